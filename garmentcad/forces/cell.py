"""Shear and twist of rows of lattice cells: both need the same vectors. The equations stand in shear.py, arcs.py and twist.py.

A processor looks ahead some 250 instructions. A loop as long as that waits for each of its roots and divisions, where turns of a shorter one overlap. So a row
of cells is gone through by short loops, and what the next one needs lies in rows meanwhile (44 us for 1,900 cells in one loop, 35 in six).
"""

from __future__ import annotations

import numpy as np

from garmentcad.arrays import inlined, row_kernel
from garmentcad.fabric.internal_friction import dragged
from garmentcad.fabric.law_bending import STICK
from garmentcad.fabric.law_shear import stick_stiffness
from garmentcad.forces.arcs import limited_arc
from garmentcad.forces.shear import chord_angle, chord_gradients, chord_products
from garmentcad.forces.twist import LEAST_NORMAL


@inlined
def _bow_row(span, motion, bow, crossing):  # type: ignore[no-untyped-def]
    """The bow and the crossing of arcs.py, (3,R) each [m]."""
    first, up, count = span
    i10, i01, i11 = first + 1, first + up, first + up + 1
    # the eight neighbours: s and n below and above, w and e beside
    s0, s1, n0, n1, w0, w1, e0, e1 = first - up, i10 - up, i01 + up, i11 + up, first - 1, i01 - 1, i10 + 1, i11 + 1
    for axis in range(3):
        x, b, c = motion[axis], bow[axis, first:], crossing[axis, first:]
        x00, x10, x11, x01 = x[first:], x[i10:], x[i11:], x[i01:]
        xs0, xs1, xn0, xn1, xw0, xw1, xe0, xe1 = x[s0:], x[s1:], x[n0:], x[n1:], x[w0:], x[w1:], x[e0:], x[e1:]
        for i in range(np.uint64(count)):
            around = ((xs0[i] + xs1[i]) + (xn0[i] + xn1[i])) + ((xw0[i] + xw1[i]) + (xe0[i] + xe1[i]))
            b[i] = around - 2.0 * ((x00[i] + x10[i]) + (x11[i] + x01[i]))
            c[i] = (x00[i] - x10[i]) + (x11[i] - x01[i])


@inlined
def _angle_row(span, half, motion, arcs, bow, crossing, warp, weft):  # type: ignore[no-untyped-def]
    """Into warp (3,R): gamma [rad], how it changes with the arc, 1/|u x w|; into weft (2+,R): what `chord_gradients` needs besides. half: 1/(2 h)."""
    first, up, count = span
    i10, i01, i11 = first + 1, first + up, first + up + 1
    x00, y00, z00, x10, y10, z10 = motion[0, first:], motion[1, first:], motion[2, first:], motion[0, i10:], motion[1, i10:], motion[2, i10:]
    x11, y11, z11, x01, y01, z01 = motion[0, i11:], motion[1, i11:], motion[2, i11:], motion[0, i01:], motion[1, i01:], motion[2, i01:]
    bx, by, bz, cx, cy, cz = bow[0, first:], bow[1, first:], bow[2, first:], crossing[0, first:], crossing[1, first:], crossing[2, first:]
    a, b, c, d, e = warp[0, first:], warp[1, first:], warp[2, first:], weft[0, first:], weft[1, first:]
    for i in range(np.uint64(count)):
        px, py, pz = x11[i] - x00[i], y11[i] - y00[i], z11[i] - z00[i]
        qx, qy, qz = x01[i] - x10[i], y01[i] - y10[i], z01[i] - z10[i]
        a[i], b[i], c[i] = chord_products(
            half * (px + qx), half * (py + qy), half * (pz + qz), half * (px - qx), half * (py - qy), half * (pz - qz)
        )  # fmt: skip
    for i in range(np.uint64(count)):
        gamma, inverse, d[i], e[i] = chord_angle(a[i], b[i], c[i])
        lean, keen = limited_arc(arcs[i] * (bx[i] * cx[i] + by[i] * cy[i] + bz[i] * cz[i]))
        a[i], b[i], c[i] = gamma + lean, keen, inverse


