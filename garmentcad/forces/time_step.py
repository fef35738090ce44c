"""The largest time step that is stable for modified Euler (velocity first, position from the new velocity).

omega^2 <= max_i sum_j |K_ij|/m_i (Gershgorin), and dt omega < 2 without damping. Damping of ratio zeta at the highest mode lowers the limit to
2 (sqrt(1 + zeta^2) - zeta): 1.72 at zeta = 0.15, so that SAFETY = 0.8 (dt omega <= 1.6) covers damping ratios up to 0.22.
"""

from __future__ import annotations

import math

import numpy as np

SAFETY = 0.8
DAMPING_RATIO = 0.15  # of the highest mode at rest


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
