"""Outlines: from edge specs to closed counter-clockwise loops of edges."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from itertools import pairwise

from garmentcad.errors import SpecError, did_you_mean
from garmentcad.geometry.curve import Arc, Cubic, Curve, Line, Point, Quadratic, Spline
from garmentcad.geometry.polygon import loop_points, signed_area
from garmentcad.pattern.pattern import Edge
from garmentcad.pattern.scope import MAX_COORDINATE_MM, Scope
from garmentcad.pattern.spec import ArcSpec, EdgeSpec, SplineSpec

_ON_CIRCLE_MM = 0.01


def draft_loop(specs: Sequence[EdgeSpec], points: Mapping[str, Point], scope: Scope, key: str) -> list[Edge]:
    """The closed loop of edges in the direction as drawn. SpecError: unknown points, an open loop, edges of one name."""
    edges: list[Edge] = []
    for k, spec in enumerate(specs):
        where = f"{key}.{k}"
        if any(edge.name == spec.name for edge in edges):
            raise SpecError(f"a second edge is called {spec.name!r}; names of edges differ within a panel", key=f"{where}.name")
        for field, name in (("from", spec.start), ("to", spec.end)):
            if name not in points:
                raise SpecError(f"no point is called {name!r}{did_you_mean(name, points)}", key=f"{where}.{field}")
        curve = draft_curve(spec, points[spec.start], points[spec.end], scope, where)
        allowance = scope.number(spec.allowance, f"{where}.allowance", 0.0, 500.0)
        edges.append(Edge(spec.name, spec.start, spec.end, curve, role=spec.role, seam_allowance_mm=allowance))
    for k, edge in enumerate(edges):
        after = edges[(k + 1) % len(edges)]
        if edge.end != after.start:
            gap = math.dist(edge.curve.end, after.curve.start)
            raise SpecError(
                f"the outline is open: edge {edge.name!r} ends at {edge.end!r} and the next edge {after.name!r} starts at {after.start!r}, "
                f"{gap:.1f} mm away; each edge starts where the one before it ends",
                key=f"{key}.{(k + 1) % len(edges)}.from",
            )
    return edges


def is_counter_clockwise(edges: Sequence[Edge], key: str) -> bool:
    """Direction of a closed loop. SpecError when it encloses no area."""
    points = loop_points([edge.curve for edge in edges])
    area = signed_area(points)
    if abs(area) < 1.0:
        raise SpecError(f"the outline encloses {area:.3f} mm2; a panel has an area", key=key)
    return area > 0.0


def reverse_edge(edge: Edge) -> Edge:
    """The same edge run against its direction."""
    return replace(edge, start=edge.end, end=edge.start, curve=edge.curve.reversed(), notches=_turned(edge.notches))


def mirror_edge(edge: Edge, point: Point, direction: Point, rename_point: Callable[[str], str], suffix: str) -> Edge:
    """Mirror image over a line, run backward so that a counter-clockwise loop stays one. The loop's order is reversed by the caller."""
    return replace(
        edge,
        name=edge.name + suffix,
        start=rename_point(edge.end),
        end=rename_point(edge.start),
        curve=edge.curve.mirrored(point, direction).reversed(),
        notches=_turned(edge.notches),
        dart=None if edge.dart is None else edge.dart + suffix,
    )


def finish_loop(edges: Sequence[Edge]) -> tuple[Edge, ...]:
    """Joints equal to the bit, and the pieces of cut edges numbered 1, 2, ... along the outline (0 for an uncut edge)."""
    names = [edge.name for edge in edges]
    counted: dict[str, int] = {}
    finished = []
    for edge, after in pairwise([*edges, edges[0]]):
        counted[edge.name] = counted.get(edge.name, 0) + 1
        curve = edge.curve
        if curve.end != after.curve.start:
            curve = curve.part(0.0, 1.0, curve.start, after.curve.start)
        finished.append(replace(edge, curve=curve, piece=counted[edge.name] if names.count(edge.name) > 1 else 0))
    return tuple(finished)


def _turned(notches: tuple[tuple[str, float], ...]) -> tuple[tuple[str, float], ...]:
    return tuple((name, 1.0 - fraction) for name, fraction in reversed(notches))


def draft_curve(spec: EdgeSpec, start: Point, end: Point, scope: Scope, key: str) -> Curve:
    """Curve of an edge between its two points."""
    if spec.arc is not None:
        return _arc(spec.arc, start, end, scope, f"{key}.arc")
    if spec.quadratic is not None:
        return Quadratic(start, end, scope.point(spec.quadratic, f"{key}.quadratic"))
    if spec.cubic is not None:
        control_a, control_b = (scope.point(spec.cubic[k], f"{key}.cubic.{k}") for k in (0, 1))
        return Cubic(start, end, control_a, control_b)
    if spec.spline is not None:
        return _spline(spec.spline, start, end, scope, f"{key}.spline")
    return Line(start, end)


def _arc(spec: ArcSpec, start: Point, end: Point, scope: Scope, key: str) -> Arc:
    if spec.center is not None:
        center = scope.point(spec.center, f"{key}.center")
        a, b = math.dist(start, center), math.dist(end, center)
        if abs(a - b) > _ON_CIRCLE_MM or a == 0.0:
            message = f"the ends are {a:.3f} and {b:.3f} mm from the center; both must lie on the circle (within {_ON_CIRCLE_MM} mm)"
            raise SpecError(message, key=f"{key}.center")
        return Arc(start, end, center, spec.direction == "clockwise")
    assert spec.radius is not None  # the model allows no third form
    radius = scope.number(spec.radius, f"{key}.radius", high=50 * MAX_COORDINATE_MM)
    half = math.dist(start, end) / 2
    if half == 0.0 or radius < half * (1 - 1e-12):
        message = f"a radius of {radius:.3f} mm cannot span the chord of {2 * half:.3f} mm; it must be at least half of a chord that is not 0"
        raise SpecError(message, key=f"{key}.radius")
    # The centre lies on the chord's right for an arc that bulges to the left, beyond the chord where the arc is the large one.
    side = (-1.0 if spec.bulge == "left" else 1.0) * (-1.0 if spec.large else 1.0)
    rise = side * math.sqrt(max(0.0, radius**2 - half**2)) / (2 * half)
    dx, dy = end[0] - start[0], end[1] - start[1]
    center = ((start[0] + end[0]) / 2 - rise * dy, (start[1] + end[1]) / 2 + rise * dx)
    return Arc(start, end, center, spec.bulge == "left")


def _spline(spec: SplineSpec, start: Point, end: Point, scope: Scope, key: str) -> Spline:
    through = tuple(scope.point(pair, f"{key}.through.{k}") for k, pair in enumerate(spec.through))
    for k, (a, b) in enumerate(pairwise([start, *through, end])):
        if math.dist(a, b) < 1e-3:
            message = f"two neighbouring points of the spline lie {math.dist(a, b):.4f} mm apart; they must differ"
            raise SpecError(message, key=f"{key}.through.{min(k, len(through) - 1)}")
    tangents: list[Point | None] = []
    for field, pair in (("start_tangent", spec.start_tangent), ("end_tangent", spec.end_tangent)):
        x, y = (0.0, 0.0) if pair is None else scope.point(pair, f"{key}.{field}")
        size = math.hypot(x, y)
        if pair is not None and size == 0.0:
            raise SpecError("a tangent of no length; it must point somewhere", key=f"{key}.{field}")
        tangents.append(None if pair is None else (x / size, y / size))
    return Spline(start, end, through, tangents[0], tangents[1])
