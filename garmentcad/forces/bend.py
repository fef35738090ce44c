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
from numba import prange

from garmentcad.arrays import CHUNKS, chunk_range, indices, kernel, parallel_kernel
from garmentcad.cloth.cloth import WARP, WEFT, BendLines
from garmentcad.fabric.material import MaterialTable
from garmentcad.forces.angle import angle_over_sine
from garmentcad.forces.force import NO_PARTICLE, OneLaw
from garmentcad.forces.rows import LatticeSlots
from garmentcad.forces.smooth import arctan_over

SHORTEST = 1e-2  # arms shorter than this part of their rest length lose their force, so that it stays finite where an arm vanishes
TINY = 1e-100  # m2
LEAST_SINE = 1e-9  # floor of sin(t): an arm folded flat onto the other has no plane to open in, and gets no force


class BendElements(NamedTuple):
    points: np.ndarray  # (B,5) int32: centre, arm a (two particles), arm b (two particles)
    weights: np.ndarray  # (B,2) weight of the second particle of arm a, arm b
    least_squares: np.ndarray  # (B,2) m2, squared arm lengths below which force fades out
    stiffness: np.ndarray  # (B,) B w/l, N.m


@kernel
def _bend_of(items, lines, positions, out):  # type: ignore[no-untyped-def]
    x = positions
    for i in range(items[0], items[1]):
        o, a, b = lines.points[i, 0], lines.points[i, 1], lines.points[i, 3]
        weight_a, weight_b = lines.weights[i, 0], lines.weights[i, 1]
        ax, ay, az = x[o, 0] - x[a, 0], x[o, 1] - x[a, 1], x[o, 2] - x[a, 2]
        bx, by, bz = x[b, 0] - x[o, 0], x[b, 1] - x[o, 1], x[b, 2] - x[o, 2]
        if weight_a > 0.0:
            c = lines.points[i, 2]
            ax, ay, az = ax + weight_a * (x[a, 0] - x[c, 0]), ay + weight_a * (x[a, 1] - x[c, 1]), az + weight_a * (x[a, 2] - x[c, 2])
        if weight_b > 0.0:
            c = lines.points[i, 4]
            bx, by, bz = bx + weight_b * (x[c, 0] - x[b, 0]), by + weight_b * (x[c, 1] - x[b, 1]), bz + weight_b * (x[c, 2] - x[b, 2])
        aa = max(ax * ax + ay * ay + az * az, TINY)
        bb = max(bx * bx + by * by + bz * bz, TINY)
        dot = ax * bx + ay * by + az * bz
        nx, ny, nz = ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx
        cross2 = nx * nx + ny * ny + nz * nz
        scale = lines.stiffness[i] * angle_over_sine(cross2, dot, LEAST_SINE * math.sqrt(aa * bb))
        if aa < lines.least_squares[i, 0] or bb < lines.least_squares[i, 1]:
            scale *= min(aa / lines.least_squares[i, 0], 1.0) * min(bb / lines.least_squares[i, 1], 1.0)
        # dt/dd1 = (d1 (d1.d2)/|d1|^2 - d2)/|d1 x d2|, and alike for d2
        inverse = dot / (aa * bb)
        along_a, along_b = inverse * bb, inverse * aa
        ax, ay, az, bx, by, bz = (
            scale * (along_a * ax - bx), scale * (along_a * ay - by), scale * (along_a * az - bz),
            scale * (along_b * bx - ax), scale * (along_b * by - ay), scale * (along_b * bz - az),
        )  # fmt: skip
        k = 5 * i
        out[k, 0], out[k, 1], out[k, 2] = bx - ax, by - ay, bz - az
        if weight_a > 0.0:
            out[k + 2, 0], out[k + 2, 1], out[k + 2, 2] = weight_a * ax, weight_a * ay, weight_a * az
        if weight_b > 0.0:
            out[k + 4, 0], out[k + 4, 1], out[k + 4, 2] = -weight_b * bx, -weight_b * by, -weight_b * bz
        weight_a, weight_b = 1.0 - weight_a, 1.0 - weight_b
        out[k + 1, 0], out[k + 1, 1], out[k + 1, 2] = weight_a * ax, weight_a * ay, weight_a * az
        out[k + 3, 0], out[k + 3, 1], out[k + 3, 2] = -weight_b * bx, -weight_b * by, -weight_b * bz


