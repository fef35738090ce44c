"""All forces inside the lattice of a cloth: stretch, shear, twist and bending, row by row (see rows.py). The equations stand with each law."""

from __future__ import annotations

import numpy as np
from numba import prange

from garmentcad.arrays import CHUNKS, chunk_range, indices, kernel, parallel_kernel
from garmentcad.cloth.cloth import Cloth
from garmentcad.fabric.material import MaterialTable
from garmentcad.forces.bend import SHORTEST, ForceBend, bend_row
from garmentcad.forces.force import NO_PARTICLE
from garmentcad.forces.rows import PIECE, LatticeSlots
from garmentcad.forces.shear import LawShear, shear_row
from garmentcad.forces.stretch import COEFFICIENTS, LawStretch, stretch_row
from garmentcad.forces.twist import LEAST_NORMAL, LawTwist, twist_row

# Where the elements' forces lie in the scratch array (27,S).
_WEFT, _WARP, _CELL, _BEND_WEFT, _BEND_WARP, _ALL = 0, 3, 6, 15, 21, 27
# Where their coefficients lie (14,S): of weft and warp links, shear G A [J], twist 4 D66 A/h^4 [N/m], weft and warp lines B w/l [N.m].
_C_WEFT, _C_WARP, _C_SHEAR = 0, COEFFICIENTS, 2 * COEFFICIENTS
_C_TWIST, _C_BEND_WEFT, _C_BEND_WARP = _C_SHEAR + 1, _C_SHEAR + 2, _C_SHEAR + 3


@kernel
def _load(chunk, pieces, positions, velocities, motion):  # type: ignore[no-untyped-def]
    first, last = chunk_range(chunk, len(pieces.particle))
    for slot in range(first, last):
        p = pieces.particle[slot]
        if p >= 0:
            for axis in range(3):
                motion[axis, slot], motion[3 + axis, slot] = positions[p, axis], velocities[p, axis]


@kernel
def _subtract(fields, span, out):  # type: ignore[no-untyped-def]
    """out (3,C) = fields (3,S) from the second slot on minus those from the first slot on; span: first, second, count."""
    first, second, count = span
    for axis in range(3):
        a, b, difference = fields[axis, first:], fields[axis, second:], out[axis]
        for i in range(np.uint64(count)):
            difference[i] = b[i] - a[i]


@kernel
def _cells(span, coefficients, setting, motion, room, out):  # type: ignore[no-untyped-def]
    """Shear and twist of the cells whose corners 00 are in the piece; span: first slot, columns, number of slots; room: (12,C), (3,C) and (9,C)."""
    first, columns, count = span
    h, damping_time = setting
    diagonals, crossing, forces = room
    positions, velocities = motion[:3], motion[3:]
    for k, fields in enumerate((positions, velocities)):
        _subtract(fields, (first, first + columns + 1, count), diagonals[6 * k : 6 * k + 3])
        _subtract(fields, (first + 1, first + columns, count), diagonals[6 * k + 3 : 6 * k + 6])
    for axis in range(3):
        a, b, c, d = positions[axis, first:], positions[axis, first + 1 :], positions[axis, first + columns + 1 :], positions[axis, first + columns :]
        into = crossing[axis]
        for i in range(np.uint64(count)):
            into[i] = (a[i] - b[i]) + (c[i] - d[i])
    shear_row(count, coefficients[_C_SHEAR, first:], 0.5 / h, damping_time, diagonals, forces[3:])
    twist_row(count, coefficients[_C_TWIST, first:], LEAST_NORMAL * 2.0 * h * h, diagonals, crossing, forces)
    for k in range(9):
        into, source = out[k, first:], forces[k]
        for i in range(np.uint64(count)):
            into[i] = source[i]


@kernel
def _elements_of(chunk, pieces, coefficients, setting, motion, scratch):  # type: ignore[no-untyped-def]
    h, damping_time = setting
    least_square = (SHORTEST * h) ** 2
    room = (np.empty((12, PIECE)), np.empty((3, PIECE)), np.empty((9, PIECE)))
    beside = np.int64(1)  # a literal would make the row kernels compile for a type of its own
    begin, end = chunk_range(chunk, len(pieces.first))
    for k in range(begin, end):
        first, count, columns = np.int64(pieces.first[k]), np.int64(pieces.size[k]), np.int64(pieces.columns[k])
        stretch_row((first, beside, count), coefficients[_C_WEFT:_C_WARP], 1.0 / h, damping_time, motion, scratch[_WEFT:_WARP])
        stretch_row((first, columns, count), coefficients[_C_WARP:_C_SHEAR], 1.0 / h, damping_time, motion, scratch[_WARP:_CELL])
        _cells((first, columns, count), coefficients, setting, motion, room, scratch[_CELL:_BEND_WEFT])
        bend_row((first, beside, count), coefficients[_C_BEND_WEFT], least_square, motion, scratch[_BEND_WEFT:_BEND_WARP])
        bend_row((first, columns, count), coefficients[_C_BEND_WARP], least_square, motion, scratch[_BEND_WARP:_ALL])


