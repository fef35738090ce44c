"""The lattice as padded rows: where lattice forces are computed, so that neighbours lie at fixed distances and long loops use wide instructions.

Every panel's lattice fills a rectangle of slots, row after row, with one empty row below and above it. Slot i has its weft neighbour at i + 1 and its warp
neighbour at i + columns. Every slot carries every element (weft link i to i + 1, warp link, cell to the upper right, weft and warp bend line centred at i);
where an element does not exist, as at the end of a row, its coefficients are 0. So loops run on over row breaks. Elements are written once, then each slot
adds up what concerns it, in one fixed order: the same bits on any number of threads.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from garmentcad.arrays import indices
from garmentcad.cloth.cloth import WARP, WEFT, Cloth
from garmentcad.forces.force import NO_PARTICLE

PIECE = 256  # slots: long enough that a loop's beginning and end do not count, short enough that its fields stay in the nearest cache


class Pieces(NamedTuple):
    """The slots in pieces of one panel each, row breaks or not. particle: (S,) int32 of each slot, NO_PARTICLE where it is empty; first, size, columns:
    (K,) int32 first slot and slots of each piece, and columns of its panel."""

    particle: np.ndarray
    first: np.ndarray
    size: np.ndarray
    columns: np.ndarray


class LatticeSlots:
    """Slots of the lattice of `cloth`. slot: (P,) int32 of each particle, -1 for particles that are no lattice particles."""

    def __init__(self, cloth: Cloth) -> None:
        inside = np.flatnonzero(cloth.vertex_place[:, 0] >= 0)
        panel, place = cloth.vertex_panel[inside], cloth.vertex_place[inside]
        pieces: list[tuple[int, int, int]] = []
        slot, end = np.empty(len(inside), dtype=np.int64), 1
        for number in range(len(cloth.panel_names)):
            mine = np.flatnonzero(panel == number)
            if len(mine) == 0:
                continue
            width, height = place[mine].max(axis=0) + 1
            start = end + width + 1  # an empty row, and one slot that the row below may look at
            slot[mine] = start + place[mine, 1] * width + place[mine, 0]
            stop = start + height * width
            pieces += [(begin, min(PIECE, stop - begin), width) for begin in range(start, stop, PIECE)]
            end = stop + width + 1
        self.count = end + 1
        self.slot = np.full(cloth.particle_count, -1, dtype=np.int64)
        particle = cloth.vertex_particle[inside]
        self.slot[particle] = slot
        occupant = np.full(self.count, NO_PARTICLE)
        occupant[slot] = particle
        table = indices(np.array(pieces, dtype=np.int64).reshape(-1, 3))
        self.pieces = Pieces(indices(occupant), *(indices(column) for column in table.T))
        self._columns = np.zeros(self.count, dtype=np.int64)
        for begin, size, width in pieces:
            self._columns[begin : begin + size] = width

    def step(self, slots: np.ndarray, direction: int) -> np.ndarray:
        """Slots from each slot to its next neighbour along WARP or WEFT."""
        return np.ones(len(slots), dtype=np.int64) if direction == WEFT else self._columns[slots]

    def spread(self, slots: np.ndarray, values: np.ndarray) -> np.ndarray:
        """(S,) with the values at their slots and 0 elsewhere."""
        field = np.zeros(self.count)
        field[slots] = values
        return field

    def is_lattice_line(self, center: np.ndarray, arm_a: np.ndarray, arm_b: np.ndarray, direction: np.ndarray) -> np.ndarray:
        """(N,) bool: lines of three particles whose arms are the two neighbours of the centre along `direction` (N,)."""
        found = np.zeros(len(center), dtype=bool)
        for axis in (WARP, WEFT):
            chosen = np.flatnonzero((direction == axis) & (self.slot[center] >= 0))
            at = self.slot[center[chosen]]
            step = self.step(at, axis)
            found[chosen] = (self.slot[arm_a[chosen]] == at - step) & (self.slot[arm_b[chosen]] == at + step)
        return found
