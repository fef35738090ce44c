"""Findings on single panels: outline, cutouts, drill holes, regions, folds, size."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import shapely

from garmentcad.check.finding import Finding
from garmentcad.check.fold import check_folds
from garmentcad.cloth.lattice import GRID_MM
from garmentcad.geometry.polygon import crossing_point, loop_points
from garmentcad.pattern.pattern import Edge, Panel

_SHORT_MM = 1.0
_ZERO_MM = 0.01
_TOLERANCE_MM = 0.05  # of the polylines that stand for curves
_CIRCLE_MM = 0.1  # by which the largest circle in an outline may be found too small
_OUTSIDE_MM2 = 1.0
_OUTSIDE_MM = 0.5


def check_panel(panel: Panel, grid_mm: float, file: str | None) -> Iterator[Finding]:
    """Everything that is wrong with one panel at a lattice spacing."""
    key = f"panels.{panel.name}"
    yield from _check_lengths(panel, file, key)
    simple = True
    for loop, place in ((panel.edges, f"{key}.edges"), *((hole, f"{key}.cutouts.{k}") for k, hole in enumerate(panel.holes))):
        points = _distinct(loop_points([edge.curve for edge in loop], _TOLERANCE_MM))
        crossing = crossing_point(points) if len(points) > 2 else (float(points[0, 0]), float(points[0, 1]))
        if crossing is not None:
            simple = False
            near = _edges_at(loop, crossing)
            yield Finding(
                "error", "outline-crosses-itself", file, place,
                f"the outline crosses or touches itself at ({crossing[0]:.1f}, {crossing[1]:.1f}) mm, on {' and '.join(near)}",
                "Move the points of these edges, or flatten their curves, so that they meet at their ends only.",
            )  # fmt: skip
    if simple:
        polygon = shapely.Polygon(loop_points([edge.curve for edge in panel.edges], _TOLERANCE_MM))
        yield from _check_inside(panel, polygon, file, key)
        yield from check_folds(panel, polygon, grid_mm, file, key)
        yield from _check_size(polygon, grid_mm, file, key)


def _check_lengths(panel: Panel, file: str | None, key: str) -> Iterator[Finding]:
    for edge in (*panel.edges, *(edge for hole in panel.holes for edge in hole)):
        length = edge.curve.length
        if length < _SHORT_MM:
            zero = length < _ZERO_MM
            yield Finding(
                "error" if zero else "warning", "edge-without-length" if zero else "edge-short", file, f"{key}.edges.{edge.name}",
                f"the edge from {edge.start} to {edge.end} is {length:.3f} mm long" + ("" if zero else f"; shorter than {_SHORT_MM:g} mm"),
                "Merge its two points, or move them apart.",
            )  # fmt: skip


def _check_inside(panel: Panel, polygon: shapely.Polygon, file: str | None, key: str) -> Iterator[Finding]:
    for k, hole in enumerate(panel.holes):
        area = shapely.Polygon(loop_points([edge.curve for edge in hole], _TOLERANCE_MM))
        outside = area.difference(polygon).area
        if outside > _OUTSIDE_MM2:
            yield Finding(
                "error", "cutout-outside", file, f"{key}.cutouts.{k}", f"{outside:.0f} of {area.area:.0f} mm2 of the cutout lie outside the panel",
                "Move the cutout inside, or draw it as part of the outline.",
            )  # fmt: skip
    for name, hole_mm in panel.drill_holes.items():
        off = polygon.distance(shapely.Point(hole_mm))
        if off > _OUTSIDE_MM:
            yield Finding(
                "warning", "hole-outside", file, f"{key}.drill_holes.{name}",
                f"the drill hole lies {off:.1f} mm outside the panel, at ({hole_mm[0]:.1f}, {hole_mm[1]:.1f}) mm", "Move it onto the cloth.",
            )  # fmt: skip
    for region in panel.regions:
        covered = shapely.make_valid(shapely.Polygon(region.polygon_mm))
        outside = covered.difference(polygon.buffer(_TOLERANCE_MM)).area
        if outside > max(_OUTSIDE_MM2, 1e-3 * covered.area):
            nothing = outside > 0.999 * covered.area
            yield Finding(
                "error" if nothing else "warning", "region-outside", file, f"{key}.regions.{region.name}",
                f"{outside:.0f} of {covered.area:.0f} mm2 of the region lie outside the panel",
                "Draw the region inside the outline; what lies outside has no effect.",
            )  # fmt: skip


def _check_size(polygon: shapely.Polygon, grid_mm: float, file: str | None, key: str) -> Iterator[Finding]:
    """A lattice needs a row of cells: at least two spacings across, and one at the very least."""
    if polygon.area > grid_mm * polygon.length:
        return  # a circle of radius area / length goes into any outline (Bonnesen); to find the largest one takes as long as all other checks of a panel
    width = 2.0 * shapely.maximum_inscribed_circle(polygon, tolerance=_CIRCLE_MM).length
    if width < 2.0 * (grid_mm - _CIRCLE_MM):
        finest = np.floor(width) / 2
        yield Finding(
            "error" if width < grid_mm else "warning", "panel-too-small", file, key,
            f"the panel is {width:.1f} mm wide where it is widest; a grid of {grid_mm:g} mm wants {2 * grid_mm:g} mm and needs {grid_mm:g} mm",
            "Make the panel wider." if finest < GRID_MM[0] else f"Use a grid of at most {finest:g} mm, or make the panel wider.",
        )  # fmt: skip


def _distinct(points: np.ndarray) -> np.ndarray:
    """Without points that repeat the one before (edges of no length, reported on their own)."""
    return points[np.hypot(*(points - np.roll(points, 1, axis=0)).T) > 1e-9]


def _edges_at(loop: tuple[Edge, ...], point: tuple[float, float]) -> list[str]:
    place = shapely.Point(point)
    names = [edge.name for edge in loop if shapely.LineString(edge.curve.polyline(_TOLERANCE_MM)).distance(place) < 0.01]
    return list(dict.fromkeys(names)) or ["an edge"]