@inlined
def _shear_row(span, here, half, damping_time, cells, motion, slider, after, warp, weft, rest):  # type: ignore[no-untyped-def]
    """Forces of shear on the diagonals p and q in place of warp and weft of `_angle_row`, (3,R) each; into rest (3,R): what arcs pull with [N/m2], 1/|u x w|,
    the energy lost [J]."""
    first, up, count = span
    i10, i01, i11 = first + 1, first + up, first + up + 1
    x00, y00, z00, u00, v00, w00 = motion[0, first:], motion[1, first:], motion[2, first:], motion[3, first:], motion[4, first:], motion[5, first:]
    x10, y10, z10, u10, v10, w10 = motion[0, i10:], motion[1, i10:], motion[2, i10:], motion[3, i10:], motion[4, i10:], motion[5, i10:]
    x11, y11, z11, u11, v11, w11 = motion[0, i11:], motion[1, i11:], motion[2, i11:], motion[3, i11:], motion[4, i11:], motion[5, i11:]
    x01, y01, z01, u01, v01, w01 = motion[0, i01:], motion[1, i01:], motion[2, i01:], motion[3, i01:], motion[4, i01:], motion[5, i01:]
    shear, low, rise, way, arc = cells[0, here:], cells[1, here:], cells[2, here:], cells[3, here:], cells[4, here:]
    a, b, c, d, e, f = warp[0, first:], warp[1, first:], warp[2, first:], weft[0, first:], weft[1, first:], weft[2, first:]
    pull, inverses, lost = rest[0, first:], rest[1, first:], rest[2, first:]
    for i in range(np.uint64(count)):
        px, py, pz = x11[i] - x00[i], y11[i] - y00[i], z11[i] - z00[i]
        qx, qy, qz = x01[i] - x10[i], y01[i] - y10[i], z01[i] - z10[i]
        ux, uy, uz, wx, wy, wz = half * (px + qx), half * (py + qy), half * (pz + qz), half * (px - qx), half * (py - qy), half * (pz - qz)
        gamma, keen, inverse = a[i], b[i], c[i]
        gux, guy, guz, gwx, gwy, gwz = chord_gradients(ux, uy, uz, wx, wy, wz, inverse, d[i], e[i])
        # on the diagonals p and q
        gpx, gpy, gpz = half * (gux + gwx), half * (guy + gwy), half * (guz + gwz)
        gqx, gqy, gqz = half * (gux - gwx), half * (guy - gwy), half * (guz - gwz)
        rate = gpx * (u11[i] - u00[i]) + gpy * (v11[i] - v00[i]) + gpz * (w11[i] - w00[i])
        rate += gqx * (u01[i] - u10[i]) + gqy * (v01[i] - v10[i]) + gqz * (w01[i] - w10[i])
        now = dragged(slider[i], gamma, way[i])
        shearing = shear[i] * gamma + stick_stiffness(gamma, low[i], rise[i]) * (gamma - now)
        pull[i], inverses[i] = shearing * keen * arc[i], inverse
        lost[i] = stick_stiffness(0.5 * (gamma + now), low[i], rise[i]) * way[i] * abs(now - slider[i])
        after[i] = now
        shearing += shear[i] * damping_time * rate
        a[i], b[i], c[i], d[i], e[i], f[i] = shearing * gpx, shearing * gpy, shearing * gpz, shearing * gqx, shearing * gqy, shearing * gqz


