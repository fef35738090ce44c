"""Every rule for missing values, the check of a sheet against itself, and the findings."""

from __future__ import annotations

from typing import Any

import pytest

from garmentcad.errors import FabricError
from garmentcad.fabric.missing import FILLED, RULES, complete, measured_fraction
from garmentcad.fabric.sheet import KesSheet, sheet_from, sheet_sha256

BASE: dict[str, Any] = {"schema": 1, "name": "x", "source": "our laboratory", "W": 20.0}
FULL: dict[str, Any] = {
    **BASE,
    "T0": 0.6,
    "Fm": 500,
    "LT": {"warp": 0.6, "weft": 0.7},
    "WT": {"warp": 7.5, "weft": 14.0},
    "RT": {"warp": 62, "weft": 58},
    "EMT": {"warp": 5.0, "weft": 8.0},
    "G": {"warp": 0.6, "weft": 0.5},
    "2HG": {"warp": 0.9, "weft": 0.8},
    "2HG5": {"warp": 1.5, "weft": 1.4},
    "B": {"warp": 0.12, "weft": 0.09, "bias": 0.1},
    "2HB": {"warp": 0.05, "weft": 0.04, "bias": 0.045},
    "MIU": 0.2,
}


def sheet(**changes: Any) -> KesSheet:
    return sheet_from({**BASE, **{key.replace("H", "2H") if key.startswith("H") else key: value for key, value in changes.items()}})


EXPECTED = [
    # given, key, number by hand, words of the rule
    ({}, "Fm", 500.0, "tester's standard"),
    ({}, "LT.warp", 0.65, "0.65"),
    ({"LT": {"weft": 0.8}, "WT": {"warp": 7.5}, "EMT": {"warp": 5.0}}, "LT.warp", 0.6, "200 WT/(Fm EMT)"),
    ({"WT": {"weft": 7.5}, "EMT": {"weft": 5.0}}, "LT.warp", 0.6, "equal to weft"),
    ({"WT": {"weft": 7.5}, "LT": {"weft": 0.6}}, "EMT.warp", 5.0, "equal to weft"),
    ({"LT": {"weft": 0.8}}, "LT.warp", 0.8, "equal to weft"),
    ({"LT": 0.7}, "LT.weft", 0.7, "mean of warp and weft"),
    ({"LT": {"mean": 0.7, "warp": 0.6}}, "LT.weft", 0.8, "2 mean - warp"),
    ({"WT": {"warp": 7.5}, "EMT": {"warp": 5.0}}, "LT.warp", 0.6, "200 WT/(Fm EMT)"),
    ({"WT": 7.5, "EMT": 5.0}, "LT.weft", 0.6, "of the means"),
    ({"WT": {"warp": 7.5}, "LT": {"warp": 0.6}}, "EMT.warp", 5.0, "200 WT/(LT Fm)"),
    ({"WT": {"warp": 0.75}, "LT": {"warp": 0.6}, "Fm": 50}, "EMT.warp", 5.0, "200 WT/(LT Fm)"),
    ({"EMT": 6.0}, "EMT.weft", 6.0, "mean of warp and weft"),
    ({"WT": 7.5, "LT": 0.6}, "EMT.weft", 5.0, "with the mean WT"),
    ({"EMT": {"warp": 4.0}}, "EMT.weft", 4.0, "equal to warp"),
    ({}, "EMT.warp", 5.0, "5 %"),
    ({"LT": 0.6, "EMT": {"warp": 5, "weft": 8}}, "WT.weft", 12.0, "LT Fm EMT/200"),
    ({"RT": {"warp": 70}}, "RT.weft", 70.0, "equal to warp"),
    ({}, "RT.weft", 60.0, "60 %"),
    ({}, "RT.warp", 60.0, "60 %"),
    ({"RT": 55}, "RT.warp", 55.0, "mean of warp and weft"),
    ({}, "G.warp", 0.6, "0.03 W"),
    ({"G": {"warp": 1.0}}, "G.weft", 1.0, "equal to warp"),
    ({"G": 1.2}, "G.weft", 1.2, "mean of warp and weft"),
    ({"G": 2.0}, "2HG.warp", 4.0, "2 degrees x G"),
    ({"HG5": {"weft": 3.32}}, "2HG.weft", 2.0, "2HG5/1.66"),
    ({"HG5": 3.32}, "2HG.warp", 2.0, "2HG5/1.66 of the mean"),
    ({"HG": {"warp": 2.0}}, "2HG.weft", 2.0, "equal to warp"),
    ({"HG": 2.0}, "2HG5.weft", 3.32, "1.66 x 2HG"),
    ({"HG5": 4.0}, "2HG5.weft", 4.0, "mean of warp and weft"),
    ({"HG5": {"weft": 4.0}}, "2HG5.warp", 4.0, "equal to weft"),
    ({"B": 0.118}, "B.warp", 0.118, "mean of warp and weft"),
    ({"B": {"warp": 0.1}}, "B.weft", 0.064, "0.64 B.warp"),
    ({"B": {"weft": 0.064}}, "B.warp", 0.1, "B.weft/0.64"),
    ({"W": 19.7}, "B.warp", 0.14, "medians of 618 fabrics"),
    ({"W": 39.4}, "B.warp", 0.14 * 2.0**1.7, "medians of 618 fabrics"),
    ({"B": {"warp": 0.16, "weft": 0.09}}, "B.bias", 0.97 * 0.12, "0.97 sqrt"),
    ({"B": 0.1}, "2HB.warp", 0.09, "0.9 /cm x B"),
    ({"B": {"warp": 0.2, "weft": 0.1}, "HB": {"warp": 0.06}}, "2HB.weft", 0.03, "2HB.warp in the ratio of B"),
    ({"HB": 0.05}, "2HB.weft", 0.05, "mean of warp and weft"),
    ({"HB": {"warp": 0.09, "weft": 0.04}}, "2HB.bias", 0.06, "sqrt(2HB.warp 2HB.weft)"),
    ({"W": 16.0}, "T0", 0.4, "0.4 g/cm3"),
    ({}, "MIU.mean", 0.2, "0.2"),
    ({"MIU": {"warp": 0.2, "weft": 0.3}}, "MIU.mean", 0.25, "mean of warp and weft"),
    ({"MIU": {"weft": 0.3}}, "MIU.mean", 0.3, "equal to weft"),
]


