"""Strain limiting: no link ends a step longer than its limit.

Where |x_b - x_a + dt (v_b - v_a)| exceeds (1 + limit) L0, both ends are pulled together along the link, each by its share of mobility, as velocities
(so that contact, which follows, can veto). Limit: the strain at 1.5 Fm of the KES sheet. Source: Provot 1995, section 5 (there on positions).
"""

from __future__ import annotations

import numpy as np
from numba import prange

from garmentcad.arrays import indices, kernel, parallel_kernel
from garmentcad.cloth.cloth import Cloth
from garmentcad.fabric.material import MaterialTable

_CHUNKS = 16
SWEEPS = 20


@parallel_kernel
def _find_too_long(positions, velocities, ends, longest, time_step, found):
    chunk = (len(ends) + _CHUNKS - 1) // _CHUNKS
    for k in prange(_CHUNKS):
        count = 0
        for link in range(k * chunk, min((k + 1) * chunk, len(ends))):
            a, b = ends[link, 0], ends[link, 1]
            square = 0.0
            for axis in range(3):
                gap = positions[b, axis] - positions[a, axis] + time_step * (velocities[b, axis] - velocities[a, axis])
                square += gap * gap
            if square > longest[link] * longest[link]:
                count += 1
        found[k] = count


@kernel
def _pull_back(positions, ends, longest, inverse_masses, time_step, velocities):
    """Gauss-Seidel sweeps over all links in their order; returns how many are still too long."""
    ahead = np.empty(3)
    left = 0
    for _ in range(SWEEPS):
        left = 0
        for link in range(len(ends)):
            a, b = ends[link, 0], ends[link, 1]
            square = 0.0
            for axis in range(3):
                ahead[axis] = positions[b, axis] - positions[a, axis] + time_step * (velocities[b, axis] - velocities[a, axis])
                square += ahead[axis] * ahead[axis]
            mobility = inverse_masses[a] + inverse_masses[b]
            if square > longest[link] * longest[link] and mobility > 0.0:
                length = np.sqrt(square)
                left += 1
                pull = (length - longest[link]) / (length * mobility * time_step)
                for axis in range(3):
                    velocities[a, axis] += inverse_masses[a] * pull * ahead[axis]
                    velocities[b, axis] -= inverse_masses[b] * pull * ahead[axis]
        if left == 0:
            break
    return left


class StrainLimit:
    """Binds the links of a cloth to their limits. `left` is the number of links that the last call could not shorten enough."""

    def __init__(self, cloth: Cloth, materials: MaterialTable) -> None:
        self._ends = cloth.links.ends
        limit = materials.strain_limit[cloth.links.material, cloth.links.direction]
        self._longest = cloth.links.rest_length * (1.0 + limit)
        self._found = indices(np.zeros(_CHUNKS))
        self.left = 0

    def limit(self, positions: np.ndarray, velocities: np.ndarray, inverse_masses: np.ndarray, time_step_s: float) -> None:
        """Correct velocities (P,3) in place."""
        _find_too_long(positions, velocities, self._ends, self._longest, time_step_s, self._found)
        self.left = 0
        if self._found.any():
            self.left = int(_pull_back(positions, self._ends, self._longest, inverse_masses, time_step_s, velocities))
