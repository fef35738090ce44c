"""Shear and twist of rows of lattice cells, in one pass: both need the same vectors. The equations stand in shear.py, arcs.py and twist.py."""

from __future__ import annotations

import numpy as np

from garmentcad.arrays import row_kernel
from garmentcad.fabric.internal_friction import dragged
from garmentcad.fabric.law_bending import STICK
from garmentcad.fabric.law_shear import stick_stiffness
from garmentcad.forces.arcs import limited_arc
from garmentcad.forces.shear import shear_angle
from garmentcad.forces.twist import LEAST_NORMAL


@row_kernel
def cell_row(span, origin, cells, setting, motion, out, held):  # type: ignore[no-untyped-def]
    """Cells whose corners 00 are in a row; span: first slot in the room, slots to the corner 01, number of cells; origin: slot at which the room begins.

    cells (7,S): of shear and of twist, see `write_rows` of each; setting: spacing, damping time; motion (6+,R). Forces on corners 00, 10, 11, 01 into
    out (15,R), at corner 00; its last three rows: what arcs push each neighbour of the cell back by, and pull each corner by twice.
    held: sliders of shear and twist (2,S) before, (2,R) after, energy lost (R,) [J], added to.
    """
    spacing, damping_time = setting
    before, after, lost = held
    first, up, count = span
    x00, y00, z00, u00, v00, w00 = motion[0, first:], motion[1, first:], motion[2, first:], motion[3, first:], motion[4, first:], motion[5, first:]
    i10 = first + 1
    x10, y10, z10, u10, v10, w10 = motion[0, i10:], motion[1, i10:], motion[2, i10:], motion[3, i10:], motion[4, i10:], motion[5, i10:]
    i01 = first + up
    x01, y01, z01, u01, v01, w01 = motion[0, i01:], motion[1, i01:], motion[2, i01:], motion[3, i01:], motion[4, i01:], motion[5, i01:]
    i11 = first + up + 1
    x11, y11, z11, u11, v11, w11 = motion[0, i11:], motion[1, i11:], motion[2, i11:], motion[3, i11:], motion[4, i11:], motion[5, i11:]
    fx00, fy00, fz00, fx10, fy10, fz10 = out[0, first:], out[1, first:], out[2, first:], out[3, first:], out[4, first:], out[5, first:]
    fx11, fy11, fz11, fx01, fy01, fz01 = out[6, first:], out[7, first:], out[8, first:], out[9, first:], out[10, first:], out[11, first:]
    arc_x, arc_y, arc_z = out[12, first:], out[13, first:], out[14, first:]
    # the eight neighbours: s and n below and above, w and e beside
    s0, s1, n0, n1, w0, w1, e0, e1 = first - up, i10 - up, i01 + up, i11 + up, first - 1, i01 - 1, i10 + 1, i11 + 1
    xs0, ys0, zs0, xs1, ys1, zs1 = motion[0, s0:], motion[1, s0:], motion[2, s0:], motion[0, s1:], motion[1, s1:], motion[2, s1:]
    xn0, yn0, zn0, xn1, yn1, zn1 = motion[0, n0:], motion[1, n0:], motion[2, n0:], motion[0, n1:], motion[1, n1:], motion[2, n1:]
    xw0, yw0, zw0, xw1, yw1, zw1 = motion[0, w0:], motion[1, w0:], motion[2, w0:], motion[0, w1:], motion[1, w1:], motion[2, w1:]
    xe0, ye0, ze0, xe1, ye1, ze1 = motion[0, e0:], motion[1, e0:], motion[2, e0:], motion[0, e1:], motion[1, e1:], motion[2, e1:]
    here = origin + first
    shear, low, rise, shear_way, arc = cells[0, here:], cells[1, here:], cells[2, here:], cells[3, here:], cells[4, here:]
    twist, twist_way = cells[5, here:], cells[6, here:]
    angle, crossing, angle_after, crossing_after, gone = before[0, here:], before[1, here:], after[0, first:], after[1, first:], lost[first:]
    half = 0.5 / spacing
    normal_unit = half / spacing
    for i in range(np.uint64(count)):
        px, py, pz = x11[i] - x00[i], y11[i] - y00[i], z11[i] - z00[i]
        qx, qy, qz = x01[i] - x10[i], y01[i] - y10[i], z01[i] - z10[i]
        ux, uy, uz, wx, wy, wz = half * (px + qx), half * (py + qy), half * (pz + qz), half * (px - qx), half * (py - qy), half * (pz - qz)
        gamma, gux, guy, guz, gwx, gwy, gwz, inverse = shear_angle(ux, uy, uz, wx, wy, wz)
        # gradients on the diagonals p and q
        gpx, gpy, gpz = half * (gux + gwx), half * (guy + gwy), half * (guz + gwz)
        gqx, gqy, gqz = half * (gux - gwx), half * (guy - gwy), half * (guz - gwz)
        rate = gpx * (u11[i] - u00[i]) + gpy * (v11[i] - v00[i]) + gpz * (w11[i] - w00[i])
        rate += gqx * (u01[i] - u10[i]) + gqy * (v01[i] - v10[i]) + gqz * (w01[i] - w10[i])
        sx, sy, sz = (x00[i] - x10[i]) + (x11[i] - x01[i]), (y00[i] - y10[i]) + (y11[i] - y01[i]), (z00[i] - z10[i]) + (z11[i] - z01[i])
        bx = ((xs0[i] + xs1[i]) + (xn0[i] + xn1[i])) + ((xw0[i] + xw1[i]) + (xe0[i] + xe1[i])) - 2.0 * ((x00[i] + x10[i]) + (x11[i] + x01[i]))
        by = ((ys0[i] + ys1[i]) + (yn0[i] + yn1[i])) + ((yw0[i] + yw1[i]) + (ye0[i] + ye1[i])) - 2.0 * ((y00[i] + y10[i]) + (y11[i] + y01[i]))
        bz = ((zs0[i] + zs1[i]) + (zn0[i] + zn1[i])) + ((zw0[i] + zw1[i]) + (ze0[i] + ze1[i])) - 2.0 * ((z00[i] + z10[i]) + (z11[i] + z01[i]))
        lean, keen = limited_arc(arc[i] * (bx * sx + by * sy + bz * sz))
        gamma += lean
        slider = dragged(angle[i], gamma, shear_way[i])
        stick = stick_stiffness(gamma, low[i], rise[i])
        shearing = shear[i] * gamma + stick * (gamma - slider)
        pull = shearing * keen * arc[i]
        shearing += shear[i] * damping_time * rate
        arc_x[i], arc_y[i], arc_z[i] = pull * sx, pull * sy, pull * sz
        loss = stick_stiffness(0.5 * (gamma + slider), low[i], rise[i]) * shear_way[i] * abs(slider - angle[i])
        angle_after[i] = slider
        # |p x q| = 2 h^2 |u x w|
        inverse = min(inverse, 1.0 / LEAST_NORMAL) * normal_unit
        nx, ny, nz = inverse * (py * qz - pz * qy), inverse * (pz * qx - px * qz), inverse * (px * qy - py * qx)
        height = nx * sx + ny * sy + nz * sz
        slider = dragged(crossing[i], height, twist_way[i])
        bending = twist[i] * (height + STICK * (height - slider))
        gone[i] += loss + STICK * twist[i] * twist_way[i] * abs(slider - crossing[i])
        crossing_after[i] = slider
        # d(height)/dp = q x t, d(height)/dq = t x p with t = (s - height n)/|p x q|
        turn = bending * inverse
        tx, ty, tz = turn * (sx - height * nx), turn * (sy - height * ny), turn * (sz - height * nz)
        nx, ny, nz = bending * nx + pull * bx, bending * ny + pull * by, bending * nz + pull * bz
        px, py, pz, qx, qy, qz = (
            shearing * gpx + (qy * tz - qz * ty), shearing * gpy + (qz * tx - qx * tz), shearing * gpz + (qx * ty - qy * tx),
            shearing * gqx + (ty * pz - tz * py), shearing * gqy + (tz * px - tx * pz), shearing * gqz + (tx * py - ty * px),
        )  # fmt: skip
        fx00[i], fy00[i], fz00[i], fx11[i], fy11[i], fz11[i] = px - nx, py - ny, pz - nz, -px - nx, -py - ny, -pz - nz
        fx10[i], fy10[i], fz10[i], fx01[i], fy01[i], fz01[i] = qx + nx, qy + ny, qz + nz, nx - qx, ny - qy, nz - qz
