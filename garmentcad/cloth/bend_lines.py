"""Bend lines: three points along warp or weft at every lattice particle; where a neighbour is missing the line ends on the contour.

A line's energy is B width t^2/(2 mean arm) with t its turning angle, so that it stands for the area width x mean arm. That area is the particle's
tributary area: a quarter of each cell, and the strip beyond the last lattice points in whole. (Widths taken across the line alone miss half of every
arm that ends on the contour and count the corners of the stair twice: up to 20 % on a strip of 50 mm at 10 mm.) Beside a seam the half of the arm next to the
sew line belongs to the seam's hinge and is left out.

A fold is a contour with cloth on both sides: lines end there, and bending over it is its hinge's.

A point on a chord lies below a surface that curves along the chord, which adds to the turning angle. The width of such a line is reduced so that its
energy is right in the mean over all directions of a cylinder.
"""

from __future__ import annotations

import numpy as np
import shapely
from scipy.spatial import cKDTree

from garmentcad.arrays import floats, indices
from garmentcad.cloth.cloth import WARP, WEFT, BendLines
from garmentcad.cloth.panel_mesh import PanelMesh, neighbors
from garmentcad.geometry.angle import arctan2
from garmentcad.geometry.triangle import signed_areas
from garmentcad.units import MM_TO_M

_STEPS = ((-1, 0), (1, 0), (0, -1), (0, 1))  # arms: weft a, weft b, warp a, warp b
_ARMS = {WEFT: (0, 1), WARP: (2, 3)}
_LONGEST_ARM = 2.0  # of the grid; a contour that runs nearly along the line is met farther out, and such a line is left out
_REACH = 2.0  # of the grid: how far area without a line of its own may be given to another
_PARTS = 4  # into which each side of a border triangle is cut to see whose area it is
_CHUNK = 4_000_000  # entries of a table of rays by segments


def bend_lines(mesh: PanelMesh) -> BendLines:
    """Bend lines of one panel in the panel's own numbering, material row 0. Weft lines first, then warp lines, each in the order of the particles."""
    length, arm, weight, on_seam = _arms(mesh)
    exists = length <= _LONGEST_ARM * mesh.spacing
    parts = []
    for number, (a, b) in _ARMS.items():
        center = np.flatnonzero(exists[:, a] & exists[:, b])
        area = _tributary_areas(mesh, center)[center]
        whole, counted = (_extent(mesh, length[center], arm[center], seam[center], (a, b)) for seam in (np.zeros_like(on_seam), on_seam))
        mean_arm = 0.5 * (length[center, a] + length[center, b])
        width = area * counted / whole / mean_arm / _excess(mesh, length[center], arm[center], weight[center], number)
        fields = (center, arm[center, a], weight[center, a], arm[center, b], weight[center, b], length[center, a], length[center, b], width)
        parts.append((*fields, np.full(len(center), number)))
    center, arm_a, weight_a, arm_b, weight_b, length_a, length_b, width, direction = (np.concatenate(column) for column in zip(*parts))
    return BendLines(
        center=indices(center),
        arm_a=indices(arm_a),
        weight_a=floats(weight_a),
        arm_b=indices(arm_b),
        weight_b=floats(weight_b),
        length_a=floats(length_a * MM_TO_M),
        length_b=floats(length_b * MM_TO_M),
        width=floats(width * MM_TO_M),
        direction=indices(direction),
        material=np.zeros(len(center), dtype=np.int32),
    )


def _arms(mesh: PanelMesh) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """For each lattice point and arm: length (n,4) in mm, the two points (n,4,2) and the weight (n,4) of the second, and whether it ends on a seam (n,4)."""
    count = mesh.lattice_count
    length = np.full((count, 4), float(mesh.spacing))
    arm = np.empty((count, 4, 2), dtype=np.int64)
    weight = np.zeros((count, 4))
    on_seam = np.zeros((count, 4), dtype=bool)
    sewn = np.append(mesh.contour.sewn, np.ones(len(mesh.contour.fold_segments[0]), dtype=bool))
    for k, step in enumerate(_STEPS):
        # Both lattice points of a pair lie half a grid from the contour: it cannot pass between them. A fold can, just half-way.
        other = neighbors(mesh.place, step)
        other[_across_folds(mesh, other)] = -1
        arm[:, k, :] = other[:, None]
        alone = np.flatnonzero(other < 0)
        length[alone, k], segment, weight[alone, k] = _cast(mesh, alone, step)
        arm[alone, k, :] = mesh.walls[segment]
        on_seam[alone, k] = sewn[segment]
    return length, arm, weight, on_seam


def _across_folds(mesh: PanelMesh, other: np.ndarray) -> np.ndarray:
    """Lattice points between which and their neighbours `other` (n,), -1 for none, a fold runs."""
    folds = shapely.linestrings(mesh.points[mesh.contour.fold_segments[0] + mesh.lattice_count])
    paired = np.flatnonzero(other >= 0)
    ways = shapely.linestrings(np.stack([mesh.points[paired], mesh.points[other[paired]]], axis=1))
    return np.unique(paired[shapely.STRtree(folds).query(ways, predicate="intersects")[0]])


