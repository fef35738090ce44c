"""Strain limiting: no link ends a step longer than its limit.

Where |x_b - x_a + dt (v_b - v_a)| exceeds (1 + limit) L0, both ends are pulled together along the link, each by its share of mobility, as velocities
(so that contact, which follows, can veto). A link that is too long already comes back at no more than RETURN_M_S: what one step took back at once would
leave with the speed of it. Limit: the strain at 1.5 Fm of the KES sheet. Source: Provot 1995, section 5 (there on positions).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from garmentcad.arrays import frozen, kernel
from garmentcad.cloth.cloth import Cloth
from garmentcad.fabric.material import MaterialTable

SWEEPS = 20
RETURN_M_S = 1.0


class StrainLimit(NamedTuple):
    """The links of a cloth and their limits."""

    ends: np.ndarray  # (L,2) int32
    longest: np.ndarray  # (L,) m


def strain_limit(cloth: Cloth, materials: MaterialTable) -> StrainLimit:
    """The limits of all links of `cloth`."""
    limit = materials.strain_limit[cloth.links.material, cloth.links.direction]
    # read-only, whosever cloth it is: kernels are compiled anew for arrays that are not
    return StrainLimit(frozen(cloth.links.ends[:]), cloth.links.rest_length * (1.0 + limit))


@kernel
def least_headroom(positions, limit):  # type: ignore[no-untyped-def]
    """By how much the link nearest to its limit is shorter than that, m, negative where one is longer; and which one it is (-1: there is none)."""
    least, nearest = math.inf, -1
    for link in range(len(limit.longest)):
        a, b = limit.ends[link, 0], limit.ends[link, 1]
        x, y, z = positions[b, 0] - positions[a, 0], positions[b, 1] - positions[a, 1], positions[b, 2] - positions[a, 2]
        room = limit.longest[link] - math.sqrt(x * x + y * y + z * z)
        if room < least:
            least, nearest = room, link
    return least, nearest


@kernel
def pull_back(positions, limit, inverse_masses, time_step, velocities):  # type: ignore[no-untyped-def]
    """Gauss-Seidel sweeps over all links in their order, velocities in place: until each that is too long comes back as fast as it may, at most SWEEPS."""
    ends, longest = limit.ends, limit.longest
    for _ in range(SWEEPS):
        all_right = True
        for link in range(len(ends)):
            a, b = ends[link, 0], ends[link, 1]
            x = positions[b, 0] - positions[a, 0] + time_step * (velocities[b, 0] - velocities[a, 0])
            y = positions[b, 1] - positions[a, 1] + time_step * (velocities[b, 1] - velocities[a, 1])
            z = positions[b, 2] - positions[a, 2] + time_step * (velocities[b, 2] - velocities[a, 2])
            square = x * x + y * y + z * z
            mobility = inverse_masses[a] + inverse_masses[b]
            if square > longest[link] * longest[link] and mobility > 0.0:
                u, v, w = positions[b, 0] - positions[a, 0], positions[b, 1] - positions[a, 1], positions[b, 2] - positions[a, 2]
                length = math.sqrt(square)
                goal = max(longest[link], math.sqrt(u * u + v * v + w * w) - RETURN_M_S * time_step)
                if length <= goal:
                    continue
                all_right = False
                pull = (length - goal) / (length * mobility * time_step)
                at, bt = inverse_masses[a] * pull, inverse_masses[b] * pull
                velocities[a, 0], velocities[a, 1], velocities[a, 2] = velocities[a, 0] + at * x, velocities[a, 1] + at * y, velocities[a, 2] + at * z
                velocities[b, 0], velocities[b, 1], velocities[b, 2] = velocities[b, 0] - bt * x, velocities[b, 1] - bt * y, velocities[b, 2] - bt * z
        if all_right:
            return
