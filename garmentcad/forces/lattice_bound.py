"""How stiff the lattice of a cloth can be at most: row sums of the tangents of stretch, shear, twist and bending, block by block as their forces (lattice.py).

What an element adds to the row sums of its corners and of its neighbours is found once, at its slot; then each slot adds up what concerns it. The bounds
themselves stand with each law.
"""

from __future__ import annotations

import math

import numba
import numpy as np

from garmentcad.arrays import kernel, long_kernel
from garmentcad.forces.bend import line_bound
from garmentcad.forces.rows import KEPT, LANES, LOAD, load_motion, runs_of
from garmentcad.forces.shear import SHORTEST, shear_bounds
from garmentcad.forces.stretch import tension_bound
from garmentcad.forces.twist import twist_bound

# Where the bounds lie in the room of a block, behind places, velocities and presence: of links, weft and warp; of cells, at the corners 00 and 11, at 10 and
# 01, at each neighbour; of weft lines at the centre, before and behind it, and of warp lines.
_WEFT, _WARP, _EVEN, _ODD, _BESIDE, _WEFT_LINE, _WARP_LINE = 7, 8, 9, 10, 11, 12, 15


@kernel
def _bound_links(first, last, step, slot, links, spacing, room, out):  # type: ignore[no-untyped-def]
    """Of the links from places first to last - 1 in the room to those `step` behind. slot: of place 0."""
    for i in range(first, last):
        dx, dy, dz = room[0, i + step] - room[0, i], room[1, i + step] - room[1, i], room[2, i + step] - room[2, i]
        s = slot + i
        strain = math.sqrt(dx * dx + dy * dy + dz * dz) / spacing - 1.0
        out[i] = tension_bound(strain, links[0, s], links[1, s], links[2, s], links[3, s]) / spacing


@kernel
def _bound_cells(first, last, up, slot, cells, spacing, whole, room):  # type: ignore[no-untyped-def]
    """Of the cells whose corners 00 are at places first to last - 1. cells: of shear and of twist, see `write_rows` of each; whole: of shear as well."""
    half = 0.5 / spacing
    for i in range(first, last):
        uu = ww = uw = bows = both = crossings = 0.0
        for axis in range(3):
            x00, x10, x11, x01 = room[axis, i], room[axis, i + 1], room[axis, i + up + 1], room[axis, i + up]
            below, above = room[axis, i - up] + room[axis, i + 1 - up], room[axis, i + 2 * up] + room[axis, i + 2 * up + 1]
            beside = (room[axis, i - 1] + room[axis, i + up - 1]) + (room[axis, i + 2] + room[axis, i + up + 2])
            u, w = half * ((x01 + x11) - (x00 + x10)), half * ((x10 + x11) - (x00 + x01))
            bow, crossing = (below + above + beside) - 2.0 * ((x00 + x10) + (x11 + x01)), (x00 - x10) + (x11 - x01)
            uu, ww, uw = uu + u * u, ww + w * w, uw + u * w
            bows, both, crossings = bows + bow * bow, both + bow * crossing, crossings + crossing * crossing
        even = odd = room[_BESIDE, i] = 0.0
        uu, ww, s = max(uu, SHORTEST * SHORTEST), max(ww, SHORTEST * SHORTEST), slot + i
        if whole:
            even, odd, room[_BESIDE, i] = shear_bounds(
                uu, ww, uw, math.sqrt(bows), both, math.sqrt(crossings), spacing, cells[0, s], cells[1, s], cells[2, s], cells[3, s], cells[4, s]
            )
        twist = twist_bound(uu, ww, uw, math.sqrt(crossings), spacing, cells[5, s], cells[6, s])
        room[_EVEN, i], room[_ODD, i] = even + twist, odd + twist


@kernel
def _bound_lines(first, last, step, stiffness, way, spacing, room, out):  # type: ignore[no-untyped-def]
    """Of the lines whose centres are at places first to last - 1 and whose arms go `step` back and on. stiffness, way: from place 0 on; out (3,R): at the
    centre, at the ends before and behind it."""
    for i in range(first, last):
        ax, ay, az = room[0, i] - room[0, i - step], room[1, i] - room[1, i - step], room[2, i] - room[2, i - step]
        bx, by, bz = room[0, i + step] - room[0, i], room[1, i + step] - room[1, i], room[2, i + step] - room[2, i]
        out[0, i], out[1, i], out[2, i] = line_bound(ax, ay, az, bx, by, bz, spacing, stiffness[i], way[i])


@kernel
def _sum_bounds(first, last, up, room, out):  # type: ignore[no-untyped-def]
    """Of what stands at places first to last - 1 and beside them, into out (last - first,)."""
    for i in range(first, last):
        links = (room[_WEFT, i] + room[_WEFT, i - 1]) + (room[_WARP, i] + room[_WARP, i - up])
        cells = (room[_EVEN, i] + room[_EVEN, i - up - 1]) + (room[_ODD, i - 1] + room[_ODD, i - up])
        rows = (room[_BESIDE, i + up] + room[_BESIDE, i + up - 1]) + (room[_BESIDE, i - 2 * up] + room[_BESIDE, i - 2 * up - 1])
        columns = (room[_BESIDE, i + 1] + room[_BESIDE, i + 1 - up]) + (room[_BESIDE, i - 2] + room[_BESIDE, i - 2 - up])
        weft = room[_WEFT_LINE, i] + (room[_WEFT_LINE + 1, i + 1] + room[_WEFT_LINE + 2, i - 1])
        warp = room[_WARP_LINE, i] + (room[_WARP_LINE + 1, i + up] + room[_WARP_LINE + 2, i - up])
        out[i - first] = (links + (cells + (rows + columns))) + (weft + warp)


@long_kernel
def bound_block(k, blocks, links, cells, bends, spacing, whole, positions, rooms, out):  # type: ignore[no-untyped-def]
    """Row sum bound [N/m] of each particle of a block into out (P,). links (8,S): coefficients of the weft and of the warp; cells (7,S); bends (4,S);
    whole: of all laws, not only of twist and bending; rooms (threads,18+,R): scratch of each thread."""
    room = rooms[numba.get_thread_id()]
    first, size, up = np.int64(blocks.first[k]), np.int64(blocks.size[k]), np.int64(blocks.columns[k])
    origin = (first - 3 * up - LANES) // LANES * LANES
    load_motion(runs_of(blocks, k, LOAD), origin, blocks.particle, positions, positions, room)
    begin, end, half = first - origin, first - origin + size, len(links) // 2
    if whole:
        _bound_links(begin - 1, end, 1, origin, links[:half], spacing, room, room[_WEFT])
        _bound_links(begin - up, end, up, origin, links[half:], spacing, room, room[_WARP])
    else:
        room[_WEFT:_EVEN] = 0.0
    _bound_cells(begin - 2 * up - 1, end + up, up, origin, cells, spacing, whole, room)
    _bound_lines(begin - 1, end + 1, 1, bends[0, origin:], bends[1, origin:], spacing, room, room[_WEFT_LINE:_WARP_LINE])
    _bound_lines(begin - up, end + up, up, bends[2, origin:], bends[3, origin:], spacing, room, room[_WARP_LINE : _WARP_LINE + 3])
    kept = runs_of(blocks, k, KEPT)
    for r in range(len(kept)):
        _sum_bounds(kept[r, 0] - origin, kept[r, 1] - origin, up, room, out[np.int64(blocks.particle[kept[r, 0]]) :])
