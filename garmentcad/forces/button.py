"""Buttons that are done up: a shank stands on the cloth below, and the buttonhole moves freely along it and is held beside it and at its end.

    E = k (|r|^2 + e^2)/2   [J]      r = d - t n,  t = d.n,  e what t has beyond 0 or L      F = -(dr/dx)^T (k + c |r|'/|r|) r - (de/dx)^T (k e + c e')   [N]

d [m] leads from the button to its hole, n is the normal of the triangle below, on the right side of its cloth, L [m] the length of the shank, k [N/m] the
stiffness of the thread, c [N.s/m] its damping. Both ends are weighted means of three particles, of which those of the button span the triangle, so that n turns
with them: what pulls at the hole also tilts the shank, and there is no torque left over. The lengths |r| and e are damped, so that a turn as a whole is not;
each by itself, because a hole that swings about the end of its shank by nanometres would hardly change a length that holds both (it swung for ever). The
masses of buttons are neglected.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from garmentcad.arrays import entry, floats, kernel
from garmentcad.forces.force import OneLaw
from garmentcad.geometry.closest import along, cross, dot, minus, row

CORNERS = 6  # of a button: three particles below it, three around its hole
_LEAST_AREA2 = 1e-30  # m4, floor of a squared normal
_LEAST_M = 1e-12  # m, floor of |r|


class Shanks(NamedTuple):
    """Buttons with their holes."""

    particles: np.ndarray  # (B,2,3) int32 below the button, and around the hole
    weights: np.ndarray  # (B,2,3)
    length: np.ndarray  # (B,) m
    stiffness: np.ndarray  # (B,) N/m
    damping: np.ndarray  # (B,) N.s/m


def no_shanks() -> Shanks:
    """Those of a garment without buttons."""
    return Shanks(np.zeros((0, 2, 3), np.int32), np.zeros((0, 2, 3)), np.zeros(0), np.zeros(0), np.zeros(0))


@kernel
def _end(shanks, button, side, positions):  # type: ignore[no-untyped-def]
    point = 0.0, 0.0, 0.0
    for k in range(3):
        point = along(point, row(positions, shanks.particles[button, side, k]), shanks.weights[button, side, k])
    return point


@kernel
def _sides(shanks, button, vectors):  # type: ignore[no-untyped-def]
    """Two sides of the triangle below, or what changes them, and what leads from button to hole."""
    a, b, c = shanks.particles[button, 0, 0], shanks.particles[button, 0, 1], shanks.particles[button, 0, 2]
    u, v = minus(row(vectors, b), row(vectors, a)), minus(row(vectors, c), row(vectors, a))
    return u, v, minus(_end(shanks, button, 1, vectors), _end(shanks, button, 0, vectors))


@kernel
def _normal(u, v):  # type: ignore[no-untyped-def]
    normal = cross(u, v)
    area = math.sqrt(max(dot(normal, normal), _LEAST_AREA2))
    return (normal[0] / area, normal[1] / area, normal[2] / area), area


@kernel
def _held(shanks, button, positions, velocities):  # type: ignore[no-untyped-def]
    """r; t, |r|, e; and how fast |r| and e grow."""
    u, v, apart = _sides(shanks, button, positions)
    n, area = _normal(u, v)
    up = dot(apart, n)
    beyond = up - min(max(up, 0.0), shanks.length[button])
    r = along(apart, n, -up)
    size = math.sqrt(dot(r, r))
    faster_u, faster_v, drift = _sides(shanks, button, velocities)
    turn = along(cross(faster_u, v), cross(u, faster_v), 1.0)
    turn = along(turn, n, -dot(turn, n))
    # n' = turn/area; r' = d' - t n' - t' n, and r lies across n
    rate, rise = dot(r, along(drift, turn, -up / area)) / max(size, _LEAST_M), dot(drift, n) + dot(apart, turn) / area
    return r, (up, size, beyond), (rate, rise if beyond != 0.0 else 0.0)


@entry
@kernel
def measure_shanks(shanks, positions, velocities, out):  # type: ignore[no-untyped-def]
    """How far each hole is from its shank [m], and how fast that changes [m/s], into the rows of out (B,2)."""
    for button in range(len(shanks.length)):
        _, (_, size, beyond), (rate, rise) = _held(shanks, button, positions, velocities)
        gap = math.sqrt(size * size + beyond * beyond)
        out[button, 0], out[button, 1] = gap, (size * rate + beyond * rise) / max(gap, _LEAST_M)


@entry
@kernel
def write_shanks(shanks, positions, velocities, out):  # type: ignore[no-untyped-def]
    """Forces on the corners of button b into out[6 b] to out[6 b + 5]; those on the three below come first."""
    for button in range(len(shanks.length)):
        r, (up, size, beyond), (rate, rise) = _held(shanks, button, positions, velocities)
        strength = shanks.stiffness[button] + shanks.damping[button] * rate / max(size, _LEAST_M)
        stop = shanks.stiffness[button] * beyond + shanks.damping[button] * rise
        u, v, _ = _sides(shanks, button, positions)
        n, area = _normal(u, v)
        pull = along((strength * r[0], strength * r[1], strength * r[2]), n, stop)
        # n turns with its two sides: (dr/dn)^T p = -t p, and de/dn = d, of which r lies across n
        tilt = (up * strength - stop) / area
        on_u, on_v = cross(v, r), cross(r, u)
        for axis in range(3):
            for k in range(3):
                out[6 * button + k, axis] = shanks.weights[button, 0, k] * pull[axis]
                out[6 * button + 3 + k, axis] = -shanks.weights[button, 1, k] * pull[axis]
            out[6 * button, axis] -= tilt * (on_u[axis] + on_v[axis])
            out[6 * button + 1, axis] += tilt * on_u[axis]
            out[6 * button + 2, axis] += tilt * on_v[axis]


class ForceButton(OneLaw):
    """Pull of the buttons of a cloth."""

    name = "button"

    def __init__(self, shanks: Shanks) -> None:
        self.shanks = self._made = shanks
        self.corners = shanks.particles.ravel()

    def soften(self, softness: float) -> None:
        """From now on the stiffness that they were made with is divided by softness >= 1; their damping ratio stays."""
        made = self._made
        self.shanks = made._replace(stiffness=made.stiffness / softness, damping=made.damping / math.sqrt(softness))

    def write_forces(self, positions: np.ndarray, velocities: np.ndarray, out: np.ndarray, sliders: np.ndarray | None = None) -> None:
        write_shanks(self.shanks, positions, velocities, out)

    def gaps(self, positions: np.ndarray) -> np.ndarray:
        """How far each hole is from its shank, (B,) m."""
        return self._measured(positions, np.zeros_like(positions))[:, 0]

    def speeds(self, positions: np.ndarray, velocities: np.ndarray) -> np.ndarray:
        """How fast that changes, (B,) m/s."""
        return np.abs(self._measured(positions, velocities)[:, 1])

    def energy(self, positions: np.ndarray, sliders: np.ndarray | None = None) -> float:
        return float(0.5 * (self.shanks.stiffness * self.gaps(positions) ** 2).sum())

    def write_stiffness(self, positions: np.ndarray, out: np.ndarray) -> None:
        # A corner moves r by its weight, and by t times how fast it turns the normal. What is left of r turns with the normal, too.
        turn = np.concatenate([tilts(positions[self.shanks.particles[:, 0]]), np.zeros((len(self.shanks.length), 3))], axis=1)
        moves = self.shanks.weights.reshape(-1, CORNERS) + self.shanks.length[:, None] * turn
        bent = self.gaps(positions)[:, None] * turn
        out[:] = (self.shanks.stiffness[:, None] * (moves + bent) * (moves + bent).sum(axis=1)[:, None]).ravel()

    def _measured(self, positions: np.ndarray, velocities: np.ndarray) -> np.ndarray:
        out = np.zeros((len(self.shanks.length), 2))
        measure_shanks(self.shanks, floats(positions), floats(velocities), out)
        return out


def tilts(corners: np.ndarray) -> np.ndarray:
    """How fast each corner of triangles (B,3,3) m turns their normals, (B,3) 1/m: 1 over the height of the triangle over it."""
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    area = np.maximum(np.linalg.norm(np.cross(b - a, c - a), axis=1), math.sqrt(_LEAST_AREA2))
    return np.asarray(np.linalg.norm(np.stack([c - b, a - c, b - a], axis=1), axis=2) / area[:, None])
