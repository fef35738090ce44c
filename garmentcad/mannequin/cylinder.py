"""Arrangement cylinders around the points of a body part."""

from __future__ import annotations

import numpy as np

from garmentcad.geometry.portable import norm, product
from garmentcad.mannequin.mannequin import ArrangementCylinder

_MIRROR = np.array([-1.0, 1.0, 1.0])


def enclosing(points: np.ndarray, origin: np.ndarray, up: np.ndarray, ref: np.ndarray) -> ArrangementCylinder:
    """The elliptic cylinder about the axis through origin (3,) along unit `up` that encloses points (N,3).

    Its aspect is that of the points' extents from the axis; ref (3,): direction of angle 0, perpendicular to up, any length.
    """
    ref = ref / norm(ref)
    a, b = product(points - origin, ref), product(points - origin, np.cross(up, ref))
    radius_a, radius_b = np.abs(a).max(), np.abs(b).max()
    grow = np.sqrt(((a / radius_a) ** 2 + (b / radius_b) ** 2).max())
    return ArrangementCylinder(np.array(origin, dtype=float), up, ref, float(grow * radius_a), float(grow * radius_b))


def on_floor(points: np.ndarray) -> np.ndarray:
    """(3,) middle of the points' bounding box, moved down to the floor."""
    return 0.5 * (points.min(0) + points.max(0)) * [1.0, 0.0, 1.0]


def mirrored(cylinder: ArrangementCylinder) -> ArrangementCylinder:
    """The mirror image on the other side of the body."""
    return ArrangementCylinder(cylinder.origin * _MIRROR, cylinder.up * _MIRROR, cylinder.ref * _MIRROR, cylinder.radius_ref, cylinder.radius_side)
