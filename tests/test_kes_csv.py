"""CSV files as laboratories print them: layouts, separators, decimal commas; nothing is dropped without a finding."""

from __future__ import annotations

from pathlib import Path

import pytest

from garmentcad.errors import FabricError, FileError, GarmentError
from garmentcad.fabric.sheet import KesSheet
from garmentcad.io.csv_table import read_table
from garmentcad.io.kes_csv import KesCsv, read_kes_csv


def read(tmp_path: Path, content: str | bytes) -> KesCsv:
    file = tmp_path / "lab.csv"
    file.write_bytes(content.encode() if isinstance(content, str) else content)
    return read_kes_csv(file)


def numbers(sheet: KesSheet) -> dict[str, float]:
    return {key: value.value for key, value in sheet.values().items()}


EXPECTED = {"W": 12.38, "EMT.warp": 3.5, "EMT.weft": 7.0, "B.mean": 0.118}

ONE_A_ROW = {
    "comma": "name,W,EMT warp,EMT weft,B mean\nbroad,12.38,3.5,7,0.118\n",
    "g/m2": "fabric,weight_g_m2,EMT-1 %,EMT-2 %,B\nbroad,123.8,3.5,7,.118\n",
    "semicolon, decimal comma": "Name;W (mg/cm²);EMT warp (%);EMT weft (%);B (gf·cm²/cm)\nbroad;12,38;3,5;7;0,118\n",
    "quoted decimal comma": '"name","W","EMT warp","EMT weft","B"\n"broad","12,38","3,5 %","7%","0,118"\n',
    "tab and blanks": "name\tW\tEMT warp\tEMT weft\tB\tG\n\n  broad \t 12.38 \t3.5\t7\t0.118\t-\n\n",
    "windows line ends": "name;W;EMT1;EMT2;B\r\nbroad;12.38;3.5;7;0.118\r\n",
    "empty column at the end": "name;W;EMT1;EMT2;B;;\nbroad;12.38;3.5;7;0.118;;\n",
}
ONE_VALUE_A_ROW = {
    "directions": "Property;Unit;Warp;Weft;Mean\nName;;broad;;\nW;mg/cm2;;;12,38\nEMT;%;3,5;7;\nB;gf.cm2/cm;;;0,118\n",
    "value": "parameter,value,unit\nname,broad,\nweight,123.8,g/m2\nEMT warp,3.5,%\nEMT weft,7,%\nB mean,0.118,gf.cm2/cm\n",
    "direction column": "fabric,symbol,direction,value\nbroad,W,,12.38\nbroad,EMT,warp,3.5\nbroad,EMT,weft,7\nbroad,B,mean,0.118\n",
}


@pytest.mark.parametrize("layout", [*ONE_A_ROW, *ONE_VALUE_A_ROW])
def test_layouts_give_the_same_sheet(layout: str, tmp_path: Path) -> None:
    result = read(tmp_path, {**ONE_A_ROW, **ONE_VALUE_A_ROW}[layout])
    (sheet,) = result.sheets
    assert numbers(sheet) == EXPECTED
    assert sheet.name == "broad"
    assert sheet.source is not None
    assert sheet.source.startswith("lab.csv, line ")
    assert result.findings == ()


@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16", "cp1252"])
def test_encodings(encoding: str, tmp_path: Path) -> None:
    result = read(tmp_path, "name;W (mg/cm²);B µN·m\nétoffe;12,38;11,571847\n".encode(encoding))
    assert result.sheets[0].name == "étoffe"
    assert numbers(result.sheets[0]) == {"W": 12.38, "B.mean": 0.118}
    assert [finding.message for finding in result.findings] == (["the file is not UTF-8; it was read as Windows-1252"] if encoding == "cp1252" else [])


def test_a_byte_order_mark_before_a_quoted_header_is_no_part_of_it(tmp_path: Path) -> None:
    assert numbers(read(tmp_path, '"weight, g/m2","B"\n"123.8","0.118"\n'.encode("utf-8-sig")).sheets[0]) == {"W": 12.38, "B.mean": 0.118}


