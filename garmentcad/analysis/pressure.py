"""Clothing pressure and friction: what the body must give back for the garment to stay where it is.

At rest the forces on every particle sum to zero, so that on a particle that touches nothing but the body the body answers with

    R = -f,    f = internal forces + weight [N]
    N = R . n,    T = R - N n,    p = N / A,    s = |T| / A

n: unit vector from the closest point of the body outward; A: area of draped cloth that the particle stands for; p: pressure; s: friction stress. Nothing of the
solver's impulses is read. The internal forces of a garment sum to zero, so that the R of all particles sum to the garment's weight: what is missing in the sum
over those that touch is carried elsewhere, or not at rest. Where layers lie on each other f holds what the cloth above presses as well: under an outer layer
p is that of the inner layer alone.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from garmentcad.analysis.strain import weighted_quantile
from garmentcad.units import PA_TO_KPA

CONTACT_MARGIN_M = 0.5e-3
UP = 1
CONTACT_KEYS = ("max", "mean_in_contact", "p95")
SUPPORT_KEYS = ("weight", "normal", "friction")


@dataclass(frozen=True)
class ContactPressure:
    """What the body gives to each particle; 0 for those that do not touch it. in_contact: (P,) bool; kpa, friction_kpa: (P,) pressure and friction stress;
    normal_n, friction_n: (P,3) N, the two parts of the force on the cloth; area: (P,) m2 as draped."""

    in_contact: np.ndarray
    kpa: np.ndarray
    friction_kpa: np.ndarray
    normal_n: np.ndarray
    friction_n: np.ndarray
    area: np.ndarray

    def summary(self) -> dict[str, float | None]:
        """{max, mean_in_contact, p95} of the pressure in kPa, weighted by area; None where nothing touches."""
        return self._summary(self.kpa)

    def friction_summary(self) -> dict[str, float | None]:
        """The same of the friction stress."""
        return self._summary(self.friction_kpa)

    def contact_area_m2(self) -> float:
        """Area of cloth that touches the body."""
        return float(self.area[self.in_contact].sum())

    def support_n(self, weight_n: float) -> dict[str, float | None]:
        """{weight, normal, friction}: the garment's weight and the upward parts of what the body gives by pressure and by friction, N."""
        return {"weight": weight_n, "normal": float(self.normal_n[:, UP].sum()), "friction": float(self.friction_n[:, UP].sum())}

    def _summary(self, values: np.ndarray) -> dict[str, float | None]:
        touching, area = values[self.in_contact], self.area[self.in_contact]
        if len(touching) == 0:
            return dict.fromkeys(CONTACT_KEYS)
        return {"max": float(touching.max()), "mean_in_contact": float(np.average(touching, weights=area)), "p95": weighted_quantile(touching, area, 0.95)}


def contact_pressure(force_n: np.ndarray, body_normal: np.ndarray, distance_m: np.ndarray, gap_m: float | np.ndarray, area_m2: np.ndarray) -> ContactPressure:
    """Pressure and friction from equilibrium.

    force_n: (P,3) N, all forces on a particle but contact and friction (internal, gravity, air, constraints). body_normal: (P,3) outward unit normal of the
    closest point of the body; distance_m: (P,) signed distance to it; gap_m: the gap that contact keeps; area_m2: (P,) of draped cloth. A particle counts as
    touching within gap + 0.5 mm. Where it would have to be held on to (N < 0) the body gives nothing: other cloth holds it, or it is not at rest.
    """
    touching = (distance_m <= np.asarray(gap_m) + CONTACT_MARGIN_M) & (area_m2 > 0.0)
    push = -np.einsum("pd,pd->p", force_n, body_normal)
    pressed = touching & (push > 0.0)
    normal = np.where(pressed, push, 0.0)
    normal_n = normal[:, None] * body_normal
    friction_n = np.where(pressed[:, None], -force_n - normal_n, 0.0)

    def per_area(force: np.ndarray) -> np.ndarray:
        return np.divide(PA_TO_KPA * force, area_m2, out=np.zeros(len(area_m2)), where=touching)

    return ContactPressure(touching, per_area(normal), per_area(np.linalg.norm(friction_n, axis=1)), normal_n, friction_n, area_m2)
