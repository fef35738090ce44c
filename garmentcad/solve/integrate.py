"""The two halves of a modified Euler step after Provot: forces change velocities, corrected velocities move positions.

    v <- v + dt f/M        x <- x + dt v

M: mass that resists; it exceeds the true mass only where drape mode slows a fast element down (weight and drag always are those of the true mass).
Source: Provot 1995 (velocity before position); DESIGN section 3 for the order of corrections between the two halves.
"""

from __future__ import annotations

import numpy as np
from numba import prange

from garmentcad.arrays import kernel, parallel_kernel


@parallel_kernel
def advance_velocities(forces, inverse_masses, time_step, speed_cap, velocities):
    """velocities (P,3) in place; inverse_masses (P,) 1/kg of the resisting mass, 0 for a fixed particle; speed_cap: m/s, faster particles are slowed."""
    for p in prange(len(velocities)):
        push = time_step * inverse_masses[p]
        x, y, z = velocities[p, 0] + push * forces[p, 0], velocities[p, 1] + push * forces[p, 1], velocities[p, 2] + push * forces[p, 2]
        square = x * x + y * y + z * z
        # not a number stays one: the comparison is false
        share = speed_cap / np.sqrt(square) if square > speed_cap * speed_cap else 1.0
        velocities[p, 0], velocities[p, 1], velocities[p, 2] = share * x, share * y, share * z


@kernel
def advance_positions(velocities, time_step, positions):
    """positions (P,3) in place."""
    for p in range(len(positions)):
        for axis in range(3):
            positions[p, axis] += time_step * velocities[p, axis]


@kernel
def motion_measures(velocities, masses, out):
    """out (3,): kinetic energy J, largest speed m/s, mass-weighted mean square speed m2/s2. Fixed order, so the same bits on any number of threads."""
    kinetic, fastest, total = 0.0, 0.0, 0.0
    for p in range(len(masses)):
        square = velocities[p, 0] ** 2 + velocities[p, 1] ** 2 + velocities[p, 2] ** 2
        kinetic += 0.5 * masses[p] * square
        total += masses[p]
        # A speed that is not a number must not hide behind a comparison that is false.
        fastest = max(fastest, square) if square == square else np.inf
    out[0] = kinetic
    out[1] = np.sqrt(fastest)
    out[2] = 2.0 * kinetic / total
