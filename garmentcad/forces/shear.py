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
from garmentcad.forces.force import OneLaw
from garmentcad.forces.rows import LatticeSlots
from garmentcad.forces.smooth import angle_over_sine

SHORTEST = 1e-2  # floor of |u|, |w| (1 at rest): below it a cell has collapsed and its angle means nothing
LEAST_COSINE = 1e-6  # floor of cos(gamma) in divisions


@kernel
def shear_angle(ux, uy, uz, wx, wy, wz):  # type: ignore[no-untyped-def]
    """gamma of warp vector u and weft vector w, dgamma/du and dgamma/dw, 1/|u x w|: (gamma, ux, uy, uz, wx, wy, wz, inverse). Without branches."""
    uu = max(ux * ux + uy * uy + uz * uz, SHORTEST * SHORTEST)
    ww = max(wx * wx + wy * wy + wz * wz, SHORTEST * SHORTEST)
    dot = ux * wx + uy * wy + uz * wz
    square = uu * ww
    # |u x w|, the cosine of gamma times both lengths
    cross = math.sqrt(max(square - dot * dot, LEAST_COSINE * LEAST_COSINE * square))
    inverse, inverse_square = 1.0 / cross, 1.0 / square
    inverse_lengths = math.sqrt(inverse_square)
    gamma = dot * inverse_lengths * angle_over_sine(cross * inverse_lengths)
    shear_u, shear_w = dot * ww * inverse_square, dot * uu * inverse_square
    return (
        gamma,
        inverse * (wx - shear_u * ux), inverse * (wy - shear_u * uy), inverse * (wz - shear_u * uz),
        inverse * (ux - shear_w * wx), inverse * (uy - shear_w * wy), inverse * (uz - shear_w * wz),
        inverse,
    )  # fmt: skip


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
