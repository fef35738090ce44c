"""Records of KES testers made up from known sheets, step by step, by a spring and a slider in parallel with the elastic law; no code of the program."""

from __future__ import annotations

import math

import numpy as np


def sweep(turns: list[float], samples: int, rng: np.random.Generator | None = None) -> np.ndarray:
    """Positions of the recorder from turn to turn, at an even pace or (rng) with steps that differ by up to four times."""
    path = np.concatenate(([0.0], np.cumsum(np.abs(np.diff(turns)))))
    steps = np.ones(samples - 1) if rng is None else rng.uniform(0.4, 1.6, samples - 1)
    along = np.concatenate(([0.0], np.cumsum(steps)))
    return np.interp(along / along[-1] * path[-1], path, turns)


def friction_record(x: np.ndarray, elastic: float, limit: list[tuple[float, float]], stick: float = 15.0) -> np.ndarray:
    """Elastic slope plus a stick spring (`stick` times the slope) in series with a slider whose limit is given at |x| by (x, limit) corners."""
    at, heights = zip(*limit)
    most = np.interp(np.abs(x), at, heights)
    slider, held = 0.0, np.zeros(len(x))
    for i in range(1, len(x)):
        slider = min(max(slider + stick * elastic * (x[i] - x[i - 1]), -most[i]), most[i])
        held[i] = slider
    return elastic * x + held


def shear_record(x: np.ndarray, g: float, hg: float, hg5: float) -> np.ndarray:
    """A tester that prints G between 0.5 and 2.5 degrees, 2HG at 0.5 and 2HG5 at 5 degrees."""
    rise = (hg5 - hg) / 9.0
    return friction_record(x, g - rise, [(0.0, hg / 2), (0.5, hg / 2), (8.5, hg / 2 + 8.0 * rise)])


def bending_record(x: np.ndarray, b: float, hb: float) -> np.ndarray:
    """A tester that prints B between 0.5 and 1.5 /cm and 2HB at 1 /cm."""
    return friction_record(x, b, [(0.0, hb / 2), (3.0, hb / 2)])


def loading(strain: np.ndarray, lt: float, emt: float, fm: float) -> np.ndarray:
    """F = Fm (e^(xu) - 1)/(e^x - 1) with the exponent x of the linearity, found by bisection of 2/x - 2/(e^x - 1)."""
    low, high = -40.0, 40.0
    for _ in range(200):
        x = 0.5 * (low + high)
        low, high = (x, high) if (2 / x - 2 / math.expm1(x) if abs(x) > 1e-9 else 1.0) > lt else (low, x)
    return fm * np.expm1(x * strain / emt) / np.expm1(x)


def tension_record(strain: np.ndarray, lt: float, rt: float, emt: float, fm: float) -> np.ndarray:
    """Out along the curve, back along RT percent of it; the change from one to the other takes a tenth of the strain."""
    force = loading(strain, lt, emt, fm)
    top = int(np.argmax(strain))
    back = np.arange(len(strain)) > top
    share = np.clip((strain[top] - strain) / (0.1 * emt), 0.0, 1.0)
    return np.where(back, force * (1.0 - share * (1.0 - rt / 100.0)), force)


def table(header: str, *columns: np.ndarray) -> str:
    """Text of a curve file; the shorter columns end in blanks."""
    longest = max(len(column) for column in columns)
    rows = [";".join(f"{column[i]:.6g}" if i < len(column) else "" for column in columns) for i in range(longest)]
    return "\n".join([header, *rows]) + "\n"
