"""Tension in warp or weft, elastic: the loading curve that the KES-FB1 tester prints.

    F(e) = Fm (exp(x u) - 1)/(exp(x) - 1)  [N/m],  u = e/em     for 0 <= e <= em
    F(e) = k e,  k = Fm x/(em (exp(x) - 1))                     for e < 0 (repel): the initial slope
    F(e) = Fm + (k + x Fm/em) (e - em)                          for e > em: the tangent at em

em: strain at Fm (EMT/100); Fm: force per width at the end of the test [N/m]; x: exponent, solved from the linearity LT of the same sheet,
LT = (energy up to em)/(Fm em/2) = 2/x - 2/(exp(x) - 1). x = 0 is linear (LT = 1), x > 0 stiffens (LT < 1), x < 0 softens (LT > 1).
Inside the curve the tangent is k + (x/em) F, so that one exponential gives force and tangent, and none is needed outside.
Source: definitions of LT and WT of the KES-FB1 tester (Kawabata 1980); the exponential is this project's choice of a curve with that LT.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from scipy.optimize import brentq

from garmentcad.arrays import kernel
from garmentcad.errors import FabricError

SMALL = 1e-4  # below this |x u| the series are exact to double precision and expm1(z) - z would cancel
LARGEST_EXPONENT = 60.0  # LT 0.033 .. 1.967


@kernel
def tension(strain: float, em: float, fm: float, exponent: float, slope: float) -> tuple[float, float]:
    """Force per width [N/m] and tangent dF/de [N/m] at an engineering strain. `slope` is `initial_slope(em, fm, exponent)`."""
    if strain <= 0.0:
        return slope * strain, slope
    rate = exponent / em
    if strain >= em:
        tangent = slope + rate * fm
        return fm + tangent * (strain - em), tangent
    z = rate * strain
    if abs(z) < SMALL:
        force = slope * strain * (1.0 + z * (0.5 + z * (1.0 / 6.0 + z / 24.0)))
    else:
        force = slope / rate * math.expm1(z)
    return force, slope + rate * force


@kernel
def tension_energy(strain: float, em: float, fm: float, exponent: float, slope: float) -> float:
    """Energy per area [J/m2]: the integral of `tension` from 0 to `strain`."""
    if strain <= 0.0:
        return 0.5 * slope * strain * strain
    inside = min(strain, em)
    rate = exponent / em
    z = rate * inside
    if abs(z) < 1e-2:  # (exp(z) - 1 - z)/z^2 by its series, exact to double precision here
        energy = slope * inside * inside * (0.5 + z * (1.0 / 6.0 + z * (1.0 / 24.0 + z * (1.0 / 120.0 + z * (1.0 / 720.0 + z / 5040.0)))))
    else:
        energy = slope * (math.expm1(z) - z) / (rate * rate)
    beyond = strain - inside
    return energy + beyond * (fm + 0.5 * (slope + rate * fm) * beyond)


def initial_slope(em: Any, fm: Any, exponent: Any) -> Any:
    """Slope of the curve at zero strain [N/m], k = Fm x/(em (exp(x) - 1)). Numbers or arrays."""
    x = np.asarray(exponent, dtype=np.float64)
    small = np.abs(x) < 1e-8
    safe = np.where(small, 1.0, x)
    return (np.asarray(fm) / np.asarray(em) * np.where(small, 1.0 - 0.5 * x, safe / np.expm1(safe)))[()]


def linearity(exponent: float) -> float:
    """LT of the curve with this exponent, 2/x - 2/(exp(x) - 1)."""
    x = exponent
    if abs(x) < 0.05:
        return 1.0 - x / 6.0 * (1.0 - x * x / 60.0 * (1.0 - x * x / 42.0))
    return 2.0 / x - 2.0 / math.expm1(x)


def solve_exponent(lt: float) -> float:
    """Exponent x of the curve with linearity LT. FabricError for LT outside 0.05..1.95, where no curve of this family lies."""
    if not 0.05 <= lt <= 1.95:
        raise FabricError(f"LT = {lt!r} is outside 0.05..1.95, the linearities that a tensile curve can have", key="LT")
    return float(brentq(lambda x: linearity(x) - lt, -LARGEST_EXPONENT, LARGEST_EXPONENT, xtol=1e-13, rtol=1e-14))


def strain_at_force(force: float, em: float, fm: float, exponent: float) -> float:
    """Strain at which the curve carries `force` [N/m]; the inverse of `tension`."""
    slope = float(initial_slope(em, fm, exponent))
    if force <= 0.0:
        return force / slope
    if force >= fm:
        return em + (force - fm) / (slope + exponent / em * fm)
    if abs(exponent) < 1e-8:
        return force / fm * em
    return em / exponent * math.log1p(force / fm * math.expm1(exponent))