def test_signs_of_a_missing_value_are_blanks(tmp_path: Path) -> None:
    (sheet,) = read(tmp_path, "name;W;B;G;T0;LT;RT;2HG;2HB\na;12;NA;n/a;nd;N.D.;–;—;-\n").sheets
    assert numbers(sheet) == {"W": 12.0}


@pytest.mark.parametrize(("lines", "found"), [(29, True), (30, False)])
def test_a_header_is_looked_for_in_the_first_thirty_lines(lines: int, found: bool, tmp_path: Path) -> None:
    text = "letterhead\n" * lines + "name;W\na;12\n"
    if found:
        assert numbers(read(tmp_path, text).sheets[0]) == {"W": 12.0}
    else:
        with pytest.raises(FileError, match="no header line"):
            read(tmp_path, text)


def test_the_cap_on_rows_counts_the_header(tmp_path: Path) -> None:
    file = tmp_path / "ten.csv"
    file.write_text("x,y\n" + "1,2\n" * 9)
    assert len(read_table(file, len, "x, y", max_rows=10).rows) == 9
    with pytest.raises(FileError, match="more than 9 rows"):
        read_table(file, len, "x, y", max_rows=9)


def test_two_fabrics_one_value_a_row(tmp_path: Path) -> None:
    result = read(tmp_path, "fabric,symbol,value\na,W,12\nb,W,20\na,B,0.1\nb,B,0.2\n")
    assert [(sheet.name, numbers(sheet)) for sheet in result.sheets] == [("a", {"W": 12.0, "B.mean": 0.1}), ("b", {"W": 20.0, "B.mean": 0.2})]


def test_texts_and_source(tmp_path: Path) -> None:
    result = read(tmp_path, "name,fibre,weave,source,W\na,wool,twill,KES lab of X,20\n,,,,21\n")
    assert [(s.name, s.fibre, s.weave, s.source) for s in result.sheets] == [("a", "wool", "twill", "KES lab of X"), ("lab-2", None, None, "lab.csv, line 3")]
    assert read_kes_csv(tmp_path / "lab.csv", source="mill").sheets[1].source == "mill"


def test_what_is_not_understood_is_reported(tmp_path: Path) -> None:
    text = "KES-FB report;2024\nname;W;B warp;B sd;DC %;B weft [lbf in]\na;12;0.1;0.01;80;3\nb;13;;;;\ncomment only;;;;;\n"
    result = read(tmp_path, text)
    assert [numbers(sheet) for sheet in result.sheets] == [{"W": 12.0, "B.warp": 0.1}, {"W": 13.0}]
    assert [(finding.severity, finding.key) for finding in result.findings] == [
        ("info", "line 1"),
        ("warning", "line 2, column 'B sd'"),
        ("warning", "line 2, column 'DC %'"),
        ("warning", "line 2, column 'B weft [lbf in]'"),
        ("warning", "line 5, the whole row"),
    ]
    assert "its 1 values are not used" in result.findings[1].message
    assert result.findings[3].message == "the unit 'lbf in' for B.weft; allowed are gf.cm2/cm, uN.m, mN.m; its 1 values are not used"


def test_rows_that_are_not_understood_are_reported(tmp_path: Path) -> None:
    result = read(tmp_path, "property;warp;weft;remark\nW;12;;\nKoshi;5.1;;\nB;0.1;0.08;\nShari;0.3;0.4;\nG [lbf];1;;\n")
    assert numbers(result.sheets[0]) == {"W": 12.0, "B.warp": 0.1, "B.weft": 0.08}
    keys = [finding.key for finding in result.findings]
    assert keys == ["line 1, column 'remark'", "line 3, warp of 'Koshi'", "line 5, warp of 'Shari'", "line 5, weft of 'Shari'", "line 6, warp of 'G [lbf]'"]
    assert result.findings[4].message == "the unit 'lbf' for G.warp; allowed are gf/(cm.deg), gf/(cm.degree), N/(m.deg), N/(m.rad), N/m; '1' is not used"


