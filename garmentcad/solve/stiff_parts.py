"""Longer steps where little of the cloth is stiff: its forces are those of places a little further on, to which those of before would take it.

    xi_0 = 0     xi_j = c_j dt^2 P a(x + xi_(j-1), v + 2 xi_(j-1)/dt)     v <- v + dt a(x + xi_(n-1), v + 2 xi_(n-1)/dt)     x <- x + dt v

P takes what is stiff, and leaves the rest where it is. For motion about rest, S = dt^2 K/M and its damping, this is a = phi(S) a_0 with a polynomial of degree
n - 1, so chosen that S phi(S), which a step of Euler's wants below 4, stays between 0 and 4 SAFETY up to n^2 times the stiffness that it bears by itself:
Chebyshev's of degree n, a little inside its ends, where stiff modes would lose all of their force. phi(0) = 1: what moves slowly moves as before.
n - 1 more evaluations of what is stiff. a has the mean of what contact and constraints added in the last steps: where these hold the forces in balance nothing
goes on, and rest is the same.

Source: Diaz and Grote 2009 (leapfrog with local time steps); Carle, Hochbruck and Sturm 2020, Grote, Michel and Sauter 2021 (kept inside the ends); damping as
displacement is our own: a step of dt^2 K + 2 dt C below 4 is what modified Euler bears of both.
"""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np
from numba import prange
from numpy.polynomial import Chebyshev, Polynomial

from garmentcad.arrays import CHUNKS, chunk_range, inlined_kernel, kernel, parallel_kernel
from garmentcad.forces.internal import Acting
from garmentcad.forces.time_step import SAFETY

# What allows less than STIFF of the median particle's step is stiff, by the bounds of both, up to FAR times the step of the stiffest, beyond which nothing is
# shortened by what three evaluations bear; and nothing is where the stiffest is hardly below that.
STIFF, FAR, CLEARLY = 0.6, 3.0, 0.75
# With four, phi falls to 0.06: what is held comes to rest so slowly that the pleated skirt was watched twice.
MOST_STAGES = 3
# Weight of the last step in the mean of what holds. A mean over few follows what is held so closely that it drives stiff modes: with 16 a waistband shook.
LASTING = 1.0 / 64.0
# How far the polynomial stays inside its ends: T(1 + _INSIDE/n^2) in place of T(1). Longest step, in those of one evaluation, and phi there: n and 0 without,
# 0.9 n, 0.21 (n = 2) and 0.13 (n = 3) with it.
_INSIDE, _GAIN = 3.0, 0.9


class StiffParts(NamedTuple):
    """What is stiff, for compiled steps."""

    acting: Acting  # the parts that act on the particles, with sliders of their own
    particles: np.ndarray  # (Q,) int32
    reach: np.ndarray  # (n-1,) c_j, none where steps are so short that what is stiff bears them
    home: np.ndarray  # (2,Q,3) scratch: their positions and velocities
    held: np.ndarray  # (P,3) N, what contact and constraints added in the last steps, a mean
    weight: np.ndarray  # (P,) of the next step in it: 1 where there is none, 1/2, 1/3, ..., LASTING


@cache
def reaches(stages: int) -> tuple[float, ...]:
    """c_j of so many evaluations, 1 or more; none of one."""
    chebyshev, at = Chebyshev.basis(stages), 1.0 + _INSIDE / stages**2
    end, slope = chebyshev(at), chebyshev.deriv()(at)
    scale = (end + 1.0) / (4.0 * SAFETY * slope)
    # s phi(s) = (T(at) - T(at - scale s))/(scale T'(at)): s for small s, and at most 4 SAFETY
    bent = (end - chebyshev.convert(kind=Polynomial)(Polynomial([at, -scale]))) / (scale * slope)
    phi = bent.coef[1:]
    return tuple(float(-phi[j + 1] / phi[j]) for j in reversed(range(stages - 1)))


def step_of(stages: int, stiff_s: float, rest_s: float) -> float:
    """Longest step [s] with so many evaluations of what is stiff, which by itself allows stiff_s, where the rest allows rest_s."""
    return stiff_s if stages == 1 else max(stiff_s, min(_GAIN * stages * stiff_s, rest_s))


