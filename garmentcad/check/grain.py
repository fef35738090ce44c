"""Findings on the grain: a few degrees off what the panel is drawn along, and twins that are cut at different angles."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations

import numpy as np
import shapely

from garmentcad.check.finding import Finding
from garmentcad.geometry.curve import Line
from garmentcad.geometry.polygon import loop_points
from garmentcad.pattern.pattern import Panel, Pattern

_STRAIGHT_DEG = 0.5  # angles that differ by less are the same: half a degree is 4 mm in half a metre
_MEANT_DEG = 10.0  # who means a slant means more
_LONG_MM = 40.0  # a shorter straight line is no direction to lay the grain along
_STRIP = (3.0, 0.97)  # times as long as wide, part of its box that it fills: a strip (waistband, cuff, belt) has a long axis
_SAME_MM = 1.0


def check_grain(pattern: Pattern, file: str | None) -> Iterator[Finding]:
    """Oblique grain of single panels, then twins whose grain differs."""
    for panel in pattern.panels.values():
        yield from _check_oblique(panel, file)
    for a, b in combinations(pattern.panels.values(), 2):
        yield from _check_twins(a, b, file)


def _check_oblique(panel: Panel, file: str | None) -> Iterator[Finding]:
    off, along = _off(panel.grain_deg, 0.0), "the drawing's vertical"
    polygon = shapely.Polygon(loop_points([edge.curve for edge in panel.edges], 0.05))
    strip = _strip_direction(polygon)
    if strip is not None:
        off, along = _off(panel.grain_deg, strip), "the long axis of this strip"
    elif any(abs(_off(panel.grain_deg, direction)) <= _STRAIGHT_DEG for direction in _drawn_directions(panel)):
        return
    if _STRAIGHT_DEG < abs(off) < _MEANT_DEG:
        yield Finding(
            "warning", "grain-oblique", file, f"panels.{panel.name}.grain",
            f"the grain of {panel.grain_deg:g} degrees lies {abs(off):.1f} degrees off straight, cross or bias grain by {along}, and along no straight line",
            f"Set grain: {round(panel.grain_deg - off, 3) + 0.0:g}, or turn the panel; cloth cut a little off grain twists when it hangs.",
        )  # fmt: skip


def _off(grain_deg: float, direction_deg: float) -> float:
    """Signed angle of the grain from the nearest multiple of 45 degrees against a direction."""
    return (grain_deg - direction_deg + 22.5) % 45.0 - 22.5


def _drawn_directions(panel: Panel) -> list[float]:
    """Directions (degrees counter-clockwise from +y) of straight edges and internal lines."""
    pairs = [(edge.curve.start, edge.curve.end) for edge in panel.edges if isinstance(edge.curve, Line) and edge.dart is None]
    pairs += [(line[k], line[k + 1]) for line in panel.internal_lines.values() for k in range(len(line) - 1)]
    steps = np.array([np.subtract(end, start) for start, end in pairs]).reshape(-1, 2)
    steps = steps[np.hypot(steps[:, 0], steps[:, 1]) >= _LONG_MM]
    return [float(angle) for angle in np.degrees(np.arctan2(-steps[:, 0], steps[:, 1]))]


def _strip_direction(polygon: shapely.Polygon) -> float | None:
    """Direction of the long side of a panel that is nearly a rectangle much longer than wide."""
    if not polygon.is_valid or polygon.is_empty:
        return None
    box = shapely.get_coordinates(shapely.oriented_envelope(polygon))
    sides = np.diff(box[:3], axis=0)
    lengths = np.hypot(sides[:, 0], sides[:, 1])
    if lengths.min() == 0.0 or lengths.max() < _STRIP[0] * lengths.min() or polygon.area < _STRIP[1] * lengths.prod():
        return None
    x, y = sides[lengths.argmax()]
    return float(np.degrees(np.arctan2(-x, y)))


def _check_twins(a: Panel, b: Panel, file: str | None) -> Iterator[Finding]:
    turns = _twin_turns(a, b)
    if not turns:
        return
    offs = [(b.grain_deg - (turn - a.grain_deg) + 90.0) % 180.0 - 90.0 for turn in turns]
    off = min(offs, key=abs)
    if abs(off) > _STRAIGHT_DEG:
        yield Finding(
            "warning", "grain-of-twins", file, f"panels.{b.name}.grain",
            f"the panel is the mirror image of {a.name}, but its grain of {b.grain_deg:g} degrees lies {abs(off):.1f} degrees off that of the mirror image",
            f"Set grain: {round(b.grain_deg - off, 3) + 0.0:g}, or draw it as mirrored_from: {a.name}; twins that are cut differently hang differently.",
        )  # fmt: skip


def _twin_turns(a: Panel, b: Panel) -> list[float]:
    """Angles (degrees) by which the mirror image (x to -x) of panel a is turned to lie on b; empty where b is no mirror image of a.

    The points compared are corners and middles of edges; edges may start anywhere.
    """
    if len(a.edges) != len(b.edges):
        return []
    image = np.array([point for edge in reversed(a.edges) for point in (edge.curve.end, edge.curve.points_at(0.5)[0])]) * [-1.0, 1.0]
    own = np.array([point for edge in b.edges for point in (edge.curve.start, edge.curve.points_at(0.5)[0])])
    image, own = image - image.mean(axis=0), own - own.mean(axis=0)
    turns = []
    for shift in range(len(b.edges)):
        moved = np.roll(own, -2 * shift, axis=0)
        sine, cosine = float(np.sum(image[:, 0] * moved[:, 1] - image[:, 1] * moved[:, 0])), float(np.sum(image * moved))
        angle = np.arctan2(sine, cosine)
        turned = image @ np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
        if np.abs(turned - moved).max() <= _SAME_MM:
            turns.append(float(np.degrees(angle)))
    return turns
