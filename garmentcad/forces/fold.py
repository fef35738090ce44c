"""Fold lines: the moment that holds a fold, beside the elastic bending and twist of the same cloth.

Bending toward a rest turn t0 costs B w |T - t0 e|^2/(2 l), T = t (a x b)/sin(t) the turn of the line as a vector (a, b the directions of its arms), e the
direction of the line that crosses it at its centre (warp for a weft line; along weft, with the other sign, for a warp line); a cell twisted toward kappa0 costs
A (4 D66) (kappa - kappa0)^2/2. Bending and twist themselves stand in bend.py and twist.py; what is left to add is linear in t0 and kappa0:

    E = -K t0 (T.e) + K t0^2/2,  K = B w/l  [J]          E = -A (4 D66) (kappa kappa0 - kappa0^2/2)  [J]

so that internal friction and everything else in those laws is untouched by a fold. T has no direction where a line is folded flat onto itself: t/sin(t)
fades so as to stay below G = 12, its value at 165 degrees. Source: rest curvature of a plate, moment B (kappa - kappa0).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from garmentcad.arrays import floats, indices, kernel, long_kernel
from garmentcad.cloth.cloth import WEFT, Cloth
from garmentcad.cloth.folds import crossing_lines, line_corners, line_weights
from garmentcad.fabric.material import MaterialTable
from garmentcad.forces.bend import LEAST_SINE, SHORTEST
from garmentcad.forces.force import NO_PARTICLE, OneLaw
from garmentcad.forces.rows import PART
from garmentcad.forces.smooth import angle_over_sine
from garmentcad.forces.twist import LEAST_NORMAL

_LARGEST_GAIN = 12.0  # of t/sin(t), which it has at 165 degrees
_SMALL2 = 1e-3  # squared sine below which a series stands for a difference that would cancel
_FLAT = 1e-9  # rad
CORNERS = 9


class FoldElements(NamedTuple):
    """Lines first, then cells. Corners of a line: centre, arm a (two), arm b (two), the two ends (of two) of the line across; of a cell: 00, 10, 11, 01."""

    corners: np.ndarray  # (N,9) int32
    weights: np.ndarray  # (N,4) weight of the second particle of arm a, arm b, first end, second end
    shortest: np.ndarray  # (N,3) least length of arm a, arm b and the line across, m; of a cell: least normal, m2
    moment: np.ndarray  # (N,) K t0 with its sign, N.m; of a cell: A 4 D66 kappa0/h^2, N
    lines: int


@kernel
def _between(positions, first, second, weight, axis):  # type: ignore[no-untyped-def]
    return positions[first, axis] + weight * (positions[second, axis] - positions[first, axis])


@kernel
def _share(out, k, weight, fx, fy, fz):  # type: ignore[no-untyped-def]
    """A force at a place between the two particles of corners k and k + 1."""
    rest = 1.0 - weight
    out[k, 0], out[k, 1], out[k, 2] = rest * fx, rest * fy, rest * fz
    out[k + 1, 0], out[k + 1, 1], out[k + 1, 2] = weight * fx, weight * fy, weight * fz


@kernel
def gain_and_slope(cosine, over_sine, sine2):  # type: ignore[no-untyped-def]
    """g = t/sin(t), faded to g/(1 + (g/G)^4)^(1/4), and its derivative by cos(t); that of g is -(1 - t cot(t))/sin(t)^2."""
    fourth = (over_sine / _LARGEST_GAIN) ** 4
    fade = (1.0 + fourth) ** -0.25
    if cosine > 0.0 and sine2 < _SMALL2:
        slope = -(1.0 / 3.0 + 2.0 / 15.0 * sine2)
    else:
        slope = -(1.0 - over_sine * cosine) / max(sine2, _FLAT * _FLAT)
    return over_sine * fade, slope * fade / (1.0 + fourth)


@kernel
def _hold_line(i, folds, x, out):  # type: ignore[no-untyped-def]
    c, w = folds.corners[i], folds.weights[i]
    ax, ay, az = x[c[0], 0] - _between(x, c[1], c[2], w[0], 0), x[c[0], 1] - _between(x, c[1], c[2], w[0], 1), x[c[0], 2] - _between(x, c[1], c[2], w[0], 2)
    bx, by, bz = _between(x, c[3], c[4], w[1], 0) - x[c[0], 0], _between(x, c[3], c[4], w[1], 1) - x[c[0], 1], _between(x, c[3], c[4], w[1], 2) - x[c[0], 2]
    ex, ey, ez = (
        _between(x, c[7], c[8], w[3], 0) - _between(x, c[5], c[6], w[2], 0),
        _between(x, c[7], c[8], w[3], 1) - _between(x, c[5], c[6], w[2], 1),
        _between(x, c[7], c[8], w[3], 2) - _between(x, c[5], c[6], w[2], 2),
    )
    on_a = 1.0 / max(math.sqrt(ax * ax + ay * ay + az * az), folds.shortest[i, 0])
    on_b = 1.0 / max(math.sqrt(bx * bx + by * by + bz * bz), folds.shortest[i, 1])
    on_e = 1.0 / max(math.sqrt(ex * ex + ey * ey + ez * ez), folds.shortest[i, 2])
    ax, ay, az, bx, by, bz, ex, ey, ez = on_a * ax, on_a * ay, on_a * az, on_b * bx, on_b * by, on_b * bz, on_e * ex, on_e * ey, on_e * ez
    ux, uy, uz = ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx
    sx, sy, sz = ax + bx, ay + by, az + bz
    half = max(0.5 * math.sqrt(sx * sx + sy * sy + sz * sz), 0.5 * LEAST_SINE)  # cosine of half the turn, without cancellation
    cosine, over_sine = ax * bx + ay * by + az * bz, angle_over_sine(half) / half
    gain, slope = gain_and_slope(cosine, over_sine, ux * ux + uy * uy + uz * uz)
    along = ux * ex + uy * ey + uz * ez
    m, s = folds.moment[i] * gain, folds.moment[i] * slope * along
    # derivatives of T.e by the directions: b x e, e x a and u, and what the gain adds; then square to each direction
    gx, gy, gz = m * (by * ez - bz * ey) + s * bx, m * (bz * ex - bx * ez) + s * by, m * (bx * ey - by * ex) + s * bz
    hx, hy, hz = m * (ey * az - ez * ay) + s * ax, m * (ez * ax - ex * az) + s * ay, m * (ex * ay - ey * ax) + s * az
    kx, ky, kz = m * ux, m * uy, m * uz
    on, off, far = gx * ax + gy * ay + gz * az, hx * bx + hy * by + hz * bz, kx * ex + ky * ey + kz * ez
    gx, gy, gz = on_a * (gx - on * ax), on_a * (gy - on * ay), on_a * (gz - on * az)
    hx, hy, hz = on_b * (hx - off * bx), on_b * (hy - off * by), on_b * (hz - off * bz)
    kx, ky, kz = on_e * (kx - far * ex), on_e * (ky - far * ey), on_e * (kz - far * ez)
    k = CORNERS * i
    out[k, 0], out[k, 1], out[k, 2] = gx - hx, gy - hy, gz - hz
    _share(out, k + 1, w[0], -gx, -gy, -gz)
    _share(out, k + 3, w[1], hx, hy, hz)
    _share(out, k + 5, w[2], -kx, -ky, -kz)
    _share(out, k + 7, w[3], kx, ky, kz)


@kernel
def _hold_cell(i, folds, x, out):  # type: ignore[no-untyped-def]
    a, b, c, d = folds.corners[i, 0], folds.corners[i, 1], folds.corners[i, 2], folds.corners[i, 3]
    px, py, pz, qx, qy, qz = x[c, 0] - x[a, 0], x[c, 1] - x[a, 1], x[c, 2] - x[a, 2], x[d, 0] - x[b, 0], x[d, 1] - x[b, 1], x[d, 2] - x[b, 2]
    nx, ny, nz = py * qz - pz * qy, pz * qx - px * qz, px * qy - py * qx
    inverse = 1.0 / max(math.sqrt(nx * nx + ny * ny + nz * nz), folds.shortest[i, 0])
    nx, ny, nz = inverse * nx, inverse * ny, inverse * nz
    sx, sy, sz = x[a, 0] - x[b, 0] + x[c, 0] - x[d, 0], x[a, 1] - x[b, 1] + x[c, 1] - x[d, 1], x[a, 2] - x[b, 2] + x[c, 2] - x[d, 2]
    height = nx * sx + ny * sy + nz * sz
    m = folds.moment[i]
    # as in cell.py, d(height)/dp = q x t, d(height)/dq = t x p with t = (s - height n)/|p x q|
    turn = m * inverse
    tx, ty, tz = turn * (sx - height * nx), turn * (sy - height * ny), turn * (sz - height * nz)
    nx, ny, nz = m * nx, m * ny, m * nz
    px, py, pz, qx, qy, qz = qy * tz - qz * ty, qz * tx - qx * tz, qx * ty - qy * tx, ty * pz - tz * py, tz * px - tx * pz, tx * py - ty * px
    k = CORNERS * i
    out[k, 0], out[k, 1], out[k, 2] = nx - px, ny - py, nz - pz
    out[k + 1, 0], out[k + 1, 1], out[k + 1, 2] = -nx - qx, -ny - qy, -nz - qz
    out[k + 2, 0], out[k + 2, 1], out[k + 2, 2] = nx + px, ny + py, nz + pz
    out[k + 3, 0], out[k + 3, 1], out[k + 3, 2] = qx - nx, qy - ny, qz - nz


@long_kernel
def fold_part(part, folds, positions, out):  # type: ignore[no-untyped-def]
    first = part * PART
    for i in range(first, min(len(folds.moment), first + PART)):
        if i < folds.lines:
            _hold_line(i, folds, positions, out)
        else:
            _hold_cell(i, folds, positions, out)


@kernel
def write_fold(folds, positions, velocities, out):  # type: ignore[no-untyped-def]
    """Forces on the corners of element i into out[9 i] to out[9 i + 8]."""
    for part in range(-(-len(folds.moment) // PART)):
        fold_part(np.int64(part), folds, positions, out)


class ForceFold(OneLaw):
    """Rest turn of the bend lines and rest twist of the cells of `cloth` under its folds. angles (F,): rest angle of each fold, rad; None for flat ones."""

    name = "fold"

    def __init__(self, cloth: Cloth, materials: MaterialTable, angles: np.ndarray | None = None) -> None:
        folds, bends, cells = cloth.folds, cloth.bends, cloth.cells
        angles = np.zeros(len(cloth.fold_names)) if angles is None else angles
        toward = np.where(bends.direction == WEFT, -1.0, 1.0)  # weft x warp is the right side: a weft line that turns toward it turns about minus warp
        across = crossing_lines(bends, cloth.particle_count)
        ends, weights = line_corners(bends, across), line_weights(bends, across)
        turns = turn_of(folded(folds.line_places, angles[folds.line_fold], folds.line_width), weights[folds.line])
        turn = toward * np.bincount(folds.line, np.where(angles[folds.line_fold] == 0.0, 0.0, folds.line_weight * turns), len(bends.center))
        twists = twist_of(folded(folds.cell_places, angles[folds.cell_fold], folds.cell_width))
        twist = np.bincount(folds.cell, np.where(angles[folds.cell_fold] == 0.0, 0.0, folds.cell_weight * twists), len(cells.corners)) / cells.spacing**2
        line = np.flatnonzero(turn != 0.0)
        cell = np.flatnonzero((twist != 0.0) & (materials.twist[cells.material] > 0.0))
        stiffness = materials.bending[bends.material[line], bends.direction[line]] * bends.width[line] / (0.5 * (bends.length_a + bends.length_b)[line])
        area = 4.0 * materials.twist[cells.material[cell]] * cells.twist_area[cell]
        other, h2 = across[line], cells.spacing[cell] ** 2
        rest = np.column_stack([bends.length_a[line], bends.length_b[line], bends.length_a[other] + bends.length_b[other]])
        corners = np.full((len(line) + len(cell), CORNERS), NO_PARTICLE)
        corners[: len(line)] = ends[line]
        corners[len(line) :, :4] = cells.corners[cell]
        weights = np.concatenate([weights[line], np.zeros((len(cell), 4))])
        least = np.zeros((len(corners), 3))
        least[: len(line)], least[len(line) :, 0] = SHORTEST * rest, LEAST_NORMAL * 2.0 * h2
        moment = np.concatenate([toward[line] * stiffness * turn[line], area * twist[cell] / h2])
        self._folds = FoldElements(indices(np.maximum(corners, 0)), floats(weights), floats(least), floats(moment), len(line))
        self._constant = {"bend": 0.5 * float(np.sum(stiffness * turn[line] ** 2)), "twist": 0.5 * float(np.sum(area * twist[cell] ** 2))}
        self._reach = np.column_stack([1.0 / rest[:, 0], 1.0 / rest[:, 1], 1.0 / rest[:, 2]])
        self.arguments = (self._folds,)
        slots = corners.copy()
        slots[: len(line), 2::2][weights[: len(line)] == 0.0] = NO_PARTICLE
        self.corners = indices(slots).ravel()

    def write_forces(self, positions: np.ndarray, velocities: np.ndarray, out: np.ndarray, sliders: np.ndarray | None = None) -> None:
        write_fold(*self.arguments, positions, velocities, out)

    def energies(self, positions: np.ndarray, sliders: np.ndarray | None = None) -> dict[str, float]:
        folds, count = self._folds, self._folds.lines
        place = positions[folds.corners]
        bend = self._constant["bend"] - float(np.sum(folds.moment[:count] * turn_of(place[:count], folds.weights[:count], folds.shortest[:count])))
        x00, x10, x11, x01 = (place[count:, k] for k in range(4))
        normal = np.cross(x11 - x00, x01 - x10)
        size = np.maximum(np.linalg.norm(normal, axis=1), folds.shortest[count:, 0])
        height = np.sum(normal * (x00 - x10 + x11 - x01), axis=1) / size
        return {"bend": bend, "twist": self._constant["twist"] - float(np.sum(folds.moment[count:] * height))}

    def energy(self, positions: np.ndarray, sliders: np.ndarray | None = None) -> float:
        """Both laws together [J]."""
        return sum(self.energies(positions).values())

    def write_stiffness(self, positions: np.ndarray, out: np.ndarray) -> None:
        # A moment M on an arm of length l has a tangent of about M/l^2, twice that over two arms; a fold at most t0 from where it rests needs no more.
        folds, count = self._folds, self._folds.lines
        bound = np.zeros((len(folds.moment), CORNERS))
        a, b, e = self._reach.T
        size = np.column_stack(
            [a + b, *(factor * reach for k, reach in enumerate((a, b, e, e)) for factor in (1.0 - folds.weights[:count, k], folds.weights[:count, k]))]
        )
        bound[:count] = size * (np.abs(folds.moment[:count]) * 2.0 * (a + b + e))[:, None]
        least = folds.shortest[count:, 0] / LEAST_NORMAL
        bound[count:, :4] = (8.0 * np.abs(folds.moment[count:]) / np.sqrt(0.5 * least))[:, None]
        out[:] = bound.ravel()


def folded(places: np.ndarray, angle: np.ndarray, width: np.ndarray) -> np.ndarray:
    """Points (N,K,3) of places (N,K,2), along and across, on panels folded by `angle` (N,) [rad] to the side of +z over cylinders of these widths (N,)."""
    along, across = places[..., 0], places[..., 1]
    angle, width = np.where(np.abs(angle) < _FLAT, _FLAT, angle)[:, None], width[:, None]
    radius = width / angle
    on = np.clip(across, -0.5 * width, 0.5 * width)
    lean, beyond = on / radius, across - on
    return np.stack([along, radius * np.sin(lean) + beyond * np.cos(lean), radius * (1.0 - np.cos(lean)) + beyond * np.sin(lean)], axis=-1)


def _ends_of(points: np.ndarray, weights: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Arms a and b and the line across (N,3 each) of lines of points (N,9,3) with weights (N,4), as in `FoldElements`."""
    a, b, c, d = (points[:, 2 * k + 1] + weights[:, k, None] * (points[:, 2 * k + 2] - points[:, 2 * k + 1]) for k in range(4))
    return points[:, 0] - a, b - points[:, 0], d - c


