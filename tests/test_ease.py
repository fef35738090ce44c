"""Sections and ease against circles, spheres and cylinders."""

from __future__ import annotations

import math
from itertools import pairwise, permutations

import numpy as np
import pytest
import trimesh
from hand_made import cylinder_body, flat, rectangles, tube

from garmentcad.analysis.ease import garment_ease, girth_at, girth_near
from garmentcad.analysis.section import Plane, cut, horizontal
from garmentcad.io.mannequin_file import read_mannequin

COLUMNS, PANELS = 30, 2
AROUND = COLUMNS * PANELS


def chord_girth(radius: float) -> float:
    """Girth of a regular polygon of AROUND corners."""
    return 2.0 * AROUND * radius * math.sin(math.pi / AROUND)


@pytest.mark.parametrize("order", list(permutations(range(3))))
def test_layers_that_share_a_seam_are_a_section_each(order: tuple[int, ...]) -> None:
    """Half a tube, the other half and a lining inside, all sewn to each other along one line: two closed chains, whatever the order of the triangles."""
    radii, spans = (0.2, 0.2, 0.15), ((0.0, math.pi), (math.pi, 2.0 * math.pi), (0.0, 2.0 * math.pi))
    points, strips = [[0.2, 0.0, 0.0], [0.2, 1.0, 0.0], [-0.2, 0.0, 0.0], [-0.2, 1.0, 0.0]], []
    for radius, (first, last) in zip(radii, spans):
        ends = [0 if math.cos(at) > 0.0 else 2 for at in (first, last)]
        columns = [ends[0]]
        for angle in np.linspace(first, last, 41)[1:-1]:
            columns.append(len(points))
            points += [[radius * math.cos(angle), y, radius * math.sin(angle)] for y in (0.0, 1.0)]
        strips.append([face for a, b in pairwise([*columns, ends[1]]) for face in ((a, b, b + 1), (a, b + 1, a + 1))])
    chains = cut(np.array(points), np.concatenate([np.array(strips[k]) for k in order]), horizontal(0.5))
    assert [chain.closed for chain in chains] == [True, True]
    step = math.pi / 20.0  # of the lining, which goes out to the seam and back
    lining = 38 * 0.3 * math.sin(0.5 * step) + 2.0 * math.hypot(0.2 - 0.15 * math.cos(step), 0.15 * math.sin(step))
    assert sorted(chain.length() for chain in chains) == pytest.approx([lining, 80 * 0.4 * math.sin(0.25 * step)], rel=1e-9)
    assert sum(len(chain.triangles) for chain in chains) == 2 * 3 * 40


@pytest.mark.parametrize("seed", range(20))
def test_every_triangle_that_the_plane_cuts_is_in_one_chain(seed: int) -> None:
    """Soups of triangles, of which up to five share an edge: each segment lies in its triangle and in the plane, and ends where the next one begins."""
    rng = np.random.default_rng(seed)
    points, faces = rng.normal(size=(9, 3)), np.array([rng.choice(9, 3, replace=False) for _ in range(25)], dtype=np.int32)
    above = (points[:, 1] >= 0.1)[faces].sum(axis=1)
    chains = cut(points, faces, horizontal(0.1))
    assert sorted(np.concatenate([chain.triangles for chain in chains])) == np.flatnonzero((above > 0) & (above < 3)).tolist()
    for chain in chains:
        begins = chain.points[: len(chain.triangles)]
        ends = np.roll(chain.points, -1, axis=0) if chain.closed else chain.points[1:]
        for line in (begins, ends):
            assert np.abs(line[:, 1] - 0.1).max() < 1e-12
            assert np.abs(trimesh.triangles.closest_point(points[faces[chain.triangles]], line) - line).max() < 1e-9
        assert chain.closed or len(chain.points) == len(chain.triangles) + 1
        assert not chain.closed or len(chain.triangles) > 2


@pytest.mark.parametrize("height", [0.0, 0.3, -0.77])
def test_sphere_section_is_a_circle(height: float) -> None:
    mesh = trimesh.creation.icosphere(subdivisions=5, radius=1.0)
    chains = cut(np.asarray(mesh.vertices), np.asarray(mesh.faces), horizontal(height))
    assert len(chains) == 1
    assert chains[0].closed
    assert chains[0].length() == pytest.approx(2.0 * math.pi * math.sqrt(1.0 - height**2), rel=1e-3)
    expected = mesh.section(plane_origin=[0.0, height, 0.0], plane_normal=[0.0, 1.0, 0.0])
    if height != 0.0:  # vertices in the plane: trimesh cuts them differently
        assert chains[0].length() == pytest.approx(expected.length, rel=1e-9)
    assert chains[0].winds_around(np.zeros(3), horizontal(height))
    assert not chains[0].winds_around(np.array([2.0, 0.0, 0.0]), horizontal(height))
    assert chains[0].span_around(np.zeros(3), horizontal(height)) > math.radians(350.0)
    for behind in (2.0, -2.0):  # seen from outside between two tangents, also where angles jump from 180 to -180 degrees
        seen = chains[0].span_around(np.array([behind, 0.0, 0.0]), horizontal(height))
        assert seen == pytest.approx(2.0 * math.asin(math.sqrt(1.0 - height**2) / 2.0), rel=1e-3)


