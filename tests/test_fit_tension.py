"""Tension loops made from known sheets give the sheet back within the stated bounds."""

from __future__ import annotations

import numpy as np
import pytest
from tester_records import sweep, tension_record

from garmentcad.errors import FabricError
from garmentcad.fabric.fit_tension import doubtful_starts, fit_tension
from garmentcad.fabric.fitted import FittedValue
from garmentcad.fabric.recorded_loop import RecordedLoop, record

CASES = [(0.58, 60.0, 6.0, 500.0), (0.72, 54.1, 5.5, 500.0), (0.45, 35.0, 18.0, 500.0), (1.0, 80.0, 3.0, 500.0), (0.75, 40.0, 33.0, 50.0)]  # LT RT EMT Fm


def truth_of(lt: float, rt: float, emt: float, fm: float) -> dict[str, float]:
    """WT from its definition; RT from the areas of a fine record, for the change of branch belongs to it."""
    x = sweep([0.0, emt, 0.0], 40_001)
    y = tension_record(x, lt, rt, emt, fm)
    back = -np.trapezoid(y[20_000:], x[20_000:]) / np.trapezoid(y[:20_001], x[:20_001])
    return {"LT": lt, "WT": lt * fm * emt / 200.0, "RT": 100.0 * float(back), "EMT": emt, "Fm": fm}


def within(fitted: list[FittedValue], truth: dict[str, float], widest: float) -> None:
    found = {value.key.partition(".")[0]: value for value in fitted}
    assert set(found) == set(truth)
    for key, number in truth.items():
        value = found[key]
        assert value.low <= number <= value.high, value
        assert value.high - value.low <= widest * number, value


def loop(x: np.ndarray, y: np.ndarray, way: str = "weft") -> RecordedLoop:
    return record("tension", way, x, y, "made up.csv", "column 'force'")


@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("samples", [60, 400])
def test_clean_loop(case: tuple[float, float, float, float], samples: int) -> None:
    x = sweep([0.0, case[2], 0.0], samples + 1)
    within(fit_tension([loop(x, tension_record(x, *case))]), truth_of(*case), 0.05)


@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("seed", range(2))
def test_noise_uneven_samples_and_offsets(case: tuple[float, float, float, float], seed: int) -> None:
    """Zero of force off by 3 % of Fm, zero of strain by half a percent, noise of 0.5 % of Fm, steps that differ by four times."""
    rng = np.random.default_rng(seed)
    x = sweep([0.0, case[2], 0.0], 300, rng)
    x[np.argmax(x)] = case[2]
    y = tension_record(x, *case) + 0.03 * case[3] + rng.normal(0.0, 0.005 * case[3], 300)
    within(fit_tension([loop(x + 0.5, y)]), truth_of(*case), 0.2)


def test_a_loop_that_overshoots_is_brought_to_the_nominal_force() -> None:
    x = sweep([0.0, 6.05, 0.0], 801)
    fitted = {value.key: value for value in fit_tension([loop(x, tension_record(x, 0.58, 60.0, 6.0, 500.0))])}
    assert fitted["Fm"].value == 500.0
    assert fitted["EMT.weft"].value == pytest.approx(6.0, rel=2e-3)
    assert fitted["LT.weft"].value == pytest.approx(0.58, rel=5e-3)


def test_two_loops_share_fm() -> None:
    x, z = sweep([0.0, 4.0, 0.0], 401), sweep([0.0, 9.0, 0.0], 401)
    warp = loop(x, tension_record(x, 0.6, 60.0, 4.0, 500.0), "warp")
    assert sum(value.key == "Fm" for value in fit_tension([warp, loop(z, tension_record(z, 0.7, 60.0, 9.0, 505.0))])) == 1
    with pytest.raises(FabricError, match="Fm belongs to the whole sheet"):
        fit_tension([warp, loop(z, tension_record(z, 0.7, 60.0, 9.0, 250.0))])
    with pytest.raises(FabricError, match=r"the loops end at (500|499\.9\d?), (520|519\.9\d?) gf/cm"):
        fit_tension([warp, loop(z, tension_record(z, 0.7, 60.0, 9.0, 520.0))])


