"""Tension in warp or weft: the loop that the KES-FB1 tester prints, loading curve F and unloading curve (1 - 2 c) F.

    T = F (1 - c + c (e - s)/d)  [N/m],  d = WAY em    for e > 0;  T = F below   (internal_friction.py: H = c F, s the slider)

    F(e) = Fm (exp(x u) - 1)/(exp(x) - 1)  [N/m],  u = e/em     for 0 <= e <= em
    F(e) = k e,  k = Fm x/(em (exp(x) - 1))                     for e < 0 (repel): the initial slope
    F(e) = Fm + (k + x Fm/em) (e - em)                          for e > em: the tangent at em

em: strain at Fm (EMT/100); Fm: force per width at the end of the test [N/m]; x: exponent, solved from the linearity LT of the same sheet,
LT = (energy up to em)/(Fm em/2) = 2/x - 2/(exp(x) - 1). x = 0 is linear (LT = 1), x > 0 stiffens (LT < 1), x < 0 softens (LT > 1).
Inside the curve the tangent is k + (x/em) F, so that one exponential gives force and tangent, and none is needed outside.
c is solved from RT, the share of the energy that comes back on the way from em to 0; on its first 2 d the stick springs turn (`friction_share`).
Cloth that was never stretched has its slider at -d: its first loading is F, the printed curve, from the first bit on.
Source: definitions of LT, WT and RT of the KES-FB1 tester (Kawabata 1980); the exponential is this project's choice of a curve with that LT.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from scipy.optimize import brentq

from garmentcad.arrays import entry, kernel
from garmentcad.errors import FabricError
from garmentcad.fabric.internal_friction import dragged
from garmentcad.geometry.portable import expm1

SMALL = 1e-4  # below this |x u| the series are exact to double precision and expm1(z) - z would cancel
LARGEST_EXPONENT = 60.0  # LT 0.033 .. 1.967
WAY = 0.1  # of em: the stick spring turns over a reversal of 0.2 em, an estimate
_PLACES, _WEIGHTS = (tuple(map(float, column)) for column in np.polynomial.legendre.leggauss(10))


@entry
@kernel
def loading(strain: float, em: float, fm: float, exponent: float, slope: float) -> tuple[float, float]:
    """F [N/m] and dF/de [N/m] at an engineering strain. `slope` is `initial_slope(em, fm, exponent)`."""
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
def tension(strain: float, slider: float, friction: float, em: float, fm: float, exponent: float, slope: float) -> tuple[float, float, float]:
    """Force per width [N/m], its tangent [N/m] and the slider at an engineering strain. friction: c."""
    force, tangent = loading(strain, em, fm, exponent, slope)
    after = dragged(slider, strain, WAY * em)
    if strain <= 0.0:
        return force, tangent, after
    rate = friction / (WAY * em)
    share = 1.0 - friction + rate * (strain - after)
    return share * force, share * tangent + (rate * force if after == slider else 0.0), after


@kernel
def tension_energy(strain: float, slider: float, friction: float, em: float, fm: float, exponent: float, slope: float) -> float:
    """Stored energy per area [J/m2] at an engineering strain; the arguments are those of `tension`."""
    after, stuck = dragged(slider, strain, WAY * em), 0.0
    for a, b in ((min(max(after, 0.0), em), min(max(strain, 0.0), em)), (max(after, em), max(strain, em))):
        for place, weight in zip(_PLACES, _WEIGHTS):
            e = 0.5 * (a + b) + 0.5 * (b - a) * place
            stuck += 0.5 * (b - a) * weight * loading(e, em, fm, exponent, slope)[0] * (e - after)
    elastic = 1.0 - friction if strain > 0.0 else 1.0
    return elastic * loading_energy(strain, em, fm, exponent, slope) + friction / (WAY * em) * stuck


@entry
@kernel
def loading_energy(strain: float, em: float, fm: float, exponent: float, slope: float) -> float:
    """Energy per area [J/m2] that loading up to `strain` takes: the integral of `loading` from 0."""
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
    return (np.asarray(fm) / np.asarray(em) * np.where(small, 1.0 - 0.5 * x, safe / expm1(safe)))[()]


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


def friction_share(resilience: float, exponent: float) -> float:
    """c with which the loop up to em gives RT/100 = `resilience` of its energy back: (1 - RT/100)/(2 (1 - J/W)), at most 1/2, J/W of `least_resilience`.

    With more than 1/2 the cloth would push on its way back: a sheet of less resilience prints more than its RT.
    """
    return min(0.5 * (1.0 - resilience) / (1.0 - least_resilience(exponent)), 0.5)


def least_resilience(exponent: float) -> float:
    """J/W, the least share of its energy that a loop up to em can give back: 0.26 at LT 0.65, 0.45 at 0.3.

    W is the energy up to em, J that which the stick springs let through while they turn: of F (e - em + 2 d)/(2 d) over the last 2 d.
    """
    slope = float(initial_slope(1.0, 1.0, exponent))
    turned = 0.0
    for place, weight in zip(_PLACES, _WEIGHTS):
        u = 1.0 - WAY + WAY * place
        turned += WAY * weight * loading(u, 1.0, 1.0, exponent, slope)[0] * (u - 1.0 + 2.0 * WAY) / (2.0 * WAY)
    return float(turned / loading_energy(1.0, 1.0, 1.0, exponent, slope))


def strain_at_force(force: float, em: float, fm: float, exponent: float) -> float:
    """Strain at which the curve carries `force` [N/m]; the inverse of `loading`."""
    slope = float(initial_slope(em, fm, exponent))
    if force <= 0.0:
        return force / slope
    if force >= fm:
        return em + (force - fm) / (slope + exponent / em * fm)
    if abs(exponent) < 1e-8:
        return force / fm * em
    return em / exponent * math.log1p(force / fm * math.expm1(exponent))