def turn_of(points: np.ndarray, weights: np.ndarray, shortest: np.ndarray | float = 0.0) -> np.ndarray:
    """T.e (N,) of lines of points (N,9,3) with weights (N,4); lengths below `shortest` (N,3) count as that."""
    lines = np.stack(_ends_of(points, weights), axis=1)
    a, b, e = np.moveaxis(lines / np.maximum(np.linalg.norm(lines, axis=2), shortest)[..., None], 1, 0)
    cross = np.cross(a, b)
    sine, cosine = np.linalg.norm(cross, axis=1), np.sum(a * b, axis=1)
    gain = np.where(sine < _FLAT, np.where(cosine > 0.0, 1.0, 1e3 * _LARGEST_GAIN), np.arctan2(sine, cosine) / np.maximum(sine, _FLAT))
    return np.asarray(gain * (1.0 + (gain / _LARGEST_GAIN) ** 4) ** -0.25 * np.sum(cross * e, axis=1))


def twist_of(points: np.ndarray) -> np.ndarray:
    """Height (M,) of cells of points (M,4,3) out of their plane: kappa h^2."""
    x00, x10, x11, x01 = (points[:, k] for k in range(4))
    normal = np.cross(x11 - x00, x01 - x10)
    return np.asarray(np.sum(normal * (x00 - x10 + x11 - x01), axis=1) / np.linalg.norm(normal, axis=1))
