"""Notches on edges, and darts cut into them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

from garmentcad.errors import SpecError, did_you_mean
from garmentcad.geometry.curve import Line, Point
from garmentcad.pattern.pattern import Edge
from garmentcad.pattern.scope import Scope
from garmentcad.pattern.spec import DartSpec, Distance, NotchSpec, Place


def find_edge(edges: Sequence[Edge], name: str, key: str) -> int:
    """Index of an uncut edge by name. SpecError for an unknown one."""
    for k, edge in enumerate(edges):
        if edge.name == name:
            return k
    raise SpecError(f"no edge is called {name!r}{did_you_mean(name, (edge.name for edge in edges))}", key=key)


def place_fraction(place: Place, edge: Edge, scope: Scope, key: str) -> float:
    """Arc-length fraction of a place on an edge in the direction as drawn. SpecError for one that does not lie on it, and for an edge without length."""
    length = edge.curve.length
    if length == 0.0:
        raise SpecError(f"edge {edge.name!r} has no length from {edge.start!r} to {edge.end!r}; nothing has a place on it", key=key)
    if not isinstance(place, Distance):
        try:
            return scope.number(place, key, 0.0, 1.0)
        except SpecError as fault:  # a length in mm, as a rule
            said = place if isinstance(place, str) else f"{place:g}"
            raise SpecError(f"{fault.message}, a fraction of the edge; a distance is {{mm: {said}, from: {edge.start}}}", key=key) from None
    if place.start not in (edge.start, edge.end):
        raise SpecError(f"edge {edge.name!r} runs from {edge.start!r} to {edge.end!r}; came {place.start!r}", key=f"{key}.from")
    distance = scope.number(place.mm, f"{key}.mm", 0.0, length)
    return distance / length if place.start == edge.start else 1.0 - distance / length


def add_notches(edges: list[Edge], notches: Sequence[NotchSpec], scope: Scope, key: str) -> list[Edge]:
    """The loop as drawn, with its notches. Names of notches differ within an edge."""
    edges = list(edges)
    for k, notch in enumerate(notches):
        where = find_edge(edges, notch.edge, f"{key}.{k}.edge")
        edge = edges[where]
        if any(name == notch.name for name, _ in edge.notches):
            raise SpecError(f"a second notch of edge {edge.name!r} is called {notch.name!r}; names differ within an edge", key=f"{key}.{k}.name")
        fraction = place_fraction(notch.at, edge, scope, f"{key}.{k}.at")
        edges[where] = replace(edge, notches=tuple(sorted([*edge.notches, (notch.name, fraction)], key=lambda item: item[1])))
    return edges


@dataclass(frozen=True)
class _Mouth:
    """A dart on its edge: arc-length fractions where the mouth begins and ends along the counter-clockwise outline; origin: the point from which the spec
    counts its place."""

    name: str
    start: float
    end: float
    length_mm: float
    origin: str
    key: str


def cut_darts(edges: Sequence[Edge], darts: Sequence[DartSpec], drawn_backward: bool, scope: Scope, key: str) -> list[Edge]:
    """A counter-clockwise loop with its darts cut in: the edge loses `intake` of its length around the dart's middle, and two legs of equal length run
    to the apex, `length` inside the mouth's chord and square to it. Points NAME_a, NAME_apex, NAME_b, edges NAME_leg_a, NAME_leg_b, along the outline.

    drawn_backward: the loop was turned around, so that fractions count from the other end. SpecError: unknown edge, a mouth over the edge's ends or another
    mouth or a notch, a name twice.
    """
    mouths: dict[str, list[_Mouth]] = {}
    for k, dart in enumerate(darts):
        where = f"{key}.{k}"
        if any(mouth.name == dart.name for row in mouths.values() for mouth in row):
            raise SpecError(f"a second dart is called {dart.name!r}; names differ within a panel", key=f"{where}.name")
        edge = edges[find_edge(edges, dart.edge, f"{where}.edge")]
        drawn = replace(edge, start=edge.end, end=edge.start) if drawn_backward else edge
        at = place_fraction(dart.at, drawn, scope, f"{where}.at")
        middle = 1.0 - at if drawn_backward else at
        half = scope.positive(dart.intake, f"{where}.intake") / edge.curve.length / 2
        length, origin = scope.positive(dart.length, f"{where}.length"), dart.at.start if isinstance(dart.at, Distance) else drawn.start
        mouths.setdefault(dart.edge, []).append(_Mouth(dart.name, middle - half, middle + half, length, origin, where))
    cut: list[Edge] = []
    for edge in edges:
        cut += _cut_edge(edge, sorted(mouths.get(edge.name, []), key=lambda mouth: mouth.start))
    return cut


def _cut_edge(edge: Edge, mouths: list[_Mouth]) -> list[Edge]:
    if not mouths:
        return [edge]
    length, reached = edge.curve.length, 0.0
    for mouth in mouths:
        if mouth.start * length < reached * length + 1.0 or mouth.end * length > length - 1.0:
            taken, free = (mouth.start * length, mouth.end * length), (reached * length + 1.0, length - 1.0)
            if mouth.origin != edge.start:
                taken, free = (length - taken[1], length - taken[0]), (length - free[1], length - free[0])
            raise SpecError(
                f"counted from {mouth.origin!r}, the mouth of dart {mouth.name!r} takes {taken[0]:.1f} to {taken[1]:.1f} mm of edge {edge.name!r}; "
                f"free is {free[0]:.1f} to {free[1]:.1f} mm (the dart before it, or the edge's end, lies in the way)",
                key=mouth.key,
            )
        reached = mouth.end
    fractions = [fraction for mouth in mouths for fraction in (mouth.start, mouth.end)]
    pieces = edge.curve.split(fractions)
    bounds = [0.0, *fractions, 1.0]
    cut: list[Edge] = []
    placed = 0
    for k in range(0, len(pieces), 2):
        a, b = bounds[k], bounds[k + 1]
        notches = tuple((name, (at - a) / (b - a)) for name, at in edge.notches if a <= at <= b)
        placed += len(notches)
        before, after = mouths[k // 2 - 1] if k else None, mouths[k // 2] if k // 2 < len(mouths) else None
        start, end = f"{before.name}_b" if before else edge.start, f"{after.name}_a" if after else edge.end
        cut.append(replace(edge, start=start, end=end, curve=pieces[k], notches=notches))
        if after:
            cut += _legs(after, pieces[k].end, pieces[k + 1].end)
    if placed < len(edge.notches):
        raise SpecError(f"a notch of edge {edge.name!r} lies in the mouth of a dart; move it out", key=mouths[0].key)
    return cut


def _legs(mouth: _Mouth, a: Point, b: Point) -> list[Edge]:
    dx, dy = b[0] - a[0], b[1] - a[1]
    chord = math.hypot(dx, dy)
    inward = mouth.length_mm / chord  # the inside lies left of a counter-clockwise outline
    apex = ((a[0] + b[0]) / 2 - inward * dy, (a[1] + b[1]) / 2 + inward * dx)
    name = mouth.name
    leg = Edge(f"{name}_leg_a", f"{name}_a", f"{name}_apex", Line(a, apex), seam_allowance_mm=0.0, dart=name)
    return [leg, replace(leg, name=f"{name}_leg_b", start=leg.end, end=f"{name}_b", curve=Line(apex, b))]
