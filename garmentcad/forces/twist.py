"""Twist: what bending off the grain costs beyond bending along warp and weft.

    kappa = n.(x00 - x10 - x01 + x11)/h^2   [1/m]      n unit normal of the cell, along (x11 - x00) x (x01 - x10)
    E = A (4 D66) kappa^2/2   [J]      D66 = max(0, B_bias - (B_warp + B_weft)/4)   [N.m]

The gradient contains the normal's, so that the forces of a cell have no net torque. A is the cell and the border strip nearest to it.
Source: orthotropic plate without Poisson effect, KES-FB2 along warp, weft and bias.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from garmentcad.arrays import indices
from garmentcad.cloth.cloth import Cells, Cloth
from garmentcad.fabric.material import MaterialTable
from garmentcad.forces.force import OneLaw
from garmentcad.forces.rows import LatticeSlots
from garmentcad.forces.shear import cell_slots

LEAST_NORMAL = 1e-3  # floor of |normal| in units of its rest value 2 h^2: a collapsed cell has no normal


class TwistElements(NamedTuple):
    corners: np.ndarray  # (C,4) int32
    least_normal: np.ndarray  # (C,) m2
    inverse_h2: np.ndarray  # (C,) 1/m2
    stiffness: np.ndarray  # (C,) 4 D66 A, N.m3


class LawTwist(OneLaw):
    """Twist of those cells of `cloth` whose material has D66 > 0."""

    name = "twist"

    def __init__(self, cloth: Cloth, materials: MaterialTable) -> None:
        cells = cloth.cells
        stiff = np.flatnonzero(materials.twist[cells.material] > 0.0)
        h2 = cells.spacing[stiff] ** 2
        self._stiff = Cells(*(column[stiff] for column in cells))
        self._cells = TwistElements(
            indices(cells.corners[stiff]), LEAST_NORMAL * 2.0 * h2, 1.0 / h2, 4.0 * materials.twist[cells.material[stiff]] * cells.twist_area[stiff]
        )
        self.corners = indices(self._cells.corners).ravel()

    def rows(self, slots: LatticeSlots) -> np.ndarray:
        """4 D66 A/h^4 (S,) of the cell whose corner 00 is at the slot, N/m."""
        return slots.spread(cell_slots(self._stiff, slots), self._cells.stiffness * self._cells.inverse_h2**2)

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
