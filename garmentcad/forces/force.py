"""What a force is. An element force acts inside the cloth, on the corners of its elements; a body force acts on every particle by itself.

Element forces never add into shared memory: each writes the force on every corner of every element once, and `ForceAssembly` gathers per particle
in a fixed order. So the result has the same bits for any number of threads.
"""

from __future__ import annotations

from typing import Protocol

import numpy as np

NO_PARTICLE = -1


class Force(Protocol):
    """Force between particles. `corners` (K,) int32 names the particle of each slot this force writes to; NO_PARTICLE marks a slot that is never read."""

    name: str
    corners: np.ndarray

    def write_forces(self, positions: np.ndarray, velocities: np.ndarray, out: np.ndarray) -> None:
        """Force on each corner [N] into out (K,3), from positions [m] and velocities [m/s], both (P,3). Damping included."""

    def energies(self, positions: np.ndarray) -> dict[str, float]:
        """Stored energy [J] by law."""

    def write_stiffness(self, positions: np.ndarray, out: np.ndarray) -> None:
        """Row sum bound of the current tangent, sum over j of |K_ij|, for each corner [N/m] into out (K,). Only what can raise a frequency counts."""


class BodyForce(Protocol):
    """Force on each particle by itself: weight."""

    name: str

    def add_forces(self, positions: np.ndarray, velocities: np.ndarray, out: np.ndarray) -> None:
        """Add the force on each particle [N] to out (P,3)."""

    def energies(self, positions: np.ndarray) -> dict[str, float]:
        """Stored energy [J] by law; 0 for a force that stores none."""


class OneLaw:
    """What forces of a single law share: `name` is the law's, `energy` [J] its energy."""

    name: str

    def energy(self, positions: np.ndarray) -> float:
        raise NotImplementedError

    def energies(self, positions: np.ndarray) -> dict[str, float]:
        return {self.name: self.energy(positions)}
