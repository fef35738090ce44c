"""Bending stiffness from a strip that is slid over an edge under its own weight (ASTM D1388, BS 3356, FAST-2): the exact elastica.

    theta'' = -s cos(theta),  theta'(0) = 0,  theta = 0 at the edge          lengths in c = (B/(W g))^(1/3)
    chord angle = atan(drop/reach) of the tip

s runs from the free tip, theta is the slope below the horizontal. Each tip slope is one initial value problem, and the strip ends where theta reaches 0.
At the standard chord angle of 41.5 degrees the overhang is 2.0004 c, so that half the overhang, the bending length that the standards print, is c within
0.02 % and B = W g (bending length)^3 within 0.05 %. Peirce's formula c = L (cos(a/2)/(8 tan a))^(1/3) gives 0.5093 L there: B 5.75 % too large.

With internal friction the shape depends on the way there. Each place bends most at the edge, where all that is out pulls at it; farther out the strip turns
down, the arm of the weight beyond grows shorter, and friction keeps a part of the curvature. Little friction therefore shortens the overhang (by 2.3 % at
H c/B = 0.1), more lengthens it (by 24 % at 1), where a strip that is let down at its full length would be longer by 5 and 35 %.
Source: equilibrium of an inextensible elastic strip with the law of `law_bending`; Peirce 1930 for the approximation that is not used here.
"""

from __future__ import annotations

import math
from functools import cache

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from garmentcad.arrays import entry, kernel
from garmentcad.fabric.law_bending import STICK

STANDARD_CHORD_DEG = 41.5
_PIECE = 0.04  # c that is slid out at a time: overhangs right to 2e-4
_SAME_BEND = 1e-9  # 1/c: corrections of a curvature that end the search
_MOST_CORRECTIONS = 500
_EDGE_MOMENT = 0.4001  # at the edge of an elastic strip at the standard angle, in W g L^2
_RATIOS = (1.9, 5.1)  # between which all overhangs with friction lie, in c: 1.954 at H c/B = 0.11; stick springs alone bear 5.04


@cache
def overhang_ratio(chord_deg: float = STANDARD_CHORD_DEG) -> float:
    """L/c at which the chord from the edge to the tip lies `chord_deg` (0.5 to 85) below the horizontal, without internal friction."""

    def off(tip_slope: float) -> float:
        return _strip(tip_slope)[1] - math.radians(chord_deg)

    return _strip(float(brentq(off, 0.005, 0.5 * math.pi - 1e-9, xtol=1e-12)))[0]


def slid_ratio(held: float) -> float:
    """L/c at which the chord lies 41.5 degrees below the horizontal, slid out piece by piece. held: H c/B, what internal friction holds."""
    ratio = float(_slide_out(held, *np.zeros((3, math.ceil(_RATIOS[1] / _PIECE)))))
    if math.isnan(ratio):
        raise ArithmeticError(f"a strip with H c/B = {held:g} finds no equilibrium on its way to {STANDARD_CHORD_DEG:g} degrees")
    return ratio


def bending_from_overhang(overhang_m: float, weight_n_m2: float, friction_n: float = 0.0, friction_1_m: float = 0.0) -> float:
    """B [N.m] of a strip of weight per area `weight_n_m2` whose overhang [m] reaches 41.5 degrees. friction_n: H = 2HB/2 of its internal friction [N];
    friction_1_m: H over B [1/m], where only that is known.

    ValueError where friction would nowhere give way: only its stick springs, an estimate, would bend then, and B is not in the reading.
    """
    if friction_n == friction_1_m == 0.0:
        return weight_n_m2 * (overhang_m / overhang_ratio()) ** 3
    if friction_n >= STICK / (1.0 + STICK) * _EDGE_MOMENT * weight_n_m2 * overhang_m**2:
        raise ValueError(f"a friction of {friction_n:g} N nowhere gives way in a strip of {overhang_m:g} m and {weight_n_m2:g} N/m2")

    def longer(length: float) -> float:
        return length * slid_ratio(friction_n / (weight_n_m2 * length**2) + friction_1_m * length) - overhang_m

    shortest, longest = (overhang_m / ratio for ratio in reversed(_RATIOS))
    return weight_n_m2 * float(brentq(longer, shortest, longest, xtol=1e-5 * overhang_m)) ** 3


def _strip(tip_slope: float) -> tuple[float, float]:
    """Length in c and chord angle [rad] of the strip whose tip has this slope [rad]."""

    def slopes(s: float, y: np.ndarray) -> tuple[float, float, float, float]:
        return y[1], -s * math.cos(y[0]), math.cos(y[0]), math.sin(y[0])

    def level(s: float, y: np.ndarray) -> float:
        return float(y[0])

    level.terminal = True  # type: ignore[attr-defined]
    path = solve_ivp(slopes, (0.0, 50.0), (tip_slope, 0.0, 0.0, 0.0), method="DOP853", events=level, rtol=1e-11, atol=1e-13)
    _, _, reach, drop = path.y_events[0][0]
    return float(path.t_events[0][0]), math.atan2(drop, reach)


@entry
@kernel
def _slide_out(held, curvature, slider, slope):  # type: ignore[no-untyped-def]
    """`slid_ratio`, NaN where it finds none. Of the joints that end the pieces, from the tip, the last one at the edge: curvature, slider [1/c] (N,) of zeros;
    slope [rad] (N,) of the pieces."""
    angle = 0.0
    for edge in range(len(curvature)):
        if not _settle(edge, held, curvature, slider, slope):
            break
        reach = drop = 0.0
        for i in range(edge + 1):
            slider[i] = min(max(slider[i], curvature[i] - held / STICK), curvature[i] + held / STICK)
            reach, drop = reach + math.cos(slope[i]), drop + math.sin(slope[i])
        before, angle = angle, math.degrees(math.atan2(drop, reach))
        if angle >= STANDARD_CHORD_DEG:
            return _PIECE * (edge + 1 - (angle - STANDARD_CHORD_DEG) / (angle - before))
    return math.nan


@kernel
def _settle(edge, held, curvature, slider, slope):  # type: ignore[no-untyped-def]
    """Curvatures (N,) of the joints up to the one at the edge into equilibrium, from a guess and the sliders before; slope (N,) follows. False where they find
    none."""
    for _ in range(_MOST_CORRECTIONS):
        turned = 0.0
        for i in range(edge, -1, -1):
            turned += (0.5 if i == edge else 1.0) * _PIECE * curvature[i]  # the joint at the edge has half a piece
            slope[i] = turned
        reach = passed = off = 0.0
        for i in range(edge + 1):
            forward = _PIECE * math.cos(slope[i])
            reach, passed = reach + forward, passed + reach + 0.5 * forward
            moment = _PIECE * ((i + 1) * reach - passed)  # of the weight beyond
            stuck = (moment + STICK * slider[i]) / (1.0 + STICK)
            pulled = STICK * (stuck - slider[i])
            asked = moment - held if pulled > held else (moment + held if pulled < -held else stuck)
            off = max(off, abs(asked - curvature[i]))
            curvature[i] = 0.5 * (curvature[i] + asked)
        if off < _SAME_BEND:
            return True
    return False
