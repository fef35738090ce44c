"""The machine's floor: the least that an explicit step costs here, to hold our own steps against.

A square cloth of 101 x 101 particles (W1 at 10 mm) with twelve linear springs a particle, velocities, a ball with friction, positions; no cloth on cloth, no
real laws. It is written for speed alone, under the floating-point rules of all kernels: every particle gathers from neighbours at fixed distances in flat
padded arrays, without a branch, so that wide instructions do the work.
"""

from __future__ import annotations

import math
import time
from typing import NamedTuple

import numba
import numpy as np
from numba import prange

from garmentcad.arrays import entry, kernel, parallel_kernel
from garmentcad.bench.cloth_on_ball import AREAL_MASS_KG_M2, BENDING_N_M, FRICTION, GAP_M, RADIUS_M, SHEAR_N_M_RAD, SIDE_M, START_M, TENSION_N_M
from garmentcad.units import GRAVITY_M_S2

COUNT = 101  # particles along a side
PARTICLES = COUNT * COUNT
_MARGIN = 16  # empty places left of each row; two would do, sixteen keep rows aligned
_STRIDE = 144  # from one row to the next: 101 particles and a margin on both sides
_LENGTH = (COUNT + 5) * _STRIDE  # two empty rows below and above, and a little more
_SAFETY = 0.4  # of the largest stable step
_DAMPING = 1.0  # 1/s
_STEPS, _TRIES = 400, 9
_NOWHERE = 10.0  # m, where empty places lie: not on any particle, so that no distance is 0
_TINY = 1e-20

# Unsigned distances to neighbours, for a place two rows above: unsigned indices need no test for negative ones.
_U = np.uint64
_HERE = _U(2 * _STRIDE)
_EAST, _WEST, _NORTH, _SOUTH = _U(2 * _STRIDE + 1), _U(2 * _STRIDE - 1), _U(3 * _STRIDE), _U(_STRIDE)
_NORTH_EAST, _NORTH_WEST, _SOUTH_EAST, _SOUTH_WEST = _U(3 * _STRIDE + 1), _U(3 * _STRIDE - 1), _U(_STRIDE + 1), _U(_STRIDE - 1)
_EAST_2, _WEST_2, _NORTH_2, _SOUTH_2 = _U(2 * _STRIDE + 2), _U(2 * _STRIDE - 2), _U(4 * _STRIDE), _U(0)


class Springs(NamedTuple):
    """Constants of the step, SI: stiffness of the springs to the nearest, diagonal and second neighbours; the rest follows from spacing."""

    near: float
    diagonal: float
    far: float
    spacing: float
    inverse_mass: float
    time_step: float
    keep: float  # share of the velocity that damping leaves in a step
    reach: float  # from the ball's centre, where the ball stops a particle
    friction: float


class Sheet(NamedTuple):
    """Padded fields, one row of places per row of particles. present: (L,) 1 for a particle, 0 for an empty place; the others (3,L), SI, origin in the ball's
    centre, y up."""

    present: np.ndarray
    positions: np.ndarray
    velocities: np.ndarray
    next_positions: np.ndarray


def springs() -> Springs:
    """W1 as springs at a stable time step."""
    spacing = SIDE_M / (COUNT - 1)
    mass = AREAL_MASS_KG_M2 * spacing**2
    bending = 4.0 * BENDING_N_M / spacing**2
    time_step = _SAFETY * 2.0 / math.sqrt((4.0 * TENSION_N_M + 8.0 * SHEAR_N_M_RAD + 4.0 * bending) / mass)
    return Springs(
        TENSION_N_M, SHEAR_N_M_RAD, bending, spacing, 1.0 / mass, time_step, math.exp(-_DAMPING * time_step),
        RADIUS_M + 0.5 * GAP_M, FRICTION,
    )  # fmt: skip


def flat_sheet(jitter_m: float = 1e-5) -> Sheet:
    """The cloth at its start, level above the ball, with a little noise."""
    rng = np.random.default_rng(0)
    side = np.linspace(-0.5 * SIDE_M, 0.5 * SIDE_M, COUNT)
    x, z = np.meshgrid(side, side)
    positions = np.full((3, _LENGTH), _NOWHERE)
    for axis, values in enumerate((x, np.full_like(x, RADIUS_M + START_M), z)):
        inner(positions[axis])[:] = values + jitter_m * rng.standard_normal(x.shape)
    present = np.zeros(_LENGTH)
    inner(present)[:] = 1.0
    return Sheet(present, positions, np.zeros((3, _LENGTH)), positions.copy())


def inner(field: np.ndarray) -> np.ndarray:
    """View (COUNT, COUNT) of the particles in a padded field (L,)."""
    return field[: (COUNT + 4) * _STRIDE].reshape(COUNT + 4, _STRIDE)[2 : COUNT + 2, _MARGIN : _MARGIN + COUNT]


