"""Functions and products to the same last bit on every processor.

numpy and the linear algebra below it choose their instructions by the processor that they find. Arc tangents, logarithms, powers and matrix products end in
other bits where its registers are wider, and a drape that begins with them ends in other folds. What a drape depends on takes angles from angle.py, eigenvalues
from eigen.py and the rest from here. Sums, square roots, sines and cosines of numpy, its `hypot`, and its `einsum` of two arrays are the same everywhere
already; equal keys keep their order where `argsort` is told to be stable.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

_expm1 = np.frompyfunc(math.expm1, 1, 1)


def expm1(x: Any) -> np.ndarray:
    """exp(x) - 1 of numbers (...), by the C library, one at a time: for tables, not for particles."""
    return np.asarray(_expm1(x), dtype=np.float64)


def product(a: Any, b: Any) -> np.ndarray:
    """a @ b of arrays: of vectors (N,) and matrices (...,N), (N,M)."""
    return np.asarray(np.einsum("...i,i->..." if np.ndim(b) == 1 else "...i,ij->...j", a, b))


def norm(vector: Any) -> float:
    """|vector| of one (N,)."""
    return math.sqrt(float(np.einsum("i,i", vector, vector)))
