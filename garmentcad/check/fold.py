"""Findings on fold lines and pleats."""

from __future__ import annotations

from collections.abc import Iterator

import shapely

from garmentcad.check.finding import Finding
from garmentcad.pattern.fold import FOLD, UNDER
from garmentcad.pattern.pattern import FoldLine, Panel

_OUTSIDE_MM = 0.5
_FOLDS_APART = 2.0  # grids; nearer ones share the cloth that each of them turns


def check_folds(panel: Panel, polygon: shapely.Polygon, grid_mm: float, file: str | None, key: str) -> Iterator[Finding]:
    """Folds outside the panel (polygon: its outline), along its edge, and folds that are too near to each other for the lattice."""
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
            if 0.0 < distance < _FOLDS_APART * grid_mm:
                yield Finding(
                    "warning", "folds-close", file, f"{key}.folds.{name}",
                    f"fold {other} is {distance:.1f} mm away; at a grid of {grid_mm:g} mm folds are {_FOLDS_APART * grid_mm:g} mm wide",
                    f"Use a grid of at most {distance / _FOLDS_APART:.1f} mm, or move them apart.",
                )  # fmt: skip
    yield from _check_pleats(panel.folds, lines, file, key)


def _check_pleats(folds: tuple[FoldLine, ...], lines: dict[str, shapely.LineString], file: str | None, key: str) -> Iterator[Finding]:
    for fold in folds:
        under = fold.name.replace(FOLD, UNDER) if FOLD in fold.name else ""
        if under in lines and lines[fold.name].intersects(lines[under]):
            yield Finding(
                "error", "pleat-crosses-itself", file, f"{key}.pleats.{fold.name.replace(FOLD, '')}", "the two fold lines of the pleat cross",
                "Draw them side by side, as far apart as the pleat is deep.",
            )  # fmt: skip
