"""The shadow of a draped disc from above: its area, its rim and its nodes."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import shapely

from garmentcad.analysis.hem_shape import node_count
from garmentcad.units import M_TO_MM, MM_TO_M

DIRECTIONS = 720  # in which the rim is looked at


class Shadow(NamedTuple):
    """outline_mm: rings of the shadow, (N,2) each, the outer one first. rim_mm: (DIRECTIONS,) greatest distance from the axis in each direction."""

    outline_mm: list[np.ndarray]
    area_m2: float
    rim_mm: np.ndarray
    nodes: int


def cast_shadow(positions: np.ndarray, triangles: np.ndarray) -> Shadow:
    """Shadow of triangles (F,3) over positions (P,3) m on the plane y = 0, about the axis x = z = 0."""
    corners = positions[:, [0, 2]][triangles]
    ab, ac = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    whole = np.abs(ab[:, 0] * ac[:, 1] - ab[:, 1] * ac[:, 0]) > 1e-14  # seen edge-on a triangle has no shadow of its own
    parts = shapely.get_parts(shapely.union_all(shapely.polygons(corners[whole]), grid_size=1e-8))
    largest = parts[np.argmax(shapely.area(parts))]
    rings = [shapely.get_coordinates(ring) for ring in shapely.get_rings(largest)]
    rim = _rim(rings[0])
    return Shadow([M_TO_MM * ring for ring in rings], float(shapely.area(parts).sum()), M_TO_MM * rim, node_count(rim))


def _rim(ring: np.ndarray) -> np.ndarray:
    """Greatest distance (DIRECTIONS,) at which a ray from the axis meets the ring (N,2)."""
    reach = 2.0 * float(np.abs(ring).max())
    angles = 2.0 * math.pi * np.arange(DIRECTIONS) / DIRECTIONS
    rays = shapely.linestrings(np.stack([np.zeros((DIRECTIONS, 2)), reach * np.column_stack([np.cos(angles), np.sin(angles)])], axis=1))
    met = shapely.intersection(rays, shapely.linestrings(ring))
    points, ray = shapely.get_coordinates(met, return_index=True)
    rim = np.zeros(DIRECTIONS)
    np.maximum.at(rim, ray, np.linalg.norm(points, axis=1))
    return rim


def drape_coefficient(area_m2: float, disc_mm: float, specimen_mm: float) -> float:
    """DC [%] = 100 (shadow - disc)/(specimen - disc), from diameters in mm. Source: Cusick 1968."""
    disc, specimen = (math.pi * (0.5 * MM_TO_M * diameter) ** 2 for diameter in (disc_mm, specimen_mm))
    return 100.0 * (area_m2 - disc) / (specimen - disc)
