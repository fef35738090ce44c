"""A third layer, such as a lining, is caught in the seam of two others."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import ipctk
import numpy as np
import pytest
import yaml
from drawn import materials, panel, pattern, rectangle

from garmentcad.check.seam import check_seams
from garmentcad.cloth.cloth import Cloth
from garmentcad.cloth.lattice import build_cloth
from garmentcad.cloth.weld import weld, welded_particles
from garmentcad.errors import SpecError
from garmentcad.export.drape import drape
from garmentcad.pattern.draft import draft
from garmentcad.pattern.parse import parse_spec
from garmentcad.pattern.pattern import EdgeUse, Panel, Pattern, Seam

BAND, SHELL = rectangle(300, 40, name="band"), rectangle(300, 200, name="shell")
WAIST = Seam("waist", (EdgeUse("band", 0, False),), (EdgeUse("shell", 2, True),))


def lined(lining: Panel, *uses: EdgeUse) -> Pattern:
    """Band and shell, and a lining whose `uses` are caught in their seam. The lining's seam comes first: order does not matter."""
    return pattern(BAND, SHELL, lining, seams=(Seam("lining", WAIST.a, uses, caught_in="waist"), WAIST))


def cloth_of(drawn: Pattern, grid: float = 20.0) -> Cloth:
    return build_cloth(drawn, lambda _, points: np.zeros(len(points), dtype=int), materials(0.12), grid)


def test_three_layers_share_the_particles_of_the_seam_and_two_hinges() -> None:
    # drawn 6 mm longer than what it is sewn to: eased in
    cloth = cloth_of(lined(rectangle(306, 150, 20.0, name="lining"), EdgeUse("lining", 2, True)))
    edges = {name: cloth.edge_vertices[f"{name}.{edge}"] for name, edge in (("band", "e0"), ("shell", "e2"), ("lining", "e2"))}
    particle = welded_particles(cloth)
    band, shell, lining = (particle[edges["band"]], particle[edges["shell"][::-1]], particle[edges["lining"][::-1]])
    assert len(band) == 16  # 300 mm at 20 mm
    assert np.array_equal(band, shell)
    assert np.array_equal(band, lining)
    assert np.allclose(cloth.vertex_uv_mm[edges["lining"][::-1], 0], np.linspace(0, 306, 16))
    welded, _ = weld(cloth)
    on_seam = np.isin(welded.hinges.corners[:, :2], band).all(axis=1)
    assert on_seam.sum() == len(welded.hinges.corners) == 2 * 15
    panel_of = np.zeros(welded.particle_count, dtype=int)
    panel_of[welded.vertex_particle] = welded.vertex_panel
    wings = {tuple(sorted(panel_of[pair])) for pair in welded.hinges.corners[:, 2:]}
    assert wings == {(0, 1), (0, 2)}  # the band with either layer; shell and lining are free of each other


def test_tapes_of_a_zip_take_a_lining_each() -> None:
    """Four layers meet at the zip. Hinges join the tapes, and each of them with its own lining; above the zip the tapes, below it shell and lining alone."""
    panels = [rectangle(100, 200, name=name) for name in ("left", "right", "lining_left", "lining_right")]
    fly = Seam("fly", (EdgeUse("left", 1, True),), (EdgeUse("right", 3, False),), closed=0.5)
    caught = [
        Seam(f"caught_{k}", side, (EdgeUse(f"lining_{side[0].panel}", side[0].edge, side[0].reverse),), caught_in="fly")
        for k, side in enumerate((fly.a, fly.b))
    ]
    cloth = cloth_of(pattern(*panels, seams=(*caught, fly)))
    welded, particle = weld(cloth)
    panel_of = np.zeros(welded.particle_count, dtype=int)
    panel_of[particle] = cloth.vertex_panel
    wings = [tuple(sorted(panel_of[pair])) for pair in welded.hinges.corners[:, 2:].tolist()]
    assert {pair: wings.count(pair) for pair in wings} == {(0, 1): 5, (0, 2): 10, (1, 3): 10}
    sides = [particle[cloth.edge_vertices[name]] for name in ("left.e1", "right.e3", "lining_left.e1", "lining_right.e3")]
    assert [len(np.intersect1d(sides[0], other)) for other in sides[1:]] == [6, 11, 6]


def test_corners_of_the_lining_stand_where_the_seam_has_stitches() -> None:
    dart = [(0, 0), (320, 0), (320, 150), (170, 150), (160, 60), (150, 150), (0, 150)]
    uses = (EdgeUse("lining", 5, True), EdgeUse("lining", 2, True))
    with pytest.raises(SpecError, match=r"seams\.lining.*150\.0 mm along side a meets no stitch of seam waist"):
        cloth_of(lined(panel(dart, name="lining"), *uses), grid=24.0)  # stitches every 23.1 mm
    assert cloth_of(lined(panel(dart, name="lining"), *uses), grid=25.0).particle_count > 0


