"""Bending: the turning angle of lines of three points along warp and weft.

    d1 = x0 - x_a,  d2 = x_b - x0,  t = atan2(|d1 x d2|, d1.d2)   [rad]
    E = B w t^2/(2 l)   [J]      l mean of the two rest arms, w width, B [N.m] bending stiffness along the line

so that the moment is B times the curvature t/l at any spacing. An arm may end at a point on a contour chord; its two particles share the force.

Internal friction needs the sign that t has not. With n the unit normal of the cloth at the centre, toward the right side, and a, b the unit vectors of the
arms,

    r = n.(b - a) (t/2)/sin(t/2)   [rad]      E = STICK (B w/l) (r - s)^2/2      (fabric/law_bending.py; s slider)

r is t, with the sign of the side to which the line bends, where it bends square to the cloth. n is along p x q: p and q join what lies before and behind the
centre in the line and across it, neighbours that are missing at the border replaced by the centre. The gradient contains the normal's, so that a line has no
net torque.
Source: KES-FB2, pure bending; Euler elastica in discrete form.
"""

from __future__ import annotations

import math
from functools import cached_property
from typing import NamedTuple

import numpy as np

from garmentcad.arrays import compact, entry, floats, indices, inlined_kernel, kernel, making_kernel, row_kernel
from garmentcad.cloth.cloth import WARP, WEFT, BendLines
from garmentcad.fabric.internal_friction import dragged
from garmentcad.fabric.law_bending import STICK
from garmentcad.fabric.material import MaterialTable
from garmentcad.forces.force import CURVES, NO_PARTICLE, Gauge, OneLaw, between
from garmentcad.forces.rows import PART, LatticeSlots, ends
from garmentcad.geometry.angle import angle_over_sine, arctan2
from garmentcad.geometry.vectors import dots, lengths, picked

SHORTEST = 1e-2  # arms shorter than this part of their rest length lose their force, so that it stays finite where an arm vanishes
LEAST_SINE = 1e-9  # floor of sin(t): an arm folded flat onto the other has no plane to open in, and gets no force
LEAST_NORMAL = 1e-3  # floor of |p x q| in units of the spacing squared: where cloth has collapsed it has no normal
CORNERS = 7  # of a line: centre, arm a (two), arm b (two), before and behind the centre across the line


class BendElements(NamedTuple):
    points: np.ndarray  # (B,7) int32, see CORNERS
    weights: np.ndarray  # (B,2) weight of the second particle of arm a, arm b
    shortest: np.ndarray  # (3,B) length of arm a, arm b below which force fades out, m; floor of |p x q|, m2
    stiffness: np.ndarray  # (B,) B w/l, N.m
    way: np.ndarray  # (B,) d l, rad


@inlined_kernel
def unit_normal(px, py, pz, qx, qy, qz, least):  # type: ignore[no-untyped-def]
    """Unit vector along p x q, shorter where |p x q| is below `least`, and 1/|p x q|."""
    nx, ny, nz = py * qz - pz * qy, pz * qx - px * qz, px * qy - py * qx
    inverse = 1.0 / math.sqrt(max(nx * nx + ny * ny + nz * nz, least * least))
    return nx * inverse, ny * inverse, nz * inverse, inverse