@parallel_kernel
def write_bend(lines, positions, out):  # type: ignore[no-untyped-def]
    """Forces on centre, arm a (two), arm b (two) of line i into out[5 i] to out[5 i + 4]; the second particle of an arm only where it has weight."""
    for chunk in prange(CHUNKS):
        _bend_of(chunk_range(chunk, len(lines.stiffness)), lines, positions, out)


@kernel
def bend_row(span, stiffness, least_square, motion, out):  # type: ignore[no-untyped-def]
    """Lines whose arms are the lattice neighbours of their centres; span: first centre, slots to its neighbour, number of lines.

    stiffness (S,): B w/l; least_square: m2, squared arm length below which force fades out.

    out (6,S): force on arm a, and minus the force on arm b. |t| = 8 atan of the tangent of an eighth of it, so that nothing is divided by its sine.
    """
    first, step, count = span
    a, b, fading = first - step, first + step, 1.0 / least_square
    xo, yo, zo, xa, ya, za = motion[0, first:], motion[1, first:], motion[2, first:], motion[0, a:], motion[1, a:], motion[2, a:]
    xb, yb, zb, k = motion[0, b:], motion[1, b:], motion[2, b:], stiffness[first:]
    fax, fay, faz, fbx, fby, fbz = out[0, first:], out[1, first:], out[2, first:], out[3, first:], out[4, first:], out[5, first:]
    for i in range(np.uint64(count)):
        ax, ay, az = xo[i] - xa[i], yo[i] - ya[i], zo[i] - za[i]
        bx, by, bz = xb[i] - xo[i], yb[i] - yo[i], zb[i] - zo[i]
        aa, bb = max(ax * ax + ay * ay + az * az, TINY), max(bx * bx + by * by + bz * bz, TINY)
        dot = ax * bx + ay * by + az * bz
        length = math.sqrt(aa * bb)
        # squared tangents of a half, a quarter, an eighth of t
        nx, ny, nz = ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx
        cross2 = nx * nx + ny * ny + nz * nz
        # |d1||d2| + d1.d2, where an arm is folded back without cancellation
        opened = max(length + dot if dot > 0.0 else cross2 / (length - dot), LEAST_SINE * LEAST_SINE * length)
        inverse = 1.0 / opened
        half = cross2 * inverse * inverse
        inverse2 = 1.0 / (1.0 + math.sqrt(1.0 + half))
        quarter = half * inverse2 * inverse2
        inverse4 = 1.0 / (1.0 + math.sqrt(1.0 + quarter))
        over_sine = 8.0 * arctan_over(quarter * inverse4 * inverse4) * inverse * inverse2 * inverse4
        over_squares = 1.0 / (aa * bb)
        scale = k[i] * min(over_sine, math.pi / LEAST_SINE * length * over_squares)
        scale *= min(aa * fading, 1.0) * min(bb * fading, 1.0)
        along_a, along_b = dot * bb * over_squares, dot * aa * over_squares
        fax[i], fay[i], faz[i] = scale * (along_a * ax - bx), scale * (along_a * ay - by), scale * (along_a * az - bz)
        fbx[i], fby[i], fbz[i] = scale * (along_b * bx - ax), scale * (along_b * by - ay), scale * (along_b * bz - az)


class ForceBend(OneLaw):
    """Bending of lines of a cloth."""

    name = "bend"

    def __init__(self, lines: BendLines, materials: MaterialTable) -> None:
        points = np.column_stack([lines.center, lines.arm_a, lines.arm_b])
        weights = np.column_stack([lines.weight_a, lines.weight_b]).astype(np.float64)
        self._rest = np.column_stack([lines.length_a, lines.length_b])
        stiffness = materials.bending[lines.material, lines.direction] * lines.width / self._rest.mean(axis=1)
        self._lines = BendElements(indices(points), weights, (SHORTEST * self._rest) ** 2, stiffness)
        corners = points.copy()
        corners[:, 2::2][weights == 0.0] = NO_PARTICLE
        self.corners = indices(corners).ravel()

    def rows(self, slots: LatticeSlots, direction: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """B w/l (S,) of the weft and of the warp line centred at each slot; for lines (N,) of `direction` whose arms are lattice neighbours."""
        at = slots.slot[self._lines.points[:, 0]]
        weft, warp = (slots.spread(at[direction == axis], self._lines.stiffness[direction == axis]) for axis in (WEFT, WARP))
        return weft, warp

    def write_forces(self, positions: np.ndarray, velocities: np.ndarray, out: np.ndarray) -> None:
        write_bend(self._lines, positions, out)

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
