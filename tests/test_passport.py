"""The fabric passport: its figures beside the sheet, and its page beside its figures."""

from __future__ import annotations

import json
from html.parser import HTMLParser
from pathlib import Path

import pytest
from test_cantilever import slid_by_shooting

from garmentcad.export.report import report_json
from garmentcad.io.fabric_file import fabric_path, load_fabric
from garmentcad.rigs.passport import Passport, make_passport
from garmentcad.rigs.passport_page import write_page

SHEET = load_fabric(fabric_path("wool-suiting")).sheet


@pytest.fixture(scope="module")
def passport() -> Passport:
    return make_passport(SHEET, 12.5, lays=0)


class Text(HTMLParser):
    """What a reader of a page sees, and how many curves it has."""

    def __init__(self) -> None:
        super().__init__()
        self.seen, self.curves = "", 0

    def handle_data(self, data: str) -> None:
        self.seen += data + " "

    def handle_starttag(self, tag: str, attrs: object) -> None:
        self.curves += tag == "polyline"


def test_the_testers_print_the_sheet(passport: Passport) -> None:
    """At 12.5 mm, the coarsest that is allowed."""
    for key, row in passport.figures["kes"].items():
        given = SHEET.get(key)
        assert row["input"] == (None if given is None else given.value)
        assert abs(row["error_percent"]) < (5.0 if key == "B.bias" else 2.0), key


def test_the_cantilever_prints_the_elastica_of_the_sheet(passport: Passport) -> None:
    figures, values = passport.figures["cantilever"], SHEET.values()
    weight = 9.81 * 1e-2 * values["W"].value
    for way in ("warp", "weft"):
        stiffness, holds = 9.80665e-5 * values[f"B.{way}"].value, 0.5 * 9.80665e-3 * values[f"2HB.{way}"].value
        c = (stiffness / weight) ** (1 / 3)
        assert figures[way]["overhang_mm"] == pytest.approx(1e3 * c * slid_by_shooting(holds * c / stiffness, 0.0125), rel=0.02)
        assert figures[way]["bending_length_mm"] == 0.5 * figures[way]["overhang_mm"]
        assert figures[way]["without_friction_mm"] == pytest.approx(1e3 * c, rel=1e-3)


def test_the_page_says_what_the_figures_say(passport: Passport, tmp_path: Path) -> None:
    figures = json.loads(report_json(passport.figures))
    assert figures == json.loads(json.dumps(passport.figures))
    assert figures["drape"] is None
    text = Text()
    text.feed(write_page(tmp_path / "passport.html", passport).read_text(encoding="utf-8"))
    for row in figures["kes"].values():
        assert f"{row['simulated']:.4g}" in text.seen
    for way in ("warp", "weft"):
        assert f"{way} {figures['cantilever'][way]['bending_length_mm']:.1f} mm" in text.seen
    assert text.curves >= 2 * len(passport.records), "of each tester the sheet's curve and the record"
    assert "Drapemeter" not in text.seen
