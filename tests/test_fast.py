"""FAST readings and lengths: curves whose truth is known, the published example of a laboratory, and readings that no cloth can have."""

from __future__ import annotations

import math
import re

import numpy as np
import pytest
from scipy.optimize import brentq
from test_cantilever import slid_by_shooting
from tester_records import loading

from garmentcad.errors import FabricError
from garmentcad.fabric.fast import doubtful, fit_fast
from garmentcad.fabric.fitted import FittedValue

# A plain weave, 100 % wool, 168 g/m2, FAST report of a student laboratory (bartleby.com and majortests.com, "Fabric Assurance by Simple Testing"): readings,
# and the B (uN.m), G (N/m) and formabilities F = B (E20 - E5)/14.7 (mm2) that the report prints.
REPORT = {"W": 16.8, "E5.warp": 0.67, "E20.warp": 1.87, "E100.warp": 4.60, "E5.weft": 0.40, "E20.weft": 1.87, "E100.weft": 5.87, "EB5": 4.7}
REPORT |= {"C.warp": 15.0, "C.weft": 14.5}
PRINTED = {"B.warp": 5.56, "B.weft": 5.02, "G.mean": 26.17}
FORMABILITY = {"warp": 0.45, "weft": 0.50}
TO_SI = {"B": 98.0665, "G": 0.980665 * 180 / math.pi}


def by_key(values: dict[str, float]) -> dict[str, FittedValue]:
    return {value.key: value for value in fit_fast(values)}


def test_published_example() -> None:
    found = by_key(REPORT)
    for key, printed in PRINTED.items():
        assert found[key].value * TO_SI[key[0]] == pytest.approx(printed, rel=5e-3)  # the report takes 123 for 122.6
    for way, printed in FORMABILITY.items():
        gain = REPORT[f"E20.{way}"] - REPORT[f"E5.{way}"]
        assert found[f"B.{way}"].value * TO_SI["B"] * gain / 14.7 == pytest.approx(printed, abs=0.01)
        assert found[f"EMT.{way}"].low <= REPORT[f"E100.{way}"] <= found[f"EMT.{way}"].high
        assert 0.6 < found[f"LT.{way}"].value < 0.9
    assert found["Fm"].value == 100.0
    assert {key.partition(".")[0] for key in found} == {"EMT", "LT", "Fm", "G", "B"}  # nothing of what a test without a way back cannot tell


@pytest.mark.parametrize("lt", [0.35, 0.6, 0.8, 0.98, 1.2])
@pytest.mark.parametrize("emt", [1.3, 4.6, 12.0])
def test_readings_of_a_known_curve_give_it_back_within_the_bounds(lt: float, emt: float) -> None:
    """Extensions read to 0.1 % from the exponential curve, found by bisection on its force."""
    exact = {
        name: float(brentq(lambda e, f=force: loading(np.array(e), lt, emt, 100.0) - f, 0.0, 1.01 * emt))
        for name, force in (("E5", 5), ("E20", 20), ("E100", 100))
    }
    found = by_key({f"{name}.warp": round(strain, 1) for name, strain in exact.items()})
    for key, truth in (("EMT.warp", emt), ("LT.warp", lt)):
        assert found[key].low - 1e-9 <= truth <= found[key].high + 1e-9, found[key]
    unrounded = by_key({f"{name}.warp": strain for name, strain in exact.items()})
    assert unrounded["LT.warp"].value == pytest.approx(lt, abs=1e-4)
    assert unrounded["LT.warp"].high - unrounded["LT.warp"].low < 0.5 / emt


def test_shear_between_stiff_and_stretching_yarns() -> None:
    """At 45 degrees 1/E = (1/G + 1/E1 + 1/E2)/4 (plate without Poisson effect): the bounds hold the G of a cloth of known stiffnesses."""
    g, warp, weft = 30.0, 900.0, 500.0  # N/m
    force = 5 * 0.980665
    readings = {"EB5": 100 * force * (1 / g + 1 / warp + 1 / weft) / 4, "E5.warp": 100 * force / warp, "E5.weft": 100 * force / weft}
    value = by_key(readings | {"E100.warp": 20.0, "E100.weft": 30.0})["G.mean"]
    assert value.value * TO_SI["G"] == pytest.approx(122.6 / readings["EB5"], rel=1e-3)
    assert value.value * TO_SI["G"] < g < value.high * TO_SI["G"]
    assert by_key({"EB5": 4.0})["G.mean"].how.endswith("yarns taken as stiff")


