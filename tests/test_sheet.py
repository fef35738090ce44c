"""KES sheets: what is accepted, what is refused and in which words, and that writing and reading keep every number."""

from __future__ import annotations

from typing import Any

import pytest

from garmentcad.errors import FabricError
from garmentcad.fabric.quantity import KEYS, QUANTITIES, quantity_of
from garmentcad.fabric.sheet import CalibratedLaw, KesSheet, KesValue, is_calibrated, sheet_data, sheet_from, sheet_sha256

BASE: dict[str, Any] = {"schema": 1, "name": "x", "source": "our laboratory"}

REFUSED = [
    pytest.param({"W": float("nan")}, "W.value", "finite number", id="nan"),
    pytest.param({"W": float("inf")}, "W.value", "finite number", id="inf"),
    pytest.param({"W": "118 g"}, "W.value", "'118 g' came", id="text for a number"),
    pytest.param({"W": "1.5"}, "W.value", "finite number", id="number in quotes"),
    pytest.param({"W": True}, "W.value", "True came", id="yes for a number"),
    pytest.param({"W": [12]}, "W.value", "finite number", id="list for a number"),
    pytest.param({"W": -3.0}, "W", "-3.0 mg/cm2 is impossible", id="negative"),
    pytest.param({"W": 118.0}, "W", "divide g/m2 by 10", id="g/m2 for mg/cm2"),
    pytest.param({"T0": 300}, "T0", "millimetres", id="micrometres for mm"),
    pytest.param({"EMT": {"warp": 0.05}}, "EMT.warp", "percent", id="fraction for percent"),
    pytest.param({"RT": {"weft": 0.6}}, "RT.weft", "percent", id="fraction for percent RT"),
    pytest.param({"B": {"warp": 100.0}}, "B.warp", "98.07 uN.m", id="B in uN.m"),
    pytest.param({"B": {"warp": 0}}, "B.warp", "impossible", id="B of nothing"),
    pytest.param({"Bb": {"warp": 1}}, "Bb", "did you mean 'B'", id="unknown key"),
    pytest.param({"2HG_5": 1}, "2HG_5", "did you mean '2HG5'", id="near key"),
    pytest.param({"B": {"wrap": 0.1}}, "B.wrap", "did you mean 'warp'", id="unknown direction"),
    pytest.param({"EMT": {"bias": 4}}, "EMT.bias", "Allowed: mean, warp, weft", id="no such direction"),
    pytest.param({"W": {"value": 12, "sorce": "me"}}, "W.sorce", "did you mean 'source'", id="unknown word in a value"),
    pytest.param({"B": {"warp": {"source": "me"}}}, "B.warp.value", "missing", id="value without number"),
    pytest.param({"W": {"value": 12, "source": "a", "estimate": "b"}}, "W", "not both", id="measured and estimated"),
    pytest.param({"W": {"value": 12, "estimate": None}}, "W", "`estimate` is empty; give the rule", id="estimated by no rule"),
    pytest.param({"source": None, "W": 12}, "W", "no source", id="no source"),
    pytest.param({"sources": {"MAT15": "..."}, "W": {"value": 12, "source": "MAT51"}}, "W", "did you mean 'MAT15'", id="unknown source"),
    pytest.param({"schema": 2}, "schema", "2 came", id="schema"),
    pytest.param({"schema": True}, "schema", "'true' came", id="schema of a truth"),
    pytest.param({"name": 7}, "name", "7 came", id="name"),
    pytest.param({"law": {"sheet_sha256": "0" * 64, "values": {"B": 0.1}}}, "law.values.B", "'B'", id="law without direction"),
    pytest.param({"law": {"sheet_sha256": "0" * 64, "values": {"G.warp": float("nan")}}}, "law.values.G.warp", "nan", id="law nan"),
    pytest.param({"T0": {"warp": 0.3}}, "T0.warp", "unknown key 'warp'; T0 has no directions, it is one number in mm. Allowed: estimate", id="direction of T0"),
    pytest.param({"2hg": 0.9}, "2hg", "did you mean '2HG'?", id="small letters"),
    pytest.param({"HG": 0.9}, "HG", "did you mean '2HG'?", id="name inside the program"),
    pytest.param({"W": "11,8"}, "W.value", "'11,8' came; a finite number in mg/cm2 is allowed; numbers have a decimal point", id="decimal comma"),
    pytest.param({"B": "9 uN.m/m"}, "B", "a finite number in gf.cm2/cm (the mean) or a mapping with the keys warp, weft, bias, mean is allowed", id="unit"),
    pytest.param({"EMT": {"warp": "5 %"}}, "EMT.warp.value", "in % is allowed; numbers have a decimal point, and neither unit nor quotes", id="percent sign"),
    pytest.param({"MIU": [0.1, 0.2]}, "MIU", "a finite number (the mean) or a mapping", id="list for directions"),
    pytest.param({"B": {"value": 9, "unit": "uN.m"}}, "B.mean.unit", "unknown key 'unit'; B is always in gf.cm2/cm", id="key unit"),
    pytest.param({"T0 [mm]": 0.3}, "T0 [mm]", "; the key is T0 alone, its number always in mm. Allowed", id="unit in the key"),
    pytest.param({"emt_warp": 3}, "emt_warp", "the key is EMT alone, its number always in %, directions below it", id="direction in the key"),
    pytest.param({"warp": {"B": 0.1}}, "warp", "directions stand below a value", id="direction first"),
    pytest.param({"B": {"value": 0.1, "warp": 0.2}}, "B.value", "Allowed: bias, mean, warp, weft", id="value beside directions"),
    pytest.param({"shear_window_deg": 3}, "shear_window_deg", "3 came; a rising pair from 0.5 to 8 is allowed, such as [0.5, 2.5]", id="window of one"),
    pytest.param({"shear_window_deg": [0, 5, 2, 5]}, "shear_window_deg", "a rising pair", id="window with decimal commas"),
    pytest.param({"shear_window_deg": [True, 2]}, "shear_window_deg.0", "True came; a rising pair", id="yes in a window"),
    pytest.param({"shear_window_deg": ["0.5", 2]}, "shear_window_deg.0", "'0.5' came; a rising pair", id="window in quotes"),
    pytest.param({"sources": "lab"}, "sources", "'lab' came; a mapping of short names to citations is allowed", id="one source"),
    pytest.param({"W": {"value": 12, "source": 2024}}, "W.source", "2024 came; a text is allowed, a number in quotes", id="year for a source"),
    pytest.param({"source": ""}, "source", "a text that is not empty", id="empty source"),
    pytest.param({"description": None}, "description", "nothing came; a text", id="no text"),
    pytest.param({"law": {"sheet_sha256": "0" * 64, "values": {"b.warp": 1}}}, "law.values.b.warp", "did you mean 'B.warp'?", id="law in small letters"),
    pytest.param({"law": {"sheet_sha256": "0" * 64, "values": {"B.warp": True}}}, "law.values.B.warp", "True came; a finite number", id="law yes"),
    pytest.param({"law": {"sheet_sha256": "0" * 64, "values": [1]}}, "law.values", "a mapping of keys of the sheet to numbers", id="law list"),
    pytest.param({"law": {}}, "law.sheet_sha256", "missing", id="law without hash"),
]


