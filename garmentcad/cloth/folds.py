"""Fold lines on the lattice: which bend lines and cells a fold crosses, and where it puts them.

A panel folded by an angle along a line is, on a lattice, a piece of a cylinder two cells wide (two grids along the grain, 2.8 where it runs on the bias),
flat on either side of it: on a narrower one chords would be shorter than the cloth between their ends by more than a tenth. What a bend line or a cell of the
folded panel shows is its rest turn and its rest twist (`ForceFold`). Each element is taken by the points that its law knows of, as distances along and across
the fold.
"""

from __future__ import annotations

from typing import NamedTuple, TypeAlias

import numpy as np
import shapely

from garmentcad.arrays import floats, indices
from garmentcad.cloth.cloth import WARP, WEFT, BendLines, ContourSpans, Folds
from garmentcad.cloth.panel_mesh import PanelMesh, to_grain
from garmentcad.pattern.pattern import FoldLine
from garmentcad.units import MM_TO_M

WIDTH = 2.0  # of a fold, in cells measured across it
WIDEST = WIDTH * np.sqrt(2.0)  # of a fold, in grids


_Crossed: TypeAlias = tuple[int, float, np.ndarray, np.ndarray, np.ndarray, np.ndarray]
"""Number and width (mm) of a fold, rows of the elements that it crosses, weights, shares, places in mm."""


class _Strip(NamedTuple):
    """One straight stretch of a fold, in weft and warp mm: its middle, the unit vector along it, half its length and half its width."""

    middle: np.ndarray
    along: np.ndarray
    half_length: float
    half_width: float

    @property
    def across(self) -> np.ndarray:
        return np.array([-self.along[1], self.along[0]])

    @property
    def polygon(self) -> shapely.Polygon:
        a, c = self.half_length * self.along, self.half_width * self.across
        return shapely.Polygon(self.middle + np.array([-a - c, a - c, a + c, -a + c]))


def panel_folds(mesh: PanelMesh, bends: BendLines, fold_lines: tuple[FoldLine, ...], grain_deg: float) -> Folds:
    """Folds of one panel, elements and folds in the panel's own numbering."""
    lines: list[_Crossed] = []
    cells: list[_Crossed] = []
    for number, fold in enumerate(fold_lines):
        for strip in _strips(to_grain(fold.points_mm, grain_deg), mesh.spacing):
            lines.append(_lines_across(mesh, bends, strip, number))
            cells.append(_cells_across(mesh, strip, number))
    return Folds(*_columns(lines, 9), *_columns(cells, 4))


def strengthened(folds: Folds, factor: np.ndarray, bends: BendLines, twist_area: np.ndarray) -> tuple[BendLines, np.ndarray]:
    """Bend lines and twist areas with bending `factor` (F,) times as stiff within the folds."""
    line = np.bincount(folds.line, folds.line_share * (factor[folds.line_fold] - 1.0), len(bends.width))
    cell = np.bincount(folds.cell, folds.cell_share * (factor[folds.cell_fold] - 1.0), len(twist_area))
    return bends._replace(width=floats(bends.width * (1.0 + line))), floats(twist_area * (1.0 + cell))


def held(folds: Folds, count: int) -> np.ndarray:
    """(B,) part of the bending friction that acts in each of `count` lines: none within a fold. There cloth is bent far beyond where friction slips, over a few
    thicknesses and not over cells; smeared over those it would hold tens of degrees. An estimate."""
    return floats(1.0 - np.minimum(1.0, np.bincount(folds.line, folds.line_share, count)))


def spans_beside(mesh: PanelMesh, spans: ContourSpans, fold_lines: tuple[FoldLine, ...], grain_deg: float) -> ContourSpans:
    """Spans that no fold crosses: a fold is a saw tooth to them."""
    strips = [strip.polygon for fold in fold_lines for strip in _strips(to_grain(fold.points_mm, grain_deg), mesh.spacing)]
    if not strips or len(spans.corners) == 0:
        return spans
    keep = ~shapely.intersects(shapely.linestrings(mesh.points[spans.corners]), shapely.union_all(strips))
    return ContourSpans(*(column[keep] for column in spans))


