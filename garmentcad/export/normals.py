"""Normals of a garment for shading."""

from __future__ import annotations

import numpy as np


def particle_normals(positions: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Area-weighted unit normals (P,3) of particles from triangles (F,3) in particle indices; zero where a particle has no triangle."""
    a, b, c = (positions[triangles[:, corner]] for corner in range(3))
    face = np.cross(b - a, c - a)
    around = triangles.T.ravel()
    normals = np.column_stack([np.bincount(around, np.tile(face[:, axis], 3), len(positions)) for axis in range(3)])
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    return np.divide(normals, length, out=np.zeros_like(normals), where=length > 0.0)