def test_oblique_plane_agrees_with_trimesh() -> None:
    mesh = trimesh.creation.torus(major_radius=1.0, minor_radius=0.3)
    normal = np.array([0.3, 0.9, 0.2]) / np.linalg.norm([0.3, 0.9, 0.2])
    chains = cut(np.asarray(mesh.vertices), np.asarray(mesh.faces), Plane(normal, 0.05))
    expected = mesh.section(plane_origin=0.05 * normal, plane_normal=normal)
    assert len(chains) == 2
    assert sum(chain.length() for chain in chains) == pytest.approx(expected.length, rel=1e-9)


def test_flat_cloth_gives_one_open_chain() -> None:
    cloth = rectangles(10, 4, 0.01, 1, sewn=False)
    for height in (0.02, 0.015):  # through vertices and between them
        for start in (0, 15, 55):  # wherever the walk begins
            order = np.roll(np.arange(len(cloth.triangles)), -start)
            chains = cut(flat(cloth), cloth.particle_triangles[order], horizontal(height))
            assert [chain.closed for chain in chains] == [False]
            assert chains[0].length() == pytest.approx(0.10)
            assert chains[0].length_on(cloth.vertex_uv_mm[cloth.triangles[order]]) == pytest.approx(100.0)


def test_tube_around_a_cylinder() -> None:
    """A tube of 60 x 15 mm = 900 mm girth, draped as a circle of radius 0.13 m on a body of girth 2 pi 120 mm."""
    cloth = rectangles(COLUMNS, 40, 0.015, PANELS, sewn=True)
    positions = tube(cloth, COLUMNS, PANELS, lambda row, angle: np.full_like(angle, 0.13), lambda row: 0.6 + 0.015 * row)
    body = cylinder_body(0.12)
    ease = garment_ease(cloth, positions, body)
    assert ease["bust"] is None
    for name in ("waist", "hip"):
        found = ease[name]
        assert found is not None
        assert found.draped_mm == pytest.approx(1000.0 * chord_girth(0.13) - 240.0 * math.pi, abs=1e-6)
        assert found.pattern_mm == pytest.approx(900.0 - 240.0 * math.pi, abs=1e-6)
        assert found.level_mm == body.measurements_mm[f"{name}_height"]


def test_cone_girth_grows_with_depth() -> None:
    cloth = rectangles(COLUMNS, 40, 0.015, PANELS, sewn=True)
    positions = tube(cloth, COLUMNS, PANELS, lambda row, angle: np.full_like(angle, 0.3 - 0.004 * row), lambda row: 0.6 + 0.015 * row)
    girth = girth_at(cloth, positions, np.zeros(3), 600.0 + 15.0 * 10.0)
    assert girth is not None
    assert girth.draped_mm == pytest.approx(1000.0 * chord_girth(0.26), abs=1e-6)


def test_waistband_that_hangs_a_little_low_is_still_measured() -> None:
    cloth = rectangles(COLUMNS, 40, 0.015, PANELS, sewn=True)
    for drop, level in ((0.0035, 1096.0), (0.0215, 1078.0)):
        positions = tube(cloth, COLUMNS, PANELS, lambda row, angle: np.full_like(angle, 0.13), lambda row, drop=drop: 0.5 - drop + 0.015 * row)
        girth = girth_near(cloth, positions, np.zeros(3), 1100.0)
        assert girth is not None
        assert girth.level_mm == level
    far = tube(cloth, COLUMNS, PANELS, lambda row, angle: np.full_like(angle, 0.13), lambda row: 0.45 + 0.015 * row)
    assert girth_near(cloth, far, np.zeros(3), 1100.0) is None


def test_fold_over_and_sleeve_do_not_count() -> None:
    """The upper half of the tube is turned down over itself at a larger radius: the innermost loop is the girth. A tube beside the axis is none."""
    cloth = rectangles(COLUMNS, 40, 0.015, PANELS, sewn=True)
    positions = tube(
        cloth,
        COLUMNS,
        PANELS,
        lambda row, angle: np.full_like(angle, 0.13 if row <= 20 else 0.15),
        lambda row: 0.6 + 0.015 * (row if row <= 20 else 40 - row),
    )
    girth = girth_at(cloth, positions, np.zeros(3), 707.0)
    assert girth is not None
    assert girth.draped_mm == pytest.approx(1000.0 * chord_girth(0.13), abs=1e-6)
    assert girth_at(cloth, positions + np.array([0.4, 0.0, 0.0]), np.zeros(3), 707.0) is None


@pytest.mark.parametrize(("radius_m", "around_arms"), [(0.2, False), (0.7, True)])
def test_what_goes_around_the_arms_too_has_no_ease_at_a_girth_of_the_trunk(radius_m: float, around_arms: bool) -> None:
    """A poncho was told 900 mm of ease at the bust."""
    body = read_mannequin("woman-88")
    cloth, bust = rectangles(COLUMNS, 40, 0.015, PANELS, sewn=True), 1e-3 * body.measurements_mm["bust_height"]
    around = tube(cloth, COLUMNS, PANELS, lambda row, angle: np.full_like(angle, radius_m), lambda row: bust + 0.015 * (row - 20))
    ease = garment_ease(cloth, around + body.cylinders["torso"].origin * [1.0, 0.0, 1.0], body)["bust"]
    assert (ease is None) == around_arms
    if ease is not None:
        assert ease.draped_mm == pytest.approx(1000.0 * chord_girth(radius_m) - body.measurements_mm["bust"], abs=1e-6)
