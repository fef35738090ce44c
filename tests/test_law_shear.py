"""The shear law without friction: 1 gf/(cm deg) gives 8 gf/cm at 8 degrees; energy and tangent are its integral and slope."""

from __future__ import annotations

import math

import pytest

from garmentcad.fabric.law_shear import shear, shear_energy
from garmentcad.units import GF_CM_DEG_TO_N_M_RAD, GF_CM_TO_N_M


@pytest.mark.parametrize("degrees", [-8.0, -0.5, 0.0, 2.5, 8.0, 20.0])
def test_shear_is_the_printed_slope(degrees: float) -> None:
    stiffness, angle, step = GF_CM_DEG_TO_N_M_RAD, math.radians(degrees), 1e-6
    force, tangent, _ = shear(angle, 0.0, stiffness, 0.0, 0.0, 0.0)
    assert force == pytest.approx(degrees * GF_CM_TO_N_M, rel=1e-12)
    assert tangent == pytest.approx(56.19, abs=0.005)
    above, below = (shear_energy(angle + sign * step, 0.0, stiffness, 0.0, 0.0, 0.0) for sign in (1, -1))
    assert (above - below) / (2 * step) == pytest.approx(force, rel=1e-6, abs=1e-9)
