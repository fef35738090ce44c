"""Welding: counts and masses by hand, elements keep their rest values, seam hinges against the geometry of the sew line."""

from __future__ import annotations

import math

import numpy as np
import pytest
from drawn import materials, panel, pattern, rectangle

from garmentcad.cloth.cloth import Cloth
from garmentcad.cloth.lattice import build_cloth, rectangle_cloth
from garmentcad.cloth.weld import weld, welded_particles
from garmentcad.errors import SpecError
from garmentcad.pattern.pattern import EdgeUse, Panel, Seam

MATERIALS = materials(0.12, 0.30)
DART = [(0, 0), (300, 0), (300, 200), (165, 200), (150, 100), (135, 200), (0, 200)]


def seam(name: str, a, b, **given) -> Seam:
    return Seam(name, tuple(EdgeUse(*use) for use in a), tuple(EdgeUse(*use) for use in b), **given)


def build(*panels: Panel, seams: tuple[Seam, ...], grid: float = 10.0) -> Cloth:
    number = {drawn.name: k for k, drawn in enumerate(panels)}
    return build_cloth(pattern(*panels, seams=seams), lambda drawn, points: np.full(len(points), min(1, number[drawn.name])), MATERIALS, grid)


def tube(grid: float = 10.0) -> Cloth:
    """Front and back sewn at both sides, 200 mm high."""
    sides = (
        seam("left", [("front", 1, False)], [("back", 3, True)], fold_angle_deg=30.0, bend_factor=3.0),
        seam("right", [("front", 3, False)], [("back", 1, True)]),
    )
    return build(rectangle(150, 200), rectangle(130, 210, 20.0, name="back"), seams=sides, grid=grid)


def test_counts_and_masses() -> None:
    cloth = tube()
    welded, particle = weld(cloth)
    assert len(cloth.stitches) == 2 * 22
    assert welded.particle_count == cloth.particle_count - 44
    assert np.array_equal(particle, welded_particles(cloth))
    assert np.array_equal(particle[cloth.stitches[:, 0]], particle[cloth.stitches[:, 1]])
    assert welded.masses.sum() == pytest.approx(cloth.masses.sum(), rel=1e-14)
    assert welded.masses[particle[cloth.stitches[5, 0]]] == pytest.approx(cloth.masses[cloth.stitches[5]].sum())
    assert len(welded.stitches) == len(welded.stitch_seam) == 0
    assert np.array_equal(np.unique(particle), np.arange(welded.particle_count))
    assert np.array_equal(np.sort(np.unique(particle, return_index=True)[1]), np.unique(particle, return_index=True)[1])


def test_elements_follow_their_particles_and_keep_their_rest_values() -> None:
    cloth = tube()
    welded, particle = weld(cloth)
    assert np.array_equal(welded.vertex_particle, particle)
    assert np.array_equal(welded.particle_triangles, particle[cloth.triangles])
    assert np.array_equal(welded.links.ends, particle[cloth.links.ends])
    assert np.array_equal(welded.cells.corners, particle[cloth.cells.corners])
    assert np.array_equal(welded.border.corners, particle[cloth.border.corners])
    assert np.array_equal(welded.border.patch, cloth.border.patch)
    for name in ("center", "arm_a", "arm_b"):
        assert np.array_equal(getattr(welded.bends, name), particle[getattr(cloth.bends, name)])
    assert np.array_equal(welded.bends.width, cloth.bends.width)
    assert np.array_equal(welded.triangles, cloth.triangles)


def test_tube_is_closed_but_for_its_rims() -> None:
    welded, _ = weld(tube())
    faces = welded.particle_triangles
    edges = {(int(face[k]), int(face[(k + 1) % 3])) for face in faces for k in range(3)}
    assert len(edges) == 3 * len(faces)
    rims = {edge for edge in edges if edge[::-1] not in edges}
    assert len(rims) == 2 * (15 + 13)


