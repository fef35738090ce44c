"""Twist: what bending off the grain costs beyond bending along warp and weft.

    kappa = n.(x00 - x10 - x01 + x11)/h^2   [1/m]      n unit normal of the cell, along (x11 - x00) x (x01 - x10)
    E = A (4 D66) kappa^2/2   [J]      D66 = max(0, B_bias - (B_warp + B_weft)/4)   [N.m]

The gradient contains the normal's, so that the forces of a cell have no net torque. A is the cell and the border strip nearest to it.
Source: orthotropic plate without Poisson effect, KES-FB2 along warp, weft and bias.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import prange

from garmentcad.arrays import CHUNKS, chunk_range, indices, kernel, parallel_kernel
from garmentcad.cloth.cloth import Cloth
from garmentcad.fabric.material import MaterialTable

LEAST_NORMAL = 1e-3  # floor of |normal| in units of its rest value 2 h^2: a collapsed cell has no normal


class TwistElements(NamedTuple):
    corners: np.ndarray  # (C,4) int32
    least_normal: np.ndarray  # (C,) m2
    inverse_h2: np.ndarray  # (C,) 1/m2
    stiffness: np.ndarray  # (C,) 4 D66 A, N.m3


@kernel
def _twist_of(items, cells, positions, out):  # type: ignore[no-untyped-def]
    x = positions
    for i in range(items[0], items[1]):
        a, b, c, d = cells.corners[i, 0], cells.corners[i, 1], cells.corners[i, 2], cells.corners[i, 3]
        # diagonals p, q and their crossing, whose projection on the normal is the twist
        px, py, pz = x[c, 0] - x[a, 0], x[c, 1] - x[a, 1], x[c, 2] - x[a, 2]
        qx, qy, qz = x[d, 0] - x[b, 0], x[d, 1] - x[b, 1], x[d, 2] - x[b, 2]
        sx = (x[a, 0] - x[b, 0]) + (x[c, 0] - x[d, 0])
        sy = (x[a, 1] - x[b, 1]) + (x[c, 1] - x[d, 1])
        sz = (x[a, 2] - x[b, 2]) + (x[c, 2] - x[d, 2])
        nx, ny, nz = py * qz - pz * qy, pz * qx - px * qz, px * qy - py * qx
        inverse = 1.0 / max(math.sqrt(nx * nx + ny * ny + nz * nz), cells.least_normal[i])
        nx, ny, nz = nx * inverse, ny * inverse, nz * inverse
        height = nx * sx + ny * sy + nz * sz
        scale = -cells.stiffness[i] * height * cells.inverse_h2[i] * cells.inverse_h2[i]
        # d(height)/dp = q x t, d(height)/dq = t x p with t = (s - height n)/|normal|
        tx, ty, tz = (sx - height * nx) * inverse, (sy - height * ny) * inverse, (sz - height * nz) * inverse
        fpx, fpy, fpz = scale * (qy * tz - qz * ty), scale * (qz * tx - qx * tz), scale * (qx * ty - qy * tx)
        fqx, fqy, fqz = scale * (ty * pz - tz * py), scale * (tz * px - tx * pz), scale * (tx * py - ty * px)
        nx, ny, nz = scale * nx, scale * ny, scale * nz
        k = 4 * i
        out[k, 0], out[k, 1], out[k, 2] = nx - fpx, ny - fpy, nz - fpz
        out[k + 1, 0], out[k + 1, 1], out[k + 1, 2] = -nx - fqx, -ny - fqy, -nz - fqz
        out[k + 2, 0], out[k + 2, 1], out[k + 2, 2] = nx + fpx, ny + fpy, nz + fpz
        out[k + 3, 0], out[k + 3, 1], out[k + 3, 2] = -nx + fqx, -ny + fqy, -nz + fqz


@parallel_kernel
def write_twist(cells, positions, out):  # type: ignore[no-untyped-def]
    """Forces on the corners 00, 10, 11, 01 of cell i into out[4 i] to out[4 i + 3]."""
    for chunk in prange(CHUNKS):
        _twist_of(chunk_range(chunk, len(cells.stiffness)), cells, positions, out)


class ForceTwist:
    """Twist of those cells of `cloth` whose material has D66 > 0."""

    name = "twist"

    def __init__(self, cloth: Cloth, materials: MaterialTable) -> None:
        cells = cloth.cells
        stiff = np.flatnonzero(materials.twist[cells.material] > 0.0)
        h2 = cells.spacing[stiff] ** 2
        self._cells = TwistElements(
            indices(cells.corners[stiff]), LEAST_NORMAL * 2.0 * h2, 1.0 / h2, 4.0 * materials.twist[cells.material[stiff]] * cells.twist_area[stiff]
        )
        self.corners = indices(self._cells.corners).ravel()

    def write_forces(self, positions: np.ndarray, velocities: np.ndarray, out: np.ndarray) -> None:
        write_twist(self._cells, positions, out)

    def _geometry(self, positions: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        x00, x10, x11, x01 = (positions[self._cells.corners[:, k]] for k in range(4))
        p, q, crossing = x11 - x00, x01 - x10, x00 - x10 - x01 + x11
        normal = np.cross(p, q)
        size = np.maximum(np.linalg.norm(normal, axis=1), self._cells.least_normal)
        height = np.sum(normal * crossing, axis=1) / size
        diagonal = np.maximum(np.linalg.norm(p, axis=1), np.linalg.norm(q, axis=1))
        return height, np.linalg.norm(crossing, axis=1), diagonal, size

    def energy(self, positions: np.ndarray) -> float:
        height, _, _, _ = self._geometry(positions)
        return float(np.sum(0.5 * self._cells.stiffness * (height * self._cells.inverse_h2) ** 2))

    def write_stiffness(self, positions: np.ndarray, out: np.ndarray) -> None:
        # |d(height)/dx| <= 1 + |crossing| |diagonal|/|normal| at each of four corners; a further factor covers the curvature of height
        _, crossing, diagonal, size = self._geometry(positions)
        gradient = 1.0 + crossing * diagonal / size
        out[:] = np.repeat(4.0 * self._cells.stiffness * self._cells.inverse_h2**2 * gradient**3, 4)
