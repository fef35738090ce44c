"""Areas of triangles, what of them belongs to each corner, and gradients of shape functions in the plane."""

from __future__ import annotations

import numpy as np


def signed_areas(points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Areas (T,) of triangles (T,3) over points (N,2); positive when counter-clockwise."""
    a, b, c = (points[triangles[:, k]] for k in range(3))
    ab, ac = b - a, c - a
    return 0.5 * (ab[:, 0] * ac[:, 1] - ab[:, 1] * ac[:, 0])


def corner_shares(corners: np.ndarray) -> np.ndarray:
    """(T,3) part of the area of triangles with corners (T,3,2 or 3) that belongs to each corner: what is nearest to it; of an obtuse triangle half to the
    obtuse corner and a quarter to each of the others.

    share_i = (1 + cot_j cot_k)/4, cot of obtuse angles 0. A quadrilateral with right angles shares itself alike whichever its diagonal is. Source: Meyer,
    Desbrun, Schroeder and Barr 2003, "Discrete differential-geometry operators for triangulated 2-manifolds". A triangle without sides is shared by thirds.
    """
    one, other = np.roll(corners, -1, axis=1) - corners, np.roll(corners, -2, axis=1) - corners
    along = np.maximum((one * other).sum(axis=2), 0.0)  # cot times twice the area
    products = np.roll(along, -1, axis=1) * np.roll(along, -2, axis=1)
    total = products.sum(axis=1, keepdims=True)
    return np.asarray(0.25 + 0.25 * np.divide(products, total, out=np.full_like(products, 1.0 / 3.0), where=total > 0.0))


def shape_gradients(points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Gradients (T,3,2) of the linear functions that are 1 at one corner and 0 at the others.

    The gradient at corner k is the opposite edge turned by 90 degrees toward k, over twice the area. Any field linear over a triangle with the corner
    values x_k has the derivative sum_k x_k gradient_k.
    """
    corners = points[triangles]
    opposite = np.roll(corners, 1, axis=1) - np.roll(corners, -1, axis=1)  # from the next corner to the one after it
    turned = np.stack([-opposite[..., 1], opposite[..., 0]], axis=-1)
    return turned / (2.0 * signed_areas(points, triangles))[:, None, None]