@pytest.mark.parametrize(("change", "key", "words"), REFUSED)
def test_refused(change: dict[str, Any], key: str, words: str) -> None:
    with pytest.raises(FabricError) as caught:
        sheet_from({**BASE, **change}, "cloth.yaml")
    assert (caught.value.file, caught.value.key) == ("cloth.yaml", key)
    assert words in str(caught.value)
    assert str(caught.value).startswith(f"cloth.yaml: {key}: ")


@pytest.mark.parametrize("data", [None, [], "W: 12", 3])
def test_something_else_than_a_mapping_is_refused(data: Any) -> None:
    with pytest.raises(FabricError, match="a mapping of keys to values"):
        sheet_from(data)


def test_a_number_stands_for_the_mean_and_takes_the_source_of_the_sheet() -> None:
    sheet = sheet_from({**BASE, "W": 12, "B": 0.118, "MIU": {"value": 0.2, "estimate": "guess"}, "2HG": {"warp": 1, "weft": {"value": 2, "source": "mill"}}})
    assert sheet.number("B.mean") == 0.118
    assert sheet.get("B.warp") is None
    assert [sheet.origin(key) for key in ("W", "MIU.mean", "2HG.warp", "2HG.weft", "T0")] == ["our laboratory", "estimate: guess", "our laboratory", "mill", ""]
    with pytest.raises(FabricError, match="no value; complete the sheet first"):
        sheet.number("G.warp")
    with pytest.raises(FabricError, match="needs a direction"):
        sheet.number("G")


def test_a_value_that_was_left_blank_is_a_gap() -> None:
    assert sheet_from({**BASE, "W": 12, "T0": None, "B": None, "EMT": {"warp": None}}) == sheet_from({**BASE, "W": 12})


