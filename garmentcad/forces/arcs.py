"""Shear measured with arcs: what bending adds to the angle between the mean warp and weft of a cell, which are chords.

On a surface that is bent and not strained, x_uu, x_vv and x_uv are all along the normal, and the chords of a cell of spacing h lean against each other by

    u.w = -(h^2/6) (x_uu + x_vv).x_uv = -(h k)^2 c s/6      on a cylinder of curvature k, warp and weft at c = cos, s = sin against the way round

The links are chords, too: they let the cloth lie on the cylinder as if its yarns were longer by (h k c^2)^2/24 and (h k s^2)^2/24. Such cloth stays as wide
along the axis as it was, wherever folds begin and end, if warp and weft turn toward each other by (h k)^2 c s/24. What is left is to be no shear:

    gamma = asin(u.w/(|u| |w|)) + a/(1 + (a/MOST)^4)^(1/4),    a = (h^2/8) (x_uu + x_vv).x_uv      [rad]

with both derivatives from the lattice: h^2 (x_uu + x_vv) = sum/4, sum that of the eight neighbours around the cell minus twice its four corners, and
h^2 x_uv = x00 - x10 - x01 + x11. So angles vanish on cylinders in any direction but for a part that falls with (h k)^4. No cylinder has a beyond MOST;
cloth that is crumpled from cell to cell has, where it means nothing. A cell that lacks one of the eight neighbours, at a contour or a fold, has chords alone.
"""

from __future__ import annotations

import numpy as np

from garmentcad.arrays import kernel, row_kernel
from garmentcad.cloth.cloth import WARP, Cells, Cloth
from garmentcad.forces.force import NO_PARTICLE
from garmentcad.forces.rows import LatticeSlots, ends
from garmentcad.geometry.vectors import picked

NEIGHBOURS = 8  # of a cell along its rows and columns
SHARE = 1.0 / 32.0  # of sum.(h^2 x_uv)/h^2
MOST = 0.125  # rad; at 45 degrees and h k = 1.6 a is 0.109, and links reach no farther round


def cell_neighbours(cloth: Cloth, slots: LatticeSlots) -> np.ndarray:
    """(C,8) int32 particles around each cell of `cloth` that its corners are linked to, NO_PARTICLE eight times where one is missing."""
    whole = slots.whole_lines(cloth.bends)
    lines = np.bincount(cloth.bends.center[whole], minlength=cloth.particle_count)
    inside = (lines[cloth.cells.corners] == 2).all(axis=1)
    found = np.full((len(inside), NEIGHBOURS), NO_PARTICLE, dtype=np.int32)
    at = slots.slot[cloth.cells.corners[inside, 0]]
    up = slots.step(at, WARP)
    around = (-up, 1 - up, at * 0 - 1, at * 0 + 2, up - 1, up + 2, 2 * up, 2 * up + 1)
    found[inside] = np.stack([slots.blocks.particle[at + step] for step in around], axis=1)
    return found


def bow_and_crossing(positions: np.ndarray, cells: Cells, neighbours: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """4 h^2 (x_uu + x_vv) and h^2 x_uv (C,3) [m] of cells with their neighbours (C,8); the first is 0 where they are missing."""
    x00, x10, x11, x01 = picked(positions, cells.corners)
    # one after the other, so that they are not all held at once
    around = sum(positions.take(column, axis=0) for column in neighbours.T)
    bow = around - 2.0 * (x00 + x10 + x11 + x01)
    return np.where(neighbours[:, :1] == NO_PARTICLE, 0.0, bow), x00 - x10 - x01 + x11


def limited(arc):  # type: ignore[no-untyped-def]
    """What an arc a [rad] adds to the angle, and its derivative by a."""
    square = (arc / MOST) ** 2
    share = 1.0 / np.sqrt(np.sqrt(1.0 + square * square))
    return arc * share, share * (share * share) ** 2


limited_arc = kernel(limited)


@row_kernel
def gather_corners(span, origin, pull, total):  # type: ignore[no-untyped-def]
    """Sum over the four cells around each slot of what stands at their corners 00, pull (3,R), into total (3,R); span: runs of slots (`Blocks.runs`), slots to
    the warp neighbour; origin: slot at which the room begins. Four times that less the sum of those of its neighbours is what arcs push a slot by: bow is
    four such differences."""
    runs, up = span
    first = runs[0, 0] - origin
    for axis in range(3):
        c00, c10, c11, c01 = pull[axis, first:], pull[axis, first - 1 :], pull[axis, first - up - 1 :], pull[axis, first - up :]
        into = total[axis, first:]
        for run in range(len(runs)):
            begin, end = ends(runs, run)
            for i in range(begin, end):
                into[i] = (c00[i] + c10[i]) + (c11[i] + c01[i])