@kernel
def _pulled(force, x, y, z, present, here, there, spring):  # type: ignore[no-untyped-def]
    """force plus that of the spring from place `here` to place `there`. spring: stiffness N/m, rest length m."""
    dx, dy, dz = x[there] - x[here], y[there] - y[here], z[there] - z[here]
    pull = present[there] * spring[0] * (1.0 - spring[1] / math.sqrt(dx * dx + dy * dy + dz * dz + _TINY))
    return force[0] + pull * dx, force[1] + pull * dy, force[2] + pull * dz


@kernel
def _row(first, springs, present, positions, velocities, next_positions):  # type: ignore[no-untyped-def]
    """One step of a row of particles; `first` is the place two rows above its first particle."""
    # Slices, so that places start at 0 and the compiler sees one loop over arrays.
    last = first + COUNT + 4 * _STRIDE + 2
    x, y, z, present = positions[0, first:last], positions[1, first:last], positions[2, first:last], present[first:last]
    start, end = first + 2 * _STRIDE, first + 2 * _STRIDE + COUNT
    vx, vy, vz = velocities[0, start:end], velocities[1, start:end], velocities[2, start:end]
    next_x, next_y, next_z = next_positions[0, start:end], next_positions[1, start:end], next_positions[2, start:end]
    near = (springs.near, springs.spacing)
    diagonal = (springs.diagonal, math.sqrt(2.0) * springs.spacing)
    far = (springs.far, 2.0 * springs.spacing)
    dt = springs.time_step
    push = dt * springs.inverse_mass
    fall = dt * GRAVITY_M_S2
    reach2 = springs.reach * springs.reach
    for c in range(_U(COUNT)):
        here = c + _HERE
        force = (0.0, 0.0, 0.0)
        force = _pulled(force, x, y, z, present, here, c + _EAST, near)
        force = _pulled(force, x, y, z, present, here, c + _WEST, near)
        force = _pulled(force, x, y, z, present, here, c + _NORTH, near)
        force = _pulled(force, x, y, z, present, here, c + _SOUTH, near)
        force = _pulled(force, x, y, z, present, here, c + _NORTH_EAST, diagonal)
        force = _pulled(force, x, y, z, present, here, c + _NORTH_WEST, diagonal)
        force = _pulled(force, x, y, z, present, here, c + _SOUTH_EAST, diagonal)
        force = _pulled(force, x, y, z, present, here, c + _SOUTH_WEST, diagonal)
        force = _pulled(force, x, y, z, present, here, c + _EAST_2, far)
        force = _pulled(force, x, y, z, present, here, c + _WEST_2, far)
        force = _pulled(force, x, y, z, present, here, c + _NORTH_2, far)
        force = _pulled(force, x, y, z, present, here, c + _SOUTH_2, far)
        ux = springs.keep * (vx[c] + push * force[0])
        uy = springs.keep * (vy[c] + push * force[1] - fall)
        uz = springs.keep * (vz[c] + push * force[2])
        px, py, pz = x[here], y[here], z[here]
        distance2 = px * px + py * py + pz * pz
        inverse = 1.0 / math.sqrt(distance2 + _TINY)
        nx, ny, nz = inverse * px, inverse * py, inverse * pz
        leaving = ux * nx + uy * ny + uz * nz
        stopped = min(leaving, 0.0) if distance2 < reach2 else 0.0
        tx, ty, tz = ux - leaving * nx, uy - leaving * ny, uz - leaving * nz
        held = min(1.0, -springs.friction * stopped / math.sqrt(tx * tx + ty * ty + tz * tz + _TINY))
        ux, uy, uz = ux - stopped * nx - held * tx, uy - stopped * ny - held * ty, uz - stopped * nz - held * tz
        vx[c], vy[c], vz[c] = ux, uy, uz
        next_x[c], next_y[c], next_z[c] = px + dt * ux, py + dt * uy, pz + dt * uz


@kernel
def _rows(rows, springs, present, positions, velocities, next_positions):  # type: ignore[no-untyped-def]
    for row in range(rows[0], rows[1]):
        _row(row * _STRIDE + _MARGIN, springs, present, positions, velocities, next_positions)


@entry
@parallel_kernel
def explicit_steps(pairs, parts, springs, sheet):  # type: ignore[no-untyped-def]
    """Twice `pairs` steps in `parts` bands of rows; positions end where they began, in `sheet.positions`."""
    for turn in range(2 * pairs):
        old, new = sheet.positions, sheet.next_positions
        if turn % 2 == 1:
            old, new = new, old
        for part in prange(parts):
            _rows((part * COUNT // parts, (part + 1) * COUNT // parts), springs, sheet.present, old, sheet.velocities, new)


def floor_us(threads: int) -> float:
    """Microseconds of one such step on this machine now: the best of a few tries, because a floor is what the machine can do."""
    before = numba.get_num_threads()
    numba.set_num_threads(threads)
    constants, best = springs(), math.inf
    try:
        explicit_steps(1, threads, constants, flat_sheet())
        for _ in range(_TRIES):
            sheet = flat_sheet()
            began = time.perf_counter()
            explicit_steps(_STEPS // 2, threads, constants, sheet)
            best = min(best, time.perf_counter() - began)
    finally:
        numba.set_num_threads(before)
    return 1e6 * best / _STEPS
