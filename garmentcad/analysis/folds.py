"""The angle of each fold line of a draped panel."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import shapely

from garmentcad.cloth.cloth import Cloth
from garmentcad.pattern.pattern import Pattern
from garmentcad.units import M_TO_MM

_ON_MM = 0.01  # from the fold: a corner of a triangle that lies on it
_STRETCH = 3.0  # grids of fold over which normals are averaged


def fold_lines(pattern: Pattern) -> dict[str, np.ndarray]:
    """Points (N,2) in panel mm of each fold line, by the name that the report gives it: "panel.fold"."""
    return {f"{panel.name}.{fold.name}": fold.points_mm for panel in pattern.panels.values() for fold in panel.folds}


def fold_angles_deg(cloth: Cloth, positions: np.ndarray, folds: Mapping[str, np.ndarray]) -> dict[str, float | None]:
    """Mean angle along each fold, degrees: 0 is flat, positive where the right sides face each other. folds: see `fold_lines`.

    On each stretch of a fold, the angle from the mean normal of the triangles along one side to that of those along the other, about the direction of the fold;
    None where there is no cloth on both sides.
    """
    return {name: _mean_angle(cloth, positions, name.split(".")[0], points) for name, points in folds.items()}


def _mean_angle(cloth: Cloth, positions: np.ndarray, panel: str, points: np.ndarray) -> float | None:
    line = shapely.LineString(points)
    on_fold = shapely.dwithin(shapely.points(cloth.vertex_uv_mm), line, _ON_MM) & (cloth.vertex_panel == cloth.panel_names.index(panel))
    mine = np.flatnonzero(on_fold[cloth.triangles].sum(axis=1) == 2)
    place = cloth.vertex_uv_mm[cloth.triangles[mine]].mean(axis=1)
    at = shapely.line_locate_point(line, shapely.points(place))
    foot = shapely.get_coordinates(shapely.line_interpolate_point(line, at))
    step = 1e-3 * line.length
    ahead = shapely.get_coordinates(shapely.line_interpolate_point(line, np.minimum(at + step, line.length)))
    behind = shapely.get_coordinates(shapely.line_interpolate_point(line, np.maximum(at - step, 0.0)))
    along, away = ahead - behind, place - foot
    left = along[:, 0] * away[:, 1] - along[:, 1] * away[:, 0] > 0.0
    corners = positions[cloth.particle_triangles[mine]]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    count = max(1, int(line.length / (_STRETCH * cloth.spacing * M_TO_MM)))
    stretch = np.minimum((at / line.length * count).astype(int), count - 1)
    found = []
    for k in range(count):
        sides = [(stretch == k) & side for side in (left, ~left)]
        if not all(side.any() for side in sides):
            continue
        one, two = (normal[side].sum(axis=0) for side in sides)
        apart = corners[sides[0]].mean(axis=(0, 1)) - corners[sides[1]].mean(axis=(0, 1))
        # toward the right side where the normals lean to each other
        sign = np.sign(float(apart @ (two - one))) or 1.0
        found.append(sign * np.degrees(np.arctan2(np.linalg.norm(np.cross(one, two)), one @ two)))
    return float(np.mean(found)) if found else None
