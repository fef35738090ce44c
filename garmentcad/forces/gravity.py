"""Weight: F = -m g along y [N], E = m g y [J], g = 9.81 m/s2."""

from __future__ import annotations

import numpy as np

from garmentcad.arrays import floats
from garmentcad.forces.force import OneLaw
from garmentcad.units import GRAVITY_M_S2


class ForceGravity(OneLaw):
    """Weight of particles of the given masses (P,) [kg]. `gravity` [m/s2] may be changed between two stretches of motion."""

    name = "gravity"

    def __init__(self, masses: np.ndarray, gravity: float = GRAVITY_M_S2) -> None:
        self._masses, self.gravity = floats(masses), gravity

    def add_forces(self, positions: np.ndarray, velocities: np.ndarray, out: np.ndarray) -> None:
        out[:, 1] -= self._masses * self.gravity

    def energy(self, positions: np.ndarray, sliders: np.ndarray | None = None) -> float:
        return float(np.sum(self._masses * self.gravity * positions[:, 1]))
