"""Angles by a polynomial: without calls or branches, so that loops over them use wide instructions, and to the same bits on every processor, which the arc
functions of numpy do not give (see portable.py). Errors are relative."""

from __future__ import annotations

from typing import Any

import numpy as np

from garmentcad.arrays import kernel


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


_ratio = getattr(angle_over_sine, "py_func", angle_over_sine)  # of arrays


def arcsin(sine: Any) -> np.ndarray:
    """Angles [rad] in -pi/2..pi/2 of sines (...) in -1..1. Error below 1e-11."""
    return np.asarray(sine * _ratio(np.sqrt(1.0 - sine * sine)))


def arctan2(y: Any, x: Any) -> np.ndarray:
    """Angles [rad] in -pi..pi of directions (x, y) (...), 0 where both are 0. Error below 1e-11: by half the angle, whose sine is exact where it is small."""
    radius = np.maximum(np.sqrt(x * x + y * y), 1e-300)
    large = np.sqrt(0.5 * (1.0 + np.abs(x) / radius))
    small = np.abs(y) / (2.0 * radius * large)
    ahead = x >= 0.0
    return np.asarray(np.copysign(2.0 * np.where(ahead, small, large) * _ratio(np.where(ahead, large, small)), y))
