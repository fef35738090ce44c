"""Judges of a finished drape that are not ours: ipctk for crossings, libigl for depth inside the body."""

from __future__ import annotations

import igl
import ipctk
import numpy as np


def crosses(positions: np.ndarray, triangles: np.ndarray, vertices: np.ndarray, faces: np.ndarray) -> bool:
    """Whether cloth (P,3) m, (F,3) crosses itself or a body (V,3), (G,3)."""
    points, both = np.concatenate([positions, vertices]), np.concatenate([triangles, faces + len(positions)]).astype(np.int32)
    return bool(ipctk.has_intersections(ipctk.CollisionMesh(points, ipctk.edges(both), both), points))


def least_distance_mm(positions: np.ndarray, triangles: np.ndarray, vertices: np.ndarray, faces: np.ndarray) -> float:
    """Smallest signed distance from a closed body at particles and at three points of each triangle; negative inside."""
    corners = positions[triangles]
    inner = [np.einsum("k,fkx->fx", np.roll([2 / 3, 1 / 6, 1 / 6], k), corners) for k in range(3)]
    return 1e3 * float(igl.signed_distance(np.concatenate([positions, *inner]), vertices, faces)[0].min())
