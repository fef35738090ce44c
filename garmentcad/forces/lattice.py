"""All forces inside the lattice of a cloth: stretch, shear, twist and bending, block by block (see rows.py). The equations stand with each law."""

from __future__ import annotations

from typing import Any

import numba
import numpy as np

from garmentcad.arrays import indices, kernel
from garmentcad.cloth.cloth import Cloth
from garmentcad.fabric.material import MaterialTable
from garmentcad.forces.bend import ForceBend, bend_row
from garmentcad.forces.cell import cell_row
from garmentcad.forces.force import NO_PARTICLE
from garmentcad.forces.rows import LANES, LatticeSlots, aligned_zeros
from garmentcad.forces.shear import LawShear
from garmentcad.forces.stretch import COEFFICIENTS, LawStretch, stretch_row
from garmentcad.forces.twist import LawTwist

# Where the coefficients of the elements lie (10,S): of weft and warp links, shear G A [J], twist 4 D66 A/h^4 [N/m], weft and warp lines B w/l [N.m].
_C_WEFT, _C_WARP, _C_SHEAR = 0, COEFFICIENTS, 2 * COEFFICIENTS
_C_TWIST, _C_BEND_WEFT, _C_BEND_WARP = _C_SHEAR + 1, _C_SHEAR + 2, _C_SHEAR + 3
# Where the fields of a block lie in its room (34,R): places and velocities; directions of links, weft or warp; pull and turn of the weft; of the warp; cells.
_MOTION, _LINES, _WEFT, _WARP, _CELL, _ALL = 0, 6, 10, 16, 22, 34


@kernel
def _load(span, particle, positions, velocities, motion):  # type: ignore[no-untyped-def]
    """Places and velocities of the slots into motion (6,R), 0 where a slot is empty; span: first slot, number of slots."""
    first, count = span
    x, y, z, u, v, w = motion[0], motion[1], motion[2], motion[3], motion[4], motion[5]
    for i in range(count):
        p = particle[first + i]
        if p >= 0:
            x[i], y[i], z[i], u[i], v[i], w[i] = positions[p, 0], positions[p, 1], positions[p, 2], velocities[p, 0], velocities[p, 1], velocities[p, 2]
        else:
            x[i] = y[i] = z[i] = u[i] = v[i] = w[i] = 0.0


@kernel
def _sum(span, room, total):  # type: ignore[no-untyped-def]
    """Total of each slot into total (3+,R); span: first slot in the room, slots to the warp neighbour, number of slots."""
    first, up, count = span
    for axis in range(3):
        weft, weft_before = room[_WEFT + axis, first:], room[_WEFT + axis, first - 1 :]
        turn, turn_behind = room[_WEFT + 3 + axis, first:], room[_WEFT + 3 + axis, first + 1 :]
        warp, warp_before = room[_WARP + axis, first:], room[_WARP + axis, first - up :]
        warp_turn, warp_turn_behind = room[_WARP + 3 + axis, first:], room[_WARP + 3 + axis, first + up :]
        # cells in which the slot is corner 00, 10, 11, 01
        c00, c10 = room[_CELL + axis, first:], room[_CELL + 3 + axis, first - 1 :]
        c11, c01 = room[_CELL + 6 + axis, first - up - 1 :], room[_CELL + 9 + axis, first - up :]
        into = total[axis, first:]
        for i in range(np.uint64(count)):
            along_weft = (weft[i] - weft_before[i]) + (turn_behind[i] - turn[i])
            along_warp = (warp[i] - warp_before[i]) + (warp_turn_behind[i] - warp_turn[i])
            into[i] = (along_weft + along_warp) + ((c00[i] + c10[i]) + (c11[i] + c01[i]))


