"""Bending along warp, weft or the twist of a cell, elastic: M = B kappa [N], energy B kappa^2/2 [J/m2].

kappa [1/m] is the curvature; M is moment per width [N.m/m], B [N.m] the slope that the KES-FB2 tester prints between 0.5 and 1.5 /cm,
1 gf.cm2/cm = 9.80665e-5 N.m. Twist obeys the same law with 4 D66 in place of B, D66 = max(0, B_bias - (B_warp + B_weft)/4).
"""

from __future__ import annotations

from garmentcad.arrays import kernel


@kernel
def bending(curvature: float, stiffness: float) -> tuple[float, float]:
    """Moment per width [N] and tangent [N.m] at a curvature [1/m]."""
    return stiffness * curvature, stiffness


@kernel
def bending_energy(curvature: float, stiffness: float) -> float:
    """Energy per area [J/m2] at a curvature [1/m]."""
    return 0.5 * stiffness * curvature * curvature
