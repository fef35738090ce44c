"""The lattice as padded rows: where lattice forces are computed, so that neighbours lie at fixed distances and long loops use wide instructions.

Every panel's lattice fills a rectangle of slots, row after row, with an empty slot at the end of each row and empty rows below and above. Slot i has its
weft neighbour at i + 1 and its warp neighbour at i + columns. Every slot carries every element (weft link i to i + 1, warp link, cell to the upper right,
weft and warp bend line centred at i); where an element does not exist, as at the end of a row, its coefficients are 0. So loops run on over row breaks, and
leave out only what lies far from any particle.
Blocks of rows are computed each by itself, elements first, then each slot adds up what concerns it, in one fixed order; elements between two blocks are
computed in both. The blocks depend on the cloth alone: the same bits on any number of threads.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable
from typing import NamedTuple

import numpy as np

from garmentcad.arrays import indices, inlined, inlined_kernel, row_kernel
from garmentcad.cloth.cloth import WARP, WEFT, BendLines, Cloth
from garmentcad.forces.force import NO_PARTICLE

# Slots of a block, about: so few that its fields stay in a near cache, but about so many rows or more that the three which are computed twice at its ends
# hardly count (a square of 160,000 particles, whose blocks were of four rows, takes a quarter less).
BLOCK, BLOCK_ROWS = 1536, 24
PART = 128  # border triangles, contour lines, spans or hinges that are computed together
NEVER = 1e30  # a strain that nothing reaches
LANES = 8  # numbers in the widest registers: loops begin at multiples of it


def padded(count: int) -> int:
    """`count` or a little more: an odd multiple of LANES, so that rows that are read side by side do not compete for the same lines of the nearest cache."""
    return (-(-count // LANES) | 1) * LANES


def aligned_zeros(*shape: int) -> np.ndarray:
    """Array of zeros each of whose rows begins at a multiple of LANES in memory; the last of `shape` must be a multiple of LANES."""
    count = math.prod(shape)
    memory = np.zeros(count + LANES)
    start = -(memory.ctypes.data // memory.itemsize) % LANES
    return memory[start : start + count].reshape(shape)


# The loops over a block, in the order of `Blocks.start`: places and velocities are loaded, links, weft and warp, bend lines and cells are computed, their arcs
# gathered, forces of slots added up; last what is kept of the slots that hold a particle.
LOAD, WEFT_LINKS, WARP_LINKS, LINES, CELLS, ARCS, SUMS, KEPT, _LOOPS = range(9)


class Blocks(NamedTuple):
    """Blocks of whole rows of one panel each. particle: (S,) int32 of each slot, NO_PARTICLE where it is empty; first, size, columns: (K,) int32 first slot
    and slots of each block, and columns of its panel. Three rows and a few slots more, at either end of a block, are slots too.

    runs (N,2) int32: first slot, and first behind the last one, of each loop over each block: loop j of block k goes over runs start[k, j] to
    start[k, j + 1] - 1. What they leave out nothing reads that counts. Those of KEPT hold particles with successive numbers, all others begin and end at
    multiples of LANES."""

    particle: np.ndarray
    first: np.ndarray
    size: np.ndarray
    columns: np.ndarray
    runs: np.ndarray
    start: np.ndarray


class LatticeSlots:
    """Slots of the lattice of `cloth`. slot: (P,) int32 of each particle, -1 for particles that are no lattice particles."""

    def __init__(self, cloth: Cloth) -> None:
        inside = np.flatnonzero(cloth.vertex_place[:, 0] >= 0)
        panel, place = cloth.vertex_panel[inside], cloth.vertex_place[inside]
        table: list[tuple[int, int, int]] = []
        slot, end = np.empty(len(inside), dtype=np.int64), 0
        for number in range(len(cloth.panel_names)):
            mine = np.flatnonzero(panel == number)
            if len(mine) == 0:
                continue
            width, height = place[mine].max(axis=0) + np.array([2, 1])  # an empty slot ends each row: neighbours across it are none
            start = max(end + 2 * width + 1, 3 * width + 2 * LANES)
            slot[mine] = start + place[mine, 1] * width + place[mine, 0]
            pairs = round(0.5 * width * height / max(BLOCK, BLOCK_ROWS * width))  # an even number: two threads share a panel
            rows = np.linspace(0, height, min(max(1, 2 * pairs), height) + 1).astype(np.int64)
            held = np.bincount(place[mine, 1], minlength=height)
            table += [(start + a * width, (b - a) * width, width) for a, b in itertools.pairwise(rows) if held[a:b].any()]
            end = start + height * width + width + 1
        widest = max((width for _, _, width in table), default=0)
        self.count = padded(end + 2 * widest + 2 * LANES)
        self.slot = np.full(cloth.particle_count, -1, dtype=np.int64)
        particle = cloth.vertex_particle[inside]
        self.slot[particle] = slot
        occupant = np.full(self.count, NO_PARTICLE)
        occupant[slot] = particle
        blocks = np.array(table, dtype=np.int64).reshape(-1, 3)
        of_loops = [runs for block in blocks for runs in _runs_of_loops(occupant, *block)]
        start = np.cumsum([0, *map(len, of_loops)])
        start = np.column_stack([start[:-1].reshape(-1, _LOOPS), start[_LOOPS::_LOOPS]])
        runs = np.vstack([np.zeros((0, 2), dtype=np.int64), *of_loops])
        self.blocks = Blocks(indices(occupant), indices(blocks[:, 0]), indices(blocks[:, 1]), indices(blocks[:, 2]), indices(runs), indices(start))
        self.room = padded(max((size + 6 * width for _, size, width in table), default=0) + 5 * LANES)
        self._columns = np.zeros(self.count, dtype=np.int64)
        for begin, size, width in table:
            self._columns[begin : begin + size] = width

    def step(self, slots: np.ndarray, direction: int) -> np.ndarray:
        """Slots from each slot to its next neighbour along WARP or WEFT."""
        return np.ones(len(slots), dtype=np.int64) if direction == WEFT else self._columns[slots]

    def across(self, center: np.ndarray, direction: np.ndarray) -> np.ndarray:
        """(N,2) particles before and behind each centre across a line along `direction` (N,), the centre in place of one that is missing; so ordered that
        line x across points to the right side of the fabric."""
        at = self.slot[center]
        found = np.empty((len(center), 2), dtype=np.int64)
        for axis, other, sides in ((WEFT, WARP, (-1, 1)), (WARP, WEFT, (1, -1))):
            mine = direction == axis
            step = self.step(at[mine], other)
            for k, side in enumerate(sides):
                there = self.blocks.particle[at[mine] + side * step]
                found[mine, k] = np.where(there == NO_PARTICLE, center[mine], there)
        return found

    def whole_lines(self, lines: BendLines) -> np.ndarray:
        """(B,) bool: lines whose arms are the two neighbours of the centre in the lattice."""
        center, found = lines.center, np.zeros(len(lines.center), dtype=bool)
        for axis in (WARP, WEFT):
            chosen = np.flatnonzero((lines.direction == axis) & (self.slot[center] >= 0) & (lines.weight_a == 0.0) & (lines.weight_b == 0.0))
            at = self.slot[center[chosen]]
            step = self.step(at, axis)
            found[chosen] = (self.slot[lines.arm_a[chosen, 0]] == at - step) & (self.slot[lines.arm_b[chosen, 0]] == at + step)
        return found


def _runs_of_loops(particle: np.ndarray, first: int, size: int, up: int) -> list[np.ndarray]:
    """Runs (N,2) of each loop over a block: what the slots of its particles add up, what that is made of, and so on. particle (S,): of each slot."""
    # the slots that lie in the room, and a few more at its end
    low, high = (first - 3 * up - LANES) // LANES * LANES, -(-(first + size + 3 * up + LANES) // LANES) * LANES
    own = np.zeros(high - low, dtype=bool)
    own[first - low : first - low + size] = particle[first : first + size] != NO_PARTICLE
    cross = (0, 1, -1, up, -up)
    lines = arcs = _reached(own, cross)
    cells = _reached(arcs, (0, -1, -up, -up - 1))
    load = _reached(cells, [column + row * up for column in (-1, 0, 1, 2) for row in (-1, 0, 1, 2)])
    loops = [load, _reached(lines, (0, -1)), _reached(lines, (0, -up)), lines, cells, arcs, own]
    in_registers = [np.asarray(loop.reshape(-1, LANES).any(axis=1)) for loop in loops]
    breaks = np.flatnonzero(own[1:] & own[:-1] & (np.diff(particle[low:high]) != 1)) + 1
    kept = np.sort(np.concatenate([_runs(own).ravel(), breaks, breaks])).reshape(-1, 2)
    return [low + runs for runs in (*(LANES * _runs(wanted) for wanted in in_registers), kept)]


def _reached(wanted: np.ndarray, steps: Iterable[int]) -> np.ndarray:
    """(N,) bool: what lies so many steps from something wanted (N,)."""
    found, places = np.zeros_like(wanted), np.flatnonzero(wanted)
    for step in steps:
        found[places + step] = True
    return found


def _runs(wanted: np.ndarray) -> np.ndarray:
    """First place, and first behind the last one, (N,2) of runs of what is wanted (N,) bool."""
    return np.flatnonzero(np.diff(wanted, prepend=False, append=False)).reshape(-1, 2)


@inlined
def runs_of(blocks, k, loop):  # type: ignore[no-untyped-def]
    """Runs (N,2) of a loop over block k."""
    return blocks.runs[blocks.start[k, loop] : blocks.start[k, loop + 1]]


@inlined_kernel
def ends(runs, run):  # type: ignore[no-untyped-def]
    """Of a run the first slot, and the first behind the last one, counted from the first of all."""
    return np.uint64(runs[run, 0] - runs[0, 0]), np.uint64(runs[run, 1] - runs[0, 0])


@row_kernel
def load_motion(runs, origin, particle, positions, velocities, motion):  # type: ignore[no-untyped-def]
    """Places and velocities of slots and 1 into motion (7,R), 0 where a slot is empty; runs: of slots (`Blocks.runs`); origin: slot at which the room
    begins."""
    x, y, z, u, v, w, present = motion[0], motion[1], motion[2], motion[3], motion[4], motion[5], motion[6]
    for run in range(len(runs)):
        for i in range(runs[run, 0] - origin, runs[run, 1] - origin):
            p = particle[origin + i]
            if p >= 0:
                x[i], y[i], z[i], u[i], v[i], w[i] = positions[p, 0], positions[p, 1], positions[p, 2], velocities[p, 0], velocities[p, 1], velocities[p, 2]
                present[i] = 1.0
            else:
                x[i] = y[i] = z[i] = u[i] = v[i] = w[i] = present[i] = 0.0
