"""Twist: what bending off the grain costs beyond bending along warp and weft.

    kappa = n.(x00 - x10 - x01 + x11)/h^2   [1/m]      n unit normal of the cell, along (x11 - x00) x (x01 - x10)
    E = A (4 D66) (kappa^2 + STICK (kappa - s)^2)/2   [J]      D66 = max(0, B_bias - (B_warp + B_weft)/4)   [N.m], s slider (fabric/law_bending.py)

The gradient contains the normal's, so that the forces of a cell have no net torque. A is the cell and the border strip nearest to it.
Source: orthotropic plate without Poisson effect, KES-FB2 along warp, weft and bias.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from garmentcad.arrays import compact, kernel
from garmentcad.cloth.cloth import Cells
from garmentcad.fabric.law_bending import STICK
from garmentcad.fabric.material import MaterialTable
from garmentcad.forces.bend import stored
from garmentcad.forces.rows import LatticeSlots
from garmentcad.forces.shear import cell_slots
from garmentcad.geometry.vectors import dots, lengths, picked

LEAST_NORMAL = 1e-3  # floor of |normal| in units of its rest value 2 h^2: a collapsed cell has no normal


@kernel
def twist_bound(uu, ww, uw, crossing, spacing, stiffness, way):  # type: ignore[no-untyped-def]
    """Row sum bound [N/m] at each corner of a cell, whatever its slider, from the products of its mean warp and weft and the length of its crossing [m]."""
    # |d(height)/dx| <= 1 + |crossing| |diagonal|/|p x q| at each of four corners; a further factor covers the curvature of height
    normal = 2.0 * spacing * spacing * max(math.sqrt(max(uu * ww - uw * uw, 0.0)), LEAST_NORMAL)
    gradient = 1.0 + crossing * spacing * math.sqrt(uu + ww + 2.0 * abs(uw)) / normal
    return 4.0 * stiffness * ((1.0 + STICK) if way > 0.0 else 1.0) * gradient * gradient * gradient


class TwistElements(NamedTuple):
    corners: np.ndarray  # (C,4) int32
    least_normal: np.ndarray  # (C,) m2
    stiffness: np.ndarray  # (C,) 4 D66 A/h^4, N/m
    way: np.ndarray  # (C,) d h^2, m


class LawTwist:
    """Twist of those cells whose material has D66 > 0; strain is kappa h^2 [m]. at: (C,) places of their sliders among the (S,) of cells."""

    name = "twist"

    def __init__(self, cells: Cells, materials: MaterialTable, slots: LatticeSlots) -> None:
        stiff = materials.twist[cells.material] > 0.0
        mine = cells if stiff.all() else Cells(*(column[stiff] for column in cells))
        h2 = mine.spacing**2
        four_d66 = 4.0 * materials.twist[mine.material]
        self.way = compact(materials.twist_friction[mine.material] / (STICK * four_d66) * h2)
        self._cells = TwistElements(mine.corners, compact(LEAST_NORMAL * 2.0 * h2), four_d66 * mine.twist_area / h2**2, self.way)
        self.at = cell_slots(mine, slots)

    def write_rows(self, out: np.ndarray) -> None:
        """Into out (2,S), of the cell whose corner 00 is at the slot: 4 D66 A/h^4 [N/m], d h^2 [m]."""
        out[:, self.at] = np.stack([self._cells.stiffness, self._cells.way])

    def slack(self) -> np.ndarray:
        return np.zeros(len(self.at))

    @property
    def between(self) -> np.ndarray:
        """(C,4) of `Gauge`."""
        return self._cells.corners

    def strain(self, positions: np.ndarray) -> np.ndarray:
        x00, x10, x11, x01 = picked(positions, self._cells.corners)
        normal = np.cross(x11 - x00, x01 - x10)
        return np.asarray(dots(normal, x00 - x10 - x01 + x11) / np.maximum(lengths(normal), self._cells.least_normal))

    def energy(self, positions: np.ndarray, sliders: np.ndarray) -> float:
        return stored(self._cells.stiffness, self.strain(positions), sliders, self.way)
