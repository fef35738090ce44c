"""What a force is. An element force acts inside the cloth, on the corners of its elements; a body force acts on every particle by itself.

Element forces never add into shared memory: each writes the force on every corner of every element once, and `ForceAssembly` gathers per particle
in a fixed order. So the result has the same bits for any number of threads.

Internal friction gives a force a memory: sliders (fabric/internal_friction.py), one for each curve that an element is measured on, which lie in
`State.friction` by the force's name. Forces are written for given positions and sliders, and move the sliders to where these positions leave them; doing
that twice changes nothing.
"""

from __future__ import annotations

from typing import NamedTuple, Protocol

import numpy as np

NO_PARTICLE = -1


class Gauge(NamedTuple):
    """What the sliders of a force are measured on, each in the order of its array. way: d, 0 without friction; curve: index of CURVES; particle: one of the
    panel, at the place or beside it, NO_PARTICLE for a slider that stands for nothing; between: (..., 4) particles in whose middle the place is, NO_PARTICLE
    beyond the last."""

    strain: np.ndarray
    way: np.ndarray
    curve: np.ndarray
    particle: np.ndarray
    between: np.ndarray


CURVES = ("weft tension", "warp tension", "shear", "twist", "weft bending", "warp bending", "seam bending")
TENSION = (0, 1)  # of them


def between(particles: np.ndarray) -> np.ndarray:
    """(N,4) of `Gauge`, from (N,1) to (N,4)."""
    return np.pad(particles, ((0, 0), (0, 4 - particles.shape[1])), constant_values=NO_PARTICLE)


class Force(Protocol):
    """Force between particles. `corners` (K,) int32 names the particle of each slot this force writes to; NO_PARTICLE marks a slot that is never read."""

    name: str

    @property
    def corners(self) -> np.ndarray: ...

    def slack(self) -> np.ndarray:
        """Sliders of cloth that was never strained; none (0,) where there is no internal friction."""

    def gauge(self, positions: np.ndarray) -> Gauge:
        """Of each slider."""

    def drawn(self, positions: np.ndarray, share: float) -> np.ndarray:
        """Sliders that hold: the stick springs drawn by a share (-1 to 1) of their way at these positions (P,3) m."""

    def write_forces(self, positions: np.ndarray, velocities: np.ndarray, out: np.ndarray, sliders: np.ndarray | None = None) -> None:
        """Force on each corner [N] into out (K,3), from positions [m] and velocities [m/s], both (P,3). Damping included. sliders: moved in place; None:
        `slack`."""

    def energies(self, positions: np.ndarray, sliders: np.ndarray | None = None) -> dict[str, float]:
        """Stored energy [J] by law, stick springs included."""

    def write_stiffness(self, positions: np.ndarray, out: np.ndarray) -> None:
        """Row sum bound of the current tangent, sum over j of |K_ij|, for each corner [N/m] into out (K,), stick springs included. Only what can raise a
        frequency counts."""

    def write_stiffness_across(self, positions: np.ndarray, out: np.ndarray) -> None:
        """As `write_stiffness`, of what resists across the cloth: bending, the pull of bands. out is zero and stays so where nothing does."""


class BodyForce(Protocol):
    """Force on each particle by itself: weight."""

    name: str

    def add_forces(self, positions: np.ndarray, velocities: np.ndarray, out: np.ndarray) -> None:
        """Add the force on each particle [N] to out (P,3)."""

    def energies(self, positions: np.ndarray) -> dict[str, float]:
        """Stored energy [J] by law; 0 for a force that stores none."""


class OneLaw:
    """What forces of a single law share: `name` is the law's, `energy` [J] its energy. Without internal friction, unless they say otherwise."""

    name: str

    def slack(self) -> np.ndarray:
        return np.empty(0)

    def gauge(self, positions: np.ndarray) -> Gauge:
        none = np.empty(0)
        return Gauge(none, none, none, none, np.empty((0, 4)))

    def drawn(self, positions: np.ndarray, share: float) -> np.ndarray:
        gauge = self.gauge(positions)
        return gauge.strain - share * gauge.way

    def write_stiffness_across(self, positions: np.ndarray, out: np.ndarray) -> None:
        """None, unless they say otherwise."""

    def energy(self, positions: np.ndarray, sliders: np.ndarray | None = None) -> float:
        raise NotImplementedError

    def energies(self, positions: np.ndarray, sliders: np.ndarray | None = None) -> dict[str, float]:
        return {self.name: self.energy(positions, sliders)}