@inlined_kernel
def line_forces(ax, ay, az, bx, by, bz, on_a, on_b, nx, ny, nz, stiffness, way, slider):  # type: ignore[no-untyped-def]
    """A line from its unit arms, what their forces are divided by (1/length), the normal, coefficients and slider: the force on the end of arm a, minus that
    on the end of arm b, the gradient of E on the normal, the slider after it, the energy lost [J]. Without branches."""
    x, y, z = ax + bx, ay + by, az + bz
    # half the angle, whose cosine is |a + b|/2 without cancellation
    half = math.sqrt(max(0.25 * (x * x + y * y + z * z), 0.25 * LEAST_SINE * LEAST_SINE))
    sine2 = max(1.0 - half * half, 1e-16)
    both = 1.0 / (half * sine2)
    over_sine = angle_over_sine(half)
    cosine, along_a, along_b = ax * bx + ay * by + az * bz, nx * ax + ny * ay + nz * az, nx * bx + ny * by + nz * bz
    across = along_b - along_a
    angle = over_sine * across
    after = dragged(slider, angle, way)
    # the squares are 1 but for arms that are too short
    stiffness *= (ax * ax + ay * ay + az * az) * (bx * bx + by * by + bz * bz)
    moment = STICK * stiffness * (angle - after)
    lost = STICK * stiffness * way * abs(after - slider)
    # t/sin(t), the elastic part, and how (t/2)/sin(t/2) changes with the cosine
    straighten = 0.25 * moment * across * (over_sine * half - 1.0) * both - stiffness * over_sine * sine2 * both
    moment *= over_sine
    turn = on_a * straighten, on_a * moment, on_b * straighten, on_b * moment
    return (
        turn[0] * (bx - cosine * ax) + turn[1] * (along_a * ax - nx),
        turn[0] * (by - cosine * ay) + turn[1] * (along_a * ay - ny),
        turn[0] * (bz - cosine * az) + turn[1] * (along_a * az - nz),
        turn[2] * (ax - cosine * bx) + turn[3] * (nx - along_b * bx),
        turn[2] * (ay - cosine * by) + turn[3] * (ny - along_b * by),
        turn[2] * (az - cosine * bz) + turn[3] * (nz - along_b * bz),
        moment * (bx - ax), moment * (by - ay), moment * (bz - az),
        after, lost,
    )  # fmt: skip


@inlined_kernel
def tilt_forces(sx, sy, sz, nx, ny, nz, inverse, px, py, pz, qx, qy, qz):  # type: ignore[no-untyped-def]
    """Gradients on p and on q of an energy whose gradient on the normal is s; inverse: 1/|p x q|."""
    along = nx * sx + ny * sy + nz * sz
    sx, sy, sz = inverse * (sx - along * nx), inverse * (sy - along * ny), inverse * (sz - along * nz)
    return qy * sz - qz * sy, qz * sx - qx * sz, qx * sy - qy * sx, sy * pz - sz * py, sz * px - sx * pz, sx * py - sy * px


@kernel
def line_bound(ax, ay, az, bx, by, bz, rest, stiffness, way):  # type: ignore[no-untyped-def]
    """Row sum bounds [N/m] of a line, whatever its slider, at its centre, at the end of arm a and of arm b, from both arms, which were `rest` [m] long."""
    # |dt/d(end of arm)| = 1/|arm|, and at the centre the sum of both; (1 + t) covers the curvature of t
    a = 1.0 / max(math.sqrt(ax * ax + ay * ay + az * az), SHORTEST * rest)
    b = 1.0 / max(math.sqrt(bx * bx + by * by + bz * bz), SHORTEST * rest)
    x, y, z = a * ax + b * bx, a * ay + b * by, a * az + b * bz
    half = min(0.5 * math.sqrt(x * x + y * y + z * z), 1.0)
    angle = 2.0 * angle_over_sine(half) * math.sqrt(1.0 - half * half)
    scale = stiffness * ((1.0 + STICK) if way > 0.0 else 1.0) * (1.0 + angle) * 2.0 * (a + b)
    return (a + b) * scale, a * scale, b * scale