BAD = [
    pytest.param("", FileError, "no header line", id="empty"),
    pytest.param("hello,world\n1,2\n", FileError, "no header line", id="no header"),
    pytest.param("W\n12\n", FileError, "at least two known labels", id="one label"),
    pytest.param("name,W\n", FileError, "no fabric below the header on line 1", id="no rows"),
    pytest.param("name,W\na,nan\n", FabricError, "line 2, column 'W': 'nan' came for W", id="nan"),
    pytest.param("name,W\na,inf\n", FabricError, "'inf' came", id="inf"),
    pytest.param("name,W\na,-12\n", FabricError, "line 2: -12.0 mg/cm2 is impossible", id="negative"),
    pytest.param("name,W\na,118\n", FabricError, "divide g/m2 by 10", id="g/m2 as mg/cm2"),
    pytest.param("name,W\na,1e400\n", FabricError, "line 2", id="too large"),
    pytest.param("name,W,B\na,12,0.118 0.01\n", FabricError, "line 2, column 'B'", id="two numbers in a cell"),
    pytest.param("name,W,B\na,12,3 %\n", FabricError, "'3 %' came for B.mean", id="percent where none belongs"),
    pytest.param('name,W\na,"1.234,5"\n', FabricError, "decimal point or comma", id="thousands"),
    pytest.param("name,W,B\na,12,38,0,118\n", FileError, "line 2: 5 cells, but the header on line 1 has 3; decimal commas need", id="bare decimal commas"),
    pytest.param("name,W,weight g/m2\na,12,120\n", FabricError, "'W' and 'weight g/m2': both mean W", id="one value twice"),
    pytest.param("symbol,value\nW,12\nB,0.1\nW,13\n", FabricError, "line 4: W stands twice", id="one row twice"),
    pytest.param("symbol,unit,value\nW,oz/yd2,5\n", FileError, "line 2, column 'unit': the unit 'oz/yd2' for W; allowed are mg/cm2, g/m2, gsm", id="ounces"),
    pytest.param("symbol,unit,warp\nT0,mil,10\n", FileError, "line 2, column 'unit': the unit 'mil' for T0; allowed are mm, cm", id="mil"),
    pytest.param("symbol,unit,warp\nMIU,N,0.2\n", FileError, "the unit 'N' for MIU.warp; allowed are none", id="unit of a number"),
    pytest.param(
        "symbol,unit,value\nW (g/m2),mg/cm2,12\n",
        FileError,
        "line 2, column 'unit': 'mg/cm2' came for 'W (g/m2)', whose label has another unit",
        id="two units",
    ),
    pytest.param(
        "symbol;direction;warp;weft\nW;;12;\nB;weft;0.1;\n",
        FabricError,
        "line 3, column 'warp': warp came for 'B', which is of weft in this row",
        id="warp of weft",
    ),
    pytest.param(
        "symbol;warp;filling\nW;12;\nB warp;;0.1\n", FabricError, "line 3, column 'filling': weft came for 'B warp', which is of warp", id="weft of warp"
    ),
    pytest.param(
        "symbol;direction;value\nB1;weft;0.1\n", FabricError, "line 2, column 'direction': weft came for 'B1', which is of warp", id="label of the other"
    ),
    pytest.param(
        "symbol;direction;warp;mean\nW;;12;\nB;warp;0.1;0.2\n", FabricError, "line 3: B.warp stands twice for the same fabric", id="column and mean of warp"
    ),
    pytest.param(
        "symbol;warp;weft\nW;12;\nT0;0.3;0.31\n",
        FabricError,
        "line 3, column 'weft': 0.31 came for T0 after 0.3 on line 3; it is one number without directions",
        id="two thicknesses",
    ),
    pytest.param(
        "symbol;direction;value\nW;warp;12\nB;warp;0.1\nW;weft;13\n",
        FabricError,
        "line 4, column 'value': 13 came for W after 12 on line 2; it is one number without directions",
        id="two weights",
    ),
    pytest.param("symbol;direction;value\nW;warp;12\nW;warp;12\n", FabricError, "line 3: W stands twice", id="one weight twice"),
    pytest.param(
        "symbol;value\nname;a\nW;12\nname;b\n", FabricError, "line 4: 'b' came for name after 'a' on line 2; one is allowed for a fabric", id="two names"
    ),
    pytest.param("symbol;warp;weft\nfibre;silk;wool\nW;12;\n", FabricError, "line 2: 'wool' came for fibre after 'silk' on line 2", id="two fibres in a row"),
    pytest.param("fabric;symbol;value\na;W;12\na;name;b\n", FabricError, "line 3: 'b' came for name after 'a' on line 2", id="name of another fabric"),
    pytest.param("symbol;value\nW;12\nB;1e400\n", FabricError, "line 3: ", id="too large in a row of its own"),
    pytest.param("symbol,unit\nW,g\n", FileError, "no column of numbers", id="no numbers"),
    pytest.param('name,W\n"a,12\n', FileError, "not valid CSV", id="open quote"),
    pytest.param("name,W\na\0,12\n", FileError, "null characters", id="null"),
    pytest.param("name,W\n" + "a,12\n" * 6000, FileError, "more than 5000 rows", id="too many rows"),
]


