"""Curves and values of one fabric from several files, and the sheet that they give."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from tester_records import bending_record, shear_record, sweep, table, tension_record

from garmentcad.cli.fabric_fit import fit as fit_command
from garmentcad.errors import FabricError, FileError
from garmentcad.fabric.fit import fit_sheet
from garmentcad.fabric.given import Given
from garmentcad.fabric.missing import complete
from garmentcad.io.fabric_file import read_fabric, write_fabric
from garmentcad.io.fit_csv import read_fit_files

FAST = "property;unit;warp;weft;bias;value\nW;g/m2;;;;168\nE5;%;0.67;0.40;;\nE20;%;1.87;1.87;;\nE100;%;4.60;5.87;;\n"
FAST += "EB5;%;;;4.7;\nC;mm;15.0;14.5;;\nT0;mm;;;;0.42\n"
TRUTH = {"LT": 0.6, "RT": 60.0, "EMT": 5.0, "G": 0.58, "2HG": 0.87, "2HG5": 1.45, "B": 0.118, "2HB": 0.124}


def write(folder: Path, name: str, text: str) -> Path:
    (folder / name).write_text(text, encoding="utf-8")
    return folder / name


def given(**values: float) -> dict[str, Given]:
    """Values by key, an underscore for the dot, as a file `us.csv` might hold them on lines of their own."""
    return {key.replace("_", "."): Given(value, "us.csv", line) for line, (key, value) in enumerate(values.items(), 2)}


def loops_to(force: float, folder: Path, way: str = "warp") -> Path:
    strain = sweep([0, 5, 0], 200)
    text = table(f"strain {way} [%];force {way} [gf/cm]", strain, tension_record(strain, 0.6, 60.0, 5.0, force))
    return write(folder, f"curves-{way}-{force:g}.csv", text)


def test_fast_table(tmp_path: Path) -> None:
    row = "name,W,E5-1,E20-1,E100-1,E5-2,E20-2,E100-2,EB5 %,C1 mm,C2 mm,T0\nwool,16.8,.67,1.87,4.6,.4,1.87,5.87,4.7,15,14.5,.42\n"
    inputs = [read_fit_files([write(tmp_path, name, text)]) for name, text in (("fast.csv", FAST), ("row.csv", row))]
    for values, loops, findings, _ in inputs:
        assert {key: given.value for key, given in values.items()} == {key: given.value for key, given in inputs[0].values.items()}
        assert (len(values), loops, findings) == (11, [], [])
    assert inputs[0].values["EB5"] == Given(4.7, str(tmp_path / "fast.csv"), 6)
    assert inputs[1].values["EB5"] == Given(4.7, str(tmp_path / "row.csv"), 2)


def test_sheet_from_three_loops_and_values(tmp_path: Path) -> None:
    """From the files to a sheet that reads back and completes, each value within its bounds of the sheet that made the curves."""
    rng = np.random.default_rng(3)
    strain, angle, bend = sweep([0, 5, 0], 400), sweep([0, 8, -8, 0], 600), sweep([0, 2.5, -2.5, 0], 500)
    columns: list[np.ndarray] = []
    for x, y in (
        (strain, tension_record(strain, TRUTH["LT"], TRUTH["RT"], TRUTH["EMT"], 500.0)),
        (angle, shear_record(angle, TRUTH["G"], TRUTH["2HG"], TRUTH["2HG5"])),
        (bend, bending_record(bend, TRUTH["B"], TRUTH["2HB"])),
    ):
        columns += [x, y + rng.normal(0.0, 2e-3 * np.ptp(y), len(x))]
    header = "strain [%];force [gf/cm];angle [deg];force [gf/cm];curvature [1/cm];moment [gf.cm/cm]"
    files = [write(tmp_path, "curves.csv", table(header, *columns)), write(tmp_path, "rest.csv", "property;value\nW;16.8\nT0;0.42\nMIU;0.18\n")]
    values, loops, *_ = read_fit_files(files)
    sheet, fitted = fit_sheet("wool", values, loops)[:2]
    assert {value.key for value in fitted} == {"Fm", *(f"{name}.mean" for name in TRUTH), "WT.mean"}
    for value in fitted:
        truth = TRUTH.get(value.key.partition(".")[0])
        if truth is not None and value.key != "RT.mean":  # the change of branch takes its share of RT, see test_fit_tension
            assert value.low <= truth <= value.high, value
        kept = sheet.get(value.key)
        assert kept is not None
        assert kept.note == value.note()
    assert read_fabric(write_fabric(sheet, tmp_path / "wool.yaml")) == sheet
    assert {key.partition(".")[0] for key in complete(sheet).assumed} - {"B", "2HB"} <= set(TRUTH) | {"WT"}
    assert sheet.description.endswith("Not measured: B.bias, 2HB.bias.")


def test_what_fast_cannot_tell_stays_blank(tmp_path: Path) -> None:
    values, loops, *_ = read_fit_files([write(tmp_path, "fast.csv", FAST)])
    sheet = fit_sheet("wool", values, loops).sheet
    assert {key.partition(".")[0] for key in sheet.values()} == {"W", "T0", "Fm", "LT", "EMT", "G", "B"}
    assert complete(sheet).sheet.origin("RT.warp").startswith("estimate")
    assert "Not measured: RT.warp" in sheet.description


def test_a_value_twice_is_refused(tmp_path: Path) -> None:
    with pytest.raises(FabricError, match="stands in an earlier file"):
        read_fit_files([write(tmp_path, "a.csv", FAST), write(tmp_path, "b.csv", "property;value\nW;17\nT0;0.4\n")])
    with pytest.raises(FabricError, match=r"B.warp comes twice"):
        fit_sheet("x", given(W=20.0, C_warp=15.0, B_warp=0.1), [])


def test_two_fabrics_are_refused(tmp_path: Path) -> None:
    with pytest.raises(FileError, match="2 fabrics came"):
        read_fit_files([write(tmp_path, "two.csv", "name;W;E100\na;12;4\nb;13;5\n")])


def test_a_unit_that_a_reading_does_not_have_is_refused(tmp_path: Path) -> None:
    with pytest.raises(FileError, match=r"fast.csv: line 7, column 'unit': the unit 'inch' for C.warp; allowed are mm, cm"):
        read_fit_files([write(tmp_path, "fast.csv", FAST.replace("C;mm", "C;inch"))])


def test_the_how_to_says_what_comes_out(tmp_path: Path) -> None:
    """The readings and the table of fitted values in docs/howto/from-fast-to-a-sheet.md."""
    page = (Path(__file__).parent.parent / "docs" / "howto" / "from-fast-to-a-sheet.md").read_text(encoding="utf-8")
    values, loops, findings, _ = read_fit_files([write(tmp_path, "wool-dress.csv", page.split("```")[1])])
    assert findings == []
    for fitted in fit_sheet("wool-dress", values, loops).fitted:
        bounds = f"{fitted.low:.4g} to {fitted.high:.4g}" if fitted.key != "Fm" else ""
        assert f"| {fitted.key.removesuffix('.mean')} | {fitted.value:.4g} | {bounds}" in page


def test_tension_to_different_forces_is_refused(tmp_path: Path) -> None:
    with pytest.raises(FabricError, match=r"EMT.warp as a tester prints them, at 500 gf/cm, beside tests to 100"):
        fit_sheet("x", given(W=20.0, EMT_warp=4.0, E100_weft=6.0), [])
    curves = table("strain weft [%];force weft [gf/cm]", *(lambda x: (x, tension_record(x, 0.6, 60.0, 6.0, 500.0)))(sweep([0, 6, 0], 200)))
    _, loops, *_ = read_fit_files([write(tmp_path, "curves.csv", curves)])
    assert fit_sheet("x", given(W=20.0, EMT_warp=4.0), loops).sheet.number("EMT.warp") == 4.0


def test_a_loop_of_two_directions_is_refused(tmp_path: Path) -> None:
    angle = sweep([0, 8, -8, 0], 200)
    text = table("angle warp [deg];force weft [gf/cm]", angle, shear_record(angle, 0.6, 0.9, 1.5))
    with pytest.raises(FileError, match="weft beside warp on its left; one direction is allowed"):
        read_fit_files([write(tmp_path, "curves.csv", text)])


def refusal_of(*files: Path) -> FabricError:
    values, loops, *_ = read_fit_files(files)
    with pytest.raises(FabricError) as caught:
        fit_sheet("x", values, loops)
    return caught.value


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("C;mm;2.1;;", "line 3: 2.1 mm is impossible for bending length"),
        ("W;mg/cm2;;;168", "line 3: 168.0 mg/cm2 is impossible"),
        ("E5;%;-0.67;;", "line 3: -0.67 % is impossible"),
        ("E5;%;0.67;;", "E100 is missing"),
        ("WT;gf.cm/cm2;30;;\nLT;-;0.6;;\nEMT;%;5;;", "line 3: WT = 30 is"),
        ("B;gf.cm2/cm;0.1;;\nB;gf.cm2/cm;;;0.01", "missing, and the rule 2 mean - warp"),
    ],
)
def test_refusals_name_the_file_and_the_line(line: str, message: str, tmp_path: Path) -> None:
    weight = "" if line.startswith("W;") else "W;mg/cm2;20\n"
    files = [
        write(tmp_path, "rest.csv", f"property;unit;warp;weft;value\nT0;mm;;;0.4\n{line}\n"),
        write(tmp_path, "w.csv", f"property;unit;value\n{weight}MIU;;0.2"),
    ]
    fault = refusal_of(*files)
    assert fault.message.startswith(message)
    assert fault.file == (str(files[0]) if message.startswith("line") else f"{files[0]}, {files[1]}")


def test_what_was_fitted_to_something_impossible_names_its_files(tmp_path: Path) -> None:
    long = write(tmp_path, "cant.csv", "property;unit;warp\nC;mm;100\nT0;mm;0.4\n")
    heavy, rest = write(tmp_path, "w.csv", "property;value\nW;90\n"), write(tmp_path, "rest.csv", "property;value\nMIU;0.2\n")
    fault = refusal_of(rest, long, heavy)
    assert (fault.key, fault.file) == ("B.warp", f"{long}, {heavy}")


def test_loops_and_fast_to_different_forces_do_not_go_together(tmp_path: Path) -> None:
    fast = write(tmp_path, "fast.csv", FAST)
    message = refusal_of(loops_to(500.0, tmp_path), fast).message
    assert message.startswith(f"tension loops to 500 ({tmp_path / 'curves-warp-500.csv'}) and FAST extensions to 100 ({fast}) gf/cm do not go together")
    fault = refusal_of(loops_to(100.0, tmp_path), fast)
    assert (fault.key, fault.file) == ("LT.warp", f"{fast}, {tmp_path / 'curves-warp-100.csv'}")
    assert "LT.warp comes twice, fitted to fast.csv by garmentcad fabric fit and fitted to curves-warp-100.csv by" in fault.message
    values, loops, *_ = read_fit_files([loops_to(100.0, tmp_path), write(tmp_path, "weft.csv", "property;unit;weft\nE100;%;6\nE20;%;2\n")])
    sheet = fit_sheet("x", values, loops).sheet
    assert [sheet.origin(key) for key in ("Fm", "EMT.warp", "EMT.weft")] == [
        f"fitted to {name}.csv by garmentcad fabric fit" for name in ("curves-warp-100", "curves-warp-100", "weft")
    ]


def test_two_loops_of_one_test_and_direction_are_refused(tmp_path: Path) -> None:
    fault = refusal_of(loops_to(500.0, tmp_path), loops_to(100.0, tmp_path))
    assert fault.file == str(tmp_path / "curves-warp-100.csv")
    assert f"a second tension loop of warp, after that in {tmp_path / 'curves-warp-500.csv'}, column 'force warp [gf/cm]'" in fault.message


def test_a_sheet_says_what_was_given_and_what_was_fitted_to_which_files(tmp_path: Path) -> None:
    files = [
        loops_to(500.0, tmp_path),
        write(tmp_path, "w.csv", "property;value\nW;20\nT0;0.4\n"),
        write(tmp_path, "cant.csv", "property;unit;warp\nC;mm;15\n"),
    ]
    values, loops, *_ = read_fit_files(files)
    sheet = read_fabric(write_fabric(fit_sheet("x", values, loops).sheet, tmp_path / "x.yaml"))
    assert [sheet.origin(key) for key in ("W", "T0", "LT.warp", "B.warp")] == [
        "given in w.csv",
        "given in w.csv",
        "fitted to curves-warp-500.csv by garmentcad fabric fit",
        "fitted to cant.csv, w.csv by garmentcad fabric fit",
    ]


def test_a_second_shear_loop_in_a_column_is_a_finding(tmp_path: Path) -> None:
    angle = sweep([0, 8, -8, 8, -8, 0], 400)
    file = write(tmp_path, "curves.csv", table("angle [deg];force [gf/cm]", angle, shear_record(angle, 0.6, 0.9, 1.5)))
    values, loops, *_ = read_fit_files([file])
    said = [str(finding) for finding in fit_sheet("x", values, loops).findings]
    assert f"warning: {file}: column 'force [gf/cm]': 200 of 400 samples, the first of them 201, are not used" in said[0]


def test_two_files_of_one_name_are_told_apart(tmp_path: Path) -> None:
    for folder, text in (("a", "property;value\nW;12\nT0;0.3\n"), ("b", "property;warp;weft\nB;0.1;0.05\n")):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / "values.csv").write_text(text)
    values, loops, *_ = read_fit_files([tmp_path / "a" / "values.csv", tmp_path / "b" / "values.csv"])
    sheet = fit_sheet("both", values, loops).sheet
    assert [sheet.origin(key) for key in ("W", "B.warp")] == [f"given in {tmp_path / folder / 'values.csv'}" for folder in ("a", "b")]


TEXTS = "property;unit;value\nname;;Wool dress 168\nsource;;mill laboratory 2024\nfibre;;100% wool\nweave;;plain\ndescription;;A dress wool.\n"


def test_what_a_table_says_in_words_reaches_the_sheet(tmp_path: Path) -> None:
    files = [
        write(tmp_path, "mill.csv", TEXTS + "W;g/m2;168\nT0;mm;0.42\nC;mm;15\n"),
        write(tmp_path, "rest.csv", "property;value\nfibre;100% wool\nMIU;0.2\n"),
    ]
    values, loops, _, texts = read_fit_files(files)
    fit = fit_sheet("wool", values, loops, texts)
    sheet = read_fabric(write_fabric(fit.sheet, tmp_path / "wool.yaml"))
    assert (sheet.name, sheet.fibre, sheet.weave) == ("wool", "100% wool", "plain")
    assert sheet.description.startswith("A dress wool.\nFitted to tests; ")
    assert [sheet.origin(key) for key in ("W", "B.mean", "MIU.mean")] == [
        "given in mill.csv (mill laboratory 2024)",
        "fitted to mill.csv (mill laboratory 2024) by garmentcad fabric fit",
        "given in rest.csv",
    ]
    said = "info: name: 'Wool dress 168' in the tables is not used; the sheet is 'wool', as its file"
    assert [str(finding) for finding in fit.findings if finding.key == "name"] == [said]
    assert "name" not in {finding.key for finding in fit_sheet("Wool dress 168", values, loops, texts).findings}


@pytest.mark.parametrize(("key", "other"), [("fibre", "cotton"), ("weave", "twill"), ("name", "Denim"), ("description", "A denim.")])
def test_tables_that_contradict_each_other_in_words_are_refused(key: str, other: str, tmp_path: Path) -> None:
    files = [write(tmp_path, "a.csv", TEXTS + "W;g/m2;168\n"), write(tmp_path, "b.csv", f"property;value\nT0;0.4\n{key};{other}\n")]
    with pytest.raises(FabricError) as caught:
        read_fit_files(files)
    line, text = next((i, row.split(";")[2]) for i, row in enumerate(TEXTS.splitlines(), 1) if row.startswith(key))
    assert (caught.value.file, caught.value.key) == (str(files[1]), key)
    assert caught.value.message == f"line 3: {other!r} came for {key}, but {text!r} in an earlier file ({files[0]}, line {line}); one is allowed for a fabric"


def test_the_words_of_a_table_of_one_fabric_a_row_reach_the_sheet(tmp_path: Path) -> None:
    values, loops, _, texts = read_fit_files([write(tmp_path, "row.csv", "name,fibre,weave,source,W\nx,silk,,mill,6\n")])
    sheet = fit_sheet("x", values, loops, texts).sheet
    assert (sheet.fibre, sheet.weave, sheet.origin("W")) == ("silk", None, "given in row.csv (mill)")


def test_the_command_keeps_the_fibre(tmp_path: Path) -> None:
    fit_command([write(tmp_path, "mill.csv", TEXTS + "W;g/m2;168\n")], tmp_path / "wool.yaml")
    sheet = read_fabric(tmp_path / "wool.yaml")
    assert (sheet.name, sheet.fibre, sheet.weave) == ("wool", "100% wool", "plain")