@row_kernel
def bend_row(span, origin, bends, spacing, motion, lines, pull, held):  # type: ignore[no-untyped-def]
    """Weft and warp lines whose arms are the links before and behind their centres; span: runs of centres (`Blocks.runs`), slots to the warp
    neighbour; origin: slot at which the room begins.

    bends (4,S): B w/l and d l of weft lines and of warp lines; motion (7,R): places, velocities, 1 where a slot holds a particle; lines (8,R): what
    `stretch_row` wrote for the weft and the warp. The force on the first end of the link behind each centre is added to rows 0 to 2 (weft) and 6 to 8 (warp)
    of pull (12,R), that on the first end of the link before it goes into rows 3 to 5 and 9 to 11, all at the centre.
    held: sliders (2,S) before, (2,R) after, energy lost (R,) [J], added to.
    """
    runs, up = span
    first = runs[0, 0] - origin
    before, after, lost = held
    here, west, east, south, north = origin + first, first - 1, first + 1, first - up, first + up
    x0, y0, z0 = motion[0, first:], motion[1, first:], motion[2, first:]
    xe, ye, ze, is_e = motion[0, east:], motion[1, east:], motion[2, east:], motion[6, east:]
    xw, yw, zw, is_w = motion[0, west:], motion[1, west:], motion[2, west:], motion[6, west:]
    xn, yn, zn, is_n = motion[0, north:], motion[1, north:], motion[2, north:], motion[6, north:]
    xs, ys, zs, is_s = motion[0, south:], motion[1, south:], motion[2, south:], motion[6, south:]
    axs, ays, azs, inverse_a = lines[0, west:], lines[1, west:], lines[2, west:], lines[3, west:]
    bxs, bys, bzs, inverse_b = lines[0, first:], lines[1, first:], lines[2, first:], lines[3, first:]
    cxs, cys, czs, inverse_c = lines[4, south:], lines[5, south:], lines[6, south:], lines[7, south:]
    dxs, dys, dzs, inverse_d = lines[4, first:], lines[5, first:], lines[6, first:], lines[7, first:]
    weft_x, weft_y, weft_z, weft_u, weft_v, weft_w = pull[0, first:], pull[1, first:], pull[2, first:], pull[3, first:], pull[4, first:], pull[5, first:]
    warp_x, warp_y, warp_z, warp_u, warp_v, warp_w = pull[6, first:], pull[7, first:], pull[8, first:], pull[9, first:], pull[10, first:], pull[11, first:]
    weft, weft_way, warp, warp_way = bends[0, here:], bends[1, here:], bends[2, here:], bends[3, here:]
    weft_slider, warp_slider, weft_after, warp_after, gone = before[0, here:], before[1, here:], after[0, first:], after[1, first:], lost[first:]
    least = LEAST_NORMAL * spacing * spacing
    for run in range(len(runs)):
        begin, end = ends(runs, run)
        for i in range(begin, end):
            x, y, z, e, w, n, s = x0[i], y0[i], z0[i], is_e[i], is_w[i], is_n[i], is_s[i]
            px, py, pz = e * (xe[i] - x) + w * (x - xw[i]), e * (ye[i] - y) + w * (y - yw[i]), e * (ze[i] - z) + w * (z - zw[i])
            qx, qy, qz = n * (xn[i] - x) + s * (x - xs[i]), n * (yn[i] - y) + s * (y - ys[i]), n * (zn[i] - z) + s * (z - zs[i])
            nx, ny, nz, inverse = unit_normal(px, py, pz, qx, qy, qz, least)
            au, av, aw, bu, bv, bw, tx, ty, tz, weft_after[i], weft_lost = line_forces(
                axs[i], ays[i], azs[i], bxs[i], bys[i], bzs[i], inverse_a[i], inverse_b[i], nx, ny, nz, weft[i], weft_way[i], weft_slider[i]
            )  # fmt: skip
            cu, cv, cw, du, dv, dw, ux, uy, uz, warp_after[i], warp_lost = line_forces(
                cxs[i], cys[i], czs[i], dxs[i], dys[i], dzs[i], inverse_c[i], inverse_d[i], nx, ny, nz, warp[i], warp_way[i], warp_slider[i]
            )  # fmt: skip
            gone[i] += weft_lost + warp_lost
            fx, fy, fz, gx, gy, gz = tilt_forces(tx + ux, ty + uy, tz + uz, nx, ny, nz, inverse, px, py, pz, qx, qy, qz)
            weft_x[i], weft_y[i], weft_z[i] = weft_x[i] + (bu + e * fx), weft_y[i] + (bv + e * fy), weft_z[i] + (bw + e * fz)
            weft_u[i], weft_v[i], weft_w[i] = au + w * fx, av + w * fy, aw + w * fz
            warp_x[i], warp_y[i], warp_z[i] = warp_x[i] + (du + n * gx), warp_y[i] + (dv + n * gy), warp_z[i] + (dw + n * gz)
            warp_u[i], warp_v[i], warp_w[i] = cu + s * gx, cv + s * gy, cw + s * gz


