"""Seams: runs by their end points become edge uses; lengths and notches along a side."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from garmentcad.errors import SpecError, did_you_mean
from garmentcad.pattern.names import SUFFIX
from garmentcad.pattern.pattern import EdgeUse, Panel, Pattern, Seam
from garmentcad.pattern.scope import Scope
from garmentcad.pattern.spec import SeamSpec

_SAME_MM = 0.01


def draft_seam(spec: SeamSpec, panels: Mapping[str, Panel], scope: Scope, key: str) -> Seam:
    """Seam of a spec. SpecError for unknown panels, edges, points, and for runs that do not lead from their first to their last point."""
    return Seam(
        spec.name,
        resolve_side(spec.a, panels, f"{key}.a"),
        resolve_side(spec.b, panels, f"{key}.b"),
        scope.number(spec.ease, f"{key}.ease", -0.9, 9.0),
        scope.number(spec.fold_angle, f"{key}.fold_angle", -180.0, 180.0),
        scope.number(spec.bend_factor, f"{key}.bend_factor", 0.0, 1000.0),
        None if spec.strength is None else scope.positive(spec.strength, f"{key}.strength"),
        order=spec.order,
        caught_in=spec.caught_in,
    )


def resolve_side(side: tuple[str, str] | list[tuple[str, str]], panels: Mapping[str, Panel], key: str) -> tuple[EdgeUse, ...]:
    """The edge pieces of one side in sewing order; dart legs inside a run are skipped."""
    if isinstance(side, tuple):
        return _resolve_run(side, panels, key)
    return tuple(use for k, run in enumerate(side) for use in _resolve_run(run, panels, f"{key}.{k}"))


def _resolve_run(run: tuple[str, str], panels: Mapping[str, Panel], key: str) -> tuple[EdgeUse, ...]:
    (panel_a, edge_a, first), (panel_b, edge_b, last) = (text.split(".") for text in run)
    _check_end(panels, panel_a, edge_a, first, f"{key}.0")
    _check_end(panels, panel_b, edge_b, last, f"{key}.1")
    if panel_a != panel_b:
        raise SpecError(f"the run starts on panel {panel_a!r} and ends on {panel_b!r}; write one run for each panel", key=key)
    edges = panels[panel_a].edges
    for reverse in (False, True):
        for where, edge in enumerate(edges):
            if edge.name == edge_a and (edge.end if reverse else edge.start) == first:
                uses = _walk(panels[panel_a], where, reverse, edge_a, edge_b, last)
                if uses:
                    return uses
    raise SpecError(
        f"no way along the outline leads from point {first!r} over edge {edge_a!r} to edge {edge_b!r} ending at {last!r}; a run starts at the far end "
        f"of its first edge and ends at the far end of its last one",
        key=key,
    )


def _walk(panel: Panel, where: int, reverse: bool, edge_a: str, edge_b: str, last: str) -> tuple[EdgeUse, ...]:
    """Pieces from index `where` along (or against) the outline until edge_b ends at the point `last`; empty when it never does."""
    uses = []
    step = -1 if reverse else 1
    for k in range(len(panel.edges)):
        index = (where + step * k) % len(panel.edges)
        edge = panel.edges[index]
        if edge.dart is None or edge.name in (edge_a, edge_b):
            uses.append(EdgeUse(panel.name, index, reverse))
        if edge.name == edge_b and (edge.start if reverse else edge.end) == last:
            return tuple(uses)
    return ()


def _check_end(panels: Mapping[str, Panel], panel: str, edge: str, point: str, key: str) -> None:
    if panel not in panels:
        raise SpecError(f"no panel is called {panel!r}{did_you_mean(panel, panels)}", key=key)
    pieces = [candidate for candidate in panels[panel].edges if candidate.name == edge]
    if not pieces:
        if any(candidate.name == edge for hole in panels[panel].holes for candidate in hole):
            raise SpecError(f"edge {edge!r} of panel {panel!r} belongs to a cutout; edges of cutouts cannot be sewn", key=key)
        hint = did_you_mean(edge, {candidate.name for candidate in panels[panel].edges})
        raise SpecError(f"panel {panel!r} has no edge {edge!r}{hint} (a mirror edge goes when the panel is unfolded)", key=key)
    ends = list(dict.fromkeys(name for piece in pieces for name in (piece.start, piece.end)))
    if point not in ends:
        raise SpecError(f"edge {edge!r} of panel {panel!r} does not end at {point!r}{did_you_mean(point, ends)}", key=key)


def side_length(pattern: Pattern, side: Sequence[EdgeUse]) -> float:
    """Length of a side of a seam, mm."""
    return sum(pattern.panels[use.panel].edges[use.edge].curve.length for use in side)


def side_notches(panels: Mapping[str, Panel], side: Sequence[EdgeUse]) -> list[tuple[str, float]]:
    """Notches along a side in sewing order: the name by which each meets one of the other side, and its distance from the first point, mm.

    Notches of one name at one place are one, as on the fold of an unfolded panel. Where a side goes over a drawn notch and its image, the image has the suffix.
    """
    marks, done = [], 0.0
    for use in side:
        edge = panels[use.panel].edges[use.edge]
        length = edge.curve.length
        marks += [(edge.image, use.panel, name, done + (1.0 - at if use.reverse else at) * length) for name, at in edge.notches]
        done += length
    drawn = {(panel, name) for image, panel, name, _ in marks if not image}
    found: list[tuple[str, float]] = []
    for image, panel, name, place in sorted(marks, key=lambda mark: mark[0]):  # what is drawn comes first
        if not any(name == other and abs(place - there) < _SAME_MM for other, there in found):
            found.append((name + SUFFIX if image and (panel, name) in drawn else name, place))
    return sorted(found, key=lambda notch: notch[1])
