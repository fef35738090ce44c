"""Fit files, tables and error bars."""

from __future__ import annotations

import csv
import dataclasses
import io
import json
from pathlib import Path

import pytest
from rich.console import Console
from test_report import run_record, tube_measures
from test_result_folder import result

from garmentcad.analysis.body_line import parse_line
from garmentcad.analysis.figures import Figure, figures
from garmentcad.analysis.refinement import error_bars
from garmentcad.errors import InputError
from garmentcad.export import fit
from garmentcad.export.fit import fit_of, fit_tables, write_fit
from garmentcad.export.report import build_report
from garmentcad.export.result_folder import Result


def worn(grid_mm: float = 15.0, hem_mm: float = 0.0) -> Result:
    """The tube of test_result_folder with the report of another one."""
    report = build_report(dataclasses.replace(run_record(), grid_mm=grid_mm), tube_measures())
    report["hem_height_mm"] += hem_mm
    return dataclasses.replace(result(), report=report)


def test_a_drape_in_true_motion_is_no_coarser_drape() -> None:
    moving = worn(30.0)
    moving.report["mode"] = "dynamics"
    assert fit_of(worn(), coarser=[worn(30.0)])["mode"] == "drape"
    with pytest.raises(InputError, match="mode differ"):
        fit_of(worn(), coarser=[moving])


def test_a_drape_in_another_sheet_of_the_same_name_is_no_coarser_drape() -> None:
    heavier = worn(30.0)
    heavier.report["fabric_sha256"] = "e" * 64
    with pytest.raises(InputError, match="the values of the fabric differ"):
        fit_of(worn(), coarser=[heavier])
    del heavier.report["fabric_sha256"]  # of an older version
    assert fit_of(worn(), coarser=[heavier])["error_bars"]


def test_a_drape_that_is_not_at_rest_is_no_coarser_drape() -> None:
    falling = worn(30.0)
    falling.report["status"] = "max_time"
    with pytest.raises(InputError, match="the coarser drape ended as max_time; one that came to rest is wanted"):
        fit_of(worn(), coarser=[falling])


def test_every_figure_has_a_unit_of_its_name() -> None:
    found = figures(worn().report)
    assert found["ease_mm.hip"].unit == "mm"
    assert found["seam_tension.side 0.mean_n_m"] == Figure(12.0, "N/m")
    assert found["seam_tension.side 0.length_mm"] == Figure(600.0, "mm")
    assert (found["trellis_deg.max"].unit, found["trellis_deg.over_8_percent"].unit) == ("°", "%")
    assert (found["support_n.normal"].unit, found["contact_area_m2"].unit, found["mass_kg"].unit) == ("N", "m²", "kg")
    assert found["ease_mm.bust"].value is None
    assert {name for name, figure in found.items() if not figure.unit} == {"hem.nodes"}  # a count


def test_json_and_csv_hold_the_same(tmp_path: Path) -> None:
    fit = fit_of(worn(), [parse_line("middle=760")])
    assert json.loads(write_fit(tmp_path / "fit.json", fit).read_text()) == fit
    rows = list(csv.DictReader(io.StringIO(write_fit(tmp_path / "fit.csv", fit).read_text())))
    assert {row["quantity"]: float(row["value"]) for row in rows if row["value"]} == pytest.approx(
        {name: figure.value for name, figure in figures(fit).items() if figure.value is not None}
    )
    loop = fit["lines"]["middle"]["torso"]
    assert loop["ease_mm"] == pytest.approx(loop["draped_mm"] - loop["body_mm"])
    assert loop["pattern_mm"] == pytest.approx(400.0)  # two panels of 10 x 20 mm
    with pytest.raises(InputError, match=r"\.json, \.csv"):
        write_fit(tmp_path / "fit.txt", fit)


def test_error_bar_of_a_figure_that_converges_with_the_spacing() -> None:
    """q = 5 + 0.3 h: the error at h is 0.3 h, whatever coarser lattice tells it."""

    def at(grid_mm: float) -> dict[str, Figure]:
        return {"q": Figure(5.0 + 0.3 * grid_mm, "mm"), "none": Figure(None, "mm")}

    for coarser in ([20.0], [14.0], [14.0, 20.0]):
        assert error_bars(at(10.0), 10.0, [(grid, at(grid)) for grid in coarser]) == {"q": pytest.approx(3.0)}
    with pytest.raises(InputError, match=r"coarser than the 10 mm"):
        error_bars(at(10.0), 10.0, [(10.0, at(10.0))])


def test_error_bars_in_file_and_table(tmp_path: Path) -> None:
    fit = fit_of(worn(15.0), [parse_line("middle=760")], [worn(30.0, 8.0)])
    assert fit["error_bars"]["hem_height_mm"] == pytest.approx(8.0)
    assert fit["error_bars"]["lines.middle.torso.ease_mm"] == 0.0
    rows = {row["quantity"]: row for row in csv.DictReader(io.StringIO(write_fit(tmp_path / "fit.csv", fit).read_text()))}
    assert float(rows["hem_height_mm"]["error"]) == pytest.approx(8.0)
    console = Console(width=140, record=True, file=io.StringIO())
    for table in fit_tables(fit):
        console.print(table)
    assert "630.0 ± 8" in console.export_text()
    with pytest.raises(InputError, match=r"fabric differ"):
        fit_of(worn(15.0), [], [dataclasses.replace(worn(30.0), report=worn(30.0).report | {"fabric": "denim"})])


def test_a_line_that_stands_twice_is_refused() -> None:
    with pytest.raises(InputError, match="lines: the line middle stands twice"):
        fit_of(worn(), [parse_line("middle=760"), parse_line("middle=750")])


@pytest.mark.parametrize("name", ["hip", "thigh_left"])
def test_a_line_with_the_name_of_one_of_the_report_is_refused(name: str) -> None:
    with pytest.raises(
        InputError, match=f"lines: '{name}' is the name of a line that every report has; allowed are names other than bust, waist, hip, top_arm"
    ):
        fit_of(worn(), [parse_line("middle=760"), parse_line(f"{name}=760")])


def test_a_swatch_has_no_lines() -> None:
    with pytest.raises(InputError, match=r"no mannequin"):
        fit_of(dataclasses.replace(worn(), mannequin=None), [parse_line("middle=760")])


def test_two_loops_of_a_line_around_one_part_are_both_told(monkeypatch: pytest.MonkeyPatch) -> None:
    """A slanted plane may go through a part twice."""
    (one,) = fit.loops_in_plane(worn().cloth, worn().state.positions, worn().mannequin, parse_line("middle=760").plane)
    monkeypatch.setattr(fit, "loops_in_plane", lambda *_: [one, dataclasses.replace(one, draped_mm=1.0)])
    found = fit_of(worn(), [parse_line("middle=760")])["lines"]["middle"]
    assert {name: loop["draped_mm"] for name, loop in found.items()} == {"torso": one.draped_mm, "torso_2": 1.0}
