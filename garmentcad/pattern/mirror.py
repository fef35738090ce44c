"""Mirror images: a half panel unfolded over a straight edge, and a whole panel turned into its left-right twin."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from garmentcad.errors import SpecError
from garmentcad.geometry.curve import Line, Point, mirror_point
from garmentcad.pattern.darts import find_edge
from garmentcad.pattern.names import SUFFIX, check_images
from garmentcad.pattern.outline import finish_loop, mirror_edge
from garmentcad.pattern.pattern import Edge, FoldLine, Panel, Region, Transform, Wrap

_ON_FOLD_MM = 0.01  # a fold line that is its own image, as the crease at centre front, stays one


def unfold(half: Panel, mirror: str, key: str) -> Panel:
    """The whole panel of a half one: its mirror edge goes, mirrored edges, points, darts, regions, lines, holes get the suffix `_m`.

    The two points of the mirror edge lie on the fold and keep their names; notches keep theirs too, so that they meet the same notch on either side. What fold
    lines have beyond the mirror edge goes.
    SpecError: unknown or curved mirror edge, a mirror edge with a dart or a notch, a name that the suffix makes twice.
    """
    where = find_edge(half.edges, mirror, key)
    fold = half.edges[where]
    if not isinstance(fold.curve, Line) or math.dist(fold.curve.start, fold.curve.end) == 0.0:
        raise SpecError(f"edge {mirror!r} is not straight (or has no length); a panel is mirrored over a straight edge", key=key)
    if any(edge.name == mirror and k != where for k, edge in enumerate(half.edges)):
        raise SpecError(f"edge {mirror!r} is cut by a dart; put half of the dart on the edges beside it", key=key)
    point, direction = fold.curve.start, _direction(fold.curve)

    if fold.notches:
        raise SpecError(f"notch {fold.notches[0][0]!r} stands on edge {mirror!r}, which goes when the panel is unfolded; put it on an edge beside it", key=key)

    def renamed(name: str) -> str:
        return name if name in (fold.start, fold.end) else name + SUFFIX

    half = replace(half, folds=tuple(_on_half(line, fold.curve, key) for line in half.folds))
    drawn = [*half.edges[where + 1 :], *half.edges[:where]]
    image = _mirrored(half, point, direction, renamed, SUFFIX)
    turned = [replace(mirror_edge(edge, point, direction, renamed, SUFFIX), image=True) for edge in reversed(drawn)]
    on_fold = [np.allclose(other.points_mm, line.points_mm, atol=_ON_FOLD_MM) for other, line in zip(image.folds, half.folds)]
    check_images(replace(half, edges=tuple(drawn)), (fold.start, fold.end), [line.name for line, own in zip(half.folds, on_fold) if own], key)
    return replace(
        half,
        edges=finish_loop([*drawn, *turned]),
        holes=half.holes + image.holes,
        regions=half.regions + image.regions,
        folds=half.folds + tuple(line for line, own in zip(image.folds, on_fold) if not own),
        internal_lines=half.internal_lines | image.internal_lines,
        drill_holes=half.drill_holes | image.drill_holes,
        points=image.points | half.points,
    )


def _on_half(line: FoldLine, mirror: Line, key: str) -> FoldLine:
    """A fold line as far as it lies on the panel's side of the mirror edge: beyond, its image goes on. One that lies wholly on one side, or is its own image,
    stays as it is drawn. SpecError for one that crosses the edge more than once."""
    start, (along_x, along_y) = np.array(mirror.start), _direction(mirror)
    inward = np.array([-along_y, along_x]) / math.hypot(along_x, along_y)  # the panel lies to the left of its edges
    depth = (line.points_mm - start) @ inward
    depth[np.abs(depth) < _ON_FOLD_MM] = 0.0
    if depth.min() >= 0.0 or depth.max() <= 0.0:
        return line
    kept: list[np.ndarray] = []
    for k, point in enumerate(line.points_mm):
        if k and depth[k - 1] * depth[k] < 0.0:
            kept.append(line.points_mm[k - 1] + depth[k - 1] / (depth[k - 1] - depth[k]) * (point - line.points_mm[k - 1]))
        if depth[k] >= 0.0:
            kept.append(point)
    inside = np.sign(depth)[depth != 0.0]
    if np.count_nonzero(inside[1:] != inside[:-1]) > 1:
        raise SpecError(f"fold {line.name!r} crosses the mirror edge more than once; draw it on the half panel, its image is made", key=key)
    return replace(line, points_mm=np.array(kept))


def mirrored_panel(panel: Panel, name: str, placement: Wrap | Transform) -> Panel:
    """The left-right twin of a whole panel: x becomes -x, every name stays."""
    point, direction = (0.0, 0.0), (0.0, 1.0)
    image = _mirrored(panel, point, direction, lambda text: text, "")
    edges = [mirror_edge(edge, point, direction, lambda text: text, "") for edge in reversed(panel.edges)]
    return replace(image, name=name, edges=finish_loop(edges), grain_deg=-panel.grain_deg, placement=placement, mirrored_from=panel.name)


def _direction(line: Line) -> Point:
    return line.end[0] - line.start[0], line.end[1] - line.start[1]


def _mirrored(panel: Panel, point: Point, direction: Point, renamed: Callable[[str], str], suffix: str) -> Panel:
    """A panel with all but its edges mirrored."""

    def mirrored(points: np.ndarray) -> np.ndarray:
        return np.array([mirror_point((float(x), float(y)), point, direction) for x, y in points]).reshape(-1, 2)

    def region(area: Region) -> Region:
        return replace(area, name=area.name + suffix, polygon_mm=mirrored(area.polygon_mm)[::-1].copy())

    def hole(loop: tuple[Edge, ...]) -> tuple[Edge, ...]:
        return finish_loop([mirror_edge(edge, point, direction, renamed, suffix) for edge in reversed(loop)])

    return replace(
        panel,
        holes=tuple(hole(loop) for loop in panel.holes),
        regions=tuple(region(area) for area in panel.regions),
        folds=tuple(replace(fold, name=fold.name + suffix, points_mm=mirrored(fold.points_mm)) for fold in panel.folds),
        internal_lines={name + suffix: mirrored(line) for name, line in panel.internal_lines.items()},
        drill_holes={name + suffix: mirror_point(place, point, direction) for name, place in panel.drill_holes.items()},
        points={renamed(name): mirror_point(place, point, direction) for name, place in panel.points.items()},
    )
