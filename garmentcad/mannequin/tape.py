"""The tape: perimeter of the convex hull of a planar section, as a tailor's tape lies, and its derivative by the section's points."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.spatial import ConvexHull, QhullError

from garmentcad.arrays import unique_pairs
from garmentcad.errors import MannequinError
from garmentcad.geometry.portable import norm, product


class Section(NamedTuple):
    """Points where edges cross a plane: point k = (1 - share) x[low] + share x[high]."""

    low: np.ndarray  # (K,) int32
    high: np.ndarray  # (K,) int32
    share: np.ndarray  # (K,)
    points: np.ndarray  # (K,3) m


class Taped(NamedTuple):
    """girth: m; gradient: (K,3) derivative of the girth by the section's points."""

    girth: float
    section: Section
    gradient: np.ndarray


def cut(points: np.ndarray, faces: np.ndarray, origin: np.ndarray, normal: np.ndarray) -> Section:
    """Section of the faces (K,3) with the plane through origin; a point for every crossed edge of every face (shared edges stand twice)."""
    height = product(points - origin, normal)
    above = height[faces] > 0.0
    crossed = np.flatnonzero((above[:, 0] != above[:, 1]) | (above[:, 1] != above[:, 2]))
    faces, above = faces[crossed], above[crossed]
    ends = [faces[above[:, a] != above[:, b]][:, [a, b]] for a, b in ((0, 1), (1, 2), (2, 0))]
    low, high = unique_pairs(np.vstack(ends))[0].T
    share = height[low] / (height[low] - height[high])
    return Section(low, high, share, points[low] + share[:, None] * (points[high] - points[low]))


def plane_axes(normal: np.ndarray) -> np.ndarray:
    """(2,3) unit vectors that span the plane across `normal`; x is the first where the plane contains it."""
    first = np.array([1.0, 0.0, 0.0]) if abs(normal[0]) < 0.9 else np.array([0.0, 0.0, 1.0])
    first = first - product(first, normal) * normal
    first /= norm(first)
    return np.stack([first, np.cross(normal, first)])


def tape(points: np.ndarray, faces: np.ndarray, origin: np.ndarray, normal: np.ndarray, mirrored: bool = False) -> Taped:
    """Girth of the faces in the plane through origin (3,) across the unit normal (3,), m.

    mirrored: the faces are a left half, and the tape goes around it and its mirror image. MannequinError when the plane misses the faces.
    """
    section = cut(points, faces, origin, normal)
    if len(section.points) < 3:
        raise MannequinError(f"a tape in the plane through {np.round(origin, 3).tolist()} m does not meet the body")
    axes = plane_axes(normal)
    flat = product(section.points, axes.T)
    count = len(flat)
    if mirrored:
        flat = np.vstack([flat, product(section.points * [-1.0, 1.0, 1.0], axes.T)])
    try:
        ring = ConvexHull(flat).vertices
    except QhullError:
        raise MannequinError(f"the section in the plane through {np.round(origin, 3).tolist()} m has no inside") from None
    steps = flat[np.roll(ring, -1)] - flat[ring]
    lengths = np.sqrt((steps**2).sum(1))
    tangents = steps / lengths[:, None]
    pull = product(np.roll(tangents, 1, axis=0) - tangents, axes)
    gradient = np.zeros((count, 3))
    np.add.at(gradient, ring % count, np.where((ring < count)[:, None], pull, pull * [-1.0, 1.0, 1.0]))
    return Taped(float(lengths.sum()), section, gradient)
