"""One recorded loop of a KES tester, cut into its branches: how far it goes, where it turns, which part leads out and which comes back."""

from __future__ import annotations

from collections.abc import Callable
from typing import Literal, NamedTuple

import numpy as np

from garmentcad.errors import FabricError

Test = Literal["tension", "shear", "bending"]

MIN_SAMPLES = 20
MAX_SAMPLES = 200_000
TURN = 0.1  # share of the range that the recorder must go back before a point counts as a turn
COPIES = 60  # evaluations with the noise added once more
SIGMAS = 3.0


class RecordedLoop(NamedTuple):
    """x, y in the order of time. Tension: strain %, gf/cm; shear: degrees, gf/cm; bending: 1/cm, gf.cm/cm. Made by `record`.

    turns: first sample, samples where the recorder turns, last sample; place: file and column, for messages.
    """

    test: Test
    way: str
    x: np.ndarray
    y: np.ndarray
    turns: tuple[int, ...]
    place: str

    def refuse(self, message: str) -> FabricError:
        """The error for this loop."""
        return _refuse(self.place, message)


class Leg(NamedTuple):
    """The recorder going one way, from turn to turn. direction: +1 where x grows."""

    x: np.ndarray
    y: np.ndarray
    direction: float


def record(test: Test, way: str, x: np.ndarray, y: np.ndarray, place: str) -> RecordedLoop:
    """A loop from its samples. FabricError for too few of them, no extent, numbers that are not finite, or a record that never turns back."""
    if not MIN_SAMPLES <= len(x) <= MAX_SAMPLES:
        raise _refuse(place, f"{len(x)} samples; {MIN_SAMPLES} to {MAX_SAMPLES} are allowed")
    if not (np.isfinite(x).all() and np.isfinite(y).all()):
        raise _refuse(place, "there are numbers that are not finite")
    extent = float(np.ptp(x))
    if extent <= 0.0 or float(np.ptp(y)) <= 0.0:
        raise _refuse(place, "the curve has no extent")
    turns = _turns(x, TURN * extent)
    if len(turns) < 3:
        raise _refuse(place, "the curve never turns back (a table sorted by its first column is no record of time)")
    return RecordedLoop(test, way, x, y, tuple(turns), place)


def cut_legs(loop: RecordedLoop) -> list[Leg]:
    """The legs of a loop, in the order of time."""
    x, y = loop.x, loop.y
    return [Leg(x[a : b + 1], y[a : b + 1], float(np.sign(x[b] - x[a]))) for a, b in zip(loop.turns[:-1], loop.turns[1:])]


def _refuse(place: str, message: str) -> FabricError:
    return FabricError(f"{message}; a loop that leads out and comes back, in the order of time, is wanted", key=place)


def _turns(x: np.ndarray, threshold: float) -> list[int]:
    """First sample, samples where x turns by more than the threshold, last sample."""
    turns = [0]
    extreme, direction = 0, 0.0
    for i, value in enumerate(x):
        ahead = (value - x[extreme]) * direction
        if direction == 0.0:
            if abs(value - x[0]) > threshold:
                extreme, direction = i, float(np.sign(value - x[0]))
        elif ahead >= 0.0:
            extreme = i
        elif -ahead > threshold:
            turns.append(extreme)
            extreme, direction = i, -direction
    last = len(x) - 1
    return [*turns, extreme] if extreme == last or abs(x[last] - x[extreme]) < 0.5 * threshold else [*turns, extreme, last]


def value_near(x: np.ndarray, y: np.ndarray, at: float, half_width: float) -> float:
    """Height of a branch at x = `at`: a straight line through the samples within half_width, or through the four nearest where they are fewer."""
    near = np.flatnonzero(np.abs(x - at) <= half_width)
    if len(near) < 4:
        near = np.argsort(np.abs(x - at), kind="stable")[:4]
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
    """Half width of the bounds of each value: three standard deviations over copies of the loop to which its own noise was added once more.

    Always the same copies (a fixed seed). The noise is taken as white; a drift of the amplifier is not in it.
    """
    noise = noise_of(loop.y, loop.x)
    if noise == 0.0:
        return dict.fromkeys(values(loop), 0.0)
    random = np.random.default_rng(0)
    copies = [values(loop._replace(y=loop.y + random.normal(0.0, noise, len(loop.y)))) for _ in range(COPIES)]
    return {key: SIGMAS * float(np.std([copy[key] for copy in copies], ddof=1)) for key in copies[0]}
