"""Fabric files: what is read is what is written; every class of bad input is refused with file, key path and what is allowed."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from garmentcad.errors import FabricError, FileError, GarmentError
from garmentcad.fabric.missing import complete
from garmentcad.fabric.sheet import CalibratedLaw, sheet_from
from garmentcad.io.fabric_file import fabric_names, fabric_path, load_fabric, read_fabric, write_fabric, write_law
from garmentcad.io.yaml_file import parse_yaml

GOOD = """\
schema: 1
name: my-poplin
source: our laboratory
W: 11.8
EMT: {warp: 3.5, weft: 7}
B:
  warp: {value: 0.1, source: the mill}
  weft: {value: 0.064, estimate: "0.64 B.warp"}
2HB: 0.1
T0:
"""


def test_a_fabric_is_read_by_its_name_and_from_a_laboratory(tmp_path: Path) -> None:
    assert read_fabric("wool-suiting") == read_fabric(fabric_path("wool-suiting")) == read_fabric(str(fabric_path("wool-suiting")))
    assert load_fabric("wool-suiting") == load_fabric(fabric_path("wool-suiting"))
    with pytest.raises(FileError, match="did you mean 'wool-suiting'"):
        read_fabric("wol-suiting")
    path = tmp_path / "lab.csv"
    path.write_text("name,W,T0,EMT-1,EMT-2,B-1,B-2\npoplin,11.8,0.5,3.5,7,0.1,0.064\n")
    assert read_fabric(path).name == "poplin"
    path.write_text(path.read_text() + "twill,11.8,0.5,3.5,7,0.1,0.064\n")
    with pytest.raises(FabricError, match="2 fabrics came"):
        read_fabric(path)


BAD = [
    pytest.param("W: 11.8", "W: 118", "W", "divide g/m2 by 10", id="g/m2"),
    pytest.param("W: 11.8", "W: .nan", None, "line 4", id="nan"),
    pytest.param("W: 11.8", "W: -1", "W", "impossible", id="negative"),
    pytest.param("W: 11.8", "W: 1,18", "W.value", "'1,18' came", id="decimal comma"),
    pytest.param("W: 11.8", "W: yes", "W.value", "'yes' came", id="word"),
    pytest.param("W: 11.8", "W: 11.8\nW: 12", None, "line 5: key 'W' stands twice, first on line 4", id="twice"),
    pytest.param("EMT:", "EMTT:", "EMTT", "did you mean 'EMT'", id="unknown key"),
    pytest.param("warp: 3.5", "wrap: 3.5", "EMT.wrap", "did you mean 'warp'", id="unknown direction"),
    pytest.param("warp: 3.5", "warp: 0.035", "EMT.warp", "percent", id="fraction"),
    pytest.param("source: our laboratory\n", "", "W", "no source", id="no source"),
    pytest.param("schema: 1\n", "", "schema", "required", id="no schema"),
    pytest.param("W: 11.8\n", "", "W", "nothing can stand in", id="no weight"),
    pytest.param("EMT: {warp: 3.5, weft: 7}", "LT: {warp: 0.7}\nEMT: {warp: 3.5}\nWT: {warp: 9}", "WT.warp", "at most 3 %", id="contradiction"),
    pytest.param(GOOD, "- 1\n- 2\n", None, "a mapping of keys to values; list came", id="list"),
    pytest.param(GOOD, "", None, "empty", id="empty"),
]


@pytest.mark.parametrize(("old", "new", "key", "words"), BAD)
def test_bad_file_is_refused_with_its_place(old: str, new: str, key: str | None, words: str, tmp_path: Path) -> None:
    file = tmp_path / "cloth.yaml"
    assert old in GOOD
    file.write_text(GOOD.replace(old, new))
    with pytest.raises(GarmentError) as caught:
        load_fabric(file)
    assert isinstance(caught.value, FabricError | FileError)
    assert caught.value.file == str(file)
    assert words in str(caught.value)
    if key is not None:
        assert caught.value.key == key


def test_what_is_lost_of_a_table_is_said(tmp_path: Path) -> None:
    """By a warning where a sheet is read as it is, and in the refusal of one that lost what it needs."""
    file = tmp_path / "cloth.csv"
    file.write_text("name;W (g/m2);B warp (g.cm2/cm);B weft (gf.cm2/cm)\nx;118;0.09;0.06\n")
    with pytest.warns(UserWarning, match="B warp") as told:
        assert "B.warp" not in read_fabric(file).values()
    assert len(told) == 1
    file.write_text("name;W (oz/yd2);B warp;B weft\nx;3.5;0.09;0.06\n")
    with pytest.raises(FabricError, match=r"mass per area is missing.*; line 1, column 'W \(oz/yd2\)'"):
        load_fabric(file)


def test_good_file(tmp_path: Path) -> None:
    file = tmp_path / "cloth.yaml"
    file.write_text(GOOD)
    sheet = read_fabric(file)
    assert {key: value.value for key, value in sheet.values().items()} == {
        "W": 11.8, "EMT.warp": 3.5, "EMT.weft": 7.0, "B.warp": 0.1, "B.weft": 0.064, "2HB.mean": 0.1,
    }  # fmt: skip
    assert sheet.origin("B.warp") == "the mill"
    done = load_fabric(file)
    assert done.sheet.number("T0") == pytest.approx(0.295)
    assert "T0" in done.assumed


def test_written_files_read_back_equal(tmp_path: Path) -> None:
    hard = sheet_from(
        {
            "schema": 1,
            "name": "null",
            "description": 'two\nlines: "quoted" # and more\n',
            "sources": {"1999": "a: b", "true": "- c", "K 16": "née µ €", "value": "v"},
            "W": {"value": 11.8, "source": "1999"},
            "MIU": {"value": 1e-1, "estimate": "yes"},
            "B": {"warp": {"value": 0.0005, "source": "value"}},
            "law": {"sheet_sha256": "0" * 64, "values": {"B.warp": 0.1, "W": 12.0}},
        }
    )
    for sheet in (hard, load_fabric(fabric_path("denim")).sheet, *(read_fabric(fabric_path(name)) for name in fabric_names())):
        assert read_fabric(write_fabric(sheet, tmp_path / "copy.yaml")) == sheet


def test_names_and_files(tmp_path: Path) -> None:
    assert fabric_path("wool-suiting").name == "wool-suiting.yaml"
    assert fabric_path(str(tmp_path / "a.yaml")) == tmp_path / "a.yaml"
    with pytest.raises(FileError, match="did you mean 'wool-suiting'"):
        fabric_path("wool-suting")
    with pytest.raises(FileError, match="no such file"):
        read_fabric(tmp_path / "none.yaml")


def test_a_csv_file_of_one_fabric_is_a_fabric(tmp_path: Path) -> None:
    file = tmp_path / "lab.csv"
    file.write_text("name;W;B;DC\nbroad;12,38;0,118;82,9\n")
    done = load_fabric(fabric_path(str(file)))
    assert done.sheet.number("B.weft") == 0.118
    assert [finding.key for finding in done.findings[:2]] == ["line 1, column 'DC'", "Fm"]
    file.write_text("name;W;B\na;12;0,1\nb;13;0,1\n")
    with pytest.raises(FabricError, match=r"2 fabrics came \(a, b\)"):
        load_fabric(file)
    file.write_text("name;B;G\na;0,1;1\n")
    with pytest.raises(FabricError, match=r"lab\.csv: W: the mass per area is missing"):
        load_fabric(file)


@pytest.mark.parametrize("page", ["fabric.md", "howto/add-a-fabric.md"])
def test_sheets_in_the_docs_are_accepted(page: str) -> None:
    text = (Path(__file__).resolve().parent.parent / "docs" / page).read_text(encoding="utf-8")
    blocks = [block for block in re.findall(r"```yaml\n(.*?)```", text, re.DOTALL) if "schema:" in block]
    assert blocks
    for block in blocks:
        assert complete(sheet_from(parse_yaml(block, page))).sheet.number("MIU.mean") > 0


LAW = CalibratedLaw(sheet_sha256="0" * 64, values={"G.warp": 0.61})
ROOM = "schema: 1\nname: x\nsource: our laboratory\nW: 12\n"
OLD = f"{{sheet_sha256: {'a' * 64}, values: {{B.warp: 0.1}}}}"


@pytest.mark.parametrize(
    ("text", "kept"),
    [
        (ROOM, ROOM),
        (f"{ROOM}law: {OLD}\n# said below\nT0: 0.3\n", f"{ROOM}# said below\nT0: 0.3\n"),
        (f"{ROOM}law:\n  # said inside\n  sheet_sha256: {'a' * 64}\n  values: {{B.warp: 0.1}}\nT0: 0.3\n", f"{ROOM}  # said inside\nT0: 0.3\n"),
        (f'{ROOM}"law": {OLD}\n', ROOM),
        (f"{ROOM}law : {OLD}\n", ROOM),
        (ROOM.replace("\n", "\r\n"), ROOM.replace("\n", "\r\n")),
    ],
    ids=["none", "in one line", "in lines", "in quotes", "with a blank", "windows line ends"],
)
def test_a_law_goes_below_every_line_that_was_typed(text: str, kept: str, tmp_path: Path) -> None:
    path, link = tmp_path / "mine.yaml", tmp_path / "link.yaml"
    path.write_bytes(text.encode())
    path.chmod(0o600)
    link.symlink_to(path)
    write_law(link, LAW)
    assert link.is_symlink()
    assert path.stat().st_mode & 0o777 == 0o600
    assert path.read_bytes().startswith(kept.encode())
    ends = path.read_bytes().count(b"\r\n")
    assert ends == (path.read_bytes().count(b"\n") if "\r\n" in text else 0)
    assert read_fabric(path).law == LAW


@pytest.mark.parametrize(
    "text",
    ["{schema: 1, name: x, source: a, W: 12}\n", "{schema: 1,\nname: x, source: a,\nW: 12}\n", " schema: 1\n name: x\n source: a\n W: 12\n",
     "schema: 1\nname: x\nsource: a\nW: 12\n...\n", 'schema: 1\nname: x\nsource: "a\nlaw: of the land"\nW: 12\n'],
    ids=["flow", "flow over lines", "indented", "end of document", "text over lines"],
)  # fmt: skip
def test_a_law_that_lines_cannot_hold_leaves_the_file_as_it_was(text: str, tmp_path: Path) -> None:
    path = tmp_path / "mine.yaml"
    path.write_text(text)
    read_fabric(path)
    with pytest.raises(FileError, match="no room for a law"):
        write_law(path, LAW)
    assert path.read_text() == text


def test_characters_that_yaml_takes_for_line_ends_come_back(tmp_path: Path) -> None:
    odd = sheet_from({"schema": 1, "name": "a\x85b\u2028c\x7f\ufeffd", "source": "value", "W": 12, "sources": {"value": "a\x9fb"}})
    assert read_fabric(write_fabric(odd, tmp_path / "odd.yaml")) == odd
