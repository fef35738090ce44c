"""Shear and bending loops made from known sheets give the sheet back within the stated bounds."""

from __future__ import annotations

import numpy as np
import pytest
from tester_records import bending_record, friction_record, shear_record, sweep

from garmentcad.errors import FabricError
from garmentcad.fabric.fit_friction import fit_friction, unread
from garmentcad.fabric.fitted import FittedValue
from garmentcad.fabric.recorded_loop import RecordedLoop, record

SUITING = {"G": 0.58, "2HG": 0.87, "2HG5": 1.45}
DENIM = {"G": 2.18, "2HG": 5.012, "2HG5": 7.412}
KNIT = {"G": 0.66, "2HG": 1.9, "2HG5": 2.1}
CYCLE, FROM_END, ONE_SIDE, TWICE = [0, 8, -8, 0], [-8, 8, -8], [0, 8, 0], [0, 8, -8, 8, -8, 0]


def loop(test: str, x: np.ndarray, y: np.ndarray, way: str = "warp") -> RecordedLoop:
    return record(test, way, x, y, "made up.csv", "column 'force'")  # type: ignore[arg-type]


def within(fitted: list[FittedValue], truth: dict[str, float], widest: float) -> None:
    found = {value.key.partition(".")[0]: value for value in fitted}
    assert set(found) == set(truth)
    for key, number in truth.items():
        value = found[key]
        assert value.low <= number <= value.high, value
        assert value.low <= value.value <= value.high
        assert value.high - value.low <= widest * number, value


@pytest.mark.parametrize("truth", [SUITING, DENIM, KNIT])
@pytest.mark.parametrize("turns", [CYCLE, FROM_END, ONE_SIDE, TWICE], ids=str)
def test_clean_shear_loop(truth: dict[str, float], turns: list[float]) -> None:
    x = sweep(turns, 801)
    within(fit_friction([loop("shear", x, shear_record(x, truth["G"], truth["2HG"], truth["2HG5"]))]), truth, 0.05)


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize(("samples", "noise", "widest"), [(240, 0.005, 0.35), (1500, 0.01, 0.35)])
def test_noise_uneven_samples_and_offsets(seed: int, samples: int, noise: float, widest: float) -> None:
    """Amplifier zero off by 5 % of the range, angle zero off by 0.3 degrees, steps that differ by four times."""
    rng = np.random.default_rng(seed)
    x = sweep(CYCLE, samples, rng)
    y = shear_record(x, *DENIM.values())
    record = loop("shear", x + 0.3, y + 0.05 * np.ptp(y) + rng.normal(0.0, noise * np.ptp(y), samples))
    within(fit_friction([record]), DENIM, widest)


@pytest.mark.parametrize("seed", range(3))
def test_bending_loop(seed: int) -> None:
    truth = {"B": 0.118, "2HB": 0.124}
    rng = np.random.default_rng(seed)
    x = sweep([0, 2.5, -2.5, 0], 400, rng)
    y = bending_record(x, *truth.values()) + 0.01 + rng.normal(0.0, 0.002, 400)
    fitted = fit_friction([loop("bending", x, y, "bias")])
    within(fitted, truth, 0.2)
    assert [value.key for value in fitted] == ["B.bias", "2HB.bias"]
    assert "between 0.5 and 1.5 /cm" in fitted[0].how


def test_a_second_cycle_is_said_to_be_unread() -> None:
    """The first cycle is half of the way."""
    x = sweep(TWICE, 721)
    (found,) = unread([loop("shear", x, shear_record(x, *SUITING.values()))])
    assert str(found).startswith("warning: made up.csv: column 'force': 360 of 721 samples, the first of them 362, are not used")
    for turns in (CYCLE, FROM_END, ONE_SIDE):
        x = sweep(turns, 801) + 0.01 * np.random.default_rng(1).normal(size=801)
        assert unread([loop("shear", x, shear_record(x, *SUITING.values()))]) == []


def test_an_elastic_cloth_has_no_width() -> None:
    x = sweep(CYCLE, 401)
    found = {value.key: value for value in fit_friction([loop("shear", x, 0.5 * x)])}
    assert found["G.warp"].value == pytest.approx(0.5, rel=1e-9)
    assert max(found["2HG.warp"].value, found["2HG5.warp"].value) < 1e-9


def test_a_loop_to_four_degrees_has_no_2hg5() -> None:
    x = sweep([0, 4, -4, 0], 400)
    assert [value.key for value in fit_friction([loop("shear", x, shear_record(x, *SUITING.values()))])] == ["G.warp", "2HG.warp"]


def test_same_bounds_every_time() -> None:
    x = sweep(CYCLE, 300)
    y = shear_record(x, *SUITING.values()) + np.random.default_rng(1).normal(0.0, 0.05, 300)
    assert fit_friction([loop("shear", x, y)]) == fit_friction([loop("shear", x, y)])


