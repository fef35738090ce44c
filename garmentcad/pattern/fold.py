"""Fold lines and knife pleats of a panel, from its internal lines."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from garmentcad.errors import SpecError, did_you_mean
from garmentcad.pattern.pattern import FoldLine
from garmentcad.pattern.scope import Scope
from garmentcad.pattern.spec import FoldSpec, PanelSpec, PleatSpec

FOLD, UNDER = "_fold", "_under"  # what a pleat appends to its name for its two folds


def draft_folds(spec: PanelSpec, lines: Mapping[str, np.ndarray], scope: Scope, key: str) -> tuple[FoldLine, ...]:
    """Folds of a panel; a pleat is two, called NAME_fold and NAME_under. SpecError: unknown line, a line without length, a name twice."""
    found: list[FoldLine] = []

    def add(name: str, line: str, angle: float, drawn: FoldSpec | PleatSpec, where: str, line_key: str) -> None:
        if line not in lines:
            raise SpecError(f"no internal line is called {line!r}{did_you_mean(line, lines)}", key=f"{where}.{line_key}")
        points = lines[line]
        if not np.any(points != points[:1]):
            raise SpecError(f"internal line {line!r} has no length; a fold runs along a line", key=f"{where}.{line_key}")
        if any(fold.name == name for fold in found):
            raise SpecError(f"a second fold is called {name!r}; names of folds and pleats differ within a panel", key=f"{where}.name")
        strength = scope.number(drawn.strength, f"{where}.strength", 0.1, 100.0)
        found.append(FoldLine(name, points, angle, strength, _share(drawn, scope, f"{where}.pressed")))

    for k, fold in enumerate(spec.folds):
        where = f"{key}.folds.{k}"
        add(fold.name, fold.line, scope.number(fold.angle, f"{where}.angle", -180.0, 180.0), fold, where, "line")
    for k, pleat in enumerate(spec.pleats):
        where = f"{key}.pleats.{k}"
        angle = scope.number(pleat.angle, f"{where}.angle", 0.0, 180.0)
        add(pleat.name + FOLD, pleat.fold, -angle, pleat, where, "fold")
        add(pleat.name + UNDER, pleat.under, angle, pleat, where, "under")
    return tuple(found)


def _share(drawn: FoldSpec | PleatSpec, scope: Scope, key: str) -> float | None:
    if isinstance(drawn.pressed, bool):
        return None if drawn.pressed else 0.0
    return scope.number(drawn.pressed, key, 0.0, 1.0)
