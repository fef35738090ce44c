"""Two garments side by side: tubes whose difference is known."""

from __future__ import annotations

import csv
import dataclasses
import io
import json
import math
from pathlib import Path

import numpy as np
import pytest
from hand_made import rectangles, tube
from rich.console import Console
from test_fit import worn

from garmentcad.analysis.surface_distance import Surface, surface_distance
from garmentcad.cloth.state import State
from garmentcad.errors import InputError
from garmentcad.export.compare import Worn, compare, comparison_data, comparison_tables, draw_comparison, read_worn, write_comparison
from garmentcad.export.result_folder import Result, write_result_folder


def wider(by_m: float) -> Result:
    """The tube of `worn` on a lattice twice as fine, in another fabric."""
    cloth = rectangles(20, 16, 0.01, 2, sewn=True)
    positions = tube(cloth, 20, 2, lambda row, angle: np.full_like(angle, 0.13 + by_m), lambda row: 0.7 + 0.01 * row)
    given = worn(7.5, 12.0)
    maps = {name: np.full(cloth.particle_count, 0.03) for name in given.maps}
    return Result(given.report | {"fabric": "denim"}, cloth, State(positions, np.zeros_like(positions)), maps, given.mannequin)


def surface(given: Result) -> Surface:
    return Surface(given.state.positions, given.cloth.particle_triangles)


def compared(a: Result, b: Result):
    return compare(Worn(a.report, surface(a)), Worn(b.report, surface(b)))


def test_shapes_of_any_lattice() -> None:
    """Tubes of 20 and 40 sides, radii 130 and 140 mm: 10 mm apart but for the chords' sagitta."""
    a, b = worn(), wider(0.010)
    found = surface_distance(surface(a), surface(b))
    sagitta = 140.0 * (1.0 - math.cos(math.pi / 40))
    assert found.from_first_mm == pytest.approx(10.0, abs=sagitta + 1e-6)
    assert found.rms_mm == pytest.approx(10.0, abs=1.0)  # B's corners lie up to 1.6 mm farther from A's flat sides
    assert found.max_mm == pytest.approx(10.0 + 130.0 * (1.0 - math.cos(math.pi / 20)), abs=0.2)  # from B's corners to A's flat sides
    same = surface_distance(surface(a), surface(a))
    assert (same.rms_mm, same.max_mm) == pytest.approx((0.0, 0.0), abs=1e-9)


def test_a_lost_hem_is_seen_from_the_longer_garment() -> None:
    a, b = worn(), worn()
    shorter = rectangles(10, 6, 0.02, 2, sewn=True)
    cut = tube(shorter, 10, 2, lambda row, angle: np.full_like(angle, 0.13), lambda row: 0.74 + 0.02 * row)
    short = Surface(cut, shorter.particle_triangles)
    found = surface_distance(short, surface(b))
    assert found.from_first_mm == pytest.approx(0.0, abs=1e-6)
    # Both ways: strips of B with corners at 0 and 20, 20 and 40 mm, of 8 rows of B and 6 of the short one.
    assert found.rms_mm == pytest.approx(math.sqrt(((0 + 400) / 2 + (400 + 1600) / 2) / (8 + 6)))
    assert found.max_mm == pytest.approx(40.0)
    assert surface_distance(surface(a), short).max_mm == pytest.approx(40.0)


def test_table_and_files(tmp_path: Path) -> None:
    a, b = worn(), wider(0.010)
    folders = tmp_path / "a", tmp_path / "b"
    found = compared(a, b)
    assert found.unlike == {"fabric": ("cotton-shirting", "denim"), "grid_mm": (15.0, 7.5)}
    data = json.loads(write_comparison(tmp_path / "c.json", folders, found, "front", "none").read_text())
    assert data["figures"]["hem_height_mm"]["difference"] == pytest.approx(12.0)
    assert data["figures"]["ease_mm.bust"] == {"a": None, "b": None, "difference": None}
    rows = {row["quantity"]: row for row in csv.DictReader(io.StringIO(write_comparison(tmp_path / "c.csv", folders, found, "front", "none").read_text()))}
    assert float(rows["hem_height_mm"]["b"]) - float(rows["hem_height_mm"]["a"]) == pytest.approx(12.0)
    console = Console(width=140, record=True, file=io.StringIO())
    for table in comparison_tables(found):
        console.print(table)
    assert "denim" in console.export_text()
    narrow = Console(width=60, record=True, file=io.StringIO())
    for table in comparison_tables(found):
        narrow.print(table)
    assert "…" not in narrow.export_text()  # names fold, numbers never lose a digit
    with pytest.raises(InputError, match=r"\.png"):
        write_comparison(tmp_path / "c.pdf", folders, found, "front", "none")


