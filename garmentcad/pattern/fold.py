"""Fold lines of a panel, from its internal lines, and the points in which they meet the outline."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np
from scipy.optimize import brentq

from garmentcad.errors import SpecError, did_you_mean
from garmentcad.geometry.curve import Curve
from garmentcad.geometry.portable import product
from garmentcad.pattern.outline import finish_loop
from garmentcad.pattern.pattern import Edge, FoldLine, Panel
from garmentcad.pattern.scope import Scope
from garmentcad.pattern.spec import PanelSpec, Pressed

_SAME_MM = 0.01
_SAMPLED = np.linspace(0.0, 1.0, 65)


def draft_folds(spec: PanelSpec, lines: Mapping[str, np.ndarray], scope: Scope, key: str) -> tuple[FoldLine, ...]:
    """Folds of a panel. SpecError: unknown line, a line without length, a name twice."""
    found: list[FoldLine] = []
    for k, fold in enumerate(spec.folds):
        where = f"{key}.folds.{k}"
        if fold.line not in lines:
            raise SpecError(f"no internal line is called {fold.line!r}{did_you_mean(fold.line, lines)}", key=f"{where}.line")
        points = lines[fold.line]
        if not np.any(points != points[:1]):
            raise SpecError(f"internal line {fold.line!r} has no length; a fold runs along a line", key=f"{where}.line")
        if any(other.name == fold.name for other in found):
            raise SpecError(f"a second fold is called {fold.name!r}; names of folds and pleats differ within a panel", key=f"{where}.name")
        angle = scope.number(fold.angle, f"{where}.angle", -180.0, 180.0)
        found.append(FoldLine(fold.name, points, angle, draft_strength(fold.strength, scope, where), draft_share(fold.pressed, scope, where)))
    return tuple(found)


def draft_strength(strength: float | str, scope: Scope, key: str) -> float:
    """Factor on the bending stiffness over a fold."""
    return scope.number(strength, f"{key}.strength", 0.1, 100.0)


def draft_share(pressed: Pressed, scope: Scope, key: str) -> float | None:
    """Share of the angle that stays; None: as the fibre lets stay."""
    if isinstance(pressed, bool):
        return None if pressed else 0.0
    return scope.number(pressed, f"{key}.pressed", 0.0, 1.0)


def cut_at_folds(panel: Panel) -> Panel:
    """The panel with its edges, those of cutouts too, cut where folds meet them: a particle lies there. The new points are called FOLD_1, FOLD_2, ...

    SpecError: a fold that goes through a dart or the depth of a pleat. Their legs are sewn to each other whole, and the cloth between them lies elsewhere.
    """
    taken = {*panel.points, *panel.drill_holes}
    loops = [[part for edge in loop for part in _cut_edge(edge, panel, taken)] for loop in (panel.edges, *panel.holes)]
    if not panel.folds or sum(map(len, loops)) == sum(len(loop) for loop in (panel.edges, *panel.holes)):
        return panel
    outline, *holes = (finish_loop(loop) for loop in loops)
    points = panel.points | {edge.start: edge.curve.start for loop in (outline, *holes) for edge in loop}
    return replace(panel, edges=outline, holes=tuple(holes), points=points)


def _cut_edge(edge: Edge, panel: Panel, taken: set[str]) -> list[Edge]:
    """The pieces of an edge; names of new points are added to `taken`."""
    found: list[tuple[float, str]] = []
    if not panel.folds:
        return [edge]
    length, drawn = edge.curve.length, sampled(edge.curve)
    for fold in panel.folds:
        for a, b in pairwise(fold.points_mm):
            for at in meeting(edge.curve, drawn, a, b):
                if all(abs(at - other) * length > _SAME_MM for other in (0.0, 1.0, *(done for done, _ in found))):
                    if edge.dart is not None:
                        x, y = edge.curve.points_at(at)[0]
                        text = f"the line goes through {edge.dart!r}, a dart or pleat, whose leg it crosses at ({x:.1f}, {y:.1f}) mm"
                        raise SpecError(f"{text}; end it at the point, or before it", key=f"panels.{panel.name}.folds.{fold.name}")
                    number = 1
                    while (name := f"{fold.name}_{number}") in taken:
                        number += 1
                    taken.add(name)
                    found.append((at, name))
    return cut_edge(edge, sorted(found))


def cut_edge(edge: Edge, cuts: Sequence[tuple[float, str]]) -> list[Edge]:
    """The pieces of an edge between `cuts`: rising arc-length fractions inside (0, 1), and the names of the points there."""
    if not cuts:
        return [edge]
    bounds = [(0.0, edge.start), *cuts, (1.0, edge.end)]
    pieces = []
    for k, ((a, start), (b, end), curve) in enumerate(zip(bounds, bounds[1:], edge.curve.split([at for at, _ in cuts]))):
        mine = [(name, at) for name, at in edge.notches if a <= at < b or (at == 1.0 and k == len(cuts))]
        pieces.append(replace(edge, start=start, end=end, curve=curve, notches=tuple((name, (at - a) / (b - a)) for name, at in mine)))
    return pieces


def sampled(curve: Curve) -> np.ndarray:
    """Points (N,2) of a curve, for `meeting`: between two of them it meets a line at most once."""
    return curve.points_at(_SAMPLED)


def meeting(curve: Curve, drawn: np.ndarray, a: np.ndarray, b: np.ndarray) -> list[float]:
    """Arc-length fractions at which a curve, whose `sampled` points are `drawn`, meets the straight line from a to b, which goes on by a hundredth of a
    millimetre at either end."""
    along = (b - a) / max(float(np.hypot(*(b - a))), 1e-12)

    def beside(at: float) -> float:
        x, y = curve.points_at(at)[0] - a
        return float(along[0] * y - along[1] * x)

    def crossing(low: float, high: float) -> float:
        """Points that are drawn one by one may round otherwise than all together: an end at which it meets the line then lies on the other side."""
        first, second = beside(low), beside(high)
        if first * second < 0.0:
            return float(brentq(beside, low, high))
        return low if abs(first) < abs(second) else high

    x, y = (drawn - a).T
    side = along[0] * y - along[1] * x
    if np.all(np.abs(side) < _SAME_MM):
        return []  # it runs along the line
    found = [float(at) for at in _SAMPLED[side == 0.0]]
    found += [crossing(float(_SAMPLED[k]), float(_SAMPLED[k + 1])) for k in np.flatnonzero(side[:-1] * side[1:] < 0.0)]
    reach = product(np.array([curve.points_at(at)[0] for at in found]).reshape(-1, 2) - a, along)
    return sorted(at for at, way in zip(found, reach) if -_SAME_MM <= way <= math.dist(a, b) + _SAME_MM)
