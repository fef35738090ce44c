"""Knife pleats: cut into their edge, caught in its seam, and folded before the panel is laid around the body."""

from __future__ import annotations

from typing import Any

import ipctk
import numpy as np
import pytest
from drawn import materials
from trimesh.creation import icosphere

from garmentcad.analysis.folds import fold_angles_deg
from garmentcad.cloth.cloth import Cloth
from garmentcad.cloth.lattice import build_cloth
from garmentcad.cloth.weld import weld
from garmentcad.errors import SpecError
from garmentcad.io.fabric_file import load_fabric
from garmentcad.io.shipped import shipped_file
from garmentcad.mannequin.mannequin import Mannequin
from garmentcad.pattern.draft import draft
from garmentcad.pattern.parse import parse_spec
from garmentcad.pattern.pattern import Pattern
from garmentcad.pattern.runs import side_length
from garmentcad.placement.place import place_vertices
from garmentcad.placement.pleats import LIFT_MM
from garmentcad.simulation.job import Job
from garmentcad.simulation.run import run

KNIFE = {"name": "k", "edge": "cd", "at": {"mm": 70, "from": "d"}, "depth": 40, "count": 2, "every": 140}
TURNED = KNIFE | {"at": {"mm": 90, "from": "c"}}
MEETING = KNIFE | {"at": {"mm": 60, "from": "d"}, "depth": 50, "every": 150}


def rectangle(width: float, low: float, high: float, **more: Any) -> dict[str, Any]:
    points = {"a": [0, low], "b": [width, low], "c": [width, high], "d": [0, high]}
    edges = [{"name": name, "from": name[0], "to": name[1]} for name in ("ab", "bc", "cd", "da")]
    return {"points": points, "edges": edges, "placement": {"transform": {"translation": [0, 0, 0]}}, **more}


def pleated(pleats: dict[str, Any], width: float = 500.0, **more: Any) -> Pattern:
    """A panel whose upper edge is sewn to a band."""
    shown = width - 2 * pleats["depth"] * pleats["count"]
    panels = {"p": rectangle(width, 0, 200, pleats=[pleats], **more), "band": rectangle(shown, 200, 230)}
    seams = [{"name": "top", "a": ["band.ab.a", "band.ab.b"], "b": ["p.cd.d", "p.cd.c"]}]
    return draft(parse_spec({"name": "x", "fabric": "wool", "mannequin": "woman-88", "panels": panels, "seams": seams}, "x.yaml"), {})


def cloth_of(pattern: Pattern, grid: float) -> Cloth:
    return build_cloth(pattern, lambda _, points: np.zeros(len(points), int), materials(0.1), grid)


def test_a_run_goes_over_what_is_seen_and_the_depth_is_a_seam_of_its_own() -> None:
    for drawn in (KNIFE, TURNED, MEETING):
        made = pleated(drawn)
        seams = {seam.name: seam for seam in made.seams}
        assert side_length(made, seams["top"].b) == pytest.approx(500.0 - 4.0 * drawn["depth"])
        for name in ("p.k_1", "p.k_2"):
            assert side_length(made, seams[name].a) == pytest.approx(drawn["depth"])
            assert side_length(made, seams[name].b) == pytest.approx(drawn["depth"])
            assert seams[name].bend_factor == 0.0
    folds = {fold.name: (fold.points_mm.tolist(), fold.angle_deg) for fold in pleated(KNIFE).panels["p"].folds}
    assert folds["k_2_fold"] == ([[210.0, 200.0], [210.0, 0.0]], -170.0)
    assert folds["k_2_under"] == ([[250.0, 200.0], [250.0, 0.0]], 170.0)
    turned = {fold.name: fold.points_mm[0].tolist() for fold in pleated(TURNED).panels["p"].folds}
    assert turned["k_1_fold"] == [410.0, 200.0]
    assert turned["k_1_under"] == [370.0, 200.0]