@inlined
def _twist_row(span, here, normal_unit, cells, motion, slider, after, lost, c00, c10, c11, c01, arcs):  # type: ignore[no-untyped-def]
    """From what the loops before have left, the forces on the corners and `arcs` of `cell_row`, (3,R) each: of shear on p in c00, on q in c10, the bow in c11,
    the rest of `_shear_row` in c01, the crossing in arcs. normal_unit: 1/(2 h^2), as |p x q| = 2 h^2 |u x w|."""
    first, up, count = span
    i10, i01, i11 = first + 1, first + up, first + up + 1
    x00, y00, z00, x10, y10, z10 = motion[0, first:], motion[1, first:], motion[2, first:], motion[0, i10:], motion[1, i10:], motion[2, i10:]
    x11, y11, z11, x01, y01, z01 = motion[0, i11:], motion[1, i11:], motion[2, i11:], motion[0, i01:], motion[1, i01:], motion[2, i01:]
    twist, way, gone = cells[5, here:], cells[6, here:], lost[first:]
    fx00, fy00, fz00, fx10, fy10, fz10 = c00[0, first:], c00[1, first:], c00[2, first:], c10[0, first:], c10[1, first:], c10[2, first:]
    fx11, fy11, fz11, fx01, fy01, fz01 = c11[0, first:], c11[1, first:], c11[2, first:], c01[0, first:], c01[1, first:], c01[2, first:]
    arc_x, arc_y, arc_z = arcs[0, first:], arcs[1, first:], arcs[2, first:]
    for i in range(np.uint64(count)):
        px, py, pz = x11[i] - x00[i], y11[i] - y00[i], z11[i] - z00[i]
        qx, qy, qz = x01[i] - x10[i], y01[i] - y10[i], z01[i] - z10[i]
        sx, sy, sz, pull = arc_x[i], arc_y[i], arc_z[i], fx01[i]
        inverse = min(fy01[i], 1.0 / LEAST_NORMAL) * normal_unit
        nx, ny, nz = inverse * (py * qz - pz * qy), inverse * (pz * qx - px * qz), inverse * (px * qy - py * qx)
        height = nx * sx + ny * sy + nz * sz
        now = dragged(slider[i], height, way[i])
        bending = twist[i] * (height + STICK * (height - now))
        gone[i] += fz01[i] + STICK * twist[i] * way[i] * abs(now - slider[i])
        after[i] = now
        # d(height)/dp = q x t, d(height)/dq = t x p with t = (s - height n)/|p x q|
        turn = bending * inverse
        fx01[i], fy01[i], fz01[i] = turn * (sx - height * nx), turn * (sy - height * ny), turn * (sz - height * nz)
        fx11[i], fy11[i], fz11[i] = bending * nx + pull * fx11[i], bending * ny + pull * fy11[i], bending * nz + pull * fz11[i]
        arc_x[i], arc_y[i], arc_z[i] = pull * sx, pull * sy, pull * sz
    for i in range(np.uint64(count)):
        px, py, pz = x11[i] - x00[i], y11[i] - y00[i], z11[i] - z00[i]
        qx, qy, qz = x01[i] - x10[i], y01[i] - y10[i], z01[i] - z10[i]
        tx, ty, tz, nx, ny, nz = fx01[i], fy01[i], fz01[i], fx11[i], fy11[i], fz11[i]
        px, py, pz, qx, qy, qz = (
            fx00[i] + (qy * tz - qz * ty), fy00[i] + (qz * tx - qx * tz), fz00[i] + (qx * ty - qy * tx),
            fx10[i] + (ty * pz - tz * py), fy10[i] + (tz * px - tx * pz), fz10[i] + (tx * py - ty * px),
        )  # fmt: skip
        fx00[i], fy00[i], fz00[i], fx11[i], fy11[i], fz11[i] = px - nx, py - ny, pz - nz, -px - nx, -py - ny, -pz - nz
        fx10[i], fy10[i], fz10[i], fx01[i], fy01[i], fz01[i] = qx + nx, qy + ny, qz + nz, nx - qx, ny - qy, nz - qz


@row_kernel
def cell_row(span, origin, cells, setting, motion, c00, c10, c11, c01, arcs, before, after, lost):  # type: ignore[no-untyped-def]
    """Cells whose corners 00 are in a row; span: first slot in the room, slots to the corner 01, number of cells; origin: slot at which the room begins.

    cells (7,S): of shear and of twist, see `write_rows` of each; setting: spacing, damping time; motion (6+,R). Into c00, c10, c11, c01 (3,R), at corner 00:
    the forces on the corners; into arcs (3,R): what arcs push each neighbour of the cell back by, and pull each corner by twice.
    before, after: sliders of shear and twist (2,S), (2,R); lost: energy lost (R,) [J], added to.
    """
    spacing, damping_time = setting
    here, half = origin + span[0], 0.5 / spacing
    _bow_row(span, motion, c11, arcs)
    _angle_row(span, half, motion, cells[4, here:], c11, arcs, c00, c10)
    _shear_row(span, here, half, damping_time, cells, motion, before[0, here:], after[0, span[0] :], c00, c10, c01)
    _twist_row(span, here, half / spacing, cells, motion, before[1, here:], after[1, span[0] :], lost, c00, c10, c11, c01, arcs)
