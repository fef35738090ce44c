"""Shear (trellis angle between warp and weft), elastic: T = G gamma [N/m], energy G gamma^2/2 [J/m2].

gamma [rad] is the departure of the angle between warp and weft from its rest value; T is force per width, G [N/m per rad] the slope that the KES-FB1
tester prints between 0.5 and 2.5 degrees, 1 gf/(cm deg) = 56.19 N/m. Beyond the tester's 8 degrees T goes on with the same slope.
"""

from __future__ import annotations

from garmentcad.arrays import kernel


@kernel
def shear(angle: float, stiffness: float) -> tuple[float, float]:
    """Shear force per width [N/m] and tangent [N/m per rad] at a shear angle [rad]."""
    return stiffness * angle, stiffness


@kernel
def shear_energy(angle: float, stiffness: float) -> float:
    """Energy per area [J/m2] at a shear angle [rad]."""
    return 0.5 * stiffness * angle * angle