@pytest.mark.parametrize("drawn", [KNIFE, TURNED, MEETING])
@pytest.mark.parametrize("grid", [50.0, 20.0, 7.0])
def test_sewn_the_top_of_the_panel_is_as_wide_as_the_band(drawn: dict[str, Any], grid: float) -> None:
    """Where folded, three layers end in one seam: a fold, and what lies under it, in one particle; the under fold where the depth ends."""
    welded, _ = weld(cloth_of(pleated(drawn), grid))

    def particle(x: float) -> int:
        found = np.flatnonzero((welded.vertex_panel == 0) & (np.abs(welded.vertex_uv_mm - [x, 200.0]).max(axis=1) < 1e-6))
        return int(welded.vertex_particle[found].item())

    step = 1.0 if drawn is not TURNED else -1.0
    first = drawn["at"]["mm"] if step > 0.0 else 500.0 - drawn["at"]["mm"]
    for k in (0, 1):
        fold, depth = first + step * k * drawn["every"], step * drawn["depth"]
        assert particle(fold) == particle(fold + 2.0 * depth)
        assert particle(fold + depth) == particle(fold - depth)
        assert particle(fold) != particle(fold + depth)


@pytest.mark.parametrize("drawn", [KNIFE, TURNED, MEETING])
@pytest.mark.parametrize("anchor", [5.0, 290.0])
def test_a_panel_is_folded_before_it_is_placed(drawn: dict[str, Any], anchor: float) -> None:
    made = pleated(drawn)
    cloth = cloth_of(made, 10.0)
    x = place_vertices(made, cloth, far_ball()) * 1e3
    mine = cloth.vertex_panel == 0
    x = x[mine] - [anchor, 0.0, 0.0]
    assert np.ptp(x[:, 0]) == pytest.approx(500.0 - 4.0 * drawn["depth"])
    assert np.ptp(x[:, 2]) == pytest.approx(LIFT_MM)
    triangles = cloth.triangles[mine[cloth.triangles[:, 0]]]
    # lengths are kept but for the slope, 12 in 40 mm at most
    for a, b in ((0, 1), (1, 2), (2, 0)):
        flat = np.linalg.norm(cloth.vertex_uv_mm[triangles[:, a]] - cloth.vertex_uv_mm[triangles[:, b]], axis=1)
        placed = np.linalg.norm(x[triangles[:, a]] - x[triangles[:, b]], axis=1)
        assert np.all((placed >= flat - 1e-9) & (placed <= np.hypot(1.0, LIFT_MM / drawn["depth"]) * flat + 1e-9))
    edges = ipctk.edges(triangles)
    assert not ipctk.has_intersections(ipctk.CollisionMesh(x, edges, triangles), x)
    # three layers: each a good way over the next, where neither is folded
    fold = 70.0 if drawn is KNIFE else None
    if fold is not None:
        uv = cloth.vertex_uv_mm[mine]

        def height(at):
            return np.interp(at, *np.unique(np.round(np.column_stack([uv[:, 0], x[:, 2]]), 6), axis=0).T)

        layers = [height(fold - 20.0), height(fold + 20.0), height(fold + 60.0)]
        assert layers[0] > layers[1] + 1.5 > layers[2] + 3.0


