"""A body in motion: how fast its vertices go in a step, and what rides on its faces.

What a particle knows of a face is kept in the face's own axes, and comes back where the face is now. So it is exact for any rigid motion, and what
sticks to a turning body turns with it.
"""

from __future__ import annotations

import math

from numba import prange

from garmentcad.arrays import CHUNKS, chunk_range, entry, kernel, long_kernel, parallel_kernel
from garmentcad.geometry.closest import along, cross, dot, minus, mixed, row, unit

_SAMPLED = 500  # vertices from which the rigid part of a body's motion is taken, about

# `pace` (4,): ways since the start, m, then speeds in the step, m/s; of the fastest vertex, and of the fastest relative to the body's rigid motion.


@long_kernel
def set_pace(leg, since, time_step, first, positions, velocities, pace):  # type: ignore[no-untyped-def]
    """Velocities of the body's vertices, the rows from `first`, in the step that begins `since` s into the leg; and the speeds in `pace`.

    Distances in a rigid body do not change: only what is left without the best rigid motion can bring one part of it to what rests on another.
    """
    count = len(leg.first)
    one, two = 2.0 * since + time_step, 3.0 * since * (since + time_step) + time_step * time_step
    for n in range(count):
        v = along(along(row(leg.first, n), row(leg.second, n), one), row(leg.third, n), two)
        velocities[first + n, 0], velocities[first + n, 1], velocities[first + n, 2] = v
    # Any rigid motion gives a bound; a part of the vertices is enough for a good one.
    stride = 1 + count // _SAMPLED
    share = 1.0 / ((count + stride - 1) // stride)
    mean_x = mean_v = (0.0, 0.0, 0.0)
    for n in range(0, count, stride):
        mean_x, mean_v = along(mean_x, row(positions, first + n), share), along(mean_v, row(velocities, first + n), share)
    xx = yy = zz = xy = yz = zx = 0.0
    spin = (0.0, 0.0, 0.0)
    for n in range(0, count, stride):
        r = minus(row(positions, first + n), mean_x)
        spin = along(spin, cross(r, minus(row(velocities, first + n), mean_v)), 1.0)
        xx, yy, zz = xx + r[0] * r[0], yy + r[1] * r[1], zz + r[2] * r[2]
        xy, yz, zx = xy + r[0] * r[1], yz + r[1] * r[2], zx + r[2] * r[0]
    # Angular velocity: the tensor of inertia times it is the spin.
    a, b, c = (yy + zz, -xy, -zx), (-xy, xx + zz, -yz), (-zx, -yz, xx + yy)
    bc, ca, ab = cross(b, c), cross(c, a), cross(a, b)
    det, size = dot(a, bc), xx + yy + zz
    turn = (0.0, 0.0, 0.0)
    if det > 1e-9 * size * size * size:
        turn = (dot(bc, spin) / det, dot(ca, spin) / det, dot(ab, spin) / det)
    fastest = bend = 0.0
    for n in range(count):
        v, r = row(velocities, first + n), minus(row(positions, first + n), mean_x)
        left = minus(minus(v, mean_v), cross(turn, r))
        fastest, bend = max(fastest, dot(v, v)), max(bend, dot(left, left))
    pace[2], pace[3] = math.sqrt(fastest), 2.0 * math.sqrt(bend)


@kernel
def row_at(values, p, place):  # type: ignore[no-untyped-def]
    """values[p, place] of an (P,2,3) array as a tuple."""
    return values[p, place, 0], values[p, place, 1], values[p, place, 2]


@kernel
def axes_of(a, b, c):  # type: ignore[no-untyped-def]
    """Axes of a face: along its first side, across that, and its normal."""
    side, normal = unit(minus(b, a)), unit(cross(minus(b, a), minus(c, a)))
    return side, cross(normal, side), normal


@kernel
def _inward(axes, v):  # type: ignore[no-untyped-def]
    return dot(axes[0], v), dot(axes[1], v), dot(axes[2], v)


@kernel
def _outward(axes, v):  # type: ignore[no-untyped-def]
    return mixed(axes[0], axes[1], axes[2], v[0], v[1], v[2])


@kernel
def ride(p, place, planes, faces, motion):  # type: ignore[no-untyped-def]
    """Bring a plane of particle p to where its face is now, and note the velocity with which what rests on it moves there, at the particle."""
    positions, velocities, time_step = motion
    first, face = len(planes.held), planes.face[p, place]
    i, j, k = first + faces[face, 0], first + faces[face, 1], first + faces[face, 2]
    a, b, c = row(positions, i), row(positions, j), row(positions, k)
    d, e, f = along(a, row(velocities, i), time_step), along(b, row(velocities, j), time_step), along(c, row(velocities, k), time_step)
    u, v, w = row_at(planes.weights, p, place)
    now, then = axes_of(a, b, c), axes_of(d, e, f)
    foot, goal = mixed(a, b, c, u, v, w), mixed(d, e, f, u, v, w)
    normal = _outward(now, row_at(planes.upright, p, place))
    planes.normal[p, place, 0], planes.normal[p, place, 1], planes.normal[p, place, 2] = normal
    if place == 0:
        planes.home[p, 0], planes.home[p, 1], planes.home[p, 2] = along(foot, normal, planes.height[p, 0])
    else:
        planes.room[p, place] = dot(normal, minus(row(planes.home, p), foot)) - planes.gap[p, place]
    apart = minus(row(positions, p), foot)
    change = along(minus(goal, foot), minus(_outward(then, _inward(now, apart)), apart), 1.0)
    for axis in range(3):
        planes.drift[p, place, axis] = change[axis] / time_step


@kernel
def anchor(p, place, planes, faces, motion, found):  # type: ignore[no-untyped-def]
    """Tie a plane that a look has found to its face. found: face, weights of its closest point, distance along the plane's normal."""
    face, weights, height = found
    first, positions = len(planes.held), motion[0]
    now = axes_of(row(positions, first + faces[face, 0]), row(positions, first + faces[face, 1]), row(positions, first + faces[face, 2]))
    upright = _inward(now, row_at(planes.normal, p, place))
    planes.face[p, place], planes.height[p, place], planes.gap[p, place] = face, height, height - planes.room[p, place]
    for axis in range(3):
        planes.weights[p, place, axis], planes.upright[p, place, axis] = weights[axis], upright[axis]
    ride(p, place, planes, faces, motion)


@long_kernel
def _carry_of(particles, planes, faces, motion):  # type: ignore[no-untyped-def]
    for p in range(particles[0], particles[1]):
        for place in range(planes.held[p]):
            ride(p, place, planes, faces, motion)


@entry
@parallel_kernel
def carry(planes, faces, positions, velocities, time_step):  # type: ignore[no-untyped-def]
    """Bring all planes to where the body's faces are; positions, velocities: of all nodes, particles first."""
    count = len(planes.held)
    for chunk in prange(CHUNKS):
        _carry_of(chunk_range(chunk, count), planes, faces, (positions, velocities, time_step))
