"""Angle over sine, from the squares that cross and dot products give: no root and no division by zero where the angle is small."""

from __future__ import annotations

import math

from garmentcad.arrays import kernel


@kernel
def angle_over_sine(sine2, cosine, least_sine):  # type: ignore[no-untyped-def]
    """t/s for t = atan2(s, c), given s^2 and c in any common unit (the result is per that unit); s is not taken below least_sine > 0."""
    if cosine > 0.0 and sine2 < 0.01 * cosine * cosine:  # atan(z)/z by its series, exact to double precision here
        inverse = 1.0 / cosine
        z = sine2 * inverse * inverse
        return inverse * (1.0 - z * (1 / 3 - z * (1 / 5 - z * (1 / 7 - z * (1 / 9 - z * (1 / 11 - z * (1 / 13 - z / 15)))))))
    sine = math.sqrt(sine2)
    return math.atan2(sine, cosine) / max(sine, least_sine)