def _strips(points: np.ndarray, grid: float) -> list[_Strip]:
    """Stretches of a polyline; its two ends go on by a grid, so that a fold that ends on the contour covers the corner beside it."""
    points = points[np.append(True, np.any(points[1:] != points[:-1], axis=1))]
    steps = np.diff(points, axis=0)
    lengths = np.linalg.norm(steps, axis=1)
    along = steps / lengths[:, None]
    points = points.copy()
    points[0] -= grid * along[0]
    points[-1] += grid * along[-1]
    half_width = 0.5 * WIDTH * grid * np.abs(along).sum(axis=1)
    return [_Strip(0.5 * (a + b), t, 0.5 * float(np.linalg.norm(b - a)), float(w)) for a, b, t, w in zip(points[:-1], points[1:], along, half_width)]


def _lines_across(mesh: PanelMesh, bends: BendLines, strip: _Strip, fold: int) -> _Crossed:
    """Bend lines with points on both sides of an edge of a strip or on it: row, part of it along the fold, share of it in the fold, places (N,9,2)."""
    other = crossing_lines(bends, len(mesh.points))
    places = (mesh.points[line_corners(bends, other)] - strip.middle) @ np.column_stack([strip.along, strip.across])
    along, across = places[:, :5, 0], places[:, :5, 1]
    row = np.flatnonzero((other >= 0) & (across.min(axis=1) < strip.half_width) & (across.max(axis=1) > -strip.half_width))
    weight = _covered(along[row].min(axis=1), along[row].max(axis=1), strip.half_length)
    share = _covered(across[row].min(axis=1), across[row].max(axis=1), strip.half_width)
    used = weight > 0.0
    return fold, 2.0 * strip.half_width, row[used], weight[used], (weight * share)[used], places[row][used]


def _covered(low: np.ndarray, high: np.ndarray, half: float) -> np.ndarray:
    """Part of the interval [low, high] within [-half, half]; of a point 0 or 1."""
    inside = np.minimum(high, half) - np.maximum(low, -half)
    return np.where(high > low, np.maximum(inside, 0.0) / np.maximum(high - low, 1e-9), inside >= 0.0)


def _cells_across(mesh: PanelMesh, strip: _Strip, fold: int) -> _Crossed:
    """Cells that a strip covers in part, as `_lines_across`; places (M,4,2)."""
    places = (mesh.points[mesh.cells] - strip.middle) @ np.column_stack([strip.along, strip.across])
    along, across = places[..., 0], places[..., 1]
    row = np.flatnonzero((across.min(axis=1) < strip.half_width) & (across.max(axis=1) > -strip.half_width))
    weight = _covered(along[row].min(axis=1), along[row].max(axis=1), strip.half_length)
    share = _covered(across[row].min(axis=1), across[row].max(axis=1), strip.half_width)
    used = weight > 0.0
    return fold, 2.0 * strip.half_width, row[used], weight[used], (weight * share)[used], places[row][used]


def line_corners(bends: BendLines, other: np.ndarray) -> np.ndarray:
    """(B,9) points of each line: centre, arm a (two), arm b (two), and both ends (of two) of the line `other` (B,) that crosses it."""
    return np.column_stack([bends.center, bends.arm_a, bends.arm_b, bends.arm_a[other], bends.arm_b[other]])


def line_weights(bends: BendLines, other: np.ndarray) -> np.ndarray:
    """(B,4) weight of the second of the two points of arm a, arm b, and both ends of the line across."""
    return np.column_stack([bends.weight_a, bends.weight_b, bends.weight_a[other], bends.weight_b[other]])


def crossing_lines(bends: BendLines, count: int) -> np.ndarray:
    """(B,) row of the bend line of the other direction with the same centre, -1 where there is none; count: of points."""
    row = np.full((2, count), -1)
    row[bends.direction, bends.center] = np.arange(len(bends.center))
    return row[WARP + WEFT - bends.direction, bends.center]


def _columns(parts: list[_Crossed], points: int) -> tuple[np.ndarray, ...]:
    """Rows, folds, widths in m, weights, shares, and places in m."""
    counts = [len(part[2]) for part in parts]
    rows, weight, share = (np.concatenate([np.empty(0), *(part[k] for part in parts)]) for k in (2, 3, 4))
    folds, widths = (np.repeat(np.array([part[k] for part in parts], dtype=np.float64), counts) for k in (0, 1))
    places = np.concatenate([np.empty((0, points, 2)), *(part[5] for part in parts)])
    return indices(rows), indices(folds), floats(widths * MM_TO_M), floats(weight), floats(share), floats(places * MM_TO_M)
