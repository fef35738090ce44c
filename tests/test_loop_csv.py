"""Curve files: units, directions, several tests side by side; what is not understood is refused with its place."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from tester_records import bending_record, shear_record, sweep, table, tension_record

from garmentcad.errors import FabricError, FileError, GarmentError
from garmentcad.io.fit_csv import FitInput, read_fit_files


def read(tmp_path: Path, content: str) -> FitInput:
    file = tmp_path / "curves.csv"
    file.write_text(content, encoding="utf-8")
    return read_fit_files([file])


STRAIN = sweep([0.0, 5.0, 0.0], 61)
FORCE = tension_record(STRAIN, 0.6, 60.0, 5.0, 500.0)
ANGLE = sweep([0, 8, -8, 0], 81)
SHEAR = shear_record(ANGLE, 0.58, 0.87, 1.45)
BEND = sweep([0, 2.5, -2.5, 0], 71)
MOMENT = bending_record(BEND, 0.1, 0.05)


def test_three_tests_side_by_side(tmp_path: Path) -> None:
    header = "strain warp [%];force warp [gf/cm];shear angle (deg);shear force weft (gf/cm);;Curvature bias [1/cm];bending moment [gf.cm/cm]"
    loops = read(tmp_path, "KES-FB;12 March\n" + table(header, STRAIN, FORCE, ANGLE, SHEAR, np.array([]), BEND, MOMENT)).loops
    assert [(loop.test, loop.way) for loop in loops] == [("tension", "warp"), ("shear", "weft"), ("bending", "bias")]
    for loop, x, y in zip(loops, (STRAIN, ANGLE, BEND), (FORCE, SHEAR, MOMENT)):
        np.testing.assert_allclose(loop.x, x, rtol=1e-5, atol=1e-12)
        np.testing.assert_allclose(loop.y, y, rtol=1e-5, atol=1e-12)


@pytest.mark.parametrize(
    ("header", "x", "y", "factors"),
    [
        ("elongation [mm/mm];load [N/m]", STRAIN, FORCE, (100.0, 1 / 0.980665)),
        ("angle [rad];force [cN/cm]", ANGLE, SHEAR, (180 / np.pi, 1 / 0.980665)),
        ("curvature [1/m];moment [N.m/m]", BEND, MOMENT, (0.01, 1 / 9.80665e-3)),
        ("Elongation (%) Mean;Force [mN/cm]", STRAIN, FORCE, (1.0, 0.1 / 0.980665)),
        ("curvature [cm⁻¹];moment [gf · cm/cm]", BEND, MOMENT, (1.0, 1.0)),
    ],
)
def test_units_and_decimal_commas(header: str, x: np.ndarray, y: np.ndarray, factors: tuple[float, float], tmp_path: Path) -> None:
    (loop,) = read(tmp_path, table(header, x, y).replace(".", ",").replace("N,m", "N.m")).loops
    assert loop.way == "mean"
    np.testing.assert_allclose(loop.x, x * factors[0], rtol=1e-5, atol=1e-12)
    np.testing.assert_allclose(loop.y, y * factors[1], rtol=1e-5, atol=1e-12)


def test_other_columns_are_findings(tmp_path: Path) -> None:
    found = read(tmp_path, table("time [s];angle [deg];force [gf/cm]", np.arange(81.0), ANGLE, SHEAR))
    assert len(found.loops) == 1
    assert [str(finding) for finding in found.findings] == ["warning: line 1, column 'time [s]': not understood; its 81 values are not used"]


GOOD = table("angle [deg];force [gf/cm]", ANGLE, SHEAR)
BAD = [
    pytest.param(GOOD.replace("[deg]", ""), FileError, "column 'angle': no unit in brackets; allowed are deg", id="no unit"),
    pytest.param(GOOD.replace("gf/cm", "lbf/in"), FileError, "the unit 'lbf/in'; allowed are gf/cm", id="unit"),
    pytest.param(GOOD.replace("force [gf/cm]", "moment [gf.cm/cm]"), FileError, "no column of curvature on its left", id="pair"),
    pytest.param(table("angle [deg];curvature [1/cm]", ANGLE, BEND), FileError, "no column of forces or moments on its right", id="lone"),
    pytest.param(GOOD.replace("angle", "angle bias"), FileError, "a shear loop has no direction 'bias'", id="direction"),
    pytest.param(GOOD.replace("\n0.8;", "\n;"), FileError, "a blank inside the shear loop", id="blank"),
    pytest.param(GOOD.replace("\n0.8;", "\nnan;"), FabricError, "'nan' came for the shear loop", id="nan"),
    pytest.param(GOOD.replace("\n0.8;", "\nn/a;"), FabricError, "line 4, column 'angle [deg]': 'n/a' came for the shear loop", id="n/a"),
    pytest.param(GOOD + "n/a;n/a\n", FabricError, "line 83, column 'angle [deg]': 'n/a' came for the shear loop; a number", id="n/a at the end"),
    pytest.param(GOOD + ";–\n", FabricError, "line 83, column 'force [gf/cm]': '–' came for the shear loop", id="dash at the end"),
    pytest.param(GOOD + "#DIV/0!;#DIV/0!\n", FabricError, "'#DIV/0!' came for the shear loop", id="fault of a spreadsheet"),
    pytest.param(GOOD.replace("\n0.8;", "\n1e999;"), FabricError, "not finite", id="huge"),
    pytest.param("angle [deg];force [gf/cm]\n", FabricError, "0 samples", id="empty"),
    pytest.param("hello;world\n1;2\n", FileError, "no header line found", id="neither"),
]


@pytest.mark.parametrize(("text", "error", "words"), BAD)
def test_bad_files_are_refused(text: str, error: type[GarmentError], words: str, tmp_path: Path) -> None:
    with pytest.raises(error) as caught:
        read(tmp_path, text)
    assert words in str(caught.value)
    assert "curves.csv" in str(caught.value)