@kernel
def _store(first, count, total, out):  # type: ignore[no-untyped-def]
    """Total (3+,R) of the slots from `first` in the room on into out (3 count,): one row of memory, for wide instructions."""
    x, y, z = total[0, first:], total[1, first:], total[2, first:]
    for i in range(np.uint64(count)):
        k = np.uint64(3) * i
        out[k], out[k + np.uint64(1)], out[k + np.uint64(2)] = x[i], y[i], z[i]


@kernel
def lattice_block(k, blocks, coefficients, setting, positions, velocities, rooms, out):  # type: ignore[no-untyped-def]
    room = rooms[numba.get_thread_id()]
    first, size, up = np.int64(blocks.first[k]), np.int64(blocks.size[k]), np.int64(blocks.columns[k])
    beside = np.int64(1)  # a literal would make the row kernels compile for a type of its own
    h, damping_time = setting
    # slots from here on lie in the room: the lines of the rows below and above need a row more at either end
    origin = (first - 2 * up - LANES) // LANES * LANES
    motion, lines, weft, warp = room[_MOTION:_LINES], room[_LINES:_WEFT], room[_WEFT:_WARP], room[_WARP:_CELL]
    _load((origin, first + size + 2 * up + 1 - origin), blocks.particle, positions, velocities, motion)
    # from the last multiple of LANES before the first element that is needed to the first one behind the last
    begin = (first - 2) // LANES * LANES
    count = (first + size + LANES - begin) // LANES * LANES
    stretch_row((begin - origin, beside, count), origin, coefficients[_C_WEFT:_C_WARP], h, damping_time, motion, lines, weft)
    begin = (first - 1) // LANES * LANES
    count = (first + size + LANES - begin) // LANES * LANES
    bend_row((begin - origin, beside, count), coefficients[_C_BEND_WEFT, begin:], lines, weft, weft[3:])
    begin = (first - 2 * up) // LANES * LANES
    count = (first + size + up - 1 + LANES - begin) // LANES * LANES
    stretch_row((begin - origin, up, count), origin, coefficients[_C_WARP:_C_SHEAR], h, damping_time, motion, lines, warp)
    begin = (first - up) // LANES * LANES
    count = (first + size + up - 1 + LANES - begin) // LANES * LANES
    bend_row((begin - origin, up, count), coefficients[_C_BEND_WARP, begin:], lines, warp, warp[3:])
    begin = (first - up - 1) // LANES * LANES
    count = (first + size - 1 + LANES - begin) // LANES * LANES
    cell_row((begin - origin, up, count), coefficients[_C_SHEAR, begin:], coefficients[_C_TWIST, begin:], h, damping_time, motion, room[_CELL:_ALL])
    begin = first // LANES * LANES
    count = (first + size - 1 + LANES - begin) // LANES * LANES
    _sum((begin - origin, up, count), room, motion)
    _store(first - origin, size, motion, out.reshape(-1)[3 * first :])


@kernel
def write_lattice(blocks, coefficients, setting, rooms, positions, velocities, out):  # type: ignore[no-untyped-def]
    """Force on the particle of each slot into out (S,3); setting: h [m], damping time [s]; rooms (threads,34,R): scratch of each thread."""
    for k in range(len(blocks.first)):
        lattice_block(np.int64(k), blocks, coefficients, setting, positions, velocities, rooms, out)  # a cast, or it compiles for each of two types of k