def stages_for(stiff_s: float, rest_s: float, work: float) -> int:
    """With how many evaluations of what is stiff, a part `work` of all, most time passes per work; steps as in `step_of`."""
    return max(range(1, MOST_STAGES + 1), key=lambda n: step_of(n, stiff_s, rest_s) / (1.0 + (n - 1) * work))


def stiff_particles(own: np.ndarray, moving: np.ndarray) -> np.ndarray:
    """(P,) bool, of the steps [s] that each particle (P,) allows by the bound of its stiffness, and which of them move."""
    if not moving.any():
        return moving
    bar, stiffest = STIFF * float(np.median(own[moving])), float(own[moving].min())
    return moving & (own < min(bar, FAR * stiffest)) & (stiffest < CLEARLY * bar)


@inlined_kernel
def _force_on(p, sums):  # type: ignore[no-untyped-def]
    """Of the corner forces of the moment and weight, N."""
    x, y, z = 0.0, -sums.weight[p], 0.0
    for j in range(sums.starts[p], sums.starts[p + 1]):
        slot = sums.slots[j]
        x, y, z = x + sums.corner_forces[slot, 0], y + sums.corner_forces[slot, 1], z + sums.corner_forces[slot, 2]
    return x, y, z


@kernel
def _go_on_of(chosen, particles, home, hold, far, sums, inverse_masses, positions, velocities):  # type: ignore[no-untyped-def]
    (held, weight), (square, double) = hold, far
    for k in range(chosen[0], chosen[1]):
        p = particles[k]
        x, y, z = _force_on(p, sums)
        share = inverse_masses[p] if weight[p] < 1.0 else 0.0
        x, y, z = share * (x + held[p, 0]), share * (y + held[p, 1]), share * (z + held[p, 2])
        positions[p, 0], positions[p, 1], positions[p, 2] = home[0, k, 0] + square * x, home[0, k, 1] + square * y, home[0, k, 2] + square * z
        velocities[p, 0], velocities[p, 1], velocities[p, 2] = home[1, k, 0] + double * x, home[1, k, 1] + double * y, home[1, k, 2] + double * z


@parallel_kernel
def go_on(particles, home, hold, far, sums, inverse_masses, positions, velocities):  # type: ignore[no-untyped-def]
    """Take particles (Q,) from their home (2,Q,3) further, by the corner forces of the moment and what holds them; hold: `held` and `weight`; far: s2 and s by
    which an acceleration moves positions and velocities."""
    for chunk in prange(CHUNKS):
        _go_on_of(chunk_range(chunk, len(particles)), particles, home, hold, far, sums, inverse_masses, positions, velocities)


@kernel
def keep_home(particles, positions, velocities, home):  # type: ignore[no-untyped-def]
    """Note where particles are, and how they move, into home (2,Q,3)."""
    for k, p in enumerate(particles):
        for axis in range(3):
            home[0, k, axis], home[1, k, axis] = positions[p, axis], velocities[p, axis]


@kernel
def take_home(particles, home, positions, velocities):  # type: ignore[no-untyped-def]
    """Back there."""
    for k, p in enumerate(particles):
        for axis in range(3):
            positions[p, axis], velocities[p, axis] = home[0, k, axis], home[1, k, axis]


@kernel
def expect(particles, sums, drag, inverse_masses, dt, velocities, home):  # type: ignore[no-untyped-def]
    """Into home[1]: the velocities to which the forces of the moment would lead by themselves."""
    for k, p in enumerate(particles):
        x, y, z = _force_on(p, sums)
        keep, push = 1.0 - dt * drag[p], dt * inverse_masses[p]
        home[1, k, 0], home[1, k, 1] = keep * velocities[p, 0] + push * x, keep * velocities[p, 1] + push * y
        home[1, k, 2] = keep * velocities[p, 2] + push * z


@kernel
def note_what_held(particles, home, velocities, inverse_masses, dt, held, weight):  # type: ignore[no-untyped-def]
    """Take what has led the particles to other velocities than those expected into the mean."""
    for k, p in enumerate(particles):
        for axis in range(3):
            force = (velocities[p, axis] - home[1, k, axis]) / (dt * inverse_masses[p]) if inverse_masses[p] > 0.0 else 0.0
            held[p, axis] += weight[p] * (force - held[p, axis])
        weight[p] = max(weight[p] / (1.0 + weight[p]), LASTING)
