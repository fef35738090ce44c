"""Soft light: how much of a bright sky every particle sees past the body and the cloth. It is what makes the depth of folds readable in a picture."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

DIRECTIONS = 32
MAP_PX = 400
# A point is tested this far off its surface, toward the side that is lit, so that the facets of its own neighbourhood do not shade it.
LIFT_M = 4e-3
# Half of the light comes from the whole sky, brighter high up; half from a soft lamp high on the left of the camera (right, up, toward the camera).
LAMP = np.array([-0.45, 0.65, 0.61])
SMOOTHINGS = 3  # passes of averaging over triangles: few directions leave hard edges


class SkyLight:
    """Depth maps of a scene from directions spread over the sphere, drawn once, asked for any surface and any camera.

    pyvista: the module; points: (N,3) m and triangles: (F,3) of everything that casts shade.
    """

    def __init__(self, pyvista: Any, points: np.ndarray, triangles: np.ndarray) -> None:
        self._directions = _spread(DIRECTIONS)
        self._maps: list[tuple[np.ndarray, np.ndarray]] = []
        self._draw(pyvista, points, triangles)

    def seen(self, points: np.ndarray, normals: np.ndarray, triangles: np.ndarray, front: np.ndarray) -> np.ndarray:
        """Part (N,) in 0..1 of the light on the vertices of a surface that nothing holds off.

        points: (N,3) m; normals: (N,3) unit; triangles: (F,3); front: (3,) unit vector toward the camera.
        """
        lifted = np.column_stack([points + LIFT_M * normals, np.ones(len(points))])
        got, full = np.zeros(len(points)), np.zeros(len(points))
        for direction, weight, (matrix, depth) in zip(self._directions, self._weights(front), self._maps):
            facing = weight * np.maximum(normals @ direction, 0.0)
            x, y, z, _ = (lifted @ matrix.T).T
            column = np.clip(np.rint((0.5 * x + 0.5) * MAP_PX - 0.5), 0, MAP_PX - 1).astype(np.int64)
            row = np.clip(np.rint((0.5 * y + 0.5) * MAP_PX - 0.5), 0, MAP_PX - 1).astype(np.int64)
            got += np.where(z <= depth[row, column], facing, 0.0)
            full += facing
        part = np.divide(got, full, out=np.ones(len(points)), where=full > 0.0)
        uses = np.maximum(np.bincount(triangles.ravel(), minlength=len(points)), 1)
        for _ in range(SMOOTHINGS):
            part = np.bincount(triangles.ravel(), weights=np.repeat(part[triangles].mean(axis=1), 3), minlength=len(points)) / uses
        return part

    def _weights(self, front: np.ndarray) -> np.ndarray:
        right = np.array([front[2], 0.0, -front[0]]) / math.hypot(front[0], front[2])
        lamp = LAMP[0] * right + LAMP[1] * np.array([0.0, 1.0, 0.0]) + LAMP[2] * front
        lobe = np.maximum(self._directions @ (lamp / np.linalg.norm(lamp)), 0.0) ** 3
        sky = 0.65 + 0.35 * self._directions[:, 1]
        return sky / sky.sum() + lobe / lobe.sum()

    def _draw(self, pyvista: Any, points: np.ndarray, triangles: np.ndarray) -> None:
        center = 0.5 * (points.min(axis=0) + points.max(axis=0))
        radius = float(np.linalg.norm(points - center, axis=1).max()) * 1.01
        plotter = pyvista.Plotter(off_screen=True, window_size=(MAP_PX, MAP_PX), lighting="none")
        plotter.add_mesh(pyvista.PolyData.from_regular_faces(points, triangles), lighting=False, color="white")
        camera = plotter.camera
        camera.enable_parallel_projection()
        camera.parallel_scale = radius
        plotter.show(auto_close=False, interactive=False)
        buffer = pyvista._vtk.vtkFloatArray()
        for direction in self._directions:
            camera.focal_point = tuple(center)
            camera.position = tuple(center + 2.0 * radius * direction)
            camera.up = (0.0, 0.0, 1.0) if abs(direction[1]) > 0.9 else (0.0, 1.0, 0.0)
            camera.clipping_range = (radius, 3.0 * radius)
            plotter.render_window.Render()
            plotter.render_window.GetZbufferData(0, 0, MAP_PX - 1, MAP_PX - 1, buffer)
            depth = pyvista.convert_array(buffer).reshape(MAP_PX, MAP_PX).copy()
            matrix = pyvista.array_from_vtkmatrix(camera.GetCompositeProjectionTransformMatrix(1.0, 0.0, 1.0))
            self._maps.append((matrix, depth))
        plotter.close()


def _spread(count: int) -> np.ndarray:
    """Unit vectors (count,3) spread evenly over the sphere on a Fibonacci spiral."""
    step = np.arange(count) + 0.5
    height = 1.0 - 2.0 * step / count
    turn = math.pi * (1.0 + math.sqrt(5.0)) * step
    ring = np.sqrt(1.0 - height**2)
    return np.column_stack([ring * np.sin(turn), height, ring * np.cos(turn)])
