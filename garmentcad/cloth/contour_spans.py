"""Contour spans: four points that follow one another along a contour. They feel the saw tooth that bend lines and seam hinges cannot see.

A bend line that ends on a chord, and a hinge over a segment, feel the mean of the chord's two ends; up and down by turns along a contour costs them
nothing. A span measures what is left of four points x_i after all that an affine map and a constant curvature along the contour make of them:

    d = sum_i c_i x_i,     sum_i c_i = 0,     sum_i c_i X_i = 0     (X_i on the panel)

c is the third difference of the points by arc length, projected onto these conditions, so that d vanishes exactly under rigid motion and uniform strain,
and under a constant curvature where the contour is straight or an arc.
"""

from __future__ import annotations

import numpy as np

from garmentcad.arrays import floats, indices
from garmentcad.cloth.cloth import ContourSpans
from garmentcad.cloth.panel_mesh import PanelMesh
from garmentcad.geometry.angle import arctan2
from garmentcad.units import MM_TO_M

_LARGEST_TURN_DEG = 30.0  # of the contour at the two middle points; a span does not reach around a corner
_UNIFORM2 = 20.0  # 1 + 9 + 9 + 1, the squared third difference of equal steps
_FLAT = 1e-6  # of the span: a bulge that is round-off


def contour_spans(mesh: PanelMesh, strip_material: np.ndarray) -> ContourSpans:
    """Spans of all loops and folds of one panel in the panel's own numbering, of the material of the border triangle (T,) over which their middle lies. None
    reaches across a fold, which is a saw tooth to it."""
    contour = mesh.contour
    after, folded = contour.segments[:, 1], contour.fold_segments[0]
    chain: list[np.ndarray] = [np.arange(len(after))]
    for _ in range(3):
        chain.append(after[chain[-1]])
    rows = np.stack(chain, axis=1)
    rows = rows[(rows[:, 0] != rows[:, 3]) & ~np.isin(rows[:, 1:3], folded).any(axis=1)]  # a triangular loop has none
    rows = np.concatenate([rows, *(np.lib.stride_tricks.sliding_window_view(points, 4) for _, points in contour.chains if len(points) > 3)])
    rows += mesh.lattice_count
    sides = np.diff(mesh.points[rows], axis=1)
    lengths = np.linalg.norm(sides, axis=2)
    turn = np.abs(arctan2(_cross(sides[:, :2], sides[:, 1:]), np.sum(sides[:, :2] * sides[:, 1:], axis=2)))
    smooth = (turn <= np.radians(_LARGEST_TURN_DEG)).all(axis=1)
    rows, lengths = rows[smooth], lengths[smooth]
    whole = mesh.points[rows[:, 3]] - mesh.points[rows[:, 0]]
    return ContourSpans(
        corners=indices(rows),
        coefficients=floats(_coefficients(mesh.points[rows], lengths)),
        length=floats(lengths.mean(axis=1) * MM_TO_M),
        along_warp=floats(whole[:, 1] / np.linalg.norm(whole, axis=1)),
        material=indices(strip_material[_over(mesh.triangles, rows[:, 1:3])]),
    )


def _over(triangles: np.ndarray, sides: np.ndarray) -> np.ndarray:
    """The triangle (N,) of which each side (N,2) is one; of two, the first."""
    width = int(triangles.max()) + 1
    keys, wanted = (np.sort(ends, axis=1).astype(np.int64) @ [width, 1] for ends in (triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), sides))
    order = np.argsort(keys, kind="stable")
    return np.asarray(order[np.searchsorted(keys[order], wanted)] // 3)


def _cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]


def _coefficients(points: np.ndarray, lengths: np.ndarray) -> np.ndarray:
    """c (N,4) for points (N,4,2) with `lengths` (N,3) between them."""
    place = np.concatenate([np.zeros((len(lengths), 1)), np.cumsum(lengths, axis=1)], axis=1)
    apart = place[:, :, None] - place[:, None, :] + np.eye(4)
    third = 1.0 / apart.prod(axis=2)  # the divided difference
    third *= np.sqrt(_UNIFORM2 / np.sum(third**2, axis=1))[:, None]
    third -= third.mean(axis=1, keepdims=True)
    x, y = np.moveaxis((points - points.mean(axis=1, keepdims=True)) / place[:, -1, None, None], 2, 0)
    turn = 0.5 * arctan2(2.0 * np.sum(x * y, axis=1), np.sum(x * x - y * y, axis=1))[:, None]  # the points lie along this direction, nearest to a line
    for way in (np.cos(turn) * x + np.sin(turn) * y, np.cos(turn) * y - np.sin(turn) * x):
        square = np.sum(way * way, axis=1, keepdims=True)
        third -= np.divide(np.sum(third * way, axis=1, keepdims=True), square, out=np.zeros_like(square), where=square > _FLAT * _FLAT) * way
    return third