@pytest.mark.parametrize(("text", "error", "words"), BAD)
def test_bad_files_are_refused(text: str, error: type[GarmentError], words: str, tmp_path: Path) -> None:
    with pytest.raises(error) as caught:
        read(tmp_path, text)
    assert words in str(caught.value)
    assert "lab.csv" in str(caught.value)


def test_folder_and_missing_file_are_refused(tmp_path: Path) -> None:
    for path in (tmp_path, tmp_path / "none.csv"):
        with pytest.raises(FileError):
            read_kes_csv(path)


def test_a_fabric_without_a_value_is_reported(tmp_path: Path) -> None:
    result = read(tmp_path, "name;property;warp;weft\nA;B;0.1;0.05\nB;T0;-;\nB;B;;\n")
    assert [sheet.name for sheet in result.sheets] == ["A"]
    assert [str(finding) for finding in result.findings] == ["warning: line 3, fabric 'B': no value in its rows; it is left out"]


def test_a_table_of_which_nothing_is_understood_says_why(tmp_path: Path) -> None:
    with pytest.raises(FileError, match=r"no fabric below the header on line 1; line 2, warp of 'Koshi': not understood; '11' is not used; line 2, weft"):
        read(tmp_path, "property;warp;weft\nKoshi;11;12\n")


def test_a_table_of_fast_values_says_what_makes_a_sheet_of_it(tmp_path: Path) -> None:
    by_value = read(tmp_path, "property;warp;weft\nB;0.1;0.05\nE5;0.2;0.4\nEB5;4;\nshine;1;\n")
    by_fabric = read(tmp_path, "name;B warp;E5 warp;C weft;shine\nx;0.1;0.2;15;1\n")
    for result, known in ((by_value, 3), (by_fabric, 2)):
        said = ["a FAST value, of which `garmentcad fabric fit` makes a sheet; " in finding.message for finding in result.findings]
        assert said == [True] * known + [False]


@pytest.mark.parametrize("head", ["warp;filling", "Warp;Weft", "wale;course"])
def test_what_laboratories_call_the_directions(head: str, tmp_path: Path) -> None:
    assert numbers(read(tmp_path, f"property;{head}\nW;;\nB;0.1;0.05\n").sheets[0]) == {"B.warp": 0.1, "B.weft": 0.05}


@pytest.mark.parametrize("column", ["value", "mean", "average"])
def test_the_direction_of_a_row_is_that_of_its_number(column: str, tmp_path: Path) -> None:
    text = f"property;direction;unit;{column};sd\nW;;g/m2;168;2\nB;warp;gf.cm2/cm;0.09;0.01\nB;weft;gf.cm2/cm;0.05;\nG 2;;;0.6;\nG;warp;;0.5;\nG 1;warp;;;\n"
    result = read(tmp_path, text + "2HG;-;;1;\n")
    assert numbers(result.sheets[0]) == {"W": 16.8, "B.warp": 0.09, "B.weft": 0.05, "G.warp": 0.5, "G.weft": 0.6, "2HG.mean": 1.0}
    assert [str(finding) for finding in result.findings] == ["warning: line 1, column 'sd': not understood; its 2 values are not used"]


