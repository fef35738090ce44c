"""garmentcad import and export of patterns, as a script sees them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from command import garmentcad, garmentcad_here
from test_garmentcode_body import MEAN

from garmentcad.export.drape import drape
from garmentcad.io.mannequin_file import read_mannequin
from garmentcad.io.spec_file import read_spec
from garmentcad.simulation.job import make_job
from tools.garmentcode_patterns import bodice, panel, pattern_file, skirt, stitch, write


def test_import_check_export(tmp_path: Path) -> None:
    write(skirt(), tmp_path, "skirt_specification.json")
    run = garmentcad("import", "skirt_specification.json", "-o", "made/skirt.yaml", folder=tmp_path)
    assert run.returncode == 0, run.stderr
    assert run.stdout.strip() == "made/skirt.yaml"
    assert "note: seam skirt_front-2-wb_front-0 gathers" in run.stderr
    assert read_spec(tmp_path / "made" / "skirt.yaml") == read_spec(tmp_path / "skirt_specification.json").model_copy(update={"name": "skirt"})
    run = garmentcad("check", "made/skirt.yaml", folder=tmp_path)
    assert run.returncode == 0, run.stdout
    run = garmentcad("export", "made/skirt.yaml", "-o", "again.json", folder=tmp_path)
    assert run.returncode == 0, run.stderr
    assert read_spec(tmp_path / "again.json").panels == read_spec(tmp_path / "made" / "skirt.yaml").panels


def test_check_reads_the_file_itself(tmp_path: Path) -> None:
    path = write(bodice(), tmp_path)
    run = garmentcad_here("check", str(path), folder=tmp_path)
    assert run.returncode == 0, run.stdout
    assert "panel left_front starts 8 mm (8, 0, 0) from its place, clear of panel right_front" in run.stdout


def test_the_body_beside_the_file_comes_along(tmp_path: Path) -> None:
    write(skirt(), tmp_path)
    values = MEAN | {"hips": 100.0}
    (tmp_path / "body_measurements.yaml").write_text("body:\n" + "".join(f"  {name}: {value}\n" for name, value in values.items()))
    run = garmentcad_here("import", "garment.json", "-o", "made/skirt.yaml", folder=tmp_path)
    assert run.returncode == 0, run.stderr
    assert read_spec(tmp_path / "made" / "skirt.yaml").mannequin == "skirt-body.yaml"
    assert abs(read_mannequin(tmp_path / "made" / "skirt-body.yaml").measurements_mm["hip"] - 1000.0) < 0.5
    for spec in ("garment.json", "made/skirt.yaml"):  # the reference is looked up beside the spec, not in the working folder
        assert make_job(tmp_path / spec).mannequin.measurements_mm["hip"] == pytest.approx(1000.0, abs=0.5)


def test_a_file_drapes(tmp_path: Path) -> None:
    """A tube of two flat panels, 400 mm apart around the hips: it closes, rests and crosses nothing; its girth and length are those of the pattern."""
    front = panel((0, 0), (55, 0), (50, 30), (0, 30), at=(-25, 80, 22))
    back = panel((0, 0), (0, 30), (50, 30), (55, 0), at=(-25, 80, -20))
    path = write(pattern_file({"front": front, "back": back}, [stitch("front", 1, "back", 2), stitch("front", 3, "back", 0)]), tmp_path)
    result = drape(str(path), grid_mm=40.0)
    report = result.report
    assert report["status"] == "converged"
    assert (report["self_intersections"], report["mannequin_intersections"], report["mannequin_penetration_mm"]["max"]) == (0, 0, 0.0)
    assert report["seam_gap_mm"]["max"] <= 0.1
    assert report["mannequin"] == "garmentcode-mean"
    # The right side is outside: triangles, counter-clockwise on it, look away from the middle of the tube.
    corners = result.state.positions[result.cloth.particle_triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    outward = corners.mean(axis=1) - result.state.positions.mean(axis=0)
    assert ((normals * outward * [1, 0, 1]).sum(axis=1) > 0).mean() > 0.95


def test_refused(tmp_path: Path) -> None:
    write(skirt(), tmp_path)
    (tmp_path / "bad.json").write_text('{"pattern": {}, "pattern": {}}')
    for arguments, says in (
        (("import", "garment.json", "-o", "x.json"), "allowed are .yaml"),
        (("import", "garment.dwg", "-o", "x.yaml"), "allowed is .json"),
        (("drape", "bad.json"), "'pattern' stands twice"),
    ):
        run = garmentcad_here(*arguments, folder=tmp_path)
        assert run.returncode == 2, run.stderr
        assert says in run.stdout + run.stderr
        assert "Traceback" not in run.stderr


def test_what_export_refuses_of_a_pattern_names_its_file(tmp_path: Path) -> None:
    edges = "[{name: e1, from: a, to: b}, {name: e2, from: b, to: c}, {name: e3, from: c, to: a}]"
    hole = "[[{name: hole, from: h, to: h, arc: {center: [110, 60], direction: clockwise}}]]"
    spec = f"""schema: 1
units: mm
name: x
fabric: cotton-shirting
mannequin: woman-88
panels:
  p:
    points: {{a: [0, 0], b: [200, 0], c: [100, 200], h: [100, 60]}}
    edges: {edges}
    cutouts: {hole}
    placement: {{transform: {{translation: [0, 1000, 300]}}}}
"""
    (tmp_path / "x.yaml").write_text(spec)
    run = garmentcad_here("export", "x.yaml", "-o", "x.json", folder=tmp_path)
    assert (run.returncode, run.stdout) == (2, "")
    assert run.stderr.startswith("garmentcad: x.yaml: panels.p.cutouts: GarmentCode files have no cutouts")


def test_a_pattern_is_exported_with_other_parameters(tmp_path: Path) -> None:
    """The straight skirt 100 mm shorter: its panels, by the reader of the format, are lower by that, and its waistband is the same."""
    for name, options in (("long", ()), ("short", ("--set", "length=500"))):
        run = garmentcad_here("export", "straight-skirt", "-o", f"{name}.json", *options, folder=tmp_path)
        assert run.returncode == 0, run.stderr
    long, short = (make_job(str(tmp_path / f"{name}.json")).pattern.panels for name in ("long", "short"))
    heights = {name: [np.ptp([edge.curve.start[1] for edge in panels[name].edges]) for panels in (long, short)] for name in long}
    assert {name: round(a - b, 1) for name, (a, b) in heights.items()} == {name: 0.0 if "band" in name else 100.0 for name in heights}
