"""Shear (trellis): the angle between warp and weft in each lattice cell.

    u = (x01 + x11 - x00 - x10)/(2 h) mean warp,  w = (x10 + x11 - x00 - x01)/(2 h) mean weft,  gamma = asin(u.w/(|u| |w|))   [rad]
    E = A g(gamma)   [J]      T = g'(gamma) + tau G dgamma/dt   [N/m]

g [J/m2] is the elastic shear law of the sheet (fabric/law_shear.py), A the cell's area. Its gradient is exact: T A dgamma/du pulled back to the four corners.
Source: KES-FB1 shear, which measures the trellis angle; cells of four particles.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import prange

from garmentcad.arrays import CHUNKS, chunk_range, indices, kernel, parallel_kernel
from garmentcad.cloth.cloth import Cloth
from garmentcad.fabric.law_shear import shear
from garmentcad.fabric.material import MaterialTable
from garmentcad.forces.angle import angle_over_sine

SHORTEST = 1e-2  # floor of |u|, |w| (1 at rest): below it a cell has collapsed and its angle means nothing
LEAST_COSINE = 1e-6  # floor of cos(gamma) in divisions
SMALLEST = 1e-100


class ShearElements(NamedTuple):
    corners: np.ndarray  # (C,4) int32
    spacing: np.ndarray  # (C,) m
    area: np.ndarray  # (C,) m2
    stiffness: np.ndarray  # (C,) G, N/m per rad


@kernel
def shear_angle(ux, uy, uz, wx, wy, wz):  # type: ignore[no-untyped-def]
    """gamma of warp vector u and weft vector w, dgamma/du and dgamma/dw: (gamma, ux, uy, uz, wx, wy, wz)."""
    uu = max(ux * ux + uy * uy + uz * uz, SHORTEST * SHORTEST)
    ww = max(wx * wx + wy * wy + wz * wz, SHORTEST * SHORTEST)
    dot = ux * wx + uy * wy + uz * wz
    # |u x w|, the cosine of gamma times both lengths
    cross = math.sqrt(max(uu * ww - dot * dot, LEAST_COSINE * LEAST_COSINE * uu * ww))
    inverse = 1.0 / cross
    shear_u, shear_w = inverse * dot / uu, inverse * dot / ww
    return (
        dot * angle_over_sine(dot * dot, cross, SMALLEST),
        inverse * wx - shear_u * ux, inverse * wy - shear_u * uy, inverse * wz - shear_u * uz,
        inverse * ux - shear_w * wx, inverse * uy - shear_w * wy, inverse * uz - shear_w * wz,
    )  # fmt: skip


@kernel
def _shear_of(items, cells, damping_time, positions, velocities, out):  # type: ignore[no-untyped-def]
    x, v = positions, velocities
    for i in range(items[0], items[1]):
        a, b, c, d = cells.corners[i, 0], cells.corners[i, 1], cells.corners[i, 2], cells.corners[i, 3]
        half = 0.5 / cells.spacing[i]
        # diagonals p = x11 - x00, q = x01 - x10: u = half (p + q), w = half (p - q)
        px, py, pz = x[c, 0] - x[a, 0], x[c, 1] - x[a, 1], x[c, 2] - x[a, 2]
        qx, qy, qz = x[d, 0] - x[b, 0], x[d, 1] - x[b, 1], x[d, 2] - x[b, 2]
        gamma, gux, guy, guz, gwx, gwy, gwz = shear_angle(
            half * (px + qx), half * (py + qy), half * (pz + qz), half * (px - qx), half * (py - qy), half * (pz - qz)
        )
        # gradients on the diagonals
        gpx, gpy, gpz = half * (gux + gwx), half * (guy + gwy), half * (guz + gwz)
        gqx, gqy, gqz = half * (gux - gwx), half * (guy - gwy), half * (guz - gwz)
        rate = gpx * (v[c, 0] - v[a, 0]) + gpy * (v[c, 1] - v[a, 1]) + gpz * (v[c, 2] - v[a, 2])
        rate += gqx * (v[d, 0] - v[b, 0]) + gqy * (v[d, 1] - v[b, 1]) + gqz * (v[d, 2] - v[b, 2])
        stress, tangent = shear(gamma, cells.stiffness[i])
        scale = cells.area[i] * (stress + damping_time * tangent * rate)
        k = 4 * i
        out[k, 0], out[k, 1], out[k, 2] = scale * gpx, scale * gpy, scale * gpz
        out[k + 1, 0], out[k + 1, 1], out[k + 1, 2] = scale * gqx, scale * gqy, scale * gqz
        out[k + 2, 0], out[k + 2, 1], out[k + 2, 2] = -scale * gpx, -scale * gpy, -scale * gpz
        out[k + 3, 0], out[k + 3, 1], out[k + 3, 2] = -scale * gqx, -scale * gqy, -scale * gqz


@parallel_kernel
def write_shear(cells, damping_time, positions, velocities, out):  # type: ignore[no-untyped-def]
    """Forces on the corners 00, 10, 11, 01 of cell i into out[4 i] to out[4 i + 3]."""
    for chunk in prange(CHUNKS):
        _shear_of(chunk_range(chunk, len(cells.area)), cells, damping_time, positions, velocities, out)


class ForceShear:
    """Trellis shear of the cells of `cloth`. damping_time: tau [s]."""

    name = "shear"

    def __init__(self, cloth: Cloth, materials: MaterialTable, damping_time: float = 0.0) -> None:
        cells = cloth.cells
        self._cells = ShearElements(np.array(cells.corners), np.array(cells.spacing), np.array(cells.shear_area), np.array(materials.shear[cells.material]))
        self.damping_time = damping_time
        self.corners = indices(cells.corners).ravel()

    def write_forces(self, positions: np.ndarray, velocities: np.ndarray, out: np.ndarray) -> None:
        write_shear(self._cells, self.damping_time, positions, velocities, out)

    def _angle_and_lengths(self, positions: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        x00, x10, x11, x01 = (positions[self._cells.corners[:, k]] for k in range(4))
        half = 0.5 / self._cells.spacing[:, None]
        return angle_and_lengths(half * (x01 + x11 - x00 - x10), half * (x10 + x11 - x00 - x01))

    def energy(self, positions: np.ndarray) -> float:
        gamma, _, _ = self._angle_and_lengths(positions)
        return float(np.sum(0.5 * self._cells.stiffness * gamma * gamma * self._cells.area))

    def write_stiffness(self, positions: np.ndarray, out: np.ndarray) -> None:
        gamma, warp, weft = self._angle_and_lengths(positions)
        self._write_bound(np.abs(gamma), 1.0 / warp + 1.0 / weft, out)

    def write_rest_stiffness(self, out: np.ndarray) -> None:
        """`write_stiffness` at rest, wherever the panels lie."""
        self._write_bound(np.zeros(len(self._cells.area)), np.full(len(self._cells.area), 2.0), out)

    def _write_bound(self, gamma: np.ndarray, inverse_lengths: np.ndarray, out: np.ndarray) -> None:
        # |dgamma/dx| <= (1/|u| + 1/|w|)/(2 h) at each of four corners; (1 + |gamma|) covers the curvature of gamma
        cells = self._cells
        gradient = inverse_lengths / (2.0 * cells.spacing)
        out[:] = np.repeat(cells.stiffness * cells.area * (1.0 + gamma) * 4.0 * gradient * gradient, 4)


def angle_and_lengths(warp: np.ndarray, weft: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """gamma (N,) and the lengths of warp and weft vectors (N,3), not below SHORTEST."""
    warp_length = np.maximum(np.linalg.norm(warp, axis=1), SHORTEST)
    weft_length = np.maximum(np.linalg.norm(weft, axis=1), SHORTEST)
    sine = np.sum(warp * weft, axis=1) / (warp_length * weft_length)
    return np.arcsin(np.clip(sine, -1.0, 1.0)), warp_length, weft_length
