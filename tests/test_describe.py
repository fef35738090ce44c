"""The table that `garmentcad fabric show` prints."""

from __future__ import annotations

from garmentcad.fabric.describe import sheet_lines
from garmentcad.fabric.missing import FILLED, complete
from garmentcad.fabric.sheet import sheet_from


def test_every_value_has_unit_origin_and_what_was_noticed() -> None:
    lines = {line.key: line for line in sheet_lines(complete(sheet_from({"schema": 1, "name": "x", "source": "lab", "W": 70, "B": {"warp": 0.1}, "LC": 0.3})))}
    assert set(lines) == set(FILLED) | {"LC"}
    assert (lines["W"].unit, lines["W"].origin, lines["W"].assumed) == ("mg/cm2", "lab", False)
    assert "outside the usual" in lines["W"].finding
    assert lines["B.weft"].assumed
    assert lines["B.weft"].origin == "estimate: 0.64 B.warp"
    assert lines["B.weft"].finding.startswith("warning: missing")
    assert all(line.origin and line.unit and line.meaning for line in lines.values())