@pytest.mark.parametrize(("given", "key", "number", "words"), EXPECTED, ids=lambda value: str(value)[:40])
def test_rule(given: dict[str, Any], key: str, number: float, words: str) -> None:
    done = complete(sheet(**given))
    assert done.sheet.number(key) == pytest.approx(number, rel=1e-12)
    assert key in done.assumed
    (finding,) = [finding for finding in done.findings if finding.key == key and finding.message.startswith("missing")]
    assert words in finding.message
    assert f"{number:.4g}" in finding.message
    assert done.sheet.origin(key).startswith("estimate: ")


def test_every_key_of_a_rule_is_tested() -> None:
    assert {key for _, key, _, _ in EXPECTED} >= {rule.key for rule in RULES} - {"WT.warp", "2HG5.warp"}


@pytest.mark.parametrize(
    ("given", "key", "severity"),
    [
        ({}, "Fm", "info"),
        ({}, "T0", "info"),
        ({"EMT": 6.0}, "EMT.weft", "info"),
        ({"G": {"warp": 1.0}}, "G.weft", "info"),
        ({"2HG5": 3.32}, "2HG.warp", "info"),
        ({"EMT": {"warp": 4.0}}, "EMT.weft", "warning"),
        ({}, "EMT.warp", "warning"),
        ({}, "G.warp", "warning"),
        ({"G": 2.0}, "2HG.warp", "warning"),
        ({}, "B.warp", "warning"),
        ({"B": {"warp": 0.1}}, "B.weft", "warning"),
        ({"B": {"weft": 0.1}}, "B.warp", "warning"),
        ({"B": 0.1}, "2HB.warp", "warning"),
        ({}, "MIU.mean", "warning"),
    ],
)
def test_a_value_that_nothing_of_its_kind_was_measured_for_is_a_warning(given: dict[str, Any], key: str, severity: str) -> None:
    findings = complete(sheet_from({**BASE, **given})).findings
    assert [found.severity for found in findings if found.key == key and found.message.startswith("missing")] == [severity]


