"""The shear loop of KES-FB1 and the bending loop of KES-FB2 to stiffness and hysteresis, as the testers read them.

    slope of the way out inside the window           shear 0.5 to 2.5 degrees: G       bending 0.5 to 1.5 /cm: B
    width of the loop, way out minus way back        at 0.5 and 5 degrees: 2HG, 2HG5   at 1 /cm: 2HB

Both sides of zero count, and their mean is the value; a record of one side only is taken as it is. Where both sides were recorded to about the same extent,
the middle between the turns is the zero of the angle or curvature. A zero of force or moment that is off changes neither slopes nor widths.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from garmentcad.fabric.finding import Finding
from garmentcad.fabric.fitted import FittedValue
from garmentcad.fabric.recorded_loop import SIGMAS, TURN, RecordedLoop, spread_by_noise, value_near

MIN_IN_WINDOW = 4
RESOLVED = 1e-3  # share of a value that a record resolves at best
TURNED = 2.0  # stretches `near` beyond a width that a loop must go: its friction turns on the way
MOST_OFFSET = 0.1  # of the extent; more is a loop that was meant for one side


class Reading(NamedTuple):
    """Where a test is read. near: half width of the stretch of curve that a width is read on."""

    stiffness: str
    window: tuple[float, float]
    widths: dict[str, float]
    near: float
    unit: str


READINGS = {
    "shear": Reading("G", (0.5, 2.5), {"2HG": 0.5, "2HG5": 5.0}, 0.25, "degrees"),
    "bending": Reading("B", (0.5, 1.5), {"2HB": 1.0}, 0.25, "/cm"),
}


class _Side(NamedTuple):
    """One side of zero, turned so that it leads out to positive x. samples: which of the record."""

    out: tuple[np.ndarray, np.ndarray]
    back: tuple[np.ndarray, np.ndarray]
    samples: np.ndarray


def fit_friction(loops: Sequence[RecordedLoop]) -> list[FittedValue]:
    """Values of shear and bending loops. A width beyond the end of a record is left out. FabricError for what is no loop."""
    fitted = []
    for loop in loops:
        found, spread = _values(loop), spread_by_noise(loop, _values)
        kinked, by_noise = _narrowed(loop), spread_by_noise(loop, _narrowed)
        low, high = READINGS[loop.test].window
        window = f", slope between {low:g} and {high:g} {READINGS[loop.test].unit}"
        for name, value in found.items():
            # a kink under the stretch errs in proportion to it; what noise alone would change is no kink
            half = spread[name] + 3.0 * max(0.0, abs(kinked[name]) - by_noise[name] / SIGMAS) + RESOLVED * abs(value)
            how = f"{loop.test} loop of {len(loop.x)} samples" + (window if name == READINGS[loop.test].stiffness else "")
            fitted.append(FittedValue(f"{name}.{loop.way}", value, max(0.0, value - half), value + half, how, (loop.key,)))
    return fitted


def unread(loops: Sequence[RecordedLoop]) -> list[Finding]:
    """A finding for each width and each way of a loop that is not read."""
    found = []
    for loop in loops:
        sides = _sides(loop)
        for name, at in READINGS[loop.test].widths.items():
            if not _reached(loop, sides, at):
                unit, beyond = READINGS[loop.test].unit, TURNED * READINGS[loop.test].near
                why = f"no side of the record goes {beyond:g} {unit} beyond and comes back to there"
                found.append(Finding("warning", f"{loop.file}: {loop.place}", f"{name}.{loop.way}, at {at:g} {unit}, is not read: {why}"))
        left = np.setdiff1d(np.arange(len(loop.x)), np.concatenate([side.samples for side in sides]))
        if len(left) and np.ptp(loop.x[left]) > TURN * np.ptp(loop.x):
            what = f"{len(left)} of {len(loop.x)} samples, the first of them {left[0] + 1}, are not used"
            why = "of each side of zero the first way out and the first way back are read"
            found.append(Finding("warning", f"{loop.file}: {loop.place}", f"{what}: {why}"))
    return found


def _narrowed(loop: RecordedLoop) -> dict[str, float]:
    """By how much the values change where widths are read on half of the stretch."""
    narrow = _values(loop, 0.5)
    return {name: value - narrow[name] for name, value in _values(loop).items()}


def _values(loop: RecordedLoop, narrower: float = 1.0) -> dict[str, float]:
    """Stiffness and widths; `narrower` scales the stretch on which a width is read, and the number of samples where a coarse record has none on it."""
    reading = READINGS[loop.test]
    low, high = reading.window
    sides = _sides(loop)
    slopes = []
    for x, y in (side.out for side in sides):
        inside = (x >= low) & (x <= high)
        if inside.sum() < MIN_IN_WINDOW:
            raise loop.refuse(f"{inside.sum()} samples between {low:g} and {high:g} {reading.unit}, at least {MIN_IN_WINDOW} are wanted")
        slopes.append(np.polynomial.polynomial.polyfit(x[inside], y[inside], 1)[1])
    stiffness = float(np.mean(slopes))
    if stiffness <= 0.0:
        raise loop.refuse("the curve falls where it should rise")
    values = {reading.stiffness: stiffness}
    for name, at in reading.widths.items():
        if reached := _reached(loop, sides, at):
            near, fewest = reading.near * narrower, int(MIN_IN_WINDOW * narrower)
            width = float(np.mean([value_near(*side.out, at, near, fewest) - value_near(*side.back, at, near, fewest) for side in reached]))
            if width < -0.05 * stiffness * at:
                raise loop.refuse(f"at {at:g} {reading.unit} the way back lies {-width:.3g} above the way out")
            values[name] = max(0.0, width)
    return values


def _reached(loop: RecordedLoop, sides: Sequence[_Side], at: float) -> list[_Side]:
    """Sides whose ways out and back both pass `at`, and turn so far beyond that friction has turned before."""
    beyond = at + TURNED * READINGS[loop.test].near
    return [side for side in sides if all(x.min() <= at and x.max() >= beyond for x, _ in (side.out, side.back))]


def _sides(loop: RecordedLoop) -> list[_Side]:
    """The sides of zero that have a way out and a way back, each the first of its kind in the record."""
    reading = READINGS[loop.test]
    ends = float(loop.x.max()), float(loop.x.min())
    middle = 0.5 * sum(ends)
    zero = middle if abs(middle) <= MOST_OFFSET * (ends[0] - ends[1]) / 2.0 else 0.0
    sides = []
    for sign in (1.0, -1.0):
        x, y = sign * (loop.x - zero), sign * loop.y
        out, back = (_first(x, loop.turns, direction, reading.window[1]) for direction in (1.0, -1.0))
        if out is not None and back is not None:
            sides.append(_Side((x[out], y[out]), (x[back], y[back]), np.concatenate([out, back])))
    if not sides:
        raise loop.refuse(f"no side of zero has a way out and a way back beyond {reading.window[1]:g} {reading.unit}")
    return sides


def _first(x: np.ndarray, turns: Sequence[int], direction: float, least: float) -> np.ndarray | None:
    """The samples above zero of the first leg in this direction that goes past `least` and covers half of the way to the furthest point there."""
    furthest = float(x.max())
    for a, b in itertools.pairwise(turns):
        here = a + np.flatnonzero(x[a : b + 1] >= 0.0)
        if direction * (x[b] - x[a]) > 0.0 and furthest > least and len(here) and np.ptp(x[here]) >= 0.5 * furthest:
            return here
    return None
