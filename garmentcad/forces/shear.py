"""Shear (trellis): the angle between warp and weft in each lattice cell.

    u = (x01 + x11 - x00 - x10)/(2 h) mean warp,  w = (x10 + x11 - x00 - x01)/(2 h) mean weft,  gamma = asin(u.w/(|u| |w|)) + arcs   [rad]
    E = A g(gamma, s)   [J]      T = g'(gamma, s) + tau G_e dasin/dt   [N/m]

arcs is what cloth that is only bent lacks of an angle of 0 (arcs.py); damping leaves it out. g [J/m2] is what the shear law of the sheet stores, s its slider
(fabric/law_shear.py), A the cell's area. The gradient is exact: T A dgamma/dx at the four corners and, of arcs, the eight neighbours.
Source: KES-FB1 shear, which measures the trellis angle; cells of four particles.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from garmentcad.arrays import compact, entry, floats, indices, kernel
from garmentcad.cloth.cloth import WARP, Cells
from garmentcad.fabric.law_shear import HIGH, LOW, shear_energy, stick_coefficients
from garmentcad.fabric.material import MaterialTable
from garmentcad.forces.arcs import MOST, NEIGHBOURS, SHARE, bow_and_crossing, limited, limited_arc
from garmentcad.forces.force import NO_PARTICLE
from garmentcad.forces.rows import LatticeSlots
from garmentcad.geometry.angle import angle_over_sine, arcsin
from garmentcad.geometry.vectors import dots, lengths, picked

SHORTEST = 1e-2  # floor of |u|, |w| (1 at rest): below it a cell has collapsed and its angle means nothing
LEAST_COSINE = 1e-6  # floor of cos(gamma) in divisions


@kernel
def chord_products(ux, uy, uz, wx, wy, wz):  # type: ignore[no-untyped-def]
    """u.u and w.w, neither below SHORTEST^2, and u.w of warp vector u and weft vector w (length 1 at rest)."""
    uu = max(ux * ux + uy * uy + uz * uz, SHORTEST * SHORTEST)
    ww = max(wx * wx + wy * wy + wz * wz, SHORTEST * SHORTEST)
    return uu, ww, ux * wx + uy * wy + uz * wz


@kernel
def chord_angle(uu, ww, dot):  # type: ignore[no-untyped-def]
    """asin(u.w/(|u| |w|)) [rad] from `chord_products`, 1/|u x w|, and the shares of u and w in each other, u.w/u.u and u.w/w.w. Without branches."""
    square = uu * ww
    # |u x w|, the cosine of gamma times both lengths
    cross = math.sqrt(max(square - dot * dot, LEAST_COSINE * LEAST_COSINE * square))
    inverse, inverse_square = 1.0 / cross, 1.0 / square
    inverse_lengths = math.sqrt(inverse_square)
    gamma = dot * inverse_lengths * angle_over_sine(cross * inverse_lengths)
    return gamma, inverse, dot * ww * inverse_square, dot * uu * inverse_square


@kernel
def chord_gradients(ux, uy, uz, wx, wy, wz, inverse, share_u, share_w):  # type: ignore[no-untyped-def]
    """Derivatives of the angle of `chord_angle` by u and by w [rad], three numbers each, from u, w and what else it returns."""
    return (
        inverse * (wx - share_u * ux), inverse * (wy - share_u * uy), inverse * (wz - share_u * uz),
        inverse * (ux - share_w * wx), inverse * (uy - share_w * wy), inverse * (uz - share_w * wz),
    )  # fmt: skip


def largest_tangent(size, stiffness, low, rise, way):  # type: ignore[no-untyped-def]
    """Bound [N/m per rad] of the tangent at angles of this size [rad], whatever the slider; (1 + |gamma| + d) covers the curvature of gamma. Numbers or
    arrays; the others are those of `ShearCurves`."""
    stick = low + rise * np.minimum(np.maximum(size - LOW, 0.0), HIGH - LOW)
    return (stiffness + stick) * (1.0 + size + way) + np.abs(rise) * way


_largest_tangent = kernel(largest_tangent)


@kernel
def shear_bounds(uu, ww, uw, bow, both, crossing, spacing, stiffness, low, rise, way, arc):  # type: ignore[no-untyped-def]
    """Row sum bounds [N/m] of a cell, whatever its slider: at its corners 00 and 11, at 10 and 01, at each of its neighbours.

    uu, ww, uw: products of the mean warp and weft, the first two not below SHORTEST^2; bow, both, crossing: length of the bow [m], its product with the
    crossing [m2] and the length of that, see arcs.py; stiffness to arc: coefficients of the cell, see `LawShear.write_rows`.
    """
    # |dgamma/dx|^2 = (1/|u|^2 + 1/|w|^2 -+ 2 sin(gamma)/(|u| |w|))/(2 h)^2 of the chords, - at 00 and 11
    chords, inverse_square = chord_angle(uu, ww, uw)[0], 1.0 / (uu * ww)
    along = 0.5 / spacing * math.sqrt(max((uu + ww - 2.0 * uw) * inverse_square, 0.0))
    across = 0.5 / spacing * math.sqrt(max((uu + ww + 2.0 * uw) * inverse_square, 0.0))
    # arcs add their own, and their curvature: of bow.crossing, with rows of 16 at the corners and 4 at the neighbours, and where they are limited
    lean, keen = limited_arc(arc * both)
    size, beside = max(abs(chords), abs(chords + lean)), arc * crossing
    bent = arc * bow + 2.0 * beside
    tangent = _largest_tangent(size, stiffness, low, rise, way)
    scale = tangent * (2.0 * (along + across + 2.0 * bent) + NEIGHBOURS * beside)
    pull = tangent * (abs(chords + lean) + way)
    curved = 4.0 * pull * arc
    limit = 5.0 * pull * keen * abs(lean * lean * lean) / (MOST * MOST * MOST * MOST) * (4.0 * bent + NEIGHBOURS * beside)
    every = 4.0 * curved + bent * limit
    return (along + bent) * scale + every, (across + bent) * scale + every, beside * scale + curved + beside * limit


class ShearCurves(NamedTuple):
    """Arguments of `law_shear.shear`, (N,) each."""

    stiffness: np.ndarray  # G_e, N/m per rad
    low: np.ndarray
    rise: np.ndarray
    way: np.ndarray  # rad


def shear_curves(materials: MaterialTable, rows: np.ndarray) -> ShearCurves:
    """The curves of rows (N,) of a material table."""
    low, rise = stick_coefficients(materials.shear_friction[rows], materials.shear_way[rows])
    return ShearCurves(np.array(materials.shear[rows]), low, rise, np.where(np.maximum(low, rise) > 0.0, materials.shear_way[rows], 0.0))


@entry
@kernel
def evaluate_energy(curves, angles, sliders, energy):  # type: ignore[no-untyped-def]
    for i in range(len(angles)):
        energy[i] = shear_energy(angles[i], sliders[i], curves.stiffness[i], curves.low[i], curves.rise[i], curves.way[i])


def shear_energy_at(curves: ShearCurves, angles: np.ndarray, sliders: np.ndarray) -> np.ndarray:
    """Stored energy per area [J/m2] of each angle (N,) [rad] with its slider (N,)."""
    energy = np.empty(len(angles))
    evaluate_energy(ShearCurves(*map(floats, curves)), floats(angles), floats(sliders), energy)
    return energy


def largest_shear_stiffness(curves: ShearCurves, angles: np.ndarray) -> np.ndarray:
    """`largest_tangent` of each curve at its angle (N,) [rad]."""
    return np.asarray(largest_tangent(np.abs(angles), *curves))


class LawShear:
    """Trellis shear of cells. at: (C,) places of their sliders among the (S,) of cells. neighbours: (C,8) of arcs.py; None: without arcs."""

    name = "shear"

    def __init__(self, cells: Cells, neighbours: np.ndarray | None, materials: MaterialTable, slots: LatticeSlots) -> None:
        self._cells = cells
        self._neighbours = np.full((len(cells.corners), NEIGHBOURS), NO_PARTICLE, dtype=np.int32) if neighbours is None else neighbours
        self.set_curves(materials)
        self._arcs = compact(np.where(self._neighbours[:, 0] == NO_PARTICLE, 0.0, SHARE / cells.spacing**2))
        self.way = self._curves.way
        self.at = cell_slots(cells, slots)
        self.corners = cells.corners.ravel()

    def set_curves(self, materials: MaterialTable) -> None:
        """The shear curves of `materials` from now on; `write_rows` brings them to the kernels."""
        self._curves = ShearCurves(*map(compact, shear_curves(materials, self._cells.material)))

    def write_rows(self, out: np.ndarray) -> None:
        """Into out (5,S), of the cell whose corner 00 is at the slot: G_e A and the stick spring's two times A [J], d [rad], SHARE/h^2 [1/m2]."""
        area, curves = self._cells.shear_area, self._curves
        out[:, self.at] = np.stack([curves.stiffness * area, curves.low * area, curves.rise * area, curves.way, self._arcs])

    def slack(self) -> np.ndarray:
        return np.zeros(len(self.at))

    @property
    def between(self) -> np.ndarray:
        """(C,4) of `Gauge`."""
        return self._cells.corners

    def _chords(self, positions: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        x00, x10, x11, x01 = picked(positions, self._cells.corners)
        half = 0.5 / self._cells.spacing[:, None]
        return angle_and_lengths(half * (x01 + x11 - x00 - x10), half * (x10 + x11 - x00 - x01))

    def strain(self, positions: np.ndarray) -> np.ndarray:
        bow, crossing = bow_and_crossing(positions, self._cells, self._neighbours)
        return np.asarray(self._chords(positions)[0] + limited(self._arcs * dots(bow, crossing))[0])

    def energy(self, positions: np.ndarray, sliders: np.ndarray) -> float:
        return float(np.sum(shear_energy_at(self._curves, self.strain(positions), sliders) * self._cells.shear_area))

    def rest_stiffness(self) -> np.ndarray:
        """Row sum [N/m] of each corner (4 C,) without friction, at rest, wherever the panels lie."""
        return np.repeat(self._curves.stiffness * self._cells.shear_area * 2.0 / self._cells.spacing**2, 4)


def cell_slots(cells: Cells, slots: LatticeSlots) -> np.ndarray:
    """Slot (C,) of corner 00 of each cell. ValueError where its corners are not four neighbours of the lattice."""
    a, b, c, d = slots.slot[cells.corners].T
    up = slots.step(a, WARP)
    if not ((b == a + 1) & (d == a + up) & (c == d + 1)).all():
        raise ValueError("a cell does not join four neighbours of the lattice")
    return indices(a)


def angle_and_lengths(warp: np.ndarray, weft: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """gamma (N,) and the lengths of warp and weft vectors (N,3), not below SHORTEST."""
    warp_length = np.maximum(lengths(warp), SHORTEST)
    weft_length = np.maximum(lengths(weft), SHORTEST)
    sine = dots(warp, weft) / (warp_length * weft_length)
    return arcsin(np.clip(sine, -1.0, 1.0)), warp_length, weft_length