def test_rules_fill_every_gap_and_a_full_sheet_has_none() -> None:
    assert {key for key in FILLED if complete(sheet()).sheet.get(key) is None} == set()
    full = complete(sheet_from(FULL))
    assert full.findings == ()
    assert full.assumed == frozenset()
    assert full.sheet == sheet_from(FULL)


def test_weight_has_no_stand_in() -> None:
    with pytest.raises(FabricError, match="nothing can stand in") as caught:
        complete(sheet_from({"schema": 1, "name": "x"}))
    assert caught.value.key == "W"


def test_a_rule_that_leads_to_nonsense_is_refused_with_its_input() -> None:
    with pytest.raises(FabricError, match=r"the rule 2 mean - warp with LT.mean = 0.5, LT.warp = 1.1 gives -0.1") as caught:
        complete(sheet(LT={"mean": 0.5, "warp": 1.1}))
    assert caught.value.key == "LT.weft"
    with pytest.raises(FabricError, match=r"the rule 2 mean - warp with LT.mean = 1.5, LT.warp = 0.5 gives 2.5, outside .* to ") as caught:
        complete(sheet(LT={"mean": 1.5, "warp": 0.5}))
    assert caught.value.key == "LT.weft"


@pytest.mark.parametrize(("wt", "accepted"), [(7.5, True), (7.5 * 1.029, True), (7.5 * 0.971, True), (7.5 * 1.031, False), (7.5 * 0.969, False)])
def test_sheet_against_itself(wt: float, accepted: bool) -> None:
    given = sheet_from({**FULL, "WT": {"warp": wt, "weft": 14.0}})
    if accepted:
        assert complete(given).findings == ()
    else:
        with pytest.raises(FabricError, match="at most 3 % is allowed") as caught:
            complete(given)
        assert caught.value.key == "WT.warp"


def test_self_check_uses_the_force_of_the_sheet() -> None:
    with pytest.raises(FabricError, match=r"LT Fm EMT/200 = 0.6 x 50 x 5/200 = 0.75"):
        complete(sheet_from({**FULL, "Fm": 50}))


def test_means_that_disagree_are_a_finding_not_a_refusal() -> None:
    done = complete(sheet(LT=0.6, EMT=5.0, WT=8.0))
    assert [(f.severity, f.key) for f in done.findings if "off LT Fm EMT/200" in f.message] == [("warning", "WT.mean")]


@pytest.mark.parametrize(
    ("change", "key", "words"),
    [
        ({"W": 70.0}, "W", "outside the usual 3 to 50"),
        ({"B": {"warp": 3.0, "weft": 2.0, "bias": 2.4}}, "B.warp", "outside the usual"),
        ({"B": {"warp": 0.12, "weft": 0.09, "bias": 0.1, "mean": 0.2}}, "B.mean", "warp and weft are used"),
        ({"2HG": {"warp": 1.6, "weft": 0.8}}, "2HG.warp", "larger than 2HG5"),
        ({"Tm": 0.7}, "Tm", "larger than T0"),
        ({"RT": {"warp": 20.0, "weft": 60.0}}, "RT.warp", "gives back 28 % at least"),
        (
            {"LT": {"warp": 0.7, "weft": 0.6}, "WT": {"warp": 8.75, "weft": 12.0}, "RT": {"warp": 62.0, "weft": 20.0}},
            "RT.weft",
            "LT = 0.6 the law gives back 28 % at least",
        ),
        ({"B": {"warp": 0.1, "weft": 0.06, "bias": 0.01}}, "B.bias", "with B = 0.1 in warp and 0.06 in weft the law has 0.04 in the bias at least"),
        ({"law": {"sheet_sha256": "0" * 64, "values": {"W": 21.0}}}, "law", "is not used"),
    ],
)
def test_strange_values_are_found(change: dict[str, Any], key: str, words: str) -> None:
    findings = complete(sheet_from({**FULL, **change})).findings
    assert [finding.severity for finding in findings if finding.key == key and words in finding.message] == ["warning"]
    assert str(findings[0]).startswith("warning: ")