class ForceLattice:
    """Stretch, shear, twist and bending of the full lattice of `cloth`; lines that end on the contour are not among them (see `contour_lines`).

    laws: those that act. damping_time: tau [s] of stretch and shear.
    """

    name = "lattice"
    LAWS = ("stretch", "shear", "twist", "bend")

    def __init__(self, cloth: Cloth, materials: MaterialTable, laws: tuple[str, ...] = LAWS, damping_time: float = 0.0) -> None:
        slots = LatticeSlots(cloth)
        inner = cloth.bends._replace(**{name: column[_inner(cloth, slots)] for name, column in cloth.bends._asdict().items()})
        stretch, shear, twist, bend = LawStretch(cloth, materials), LawShear(cloth, materials), LawTwist(cloth, materials), ForceBend(inner, materials)
        self.laws = tuple(law for law in (stretch, shear, twist, bend) if law.name in laws)
        self.damping_time = damping_time
        self._blocks, self._spacing = slots.blocks, cloth.spacing
        self._coefficients = aligned_zeros(_C_BEND_WARP + 1, slots.count)
        if stretch in self.laws:
            self._coefficients[_C_WEFT:_C_WARP], self._coefficients[_C_WARP:_C_SHEAR] = stretch.rows(slots)
        if shear in self.laws:
            self._coefficients[_C_SHEAR] = shear.rows(slots)
        if twist in self.laws:
            self._coefficients[_C_TWIST] = twist.rows(slots)
        if bend in self.laws:
            self._coefficients[_C_BEND_WEFT], self._coefficients[_C_BEND_WARP] = bend.rows(slots, inner.direction)
        numba.get_num_threads()  # kernels from the disk cache ask for the number of their thread, which no thread has before numba starts them
        self._rooms = aligned_zeros(numba.config.NUMBA_NUM_THREADS, _ALL, slots.room)  # type: ignore[attr-defined]
        self.corners = slots.blocks.particle

    @property
    def arguments(self) -> tuple[Any, ...]:
        """What `write_lattice` takes before positions, velocities and out."""
        return self._blocks, self._coefficients, (self._spacing, self.damping_time), self._rooms

    def write_forces(self, positions: np.ndarray, velocities: np.ndarray, out: np.ndarray) -> None:
        write_lattice(*self.arguments, positions, velocities, out)

    def energies(self, positions: np.ndarray) -> dict[str, float]:
        return {law.name: law.energy(positions) for law in self.laws}

    def energy(self, positions: np.ndarray) -> float:
        """Stored energy [J] of all its laws."""
        return sum(self.energies(positions).values())

    def write_stiffness(self, positions: np.ndarray, out: np.ndarray) -> None:
        self._gather_stiffness(lambda law, corners: law.write_stiffness(positions, corners), out)

    def write_rest_stiffness(self, out: np.ndarray) -> None:
        """`write_stiffness` of stretch and shear at rest, wherever the panels lie."""

        def at_rest(law: LawStretch | LawShear | LawTwist | ForceBend, corners: np.ndarray) -> None:
            if isinstance(law, LawStretch | LawShear):
                law.write_rest_stiffness(corners)

        self._gather_stiffness(at_rest, out)

    def _gather_stiffness(self, write, out: np.ndarray) -> None:  # type: ignore[no-untyped-def]
        count = int(self.corners.max(initial=0)) + 1
        total = np.zeros(count)
        for law in self.laws:
            corners = np.zeros(len(law.corners))
            write(law, corners)
            used = law.corners != NO_PARTICLE
            total += np.bincount(law.corners[used], weights=corners[used], minlength=count)[:count]
        out[:] = np.where(self.corners == NO_PARTICLE, 0.0, total[self.corners])


def contour_lines(cloth: Cloth, materials: MaterialTable) -> ForceBend:
    """Bending of the lines of `cloth` that end on the contour."""
    outer = ~_inner(cloth, LatticeSlots(cloth))
    return ForceBend(cloth.bends._replace(**{name: column[outer] for name, column in cloth.bends._asdict().items()}), materials)


def _inner(cloth: Cloth, slots: LatticeSlots) -> np.ndarray:
    """(B,) bool: bend lines between lattice neighbours at full spacing."""
    lines = cloth.bends
    whole = (lines.weight_a == 0.0) & (lines.weight_b == 0.0)
    whole &= np.isclose(lines.length_a, cloth.spacing, rtol=1e-9) & np.isclose(lines.length_b, cloth.spacing, rtol=1e-9)
    return whole & slots.is_lattice_line(indices(lines.center), lines.arm_a[:, 0], lines.arm_b[:, 0], lines.direction)
