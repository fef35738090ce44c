"""The surface of a body as contact sees it: pseudo-normals that tell inside from outside, and how far flat cloth triangles must stay off its curves."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from garmentcad.arrays import floats, frozen, indices, unique_pairs
from garmentcad.geometry.angle import arcsin
from garmentcad.geometry.closest import EDGE, FACE

_SMOOTHINGS = 3  # of the vertex curvature over the neighbours


class Surface(NamedTuple):
    """A closed body. normals: (F,7,3) unit, of the features of each face as `geometry.closest` numbers them: corners, edges, the face itself."""

    vertices: np.ndarray  # (V,3) m
    faces: np.ndarray  # (F,3) int32, counter-clockwise from outside
    normals: np.ndarray


def build_surface(vertices: np.ndarray, faces: np.ndarray) -> Surface:
    """Surface with angle-weighted pseudo-normals (Baerentzen and Aanaes 2005): their sign is right at corners and edges as well."""
    # Copied, so that the one may be written and the other may not, whatever was given: kernels are compiled anew for the other kind.
    vertices, faces = floats(vertices).copy(), frozen(indices(faces).copy())
    return Surface(vertices, faces, pseudo_normals(vertices, faces, edge_of_side(faces)))


def edge_of_side(faces: np.ndarray) -> np.ndarray:
    """(3F,) number of the edge that each side of each face (F,3) is."""
    return unique_pairs(np.stack([faces, np.roll(faces, -1, axis=1)], axis=2).reshape(-1, 2))[1]


def pseudo_normals(vertices: np.ndarray, faces: np.ndarray, edge: np.ndarray) -> np.ndarray:
    """Normals of a Surface. edge: `edge_of_side` of the faces."""
    # A moving body asks for them every few dozen steps, and coordinate by coordinate that takes half as long.
    corners = np.stack([np.take(coordinate, faces.T) for coordinate in vertices.T])  # (3 coordinates, 3 corners, F)
    sides = np.roll(corners, -1, axis=1) - corners  # from each corner to the next
    (ax, ay, az), (bx, by, bz) = sides[:, 0], -sides[:, 2]
    flat = _unit(np.stack([ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx]))
    ways = _unit(sides)
    towards = ways * np.roll(ways, 1, axis=1)
    angles = 0.5 * np.pi - arcsin(np.clip(-((towards[0] + towards[1]) + towards[2]), -1.0, 1.0))
    vertex_normal = _unit(_sums(faces.T.ravel(), (flat[:, None] * angles).reshape(3, -1), len(vertices)))
    edge_normal = _unit(_sums(edge, np.repeat(flat, 3, axis=1), int(edge.max(initial=-1)) + 1))
    normals = np.empty((len(faces), 7, 3))
    normals[:, :EDGE] = np.take(vertex_normal.T, faces, axis=0)
    normals[:, EDGE:FACE] = np.take(edge_normal.T, edge.reshape(-1, 3), axis=0)
    normals[:, FACE] = flat.T
    return normals


def convex_curvature(surface: Surface) -> np.ndarray:
    """(V,) 1/m: the largest normal curvature toward a neighbour where the body bulges (0 where it is flat or hollow), smoothed over neighbours."""
    one, other, drop, length = _drops(surface)
    curvature = np.zeros(len(surface.vertices))
    np.maximum.at(curvature, one, 2.0 * drop / length**2)
    count = np.bincount(one, minlength=len(curvature)).clip(1)
    for _ in range(_SMOOTHINGS):
        curvature = 0.5 * (curvature + np.bincount(one, curvature[other], len(curvature)) / count)
    return curvature


def bulge(surface: Surface, radius: float) -> np.ndarray:
    """(V,) m: how far the surface drops below the tangent plane of each vertex at a distance `radius`, toward the neighbour where it drops most: along an edge
    that is longer than that in proportion, along shorter ones as a parabola goes on."""
    one, _, drop, length = _drops(surface)
    found = np.zeros(len(surface.vertices))
    np.maximum.at(found, one, drop * np.where(length < radius, (radius / length) ** 2, radius / length))
    return found


def _drops(surface: Surface) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Both ways along all sides of faces: from vertex, to vertex, drop below the tangent plane of the first, length."""
    vertices, faces = surface.vertices, surface.faces
    normals = np.zeros_like(vertices)
    normals[faces.ravel()] = surface.normals[:, :EDGE].reshape(-1, 3)
    one, other = faces.ravel(), np.roll(faces, -1, axis=1).ravel()
    one, other = np.concatenate([one, other]), np.concatenate([other, one])
    apart = vertices[other] - vertices[one]
    return one, other, -(normals[one] * apart).sum(axis=1), np.maximum(np.linalg.norm(apart, axis=1), 1e-9)


def _sums(places: np.ndarray, vectors: np.ndarray, count: int) -> np.ndarray:
    """(3,count): sums of the vectors (3,K) that belong to each place, `places` (K,)."""
    return np.stack([np.bincount(places, coordinate, count) for coordinate in vectors])


def _unit(vectors: np.ndarray) -> np.ndarray:
    """Of vectors (3,...)."""
    squares = vectors * vectors
    length = np.sqrt((squares[0] + squares[1]) + squares[2])
    return np.asarray(vectors / np.where(length > 0.0, length, 1.0))
