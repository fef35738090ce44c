"""Knife pleats: folds laid square to a straight edge, whose depth is caught in the seam of that edge.

Along the edge a pleat shows its fold at s; the cloth turns back for `depth` to its under fold at s + depth and forth again, so that the edge is seen anew from
s + 2 depth on. Both hidden stretches are cut out of the edge, as a dart is: they are the legs of a seam whose apex is the under fold, and runs skip them.
That apex lies over the point s - depth of the edge and is tacked to it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from garmentcad.errors import SpecError
from garmentcad.geometry.curve import Line
from garmentcad.geometry.portable import product
from garmentcad.pattern.darts import find_edge, place_fraction
from garmentcad.pattern.fold import cut_edge, draft_share, draft_strength, meeting, sampled
from garmentcad.pattern.pattern import Edge, EdgeUse, FoldLine, Panel, Seam
from garmentcad.pattern.scope import MAX_COORDINATE_MM, Scope
from garmentcad.pattern.spec import PleatsSpec

FOLD, UNDER = "_fold", "_under"  # what a pleat appends to its name for its two folds
_MOST = 100
_SAME_MM = 0.01


def cut_pleats(edges: Sequence[Edge], pleats: Sequence[PleatsSpec], drawn_backward: bool, scope: Scope, key: str) -> tuple[list[Edge], tuple[FoldLine, ...]]:
    """A counter-clockwise loop with its pleats cut in, and their folds NAME_k_fold and NAME_k_under from the edge across the panel.

    Points NAME_k_a (over which the depth ends), NAME_k_fold, NAME_k_under, NAME_k_b, edges NAME_k_leg_a, NAME_k_leg_b. SpecError: unknown or curved edge, a
    name twice, pleats that lie over each other, over an end of the edge or over a notch.
    """
    loop, folds = list(edges), list[FoldLine]()
    for number, spec in enumerate(pleats):
        where = f"{key}.{number}"
        if any(other.name == spec.name for other in pleats[:number]):
            raise SpecError(f"second pleats are called {spec.name!r}; names of folds and pleats differ within a panel", key=f"{where}.name")
        index = find_edge(loop, spec.edge, f"{where}.edge")
        edge = loop[index]
        if not isinstance(edge.curve, Line) or sum(other.name == edge.name for other in loop) > 1:
            raise SpecError(f"edge {edge.name!r} is curved, or cut by a dart or by other pleats; pleats are folded from one straight edge", key=f"{where}.edge")
        at, toward = _places(spec, edge, drawn_backward, scope, where)
        depth = toward * scope.positive(spec.depth, f"{where}.depth")
        marks = [(place - depth, place, place + depth, place + 2.0 * depth) for place in at]
        _check_room(spec, edge, marks, where)
        folds += _folds(spec, edge, edges, marks, scope, where)
        loop[index : index + 1] = _cut(spec, edge, marks, where)
    return loop, tuple(folds)


def _places(spec: PleatsSpec, edge: Edge, drawn_backward: bool, scope: Scope, key: str) -> tuple[list[float], float]:
    """Where the pleats show their folds, mm along the counter-clockwise edge, and the direction in which each goes on to its under fold."""
    count = scope.number(spec.count, f"{key}.count", 1.0, _MOST)
    if count != round(count):
        raise SpecError(f"came {count:g}; a whole number of pleats is wanted", key=f"{key}.count")
    if spec.every is None and count > 1:
        raise SpecError("more than one pleat needs the distance from one to the next on the flat panel, mm", key=f"{key}.every")
    every = 0.0 if spec.every is None else scope.positive(spec.every, f"{key}.every")
    drawn = replace(edge, start=edge.end, end=edge.start) if drawn_backward else edge
    fraction = place_fraction(spec.at, drawn, scope, f"{key}.at")
    first = (1.0 - fraction if drawn_backward else fraction) * edge.curve.length
    toward = 1.0 if spec.at.start == edge.start else -1.0
    return [first + toward * k * every for k in range(round(count))], toward


def _check_room(spec: PleatsSpec, edge: Edge, marks: Sequence[tuple[float, float, float, float]], key: str) -> None:
    free, length = 0.0, edge.curve.length
    for k, places in enumerate(marks):
        first, *_, last = places if spec.at.start == edge.start else (length - place for place in places)
        if first < free - _SAME_MM or last > length + _SAME_MM:
            raise SpecError(
                f"pleat {k + 1} takes {first:.1f} to {last:.1f} mm of edge {edge.name!r} from {spec.at.start!r} on, with the cloth over its depth; free is "
                f"{free:.1f} to {length:.1f} mm: pleats may meet, but not lie over each other or over an end of the edge",
                key=key,
            )
        free = last


def _folds(spec: PleatsSpec, edge: Edge, edges: Sequence[Edge], marks: Sequence[tuple[float, float, float, float]], scope: Scope, key: str) -> list[FoldLine]:
    angle = scope.number(spec.angle, f"{key}.angle", 90.0, 180.0)
    more = draft_strength(spec.strength, scope, key), draft_share(spec.pressed, scope, key), True
    start, along = np.array(edge.curve.start), edge.curve.tangents_at(0.5)[0]
    inward = np.array([-along[1], along[0]])  # the inside lies left of a counter-clockwise outline
    drawn = [(other, sampled(other.curve)) for other in edges]
    found = []
    for k, (_, fold, under, _) in enumerate(marks):
        for name, place, turn in ((FOLD, fold, -angle), (UNDER, under, angle)):
            begin = start + place * along
            ray = begin + _SAME_MM * 10.0 * inward, begin + MAX_COORDINATE_MM * inward
            hits = [other.curve.points_at(at)[0] for other, points in drawn for at in meeting(other.curve, points, *ray)]
            if not hits:
                raise SpecError(f"the folds of pleat {k + 1} run from edge {spec.edge!r} across the panel and meet no other edge of it", key=key)
            end = min(hits, key=lambda hit: float(product(hit - begin, inward)))
            found.append(FoldLine(f"{spec.name}_{k + 1}{name}", np.array([begin, end]), turn, *more))
    return found


def _cut(spec: PleatsSpec, edge: Edge, marks: Sequence[tuple[float, float, float, float]], key: str) -> list[Edge]:
    """The pieces of the edge, hidden ones as the legs of a dart."""
    length = edge.curve.length
    cuts: list[tuple[float, str]] = []
    for k, places in enumerate(marks):
        for place, suffix in zip(places, ("_a", FOLD, UNDER, "_b")):
            if all(abs(place - other) > _SAME_MM for other in (0.0, length, *(at * length for at, _ in cuts))):
                cuts.append((place / length, f"{spec.name}_{k + 1}{suffix}"))
    pieces = []
    for piece in cut_edge(edge, sorted(cuts)):
        middle = product((np.array(piece.curve.start) + np.array(piece.curve.end) - 2.0 * np.array(edge.curve.start)) / 2.0, edge.curve.tangents_at(0.5)[0])
        for k, (_, fold, under, again) in enumerate(marks):
            for suffix, a, b in (("_leg_a", fold, under), ("_leg_b", under, again)):
                if min(a, b) < middle < max(a, b):
                    if piece.notches:
                        raise SpecError(f"notch {piece.notches[0][0]!r} of edge {edge.name!r} lies in the depth of a pleat; move it out", key=key)
                    name = f"{spec.name}_{k + 1}"
                    piece = replace(piece, name=name + suffix, role=None, seam_allowance_mm=0.0, dart=name)
        pieces.append(piece)
    return pieces


def pleat_seam(seam: Seam, panel: Panel) -> Seam:
    """The seam of a dart as it is; that of a pleat with its tack, and without a hinge, which would open it."""
    first, second = panel.edges[seam.a[0].edge].curve, panel.edges[seam.b[0].edge].curve
    for fold in panel.folds:
        begin = fold.points_mm[0]
        if fold.laid and fold.angle_deg < 0.0 and min(math.dist(begin, first.start), math.dist(begin, second.end)) < _SAME_MM:
            over = 2.0 * begin - first.end
            piece = min(range(len(panel.edges)), key=lambda k: math.dist(panel.edges[k].curve.start, over))
            return replace(seam, bend_factor=0.0, tack=EdgeUse(panel.name, piece, False))
    return seam