def test_a_mean_extension_is_that_of_both_yarns_of_the_bias() -> None:
    """Each of them takes 0.30 + 0.05 % at most of four times 4.0 - 0.05 %: 4.9033 N/m over 0.151 is 32.47 N/m."""
    assert by_key({"EB5": 4.0, "E5.mean": 0.3, "E100.mean": 4.0})["G.mean"].high * TO_SI["G"] == pytest.approx(32.47, abs=0.01)


def test_lengths_by_the_exact_elastica() -> None:
    """c = (B/(W g))^(1/3) is 17.2 mm for 10 uN.m and 200 g/m2; the strip overhangs 2.0004 c. Peirce's formula, 0.5093 of the overhang, gives 5.75 % more."""
    c_mm = 1000 * (1e-5 / 1.962) ** (1 / 3)
    found = by_key({"W": 20.0, "overhang.warp": 2.00035 * c_mm, "C.weft": 1.000175 * c_mm, "C.bias": 15.0})
    for key in ("B.warp", "B.weft"):
        assert found[key].value * 98.0665 == pytest.approx(10.0, rel=1e-4)
        assert found[key].low < found[key].value < found[key].high
    peirce = 1e6 * 1.962 * (0.50932 * 2.00035e-3 * c_mm) ** 3
    assert peirce / (found["B.warp"].value * 98.0665) == pytest.approx(1.0575, abs=2e-4)
    assert found["B.warp"].high * 98.0665 == pytest.approx(10.0 * 1.01 * (1 + 0.5 / (2.00035 * c_mm)) ** 3, rel=1e-3)


def test_friction_is_taken_out_of_lengths_where_it_is_known() -> None:
    """10 uN.m, 200 g/m2 and H c/B = 0.6 (and 0.15): without 2HB, B would come out 43 % too high (and 5 % too low). Strips of an independent solve."""
    c = (1e-5 / 1.962) ** (1 / 3)
    for held, raw in ((0.6, 1.43), (0.15, 0.953)):
        printed = 2.0 * held * 1e-5 / c / 9.80665e-3  # 2HB, gf.cm/cm
        overhang_mm = 1e3 * c * (2.0 * slid_by_shooting(held, 0.025) - slid_by_shooting(held, 0.05))
        readings = {"W": 20.0, "overhang.warp": overhang_mm, "C.bias": 0.5 * overhang_mm}
        assert by_key(readings)["B.warp"].value * 98.0665 == pytest.approx(10.0 * raw, rel=0.01)
        for known in ({"2HB.warp": printed, "2HB.bias": printed}, {"2HB.mean": printed}, {"2HB.warp": printed, "2HB.weft": printed}):
            found = by_key(readings | known)
            for key in ("B.warp", "B.bias"):
                assert found[key].value * 98.0665 == pytest.approx(10.0, rel=0.005)
                assert found[key].low < found[key].value < found[key].high
                assert "taken out" in found[key].how


def test_a_ratio_of_hysteresis_to_stiffness_gives_both_from_a_length() -> None:
    """10 uN.m, 200 g/m2 and H c/B = 0.6: 2HB over B is 1.2/c. Without it the bounds hold the B of the usual 0.9 /cm, as of a strip that has it."""
    c = (1e-5 / 1.962) ** (1 / 3)
    for ratio in (1.2 / (100.0 * c), 0.9):
        held = 50.0 * ratio * c
        overhang_mm = 1e3 * c * (2.0 * slid_by_shooting(held, 0.025) - slid_by_shooting(held, 0.05))
        readings = {"W": 20.0, "overhang.warp": overhang_mm, "C.bias": 0.5 * overhang_mm}
        found = by_key(readings | {"2HB/B": ratio})
        for way in ("warp", "bias"):
            bending, hysteresis = found[f"B.{way}"], found[f"2HB.{way}"]
            assert bending.value * 98.0665 == pytest.approx(10.0, rel=0.005)
            assert bending.low < bending.value < bending.high
            assert hysteresis.value == pytest.approx(ratio * bending.value, rel=1e-12)
            assert (bending.estimate, hysteresis.estimate) == (False, True)
    without = by_key(readings)
    assert set(without) == {"B.warp", "B.bias"}
    assert without["B.warp"].low * 98.0665 < 10.0 < 14.0 < without["B.warp"].value * 98.0665 < without["B.warp"].high * 98.0665


