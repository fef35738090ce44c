"""Hinges: the fold angle over welded sew lines and over fold lines.

    E = K (r^2 + STICK (r - s)^2)/2   [J]      r = theta - theta0, s slider (fabric/law_bending.py)      K = factor B_n length^2/(A_a + A_b)   [N.m per rad]
    B_n = mean over both sides of B_warp c^4 + B_weft s^4 + 4 D66 c^2 s^2,  c cosine between the edge's normal and the warp

theta [rad] is 0 where the two triangles are flat and positive where they fold toward the right side of the fabric. Corners: edge from 0 to 1, wing of side a
on its left as seen from the right side of the fabric, wing of side b on its right. theta is the curvature times (A_a + A_b)/length, so far its slider's way.
Over a fold there is no friction: cloth is bent there far beyond where friction slips, over a few thicknesses and not over the strip of a hinge; smeared over
that it would hold tens of degrees (an estimate).
Source: orthotropic plate rotated to the edge (PHYSICS: B at angle t); factor counts the layers of the seam allowance.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from garmentcad.arrays import entry, indices, kernel, making_kernel, row_kernel
from garmentcad.cloth.cloth import Cloth
from garmentcad.fabric.internal_friction import dragged
from garmentcad.fabric.law_bending import STICK
from garmentcad.fabric.material import MaterialTable, bending_along, bending_friction_along
from garmentcad.forces.bend import stored
from garmentcad.forces.force import CURVES, Gauge, OneLaw, between
from garmentcad.forces.rows import PART
from garmentcad.geometry.angle import angle_over_sine, arctan2

LEAST_LENGTH = 1e-15  # m, floor of an edge's length in divisions
LEAST_AREA2 = 1e-30  # m4, floor of squared normals: a wing on the sew line has no plane, and gets no force


class HingeElements(NamedTuple):
    corners: np.ndarray  # (H,4) int32
    stiffness: np.ndarray  # (H,) K, N.m per rad
    rest_angle: np.ndarray  # (H,) rad
    way: np.ndarray  # (H,) rad


@row_kernel
def _load_wings(span, corners, positions, wings):  # type: ignore[no-untyped-def]
    """From the edge's start to its end, to wing a and to wing b, into wings (9,PART); span: first hinge, number."""
    first, count = span
    x = positions
    for i in range(count):
        s, e, a, b = corners[first + i, 0], corners[first + i, 1], corners[first + i, 2], corners[first + i, 3]
        for axis in range(3):
            wings[axis, i], wings[3 + axis, i], wings[6 + axis, i] = x[e, axis] - x[s, axis], x[a, axis] - x[s, axis], x[b, axis] - x[s, axis]


@row_kernel
def _fold(count, hinges, first, sliders, wings, lost):  # type: ignore[no-untyped-def]
    """In place of wings (9,PART): the forces on edge end, wing a and wing b. Moves the sliders; the energy lost [J] goes into lost (PART,)."""
    stiffness, rest_angle, way, slider = hinges.stiffness[first:], hinges.rest_angle[first:], hinges.way[first:], sliders[first:]
    exs, eys, ezs, axs, ays, azs, bxs, bys, bzs = wings[0], wings[1], wings[2], wings[3], wings[4], wings[5], wings[6], wings[7], wings[8]
    for i in range(np.uint64(count)):
        ex, ey, ez, ax, ay, az, bx, by, bz = exs[i], eys[i], ezs[i], axs[i], ays[i], azs[i], bxs[i], bys[i], bzs[i]
        # normals to the right side: e x a and b x e
        mx, my, mz = ey * az - ez * ay, ez * ax - ex * az, ex * ay - ey * ax
        nx, ny, nz = by * ez - bz * ey, bz * ex - bx * ez, bx * ey - by * ex
        length = math.sqrt(ex * ex + ey * ey + ez * ez)
        inverse = 1.0 / max(length, LEAST_LENGTH)
        inverse_m = 1.0 / math.sqrt(max(mx * mx + my * my + mz * mz, LEAST_AREA2))
        inverse_n = 1.0 / math.sqrt(max(nx * nx + ny * ny + nz * nz, LEAST_AREA2))
        mx, my, mz, nx, ny, nz = inverse_m * mx, inverse_m * my, inverse_m * mz, inverse_n * nx, inverse_n * ny, inverse_n * nz
        # |m + n| = 2 cos(theta/2), |m - n| = 2 |sin(theta/2)|: neither is lost where the other is 1; n x m points along the edge, by the sign of theta
        x, y, z, u, v, w = mx + nx, my + ny, mz + nz, mx - nx, my - ny, mz - nz
        cosine, sine = 0.5 * math.sqrt(x * x + y * y + z * z), 0.5 * math.sqrt(u * u + v * v + w * w)
        angle = math.copysign(2.0 * sine * angle_over_sine(cosine), bx * mx + by * my + bz * mz)
        opened = angle - rest_angle[i]
        after = dragged(slider[i], opened, way[i])
        lost[i] = STICK * stiffness[i] * way[i] * abs(after - slider[i])
        slider[i] = after
        scale = -stiffness[i] * (opened + STICK * (opened - after))
        on_a, on_b = scale * inverse_m, scale * inverse_n
        fraction_a = (ax * ex + ay * ey + az * ez) * inverse
        fraction_b = (bx * ex + by * ey + bz * ez) * inverse
        mx, my, mz, nx, ny, nz = on_a * mx, on_a * my, on_a * mz, on_b * nx, on_b * ny, on_b * nz
        exs[i], eys[i], ezs[i] = -fraction_a * mx - fraction_b * nx, -fraction_a * my - fraction_b * ny, -fraction_a * mz - fraction_b * nz
        axs[i], ays[i], azs[i], bxs[i], bys[i], bzs[i] = length * mx, length * my, length * mz, length * nx, length * ny, length * nz