def _cast(mesh: PanelMesh, start: np.ndarray, step: tuple[int, int]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """From lattice points `start` along a lattice direction: distance to the contour, the segment met, and the fraction along that segment.

    A segment holds one of its ends for this purpose, so that a line through a contour point meets exactly one of the two segments.
    """
    axis = 0 if step[0] else 1
    sign = step[axis]
    ends = mesh.points[mesh.walls]
    (along_a, along_b), (across_a, across_b) = ends[:, :, axis].T, ends[:, :, 1 - axis].T
    distance, segment, place = np.full(len(start), np.inf), np.zeros(len(start), dtype=np.int64), np.zeros(len(start))
    rows = max(1, _CHUNK // len(ends))
    for first in range(0, len(start), rows):
        chosen = slice(first, min(first + rows, len(start)))
        along, across = mesh.points[start[chosen], axis][:, None], mesh.points[start[chosen], 1 - axis][:, None]
        ray, which = np.nonzero((across_a <= across) != (across_b <= across))
        fraction = (across[ray, 0] - across_a[which]) / (across_b[which] - across_a[which])
        away = sign * (along_a[which] + fraction * (along_b[which] - along_a[which]) - along[ray, 0])
        ahead = away > 0.0
        ray, which, fraction, away = ray[ahead], which[ahead], fraction[ahead], away[ahead]
        order = np.lexsort((away, ray))
        nearest = order[np.unique(ray[order], return_index=True)[1]]
        distance[first + ray[nearest]], segment[first + ray[nearest]], place[first + ray[nearest]] = away[nearest], which[nearest], fraction[nearest]
    return distance, segment, place


def _extent(mesh: PanelMesh, length: np.ndarray, arm: np.ndarray, on_seam: np.ndarray, arms: tuple[int, int]) -> np.ndarray:
    """Length along the line that it stands for: half a grid toward a neighbour, the whole arm to a free contour, half of it to a seam."""
    total = np.zeros(len(length))
    for k in arms:
        to_contour = arm[:, k, 0] >= mesh.lattice_count
        total += np.where(to_contour, np.where(on_seam[:, k], 0.5, 1.0) * length[:, k], 0.5 * mesh.spacing)
    return total


def _excess(mesh: PanelMesh, length: np.ndarray, arm: np.ndarray, weight: np.ndarray, direction: int) -> np.ndarray:
    """Mean over the directions f of a cylinder of the squared turning angle of each line, over that of a line whose ends lie on the surface.

    Along a line at angle 0 the angle is k (m cos^2 f + sum_i s_i cos^2(f - p_i)): k the curvature, m the mean arm, p_i the angle of chord i to the line,
    s_i = w (1 - w) chord^2/(2 arm), as the point at fraction w of a chord lies w (1 - w) chord^2/2 k cos^2(f - p_i) below the surface. The mean
    of cos^2 f cos^2(f - p) is 1/4 + cos(2p)/8.
    """
    a, b = _ARMS[direction]
    sags, angles = [], []
    for k in (a, b):
        chord = mesh.points[arm[:, k, 1]] - mesh.points[arm[:, k, 0]]
        sags.append(weight[:, k] * (1.0 - weight[:, k]) * np.sum(chord**2, axis=1) / (2.0 * length[:, k]))
        angles.append(arctan2(chord[:, 1], chord[:, 0]) - (0.0 if direction == WEFT else 0.5 * np.pi))
    terms = [(0.5 * (length[:, a] + length[:, b]), np.zeros(len(length))), *zip(sags, angles)]
    mean = sum(s * t * (0.25 + np.cos(2.0 * (p - q)) / 8.0) for s, p in terms for t, q in terms)
    return mean / (0.375 * terms[0][0] ** 2)


def _tributary_areas(mesh: PanelMesh, lined: np.ndarray) -> np.ndarray:
    """(n,) area in mm2 of each lattice point among those that have a line: its quarter of each cell, and of the strip what is nearest to it.

    Border triangles are cut into _PARTS x _PARTS like ones, whose areas go where their middle lies. (A triangle shared by its corners on the lattice depends on
    which diagonal the mesh happened to take: rows of a narrow strip then had 0.5 to 1.5 times their area.) A point without a line gives its quarters to the
    nearest that has one, within two grids, as does the strip.
    """
    count = mesh.lattice_count
    areas = np.bincount(mesh.cells.ravel(), minlength=count) * (0.25 * mesh.spacing**2)
    has_line = np.zeros(count, dtype=bool)
    has_line[lined] = True
    middles = np.einsum("kc,tcx->tkx", _middles(_PARTS), mesh.points[mesh.triangles])
    strip = np.repeat(signed_areas(mesh.points, mesh.triangles) / _PARTS**2, _PARTS**2)
    loose = np.concatenate([mesh.points[:count][~has_line], middles.reshape(-1, 2)])
    loose_areas = np.concatenate([areas[~has_line], strip])
    areas[~has_line] = 0.0
    if len(lined) and len(loose):
        distance, nearest = cKDTree(mesh.points[lined]).query(loose)
        near = distance <= _REACH * mesh.spacing
        areas += np.bincount(lined[nearest[near]], weights=loose_areas[near], minlength=count)
    return areas


def _middles(parts: int) -> np.ndarray:
    """(parts^2,3) barycentric middles of the like triangles into which a triangle is cut."""
    upright = [(i + 1 / 3, j + 1 / 3) for i in range(parts) for j in range(parts - i)]
    turned = [(i + 2 / 3, j + 2 / 3) for i in range(parts) for j in range(parts - i - 1)]
    first = np.array(upright + turned) / parts
    return np.column_stack([first, 1.0 - first.sum(axis=1)])
