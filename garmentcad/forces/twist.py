"""Twist: what bending off the grain costs beyond bending along warp and weft.

    kappa = n.(x00 - x10 - x01 + x11)/h^2   [1/m]      n unit normal of the cell, along (x11 - x00) x (x01 - x10)
    E = A (4 D66) (kappa^2 + STICK (kappa - s)^2)/2   [J]      D66 = max(0, B_bias - (B_warp + B_weft)/4)   [N.m], s slider (fabric/law_bending.py)

The gradient contains the normal's, so that the forces of a cell have no net torque. A is the cell and the border strip nearest to it.
Source: orthotropic plate without Poisson effect, KES-FB2 along warp, weft and bias.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from garmentcad.arrays import indices
from garmentcad.cloth.cloth import Cells
from garmentcad.fabric.law_bending import STICK
from garmentcad.fabric.material import MaterialTable
from garmentcad.forces.bend import stored
from garmentcad.forces.rows import LatticeSlots
from garmentcad.forces.shear import cell_slots
from garmentcad.geometry.vectors import dots, lengths, picked

LEAST_NORMAL = 1e-3  # floor of |normal| in units of its rest value 2 h^2: a collapsed cell has no normal


class TwistElements(NamedTuple):
    corners: np.ndarray  # (C,4) int32
    least_normal: np.ndarray  # (C,) m2
    stiffness: np.ndarray  # (C,) 4 D66 A/h^4, N/m
    way: np.ndarray  # (C,) d h^2, m


class LawTwist:
    """Twist of those cells whose material has D66 > 0; strain is kappa h^2 [m]. at: (C,) places of their sliders among the (S,) of cells."""

    name = "twist"

    def __init__(self, cells: Cells, materials: MaterialTable, slots: LatticeSlots) -> None:
        stiff = np.flatnonzero(materials.twist[cells.material] > 0.0)
        mine = Cells(*(column[stiff] for column in cells))
        h2 = mine.spacing**2
        four_d66 = 4.0 * materials.twist[mine.material]
        way = materials.twist_friction[mine.material] / (STICK * four_d66) * h2
        self._cells = TwistElements(indices(mine.corners), LEAST_NORMAL * 2.0 * h2, four_d66 * mine.twist_area / h2**2, way)
        self.corners = indices(mine.corners).ravel()
        self.way = way
        self.at = cell_slots(mine, slots)

    def write_rows(self, out: np.ndarray) -> None:
        """Into out (2,S), of the cell whose corner 00 is at the slot: 4 D66 A/h^4 [N/m], d h^2 [m]."""
        out[:, self.at] = np.stack([self._cells.stiffness, self._cells.way])

    def slack(self) -> np.ndarray:
        return np.zeros(len(self.at))

    def _geometry(self, positions: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        x00, x10, x11, x01 = picked(positions, self._cells.corners)
        p, q, crossing = x11 - x00, x01 - x10, x00 - x10 - x01 + x11
        normal = np.cross(p, q)
        size = np.maximum(lengths(normal), self._cells.least_normal)
        height = dots(normal, crossing) / size
        diagonal = np.maximum(lengths(p), lengths(q))
        return height, lengths(crossing), diagonal, size

    def strain(self, positions: np.ndarray) -> np.ndarray:
        return self._geometry(positions)[0]

    def energy(self, positions: np.ndarray, sliders: np.ndarray) -> float:
        return stored(self._cells.stiffness, self.strain(positions), sliders, self.way)

    def write_stiffness(self, positions: np.ndarray, out: np.ndarray) -> None:
        # |d(height)/dx| <= 1 + |crossing| |diagonal|/|normal| at each of four corners; a further factor covers the curvature of height
        _, crossing, diagonal, size = self._geometry(positions)
        gradient = 1.0 + crossing * diagonal / size
        stiffness = self._cells.stiffness * np.where(self.way > 0.0, 1.0 + STICK, 1.0)
        out[:] = np.repeat(4.0 * stiffness * gradient * gradient * gradient, 4)
