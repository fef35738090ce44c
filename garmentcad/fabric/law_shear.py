"""Shear (trellis angle between warp and weft): T = G_e gamma + k(gamma) (gamma - s) [N/m], s the slider, k d = H(gamma) (internal_friction.py).

gamma [rad] is the departure of the angle between warp and weft from its rest value; T is force per width. H [N/m], half the width of the loop on the KES-FB1
tester, is 2HG/2 below 0.5 degrees, rises linearly to 2HG5/2 at 5 degrees and is constant beyond. The slope G that the tester prints between 0.5 and 2.5
degrees holds dH/dgamma, hence G_e = G - (2HG5 - 2HG)/(2 x 4.5 degrees), times the share of the window on which H rises where a sheet names another one;
1 gf/(cm deg) = 56.19 N/m per rad. Beyond the tester's 8 degrees T goes on with the same slope.
"""

from __future__ import annotations

import math

import numpy as np

from garmentcad.arrays import kernel
from garmentcad.fabric.internal_friction import dragged

STICK = 10.0  # k/G_e below LOW; above HIGH it is H(HIGH)/H(LOW) times as much, at most 2 STICK; an estimate
LEAST_ELASTIC = 0.1  # of G: what is left where a sheet's loop widens as fast as it rises
_LOW_DEG, _HIGH_DEG = 0.5, 5.0
LOW, HIGH = math.radians(_LOW_DEG), math.radians(_HIGH_DEG)


def rising_share(low_deg: float, high_deg: float) -> float:
    """Share of a window of angles, degrees from 0.5 on, on which H rises: all of the tester's 0.5 to 2.5."""
    return (min(high_deg, _HIGH_DEG) - min(low_deg, _HIGH_DEG)) / (high_deg - low_deg)


def elastic_slope(slope: float, narrow: float, wide: float, window_deg: tuple[float, float]) -> float:
    """G_e from G, 2HG and 2HG5 [gf/(cm deg), gf/cm] or in other units that go with degrees, at least LEAST_ELASTIC of G."""
    return max(slope - rising_share(*window_deg) * (wide - narrow) / (2.0 * math.degrees(HIGH - LOW)), LEAST_ELASTIC * slope)


def slope_over(window_deg: tuple[float, float], slope: float, narrow: float, wide: float, of_deg: tuple[float, float]) -> float:
    """G over a window of cloth whose G is `slope` over another one, `of_deg`; units as `elastic_slope`."""
    return slope + (rising_share(*window_deg) - rising_share(*of_deg)) * (wide - narrow) / (2.0 * math.degrees(HIGH - LOW))


def stick_way(low: float, high: float, stiffness: float) -> float:
    """Way d [rad] of the stick spring for the limits H [N/m] below LOW and above HIGH and G_e [N/m per rad]."""
    return max(low, 0.5 * high) / (STICK * stiffness)


def stick_coefficients(friction: np.ndarray, way: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """k below LOW [N/m per rad] and its rise per rad from there to HIGH (N,), from H below LOW and above HIGH (N,2) and d (N,)."""
    low, high = np.divide(friction, way[:, None], out=np.zeros_like(friction), where=way[:, None] > 0.0).T
    return low, (high - low) / (HIGH - LOW)


@kernel
def stick_stiffness(angle: float, low: float, rise: float) -> float:
    """k [N/m per rad] at a shear angle [rad]; low, rise: see `stick_coefficients`."""
    return low + rise * min(max(abs(angle) - LOW, 0.0), HIGH - LOW)


@kernel
def shear(angle: float, slider: float, stiffness: float, low: float, rise: float, way: float) -> tuple[float, float, float]:
    """Shear force per width [N/m], its tangent [N/m per rad] and the slider [rad] at a shear angle [rad]. way: d [rad]; low, rise: see `stick_coefficients`."""
    after = dragged(slider, angle, way)
    stick, held = stick_stiffness(angle, low, rise), angle - after
    growth = rise * math.copysign(1.0, angle) * held if LOW < abs(angle) < HIGH else 0.0
    return stiffness * angle + stick * held, stiffness + growth + (stick if after == slider else 0.0), after


@kernel
def shear_energy(angle: float, slider: float, stiffness: float, low: float, rise: float, way: float) -> float:
    """Stored energy per area [J/m2] at a shear angle [rad]; the arguments are those of `shear`."""
    after = dragged(slider, angle, way)
    ramp = _ramp_energy(angle, after) - _ramp_energy(after, after)
    return 0.5 * stiffness * angle * angle + 0.5 * low * (angle - after) ** 2 + rise * ramp


@kernel
def _ramp_energy(angle, slider):  # type: ignore[no-untyped-def]
    """Integral of min(max(|g| - LOW, 0), HIGH - LOW) (g - slider) from g = 0 to `angle`."""
    size = abs(angle)
    toward = slider if angle >= 0.0 else -slider
    inside, beyond = min(max(size - LOW, 0.0), HIGH - LOW), max(size - HIGH, 0.0)
    return inside * inside * (inside / 3.0 + 0.5 * (LOW - toward)) + (HIGH - LOW) * beyond * (0.5 * beyond + HIGH - toward)
