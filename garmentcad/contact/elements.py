"""Points, edges and triangles of a cloth for contact, and what a particle has of the material around it."""

from __future__ import annotations

import numpy as np

from garmentcad.arrays import indices, unique_pairs
from garmentcad.cloth.cloth import Cloth
from garmentcad.contact.near import Elements

LEAST_GAP = 1e-3  # m, of mid-surfaces


def unique_edges(triangles: np.ndarray) -> np.ndarray:
    """Edges (E,2) int32 of triangles (F,3), each once, rising."""
    ends = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    return unique_pairs(ends)[0]


def elements(nodes: np.ndarray, identity: np.ndarray) -> Elements:
    """Elements of points (N,), edges (N,2) or triangles (N,3), with the identity of their nodes (P,)."""
    rows = nodes[:, None] if nodes.ndim == 1 else nodes
    rows = indices(np.concatenate([rows, np.repeat(rows[:, -1:], 3 - rows.shape[1], axis=1)], axis=1))
    same = np.array_equal(identity, np.arange(len(identity)))  # one memory for both, then
    return Elements(rows, rows if same else indices(identity[rows]))


def largest_around(cloth: Cloth, per_material: np.ndarray) -> np.ndarray:
    """(P,): the largest value (M,) of the materials of the triangles around each particle."""
    values = np.zeros(cloth.particle_count)
    np.maximum.at(values, cloth.particle_triangles, per_material[cloth.triangle_material][:, None])
    return values
