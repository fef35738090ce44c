"""Assertions: what holds, what fails, and what is refused before anything is draped. Reports are made up."""

from __future__ import annotations

import math
from typing import Any

import pytest

from garmentcad.errors import SpecError
from garmentcad.pattern.garment_test import Expected, Tolerance
from garmentcad.pattern.pattern import Pattern
from garmentcad.regression.assertion import expected_text, holds, judge, means, refuse_unknown_keys, values_at
from garmentcad.regression.known_values import known_values
from garmentcad.simulation.job import make_job

KNOWN = known_values(Pattern("sheet", {}, (), "denim", "woman-88", {}, {}))  # of a garment that names nothing itself

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


def test_one_value_by_two_keys_has_two_names() -> None:
    verdicts = judge({"ease_mm": {"hip": 20.0, "waist": 5.0}}, {"ease_mm.*": (0.0, 30.0), "ease_mm.hip": (25.0, 30.0)})
    assert [(verdict.key, verdict.passed) for verdict in verdicts] == [("ease_mm.hip", True), ("ease_mm.waist", True), ("ease_mm.hip (ease_mm.hip)", False)]


def test_what_fails_is_told_with_all_digits_of_a_report() -> None:
    (verdict,) = judge({"hem_height_mm": 410.164037}, {"hem_height_mm": 410.164})
    assert (verdict.expected, verdict.came, verdict.passed) == ("410.164", "410.164037", False)
    (beyond,) = judge({"hem_height_mm": 410.164037}, {"hem_height_mm": (400.0, 410.164036)})
    assert (beyond.expected, beyond.came) == ("400 to 410.164036", "410.164037")
    (held,) = judge({"hem_height_mm": 410.164037}, {"hem_height_mm": (400.0, 420.0)})
    assert held.came == "410.164"


def test_only_the_wildcard_stands_for_other_text() -> None:
    report = {"ease_mm": {"bust": 1, "waist": 2, "hip": None, "a?": 3, "[b]": 4}}
    assert values_at(report, "ease_mm.b*") == {"ease_mm.bust": 1}
    assert values_at(report, "ease_mm.[bw]*") == values_at(report, "ease_mm.hi?") == {}
    assert (values_at(report, "ease_mm.a?"), values_at(report, "ease_mm.[b]")) == ({"ease_mm.a?": 3}, {"ease_mm.[b]": 4})


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
        refuse_unknown_keys([key], KNOWN, "t.yaml", "report")
    assert says in caught.value.message
    assert caught.value.key == f"report.{key}"


@pytest.mark.parametrize(
    ("key", "says"),
    [
        ("fold_deg.front.creese", "there is no 'front.creese' in fold_deg; did you mean 'front.crease'"),
        ("fold_deg.front", "there is no 'front' in fold_deg"),
        ("fold_deg.front.crease.max", "there is no 'max' in fold_deg.front.crease. There are none to choose from"),
        ("seam_tension.sides.max_n_m", "there is no 'sides.max_n_m' in seam_tension. Allowed: front.dart, side"),
        ("seam_tension.front.darts.max_n_m", "there is no 'front.darts' in seam_tension; did you mean 'front.dart'"),
        ("seam_tension.front.dart.max", "there is no 'max' in seam_tension.front.dart; did you mean 'max_n_m'"),
        ("seam_tension.front.dart", "this is a group of values; name one of them or write seam_tension.front.dart.*"),
        ("constraints.gap_mm.button_2", "did you mean 'button_1'"),
        ("bands.waist.tension", "did you mean 'tension_n'"),
        ("bands.hip.tension_n", "there is no 'hip' in bands"),
        ("versions.nump", "did you mean 'numpy'"),
    ],
)
def test_names_that_the_garment_has_not_are_refused(key: str, says: str) -> None:
    with pytest.raises(SpecError) as caught:
        refuse_unknown_keys([key], named(), "t.yaml", "report")
    assert says in caught.value.message


def named() -> dict[str, Any]:
    """What is known of a garment that names things itself."""
    held = {"button_1": None, "peg": None}
    bands = {"waist": dict.fromkeys(("tension_n", "length_mm"))}
    seams = {name: dict.fromkeys(("mean_n_m", "max_n_m")) for name in ("side", "front.dart")}
    own = {"fold_deg": {"front.crease": None, "back.crease": None}, "bands": bands, "seam_tension": seams}
    return KNOWN | own | {"constraints": KNOWN["constraints"] | {"gap_mm": held, "speed_m_s": held}}


@pytest.mark.parametrize(
    "key",
    [
        "constraints.gap_mm.button_1", "constraints.speed_m_s.peg", "bands.waist.tension_n", "seam_tension.side.max_n_m", "seam_tension.front.dart.max_n_m",
        "seam_tension.*.max_n_m", "fold_deg.front.crease", "fold_deg.*", "fold_deg.*.crease", "fold_deg.front.*", "fold_deg.*crease", "*.front.crease",
    ],
)  # fmt: skip
def test_what_a_garment_names_itself_may_be_asserted(key: str) -> None:
    refuse_unknown_keys([key], named(), "t.yaml", "report")


def test_names_with_dots_are_asserted_as_they_are_printed() -> None:
    report = {"fold_deg": {"front.crease": -20.3, "back.crease": None}, "seam_tension": {"front.dart": {"max_n_m": 3.0}, "side": {"max_n_m": 5.0}}}
    for key in ("fold_deg.*", "fold_deg.*.crease", "fold_deg.front.crease"):
        assert [(verdict.key, verdict.passed) for verdict in judge(report, {key: (-90, 90)})] == [("fold_deg.front.crease", True)]
    assert values_at(report, "seam_tension.front.dart.max_n_m") == {"seam_tension.front.dart.max_n_m": 3.0}
    assert values_at(report, "seam_tension.*.max_n_m") == {"seam_tension.front.dart.max_n_m": 3.0, "seam_tension.side.max_n_m": 5.0}
    assert values_at(report, "fold_deg.front") == values_at(report, "fold_deg.front.crease.x") == {}
    assert means([report, report], "fold_deg.front.crease") == {"fold_deg.front.crease": -20.3}


def test_what_shipped_garments_name_themselves_is_known() -> None:
    """Folds, darts and pleats among the seams, buttons, and an elastic; nothing where there is none."""
    for garment, keys in (
        ("mens-shirt", ["constraints.gap_mm.button_neck", "constraints.speed_m_s.button_1", "seam_tension.*.max_n_m"]),
        ("pleated-skirt", ["fold_deg.front.knife_1_fold", "seam_tension.front.knife_1.mean_n_m", "seam_tension.yoke_front.dart_side.max_n_m"]),
        ("wrap-skirt", ["bands.belt.max_tension_n"]),
    ):
        refuse_unknown_keys(keys, known_values(make_job(garment).pattern), "t.yaml", "report")
    for key in ("fold_deg.*", "bands.*.tension_n", "constraints.gap_mm.button_neck"):
        with pytest.raises(SpecError, match="There are none to choose from"):
            refuse_unknown_keys([key], known_values(make_job("straight-skirt").pattern), "t.yaml", "report")


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
    refuse_unknown_keys(known, KNOWN, "t.yaml", "report")


def test_not_a_number_never_holds() -> None:
    assert not holds(math.nan, Tolerance(value=0, tol=1))
    assert not holds(math.nan, (None, 1))
