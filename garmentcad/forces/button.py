"""Buttons that are done up: a shank stands on the cloth below, and the buttonhole moves freely along it and is held beside it and at its end.

    E = k |r|^2/2   [J]      r = d - t n,  t = d.n within 0 to L      F = -(dr/dx)^T (k r + c r')   [N]

d [m] leads from the button to its hole, n is the normal of the triangle below, on the right side of its cloth, L [m] the length of the shank, k [N/m] the
stiffness of the thread, c [N.s/m] its damping. Both ends are weighted means of three particles, of which those of the button span the triangle, so that n turns
with them: what pulls at the hole also tilts the shank, and there is no torque left over. The masses of buttons are neglected.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from garmentcad.arrays import kernel
from garmentcad.forces.force import OneLaw
from garmentcad.geometry.closest import along, cross, dot, minus, row

CORNERS = 6  # of a button: three particles below it, three around its hole
_LEAST_AREA2 = 1e-30  # m4, floor of a squared normal


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
def write_shanks(shanks, positions, velocities, out):  # type: ignore[no-untyped-def]
    """Forces on the corners of button b into out[6 b] to out[6 b + 5]; those on the three below come first."""
    for button in range(len(shanks.length)):
        u, v, apart = _sides(shanks, button, positions)
        normal = cross(u, v)
        area = math.sqrt(max(dot(normal, normal), _LEAST_AREA2))
        n = normal[0] / area, normal[1] / area, normal[2] / area
        height = dot(apart, n)
        up = min(max(height, 0.0), shanks.length[button])
        faster_u, faster_v, drift = _sides(shanks, button, velocities)
        # r' = d' - t n', without its part along n where t follows d
        turn = along(cross(faster_u, v), cross(u, faster_v), 1.0)
        drift = along(drift, along(turn, n, -dot(turn, n)), -up / area)
        r, stiffness, damping = along(apart, n, -up), shanks.stiffness[button], shanks.damping[button]
        pull = stiffness * r[0] + damping * drift[0], stiffness * r[1] + damping * drift[1], stiffness * r[2] + damping * drift[2]
        beside = along(pull, n, -dot(pull, n))
        if up == height:
            pull = beside
        # n turns with its two sides: (dr/dn)^T p = -t p
        on_u, on_v = cross(v, beside), cross(beside, u)
        lever = up / area
        for axis in range(3):
            for k in range(3):
                out[6 * button + k, axis] = shanks.weights[button, 0, k] * pull[axis]
                out[6 * button + 3 + k, axis] = -shanks.weights[button, 1, k] * pull[axis]
            out[6 * button, axis] -= lever * (on_u[axis] + on_v[axis])
            out[6 * button + 1, axis] += lever * on_u[axis]
            out[6 * button + 2, axis] += lever * on_v[axis]


class ForceButton(OneLaw):
    """Pull of the buttons of a cloth."""

    name = "button"

    def __init__(self, shanks: Shanks) -> None:
        self.shanks = shanks
        self.corners = shanks.particles.ravel()

    def write_forces(self, positions: np.ndarray, velocities: np.ndarray, out: np.ndarray, sliders: np.ndarray | None = None) -> None:
        write_shanks(self.shanks, positions, velocities, out)

    def gaps(self, positions: np.ndarray) -> np.ndarray:
        """|r| (B,) m: how far each hole is from its shank."""
        _, r, _ = self._measured(positions)
        return np.asarray(np.linalg.norm(r, axis=1))

    def speeds(self, velocities: np.ndarray) -> np.ndarray:
        """Speed (B,) m/s between button and hole."""
        ends = np.einsum("bek,bekx->bex", self.shanks.weights, velocities[self.shanks.particles])
        return np.asarray(np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1))

    def energy(self, positions: np.ndarray, sliders: np.ndarray | None = None) -> float:
        return float(0.5 * (self.shanks.stiffness * self.gaps(positions) ** 2).sum())

    def write_stiffness(self, positions: np.ndarray, out: np.ndarray) -> None:
        # A corner moves r by its weight, and by t times how fast it turns the normal: the far sides' share of the height of the triangle over it. What is
        # left of r turns with the normal, too.
        up, r, sides = self._measured(positions)
        turn = np.concatenate([np.linalg.norm(sides, axis=2), np.zeros((len(up), 3))], axis=1)
        moves = self.shanks.weights.reshape(-1, CORNERS) + up[:, None] * turn
        bent = np.linalg.norm(r, axis=1)[:, None] * turn
        out[:] = (self.shanks.stiffness[:, None] * (moves + bent) * (moves + bent).sum(axis=1)[:, None]).ravel()

    def _measured(self, positions: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """t (B,), r (B,3), and how fast each corner of the triangle turns its normal (B,3,3), 1/m."""
        ends = np.einsum("bek,bekx->bex", self.shanks.weights, positions[self.shanks.particles])
        a, b, c = (positions[self.shanks.particles[:, 0, k]] for k in range(3))
        normal = np.cross(b - a, c - a)
        area = np.maximum(np.linalg.norm(normal, axis=1), math.sqrt(_LEAST_AREA2))[:, None]
        apart = ends[:, 1] - ends[:, 0]
        up = np.clip((apart * normal / area).sum(axis=1), 0.0, self.shanks.length)
        sides = np.stack([c - b, a - c, b - a], axis=1) / area[:, None]
        return up, apart - up[:, None] * normal / area, sides
