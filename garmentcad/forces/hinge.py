"""Seam hinges: the fold angle over welded sew lines.

    E = K (theta - theta0)^2/2   [J]      K = factor B_n length^2/(A_a + A_b)   [N.m per rad]
    B_n = mean over both sides of B_warp c^4 + B_weft s^4 + 4 D66 c^2 s^2,  c cosine between the edge's normal and the warp

theta [rad] is 0 where the two triangles are flat and positive where they fold toward the right side of the fabric. Corners: edge from 0 to 1, wing of side a
on its left as seen from the right side of the fabric, wing of side b on its right. Source: orthotropic plate rotated to the edge (PHYSICS: B at angle t);
factor counts the layers of the seam allowance.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import prange

from garmentcad.arrays import CHUNKS, chunk_range, indices, kernel, parallel_kernel
from garmentcad.cloth.cloth import Cloth
from garmentcad.fabric.material import MaterialTable, bending_along
from garmentcad.forces.force import OneLaw

LEAST_AREA2 = 1e-30  # m4, floor of squared normals: a wing on the sew line has no plane, and gets no force


class HingeElements(NamedTuple):
    corners: np.ndarray  # (H,4) int32
    stiffness: np.ndarray  # (H,) K, N.m per rad
    rest_angle: np.ndarray  # (H,) rad


@kernel
def _hinge_of(items, hinges, positions, out):  # type: ignore[no-untyped-def]
    x = positions
    for i in range(items[0], items[1]):
        s, e, a, b = hinges.corners[i, 0], hinges.corners[i, 1], hinges.corners[i, 2], hinges.corners[i, 3]
        ex, ey, ez = x[e, 0] - x[s, 0], x[e, 1] - x[s, 1], x[e, 2] - x[s, 2]
        ax, ay, az = x[a, 0] - x[s, 0], x[a, 1] - x[s, 1], x[a, 2] - x[s, 2]
        bx, by, bz = x[b, 0] - x[s, 0], x[b, 1] - x[s, 1], x[b, 2] - x[s, 2]
        # normals to the right side: e x a and b x e
        mx, my, mz = ey * az - ez * ay, ez * ax - ex * az, ex * ay - ey * ax
        nx, ny, nz = by * ez - bz * ey, bz * ex - bx * ez, bx * ey - by * ex
        length = math.sqrt(ex * ex + ey * ey + ez * ez)
        mm = max(mx * mx + my * my + mz * mz, LEAST_AREA2)
        nn = max(nx * nx + ny * ny + nz * nz, LEAST_AREA2)
        # (n x m).e = length^2 (b.m), because m is normal to e and n = b x e
        angle = math.atan2(length * (bx * mx + by * my + bz * mz), mx * nx + my * ny + mz * nz)
        scale = -hinges.stiffness[i] * (angle - hinges.rest_angle[i])
        inverse = 1.0 / length if length > 0.0 else 0.0
        fraction_a = (ax * ex + ay * ey + az * ez) * inverse
        fraction_b = (bx * ex + by * ey + bz * ez) * inverse
        mx, my, mz = scale / mm * mx, scale / mm * my, scale / mm * mz
        nx, ny, nz = scale / nn * nx, scale / nn * ny, scale / nn * nz
        k = 4 * i
        rest_a, rest_b = fraction_a - length, fraction_b - length
        out[k, 0], out[k, 1], out[k, 2] = rest_a * mx + rest_b * nx, rest_a * my + rest_b * ny, rest_a * mz + rest_b * nz
        k += 1
        out[k, 0], out[k, 1], out[k, 2] = -fraction_a * mx - fraction_b * nx, -fraction_a * my - fraction_b * ny, -fraction_a * mz - fraction_b * nz
        k += 1
        out[k, 0], out[k, 1], out[k, 2] = length * mx, length * my, length * mz
        k += 1
        out[k, 0], out[k, 1], out[k, 2] = length * nx, length * ny, length * nz


@parallel_kernel
def write_hinge(hinges, positions, out):  # type: ignore[no-untyped-def]
    """Forces on edge start, edge end, wing a, wing b of hinge i into out[4 i] to out[4 i + 3]."""
    for chunk in prange(CHUNKS):
        _hinge_of(chunk_range(chunk, len(hinges.stiffness)), hinges, positions, out)


class ForceHinge(OneLaw):
    """Hinges over the seams of `cloth`."""

    name = "hinge"

    def __init__(self, cloth: Cloth, materials: MaterialTable) -> None:
        hinges = cloth.hinges
        across = bending_along(materials, hinges.material, hinges.across_warp)
        self._hinges = HingeElements(np.array(hinges.corners), hinges.factor * across.mean(axis=1) * hinges.length2_over_area, np.array(hinges.rest_angle))
        self.corners = indices(hinges.corners).ravel()

    def write_forces(self, positions: np.ndarray, velocities: np.ndarray, out: np.ndarray) -> None:
        write_hinge(self._hinges, positions, out)

    def _geometry(self, positions: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """theta (H,) and bounds of |dtheta/dx| at edge start, edge end, wing a, wing b (H,4)."""
        start, end, a, b = (positions[self._hinges.corners[:, k]] for k in range(4))
        edge = end - start
        length = np.linalg.norm(edge, axis=1)
        m, n = np.cross(edge, a - start), np.cross(b - start, edge)
        angle = np.arctan2(length * np.sum((b - start) * m, axis=1), np.sum(m * n, axis=1))
        gradients = np.zeros((len(angle), 4))
        for k, wing, normal in ((2, a, m), (3, b, n)):
            inverse = 1.0 / np.sqrt(np.maximum(np.sum(normal * normal, axis=1), LEAST_AREA2))
            fraction = np.sum((wing - start) * edge, axis=1) / np.maximum(length, np.sqrt(LEAST_AREA2))
            gradients[:, 0] += np.abs(fraction - length) * inverse
            gradients[:, 1] += np.abs(fraction) * inverse
            gradients[:, k] = length * inverse
        return angle, gradients

    def energy(self, positions: np.ndarray) -> float:
        angle, _ = self._geometry(positions)
        return float(np.sum(0.5 * self._hinges.stiffness * (angle - self._hinges.rest_angle) ** 2))

    def write_stiffness(self, positions: np.ndarray, out: np.ndarray) -> None:
        # (1 + |theta - theta0|) covers the curvature of theta
        angle, gradients = self._geometry(positions)
        scale = self._hinges.stiffness * (1.0 + np.abs(angle - self._hinges.rest_angle)) * gradients.sum(axis=1)
        out[:] = (gradients * scale[:, None]).ravel()
