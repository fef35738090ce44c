"""Many vectors of three, row by row, as numpy does it fast and to the same bits: it adds up rows along their axis five times as slowly as columns, and picks
rows out by indexing six times as slowly as by `take`."""

from __future__ import annotations

import numpy as np


def picked(points: np.ndarray, rows: np.ndarray) -> tuple[np.ndarray, ...]:
    """points[rows[:, k]] for each column k of rows (N,K), one after the other; points (P,3)."""
    return tuple(points.take(column, axis=0) for column in rows.T)


def dots(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """a.b (N,) of rows (N,3)."""
    return np.asarray(a[:, 0] * b[:, 0] + a[:, 1] * b[:, 1] + a[:, 2] * b[:, 2])


def lengths(a: np.ndarray) -> np.ndarray:
    """|a| (N,) of rows (N,3)."""
    return np.sqrt(dots(a, a))
