"""Soft light: how much of a bright sky every particle sees past the body and the cloth. It is what makes the depth of folds readable in a picture."""

from __future__ import annotations

import math
from concurrent.futures import ThreadPoolExecutor

import numpy as np

from garmentcad.arrays import entry, indices, kernel
from garmentcad.export.raster import blank, draw_triangles

DIRECTIONS = 32
MAP_PX = 400
# A point is tested this far off its surface, toward the side that is lit, so that the facets of its own neighbourhood do not shade it.
LIFT_M = 4e-3
# Half of the light comes from the whole sky, brighter high up; half from a soft lamp high on the left of the camera (right, up, toward the camera).
LAMP = np.array([-0.45, 0.65, 0.61])
SMOOTHINGS = 3  # passes of averaging over triangles: few directions leave hard edges


class SkyLight:
    """Maps of what is nearest to the sky in directions spread over the sphere, drawn once, asked for any surface.

    points: (N,3) m and triangles: (F,3) of everything that casts shade.
    """

    def __init__(self, points: np.ndarray, triangles: np.ndarray) -> None:
        self._directions = _spread(DIRECTIONS)
        center = 0.5 * (points.min(axis=0) + points.max(axis=0))
        triangles = indices(triangles)
        metre_px = 0.5 * MAP_PX / (1.01 * float(np.linalg.norm(points - center, axis=1).max()))
        self._views = np.stack([_view(direction, center, metre_px) for direction in self._directions])

        def draw(view: np.ndarray) -> np.ndarray:
            nearness, owner = blank(MAP_PX, MAP_PX)
            draw_triangles(points @ view[:, :3].T + view[:, 3], triangles, 0, nearness, owner)
            return nearness

        with ThreadPoolExecutor() as pool:
            self._maps = np.stack(list(pool.map(draw, self._views)))

    def on(self, points: np.ndarray, normals: np.ndarray) -> SurfaceLight:
        """The light on the vertices of a surface. points: (N,3) m; normals: (N,3) unit, toward the side that is lit."""
        facing = np.maximum(self._directions @ normals.T, 0.0)
        got = np.empty_like(facing)
        _hold_off(points + LIFT_M * normals, self._views, self._maps, facing, got)
        return SurfaceLight(self._directions, facing, got)


def _view(direction: np.ndarray, center: np.ndarray, metre_px: float) -> np.ndarray:
    """(3,4): matrix and shift that take a point in m to column, row and nearness on the map of a direction."""
    right = np.cross((0.0, 0.0, 1.0) if abs(direction[1]) > 0.9 else (0.0, 1.0, 0.0), direction)
    right /= np.linalg.norm(right)
    axes = np.stack([metre_px * right, metre_px * np.cross(direction, right), direction])
    return np.column_stack([axes, [0.5 * MAP_PX, 0.5 * MAP_PX, 0.0] - axes @ center])


@entry
@kernel
def _hold_off(points, views, maps, facing, got):  # type: ignore[no-untyped-def]
    """The light `facing` (D,N) that reaches points (N,3) past what the maps (D,H,W) show, into `got` (D,N)."""
    for k in range(len(views)):
        view, nearest = views[k], maps[k]
        height, width = nearest.shape
        for n in range(len(points)):
            x, y, z = points[n, 0], points[n, 1], points[n, 2]
            column = min(max(int(view[0, 0] * x + view[0, 1] * y + view[0, 2] * z + view[0, 3]), 0), width - 1)
            row = min(max(int(view[1, 0] * x + view[1, 1] * y + view[1, 2] * z + view[1, 3]), 0), height - 1)
            open_sky = view[2, 0] * x + view[2, 1] * y + view[2, 2] * z + view[2, 3] >= nearest[row, column]
            got[k, n] = facing[k, n] if open_sky else 0.0


class SurfaceLight:
    """Light on N vertices from each of the directions (D,3): `facing` (D,N) what would come in if nothing held it off, `got` (D,N) what does."""

    def __init__(self, directions: np.ndarray, facing: np.ndarray, got: np.ndarray) -> None:
        self._directions, self._facing, self._got = directions, facing, got

    def seen(self, triangles: np.ndarray, front: np.ndarray) -> np.ndarray:
        """Part (N,) in 0..1 of the light that nothing holds off. triangles: (F,3) of the surface; front: (3,) unit vector toward the camera."""
        weights = self._weights(front)
        got, full = weights @ self._got, weights @ self._facing
        part = np.divide(got, full, out=np.ones(len(full)), where=full > 0.0)
        uses = np.maximum(np.bincount(triangles.ravel(), minlength=len(part)), 1)
        for _ in range(SMOOTHINGS):
            part = np.bincount(triangles.ravel(), weights=np.repeat(part[triangles].mean(axis=1), 3), minlength=len(part)) / uses
        return part

    def _weights(self, front: np.ndarray) -> np.ndarray:
        right = np.array([front[2], 0.0, -front[0]]) / math.hypot(front[0], front[2])
        lamp = LAMP[0] * right + LAMP[1] * np.array([0.0, 1.0, 0.0]) + LAMP[2] * front
        lobe = np.maximum(self._directions @ (lamp / np.linalg.norm(lamp)), 0.0) ** 3
        sky = 0.65 + 0.35 * self._directions[:, 1]
        return sky / sky.sum() + lobe / lobe.sum()


def _spread(count: int) -> np.ndarray:
    """Unit vectors (count,3) spread evenly over the sphere on a Fibonacci spiral."""
    step = np.arange(count) + 0.5
    height = 1.0 - 2.0 * step / count
    turn = math.pi * (1.0 + math.sqrt(5.0)) * step
    ring = np.sqrt(1.0 - height**2)
    return np.column_stack([ring * np.sin(turn), height, ring * np.cos(turn)])
