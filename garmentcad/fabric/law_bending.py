"""Bending along warp, weft or the twist of a cell: M = B kappa + STICK B (kappa - s) [N], s the slider (internal_friction.py).

kappa [1/m] is the curvature; M is moment per width [N.m/m], B [N.m] the slope that the KES-FB2 tester prints between 0.5 and 1.5 /cm,
1 gf.cm2/cm = 9.80665e-5 N.m, and H = 2HB/2 [N], half its loop's width at 1 /cm, 1 gf.cm/cm = 9.80665e-3 N. The stick spring is STICK times as stiff as the
cloth, so that cloth that was bent far keeps at most the curvature 2HB/(2 B), and a strip shorter than sqrt(2HB/(W g)) hardly droops.
Twist obeys the same law with 4 D66 in place of B, D66 = max(0, B_bias - (B_warp + B_weft)/4), and H_twist = max(0, 2 H_bias - H_warp - H_weft): bent along
the bias by kappa, warp, weft and twist take kappa/2 each. With H_bias = sqrt(H_warp H_weft), the estimate where it was not measured, warp and weft lose all
of it.
"""

from __future__ import annotations

from garmentcad.arrays import kernel
from garmentcad.fabric.internal_friction import dragged

STICK = 15.0  # stiffness of the stick spring over B; 10 to 20 leave the loops alike, an estimate


@kernel
def bending(curvature: float, slider: float, stiffness: float, way: float) -> tuple[float, float, float]:
    """Moment per width [N], its tangent [N.m] and the slider [1/m] at a curvature [1/m]. way: H/(STICK B) [1/m]."""
    after = dragged(slider, curvature, way)
    stick = STICK * stiffness
    return stiffness * curvature + stick * (curvature - after), stiffness + (stick if after == slider else 0.0), after


@kernel
def bending_energy(curvature: float, slider: float, stiffness: float, way: float) -> float:
    """Stored energy per area [J/m2] at a curvature [1/m]; the arguments are those of `bending`."""
    held = curvature - dragged(slider, curvature, way)
    return 0.5 * stiffness * (curvature * curvature + STICK * held * held)
