"""Assertions: what holds, what fails, and what is refused before anything is draped. Reports are made up."""

from __future__ import annotations

import math

import pytest

from garmentcad.errors import SpecError
from garmentcad.export.report import blank_report
from garmentcad.pattern.garment_test import Expected, Tolerance
from garmentcad.regression.assertion import expected_text, holds, judge, means, refuse_unknown_keys, values_at

REPORT = {
    "status": "converged",
    "self_intersections": 0,
    "mannequin_intersections": 2,
    "uncalibrated": True,
    "hem_height_mm": 612.4,
    "waist_drop_mm": None,
    "ease_mm": {"bust": None, "waist": 21.9, "hip": 85.0},
    "strain_percent": {"warp": {"p99": 0.6, "max": 3.0}, "weft": {"p99": 0.9, "max": 2.0}},
}


@pytest.mark.parametrize(
    ("value", "wanted", "passes"),
    [
        (612.4, Tolerance(value=612, tol=0.5), True),
        (612.5, Tolerance(value=612, tol=0.5), True),
        (611.5, Tolerance(value=612, tol=0.5), True),
        (612.6, Tolerance(value=612, tol=0.5), False),
        (611.4, Tolerance(value=612, tol=0.5), False),
        (None, Tolerance(value=612, tol=1e9), False),
        (True, Tolerance(value=1, tol=1), False),
        ("612", Tolerance(value=612, tol=1), False),
        (15, (15, 25), True),
        (25.0, (15, 25), True),
        (25.001, (15, 25), False),
        (14.999, (15, 25), False),
        (-1e9, (None, 25), True),
        (26, (None, 25), False),
        (1e9, (15, None), True),
        (14, (15, None), False),
        (None, (None, 25), False),
        (0, 0, True),
        (0.0, 0, True),
        (1, 0, False),
        (True, 1, False),
        (1, True, False),
        (True, True, True),
        ("converged", "converged", True),
        ("max_time", "converged", False),
        (None, None, True),
        (0, None, False),
        (None, "*", False),
        (0, "*", True),
    ],
)
def test_holds(value: object, wanted: Expected, passes: bool) -> None:
    assert holds(value, wanted) is passes


def test_every_value_of_a_wildcard_is_judged_and_what_was_not_measured_left_out() -> None:
    verdicts = judge(REPORT, {"ease_mm.*": (20, 60), "*_intersections": 0, "strain_percent.*.p99": (None, 1)})
    assert [(verdict.key, verdict.passed) for verdict in verdicts] == [
        ("ease_mm.waist", True),
        ("ease_mm.hip", False),
        ("self_intersections", True),
        ("mannequin_intersections", False),
        ("strain_percent.warp.p99", True),
        ("strain_percent.weft.p99", True),
    ]


def test_a_mean_over_reports_wants_a_number_in_each() -> None:
    assert means([{"a": 1.0, "b": 1}, {"a": 4.0, "b": None}, {"a": 10.0, "b": 2}], "*") == {"a": 5.0, "b": None}
    assert means([{"a": True}, {"a": 3}], "a") == {"a": None}
    assert means([{"a": "converged"}], "a") == {"a": "converged"}


def test_a_value_that_is_not_there_fails() -> None:
    """A garment that no longer reaches the hip, and a wildcard under which nothing was measured."""
    fell = REPORT | {"ease_mm": dict.fromkeys(("bust", "waist", "hip"))}
    for key in ("ease_mm.waist", "ease_mm.*", "ease_mm.chest", "fit.hip"):
        (verdict,) = judge(fell, {key: (0, 1000)})
        assert not verdict.passed
        assert verdict.came in ("not measured", "no such value")
    assert values_at(REPORT, "ease_mm.bust") == {"ease_mm.bust": None}


def test_texts_that_people_read() -> None:
    assert expected_text(Tolerance(value=612.123456, tol=4.999)) == "612.123 ± 5"
    assert expected_text((15, 25)) == "15 to 25"
    assert expected_text((None, 25)) == "at most 25"
    assert expected_text((15.5, None)) == "at least 15.5"
    (verdict,) = judge(REPORT, {"waist_drop_mm": Tolerance(value=5, tol=1)})
    assert (verdict.expected, verdict.came) == ("5 ± 1", "not measured")
    (verdict,) = judge({"warnings": ["x" * 500]}, {"warnings": "*"})
    assert len(verdict.came) <= 80


@pytest.mark.parametrize(
    ("key", "says"),
    [
        ("hem_hight_mm", "did you mean 'hem_height_mm'"),
        ("ease_mm.wist", "there is no 'wist' in ease_mm; did you mean 'waist'"),
        ("*ease_mm.wist", "there is no 'wist' in *ease_mm; did you mean 'waist'"),
        ("hem_height_mm.mean", "there is no 'mean' in hem_height_mm. There are none to choose from"),
        ("ease_mm", "this is a group of values; name one of them or write ease_mm.*"),
        ("strain_percent.*", "write strain_percent.*.*"),
        ("hem.node", "did you mean 'nodes'"),
        ("zzz*", "Allowed:"),
    ],
)
def test_unknown_keys_are_refused_before_the_drape(key: str, says: str) -> None:
    with pytest.raises(SpecError, match=r"t\.yaml") as caught:
        refuse_unknown_keys([key], blank_report(), "t.yaml", "report")
    assert says in caught.value.message
    assert caught.value.key == f"report.{key}"


@pytest.mark.parametrize("key", ["constraints.gap_mm.button_1", "constraints.speed_m_s.peg", "bands.waist.tension_n.mean", "seam_tension.side.max"])
def test_what_a_garment_names_itself_may_be_asserted(key: str) -> None:
    refuse_unknown_keys([key], blank_report(), "t.yaml", "report")


def test_keys_of_the_report_are_known() -> None:
    known = [
        "status",
        "ease_mm.waist",
        "ease_mm.*",
        "strain_percent.*.p99",
        "*_intersections",
        "hem.nodes",
        "seam_gap_mm.max",
        "versions.numpy",
        "energy_j.bend",
        "*.waist",
    ]
    refuse_unknown_keys(known, blank_report(), "t.yaml", "report")


def test_not_a_number_never_holds() -> None:
    assert not holds(math.nan, Tolerance(value=0, tol=1))
    assert not holds(math.nan, (None, 1))