def test_friction_in_a_length_is_said_unless_it_is_taken_out() -> None:
    readings = {"W": 20.0, "C.warp": 20.0, "C.weft": 18.0}
    assert [(finding.severity, finding.key) for finding in doubtful(readings)] == [("warning", "B.warp"), ("warning", "B.weft")]
    assert [finding.key for finding in doubtful(readings | {"2HB.warp": 0.02})] == ["B.weft"]
    assert doubtful(readings | {"2HB/B": 0.4}) == doubtful(readings | {"2HB.mean": 0.03}) == []


BAD = [
    ({"W": 20.0, "2HB/B": 0.4}, "2HB/B", "needs a length of a cantilever"),
    ({"W": 20.0, "C.warp": 15.0, "2HB.warp": 0.01, "2HB/B": 0.4}, "2HB/B", "needs a length of a cantilever in a direction of which no 2HB is given"),
    ({"C.warp": 15.0}, "W", "only with the mass per area"),
    ({"W": 20.0, "C.warp": 15.0, "overhang.warp": 30.0}, "C.warp", "both a bending length and an overhang"),
    ({"W": 20.0, "C.warp": 1.5}, "C.warp", "impossible for bending length"),
    ({"E5.warp": 1.0, "E20.warp": 2.0}, "E100.warp", "E100 is missing"),
    ({"E5.weft": 2.0, "E20.weft": 1.0, "E100.weft": 4.0}, "E100.weft", "a larger load cannot stretch less"),
    ({"EB5": 0.5, "E5.warp": 0.8, "E5.weft": 0.9, "E100.warp": 4.0, "E100.weft": 4.0}, "EB5", "no more than its yarns give"),
    ({"EB5": 0.55, "E5.warp": 0.9, "E5.weft": 0.9, "E100.warp": 4.0, "E100.weft": 4.0}, "EB5", "no more than its yarns give"),
    ({"EB5": 0.0}, "EB5", "impossible"),
    ({"W": 20.0, "C.warp": 150.0}, "C.warp", "impossible for bending length"),
    ({"W": 20.0, "C.warp": 15.0, "2HB.warp": 0.2}, "C.warp", "2HB = 0.2 gf.cm/cm alone bears a strip of 20 mg/cm2 at an overhang of 30 mm"),
]


@pytest.mark.parametrize(("values", "key", "words"), BAD)
def test_readings_of_no_cloth_are_refused(values: dict[str, float], key: str, words: str) -> None:
    with pytest.raises(FabricError, match=words) as caught:
        fit_fast(values)
    assert caught.value.key == key


def test_readings_that_are_equal_within_their_tenth_are_taken() -> None:
    """A stiff warp that is read as 0.1 % at 5 and at 20 gf/cm."""
    fitted = {value.key: value for value in fit_fast({"E5.warp": 0.1, "E20.warp": 0.1, "E100.warp": 0.8})}
    assert fitted["EMT.warp"].low <= 0.8 <= fitted["EMT.warp"].high
    assert fitted["LT.warp"].low < fitted["LT.warp"].value < fitted["LT.warp"].high


def test_the_firmest_cloth_that_a_sheet_takes_is_fitted() -> None:
    """Extensions of 0, 0 and 0.2 % come nearest to a curve that ends just below the least EMT of a sheet."""
    found = by_key({"E5.warp": 0.0, "E20.warp": 0.0, "E100.warp": 0.2})
    assert found["EMT.warp"].value == pytest.approx(0.2, abs=1e-6)
    assert found["EMT.warp"].value >= 0.2


def test_one_extension_gives_its_strain_and_no_linearity() -> None:
    assert [value.key for value in fit_fast({"E100.mean": 5.0})] == ["EMT.mean", "Fm"]


def test_extensions_that_no_curve_meets_are_said() -> None:
    def said(*strains: float) -> list[str]:
        return [str(finding) for finding in doubtful({f"{name}.warp": value for name, value in zip(("E5", "E20", "E100"), strains)})]

    assert said(0.5, 1.5, 4.0) == []
    (missed,) = said(0.1, 4.5, 4.6)
    assert re.match(r"warning: EMT.warp: no curve of a tensile tester goes through E5 0.1 %, E20 4.5 %, E100 4.6 %: it misses one by [12]\.\d+ %", missed)
    assert any(one.startswith("warning: LT.warp: E5 3 %, E20 3 %, E100 3 % ask for an LT beyond") for one in said(3.0, 3.0, 3.0))
    assert any(one.startswith("warning: LT.warp") for one in said(0.01, 0.1, 4.6))
