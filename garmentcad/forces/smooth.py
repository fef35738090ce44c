"""Functions without branches, calls or tables, so that loops over them use wide instructions. Errors are relative, against the functions of `math`."""

from __future__ import annotations

from typing import Any

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
