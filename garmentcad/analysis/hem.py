"""Where the hem hangs, and how evenly."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from garmentcad.cloth.cloth import Cloth
from garmentcad.units import M_TO_MM


@dataclass(frozen=True)
class HemHeight:
    """Heights of the hem above the floor, mm: mean over its rest length, lowest and highest point, and unevenness: the root mean square of height minus mean
    (0 for a level hem)."""

    mean_mm: float
    low_mm: float
    high_mm: float
    uneven_mm: float


def rest_lengths_mm(cloth: Cloth, vertices: np.ndarray) -> np.ndarray:
    """Lengths (N-1,) on the pattern, mm, from each of vertices (N,) along an edge to the next; 0 over the mouth of a dart, which is sewn shut."""
    particle = cloth.vertex_particle[vertices]
    return np.where(particle[1:] != particle[:-1], np.linalg.norm(np.diff(cloth.vertex_uv_mm[vertices], axis=0), axis=1), 0.0)


def hem_height(cloth: Cloth, positions: np.ndarray, edge_keys: Iterable[str]) -> HemHeight | None:
    """Height of the edges `panel.edge` (keys of `Cloth.edge_vertices`) at positions (P,3) m; None without edges.

    The mean is weighted by length on the pattern: height is linear along each stretch between two vertices. Raises KeyError for an unknown edge.
    """
    total, weighted, squares, low, high = 0.0, 0.0, 0.0, np.inf, -np.inf
    for key in edge_keys:
        vertices = cloth.edge_vertices[key]
        height = positions[cloth.vertex_particle[vertices], 1]
        length = rest_lengths_mm(cloth, vertices)
        total += float(length.sum())
        weighted += float((length * 0.5 * (height[1:] + height[:-1])).sum())
        squares += float((length * (height[1:] ** 2 + height[1:] * height[:-1] + height[:-1] ** 2)).sum()) / 3.0
        low, high = min(low, float(height.min())), max(high, float(height.max()))
    if total == 0.0:
        return None
    mean = weighted / total
    uneven = math.sqrt(max(squares / total - mean**2, 0.0))
    return HemHeight(*(M_TO_MM * value for value in (mean, low, high, uneven)))