def test_only_edges_of_the_named_seam_can_be_caught() -> None:
    lining = rectangle(300, 150, name="lining")
    loose = pattern(BAND, SHELL, lining, seams=(WAIST, Seam("lining", (EdgeUse("shell", 0, False),), (EdgeUse("lining", 2, True),), caught_in="waist")))
    with pytest.raises(SpecError, match=r"seams\.lining.*caught in waist, but not all of its edges are sewn there"):
        cloth_of(loose)
    unsaid = pattern(BAND, SHELL, lining, seams=(WAIST, Seam("lining", WAIST.a, (EdgeUse("lining", 2, True),))))
    with pytest.raises(SpecError, match=r"edge band\.e0 is sewn in waist and in lining"):
        cloth_of(unsaid)
    assert [finding.code for finding in check_seams(unsaid, None)] == ["edge-sewn-twice"]
    assert list(check_seams(lined(lining, EdgeUse("lining", 2, True)), None)) == []


def test_the_seam_must_be_there() -> None:
    square = {"points": {"a": [0, 0], "b": [100, 0], "c": [100, 100], "d": [0, 100]},
              "edges": [{"name": s + e, "from": s, "to": e} for s, e in ("ab", "bc", "cd", "da")],
              "placement": {"transform": {"translation": [0, 0, 0], "rotation": [0, 0, 0]}}}  # fmt: skip
    seam = {"name": "third", "a": ["one.ab.a", "one.ab.b"], "b": ["two.cd.d", "two.cd.c"], "caught_in": "wiast"}
    first = {"name": "waist", "a": ["one.bc.b", "one.bc.c"], "b": ["two.da.a", "two.da.d"]}
    spec = {"schema": 1, "units": "mm", "name": "x", "fabric": "denim", "mannequin": "woman-88", "panels": {"one": square, "two": square}}
    with pytest.raises(SpecError, match=r"seams\.third\.caught_in.*'wiast'.*waist"):
        draft(parse_spec(spec | {"seams": [first, seam]}), {})


def test_a_lining_hangs_behind_the_shell_that_it_is_sewn_to(tmp_path: Path) -> None:
    """A strip of waistband on two hooks, 1 m beside the body; the shell hangs from it in front, the lining, 20 mm shorter, behind."""
    panels = {}
    for name, height, fabric, x, y, z in (
        ("band", 40, "wool-suiting", 1000, 1500, 0),
        ("shell", 120, "wool-suiting", 1000, 1370, 12),
        ("lining", 100, "viscose-lining", 1000, 1390, -12),
    ):
        points = {"a": [0, 0], "b": [150, 0], "c": [150, height], "d": [0, height]}
        edges = [{"name": s + e, "from": s, "to": e} for s, e in ("ab", "bc", "cd", "da")]
        panels[name] = {"fabric": fabric, "points": points, "edges": edges, "placement": {"transform": {"translation": [x, y, z], "rotation": [0, 0, 0]}}}
    seams: list[dict[str, Any]] = [
        {"name": "waist", "a": ["band.ab.a", "band.ab.b"], "b": ["shell.cd.d", "shell.cd.c"]},
        {"name": "lining", "a": ["band.ab.a", "band.ab.b"], "b": ["lining.cd.d", "lining.cd.c"], "caught_in": "waist"},
    ]
    pins = [{"name": f"hook_{k}", "at": f"band.{k}", "point": [x, 1540, 0]} for k, x in (("c", 1150), ("d", 1000))]
    spec = {"schema": 1, "units": "mm", "name": "lined", "fabric": "wool-suiting", "mannequin": "woman-88", "panels": panels, "seams": seams, "pins": pins}
    (tmp_path / "lined.yaml").write_text(yaml.safe_dump(spec))
    result = drape(tmp_path / "lined.yaml", grid_mm=25.0)
    assert (result.report["status"], result.report["self_intersections"]) == ("converged", 0)
    assert result.report["seam_gap_mm"]["max"] < 0.5
    cloth, positions = result.cloth, result.state.positions
    mesh = ipctk.CollisionMesh(positions, ipctk.edges(cloth.particle_triangles), cloth.particle_triangles)
    assert not ipctk.has_intersections(mesh, positions)
    hems = {name: positions[cloth.vertex_particle[cloth.edge_vertices[f"{name}.ab"]]].mean(axis=0) for name in ("shell", "lining")}
    assert hems["lining"][1] - hems["shell"][1] == pytest.approx(0.020, abs=0.002)
    assert hems["shell"][2] - hems["lining"][2] > 0.5e-3