@pytest.mark.parametrize(("end", "force"), [(49.0, 50.0), (102.0, 100.0), (104.0, 104.0), (250.0, 250.0), (510.0, 500.0)])
def test_fm_is_the_nominal_force_near_by_and_its_bounds_hold_what_was_recorded(end: float, force: float) -> None:
    x = sweep([0.0, 6.0, 0.0], 401)
    fm = next(value for value in fit_tension([loop(x, tension_record(x, 0.6, 60.0, 6.0, end))]) if value.key == "Fm")
    assert fm.value == pytest.approx(force, rel=5e-4)
    assert (fm.low, fm.high) == pytest.approx((min(force, end), max(force, end)), rel=5e-4)


def test_a_coarse_record_that_overshoots_is_brought_to_fm_along_its_tangent() -> None:
    """Of its last tenth there are two samples, too few for a slope."""
    x = sweep([0.0, 6.05, 0.0], 25)
    fitted = {value.key: value for value in fit_tension([loop(x, tension_record(x, 0.58, 60.0, 6.0, 500.0))])}
    assert fitted["EMT.weft"].value == pytest.approx(6.0, rel=2e-3)


BAD = [
    pytest.param(lambda x, y: (x[:200], y[:200]), "never turns back", id="loading only"),
    pytest.param(lambda x, y: (x[:260], y[:260]), "the way back ends at", id="half a way back"),
    pytest.param(lambda x, y: (x[::-1], y[::-1]), "the way back gives", id="backwards in time"),
    pytest.param(lambda x, y: (x, y + 200.0), "the record begins at 200", id="preload"),
    pytest.param(lambda x, y: (x, y - 200.0), "the record begins at -200", id="slack"),
    pytest.param(lambda x, y: (x, np.where(np.arange(len(x)) > 200, 1.75 * y, y)), "the way back gives", id="gain"),
    pytest.param(lambda x, y: (x, -y), "does not grow", id="sign"),
    pytest.param(lambda x, y: (-x, y), "the strain falls first", id="compression"),
    pytest.param(lambda x, y: (np.tile(x, 2), np.concatenate([y, 0.6 * y])), "at sample 402 the strain grows again; one loop", id="two loops"),
]


@pytest.mark.parametrize(("spoil", "words"), BAD)
def test_what_is_no_loop_is_refused(spoil: object, words: str) -> None:
    x = sweep([0.0, 6.0, 0.0], 401)
    with pytest.raises(FabricError) as caught:
        fit_tension([loop(*spoil(x, tension_record(x, 0.58, 60.0, 6.0, 500.0)))])  # type: ignore[operator]
    assert words in str(caught.value)


@pytest.mark.parametrize(("fall", "samples"), [(0.02, 5), (0.05, 5), (0.08, 10)])
def test_a_pause_at_the_end_in_which_the_force_falls_belongs_to_the_way_back(fall: float, samples: int) -> None:
    x = sweep([0.0, 6.0, 0.0], 401)
    y, top = tension_record(x, 0.6, 60.0, 6.0, 500.0), 200
    y[top + 1 :] *= 1.0 - fall
    paused = np.insert(x, top + 1, np.full(samples, x[top])), np.insert(y, top + 1, 500.0 * (1.0 - fall * np.linspace(0.0, 1.0, samples + 1)[1:]))
    found = {value.key: value.value for value in fit_tension([loop(*paused)])}
    assert found["Fm"] == 500.0
    assert [found["LT.weft"], found["EMT.weft"], found["WT.weft"]] == pytest.approx([0.6, 6.0, 9.0], rel=1e-3)


def test_a_start_that_is_pulled_already_or_slack_is_told() -> None:
    x = sweep([0.0, 6.0, 0.0], 401)
    clean = tension_record(x, 0.6, 60.0, 6.0, 500.0)
    assert doubtful_starts([loop(x, clean), loop(x, clean + 4.0)]) == []
    pulled = clean >= 40.0
    (finding,) = doubtful_starts([loop(x[pulled], clean[pulled])])
    assert finding.severity == "warning"
    assert finding.message.startswith("the record begins at 40.")
    slack = np.concatenate([np.linspace(0.0, 2.0, 67)[:-1], x + 2.0, np.linspace(2.0, 0.0, 67)[1:]])
    (finding,) = doubtful_starts([loop(slack, np.concatenate([np.zeros(66), clean, np.zeros(66)]))])
    assert finding.message.startswith("the force grows from 2.15 % of strain on")


