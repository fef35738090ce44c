"""Shear (trellis): the angle between warp and weft in each lattice cell.

    u = (x01 + x11 - x00 - x10)/(2 h) mean warp,  w = (x10 + x11 - x00 - x01)/(2 h) mean weft,  gamma = asin(u.w/(|u| |w|))   [rad]
    E = A g(gamma)   [J]      T = g'(gamma) + tau G dgamma/dt   [N/m]

g [J/m2] is the elastic shear law of the sheet (fabric/law_shear.py), A the cell's area. Its gradient is exact: T A dgamma/du pulled back to the four corners.
Source: KES-FB1 shear, which measures the trellis angle; cells of four particles.
"""

from __future__ import annotations

import math

import numpy as np

from garmentcad.arrays import kernel
from garmentcad.cloth.cloth import WARP, Cells, Cloth
from garmentcad.fabric.material import MaterialTable
from garmentcad.forces.angle import angle_over_sine
from garmentcad.forces.force import OneLaw
from garmentcad.forces.rows import LatticeSlots
from garmentcad.forces.smooth import arctan_over

SHORTEST = 1e-2  # floor of |u|, |w| (1 at rest): below it a cell has collapsed and its angle means nothing
LEAST_COSINE = 1e-6  # floor of cos(gamma) in divisions
SMALLEST = 1e-100


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
def shear_row(count, stiffness, half, damping_time, diagonals, out):  # type: ignore[no-untyped-def]
    """Shear forces of a row of cells along their diagonals. diagonals (12,C): p, q, and their velocities; half: 1/(2 h); out (6,C): along p on corner 00
    (minus that on 11), along q on corner 10 (minus that on 01)."""
    px, py, pz, qx, qy, qz = diagonals[0], diagonals[1], diagonals[2], diagonals[3], diagonals[4], diagonals[5]
    pu, pv, pw, qu, qv, qw = diagonals[6], diagonals[7], diagonals[8], diagonals[9], diagonals[10], diagonals[11]
    fpx, fpy, fpz, fqx, fqy, fqz = out[0], out[1], out[2], out[3], out[4], out[5]
    for i in range(np.uint64(count)):
        # p = x11 - x00, q = x01 - x10: u = half (p + q), w = half (p - q)
        ux, uy, uz = half * (px[i] + qx[i]), half * (py[i] + qy[i]), half * (pz[i] + qz[i])
        wx, wy, wz = half * (px[i] - qx[i]), half * (py[i] - qy[i]), half * (pz[i] - qz[i])
        uu = max(ux * ux + uy * uy + uz * uz, SHORTEST * SHORTEST)
        ww = max(wx * wx + wy * wy + wz * wz, SHORTEST * SHORTEST)
        dot = ux * wx + uy * wy + uz * wz
        # |u x w|, the cosine of gamma times both lengths
        cross = math.sqrt(max(uu * ww - dot * dot, LEAST_COSINE * LEAST_COSINE * uu * ww))
        # gamma = atan2(dot, cross) = 4 atan of the tangent of a quarter of it
        half_tangent = dot / (cross + math.sqrt(cross * cross + dot * dot))
        tangent = half_tangent / (1.0 + math.sqrt(1.0 + half_tangent * half_tangent))
        gamma = 4.0 * tangent * arctan_over(tangent * tangent)
        inverse = 1.0 / cross
        shear_u, shear_w = inverse * dot / uu, inverse * dot / ww
        gux, guy, guz = inverse * wx - shear_u * ux, inverse * wy - shear_u * uy, inverse * wz - shear_u * uz
        gwx, gwy, gwz = inverse * ux - shear_w * wx, inverse * uy - shear_w * wy, inverse * uz - shear_w * wz
        # gradients on the diagonals
        gpx, gpy, gpz = half * (gux + gwx), half * (guy + gwy), half * (guz + gwz)
        gqx, gqy, gqz = half * (gux - gwx), half * (guy - gwy), half * (guz - gwz)
        rate = gpx * pu[i] + gpy * pv[i] + gpz * pw[i] + gqx * qu[i] + gqy * qv[i] + gqz * qw[i]
        scale = stiffness[i] * (gamma + damping_time * rate)
        fpx[i], fpy[i], fpz[i] = scale * gpx, scale * gpy, scale * gpz
        fqx[i], fqy[i], fqz[i] = scale * gqx, scale * gqy, scale * gqz


class LawShear(OneLaw):
    """Trellis shear of the cells of `cloth`."""

    name = "shear"

    def __init__(self, cloth: Cloth, materials: MaterialTable) -> None:
        self._cells = cloth.cells
        self._stiffness = np.array(materials.shear[cloth.cells.material])
        self.corners = cloth.cells.corners.ravel()

    def rows(self, slots: LatticeSlots) -> np.ndarray:
        """G A (S,) of the cell whose corner 00 is at the slot, J."""
        return slots.spread(cell_slots(self._cells, slots), self._stiffness * self._cells.shear_area)

    def _angle_and_lengths(self, positions: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        x00, x10, x11, x01 = (positions[self._cells.corners[:, k]] for k in range(4))
        half = 0.5 / self._cells.spacing[:, None]
        return angle_and_lengths(half * (x01 + x11 - x00 - x10), half * (x10 + x11 - x00 - x01))

    def energy(self, positions: np.ndarray) -> float:
        gamma, _, _ = self._angle_and_lengths(positions)
        return float(np.sum(0.5 * self._stiffness * gamma * gamma * self._cells.shear_area))

    def write_stiffness(self, positions: np.ndarray, out: np.ndarray) -> None:
        gamma, warp, weft = self._angle_and_lengths(positions)
        self._write_bound(np.abs(gamma), 1.0 / warp + 1.0 / weft, out)

    def write_rest_stiffness(self, out: np.ndarray) -> None:
        """`write_stiffness` at rest, wherever the panels lie."""
        self._write_bound(np.zeros(len(self._stiffness)), np.full(len(self._stiffness), 2.0), out)

    def _write_bound(self, gamma: np.ndarray, inverse_lengths: np.ndarray, out: np.ndarray) -> None:
        # |dgamma/dx| <= (1/|u| + 1/|w|)/(2 h) at each of four corners; (1 + |gamma|) covers the curvature of gamma
        cells = self._cells
        gradient = inverse_lengths / (2.0 * cells.spacing)
        out[:] = np.repeat(self._stiffness * cells.shear_area * (1.0 + gamma) * 4.0 * gradient * gradient, 4)


def cell_slots(cells: Cells, slots: LatticeSlots) -> np.ndarray:
    """Slot (C,) of corner 00 of each cell. ValueError where its corners are not four neighbours of the lattice."""
    a, b, c, d = slots.slot[cells.corners].T
    up = slots.step(a, WARP)
    if not ((b == a + 1) & (d == a + up) & (c == d + 1)).all():
        raise ValueError("a cell does not join four neighbours of the lattice")
    return np.asarray(a)


def angle_and_lengths(warp: np.ndarray, weft: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """gamma (N,) and the lengths of warp and weft vectors (N,3), not below SHORTEST."""
    warp_length = np.maximum(np.linalg.norm(warp, axis=1), SHORTEST)
    weft_length = np.maximum(np.linalg.norm(weft, axis=1), SHORTEST)
    sine = np.sum(warp * weft, axis=1) / (warp_length * weft_length)
    return np.arcsin(np.clip(sine, -1.0, 1.0)), warp_length, weft_length