def test_another_sheet_of_the_same_name_is_told() -> None:
    a, b = worn(), worn()
    b.report["fabric_sha256"] = "e" * 64
    found = compared(a, b)
    assert found.unlike == {"fabric_sha256": ("c" * 64, "e" * 64)}
    console = Console(width=140, record=True, file=io.StringIO())
    console.print(comparison_tables(found)[0])
    assert "fabric, other values of one name" in console.export_text()


def test_how_both_ended_is_said_where_it_is_the_same() -> None:
    a, b = worn(), wider(0.010)
    for one in (a, b):
        one.report["status"] = "max_time"
    found = compared(a, b)
    assert "status" not in found.unlike
    assert comparison_data(found)["status"] == ["max_time", "max_time"]


def test_a_figure_of_an_older_version_may_be_missing() -> None:
    a, b = worn(), worn()
    report = {key: value for key, value in b.report.items() if key != "support_n"}
    found = compared(a, dataclasses.replace(b, report=report))
    assert found.rows["support_n.weight"][1] is None
    assert found.rows["hem_height_mm"][1] is not None


def test_folders_of_other_versions_are_compared_by_report_and_mesh(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Positions come from garment.obj to its nine digits; a cloth.npz that this version cannot read is not asked for."""
    monkeypatch.setattr("garmentcad.export.result_folder.render_pictures", lambda *_: [])
    there = {"particles": len(worn().state.positions), "triangles": len(worn().cloth.triangles)}
    for name, given in (("a", worn()), ("b", wider(0.010))):
        counted = there if name == "a" else {"particles": len(given.state.positions), "triangles": len(given.cloth.triangles)}
        write_result_folder(tmp_path / name, dataclasses.replace(given, report=given.report | counted), {"spec": "x"})
        (tmp_path / name / "cloth.npz").write_bytes(b"of another version")
    found = compare(read_worn(tmp_path / "a"), read_worn(tmp_path / "b"))
    assert found.shape.rms_mm == pytest.approx(compared(worn(), wider(0.010)).shape.rms_mm, abs=1e-5)
    assert found.unlike["fabric"] == ("cotton-shirting", "denim")
    path = tmp_path / "a" / "garment.obj"
    whole = path.read_text()
    path.write_text(whole[: whole.rindex("f ")])
    with pytest.raises(InputError, match=rf"garment\.obj: holds {there['triangles'] - 1} triangles; report\.json has {there['triangles']}"):
        read_worn(tmp_path / "a")
    path.write_text(whole[: whole.rindex(" ")])
    with pytest.raises(InputError, match=r"garment\.obj: is not a garment written by garmentcad \(points of three numbers and triangles are wanted\)"):
        read_worn(tmp_path / "a")
    (tmp_path / "b" / "garment.obj").write_text("f 1/1 2/2 3/3\n")
    with pytest.raises(InputError, match=r"garment\.obj"):
        read_worn(tmp_path / "b")


def test_picture_paints_both_on_one_scale() -> None:
    """A is strained by at most 2 % and B by 3 %: A's end color is not B's, and the third tile is dark where A and B are far apart."""
    pytest.importorskip("PIL.Image")
    a, b = worn(), wider(0.010)
    picture = draw_comparison(a, b, compared(a, b), "front", "strain", height_px=240)
    pixels = np.asarray(picture).astype(int)
    width = pixels.shape[1] // 3
    assert pixels.shape[:2] == (240, 3 * width)
    middle = [pixels[120, k * width + (width + round(0.16 * 240)) // 2] for k in range(3)]
    assert middle[1].sum() < middle[0].sum() - 100
    assert middle[2].sum() < middle[0].sum() - 100
    with pytest.raises(InputError, match=r"no map 'tension'"):
        draw_comparison(a, b, compared(a, b), "front", "tension", height_px=240)