@kernel
def _sums_of(chunk, pieces, scratch, out):  # type: ignore[no-untyped-def]
    total = np.empty((3, PIECE))
    begin, end = chunk_range(chunk, len(pieces.first))
    for k in range(begin, end):
        i0, count, up = np.int64(pieces.first[k]), np.int64(pieces.size[k]), np.int64(pieces.columns[k])
        for axis in range(3):
            weft, weft_before = scratch[_WEFT + axis, i0:], scratch[_WEFT + axis, i0 - 1 :]
            warp, warp_before = scratch[_WARP + axis, i0:], scratch[_WARP + axis, i0 - up :]
            # cells in which the slot is corner 00, 10, 11, 01
            n00, p00 = scratch[_CELL + axis, i0:], scratch[_CELL + 3 + axis, i0:]
            n10, q10 = scratch[_CELL + axis, i0 - 1 :], scratch[_CELL + 6 + axis, i0 - 1 :]
            n11, p11 = scratch[_CELL + axis, i0 - up - 1 :], scratch[_CELL + 3 + axis, i0 - up - 1 :]
            n01, q01 = scratch[_CELL + axis, i0 - up :], scratch[_CELL + 6 + axis, i0 - up :]
            a0, b0 = scratch[_BEND_WEFT + axis, i0:], scratch[_BEND_WEFT + 3 + axis, i0:]
            a1, b1 = scratch[_BEND_WEFT + axis, i0 + 1 :], scratch[_BEND_WEFT + 3 + axis, i0 - 1 :]
            c0, d0 = scratch[_BEND_WARP + axis, i0:], scratch[_BEND_WARP + 3 + axis, i0:]
            c1, d1 = scratch[_BEND_WARP + axis, i0 + up :], scratch[_BEND_WARP + 3 + axis, i0 - up :]
            into = total[axis]
            for i in range(np.uint64(count)):
                links = (weft[i] - weft_before[i]) + (warp[i] - warp_before[i])
                cells = ((n00[i] + p00[i]) - (n10[i] - q10[i])) + ((n11[i] - p11[i]) - (n01[i] + q01[i]))
                lines = ((a1[i] - b1[i]) + (b0[i] - a0[i])) + ((c1[i] - d1[i]) + (d0[i] - c0[i]))
                into[i] = (links + cells) + lines
        for i in range(count):
            out[i0 + i, 0], out[i0 + i, 1], out[i0 + i, 2] = total[0, i], total[1, i], total[2, i]


@parallel_kernel
def write_lattice(pieces, coefficients, setting, positions, velocities, room, out):  # type: ignore[no-untyped-def]
    """Force on the particle of each slot into out (S,3); setting: h [m], damping time [s]; room: motion (6,S) and scratch (27,S), which are 0 in empty
    slots."""
    motion, scratch = room
    for chunk in prange(CHUNKS):
        _load(chunk, pieces, positions, velocities, motion)
    for chunk in prange(CHUNKS):
        _elements_of(chunk, pieces, coefficients, setting, motion, scratch)
    for chunk in prange(CHUNKS):
        _sums_of(chunk, pieces, scratch, out)


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
        self._pieces, self._spacing = slots.pieces, cloth.spacing
        self._coefficients = np.zeros((_C_BEND_WARP + 1, slots.count))
        if stretch in self.laws:
            self._coefficients[_C_WEFT:_C_WARP], self._coefficients[_C_WARP:_C_SHEAR] = stretch.rows(slots)
        if shear in self.laws:
            self._coefficients[_C_SHEAR] = shear.rows(slots)
        if twist in self.laws:
            self._coefficients[_C_TWIST] = twist.rows(slots)
        if bend in self.laws:
            self._coefficients[_C_BEND_WEFT], self._coefficients[_C_BEND_WARP] = bend.rows(slots, inner.direction)
        self._room = (np.zeros((6, slots.count)), np.zeros((_ALL, slots.count)))
        self.corners = slots.pieces.particle

    def write_forces(self, positions: np.ndarray, velocities: np.ndarray, out: np.ndarray) -> None:
        write_lattice(self._pieces, self._coefficients, (self._spacing, self.damping_time), positions, velocities, self._room, out)

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
