"""How deep a cloth lies inside a body: an exact judge, independent of the solver's contact."""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np
from numba import prange
from scipy.spatial import cKDTree

from garmentcad.arrays import entry, floats, indices, kernel, parallel_kernel
from garmentcad.geometry.angle import arctan2
from garmentcad.units import M_TO_MM

_CLUSTER = 4  # faces in a box
_ON_SURFACE = 1e-9  # m
_FACE = 6  # the feature of a foot that lies inside a face
_FAN = 16  # boxes in a larger box, of which there are two levels
# Barycentric weights of the three points in which a triangle is sampled beside its corners.
_SAMPLES = np.array([[2 / 3, 1 / 6, 1 / 6], [1 / 6, 2 / 3, 1 / 6], [1 / 6, 1 / 6, 2 / 3]])


def signed_distances(points: np.ndarray, vertices: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """(N,) distance of points (N,3) from a closed surface, negative inside; see `distances_and_normals`."""
    return distances_and_normals(points, vertices, faces)[0]


def distances_and_normals(points: np.ndarray, vertices: np.ndarray, faces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Distance (N,) of points (N,3) from a closed surface, negative inside, and the unit vector (N,3) along which it grows, from the closest point outward;
    faces (F,3) counter-clockwise seen from outside.

    The sign comes from the pseudo-normal of the closest feature (Baerentzen and Aanaes 2005). A point on the surface has the normal of a face there.
    """
    points = floats(points)
    out = np.empty((len(points), 4))
    _signed(points, *_surface(floats(vertices).tobytes(), indices(faces).tobytes()), out)
    return out[:, 0].copy(), out[:, 1:].copy()


@lru_cache(maxsize=2)  # one body is asked many times: the doctor and the report do so at every step of theirs
def _surface(vertices: bytes, faces: bytes) -> tuple[np.ndarray, ...]:
    """What `_signed` takes of a surface of vertices (V,3) and faces (F,3): corners of its faces in clusters, boxes around them, pseudo-normals."""
    points, triangles = np.frombuffer(vertices).reshape(-1, 3), np.frombuffer(faces, dtype=np.int32).reshape(-1, 3)
    corners = points[triangles]
    order = cKDTree(corners.mean(axis=1), leafsize=_CLUSTER).indices
    sorted_corners = floats(corners[order])
    small = _boxes_around(np.concatenate([sorted_corners.min(axis=1), sorted_corners.max(axis=1)], axis=1), _CLUSTER)
    middle = _boxes_around(small, _FAN)
    return sorted_corners, small, middle, _boxes_around(middle, _FAN), floats(_pseudo_normals(points, triangles)[order])


def penetration_mm(
    positions: np.ndarray, triangles: np.ndarray, body_vertices: np.ndarray, body_faces: np.ndarray, distances: np.ndarray | None = None
) -> float:
    """Greatest depth in mm of a cloth inside a closed body, at the cloth's particles and at three points of each triangle; 0 if there is none.

    distances: `signed_distances` of the particles, where they are known already.
    """
    positions, triangles = np.asarray(positions), np.asarray(triangles)
    if len(positions) == 0:
        return 0.0
    if distances is None:
        distances = signed_distances(positions, body_vertices, body_faces)
    corners = positions[triangles]
    samples = np.einsum("sk,fkx->fsx", _SAMPLES, corners)
    # A point that is nearer to a corner than that corner is to the body lies on the corner's side of it.
    reach = np.linalg.norm(samples[:, :, None] - corners[:, None], axis=3)
    doubtful = samples[(distances[triangles][:, None] <= reach).all(axis=2)]
    depth = -min(distances.min(), signed_distances(doubtful, body_vertices, body_faces).min(initial=np.inf))
    return max(0.0, float(depth)) * M_TO_MM


def _boxes_around(boxes: np.ndarray, count: int) -> np.ndarray:
    """Boxes (K,6), low and high corner, around each `count` following boxes (N,6)."""
    starts = np.arange(0, len(boxes), count)
    return floats(np.concatenate([np.minimum.reduceat(boxes[:, :3], starts, axis=0), np.maximum.reduceat(boxes[:, 3:], starts, axis=0)], axis=1))


def _pseudo_normals(vertices: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """(F,7,3): angle-weighted normals of the corners, sums of the two face normals at the edges opposite to corners 0 1 2, the face's own normal."""
    own = _face_normals(vertices[faces])
    opposite = np.sort(np.stack([faces[:, [1, 2]], faces[:, [2, 0]], faces[:, [0, 1]]], axis=1), axis=2)
    key = (opposite[..., 0].astype(np.int64) * len(vertices) + opposite[..., 1]).ravel()
    _, edge = np.unique(key, return_inverse=True)
    at_edge = np.stack([np.bincount(edge, np.repeat(own[:, axis], 3)) for axis in range(3)], axis=1)
    return np.concatenate([_angle_sums(vertices, faces, own)[faces], at_edge[edge.reshape(-1, 3)], own[:, None]], axis=1)


def _face_normals(corners: np.ndarray) -> np.ndarray:
    """(F,3) unit normals of faces (F,3,3)."""
    own = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return own / np.maximum(np.linalg.norm(own, axis=1, keepdims=True), 1e-300)


def _angle_sums(vertices: np.ndarray, faces: np.ndarray, own: np.ndarray) -> np.ndarray:
    """(V,3): sums over the faces around a vertex of their normals `own` (F,3) times their angles there."""
    corners = vertices[faces]
    sums = np.zeros_like(vertices)
    for k in range(3):
        e, f = corners[:, k - 2] - corners[:, k], corners[:, k - 1] - corners[:, k]
        angle = arctan2(np.linalg.norm(np.cross(e, f), axis=1), (e * f).sum(axis=1))
        for axis in range(3):
            sums[:, axis] += np.bincount(faces[:, k], angle * own[:, axis], len(vertices))
    return sums


@kernel
def _box_gap2(boxes, box, x, y, z):  # type: ignore[no-untyped-def]
    dx = max(boxes[box, 0] - x, 0.0, x - boxes[box, 3])
    dy = max(boxes[box, 1] - y, 0.0, y - boxes[box, 4])
    dz = max(boxes[box, 2] - z, 0.0, z - boxes[box, 5])
    return dx * dx + dy * dy + dz * dz


@kernel
def _foot(corners, face, x, y, z):  # type: ignore[no-untyped-def]
    """Vector from the closest point of a face to the point, and the feature: corner 0..2, 3 + corner opposite to the edge, 6 the face."""
    best, bx, by, bz, feature = math.inf, 0.0, 0.0, 0.0, 0
    ux, uy, uz = corners[face, 1, 0] - corners[face, 0, 0], corners[face, 1, 1] - corners[face, 0, 1], corners[face, 1, 2] - corners[face, 0, 2]
    vx, vy, vz = corners[face, 2, 0] - corners[face, 0, 0], corners[face, 2, 1] - corners[face, 0, 1], corners[face, 2, 2] - corners[face, 0, 2]
    nx, ny, nz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
    square = nx * nx + ny * ny + nz * nz
    over = square > 0.0
    for k in range(3):
        i, j = (k + 1) % 3, (k + 2) % 3
        ex, ey, ez = corners[face, j, 0] - corners[face, i, 0], corners[face, j, 1] - corners[face, i, 1], corners[face, j, 2] - corners[face, i, 2]
        px, py, pz = x - corners[face, i, 0], y - corners[face, i, 1], z - corners[face, i, 2]
        # Left of every edge: the point lies over the face.
        over = over and nx * (ey * pz - ez * py) + ny * (ez * px - ex * pz) + nz * (ex * py - ey * px) >= 0.0
        long2 = ex * ex + ey * ey + ez * ez
        t = (ex * px + ey * py + ez * pz) / long2 if long2 > 0.0 else 0.0
        t = min(1.0, max(0.0, t))
        rx, ry, rz = px - t * ex, py - t * ey, pz - t * ez
        gap2 = rx * rx + ry * ry + rz * rz
        if gap2 < best:
            best, bx, by, bz = gap2, rx, ry, rz
            feature = i if t == 0.0 else (j if t == 1.0 else 3 + k)
    if over:
        height = (nx * (x - corners[face, 0, 0]) + ny * (y - corners[face, 0, 1]) + nz * (z - corners[face, 0, 2])) / square
        return height * nx, height * ny, height * nz, _FACE
    return bx, by, bz, feature


@kernel
def _nearest_box(boxes, first, count, x, y, z):  # type: ignore[no-untyped-def]
    """Of the `count` boxes from `first` on, those that there are."""
    nearest, best = first, math.inf
    for box in range(first, min(first + count, len(boxes))):
        gap2 = _box_gap2(boxes, box, x, y, z)
        if gap2 < best:
            nearest, best = box, gap2
    return nearest


@kernel
def _closest_in(box, x, y, z, corners, normals, best, out):  # type: ignore[no-untyped-def]
    """Squared distance from the nearest face so far, after the faces of a small box; that face's signed distance and direction go into out (4,)."""
    for face in range(box * _CLUSTER, min((box + 1) * _CLUSTER, len(corners))):
        rx, ry, rz, feature = _foot(corners, face, x, y, z)
        gap2 = rx * rx + ry * ry + rz * rz
        if gap2 < best:
            best, gap = gap2, math.sqrt(gap2)
            nx, ny, nz = normals[face, feature, 0], normals[face, feature, 1], normals[face, feature, 2]
            out[0] = -gap if rx * nx + ry * ny + rz * nz < 0.0 else gap
            if gap > _ON_SURFACE:
                out[1], out[2], out[3] = rx / out[0], ry / out[0], rz / out[0]
            else:
                out[1], out[2], out[3] = normals[face, _FACE, 0], normals[face, _FACE, 1], normals[face, _FACE, 2]
    return best


@kernel
def _signed_one(x, y, z, corners, small, middle, large, normals, out):  # type: ignore[no-untyped-def]
    # First down to a near box, so that few of the others remain.
    first = _nearest_box(large, 0, len(large), x, y, z)
    first = _nearest_box(middle, first * _FAN, _FAN, x, y, z)
    first = _nearest_box(small, first * _FAN, _FAN, x, y, z)
    best = _closest_in(first, x, y, z, corners, normals, math.inf, out)
    for a in range(len(large)):
        if _box_gap2(large, a, x, y, z) > best:
            continue
        for b in range(a * _FAN, min((a + 1) * _FAN, len(middle))):
            if _box_gap2(middle, b, x, y, z) > best:
                continue
            for c in range(b * _FAN, min((b + 1) * _FAN, len(small))):
                if c != first and _box_gap2(small, c, x, y, z) <= best:
                    best = _closest_in(c, x, y, z, corners, normals, best, out)


@entry
@parallel_kernel
def _signed(points, corners, small, middle, large, normals, out):  # type: ignore[no-untyped-def]
    for n in prange(len(points)):
        _signed_one(points[n, 0], points[n, 1], points[n, 2], corners, small, middle, large, normals, out[n])
