"""Findings on fold lines and pleats."""

from __future__ import annotations

from collections.abc import Iterator

import shapely

from garmentcad.check.finding import Finding
from garmentcad.cloth.lattice import GRID_MM
from garmentcad.pattern.pattern import Panel

_OUTSIDE_MM = 0.5
_SAME_LINE_MM = 0.5
_FOLDS_APART = 1.0  # grids; between nearer ones there is no lattice


def check_folds(panel: Panel, polygon: shapely.Polygon, grid_mm: float, file: str | None, key: str) -> Iterator[Finding]:
    """Folds outside the panel (polygon: its outline), along its edge, too near to each other for the lattice, and on one line."""
    lines = {fold.name: shapely.LineString(fold.points_mm) for fold in panel.folds}
    for name, line in lines.items():
        place = f"{key}.folds.{name}"
        outside = line.difference(polygon.buffer(_OUTSIDE_MM)).length
        if outside > 0.0:
            nothing = outside > 0.999 * line.length
            yield Finding(
                "error" if nothing else "warning", "fold-outside", file, place, f"{outside:.0f} of {line.length:.0f} mm of the fold line lie outside the panel",
                "Draw the internal line inside the outline; what lies outside has no effect.",
            )  # fmt: skip
            continue
        beside = line.intersection(polygon.exterior.buffer(0.5 * grid_mm)).length
        if beside > 0.5 * line.length and beside > grid_mm:
            yield Finding(
                "warning", "fold-at-edge", file, place, f"{beside:.0f} of {line.length:.0f} mm of the fold line run within half a grid of the outline",
                "Nothing folds there; give a seam a fold_angle, or draw the panel on beyond the fold.",
            )  # fmt: skip
    names = list(lines)
    for k, name in enumerate(names):
        for other in names[k + 1 :]:
            distance = lines[name].distance(lines[other])
            if _SAME_LINE_MM < distance < _FOLDS_APART * grid_mm:  # nearer ones meet, as a fold does its mirror image up to rounding
                finest = distance / _FOLDS_APART
                yield Finding(
                    "warning", "folds-close", file, f"{key}.folds.{name}",
                    f"fold {other} is {distance:.1f} mm away, less than a grid of {grid_mm:g} mm",
                    "Move them apart." if finest < GRID_MM[0] else f"Use a grid of at most {finest:.1f} mm, or move them apart.",
                )  # fmt: skip
                continue
            along = lines[name].intersection(lines[other].buffer(_SAME_LINE_MM)).length
            if along > grid_mm:  # more than where lines cross or run into each other
                yield Finding(
                    "warning", "folds-close", file, f"{key}.folds.{name}", f"fold {other} runs along the same line for {along:.0f} mm",
                    "The cloth folds there once: leave one of them out, or move them apart.",
                )  # fmt: skip
