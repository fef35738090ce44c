"""Bending stiffness from a strip that hangs over an edge under its own weight (ASTM D1388, BS 3356, FAST-2): the exact elastica.

    theta'' = -s cos(theta),  theta'(0) = 0,  theta = 0 at the edge          lengths in c = (B/(W g))^(1/3)
    chord angle = atan(drop/reach) of the tip

s runs from the free tip, theta is the slope below the horizontal. Each tip slope is one initial value problem, and the strip ends where theta reaches 0.
With internal friction the moment m, the integral of s cos(theta) [B/c], bends by the law of `law_bending` out of the flat state: by m/(1 + STICK) where
friction sticks, by m - h where it slides, the larger of the two; h = H c/B.
At the standard chord angle of 41.5 degrees the overhang is 2.0004 c, so that half the overhang, the bending length that the standards print, is c within
0.02 % and B = W g (bending length)^3 within 0.05 %. Peirce's formula c = L (cos(a/2)/(8 tan a))^(1/3) gives 0.5093 L there: B 5.75 % too large.
Source: equilibrium of an inextensible elastic strip; Peirce 1930 for the approximation that is not used here.
"""

from __future__ import annotations

import math
from functools import cache

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from garmentcad.fabric.law_bending import STICK

STANDARD_CHORD_DEG = 41.5


@cache
def overhang_ratio(chord_deg: float = STANDARD_CHORD_DEG, held: float = 0.0) -> float:
    """L/c at which the chord from the edge to the tip lies `chord_deg` (0.5 to 85) below the horizontal. held: H c/B, what internal friction holds."""

    def off(tip_slope: float) -> float:
        return _strip(tip_slope, held)[1] - math.radians(chord_deg)

    return _strip(float(brentq(off, 0.005, 0.5 * math.pi - 1e-9, xtol=1e-12)), held)[0]


def bending_from_overhang(overhang_m: float, weight_n_m2: float, chord_deg: float = STANDARD_CHORD_DEG) -> float:
    """B [N.m] of a strip of weight per area `weight_n_m2` whose overhang [m] reaches the chord angle."""
    return weight_n_m2 * (overhang_m / overhang_ratio(chord_deg)) ** 3


def _strip(tip_slope: float, held: float) -> tuple[float, float]:
    """Length in c and chord angle [rad] of the strip whose tip has this slope [rad]. held: as for `overhang_ratio`."""

    def slopes(s: float, y: np.ndarray) -> tuple[float, float, float, float]:
        return min(y[1] / (1.0 + STICK), y[1] + held), -s * math.cos(y[0]), math.cos(y[0]), math.sin(y[0])

    def level(s: float, y: np.ndarray) -> float:
        return float(y[0])

    level.terminal = True  # type: ignore[attr-defined]
    path = solve_ivp(slopes, (0.0, 50.0), (tip_slope, 0.0, 0.0, 0.0), method="DOP853", events=level, rtol=1e-11, atol=1e-13)
    _, _, reach, drop = path.y_events[0][0]
    return float(path.t_events[0][0]), math.atan2(drop, reach)
