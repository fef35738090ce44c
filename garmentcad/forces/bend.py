"""Bending: the turning angle of lines of three points along warp and weft.

    d1 = x0 - x_a,  d2 = x_b - x0,  t = atan2(|d1 x d2|, d1.d2)   [rad]
    E = B w t^2/(2 l)   [J]      l mean of the two rest arms, w width, B [N.m] bending stiffness along the line

so that the moment is B times the curvature t/l at any spacing. An arm may end at a point on a contour chord; its two particles share the force.
Source: KES-FB2, pure bending; Euler elastica in discrete form.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from garmentcad.arrays import floats, indices, kernel
from garmentcad.cloth.cloth import WARP, WEFT, BendLines
from garmentcad.fabric.material import MaterialTable
from garmentcad.forces.force import NO_PARTICLE, OneLaw
from garmentcad.forces.rows import PART, LatticeSlots
from garmentcad.forces.smooth import angle_over_sine

SHORTEST = 1e-2  # arms shorter than this part of their rest length lose their force, so that it stays finite where an arm vanishes
LEAST_SINE = 1e-9  # floor of sin(t): an arm folded flat onto the other has no plane to open in, and gets no force


class BendElements(NamedTuple):
    points: np.ndarray  # (B,5) int32: centre, arm a (two particles), arm b (two particles)
    weights: np.ndarray  # (B,2) weight of the second particle of arm a, arm b
    shortest: np.ndarray  # (2,B) m, length of arm a, arm b below which force fades out
    stiffness: np.ndarray  # (B,) B w/l, N.m


@kernel
def opening(ax, ay, az, bx, by, bz):  # type: ignore[no-untyped-def]
    """Cosine of the angle t between two unit vectors and t/sin(t), without branches. From half the angle, whose cosine is |a + b|/2 without cancellation."""
    x, y, z = ax + bx, ay + by, az + bz
    half = math.sqrt(max(0.25 * (x * x + y * y + z * z), 0.25 * LEAST_SINE * LEAST_SINE))
    return ax * bx + ay * by + az * bz, angle_over_sine(half) * (1.0 / half)  # the division need not wait


@kernel
def bend_row(span, stiffness, lines, pull, turn):  # type: ignore[no-untyped-def]
    """Lines whose arms are the lattice links before and behind their centres; span: first centre, slots to its neighbour, number of lines.

    stiffness (L,): B w/l from the first centre on; lines (4,R): what `stretch_row` wrote. The force on the first end of the link behind each centre is added
    to pull (3+,R), that on the first end of the link before it goes into turn (3,R), both at the centre.
    """
    first, step, count = span
    before = first - step
    axs, ays, azs, inverse_a = lines[0, before:], lines[1, before:], lines[2, before:], lines[3, before:]
    bxs, bys, bzs, inverse_b = lines[0, first:], lines[1, first:], lines[2, first:], lines[3, first:]
    pull_x, pull_y, pull_z = pull[0, first:], pull[1, first:], pull[2, first:]
    turn_x, turn_y, turn_z = turn[0, first:], turn[1, first:], turn[2, first:]
    for i in range(np.uint64(count)):
        ax, ay, az, bx, by, bz = axs[i], ays[i], azs[i], bxs[i], bys[i], bzs[i]
        cosine, over_sine = opening(ax, ay, az, bx, by, bz)
        # the squares are 1 but for links that are too short
        scale = stiffness[i] * over_sine * ((ax * ax + ay * ay + az * az) * (bx * bx + by * by + bz * bz))
        on_a, on_b = scale * inverse_a[i], scale * inverse_b[i]
        pull_x[i] += on_b * (cosine * bx - ax)
        pull_y[i] += on_b * (cosine * by - ay)
        pull_z[i] += on_b * (cosine * bz - az)
        turn_x[i], turn_y[i], turn_z[i] = on_a * (cosine * ax - bx), on_a * (cosine * ay - by), on_a * (cosine * az - bz)


@kernel
def _load_arms(span, lines, positions, arms):  # type: ignore[no-untyped-def]
    """Arms a and b (6,PART) of the lines in span: first, number."""
    first, count = span
    x = positions
    for i in range(count):
        k = first + i
        o, a, c, b, d = lines.points[k, 0], lines.points[k, 1], lines.points[k, 2], lines.points[k, 3], lines.points[k, 4]
        weight_a, weight_b = lines.weights[k, 0], lines.weights[k, 1]
        for axis in range(3):
            arms[axis, i] = x[o, axis] - x[a, axis] + weight_a * (x[a, axis] - x[c, axis])
            arms[3 + axis, i] = x[b, axis] - x[o, axis] + weight_b * (x[d, axis] - x[b, axis])


@kernel
def _turn_arms(count, shortest_a, shortest_b, stiffness, arms):  # type: ignore[no-untyped-def]
    """In place of the arms (6,PART): the force on the end of arm a, and minus the force on the end of arm b."""
    axs, ays, azs, bxs, bys, bzs = arms[0], arms[1], arms[2], arms[3], arms[4], arms[5]
    for i in range(np.uint64(count)):
        ax, ay, az, bx, by, bz = axs[i], ays[i], azs[i], bxs[i], bys[i], bzs[i]
        inverse_a = 1.0 / max(math.sqrt(ax * ax + ay * ay + az * az), shortest_a[i])
        inverse_b = 1.0 / max(math.sqrt(bx * bx + by * by + bz * bz), shortest_b[i])
        ax, ay, az, bx, by, bz = ax * inverse_a, ay * inverse_a, az * inverse_a, bx * inverse_b, by * inverse_b, bz * inverse_b
        cosine, over_sine = opening(ax, ay, az, bx, by, bz)
        # the squares are 1 but for arms that are too short
        scale = stiffness[i] * over_sine * ((ax * ax + ay * ay + az * az) * (bx * bx + by * by + bz * bz))
        on_a, on_b = scale * inverse_a, scale * inverse_b
        axs[i], ays[i], azs[i] = on_a * (cosine * ax - bx), on_a * (cosine * ay - by), on_a * (cosine * az - bz)
        bxs[i], bys[i], bzs[i] = on_b * (cosine * bx - ax), on_b * (cosine * by - ay), on_b * (cosine * bz - az)


@kernel
def bend_part(part, lines, positions, out):  # type: ignore[no-untyped-def]
    first = part * PART
    count = min(len(lines.stiffness) - first, PART)
    arms = np.empty((6, PART))
    _load_arms((first, count), lines, positions, arms)
    _turn_arms(count, lines.shortest[0, first:], lines.shortest[1, first:], lines.stiffness[first:], arms)
    for i in range(count):
        weight_a, weight_b = lines.weights[first + i, 0], lines.weights[first + i, 1]
        k = 5 * (first + i)
        for axis in range(3):
            a, b = arms[axis, i], arms[3 + axis, i]
            out[k, axis] = b - a
            out[k + 1, axis], out[k + 2, axis] = a - weight_a * a, weight_a * a
            out[k + 3, axis], out[k + 4, axis] = weight_b * b - b, -weight_b * b


@kernel
def write_bend(lines, positions, velocities, out):  # type: ignore[no-untyped-def]
    """Forces on centre, arm a (two), arm b (two) of line i into out[5 i] to out[5 i + 4]."""
    for part in range(-(-len(lines.stiffness) // PART)):
        bend_part(np.int64(part), lines, positions, out)


class ForceBend(OneLaw):
    """Bending of lines of a cloth."""

    name = "bend"

    def __init__(self, lines: BendLines, materials: MaterialTable) -> None:
        points = np.column_stack([lines.center, lines.arm_a, lines.arm_b])
        weights = np.column_stack([lines.weight_a, lines.weight_b]).astype(np.float64)
        self._rest = np.column_stack([lines.length_a, lines.length_b])
        stiffness = materials.bending[lines.material, lines.direction] * lines.width / self._rest.mean(axis=1)
        self._lines = BendElements(indices(points), weights, floats(SHORTEST * self._rest.T), stiffness)
        self.arguments = (self._lines,)
        corners = points.copy()
        corners[:, 2::2][weights == 0.0] = NO_PARTICLE
        self.corners = indices(corners).ravel()

    def rows(self, slots: LatticeSlots, direction: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """B w/l (S,) of the weft and of the warp line centred at each slot; for lines (N,) of `direction` whose arms are lattice neighbours."""
        at = slots.slot[self._lines.points[:, 0]]
        weft, warp = (slots.spread(at[direction == axis], self._lines.stiffness[direction == axis]) for axis in (WEFT, WARP))
        return weft, warp

    def write_forces(self, positions: np.ndarray, velocities: np.ndarray, out: np.ndarray) -> None:
        write_bend(*self.arguments, positions, velocities, out)

    def _angle_and_arms(self, positions: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        center, a0, a1, b0, b1 = (positions[self._lines.points[:, k]] for k in range(5))
        weight_a, weight_b = self._lines.weights[:, :1], self._lines.weights[:, 1:]
        arm_a = center - (1.0 - weight_a) * a0 - weight_a * a1
        arm_b = (1.0 - weight_b) * b0 + weight_b * b1 - center
        angle = np.arctan2(np.linalg.norm(np.cross(arm_a, arm_b), axis=1), np.sum(arm_a * arm_b, axis=1))
        arms = np.column_stack([np.linalg.norm(arm_a, axis=1), np.linalg.norm(arm_b, axis=1)])
        return angle, np.maximum(arms, SHORTEST * self._rest)

    def energy(self, positions: np.ndarray) -> float:
        angle, _ = self._angle_and_arms(positions)
        return float(np.sum(0.5 * self._lines.stiffness * angle * angle))

    def write_stiffness(self, positions: np.ndarray, out: np.ndarray) -> None:
        # |dt/d(end of arm)| = 1/|arm|, and at the centre the sum of both; (1 + t) covers the curvature of t
        angle, arms = self._angle_and_arms(positions)
        weight = self._lines.weights
        a, b = 1.0 / arms[:, 0], 1.0 / arms[:, 1]
        gradients = np.column_stack([a + b, a * (1.0 - weight[:, 0]), a * weight[:, 0], b * (1.0 - weight[:, 1]), b * weight[:, 1]])
        out[:] = (gradients * (self._lines.stiffness * (1.0 + angle) * 2.0 * (a + b))[:, None]).ravel()
