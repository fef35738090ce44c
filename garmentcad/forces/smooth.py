"""Functions without branches, calls or tables, so that loops over them use wide instructions. Errors are relative, against the functions of `math`."""

from __future__ import annotations

from typing import Any

import numpy as np
from llvmlite import ir
from numba import types
from numba.extending import intrinsic

from garmentcad.arrays import kernel

# Adding this to a number below 2^51 rounds it to the nearest integer n, which then stands in the lowest bits of the sum.
_ROUND = 6755399441055744.0
_LOG2_E = 1.4426950408889634
_LN_2 = 0.6931471805599453


@intrinsic
def _power_of_two(_context: Any, rounded: Any) -> Any:
    """2^n from n + _ROUND, by moving n into the exponent's bits."""

    def generate(_: Any, builder: Any, __: Any, arguments: Any) -> Any:
        bits = ir.IntType(64)
        exponent = builder.shl(builder.bitcast(arguments[0], bits), ir.Constant(bits, 52))
        return builder.bitcast(builder.add(exponent, ir.Constant(bits, 1023 << 52)), ir.DoubleType())

    return types.float64(types.float64), generate


@kernel
def expm1_smooth(x):  # type: ignore[no-untyped-def]
    """exp(x) - 1 for |x| <= 700: with x = n ln 2 + r, |r| <= ln(2)/2, it is 2^n expm1(r) + 2^n - 1. Error below 1e-12."""
    rounded = x * _LOG2_E + _ROUND
    r = x - (rounded - _ROUND) * _LN_2
    power = _power_of_two(rounded)  # type: ignore[call-arg, var-annotated]
    r2 = r * r
    r4 = r2 * r2
    low = (1.0 + r * (1.0 / 2.0)) + r2 * (1.0 / 6.0 + r * (1.0 / 24.0))
    middle = (1.0 / 120.0 + r * (1.0 / 720.0)) + r2 * (1.0 / 5040.0 + r * (1.0 / 40320.0))
    high = 1.0 / 362880.0 + r * (1.0 / 3628800.0 + r * (1.0 / 39916800.0))
    return power * (r * (low + r4 * (middle + r4 * high))) + (power - 1.0)


@kernel
def angle_over_sine(cosine):  # type: ignore[no-untyped-def]
    """t/sin(t) from c = cos(t) for 0 <= c <= 1, by a polynomial in 1 - c through its Chebyshev nodes. Error below 1e-11."""
    y = 1.0 - cosine
    y2 = y * y
    y4 = y2 * y2
    y8 = y4 * y4
    a = (0.999999999992449 + y * 0.33333333628998413) + y2 * (0.1333331423509574 + y * 0.057147690059179995)
    b = (0.02533338469529167 + y * 0.012039449369141761) + y2 * (0.002842058386458133 + y * 0.010865392611606076)
    c = (-0.01824225835640979 + y * 0.03163372556124773) + y2 * (-0.033662202060551635 + y * 0.024378553392548623)
    return (a + y4 * b) + y8 * (c + y4 * (-0.010286180543669612 + y * 0.0020802350319021044))


_ratio = getattr(angle_over_sine, "py_func", angle_over_sine)


def arc_sines(sines: np.ndarray) -> np.ndarray:
    """asin [rad] of sines (N,) in -1..1. Error below 1e-11; the same bits on every processor, which `numpy.arcsin` does not give."""
    return np.asarray(sines * _ratio(np.sqrt(1.0 - sines * sines)))


def arc_tangents(y: np.ndarray, x: np.ndarray) -> np.ndarray:
    """atan2(y, x) [rad] (N,), 0 at the origin: by the half of it, whose sine is accurate where it is small. Error below 1e-11; the same bits everywhere."""
    radius = np.maximum(np.sqrt(x * x + y * y), 1e-300)
    large = np.sqrt(0.5 * (1.0 + np.abs(x) / radius))
    small = np.abs(y) / (2.0 * radius * large)
    ahead = x >= 0.0
    return np.copysign(2.0 * np.where(ahead, small, large) * _ratio(np.where(ahead, large, small)), y)
