"""The shape in which a hem hangs, by figures that do not depend on where its folds lie: nodes, and the area of its shadow.

Every closed line of hem edges is looked at from above. Its shadow is all that the line encloses there; the rim of the shadow is the outermost line around it.
A node is a maximum of the rim's radius around the vertical axis through the shadow's centroid that stands out by at least 3 mm (prominence), as counted on a
drapemeter. The drape coefficient of a hem is the area of the shadow over that of the circle whose circumference is the hem's length on the pattern: 100 % is a
hem that stands out round, the softer the cloth the less.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from shapely import LineString, Polygon, get_parts, polygonize, unary_union

from garmentcad.analysis.hem import rest_lengths_mm
from garmentcad.cloth.cloth import Cloth
from garmentcad.units import M_TO_MM

PROMINENCE_M = 3e-3
RAYS = 720  # directions in which the rim is looked at
RIM_STEP_M = 5e-4  # between the points of the rim: each ray sees some, down to a radius of 60 mm; nearer ones are interpolated


@dataclass(frozen=True)
class HemShape:
    """nodes: count, of all closed lines together; shadow_m2: area of their shadows; drape_coefficient_percent: the same over the area of the circles as long as
    the hems; radius_low_mm, radius_high_mm: least and greatest distance of a rim from its axis."""

    nodes: int
    shadow_m2: float
    drape_coefficient_percent: float
    radius_low_mm: float
    radius_high_mm: float


def hem_shape(cloth: Cloth, positions: np.ndarray, edge_keys: Iterable[str]) -> HemShape | None:
    """Shape of the edges `panel.edge` (keys of `Cloth.edge_vertices`) at positions (P,3) m; None where none forms a closed line. KeyError for an unknown
    edge."""
    nodes, shadow, circle = 0, 0.0, 0.0
    radii = []
    for line, length in _closed_lines(cloth, list(edge_keys)):
        radius, area = rim(positions[line][:, [2, 0]])
        if area > 0.0:
            nodes += node_count(radius)
            shadow += area
            circle += length**2 / (4.0 * math.pi)
            radii.append(radius)
    if not radii:
        return None
    low, high = min(float(radius.min()) for radius in radii), max(float(radius.max()) for radius in radii)
    return HemShape(nodes, shadow, 100.0 * shadow / circle, M_TO_MM * low, M_TO_MM * high)


def node_count(radius: np.ndarray, prominence_m: float = PROMINENCE_M) -> int:
    """Maxima of a closed curve of radii (N,) m that stand out by at least the prominence: between them it falls, and to each of them it rises, by as much.

    From the lowest point on these are those that scipy's `find_peaks` finds, whose import takes half a second at the end of a drape."""
    nodes, rising, high, low = 0, True, 0.0, 0.0
    turned = np.roll(radius, -int(radius.argmin())).tolist()
    for distance in turned + turned[:1]:
        if rising:
            high = max(high, distance)
            if high - distance >= prominence_m:
                nodes, rising, low = nodes + 1, False, distance
        else:
            low = min(low, distance)
            if distance - low >= prominence_m:
                rising, high = True, distance
    return nodes


def rim(line: np.ndarray) -> tuple[np.ndarray, float]:
    """Radius (RAYS,) m of a shadow's rim around its centroid, by direction, and the area [m2]. line: (N,2) m, closed, seen from above; it may cross itself."""
    faces = get_parts(polygonize([unary_union(LineString(np.vstack([line, line[:1]])))]))
    outlines = [Polygon(part.exterior) for part in get_parts(unary_union(faces)) if part.area > 0.0]
    if not outlines:
        return np.zeros(RAYS), 0.0
    # A fold that lies across itself may pinch off a loop; the shadow goes around the largest.
    shadow = max(outlines, key=lambda part: part.area)
    points = np.array(shadow.exterior.segmentize(RIM_STEP_M).coords) - shadow.centroid.coords[0]
    ray = np.floor(np.arctan2(points[:, 1], points[:, 0]) % (2.0 * math.pi) / (2.0 * math.pi) * RAYS).astype(int) % RAYS
    radius = np.zeros(RAYS)
    np.maximum.at(radius, ray, np.hypot(*points.T))
    seen = np.flatnonzero(radius > 0.0)
    return np.interp(np.arange(RAYS), seen, radius[seen], period=RAYS), float(shadow.area)


def _closed_lines(cloth: Cloth, edge_keys: list[str]) -> list[tuple[np.ndarray, float]]:
    """Particles (N,) of each closed line of edges, and its length on the pattern [m]. Edges join where their end particles are one."""
    left = [(cloth.vertex_particle[vertices], _length(cloth, vertices)) for vertices in (cloth.edge_vertices[key] for key in edge_keys)]
    lines = []
    while left:
        line, length = left.pop(0)
        while line[0] != line[-1]:
            found = next((k for k, (other, _) in enumerate(left) if line[-1] in (other[0], other[-1])), None)
            if found is None:
                break
            other, more = left.pop(found)
            line = np.append(line, (other if other[0] == line[-1] else other[::-1])[1:])
            length += more
        else:
            lines.append((line[:-1], length))
    return lines


def _length(cloth: Cloth, vertices: np.ndarray) -> float:
    return float(rest_lengths_mm(cloth, vertices).sum()) / M_TO_MM