def test_short_source_names_are_written_out() -> None:
    sheet = sheet_from({"schema": 1, "name": "x", "sources": {"MAT15": "Matsudaira 2015"}, "W": {"value": 12, "source": "MAT15"}})
    assert sheet.origin("W") == "Matsudaira 2015"


def test_plain_data_round_trip_of_every_key() -> None:
    data: dict[str, Any] = {**BASE, "description": "d", "shear_window_deg": [0.5, 5.0]}
    for key in KEYS:
        name, _, way = key.partition(".")
        number = sum(QUANTITIES[name].usual) / 2
        entry = {"value": number, "source": f"who measured {key}", "note": "n"}
        if way:
            data.setdefault(name, {})[way] = entry
        else:
            data[name] = entry
    sheet = sheet_from(data)
    assert list(sheet.values()) == list(KEYS)
    assert sheet_from(sheet_data(sheet)) == sheet
    assert sheet_data(sheet) == data


def test_with_values_replaces_and_refuses() -> None:
    sheet = sheet_from({**BASE, "W": 12, "B": {"warp": 0.1}})
    changed = sheet.with_values({"B.warp": KesValue(value=0.2), "B.bias": KesValue(value=0.3, estimate="e"), "W": KesValue(value=13.0)})
    assert {key: value.value for key, value in changed.values().items()} == {"W": 13.0, "B.warp": 0.2, "B.bias": 0.3}
    assert sheet.number("B.warp") == 0.1
    with pytest.raises(FabricError, match="impossible"):
        sheet.with_values({"W": KesValue(value=1000.0)})
    with pytest.raises(FabricError, match="is not a value of a KES sheet"):
        sheet.with_values({"Q": KesValue(value=1.0)})
    with pytest.raises(FabricError, match=r"B.warp: 0.5 came, of the type float; a KesValue\(value=...\)"):
        sheet.with_values({"B.warp": 0.5})  # type: ignore[dict-item]


def test_a_copy_with_other_numbers_has_no_law_values() -> None:
    sheet = sheet_from({**BASE, "W": 12})
    sheet = sheet.model_copy(update={"law": CalibratedLaw(sheet_sha256=sheet_sha256(sheet), values={"G.warp": 0.5})})
    assert sheet.with_values({"W": KesValue(value=12.0, source="the mill")}).law == sheet.law
    assert sheet.with_values({"W": KesValue(value=13.0)}).law is None
    assert sheet.with_values({"T0": KesValue(value=0.4)}).law is None


def test_hash_sees_numbers_only() -> None:
    sheet = sheet_from({**BASE, "W": 12})
    same = sheet_from({**BASE, "name": "y", "source": "another", "W": {"value": 12.0, "estimate": "e"}})
    assert sheet_sha256(sheet) == sheet_sha256(same)
    assert sheet_sha256(sheet) != sheet_sha256(sheet_from({**BASE, "W": 12.000001}))
    law = {"sheet_sha256": sheet_sha256(sheet), "values": {"W": 12.5}}
    assert is_calibrated(sheet_from({**BASE, "W": 12, "law": law}))
    assert not is_calibrated(sheet_from({**BASE, "W": 13, "law": law}))
    assert not is_calibrated(sheet)


def test_ranges_are_nested_and_keys_unique() -> None:
    for quantity in QUANTITIES.values():
        assert quantity.possible[0] <= quantity.usual[0] < quantity.usual[1] <= quantity.possible[1], quantity.name
    assert len(set(KEYS)) == len(KEYS)
    with pytest.raises(FabricError, match="has no direction 'up'"):
        quantity_of("B.up")


def test_pydantic_door_raises_the_same_words() -> None:
    with pytest.raises(ValueError, match="divide g/m2 by 10"):
        KesSheet.model_validate({**BASE, "W": 118})


@pytest.mark.parametrize("window", [[2.5, 2.5], [2.5, 0.5], [-1.0, 1.0], [0.4, 2.5], [0.5, 100.0]])
def test_a_window_outside_the_tester_is_refused(window: list[float]) -> None:
    with pytest.raises(FabricError, match=r"from 0\.5 to 8 is allowed") as caught:
        sheet_from({**BASE, "W": 12, "shear_window_deg": window})
    assert caught.value.key == "shear_window_deg"


def test_a_calibration_belongs_to_its_window() -> None:
    usual, wider = (sheet_sha256(sheet_from({**BASE, "W": 12, "shear_window_deg": window})) for window in ([0.5, 2.5], [0.5, 5.0]))
    assert usual == sheet_sha256(sheet_from({**BASE, "W": 12})) != wider
