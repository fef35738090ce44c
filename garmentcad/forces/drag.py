"""Air drag, linear and proportional to mass: F = -m c (v - v_air) [N], c [1/s].

A flat cloth of W = 0.15 kg/m2 that moves broadside at v feels about 0.6 Cd v^2 N/m2 with Cd = 1.2, at 0.5 m/s as much as c = 2.4 /s: DEFAULT_RATE
is that, rounded. The linear law damps every direction and speed alike; its rate is an estimate, not a measured one.
"""

from __future__ import annotations

import numpy as np

from garmentcad.arrays import floats
from garmentcad.forces.force import OneLaw

DEFAULT_RATE = 2.0  # 1/s


class ForceDrag(OneLaw):
    """Drag on particles of the given masses (P,) [kg], with rate c [1/s] in air of velocity (3,) [m/s]."""

    name = "drag"

    def __init__(self, masses: np.ndarray, rate: float = DEFAULT_RATE, air_velocity: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> None:
        self._masses = floats(masses)
        self._scratch = np.empty((len(masses), 3))
        self.set(rate, air_velocity)

    def set(self, rate: float, air_velocity: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> None:
        """Change rate [1/s] and air velocity [m/s] between steps."""
        self._rate = rate
        self._air = np.tile(floats(air_velocity), (len(self._masses), 1))
        self.set_inertia(self._masses)

    def set_inertia(self, masses: np.ndarray) -> None:
        """See `BodyForce`: a particle that drape mode makes heavier would otherwise ring on."""
        self._masses = floats(masses)
        self._coefficient = floats(np.repeat(self._rate * self._masses[:, None], 3, axis=1))

    def add_forces(self, positions: np.ndarray, velocities: np.ndarray, out: np.ndarray) -> None:
        np.subtract(velocities, self._air, out=self._scratch)
        self._scratch *= self._coefficient
        out -= self._scratch

    def energy(self, positions: np.ndarray) -> float:
        return 0.0
