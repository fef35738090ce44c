"""Clothing pressure: what the body must push back for the garment to stay where it is."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

CONTACT_MARGIN_M = 0.5e-3
PA_TO_KPA = 1e-3


@dataclass(frozen=True)
class ContactPressure:
    """kpa: (P,) pressure, 0 away from the body; in_contact: (P,) bool; area: (P,) m2."""

    kpa: np.ndarray
    in_contact: np.ndarray
    area: np.ndarray

    def summary(self) -> dict[str, float | None]:
        """{max, mean_in_contact} in kPa, the mean weighted by area; None where nothing touches."""
        if not self.in_contact.any():
            return {"max": None, "mean_in_contact": None}
        touching = self.in_contact
        return {"max": float(self.kpa[touching].max()), "mean_in_contact": float(np.average(self.kpa[touching], weights=self.area[touching]))}


def contact_pressure(force_n: np.ndarray, body_normal: np.ndarray, distance_m: np.ndarray, gap_m: float | np.ndarray, area_m2: np.ndarray) -> ContactPressure:
    """Normal contact pressure from equilibrium, p = -(f . n) / A.

    force_n: (P,3) N, all forces on a particle but contact and friction (internal, gravity, air, constraints); at rest the body answers with -f.
    body_normal: (P,3) outward unit normal of the nearest body point; distance_m: (P,) signed distance to it; gap_m: the gap that contact keeps;
    area_m2: (P,) rest area of a particle. A particle counts as touching within gap + 0.5 mm; a pull off the body (negative p) counts as 0.
    """
    touching = (distance_m <= np.asarray(gap_m) + CONTACT_MARGIN_M) & (area_m2 > 0.0)
    push = np.maximum(-np.einsum("pd,pd->p", force_n, body_normal), 0.0)
    kpa = np.divide(PA_TO_KPA * push, area_m2, out=np.zeros(len(area_m2)), where=touching)
    return ContactPressure(kpa, touching, area_m2)
