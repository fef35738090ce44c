"""Where a garment begins that is put on over others: outside them, where they hang, but no farther than that.

A sleeve that begins far out goes less than half way around the arm, and its edges then meet on the wrong side of it.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace

import numpy as np

from garmentcad.cloth.cloth import Cloth
from garmentcad.geometry.portable import product
from garmentcad.mannequin.mannequin import ArrangementCylinder, Mannequin
from garmentcad.pattern.pattern import Pattern, Wrap
from garmentcad.units import M_TO_MM

CLEAR_M = 0.010  # between what is worn and what begins around it
_SLICE_M = 0.005  # along the axis of a part, in which heights are compared
_BESIDE = 2  # slices above and below that count as being at one height
_HALVINGS, _FAR_M = 40, 2.0


def around_worn(pattern: Pattern, cloth: Cloth, positions: np.ndarray, mannequin: Mannequin, worn: Collection[str]) -> Pattern:
    """`pattern` with the wraps of the panels that are not `worn` as much farther out as they must be to begin CLEAR_M outside all that is worn on their part of
    the body at their height: on each part all alike, so that they keep their order.

    positions (V,3) m: vertices of `worn` panels where they hang, of all others as placed.
    """
    panels, owner = dict(pattern.panels), cloth.vertex_panel[cloth.triangles[:, 0]]
    for part, cylinder in mannequin.cylinders.items():
        mine = [name for name, panel in panels.items() if isinstance(panel.placement, Wrap) and panel.placement.part == part]
        above = [name for name in mine if name not in worn]
        below, free = (np.isin(owner, [cloth.panel_names.index(name) for name in names]) for names in (set(mine) - set(above), above))
        if not below.any() or not free.any():
            continue
        lack_mm = M_TO_MM * _lack(cylinder, positions[cloth.triangles[below]], positions[cloth.triangles[free]].reshape(-1, 3))
        for name in above:
            rule = panels[name].placement
            assert isinstance(rule, Wrap)
            panels[name] = replace(panels[name], placement=replace(rule, offset_mm=rule.offset_mm + lack_mm / rule.scale))
    return replace(pattern, panels=panels)


def _lack(cylinder: ArrangementCylinder, worn: np.ndarray, placed: np.ndarray) -> float:
    """By how much points `placed` (N,3) are less than CLEAR_M outside triangles `worn` (T,3,3) at their height, m; 0 where they are not."""
    heights, own = (product(points - cylinder.origin, cylinder.up) for points in (worn, placed))
    lowest = min(heights.min(), own.min())
    slices, mine = (np.floor((along - lowest) / _SLICE_M).astype(np.int64) + _BESIDE for along in (heights, own))
    reach = np.full(max(slices.max(), mine.max()) + _BESIDE + 1, -np.inf)
    farthest = outside(cylinder, worn.reshape(-1, 3)).reshape(-1, 3).max(axis=1)
    bottom, top = slices.min(axis=1), slices.max(axis=1)
    for step in range(int((top - bottom).max()) + 1):
        np.maximum.at(reach, np.minimum(bottom + step, top), farthest)
    near = np.max([reach[mine + step] for step in range(-_BESIDE, _BESIDE + 1)], axis=0)
    return max(0.0, float((near + CLEAR_M - outside(cylinder, placed)).max()))


def outside(cylinder: ArrangementCylinder, points: np.ndarray) -> np.ndarray:
    """By how much both radii of the cylinder must grow for its surface to go through each of points (N,3), m; negative inside it."""
    away = points - cylinder.origin
    ref, side = product(away, cylinder.ref), product(away, np.cross(cylinder.up, cylinder.ref))
    low, high = np.full(len(points), -min(cylinder.radius_ref, cylinder.radius_side)), np.full(len(points), _FAR_M)
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        beyond = (ref / (cylinder.radius_ref + middle)) ** 2 + (side / (cylinder.radius_side + middle)) ** 2 > 1.0
        low, high = np.where(beyond, middle, low), np.where(beyond, high, middle)
    return high