@pytest.mark.parametrize(("pleats", "more", "key", "message"), [
    ({"edge": "top"}, {}, "pleats.0.edge", "no edge is called 'top'"),
    ({"at": {"mm": 70, "from": "a"}}, {}, "pleats.0.at.from", "edge 'cd' runs from 'c' to 'd'; came 'a'"),
    ({"depth": 0}, {}, "pleats.0.depth", "larger than 0"),
    ({"count": 1.5}, {}, "pleats.0.count", "came 1.5; a whole number of pleats is wanted"),
    ({"count": 101}, {}, "pleats.0.count", "allowed is 1 to 100"),
    ({"every": None}, {}, "pleats.0.every", "more than one pleat needs the distance"),
    ({"angle": 60}, {}, "pleats.0.angle", "came 60; allowed is 90 to 180"),
    ({"at": {"mm": 30, "from": "d"}}, {}, "pleats.0", "pleat 1 takes -10.0 to 110.0 mm of edge 'cd' from 'd' on"),
    ({"every": 110}, {}, "pleats.0", "pleats may meet, but not lie over each other"),
    ({"at": {"mm": 350, "from": "d"}}, {}, "pleats.0", "free is"),
    ({}, {"notches": [{"edge": "cd", "at": {"mm": 100, "from": "d"}, "name": "n"}]}, "pleats.0", "notch 'n' of edge 'cd' lies in the depth of a pleat"),
    ({}, {"darts": [{"name": "d", "edge": "cd", "at": 0.02, "intake": 5, "length": 20}]}, "pleats.0.edge", "one straight edge"),
    ({}, {"points": {"a": [0, 0], "b": [500, 0], "c": [500, 200], "d": [0, 200], "k_1_fold": [9, 9]}}, "pleats.0.name", "a point 'k_1_fold'"),
])  # fmt: skip
def test_faults(pleats: dict[str, Any], more: dict[str, Any], key: str, message: str) -> None:
    with pytest.raises(SpecError) as caught:
        pleated(KNIFE | pleats, **more)
    assert caught.value.key == f"panels.p.{key}"
    assert message in caught.value.message


def test_a_pressed_pleat_hangs_closed_below_the_seam_that_catches_it() -> None:
    """A panel with one pleat, sewn to a band on pegs: three layers, as wide at the hem as at the band, none through another."""
    pleats = {"name": "k", "edge": "cd", "at": {"mm": 75, "from": "d"}, "depth": 50}
    panels = {"p": rectangle(200, 0, 120, pleats=[pleats]), "band": rectangle(100, 130, 160, drill_holes={"left": [10, 150], "right": [90, 150]})}
    pins = [{"name": peg, "at": f"band.{peg}", "point": [x, 150, 0]} for peg, x in (("left", 10), ("right", 90))]
    seams = [{"name": "top", "a": ["band.ab.a", "band.ab.b"], "b": ["p.cd.d", "p.cd.c"]}]
    spec = parse_spec({"name": "x", "fabric": "wool-suiting", "mannequin": "woman-88", "panels": panels, "pins": pins, "seams": seams}, "x.yaml")
    fabrics = {"wool-suiting": load_fabric(shipped_file("fabrics", "wool-suiting"))}
    outcome = run(Job(spec, draft(spec, {}), fabrics, far_ball(), grid_mm=20.0), lambda progress: None)
    assert outcome.status == "converged"
    assert not outcome.warnings
    x, uv = outcome.state.positions * 1e3, outcome.cloth.vertex_uv_mm
    triangles = outcome.cloth.particle_triangles
    assert not ipctk.has_intersections(ipctk.CollisionMesh(x, ipctk.edges(triangles), triangles), x)
    hem = x[outcome.cloth.vertex_particle[(outcome.cloth.vertex_panel == 0) & (uv[:, 1] == 0.0)]]
    assert np.ptp(hem[:, 0]) == pytest.approx(100.0, abs=5.0)
    assert np.ptp(hem[:, 2]) < 25.0
    angles = fold_angles_deg(outcome.cloth, outcome.state.positions, {f"p.{fold.name}": fold.points_mm for fold in outcome.job.pattern.panels["p"].folds})
    # at least what is left of 170 degrees in wool
    assert angles["p.k_1_fold"] < -0.84 * 170.0
    assert angles["p.k_1_under"] > 0.84 * 170.0


def far_ball() -> Mannequin:
    """A body that nothing meets."""
    mesh = icosphere(subdivisions=1, radius=0.05)
    faces = np.asarray(mesh.faces, dtype=np.int32)
    return Mannequin("ball", np.asarray(mesh.vertices) - [0.0, 0.0, 3.0], faces, {}, {}, {}, ("ball",), np.zeros(len(faces), dtype=np.int32))
