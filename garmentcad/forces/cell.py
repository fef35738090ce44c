"""Shear and twist of rows of lattice cells: both need the same vectors. The equations stand in shear.py, arcs.py and twist.py.

A processor looks ahead some 250 instructions. A loop as long as that waits for each of its roots and divisions, where turns of a shorter one overlap. So a row
of cells is gone through by short loops, and what the next one needs lies in rows meanwhile (44 us for 1,900 cells in one loop, 35 in six).
"""

from __future__ import annotations

from garmentcad.arrays import row_kernel
from garmentcad.fabric.internal_friction import dragged
from garmentcad.fabric.law_bending import STICK
from garmentcad.fabric.law_shear import stick_stiffness
from garmentcad.forces.arcs import limited_arc
from garmentcad.forces.rows import ends
from garmentcad.forces.shear import chord_angle, chord_gradients, chord_products
from garmentcad.forces.twist import LEAST_NORMAL


@row_kernel
def cell_row(span, origin, cells, setting, motion, c00, c10, c11, c01, arcs, before, after, lost):  # type: ignore[no-untyped-def]
    """Cells; span: runs of their corners 00 (`Blocks.runs`), slots to the corner 01; origin: slot at which the room begins.

    cells (7,S): of shear and of twist, see `write_rows` of each; setting: spacing, damping time; motion (6+,R). Into c00, c10, c11, c01 (3,R), at corner 00:
    the forces on the corners; into arcs (3,R): what arcs push each neighbour of the cell back by, and pull each corner by twice.
    before, after: sliders of shear and twist (2,S), (2,R); lost: energy lost (R,) [J], added to.
    """
    spacing, damping_time = setting
    runs, up = span
    first = runs[0, 0] - origin
    i10, i01, i11, here = first + 1, first + up, first + up + 1, origin + first
    # the eight neighbours: s and n below and above, w and e beside
    s0, s1, n0, n1, w0, w1, e0, e1 = first - up, i10 - up, i01 + up, i11 + up, first - 1, i01 - 1, i10 + 1, i11 + 1
    x00, y00, z00, u00, v00, w00 = motion[0, first:], motion[1, first:], motion[2, first:], motion[3, first:], motion[4, first:], motion[5, first:]
    x10, y10, z10, u10, v10, w10 = motion[0, i10:], motion[1, i10:], motion[2, i10:], motion[3, i10:], motion[4, i10:], motion[5, i10:]
    x11, y11, z11, u11, v11, w11 = motion[0, i11:], motion[1, i11:], motion[2, i11:], motion[3, i11:], motion[4, i11:], motion[5, i11:]
    x01, y01, z01, u01, v01, w01 = motion[0, i01:], motion[1, i01:], motion[2, i01:], motion[3, i01:], motion[4, i01:], motion[5, i01:]
    fx00, fy00, fz00, fx10, fy10, fz10 = c00[0, first:], c00[1, first:], c00[2, first:], c10[0, first:], c10[1, first:], c10[2, first:]
    fx11, fy11, fz11, fx01, fy01, fz01 = c11[0, first:], c11[1, first:], c11[2, first:], c01[0, first:], c01[1, first:], c01[2, first:]
    arc_x, arc_y, arc_z = arcs[0, first:], arcs[1, first:], arcs[2, first:]
    shear, low, rise, shear_way, arc = cells[0, here:], cells[1, here:], cells[2, here:], cells[3, here:], cells[4, here:]
    twist, twist_way = cells[5, here:], cells[6, here:]
    angle, height, angle_after, height_after, gone = before[0, here:], before[1, here:], after[0, first:], after[1, first:], lost[first:]
    half = 0.5 / spacing
    normal_unit = half / spacing
    # bow of arcs.py into c11, crossing into arcs
    for axis in range(3):
        x, bow, crossing = motion[axis], c11[axis, first:], arcs[axis, first:]
        p00, p10, p11, p01, ps0, ps1, pn0, pn1 = x[first:], x[i10:], x[i11:], x[i01:], x[s0:], x[s1:], x[n0:], x[n1:]
        pw0, pw1, pe0, pe1 = x[w0:], x[w1:], x[e0:], x[e1:]
        for run in range(len(runs)):
            begin, end = ends(runs, run)
            for i in range(begin, end):
                around = ((ps0[i] + ps1[i]) + (pn0[i] + pn1[i])) + ((pw0[i] + pw1[i]) + (pe0[i] + pe1[i]))
                bow[i] = around - 2.0 * ((p00[i] + p10[i]) + (p11[i] + p01[i]))
                crossing[i] = (p00[i] - p10[i]) + (p11[i] - p01[i])
    # products of the mean warp u and weft w into c00
    for run in range(len(runs)):
        begin, end = ends(runs, run)
        for i in range(begin, end):
            px, py, pz = x11[i] - x00[i], y11[i] - y00[i], z11[i] - z00[i]
            qx, qy, qz = x01[i] - x10[i], y01[i] - y10[i], z01[i] - z10[i]
            fx00[i], fy00[i], fz00[i] = chord_products(
                half * (px + qx), half * (py + qy), half * (pz + qz), half * (px - qx), half * (py - qy), half * (pz - qz)
            )  # fmt: skip
    # into c00: gamma, how it changes with the arc, 1/|u x w|; into c10 what else its gradients need
    for run in range(len(runs)):
        begin, end = ends(runs, run)
        for i in range(begin, end):
            gamma, inverse, fx10[i], fy10[i] = chord_angle(fx00[i], fy00[i], fz00[i])
            lean, keen = limited_arc(arc[i] * (fx11[i] * arc_x[i] + fy11[i] * arc_y[i] + fz11[i] * arc_z[i]))
            fx00[i], fy00[i], fz00[i] = gamma + lean, keen, inverse
    # forces of shear on the diagonals p and q into c00 and c10; into c01: the pull of arcs, 1/|u x w|, the energy lost
    for run in range(len(runs)):
        begin, end = ends(runs, run)
        for i in range(begin, end):
            px, py, pz = x11[i] - x00[i], y11[i] - y00[i], z11[i] - z00[i]
            qx, qy, qz = x01[i] - x10[i], y01[i] - y10[i], z01[i] - z10[i]
            ux, uy, uz, wx, wy, wz = half * (px + qx), half * (py + qy), half * (pz + qz), half * (px - qx), half * (py - qy), half * (pz - qz)
            gamma, keen, inverse = fx00[i], fy00[i], fz00[i]
            gux, guy, guz, gwx, gwy, gwz = chord_gradients(ux, uy, uz, wx, wy, wz, inverse, fx10[i], fy10[i])
            gpx, gpy, gpz = half * (gux + gwx), half * (guy + gwy), half * (guz + gwz)
            gqx, gqy, gqz = half * (gux - gwx), half * (guy - gwy), half * (guz - gwz)
            rate = gpx * (u11[i] - u00[i]) + gpy * (v11[i] - v00[i]) + gpz * (w11[i] - w00[i])
            rate += gqx * (u01[i] - u10[i]) + gqy * (v01[i] - v10[i]) + gqz * (w01[i] - w10[i])
            slider = dragged(angle[i], gamma, shear_way[i])
            shearing = shear[i] * gamma + stick_stiffness(gamma, low[i], rise[i]) * (gamma - slider)
            fx01[i], fy01[i] = shearing * keen * arc[i], inverse
            fz01[i] = stick_stiffness(0.5 * (gamma + slider), low[i], rise[i]) * shear_way[i] * abs(slider - angle[i])
            angle_after[i] = slider
            shearing += shear[i] * damping_time * rate
            fx00[i], fy00[i], fz00[i], fx10[i], fy10[i], fz10[i] = (
                shearing * gpx,
                shearing * gpy,
                shearing * gpz,
                shearing * gqx,
                shearing * gqy,
                shearing * gqz,
            )
    # d(height)/dp = q x t, d(height)/dq = t x p with t = (crossing - height n)/|p x q|: t times the bending into c01, what is not along p and q into c11
    for run in range(len(runs)):
        begin, end = ends(runs, run)
        for i in range(begin, end):
            px, py, pz = x11[i] - x00[i], y11[i] - y00[i], z11[i] - z00[i]
            qx, qy, qz = x01[i] - x10[i], y01[i] - y10[i], z01[i] - z10[i]
            sx, sy, sz, pull = arc_x[i], arc_y[i], arc_z[i], fx01[i]
            # |p x q| = 2 h^2 |u x w|
            inverse = min(fy01[i], 1.0 / LEAST_NORMAL) * normal_unit
            nx, ny, nz = inverse * (py * qz - pz * qy), inverse * (pz * qx - px * qz), inverse * (px * qy - py * qx)
            above = nx * sx + ny * sy + nz * sz
            slider = dragged(height[i], above, twist_way[i])
            bending = twist[i] * (above + STICK * (above - slider))
            gone[i] += fz01[i] + STICK * twist[i] * twist_way[i] * abs(slider - height[i])
            height_after[i] = slider
            turn = bending * inverse
            fx01[i], fy01[i], fz01[i] = turn * (sx - above * nx), turn * (sy - above * ny), turn * (sz - above * nz)
            fx11[i], fy11[i], fz11[i] = bending * nx + pull * fx11[i], bending * ny + pull * fy11[i], bending * nz + pull * fz11[i]
            arc_x[i], arc_y[i], arc_z[i] = pull * sx, pull * sy, pull * sz
    for run in range(len(runs)):
        begin, end = ends(runs, run)
        for i in range(begin, end):
            px, py, pz = x11[i] - x00[i], y11[i] - y00[i], z11[i] - z00[i]
            qx, qy, qz = x01[i] - x10[i], y01[i] - y10[i], z01[i] - z10[i]
            tx, ty, tz, nx, ny, nz = fx01[i], fy01[i], fz01[i], fx11[i], fy11[i], fz11[i]
            px, py, pz, qx, qy, qz = (
                fx00[i] + (qy * tz - qz * ty), fy00[i] + (qz * tx - qx * tz), fz00[i] + (qx * ty - qy * tx),
                fx10[i] + (ty * pz - tz * py), fy10[i] + (tz * px - tx * pz), fz10[i] + (tx * py - ty * px),
            )  # fmt: skip
            fx00[i], fy00[i], fz00[i], fx11[i], fy11[i], fz11[i] = px - nx, py - ny, pz - nz, -px - nx, -py - ny, -pz - nz
            fx10[i], fy10[i], fz10[i], fx01[i], fy01[i], fz01[i] = qx + nx, qy + ny, qz + nz, nx - qx, ny - qy, nz - qz