def test_a_direction_that_a_value_does_not_have_is_reported(tmp_path: Path) -> None:
    result = read(tmp_path, "property;direction;value\nW;both;12\nB;diagonal;0.1\nEMT;bias;3\n")
    assert numbers(result.sheets[0]) == {"W": 12.0}
    assert [str(finding) for finding in result.findings] == [
        "warning: line 3, value of 'B': the direction 'diagonal' for B; allowed are warp, weft, bias, mean; '0.1' is not used",
        "warning: line 4, value of 'EMT': the direction 'bias' for EMT; allowed are warp, weft, mean; '3' is not used",
    ]


def test_a_value_of_the_whole_fabric_under_both_directions_is_taken_once(tmp_path: Path) -> None:
    for text in ("property;warp;weft\nW;12;12,0\nT0 warp;0.3;\nT0;;0.3\n", "property;direction;value\nW;warp;12\nT0;;0.3\nW;weft;12\n"):
        result = read(tmp_path, text)
        assert numbers(result.sheets[0]) == {"W": 12.0, "T0": 0.3}
        assert result.findings == ()
    (finding,) = read(tmp_path, "name;W;T0 warp\na;12;0.3\n").findings
    assert str(finding) == "warning: line 1, column 'T0 warp': T0 is one number without directions; its 1 values are not used"


def test_numbers_under_a_blank_header_are_reported(tmp_path: Path) -> None:
    result = read(tmp_path, "property;unit;warp;weft;;\nW;g/m2;168;;;\nB;uN.m;9,0;5,8;7,4;\n")
    assert [str(finding) for finding in result.findings] == ["warning: line 1, column '': not understood; its 1 values are not used"]


def test_a_number_where_the_unit_belongs_is_reported(tmp_path: Path) -> None:
    (finding,) = read(tmp_path, "property;unit;warp;weft\nW;mg/cm2;19;\nLT;0.6;;\nB;;0.06;0.05\nG;gf/(cm.deg);-;-\n").findings
    assert (finding.key, finding.message) == ("line 3, unit of 'LT'", "the number 0.6 stands where its unit belongs; it is not used")


def test_a_text_may_stand_in_any_column(tmp_path: Path) -> None:
    text = "property;direction;unit;warp;weft\nname;;Linen plain;;\nfibre;linen;;;\nweave;;-;;plain\nsource;;text;mill;mill\nW;;g/m2;168;\n"
    (sheet,) = read(tmp_path, text).sheets
    assert (sheet.name, sheet.fibre, sheet.weave, sheet.source) == ("Linen plain", "linen", "plain", "mill")


def test_a_unit_in_the_label_and_in_its_column(tmp_path: Path) -> None:
    text = "property;unit;value\nW (g/m2);g/m²;168\nBending rigidity B (uN.m) warp;µN·m;9.80665\nT0 [mm];;0.3\n2HB (gf.cm/cm);-;0.1\n"
    assert numbers(read(tmp_path, text).sheets[0]) == {"W": 16.8, "T0": 0.3, "B.warp": 0.1, "2HB.mean": 0.1}


def test_each_value_has_the_line_where_it_stands(tmp_path: Path) -> None:
    text = "property;warp;weft\nW;12;\nB;0.1;0.05\nT0;0.3;\n"
    (sheet,) = read(tmp_path, text).sheets
    assert [sheet.origin(key) for key in ("W", "B.warp", "B.weft", "T0")] == [f"lab.csv, line {line}" for line in (2, 3, 3, 4)]
    assert {read_kes_csv(tmp_path / "lab.csv", source="mill").sheets[0].origin(key) for key in ("W", "B.warp", "T0")} == {"mill"}
    (sheet,) = read(tmp_path, text + "source;the mill;\n").sheets
    assert {sheet.origin(key) for key in ("W", "B.warp", "T0")} == {"the mill"}