@row_kernel
def _load_arms(span, lines, positions, arms):  # type: ignore[no-untyped-def]
    """Arms a and b and the way across (9,PART) of the lines in span: first, number."""
    first, count = span
    x = positions
    for i in range(count):
        k = first + i
        o, a, c, b, d = lines.points[k, 0], lines.points[k, 1], lines.points[k, 2], lines.points[k, 3], lines.points[k, 4]
        e, f = lines.points[k, 5], lines.points[k, 6]
        weight_a, weight_b = lines.weights[k, 0], lines.weights[k, 1]
        for axis in range(3):
            arms[axis, i] = x[o, axis] - x[a, axis] + weight_a * (x[a, axis] - x[c, axis])
            arms[3 + axis, i] = x[b, axis] - x[o, axis] + weight_b * (x[d, axis] - x[b, axis])
            arms[6 + axis, i] = x[f, axis] - x[e, axis]


@row_kernel
def _turn_arms(count, lines, first, sliders, arms, lost):  # type: ignore[no-untyped-def]
    """In place of the arms (9,PART): the force on the end of arm a, minus the force on the end of arm b, the force before the centre across. Moves the sliders;
    the energy lost [J] goes into lost (PART,)."""
    axs, ays, azs, bxs, bys, bzs, qxs, qys, qzs = arms[0], arms[1], arms[2], arms[3], arms[4], arms[5], arms[6], arms[7], arms[8]
    shortest_a, shortest_b, least = lines.shortest[0, first:], lines.shortest[1, first:], lines.shortest[2, first:]
    stiffness, way, slider = lines.stiffness[first:], lines.way[first:], sliders[first:]
    for i in range(np.uint64(count)):
        ax, ay, az, bx, by, bz, qx, qy, qz = axs[i], ays[i], azs[i], bxs[i], bys[i], bzs[i], qxs[i], qys[i], qzs[i]
        inverse_a = 1.0 / max(math.sqrt(ax * ax + ay * ay + az * az), shortest_a[i])
        inverse_b = 1.0 / max(math.sqrt(bx * bx + by * by + bz * bz), shortest_b[i])
        px, py, pz = ax + bx, ay + by, az + bz
        nx, ny, nz, inverse = unit_normal(px, py, pz, qx, qy, qz, least[i])
        ax, ay, az, bx, by, bz = ax * inverse_a, ay * inverse_a, az * inverse_a, bx * inverse_b, by * inverse_b, bz * inverse_b
        au, av, aw, bu, bv, bw, tx, ty, tz, slider[i], lost[i] = line_forces(
            ax, ay, az, bx, by, bz, inverse_a, inverse_b, nx, ny, nz, stiffness[i], way[i], slider[i]
        )  # fmt: skip
        fx, fy, fz, qxs[i], qys[i], qzs[i] = tilt_forces(tx, ty, tz, nx, ny, nz, inverse, px, py, pz, qx, qy, qz)
        axs[i], ays[i], azs[i], bxs[i], bys[i], bzs[i] = au + fx, av + fy, aw + fz, bu + fx, bv + fy, bw + fz