@making_kernel
def hinge_part(part, hinges, sliders, positions, out):  # type: ignore[no-untyped-def]
    """Returns the energy lost [J]."""
    first = part * PART
    count = min(len(hinges.stiffness) - first, PART)
    wings, lost, total = np.empty((9, PART)), np.empty(PART), 0.0
    _load_wings((first, count), hinges.corners, positions, wings)
    _fold(count, hinges, first, sliders, wings, lost)
    for i in range(count):
        k = 4 * (first + i)
        for axis in range(3):
            end, a, b = wings[axis, i], wings[3 + axis, i], wings[6 + axis, i]
            out[k, axis], out[k + 1, axis], out[k + 2, axis], out[k + 3, axis] = -(end + (a + b)), end, a, b
        total += lost[i]
    return total


@entry
@kernel
def write_hinge(hinges, sliders, positions, velocities, out):  # type: ignore[no-untyped-def]
    """Forces on edge start, edge end, wing a, wing b of hinge i into out[4 i] to out[4 i + 3]. Returns the energy lost [J]."""
    lost = 0.0
    for part in range(-(-len(hinges.stiffness) // PART)):
        lost += hinge_part(part, hinges, sliders, positions, out)
    return lost


class ForceHinge(OneLaw):
    """Hinges over the seams and folds of `cloth`. fold_angles (F,): rest angles of the folds, rad; None for flat ones."""

    name = "hinge"

    def __init__(self, cloth: Cloth, materials: MaterialTable, fold_angles: np.ndarray | None = None) -> None:
        hinges, over_fold = cloth.hinges, cloth.hinges.fold >= 0
        rest = np.array(hinges.rest_angle)
        if fold_angles is not None:
            rest[over_fold] = fold_angles[hinges.fold[over_fold]]
        across = bending_along(materials, hinges.material, hinges.across_warp)
        hold = bending_friction_along(materials, hinges.material, hinges.across_warp).mean(axis=1)
        mean = across.mean(axis=1)
        self.way = np.where(over_fold, 0.0, hold / (STICK * mean) * hinges.length / hinges.length2_over_area)
        self._hinges = HingeElements(np.array(hinges.corners), hinges.factor * mean * hinges.length2_over_area, rest, self.way)
        self.arguments = (self._hinges,)
        self.corners = indices(hinges.corners).ravel()

    def slack(self) -> np.ndarray:
        return np.zeros(len(self.way))

    def gauge(self, positions: np.ndarray) -> Gauge:
        ends = self._hinges.corners[:, :2]
        return Gauge(self.strain(positions), self.way, np.full(len(self.way), CURVES.index("seam bending")), ends[:, 0], between(ends))

    def write_forces(self, positions: np.ndarray, velocities: np.ndarray, out: np.ndarray, sliders: np.ndarray | None = None) -> None:
        write_hinge(*self.arguments, self.slack() if sliders is None else sliders, positions, velocities, out)

    def strain(self, positions: np.ndarray) -> np.ndarray:
        """theta - theta0 (H,) [rad]."""
        return np.asarray(self._geometry(positions)[0] - self._hinges.rest_angle)

    def _geometry(self, positions: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """theta (H,) and bounds of |dtheta/dx| at edge start, edge end, wing a, wing b (H,4)."""
        start, end, a, b = (positions[self._hinges.corners[:, k]] for k in range(4))
        edge = end - start
        length = np.linalg.norm(edge, axis=1)
        m, n = np.cross(edge, a - start), np.cross(b - start, edge)
        angle = arctan2(length * np.sum((b - start) * m, axis=1), np.sum(m * n, axis=1))
        gradients = np.zeros((len(angle), 4))
        for k, wing, normal in ((2, a, m), (3, b, n)):
            inverse = 1.0 / np.sqrt(np.maximum(np.sum(normal * normal, axis=1), LEAST_AREA2))
            fraction = np.sum((wing - start) * edge, axis=1) / np.maximum(length, np.sqrt(LEAST_AREA2))
            gradients[:, 0] += np.abs(fraction - length) * inverse
            gradients[:, 1] += np.abs(fraction) * inverse
            gradients[:, k] = length * inverse
        return angle, gradients

    def energy(self, positions: np.ndarray, sliders: np.ndarray | None = None) -> float:
        return stored(self._hinges.stiffness, self.strain(positions), self.slack() if sliders is None else sliders, self.way)

    def write_stiffness_across(self, positions: np.ndarray, out: np.ndarray) -> None:
        self.write_stiffness(positions, out)

    def write_stiffness(self, positions: np.ndarray, out: np.ndarray) -> None:
        # (1 + |theta - theta0|) covers the curvature of theta
        angle, gradients = self._geometry(positions)
        stiffness = self._hinges.stiffness * np.where(self.way > 0.0, 1.0 + STICK, 1.0)
        scale = stiffness * (1.0 + np.abs(angle - self._hinges.rest_angle)) * gradients.sum(axis=1)
        out[:] = (gradients * scale[:, None]).ravel()
