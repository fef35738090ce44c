"""Closed polygons in the plane, (N,2) without repeating the first point. Millimetres."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely

from garmentcad.geometry.curve import Curve

_SAME = 1e-6  # mm: crossings are found to within it, so that rounding never gets in the way of an outline that runs back along itself


def loop_points(curves: Sequence[Curve], tolerance_mm: float = 0.1) -> np.ndarray:
    """Polygon (N,2) of a closed loop of curves (each ends where the next starts), within `tolerance_mm` of it."""
    return np.concatenate([curve.polyline(tolerance_mm)[:-1] for curve in curves])


def signed_area(points: np.ndarray) -> float:
    """Area of a polygon (shoelace), positive when counter-clockwise; origin at the first point, so that far polygons lose no digits."""
    x, y = (points - points[0]).T
    return 0.5 * float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))


def crossing_point(points: np.ndarray) -> tuple[float, float] | None:
    """A point where the outline of a polygon crosses or touches itself, or None for a simple polygon."""
    ring = shapely.LinearRing(points)
    if ring.is_simple:
        return None
    # An overlay of the ring with itself cuts it at every crossing: a point where more than two pieces meet, or a stretch run twice, is the fault.
    noded = shapely.get_parts(shapely.union_all([ring], grid_size=_SAME))
    met: dict[tuple[float, ...], int] = {}
    for line in noded:
        for end in (line.coords[0], line.coords[-1]):
            met[end] = met.get(end, 0) + 1
    crossing = [end for end, count in met.items() if count > 2]
    first = crossing[0] if crossing else points[0]
    return float(first[0]), float(first[1])