def test_a_calibration_of_the_completed_sheet_is_kept() -> None:
    plain = complete(sheet()).sheet
    done = complete(sheet(law={"sheet_sha256": sheet_sha256(plain), "values": {"G.warp": 0.7}}))
    assert not [finding for finding in done.findings if finding.key == "law"]
    assert done.sheet.law is not None


def test_measured_fraction_counts_measurements() -> None:
    assert measured_fraction(sheet()) == pytest.approx(1 / len(FILLED))
    assert measured_fraction(sheet_from(FULL)) == 1.0
    assert measured_fraction(sheet(B=0.1)) == pytest.approx(3 / len(FILLED))  # W, and warp and weft by their mean; not the bias
    assert measured_fraction(sheet(B={"value": 0.1, "estimate": "guess"})) == pytest.approx(1 / len(FILLED))
    assert measured_fraction(sheet(MIU={"warp": 0.2, "weft": 0.2})) == pytest.approx(2 / len(FILLED))
    assert measured_fraction(complete(sheet()).sheet) == pytest.approx(1 / len(FILLED))


def test_a_measured_mean_of_the_strain_is_kept_where_the_work_of_both_ways_was_measured() -> None:
    done = complete(sheet(WT={"warp": 10.0, "weft": 12.0}, EMT=5.0)).sheet
    assert done.number("EMT.warp") == pytest.approx(5.0 * 10.0 / 11.0)
    assert 0.5 * (done.number("EMT.warp") + done.number("EMT.weft")) == pytest.approx(5.0)
    for way in ("warp", "weft"):
        assert done.number(f"LT.{way}") * 500.0 * done.number(f"EMT.{way}") / 200.0 == pytest.approx(done.number(f"WT.{way}"))


def test_a_mean_that_does_not_agree_with_what_follows_from_other_values_is_said() -> None:
    said = [str(finding) for finding in complete(sheet(WT={"warp": 10.0, "weft": 12.0}, EMT=5.0, LT=0.6)).findings if finding.key == "EMT.mean"]
    assert said == ["warning: EMT.mean: 5 is not the mean of warp 6.667 and weft 8, which follow from other values"]


@pytest.mark.parametrize("name", ["B", "2HB", "MIU", "G"])
def test_a_mean_that_does_not_agree_with_what_was_given_is_said_once(name: str) -> None:
    findings = complete(sheet_from({**BASE, "B": {"warp": 0.2, "weft": 0.2}, name: {"warp": 0.2, "weft": 0.3, "mean": 0.4}})).findings
    said = [str(finding) for finding in findings if finding.key == f"{name}.mean" and "is not the mean" in finding.message]
    assert said == [f"warning: {name}.mean: 0.4 is not the mean of warp 0.2 and weft 0.3; warp and weft are used"]


def test_a_loop_of_shear_that_widens_as_fast_as_it_rises_is_said() -> None:
    def said(widest: float) -> list[str]:
        done = complete(sheet_from({**BASE, "G": 0.4, "2HG": 1.0, "2HG5": widest}))
        return [finding.message for finding in done.findings if finding.key == "2HG5"]

    assert said(4.0) == []  # (4 - 1)/9 leave a sixth of G
    assert said(5.0) == ["with 2HG = 1 and 2HG5 = 5 friction rises about as fast as G = 0.4; G/10 is left"]
