"""All forces inside the lattice of a cloth: stretch, shear, twist and bending, block by block (see rows.py). The equations stand with each law."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numba
import numpy as np
from numba import prange

from garmentcad.arrays import entry, floats, indices, kernel, long_kernel, parallel_kernel, row_kernel
from garmentcad.cloth.cloth import WEFT, BendLines, Cells, Cloth, Links
from garmentcad.fabric.material import MaterialTable
from garmentcad.forces import rows
from garmentcad.forces.arcs import cell_neighbours, gather_corners
from garmentcad.forces.bend import ForceBend, across_lines, bend_row
from garmentcad.forces.cell import cell_row
from garmentcad.forces.force import NO_PARTICLE, Gauge
from garmentcad.forces.lattice_bound import bound_block
from garmentcad.forces.rows import LANES, NEVER, LatticeSlots, aligned_zeros, ends, load_motion, runs_of
from garmentcad.forces.shear import LawShear
from garmentcad.forces.stretch import COEFFICIENTS, LawStretch, stretch_row
from garmentcad.forces.twist import LawTwist

# Where the coefficients of the elements lie (19,S): of weft and of warp links, of cells (shear, twist), of weft and of warp lines. See `write_rows` of each
# law.
_C_WEFT, _C_WARP, _C_CELL, _C_BEND, _C_ALL = 0, COEFFICIENTS, 2 * COEFFICIENTS, 2 * COEFFICIENTS + 7, 2 * COEFFICIENTS + 11
_WAYS = [2, COEFFICIENTS + 2, _C_CELL + 3, _C_CELL + 6, _C_BEND + 1, _C_BEND + 3]  # em and d: so large that what is no element never moves its slider
# Where the sliders lie (6,S): of weft and of warp links, shear, twist, weft and warp lines, in the order of force.CURVES.
_S_WEFT, _S_WARP, _S_CELL, _S_BEND, SLIDERS = 0, 1, 2, 4, 6
# Where the fields of a block lie in its room (41,R): places, velocities (in their place later what neighbours of cells bear) and presence; directions of
# links, weft and warp, in their place later cells; pull and turn of the weft, of the warp; sliders after; energy lost.
_MOTION, _LINES, _WEFT, _WARP, _AFTER, _LOST, _ALL = 0, 7, 22, 28, 34, 40, 41
_ARCS = 3
_CELL = _LINES
PART_OF_LAW = 1 << 14  # elements whose strains and energies are found together, so that this takes little memory
_SUMS = 8  # partial sums of what a block loses, so that the additions need not wait for each other


@row_kernel
def _sum(span, origin, room, total):  # type: ignore[no-untyped-def]
    """Total of each slot into total (3+,R); span: runs of slots (`Blocks.runs`), slots to the warp neighbour; origin: slot at which the room begins."""
    runs, up = span
    first = runs[0, 0] - origin
    for axis in range(3):
        weft, weft_before = room[_WEFT + axis, first:], room[_WEFT + axis, first - 1 :]
        turn, turn_behind = room[_WEFT + 3 + axis, first:], room[_WEFT + 3 + axis, first + 1 :]
        warp, warp_before = room[_WARP + axis, first:], room[_WARP + axis, first - up :]
        warp_turn, warp_turn_behind = room[_WARP + 3 + axis, first:], room[_WARP + 3 + axis, first + up :]
        # cells in which the slot is corner 00, 10, 11, 01
        c00, c10 = room[_CELL + axis, first:], room[_CELL + 3 + axis, first - 1 :]
        c11, c01 = room[_CELL + 6 + axis, first - up - 1 :], room[_CELL + 9 + axis, first - up :]
        # sums of the arcs over the cells around the slot and its neighbours
        arcs, east, west = room[_ARCS + axis, first:], room[_ARCS + axis, first + 1 :], room[_ARCS + axis, first - 1 :]
        north, south = room[_ARCS + axis, first + up :], room[_ARCS + axis, first - up :]
        into = total[axis, first:]
        for run in range(len(runs)):
            begin, end = ends(runs, run)
            for i in range(begin, end):
                around = ((east[i] + west[i]) + (north[i] + south[i])) - 4.0 * arcs[i]
                along_weft = (weft[i] - weft_before[i]) + (turn_behind[i] - turn[i])
                along_warp = (warp[i] - warp_before[i]) + (warp_turn_behind[i] - warp_turn[i])
                into[i] = (along_weft + along_warp) + (((c00[i] + c10[i]) + (c11[i] + c01[i])) - around)


@row_kernel
def _store(first, count, total, out):  # type: ignore[no-untyped-def]
    """Total (3+,R) of the slots from `first` in the room on into out (3 count,): one row of memory, for wide instructions."""
    x, y, z = total[0, first:], total[1, first:], total[2, first:]
    for i in range(np.uint64(count)):
        k = np.uint64(3) * i
        out[k], out[k + np.uint64(1)], out[k + np.uint64(2)] = x[i], y[i], z[i]


@row_kernel
def _keep(first, count, after, sliders):  # type: ignore[no-untyped-def]
    """Sliders (6,R) of the slots from `first` in the room on into those (6,count) of the cloth."""
    for row in range(SLIDERS):
        one, into = after[row, first:], sliders[row]
        for i in range(np.uint64(count)):
            into[i] = one[i]


@kernel
def _total(first, count, lost):  # type: ignore[no-untyped-def]
    """Sum of `count` numbers of lost (R,) from `first` on, in one fixed order."""
    whole = count // _SUMS * _SUMS
    a = b = c = d = e = f = g = h = 0.0
    for i in range(first, first + whole, _SUMS):
        a, b, c, d = a + lost[i], b + lost[i + 1], c + lost[i + 2], d + lost[i + 3]
        e, f, g, h = e + lost[i + 4], f + lost[i + 5], g + lost[i + 6], h + lost[i + 7]
    for i in range(first + whole, first + count):
        a += lost[i]
    return ((a + b) + (c + d)) + ((e + f) + (g + h))


@long_kernel
def lattice_block(k, blocks, fabric, setting, positions, velocities, rooms, out):  # type: ignore[no-untyped-def]
    """One block; fabric: coefficients (19,S), sliders (6,S); out (P,3). Returns the energy lost [J].

    It reads sliders of the rows around it, which another thread may be moving: a slider that was moved for these positions is not moved again, so that it does
    not matter. What the runs of a loop leave out holds in the room what another block or step left there; so it does in the few slots that they go over
    besides."""
    coefficients, sliders = fabric
    room = rooms[numba.get_thread_id()]
    first, up = np.int64(blocks.first[k]), np.int64(blocks.columns[k])
    # slots from here on lie in the room: the cells two rows below and one above need a row more at either end
    origin = (first - 3 * up - LANES) // LANES * LANES
    motion, lines, pull, after, lost = room[_MOTION:_LINES], room[_LINES:_WEFT], room[_WEFT:_AFTER], room[_AFTER:_LOST], room[_LOST]
    lost[:] = 0.0
    load_motion(runs_of(blocks, k, rows.LOAD), origin, blocks.particle, positions, velocities, motion)
    held = sliders[_S_WEFT], after[_S_WEFT], lost
    stretch_row((runs_of(blocks, k, rows.WEFT_LINKS), 1), origin, coefficients[_C_WEFT:_C_WARP], setting, motion, lines, pull, held)
    held = sliders[_S_WARP], after[_S_WARP], lost
    stretch_row((runs_of(blocks, k, rows.WARP_LINKS), up), origin, coefficients[_C_WARP:_C_CELL], setting, motion, lines[4:], pull[6:], held)
    bends = sliders[_S_BEND:], after[_S_BEND:], lost
    bend_row((runs_of(blocks, k, rows.LINES), up), origin, coefficients[_C_BEND:], setting[0], motion, lines, pull, bends)
    span = runs_of(blocks, k, rows.CELLS), up
    corners = room[_CELL : _CELL + 3], room[_CELL + 3 : _CELL + 6], room[_CELL + 6 : _CELL + 9], room[_CELL + 9 : _CELL + 12], room[_CELL + 12 : _WEFT]
    cell_row(span, origin, coefficients[_C_CELL:], setting, motion, *corners, sliders[_S_CELL:], after[_S_CELL:], lost)
    gather_corners((runs_of(blocks, k, rows.ARCS), up), origin, room[_CELL + 12 : _WEFT], motion[_ARCS:])
    _sum((runs_of(blocks, k, rows.SUMS), up), origin, room, motion)
    kept, total = runs_of(blocks, k, rows.KEPT), 0.0
    for r in range(len(kept)):
        begin, count = np.int64(kept[r, 0]), np.int64(kept[r, 1] - kept[r, 0])
        _store(begin - origin, count, motion, out.reshape(-1)[3 * np.int64(blocks.particle[begin]) :])
        _keep(begin - origin, count, after, sliders[:, begin:])
        total += _total(begin - origin, count, lost)
    return total


@entry
@parallel_kernel
def write_lattice(blocks, coefficients, setting, rooms, sliders, positions, velocities, out):  # type: ignore[no-untyped-def]
    """Force on each particle of the lattice into out (P,3); setting: h [m], damping time [s]; rooms (threads,41,R): scratch of each thread."""
    for k in prange(len(blocks.first)):
        lattice_block(np.int64(k), blocks, (coefficients, sliders), setting, positions, velocities, rooms, out)


_Law = LawStretch | LawShear | LawTwist | ForceBend


@entry
@parallel_kernel
def write_bounds(blocks, coefficients, spacing, whole, positions, rooms, out):  # type: ignore[no-untyped-def]
    """Row sum bound [N/m] of each particle of the lattice into out (P,); whole: of all laws, not only of twist and bending."""
    for k in prange(len(blocks.first)):
        bound_block(
            np.int64(k), blocks, coefficients[:_C_CELL], coefficients[_C_CELL:_C_BEND], coefficients[_C_BEND:_C_ALL], spacing, whole, positions, rooms, out
        )  # fmt: skip


class ForceLattice:
    """Stretch, shear, twist and bending of the full lattice of `cloth`; lines that end on the contour are not among them (see `contour_lines`).

    laws: those that act. damping_time: tau [s] of stretch and shear. arcs: whether shear is measured with them.
    """

    name = "lattice"
    LAWS = ("stretch", "shear", "twist", "bend")

    def __init__(self, cloth: Cloth, materials: MaterialTable, laws: tuple[str, ...] = LAWS, damping_time: float = 0.0, arcs: bool = True) -> None:
        slots = LatticeSlots(cloth)
        count, inner = slots.count, np.flatnonzero(_inner(cloth, slots))
        neighbours = cell_neighbours(cloth, slots) if arcs else None
        self.laws: list[_Law] = []
        self._places: list[np.ndarray] = []  # of the sliders of each law among all
        for part in _parts(len(cloth.links.ends)):
            stretch = LawStretch(Links(*(column[part] for column in cloth.links)), materials, slots)
            self._act(laws, stretch, stretch.at)
        for part in _parts(len(cloth.cells.corners)):
            cells = Cells(*(column[part] for column in cloth.cells))
            shear, twist = LawShear(cells, None if neighbours is None else neighbours[part], materials, slots), LawTwist(cells, materials, slots)
            self._act(laws, shear, _S_CELL * count + shear.at)
            self._act(laws, twist, (_S_CELL + 1) * count + twist.at)
        for part in _parts(len(inner)):
            lines = BendLines(*(column[inner[part]] for column in cloth.bends))
            bend = ForceBend(lines, slots.across(lines.center, lines.direction), materials)
            self._act(laws, bend, np.where(lines.direction == WEFT, _S_BEND, _S_BEND + 1) * count + slots.slot[lines.center])
        self.damping_time = damping_time
        self._blocks, self._spacing, self._slots = slots.blocks, cloth.spacing, count
        self._coefficients = aligned_zeros(_C_ALL, count)
        self._coefficients[_WAYS] = NEVER
        self._write_plane()
        for law in self.laws:
            if isinstance(law, LawTwist):
                law.write_rows(self._coefficients[_C_CELL + 5 : _C_BEND])
            elif isinstance(law, ForceBend):
                law.write_rows(slots, self._coefficients[_C_BEND:])
        numba.get_num_threads()  # starts the threads: before that a thread has no number by which it finds its room
        self._rooms = aligned_zeros(numba.config.NUMBA_NUM_THREADS, _ALL, slots.room)  # type: ignore[attr-defined]
        held = slots.slot >= 0
        # What it writes stands where a particle has its number: the stepper need not gather what nothing else adds to.
        self.corners = indices(np.where(held, np.arange(len(held)), NO_PARTICLE))

    def _act(self, laws: tuple[str, ...], law: _Law, places: np.ndarray) -> None:
        if law.name in laws:
            self.laws.append(law)
            self._places.append(indices(places))

    def set_plane(self, materials: MaterialTable) -> None:
        """From now on tension and shear are those of other materials; what strains mean, and where friction gives way, must be the same."""
        for law in self.laws:
            if isinstance(law, LawStretch | LawShear):
                law.set_curves(materials)
        self._write_plane()

    def _write_plane(self) -> None:
        for law in self.laws:
            if isinstance(law, LawStretch):
                law.write_rows(self._coefficients[:_C_CELL])
            elif isinstance(law, LawShear):
                law.write_rows(self._coefficients[_C_CELL : _C_CELL + 5])

    @property
    def arguments(self) -> tuple[Any, ...]:
        """What `write_lattice` takes before sliders, positions, velocities and out."""
        return self._blocks, self._coefficients, (self._spacing, self.damping_time), self._rooms

    def slack(self) -> np.ndarray:
        return self._spread(lambda law: law.slack())

    def gauge(self, positions: np.ndarray) -> Gauge:
        particle, middle = (np.full((SLIDERS, self._slots, *more), NO_PARTICLE, dtype=np.int32) for more in ((), (4,)))
        curve = np.broadcast_to(np.arange(SLIDERS)[:, None], particle.shape)
        for law, places in zip(self.laws, self._places):
            particle.reshape(-1)[places] = self._blocks.particle[places % self._slots]
            middle.reshape(-1, 4)[places] = law.between
        return Gauge(self._spread(lambda law: law.strain(positions)), self._spread(lambda law: law.way), curve, particle, middle)

    def drawn(self, positions: np.ndarray, share: float) -> np.ndarray:
        return self._spread(lambda law: law.strain(positions) - share * law.way)

    def _spread(self, of_law: Callable[[_Law], np.ndarray]) -> np.ndarray:
        found = aligned_zeros(SLIDERS, self._slots)
        for law, places in zip(self.laws, self._places):
            found.reshape(-1)[places] = of_law(law)
        return found

    def write_forces(self, positions: np.ndarray, velocities: np.ndarray, out: np.ndarray, sliders: np.ndarray | None = None) -> None:
        write_lattice(*self.arguments, self.slack() if sliders is None else sliders, positions, velocities, out)

    def energies(self, positions: np.ndarray, sliders: np.ndarray | None = None) -> dict[str, float]:
        held = (self.slack() if sliders is None else sliders).reshape(-1)
        total: dict[str, float] = {}
        for law, places in zip(self.laws, self._places):
            total[law.name] = total.get(law.name, 0.0) + law.energy(positions, held[places])
        return total

    def energy(self, positions: np.ndarray, sliders: np.ndarray | None = None) -> float:
        """Stored energy [J] of all its laws."""
        return sum(self.energies(positions, sliders).values())

    def write_stiffness(self, positions: np.ndarray, out: np.ndarray) -> None:
        write_bounds(self._blocks, self._coefficients, self._spacing, True, floats(positions), self._rooms, out)

    def write_stiffness_across(self, positions: np.ndarray, out: np.ndarray) -> None:
        write_bounds(self._blocks, self._coefficients, self._spacing, False, floats(positions), self._rooms, out)

    def write_rest_stiffness(self, out: np.ndarray) -> None:
        """Row sums of stretch and shear without friction, at rest, wherever the panels lie."""
        total = np.zeros(len(self.corners))
        for law in self.laws:
            if isinstance(law, LawStretch | LawShear):
                # A part of a law touches few of the particles: sums over all of them, part by part, would grow with their square.
                low = int(law.corners.min(initial=len(total)))
                part = np.bincount(law.corners - low, weights=law.rest_stiffness())
                total[low : low + len(part)] += part
        out[:] = total


def _parts(count: int) -> list[slice]:
    """`count` elements in parts of at most PART_OF_LAW, one at least."""
    return [slice(first, min(first + PART_OF_LAW, count)) for first in range(0, max(count, 1), PART_OF_LAW)]


def contour_lines(cloth: Cloth, materials: MaterialTable) -> ForceBend:
    """Bending of the lines of `cloth` that are not in its lattice: they end on the contour, or find a normal only there."""
    outer = ~_inner(cloth, LatticeSlots(cloth))
    lines = cloth.bends._replace(**{name: column[outer] for name, column in cloth.bends._asdict().items()})
    return ForceBend(lines, across_lines(cloth.bends)[outer], materials)


def _inner(cloth: Cloth, slots: LatticeSlots) -> np.ndarray:
    """(B,) bool: bend lines between lattice neighbours at full spacing, whose centres have a neighbour across them too: a normal."""
    lines = cloth.bends
    whole = slots.whole_lines(lines)
    whole &= np.isclose(lines.length_a, cloth.spacing, rtol=1e-9) & np.isclose(lines.length_b, cloth.spacing, rtol=1e-9)
    inner = np.flatnonzero(whole)
    whole[inner] = (slots.across(lines.center[inner], lines.direction[inner]) != lines.center[inner, None]).any(axis=1)
    return whole
