"""The surface of a body as contact sees it: pseudo-normals that tell inside from outside, and how far flat cloth triangles must stay off its curves."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from garmentcad.arrays import floats, indices, unique_pairs
from garmentcad.geometry.closest import EDGE, FACE

SMOOTHINGS = 3  # of the vertex curvature over the neighbours


class Surface(NamedTuple):
    """A still closed body. normals: (F,7,3) unit, of the features of each face as `geometry.closest` numbers them: corners, edges, the face itself."""

    vertices: np.ndarray  # (V,3) m
    faces: np.ndarray  # (F,3) int32, counter-clockwise from outside
    normals: np.ndarray


def build_surface(vertices: np.ndarray, faces: np.ndarray) -> Surface:
    """Surface with angle-weighted pseudo-normals (Baerentzen and Aanaes 2005): their sign is right at corners and edges as well."""
    vertices, faces = floats(vertices), indices(faces)
    corners = vertices[faces]
    flat = _unit(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]))
    angled = []
    for corner in range(3):
        to_next = _unit(corners[:, (corner + 1) % 3] - corners[:, corner])
        to_last = _unit(corners[:, (corner + 2) % 3] - corners[:, corner])
        angle = np.arccos(np.clip((to_next * to_last).sum(axis=1), -1.0, 1.0))
        angled.append(angle[:, None] * flat)
    vertex_normal = _sums(faces.T.ravel(), np.concatenate(angled), len(vertices))
    edges, edge = unique_pairs(np.stack([faces, np.roll(faces, -1, axis=1)], axis=2).reshape(-1, 2))
    edge_normal = _sums(edge, np.repeat(flat, 3, axis=0), len(edges))
    normals = np.empty((len(faces), 7, 3))
    normals[:, :EDGE] = _unit(vertex_normal)[faces]
    normals[:, EDGE:FACE] = _unit(edge_normal)[edge.reshape(-1, 3)]
    normals[:, FACE] = flat
    return Surface(vertices, faces, normals)


def convex_curvature(surface: Surface, smoothings: int = SMOOTHINGS) -> np.ndarray:
    """(V,) 1/m: the largest normal curvature toward a neighbour where the body bulges (0 where it is flat or hollow), smoothed over neighbours."""
    vertices, faces = surface.vertices, surface.faces
    normals = np.zeros_like(vertices)
    normals[faces.ravel()] = surface.normals[:, :EDGE].reshape(-1, 3)
    one, other = faces.ravel(), np.roll(faces, -1, axis=1).ravel()
    apart = vertices[other] - vertices[one]
    square = np.maximum((apart * apart).sum(axis=1), 1e-18)
    curvature = np.zeros(len(vertices))
    np.maximum.at(curvature, one, -2.0 * (normals[one] * apart).sum(axis=1) / square)
    np.maximum.at(curvature, other, 2.0 * (normals[other] * apart).sum(axis=1) / square)
    count = np.bincount(one, minlength=len(vertices)).clip(1)
    for _ in range(smoothings):
        curvature = 0.5 * (curvature + np.bincount(one, curvature[other], len(vertices)) / count)
    return curvature


def _sums(places: np.ndarray, vectors: np.ndarray, count: int) -> np.ndarray:
    """(count,3): sums of the vectors (K,3) that belong to each place, `places` (K,)."""
    return np.column_stack([np.bincount(places, vectors[:, axis], count) for axis in range(3)])


def _unit(vectors: np.ndarray) -> np.ndarray:
    length = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return np.divide(vectors, length, out=np.zeros_like(vectors), where=length > 0.0)
