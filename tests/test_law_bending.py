"""The bending law without friction: 1 gf.cm2/cm at a curvature of 1 /cm is a moment of 1 gf.cm/cm; energy and tangent are its integral and slope."""

from __future__ import annotations

import pytest

from garmentcad.fabric.law_bending import STICK, bending, bending_energy
from garmentcad.units import GF_CM2_CM_TO_N_M, GF_CM_CM_TO_N


@pytest.mark.parametrize("per_cm", [-2.5, -0.5, 0.0, 1.0, 2.5])
def test_bending_is_the_printed_slope(per_cm: float) -> None:
    curvature, step = 100.0 * per_cm, 1e-4
    moment, tangent, _ = bending(curvature, 0.0, GF_CM2_CM_TO_N_M, 0.0)
    assert moment == pytest.approx(per_cm * GF_CM_CM_TO_N, rel=1e-12)
    assert tangent in (pytest.approx(9.80665e-5, rel=1e-12), pytest.approx(9.80665e-5 * (1.0 + STICK)))  # at rest the slider holds
    slope = (bending_energy(curvature + step, 0.0, GF_CM2_CM_TO_N_M, 0.0) - bending_energy(curvature - step, 0.0, GF_CM2_CM_TO_N_M, 0.0)) / (2 * step)
    assert slope == pytest.approx(moment, rel=1e-6, abs=1e-12)
