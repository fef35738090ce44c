"""Functions and products to the same last bit on every processor.

numpy and the linear algebra below it choose their instructions by the processor that they find. Arc tangents, logarithms, powers and matrix products end in
other bits where its registers are wider, and a drape that begins with them ends in other folds. What a drape depends on takes its functions from the C library
instead, one number at a time, and adds up products in a fixed order. Sums, square roots, sines and cosines of numpy, its `hypot`, and its `einsum` of two
arrays are the same everywhere already; equal keys keep their order where `argsort` is told to be stable.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np


def _one_by_one(function: Callable[..., float], arguments: int) -> Callable[..., Any]:
    each = np.frompyfunc(function, arguments, 1)
    return lambda *values: np.asarray(each(*values), dtype=np.float64)[()]


arccos, arctan2 = _one_by_one(math.acos, 1), _one_by_one(math.atan2, 2)
expm1 = _one_by_one(math.expm1, 1)


def product(a: Any, b: Any) -> np.ndarray:
    """a @ b of arrays: of vectors (N,) and matrices (...,N), (N,M)."""
    return np.asarray(np.einsum("...i,i->..." if np.ndim(b) == 1 else "...i,ij->...j", a, b))


def norm(vector: Any) -> float:
    """|vector| of one (N,)."""
    return math.sqrt(float(np.einsum("i,i", vector, vector)))
