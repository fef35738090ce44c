"""Fold lines as chains of points: cells end there as at a contour, and cloth folds over the chain as over a seam. Millimetres."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import shapely

from garmentcad.arrays import indices
from garmentcad.cloth.seam_match import part_count
from garmentcad.pattern.pattern import FoldLine

_SAME_MM = 0.01  # nearer points are one


def fold_chains(
    folds: tuple[FoldLine, ...], contour_mm: np.ndarray, polygon: shapely.Polygon, grid_mm: float
) -> tuple[np.ndarray, tuple[tuple[int, np.ndarray], ...]]:
    """Points (N,2) of the folds of a panel beside those of its contour (M,2), and chains: number of the fold and its points, numbered from the contour's on.

    Only what lies inside the panel (polygon) folds, nothing along its outline. Chains have points at the corners of fold lines, where folds cross, and where
    they meet points of the contour, no farther apart than the grid.
    """
    lines = [shapely.LineString(fold.points_mm) for fold in folds]
    points: list[np.ndarray] = [*contour_mm]
    chains: list[tuple[int, np.ndarray]] = []

    def number_of(place: np.ndarray) -> int:
        if shapely.distance(polygon.boundary, shapely.Point(place)) < _SAME_MM:
            return int(np.argmin(np.linalg.norm(contour_mm - place, axis=1)))
        near = np.flatnonzero(np.linalg.norm(np.array(points) - place, axis=1) < _SAME_MM)
        if len(near) == 0:
            points.append(place)
        return int(near[0]) if len(near) else len(points) - 1

    for number, line in enumerate(lines):
        met = [shapely.intersection(line, other) for k, other in enumerate(lines) if k != number and line.intersects(other)]
        for part in shapely.get_parts(shapely.intersection(line, polygon)):
            if part.length < _SAME_MM:
                continue
            marks = np.unique([0.0, part.length, *(part.project(shapely.Point(xy)) for xy in [*part.coords, *shapely.get_coordinates(met)])])
            marks = marks[np.append(True, np.diff(marks) > _SAME_MM)]
            touched = part.project(shapely.points(contour_mm[shapely.distance(shapely.points(contour_mm), part) < _SAME_MM]))
            marks = np.union1d(marks, [at for at in touched if np.abs(marks - at).min() > _SAME_MM])
            chain: list[int] = []
            for a, b in pairwise(marks):
                if part.interpolate(0.5 * (a + b)).distance(polygon.boundary) < _SAME_MM:  # along the outline nothing folds
                    chains += [(number, indices(chain))] if chain else []
                    chain = []
                    continue
                at = shapely.get_coordinates(part.interpolate(np.linspace(a, b, part_count(b - a, grid_mm) + 1)))
                chain += [number_of(place) for place in at[1 if chain else 0 :]]
            chains += [(number, indices(chain))] if chain else []
    return np.array(points[len(contour_mm) :]).reshape(-1, 2), tuple(chains)
