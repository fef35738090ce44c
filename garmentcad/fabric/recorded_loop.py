"""One recorded loop of a KES tester, cut into its branches: how far it goes, where it turns, which part leads out and which comes back.

A record with samples that stand alone, or whose amplifier clips, is refused: a single one of them can move a value by a third, and no bound shows it.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from contextlib import suppress
from typing import Literal, NamedTuple

import numpy as np

from garmentcad.errors import FabricError

Test = Literal["tension", "shear", "bending"]

MIN_SAMPLES = 20
MAX_SAMPLES = 200_000
TURN = 0.1  # share of the range that the recorder must go back before a point counts as a turn
# A sample stands alone where it is this far from the median of those around it, so many on either side: a curve that rises or falls, however steeply, goes
# through its own median. Strain and angle turn, by a step or two of a coarse record.
AROUND, ALONE_SHARE, ALONE_SIGMAS = 5, 0.05, 8.0
AROUND_TURN, ALONE_AT_TURN = 2, 0.2
ALONE_AT_END = 0.5  # share of the range, of the last sample before a turn from the line through the two before it: a tension curve is steep there
AT_TURN = 0.002  # share of the way within which the recorder stands
CLIPPED = 0.05  # share of the way over which the force or moment stands still at its largest
MOST_DECIMALS = 5  # to which a record may be printed so that it counts as rounded
STANDS_ON = 3.0  # steps: a curve printed in few steps stands on each; on the last one no longer than on so many
COPIES = 60  # evaluations with the noise added once more
LEAST_READ = 0.8  # share of them that must be readable
SIGMAS = 3.0


class RecordedLoop(NamedTuple):
    """x, y in the order of time. Tension: strain %, gf/cm; shear: degrees, gf/cm; bending: 1/cm, gf.cm/cm. Made by `record`.

    turns: first sample, samples where the recorder turns, last sample; file, place: where it stands, for messages.
    """

    test: Test
    way: str
    x: np.ndarray
    y: np.ndarray
    turns: tuple[int, ...]
    file: str
    place: str

    @property
    def key(self) -> str:
        """What was tested: `tension.warp`."""
        return f"{self.test}.{self.way}"

    def refuse(self, message: str) -> FabricError:
        """The error for this loop."""
        return _refuse(self.file, self.place, message)


class Leg(NamedTuple):
    """The recorder going one way, from turn to turn. direction: +1 where x grows."""

    x: np.ndarray
    y: np.ndarray
    direction: float


def record(test: Test, way: str, x: np.ndarray, y: np.ndarray, file: str, place: str) -> RecordedLoop:
    """A loop from its samples. FabricError for too few of them, no extent, numbers that are not finite, a record that never turns back, and samples that stand
    alone or still."""
    if not MIN_SAMPLES <= len(x) <= MAX_SAMPLES:
        raise _refuse(file, place, f"{len(x)} samples; {MIN_SAMPLES} to {MAX_SAMPLES} are allowed")
    if not (np.isfinite(x).all() and np.isfinite(y).all()):
        raise _refuse(file, place, "there are numbers that are not finite")
    extent = float(np.ptp(x))
    if extent <= 0.0 or float(np.ptp(y)) <= 0.0:
        raise _refuse(file, place, "the curve has no extent")
    if (jump := _alone(x, AROUND_TURN, ALONE_AT_TURN * _range(x))) is not None:
        raise _refuse(file, place, f"sample {jump + 1} stands alone at {x[jump]:g}, between {x[max(0, jump - 1)]:g} and {x[min(len(x) - 1, jump + 1)]:g}")
    turns = _turns(x, TURN * extent)
    if len(turns) < 3:
        raise _refuse(file, place, "the curve never turns back (a table sorted by its first column is no record of time)")
    loop = RecordedLoop(test, way, x, y, tuple(turns), file, place)
    height = _range(y)
    off = max(ALONE_SHARE * height, ALONE_SIGMAS * noise_of(y, x))
    for a, b in _moving(x, turns, AT_TURN * extent):
        _refuse_alone(loop, a, b, off, max(ALONE_AT_END * height, off))
        _refuse_still(loop, a, b, CLIPPED * extent)
    return loop


def _refuse_alone(loop: RecordedLoop, a: int, b: int, off: float, off_at_end: float) -> None:
    """FabricError where a sample from a to b stands alone; both bounds in the unit of y."""
    x, y = loop.x, loop.y
    lone = _alone(y[a : b + 1], AROUND, off)
    if lone is None and b - a > 1 and abs(y[b] - 2.0 * y[b - 1] + y[b - 2]) > off_at_end:
        lone = b - a
    if lone is not None:
        raise loop.refuse(f"sample {a + lone + 1}, {y[a + lone]:g} at {x[a + lone]:g}, stands alone between its neighbours")


def _refuse_still(loop: RecordedLoop, a: int, b: int, least: float) -> None:
    """FabricError where from sample a to b y stands still at its largest, of shear and bending at its smallest too, while x goes farther than `least`."""
    x, y = loop.x[a : b + 1], loop.y[a : b + 1]
    for value in (y.max(),) if loop.test == "tension" else (y.max(), y.min()):
        still = np.flatnonzero(y == value)
        if np.ptp(x[still]) > max(least, STANDS_ON * printed_step(y) / max(_range(y), 1e-12) * np.ptp(x)) and len(still) == still[-1] - still[0] + 1:
            raise loop.refuse(f"samples {a + still[0] + 1} to {a + still[-1] + 1} stand still at {value:g}: the amplifier clips")


def _moving(x: np.ndarray, turns: list[int], near: float) -> list[tuple[int, int]]:
    """First and last sample of each leg without those within `near` of its turns, where the recorder may stand while the force falls."""
    found = []
    for a, b in itertools.pairwise(turns):
        going = a + np.flatnonzero((np.abs(x[a : b + 1] - x[a]) > near) & (np.abs(x[a : b + 1] - x[b]) > near))
        found += [(int(going[0]), int(going[-1]))] if len(going) else []
    return found


def _range(values: np.ndarray) -> float:
    """Extent of the values without the outermost hundredth at either end."""
    low, high = np.percentile(values, (1.0, 99.0))
    return float(high - low)


def _alone(values: np.ndarray, around: int, off: float) -> int | None:
    """The sample that is farthest from the median of those around it, where that is more than `off`; the ends are mirrored, so that they may be steep."""
    reach = min(around, len(values) - 1)
    before, after = 2.0 * values[0] - values[reach:0:-1], 2.0 * values[-1] - values[-2 : -reach - 2 : -1]
    windows = np.lib.stride_tricks.sliding_window_view(np.concatenate([before, values, after]), 2 * reach + 1)
    apart = np.abs(values - np.median(windows, axis=1))
    worst = int(np.argmax(apart))
    return worst if apart[worst] > off else None


def cut_legs(loop: RecordedLoop) -> list[Leg]:
    """The legs of a loop, in the order of time."""
    x, y = loop.x, loop.y
    return [Leg(x[a : b + 1], y[a : b + 1], float(np.sign(x[b] - x[a]))) for a, b in itertools.pairwise(loop.turns)]


def _refuse(file: str, place: str, message: str) -> FabricError:
    return FabricError(f"{message}; a loop that leads out and comes back, in the order of time, is wanted", file=file, key=place)


def _turns(x: np.ndarray, threshold: float) -> list[int]:
    """First sample, samples where x turns by more than the threshold, last sample."""
    turns = [0]
    extreme, direction = 0, 0.0
    for i, value in enumerate(x):
        ahead = (value - x[extreme]) * direction
        if direction == 0.0:
            if abs(value - x[0]) > threshold:
                extreme, direction = i, float(np.sign(value - x[0]))
        elif ahead > 0.0:  # where the recorder stands, the force that falls meanwhile belongs to the way back
            extreme = i
        elif -ahead > threshold:
            turns.append(extreme)
            extreme, direction = i, -direction
    last = len(x) - 1
    return [*turns, extreme] if extreme == last or abs(x[last] - x[extreme]) < 0.5 * threshold else [*turns, extreme, last]


def value_near(x: np.ndarray, y: np.ndarray, at: float, half_width: float, fewest: int) -> float:
    """Height of a branch at x = `at`: a straight line through the samples within half_width, or through the `fewest` nearest where they are fewer."""
    near = np.flatnonzero(np.abs(x - at) <= half_width)
    if len(near) < fewest:
        near = np.argsort(np.abs(x - at), kind="stable")[:fewest]
    return float(np.polynomial.polynomial.polyfit(x[near] - at, y[near], 1)[0])


def noise_of(y: np.ndarray, x: np.ndarray) -> float:
    """Standard deviation of the noise: each sample against the chord of its neighbours, by the median, so that turns and steps do not count."""
    span = x[2:] - x[:-2]
    usable = np.abs(span) > 1e-12
    share = np.where(usable, (x[1:-1] - x[:-2]) / np.where(usable, span, 1.0), 0.5)
    usable &= (share >= 0.0) & (share <= 1.0)
    if not usable.any():
        return 0.0
    off = y[1:-1] - ((1.0 - share) * y[:-2] + share * y[2:])
    return float(1.4826 * np.median((np.abs(off) / np.sqrt(1.0 + share**2 + (1.0 - share) ** 2))[usable]))


def spread_by_noise(loop: RecordedLoop, values: Callable[[RecordedLoop], dict[str, float]]) -> dict[str, float]:
    """Half width of the bounds of each value: three standard deviations over copies of the loop to which its own noise was added once more, or the rounding of
    forces and moments where that is more.

    Always the same copies (a fixed seed). The noise is taken as white; a drift of the amplifier is not in it, nor that strains and angles are rounded: they
    may as well have been recorded at just these steps.
    """
    noise = max(noise_of(loop.y, loop.x), printed_step(loop.y) / math.sqrt(12.0))
    if noise == 0.0:
        return dict.fromkeys(values(loop), 0.0)
    random = np.random.default_rng(0)
    copies = []
    for _ in range(COPIES):
        with suppress(FabricError):
            copies.append(values(loop._replace(y=loop.y + random.normal(0.0, noise, len(loop.y)))))
    if len(copies) < LEAST_READ * COPIES:
        raise loop.refuse(f"its noise of {noise:.2g} is too large: with as much once more {COPIES - len(copies)} of {COPIES} copies cannot be read")
    return {key: SIGMAS * float(np.std([copy[key] for copy in copies], ddof=1)) for key in copies[0]}


def printed_step(values: np.ndarray) -> float:
    """Step of numbers that are printed to a few decimals, 0.001 for 3; 0 for more than MOST_DECIMALS."""
    for decimals in range(MOST_DECIMALS + 1):
        if np.allclose(values, np.round(values, decimals), rtol=0.0, atol=1e-9):
            return float(10.0**-decimals)
    return 0.0