def test_hinges_of_a_seam() -> None:
    cloth = tube()
    welded, particle = weld(cloth)
    hinges = welded.hinges
    assert len(hinges.factor) == 2 * 21
    assert hinges.factor.tolist() == [3.0] * 21 + [2.0] * 21
    assert hinges.rest_angle == pytest.approx([math.radians(30.0)] * 21 + [0.0] * 21)
    assert np.array_equal(hinges.material, np.tile([0, 1], (42, 1)))  # side a is the front in both seams
    # Front: warp along the seam. Back: warp turned by 20 degrees, so that the seam's normal has the cosine of 70 with it.
    assert np.abs(hinges.across_warp) == pytest.approx(np.tile([0.0, math.sin(math.radians(20))], (42, 1)), abs=1e-12)
    uv = cloth.vertex_uv_mm * 1e-3
    owner: dict[int, dict[int, int]] = {}
    for vertex, at in enumerate(particle):
        owner.setdefault(int(at), {})[int(cloth.vertex_panel[vertex])] = vertex
    for (start, end, wing_a, wing_b), ratio in zip(hinges.corners.tolist(), hinges.length2_over_area):
        corners = [[owner[at][number] for at in (start, end, wing)] for number, wing in ((0, wing_a), (1, wing_b))]
        lengths = [math.dist(uv[c[0]], uv[c[1]]) for c in corners]
        turns = [float(np.linalg.det([uv[c[1]] - uv[c[0]], uv[c[2]] - uv[c[0]]])) for c in corners]
        assert turns[0] > 0.0 > turns[1]  # the wing of side a lies to the left of the edge, the other to its right
        assert ratio == pytest.approx((sum(lengths) / 2) ** 2 / (0.5 * (turns[0] - turns[1])))
        vertices = set(cloth.border.corners[:, :].ravel().tolist())
        assert set(corners[0]) <= vertices


def test_dart_closes_to_its_apex() -> None:
    cloth = build(panel(DART, 10.0), seams=(seam("dart", [("front", 3, False)], [("front", 4, True)], fold_angle_deg=-20.0),))
    welded, particle = weld(cloth)
    assert welded.particle_count == cloth.particle_count - 11  # 12 points on each leg, the apex is shared
    assert len(welded.hinges.factor) == 11
    assert np.all(welded.hinges.rest_angle == math.radians(-20.0))
    apex = particle[cloth.edge_vertices["front.e3"][-1]]
    assert (welded.hinges.corners[:, :2] == apex).sum() == 1


def test_chains_of_stitches_meet_in_one_particle() -> None:
    # Four panels around a point: each is sewn to the next.
    names = ("p", "q", "r", "s")
    seams = (
        seam("pq", [("p", 1, False)], [("q", 3, True)]),
        seam("rs", [("r", 1, False)], [("s", 3, True)]),
        seam("across", [("p", 2, True), ("q", 2, True)], [("r", 0, False), ("s", 0, False)]),
    )
    cloth = build(*(rectangle(100, 100, name=name) for name in names), seams=seams)
    welded, particle = weld(cloth)
    corners = [cloth.edge_vertices["p.e2"][0], cloth.edge_vertices["q.e2"][-1], cloth.edge_vertices["r.e0"][-1], cloth.edge_vertices["s.e0"][0]]
    assert len(set(particle[corners].tolist())) == 1
    assert cloth.particle_count - welded.particle_count == 11 + 11 + 22 - 1  # the middle has one stitch more than it needs
    assert len(welded.hinges.factor) == 40
    assert np.all(welded.hinges.factor == 2.0)


def test_welding_twice_changes_nothing() -> None:
    welded, _ = weld(tube())
    again, particle = weld(welded)
    assert np.array_equal(particle, np.arange(welded.particle_count))
    assert np.array_equal(again.hinges.corners, welded.hinges.corners)
    plain = rectangle_cloth(100, 50, 10, 30.0, MATERIALS)
    assert len(weld(plain)[0].hinges.factor) == 0
    assert welded_particles(plain).tolist() == list(range(plain.particle_count))


def test_welded_arrays_are_read_only() -> None:
    welded, particle = weld(tube())
    elements = (*welded.links, *welded.cells, *welded.border, *welded.bends, *welded.hinges, welded.masses, particle)
    assert not any(array.flags.writeable for array in elements)


def test_a_panel_too_narrow_for_the_grid_is_refused_by_place() -> None:
    tape = rectangle(60, 8, name="tape")
    cloth = build(tape, seams=(seam("tube", [("tape", 0, False)], [("tape", 2, True)]),))
    with pytest.raises(SpecError, match=r"panels\.tape: seam tube sews two corners of the same triangle together near \(\d+\.\d, \d+\.\d\) mm"):
        weld(cloth)
    weld(build(tape, seams=(seam("tube", [("tape", 0, False)], [("tape", 2, True)]),), grid=3.0))
