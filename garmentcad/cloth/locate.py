"""Where points of a panel lie on its triangles."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.spatial import cKDTree

from garmentcad.cloth.cloth import Cloth
from garmentcad.errors import SpecError

_NEAREST = 16  # triangles around a point among which the one that holds it is looked for
_BESIDE = 0.2  # of a triangle, that a curved contour may lie outside its chord
_CORNER = 1e-6  # of a triangle: a point this near to a corner is the corner


class Located(NamedTuple):
    """Points as weighted means of three vertices (N,3) int; weights (N,3) sum up to 1, and are negative outside the triangle."""

    vertices: np.ndarray
    weights: np.ndarray


def located(cloth: Cloth, panel: int, points_mm: np.ndarray) -> Located:
    """Points (N,2), panel mm, on the triangles of a panel. A point beside the chords of a curved contour continues the nearest triangle."""
    triangles = cloth.triangles[cloth.vertex_panel[cloth.triangles[:, 0]] == panel]
    corners = cloth.vertex_uv_mm[triangles]
    near = cKDTree(corners.mean(axis=1)).query(points_mm, k=min(_NEAREST, len(triangles)))[1].reshape(len(points_mm), -1)
    weights = _barycentric(points_mm[:, None, :], corners[near])
    best, rows = np.argmax(weights.min(axis=2), axis=1), np.arange(len(points_mm))
    found, held = near[rows, best], weights[rows, best]
    for k in np.flatnonzero(held.min(axis=1) < -_BESIDE).tolist():  # a long triangle holds it, whose middle lies farther than those of many small ones
        every = _barycentric(points_mm[k], corners)
        found[k] = np.argmax(every.min(axis=1))
        held[k] = every[found[k]]
    return Located(triangles[found], held)


class Anchors(NamedTuple):
    """Points of a cloth that something holds: particles (N,3) int32 and weights (N,3), which sum up to 1."""

    particles: np.ndarray
    weights: np.ndarray


def anchors(cloth: Cloth, panel: str, points_mm: np.ndarray) -> Anchors:
    """Points (N,2), panel mm, inside a panel or on its outline. One that is a vertex has that vertex alone. SpecError for a point that lies elsewhere."""
    place = located(cloth, cloth.panel_names.index(panel), points_mm)
    outside = np.flatnonzero(place.weights.min(axis=1) < -_BESIDE)
    if len(outside):
        u, v = points_mm[outside[0]]
        raise SpecError(f"({u:.1f}, {v:.1f}) mm lies outside the panel; a point that is held lies on its cloth", key=f"panels.{panel}")
    weights = np.clip(place.weights, 0.0, None)
    weights[weights < _CORNER] = 0.0
    return Anchors(cloth.vertex_particle[place.vertices], weights / weights.sum(axis=1, keepdims=True))


def _barycentric(points: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """Weights (...,3) of points (...,2) in triangles (...,3,2), broadcast against each other."""
    a, b, c = corners[..., 0, :], corners[..., 1, :], corners[..., 2, :]
    ab, ac, ap = b - a, c - a, points - a
    area = ab[..., 0] * ac[..., 1] - ab[..., 1] * ac[..., 0]
    v = (ap[..., 0] * ac[..., 1] - ap[..., 1] * ac[..., 0]) / area
    w = (ab[..., 0] * ap[..., 1] - ab[..., 1] * ap[..., 0]) / area
    return np.stack([1.0 - v - w, v, w], axis=-1)
