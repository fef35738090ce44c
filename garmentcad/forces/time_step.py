"""The largest time step that is stable for modified Euler (velocity first, position from the new velocity).

omega^2 <= max_i sum_j |K_ij|/m_i (Gershgorin), and dt omega < 2 without damping. Damping of ratio zeta at the highest mode lowers the limit to
2 (sqrt(1 + zeta^2) - zeta): 1.72 at zeta = 0.15, so that SAFETY = 0.8 (dt omega <= 1.6) covers damping ratios up to 0.22.

The bound is a quarter too high inside a lattice and more than a half at its border. Where tangents hardly change, the frequency itself is worth its price:
Lanczos' method on M^-1/2 K M^-1/2, K v by differences of forces (Lanczos 1950; Kuczynski and Wozniakowski 1992 for how fast the largest value is found).
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from scipy.linalg import eigh_tridiagonal

from garmentcad.forces.assembly import ForceAssembly

SAFETY = 0.8
DAMPING_RATIO = 0.15  # of the highest mode at rest
LANCZOS_STEPS = 16  # garments with 7,000 and 10,000 particles: 0.2 % below the frequency that 120 steps find
STUCK = 0.9  # of the way of the stick springs: tension is stiffest where it has been loading
_NUDGE_M = 1e-7  # of the differences: 1e-5 of strain


def highest_frequency(stiffness: np.ndarray, masses: np.ndarray) -> float:
    """Bound on the highest angular frequency [rad/s] from row sums (P,) [N/m] and masses (P,) [kg]."""
    return math.sqrt(float(np.max(stiffness / masses)))


def largest_stable_time_step(stiffness: np.ndarray, masses: np.ndarray) -> float:
    """Time step [s] from row sums (P,) [N/m] of `ForceAssembly.stiffness` and masses (P,) [kg]; infinite where nothing is stiff."""
    frequency = highest_frequency(stiffness, masses)
    return SAFETY * 2.0 / frequency if frequency > 0.0 else math.inf


def internal_damping_time(stiffness: np.ndarray, masses: np.ndarray, ratio: float = DAMPING_RATIO) -> float:
    """tau [s] for which stiffness-proportional damping, force = tau K v, has the damping ratio tau omega/2 = `ratio` at the highest frequency."""
    frequency = highest_frequency(stiffness, masses)
    return 2.0 * ratio / frequency if frequency > 0.0 else 0.0


class SmallMotion:
    """Motion about `positions` (P,3) [m] so small that all internal friction holds. forces: (P,3) [N], there."""

    def __init__(self, laws: ForceAssembly, positions: np.ndarray) -> None:
        self._laws, self._positions, self._still = laws, positions, np.zeros_like(positions)
        self._sliders = laws.drawn(positions, STUCK)
        self.forces = self._at(positions)

    def _at(self, positions: np.ndarray) -> np.ndarray:
        found = np.empty_like(positions)
        self._laws.add_up(positions, self._still, found, self._sliders)
        return found

    def highest_frequency(self, root: Callable[[np.ndarray], np.ndarray]) -> float:
        """Angular frequency [rad/s], hardly too low; root: M^-1/2 times vectors (P,3), 0 where a particle is held, as new
        arrays."""
        before, mode = np.zeros_like(self._positions), np.random.default_rng(0).standard_normal(self._positions.shape)
        mode[~root(mode).any(axis=1)] = 0.0
        size = math.sqrt(float((mode * mode).sum()))
        if size == 0.0:
            return 0.0  # all are held
        mode /= size
        diagonal, beside = [], [0.0]
        for _ in range(LANCZOS_STEPS):
            way = root(mode)
            nudge = _NUDGE_M / max(way.max(), -way.min())
            # in place, for the sake of large cloths
            way *= nudge
            way += self._positions
            image = self._at(way)
            np.subtract(self.forces, image, out=image)
            image /= nudge
            image = root(image)
            image -= beside[-1] * before
            diagonal.append(float((mode * image).sum()))
            image -= diagonal[-1] * mode
            beside.append(math.sqrt(float((image * image).sum())))
            if beside[-1] <= 1e-12 * abs(diagonal[0]):
                break
            before, mode = mode, image / beside[-1]
        between = beside[1 : len(diagonal)]
        # halving intervals needs no linear algebra that chooses its instructions by the processor
        last = len(diagonal) - 1
        largest = eigh_tridiagonal(diagonal, between, eigvals_only=True, select="i", select_range=(last, last), lapack_driver="stebz", tol=0.0)
        return math.sqrt(max(float(largest[0]), 0.0))
