"""Normals of a garment for shading, and where shading may not run on: over the ridge of a fold one normal would face neither of its sides."""

from __future__ import annotations

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from garmentcad.arrays import unique_pairs

CREASE_DEG = 90.0  # smooth folds turn by less from triangle to triangle, gathers on coarse lattices nearly as much


def particle_normals(positions: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Area-weighted unit normals (P,3) of particles from triangles (F,3) in particle indices; zero where a particle has no triangle."""
    around = triangles.T.ravel()
    face = _face_normals(positions, triangles)
    normals = np.column_stack([np.bincount(around, np.tile(face[:, axis], 3), len(positions)) for axis in range(3)])
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    return np.divide(normals, length, out=np.zeros_like(normals), where=length > 0.0)


def split_at_creases(positions: np.ndarray, triangles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Particles (N,), each once or more, and triangles (F,3) as rows of them: triangles that meet in an edge at more than CREASE_DEG share no row of its
    particles, unless others lead around one of them smoothly. positions: (P,3) m; triangles: (F,3) in particle indices, some of them may be turned over."""
    face = _face_normals(positions, triangles)
    tail, head = triangles.ravel(), np.roll(triangles, -1, axis=1).ravel()
    here = np.arange(3 * len(triangles))
    there = np.roll(here.reshape(-1, 3), -1, axis=1).ravel()
    forward = tail < head
    low, high = np.where(forward, here, there), np.where(forward, there, here)  # corners at the particle of the lower number, and of the higher
    _, edge = unique_pairs(np.column_stack([tail, head]))
    order = np.argsort(edge, kind="stable")
    beside = np.flatnonzero(np.diff(edge[order]) == 0)
    one, other = order[beside], order[beside + 1]
    # sides that run the same way have their right sides on different sides of the surface
    turned = np.where(forward[one] == forward[other], -1.0, 1.0)
    a, b = face[one // 3], face[other // 3]
    smooth = turned * np.einsum("ec,ec->e", a, b) >= np.cos(np.radians(CREASE_DEG)) * np.linalg.norm(a, axis=1) * np.linalg.norm(b, axis=1)
    one, other = one[smooth], other[smooth]
    row, column = np.concatenate([low[one], high[one]]), np.concatenate([low[other], high[other]])
    _, label = connected_components(coo_matrix((np.ones(len(row)), (row, column)), shape=(len(here), len(here))), directed=False)
    _, first, corner = np.unique(label, return_index=True, return_inverse=True)
    return tail[first], corner.reshape(-1, 3)


def _face_normals(positions: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Normals (F,3), twice as long as the areas."""
    a, b, c = (positions[triangles[:, corner]] for corner in range(3))
    return np.asarray(np.cross(b - a, c - a))