@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("noise", [0.0, 0.002, 0.01])
def test_a_start_from_zero_is_not_told_whatever_its_noise(case: tuple[float, float, float, float], noise: float) -> None:
    x = sweep([0.0, case[2], 0.0], 301)
    y = tension_record(x, *case) + np.random.default_rng(3).normal(0.0, noise * case[3], len(x))
    assert doubtful_starts([loop(x, y)]) == []


def test_noise_that_makes_a_few_copies_unreadable_does_not_refuse_the_record() -> None:
    """With noise of 8 of 500 gf/cm on a hundred samples a side the force seems not to grow at the end of one copy in some hundred."""
    x = sweep([0.0, 6.0, 0.0], 201)
    clean = tension_record(x, 0.6, 60.0, 6.0, 500.0)
    for seed in range(40):
        fitted = fit_tension([loop(x, clean + np.random.default_rng(seed).normal(0.0, 8.0, len(x)))])
        assert {value.key for value in fitted} == {"Fm", "LT.weft", "WT.weft", "RT.weft", "EMT.weft"}
    with pytest.raises(FabricError, match=r"its noise of \d+ is too large: with as much once more \d+ of 60 copies cannot be read"):
        fit_tension([loop(x, clean + np.random.default_rng(7).normal(0.0, 40.0, len(x)))])


@pytest.mark.parametrize("samples", [40, 80, 160, 800])
def test_a_sudden_fall_at_the_turn_is_in_the_bounds(samples: int) -> None:
    """The way back is 60 % of the way out from its first sample on."""
    x = sweep([0.0, 6.0, 0.0], samples + 1)
    y = tension_record(x, 0.6, 100.0, 6.0, 500.0)
    y[samples // 2 + 1 :] *= 0.6
    found = {value.key: value for value in fit_tension([loop(x, y)])}["RT.weft"]
    assert found.low <= 60.0 <= found.high, found
    assert found.high - found.low < 440.0 / samples


def test_a_sudden_fall_in_a_long_first_step_back_is_in_the_bounds() -> None:
    """Two samples after the turn are missing: nobody saw where in a step of three the force fell to 60 %."""
    x = sweep([0.0, 6.0, 0.0], 161)
    y = tension_record(x, 0.6, 100.0, 6.0, 500.0)
    y[81:] *= 0.6
    found = {value.key: value for value in fit_tension([loop(np.delete(x, [81, 82]), np.delete(y, [81, 82]))])}["RT.weft"]
    assert found.low <= 60.0 <= found.high, found


@pytest.mark.parametrize(("back_to", "turns"), [(5.5, 3), (5.0, 5)])
def test_a_recorder_that_goes_back_by_less_than_a_tenth_of_the_range_does_not_turn(back_to: float, turns: int) -> None:
    """On the way out from 0 to 8 it stops at 6 and goes back a little."""
    x = sweep([0.0, 6.0, back_to, 8.0, 0.0], 321)
    found = record("tension", "warp", x, tension_record(x, 0.9, 100.0, 8.0, 500.0), "made up.csv", "column 'force'")
    assert len(found.turns) == turns
    assert x[list(found.turns)] == pytest.approx([0.0, 8.0, 0.0] if turns == 3 else [0.0, 6.0, 5.0, 8.0, 0.0], abs=0.06)


@pytest.mark.parametrize(("at", "force"), [(40, 5000.0), (40, 0.0), (99, 5000.0)])
def test_a_sample_that_stands_alone_is_refused(at: int, force: float) -> None:
    x = sweep([0.0, 6.0, 0.0], 201)
    y = tension_record(x, 0.6, 60.0, 6.0, 500.0)
    y[at] = force
    with pytest.raises(FabricError, match=f"sample {at + 1}, {force:g} .* stands alone"):
        fit_tension([loop(x, y)])


@pytest.mark.parametrize("case", CASES)
def test_what_a_way_back_lacks_is_in_the_bounds(case: tuple[float, float, float, float]) -> None:
    """It stops at 9 % of Fm."""
    x = sweep([0.0, case[2], 0.0], 801)
    y = tension_record(x, *case)
    kept = (np.arange(801) < 401) | (y > 0.09 * case[3])
    found = {value.key: value for value in fit_tension([loop(x[kept], y[kept])])}["RT.weft"]
    assert found.low <= truth_of(*case)["RT"] <= found.high
    assert found.value < truth_of(*case)["RT"] - 0.3
