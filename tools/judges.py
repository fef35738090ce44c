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


def uncovered(points: np.ndarray, positions: np.ndarray, triangles: np.ndarray, vertices: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """(N,) bool: points (N,3) of what is worn below that lie outside what is worn over them: the way to the nearest point of the body, (V,3), (G,3), goes
    through its triangles, (P,3), (F,3), an odd number of times."""
    nearest = igl.signed_distance(points, vertices, faces)[2]
    a, b, c = (positions[triangles[:, k]] for k in range(3))
    found = np.zeros(len(points), dtype=bool)
    for k, (start, end) in enumerate(zip(points, nearest, strict=True)):
        found[k] = np.count_nonzero(_passes(start, end, a, b, c)) % 2 == 1
    return found


def _passes(start: np.ndarray, end: np.ndarray, a: np.ndarray, b: np.ndarray, c: np.ndarray) -> np.ndarray:
    """(F,) bool: triangles that a segment goes through, by signed volumes."""
    side = [np.einsum("fx,fx->f", np.cross(b - a, c - a), point - a) > 0.0 for point in (start, end)]
    way = end - start
    turns = np.array([np.einsum("x,fx->f", way, np.cross(p - start, q - start)) > 0.0 for p, q in ((a, b), (b, c), (c, a))])
    return (side[0] != side[1]) & (turns.all(axis=0) | ~turns.any(axis=0))