@making_kernel
def bend_part(part, lines, sliders, positions, out):  # type: ignore[no-untyped-def]
    """Returns the energy lost [J]."""
    first = part * PART
    count = min(len(lines.stiffness) - first, PART)
    arms, lost, total = np.empty((9, PART)), np.empty(PART), 0.0
    _load_arms((first, count), lines, positions, arms)
    _turn_arms(count, lines, first, sliders, arms, lost)
    for i in range(count):
        weight_a, weight_b = lines.weights[first + i, 0], lines.weights[first + i, 1]
        k = CORNERS * (first + i)
        for axis in range(3):
            a, b, across = arms[axis, i], arms[3 + axis, i], arms[6 + axis, i]
            out[k, axis] = b - a
            out[k + 1, axis], out[k + 2, axis] = a - weight_a * a, weight_a * a
            out[k + 3, axis], out[k + 4, axis] = weight_b * b - b, -weight_b * b
            out[k + 5, axis], out[k + 6, axis] = across, -across
        total += lost[i]
    return total


@entry
@kernel
def write_bend(lines, sliders, positions, velocities, out):  # type: ignore[no-untyped-def]
    """Forces on the corners of line i into out[CORNERS i] and what follows. Returns the energy lost [J]."""
    lost = 0.0
    for part in range(-(-len(lines.stiffness) // PART)):
        lost += bend_part(part, lines, sliders, positions, out)
    return lost


def stored(stiffness: np.ndarray, strain: np.ndarray, sliders: np.ndarray, way: np.ndarray, elastic: np.ndarray | None = None) -> float:
    """Energy [J] of elements with stick springs STICK times as stiff as they are themselves: stiffness (elastic^2 + STICK (strain - slider)^2)/2."""
    held = strain - np.clip(sliders, strain - way, strain + way)
    return float(np.sum(0.5 * stiffness * ((strain if elastic is None else elastic) ** 2 + STICK * held**2)))


class ForceBend(OneLaw):
    """Bending of lines of a cloth. across: (B,2) particles before and behind each centre across the line, see `across_lines`."""

    name = "bend"

    def __init__(self, lines: BendLines, across: np.ndarray, materials: MaterialTable) -> None:
        self._points = indices(np.column_stack([lines.center, lines.arm_a, lines.arm_b, across]))
        self._weights = compact(np.column_stack([lines.weight_a, lines.weight_b]).astype(np.float64))
        self._direction = lines.direction
        self._rest = compact(np.column_stack([lines.length_a, lines.length_b]))
        bending = materials.bending[lines.material, lines.direction]
        self.way = compact(materials.bending_friction[lines.material, lines.direction] / (STICK * bending) * self._arm)
        self._stiffness = compact(bending * lines.width / self._arm)

    @property
    def _arm(self) -> np.ndarray:
        """(B,) m, mean of the arms at rest."""
        return np.asarray(self._rest.mean(axis=1))

    @property
    def corners(self) -> np.ndarray:
        """(7 B,) int32, NO_PARTICLE for the second particle of an arm that ends at one."""
        corners = self._points.copy()
        corners[:, 2:5:2][self._weights == 0.0] = NO_PARTICLE
        return corners.ravel()

    @property
    def between(self) -> np.ndarray:
        """(B,4) of `Gauge`."""
        return between(self._points[:, :1])

    @cached_property
    def arguments(self) -> tuple[BendElements]:
        """What `write_bend` takes before sliders, positions, velocities and out."""
        shortest = np.vstack([SHORTEST * self._rest.T, LEAST_NORMAL * self._arm**2])
        return (BendElements(self._points, floats(self._weights), floats(shortest), floats(self._stiffness), floats(self.way)),)

    def write_rows(self, slots: LatticeSlots, out: np.ndarray) -> None:
        """Into out (4,S), of the lines centred at each slot: B w/l [N.m] and d l [rad] of the weft, of the warp; for lines whose arms are lattice
        neighbours."""
        at = slots.slot[self._points[:, 0]]
        for k, axis in enumerate((WEFT, WARP)):
            mine = self._direction == axis
            out[2 * k, at[mine]], out[2 * k + 1, at[mine]] = self._stiffness[mine], self.way[mine]

    def slack(self) -> np.ndarray:
        return np.zeros(len(self.way))

    def gauge(self, positions: np.ndarray) -> Gauge:
        curve = np.where(self._direction == WEFT, CURVES.index("weft bending"), CURVES.index("warp bending"))
        return Gauge(self.strain(positions), self.way, curve, self._points[:, 0], self.between)

    def write_forces(self, positions: np.ndarray, velocities: np.ndarray, out: np.ndarray, sliders: np.ndarray | None = None) -> None:
        write_bend(*self.arguments, self.slack() if sliders is None else sliders, positions, velocities, out)

    def _arms(self, positions: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        center, a0, a1, b0, b1 = picked(positions, self._points[:, :5])
        weight_a, weight_b = self._weights[:, :1], self._weights[:, 1:]
        return center - (1.0 - weight_a) * a0 - weight_a * a1, (1.0 - weight_b) * b0 + weight_b * b1 - center

    def _angle_and_arms(self, positions: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        arm_a, arm_b = self._arms(positions)
        angle = arctan2(lengths(np.cross(arm_a, arm_b)), dots(arm_a, arm_b))
        arms = np.column_stack([lengths(arm_a), lengths(arm_b)])
        return angle, np.maximum(arms, SHORTEST * self._rest)

    def strain(self, positions: np.ndarray) -> np.ndarray:
        """r (B,) [rad]."""
        arm_a, arm_b = self._arms(positions)
        before, behind = picked(positions, self._points[:, 5:])
        normal = np.cross(arm_a + arm_b, behind - before)
        normal /= np.maximum(lengths(normal), LEAST_NORMAL * self._arm**2)[:, None]
        a, b = (arm / np.maximum(lengths(arm), SHORTEST * rest)[:, None] for arm, rest in ((arm_a, self._rest[:, 0]), (arm_b, self._rest[:, 1])))
        half = 0.5 * self._angle_and_arms(positions)[0]
        return np.asarray(dots(normal, b - a) / np.sinc(half / np.pi))

    def energy(self, positions: np.ndarray, sliders: np.ndarray | None = None) -> float:
        angle, _ = self._angle_and_arms(positions)
        return stored(self._stiffness, self.strain(positions), self.slack() if sliders is None else sliders, self.way, angle)

    def write_stiffness_across(self, positions: np.ndarray, out: np.ndarray) -> None:
        self.write_stiffness(positions, out)

    def write_stiffness(self, positions: np.ndarray, out: np.ndarray) -> None:
        # |dt/d(end of arm)| = 1/|arm|, and at the centre the sum of both; (1 + t) covers the curvature of t
        angle, arms = self._angle_and_arms(positions)
        weight = self._weights
        a, b = 1.0 / arms[:, 0], 1.0 / arms[:, 1]
        none = np.zeros(len(a))
        gradients = np.column_stack([a + b, a * (1.0 - weight[:, 0]), a * weight[:, 0], b * (1.0 - weight[:, 1]), b * weight[:, 1], none, none])
        stiffness = self._stiffness * np.where(self.way > 0.0, 1.0 + STICK, 1.0)
        out[:] = (gradients * (stiffness * (1.0 + angle) * 2.0 * (a + b))[:, None]).ravel()


def across_lines(lines: BendLines) -> np.ndarray:
    """(B,2) particles before and behind the centre of each line across it: the nearer ends of the arms of the other line at the same centre, so ordered that
    line x across points to the right side of the fabric; the centre itself where there is no such line."""
    ends = np.column_stack([
        np.where(weight < 0.5, arm[:, 0], arm[:, 1]) for arm, weight in ((lines.arm_a, lines.weight_a), (lines.arm_b, lines.weight_b))
    ])  # fmt: skip
    found = np.column_stack([lines.center, lines.center])
    for direction, other in ((WEFT, WARP), (WARP, WEFT)):
        mine, across = np.flatnonzero(lines.direction == direction), np.flatnonzero(lines.direction == other)
        _, here, there = np.intersect1d(lines.center[mine], lines.center[across], return_indices=True)
        pair = ends[across[there]]
        found[mine[here]] = pair if direction == WEFT else pair[:, ::-1]
    return found