def backwards(x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    return x[::-1], y[::-1]


BAD = [
    pytest.param(lambda x, y: (x[:100], y[:100]), "never turns back", id="one way"),
    pytest.param(lambda x, y: (np.sort(x), y[np.argsort(x)]), "never turns back", id="sorted"),
    pytest.param(lambda x, y: (x[:15], y[:15]), "15 samples; 20", id="short"),
    pytest.param(lambda x, y: (x, 0.0 * y), "no extent", id="flat"),
    pytest.param(lambda x, y: (x, y * np.nan), "not finite", id="nan"),
    pytest.param(backwards, "above the way out", id="backwards in time"),
    pytest.param(lambda x, y: (x, -y), "falls where it should rise", id="sign"),
    pytest.param(lambda x, y: (0.2 * x, y), "beyond 2.5 degrees", id="too small"),
    pytest.param(lambda x, y: (x[::30], y[::30]), "at least 4 are wanted", id="coarse"),
]


@pytest.mark.parametrize(("spoil", "words"), BAD)
def test_what_is_no_loop_is_refused(spoil: object, words: str) -> None:
    x = sweep(CYCLE, 640)
    bad = spoil(x, shear_record(x, *DENIM.values()))  # type: ignore[operator]
    with pytest.raises(FabricError) as caught:
        fit_friction([loop("shear", *bad)])
    assert words in str(caught.value)
    assert "made up" in str(caught.value)


ALONE = [
    pytest.param(lambda x, y: (x, np.where(np.arange(len(x)) == 15, 50.0, y)), "sample 16, 50", id="spike"),
    pytest.param(lambda x, y: (x, np.where((np.arange(len(x)) >= 100) & (np.arange(len(x)) < 105), 0.0, y)), "stands alone", id="drop-out"),
    pytest.param(lambda x, y: (np.where(np.arange(len(x)) == 30, 99.0, x), y), "sample 31 stands alone at 99", id="angle"),
    pytest.param(lambda x, y: (x, np.where(np.arange(len(x)) == np.argmax(x) - 2, 40.0, y)), "stands alone", id="before the turn"),
    pytest.param(lambda x, y: (x, np.clip(y, -3.0, 3.0)), "stand still at 3: the amplifier clips", id="clipped above"),
    pytest.param(lambda x, y: (x, np.maximum(y, -3.0)), "stand still at -3: the amplifier clips", id="clipped below"),
]


@pytest.mark.parametrize(("spoil", "words"), ALONE)
def test_samples_that_stand_alone_or_still_are_refused(spoil: object, words: str) -> None:
    """Of a record that is taken without them, with its noise."""
    x = sweep(CYCLE, 320)
    y = shear_record(x, *SUITING.values()) + np.random.default_rng(2).normal(0.0, 0.01, len(x))
    within(fit_friction([loop("shear", x, y)]), SUITING, 0.35)
    with pytest.raises(FabricError, match=words):
        fit_friction([loop("shear", *spoil(x, y))])  # type: ignore[operator]


@pytest.mark.parametrize(("samples", "widest"), [(81, 0.4), (121, 0.14), (161, 0.12), (321, 0.1)])
def test_coarse_records_say_how_little_they_know(samples: int, widest: float) -> None:
    """From 0.4 degrees between samples on; 2HG is read at the kink of the loop, on a stretch of half a degree."""
    x = sweep(CYCLE, samples)
    within(fit_friction([loop("shear", x, shear_record(x, 0.6, 0.9, 1.5))]), {"G": 0.6, "2HG": 0.9, "2HG5": 1.5}, widest)


def test_a_recorder_may_stand_at_its_turns_while_the_force_falls() -> None:
    x = np.concatenate([np.linspace(0.0, 8.0, 60), np.full(6, 8.0), np.linspace(8.0, 0.0, 60)])
    y = np.where(np.arange(126) < 60, 0.5 * x + 0.45, 0.5 * x - 0.45)
    y[60:66] = np.linspace(4.45, 3.55, 6)
    found = {value.key: value.value for value in fit_friction([loop("shear", x, y)])}
    assert found == pytest.approx({"G.warp": 0.5, "2HG.warp": 0.9, "2HG5.warp": 0.9})


def test_a_flat_curve_in_coarse_steps_of_force_is_not_clipped() -> None:
    """It comes to its largest number again and again over degrees, and leaves it in between."""
    x = sweep(CYCLE, 321)
    y = friction_record(x, 0.02, [(0.0, 0.5), (8.0, 0.5)], 200.0) + np.random.default_rng(1).normal(0.0, 0.03, len(x))
    y = np.round(y / 0.05) * 0.05
    top = np.flatnonzero(y[:81] == y[:81].max())
    assert np.ptp(x[top]) > 0.05 * np.ptp(x)
    assert len(loop("shear", x, y).turns) == 4


@pytest.mark.parametrize("seed", range(5))
def test_rounded_moments_are_in_the_bounds(seed: int) -> None:
    """A sheer cloth, B 0.004, whose moments of 0.012 at most are printed to three decimals: in twenty steps, on each of which the record stands."""
    truth = {"B": 0.004, "2HB": 0.0012}
    x = sweep([0, 2.5, -2.5, 0], 200 + 11 * seed, np.random.default_rng(seed))
    within(fit_friction([loop("bending", x, np.round(bending_record(x, *truth.values()), 3))]), truth, 0.7)


@pytest.mark.parametrize(("end", "read"), [(5.0, False), (5.2, False), (5.6, True)])
def test_a_width_is_not_read_where_the_loop_turns(end: float, read: bool) -> None:
    x = sweep([0, end, -end, 0], 801)
    one = loop("shear", x, shear_record(x, *SUITING.values()))
    within(fit_friction([one]), SUITING if read else {"G": SUITING["G"], "2HG": SUITING["2HG"]}, 0.05)
    said = [finding.message for finding in unread([one])]
    why = "no side of the record goes 0.5 degrees beyond and comes back to there"
    assert said == ([] if read else [f"2HG5.warp, at 5 degrees, is not read: {why}"])


def test_a_width_is_not_read_where_the_way_back_stops_before() -> None:
    x = sweep([0, 8, 0], 801)
    y = shear_record(x, *SUITING.values())
    kept = (np.arange(801) < 401) | (x > 3.0)
    one = loop("shear", x[kept], y[kept])
    within(fit_friction([one]), {"G": SUITING["G"], "2HG5": SUITING["2HG5"]}, 0.05)
    assert [finding.message.partition(",")[0] for finding in unread([one])] == ["2HG.warp"]
