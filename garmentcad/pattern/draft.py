"""Drafting: from a spec and a body's measurements to a Pattern."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from garmentcad.arrays import frozen
from garmentcad.errors import InputError, SpecError, did_you_mean
from garmentcad.pattern.darts import add_notches, cut_darts
from garmentcad.pattern.fold import cut_at_folds, draft_folds
from garmentcad.pattern.hardware import draft_hardware
from garmentcad.pattern.mirror import mirrored_panel, unfold
from garmentcad.pattern.names import check_made
from garmentcad.pattern.outline import draft_loop, finish_loop, is_counter_clockwise, reverse_edge
from garmentcad.pattern.parse import shown
from garmentcad.pattern.pattern import Edge, EdgeUse, Panel, Pattern, Seam, Transform, Wrap
from garmentcad.pattern.pleats import cut_pleats, pleat_seam
from garmentcad.pattern.region import draft_regions
from garmentcad.pattern.runs import draft_seam
from garmentcad.pattern.scope import Scope, make_scope, with_values
from garmentcad.pattern.spec import GarmentSpec, MirroredPanelSpec, PanelSpec, PlacementSpec, ZipSpec


def draft(spec: GarmentSpec, measurements_mm: Mapping[str, float], values: Mapping[str, float] | None = None) -> Pattern:
    """Pattern of a garment for a body: expressions evaluated, darts cut in, mirror unfolded, seams resolved.

    measurements_mm: names of docs/spec.md, as a mannequin has them; values: replaces values of parameters. SpecError or ExpressionError (with the spec's file
    and the key path) for the first fault; `draft_errors` gives all. InputError for arguments of other kinds.
    """
    if not isinstance(spec, GarmentSpec):
        raise InputError(f"a GarmentSpec is wanted, as read_spec reads it, came {shown(spec)}", key="spec")
    values = {} if values is None else values
    for key, named in (("measurements_mm", measurements_mm), ("values", values)):
        if not isinstance(named, Mapping):
            raise InputError(f"a mapping of names to numbers is wanted, came {shown(named)}", key=key)
    pattern, errors = draft_errors(with_values(spec, values), measurements_mm)
    if pattern is None:
        raise type(errors[0])(errors[0].message, file=errors[0].file, key=errors[0].key, others=errors[1:])
    return pattern


def draft_errors(spec: GarmentSpec, measurements_mm: Mapping[str, float]) -> tuple[Pattern | None, list[InputError]]:
    """As `draft`, but every fault that can be told apart is collected; the pattern is None when there is one."""
    errors: list[InputError] = []

    def keep(fault: InputError) -> None:
        errors.append(type(fault)(fault.message, file=fault.file or spec.file, key=fault.key))

    try:
        scope, parameters = make_scope(spec, measurements_mm)
    except InputError as fault:
        keep(fault)
        return None, errors
    panels: dict[str, Panel] = {}
    for name, drawn in spec.panels.items():
        if isinstance(drawn, PanelSpec):
            try:
                panels[name] = _draft_panel(name, drawn, scope)
            except InputError as fault:
                keep(fault)
    for name, image in spec.panels.items():
        if isinstance(image, MirroredPanelSpec):
            try:
                _check_source(spec, name, image)
                if image.mirrored_from in panels:  # else its own fault is reported
                    panels[name] = _draft_mirrored(name, image, panels[image.mirrored_from], scope)
            except InputError as fault:
                keep(fault)
    seams: list[Seam] = []
    holding = [seam.name for seam in spec.seams if seam.caught_in is None] + [closure.name for closure in spec.closures if isinstance(closure, ZipSpec)]
    for k, seam in enumerate(spec.seams):
        named = {text.split(".")[0] for side in (seam.a, seam.b) for run in ([side] if isinstance(side, tuple) else side) for text in run}
        if named & (spec.panels.keys() - panels.keys()):
            continue  # a panel of it has faults of its own
        try:
            if any(other.name == seam.name for other in seams):
                raise SpecError(f"a second seam is called {seam.name!r}; names of seams differ", key=f"seams.{k}.name")
            if seam.caught_in is not None and seam.caught_in not in holding:
                text = f"no seam that is itself not caught in another is called {seam.caught_in!r}{did_you_mean(seam.caught_in, holding)}"
                raise SpecError(text, key=f"seams.{seam.name}.caught_in")
            seams.append(draft_seam(seam, panels, scope, f"seams.{seam.name}"))
        except InputError as fault:
            keep(fault)
    if errors and len(panels) < len(spec.panels):
        return None, errors  # what lies on a panel with faults cannot be told
    pins, buttons, zips, bands = draft_hardware(spec, panels, scope, keep)
    if errors:
        return None, errors
    ordered = {name: panels[name] for name in spec.panels}
    every = (*(seam for panel in ordered.values() for seam in _dart_seams(panel)), *seams, *zips)
    return Pattern(spec.name, ordered, every, spec.fabric, spec.mannequin, parameters, dict(measurements_mm), pins, buttons, bands), []


def _draft_panel(name: str, spec: PanelSpec, scope: Scope) -> Panel:
    key = f"panels.{name}"
    points = {point: scope.point(pair, f"{key}.points.{point}") for point, pair in spec.points.items()}
    drawn = add_notches(draft_loop(spec.edges, points, scope, f"{key}.edges"), spec.notches, scope, f"{key}.notches")
    backward = not is_counter_clockwise(drawn, f"{key}.edges")
    outline = [reverse_edge(edge) for edge in reversed(drawn)] if backward else drawn
    edges = cut_darts(outline, spec.darts, backward, scope, f"{key}.darts")
    edges, laid = cut_pleats(edges, spec.pleats, backward, scope, f"{key}.pleats")
    points |= {edge.start: edge.curve.start for edge in edges}
    holes: list[tuple[Edge, ...]] = []
    for k, specs in enumerate(spec.cutouts):
        loop = draft_loop(specs, points, scope, f"{key}.cutouts.{k}")
        turned = [reverse_edge(edge) for edge in reversed(loop)] if is_counter_clockwise(loop, f"{key}.cutouts.{k}") else loop
        taken = {edge.name for edge in edges} | {edge.name for hole in holes for edge in hole}
        for edge in loop:
            if edge.name in taken:
                raise SpecError(f"a second edge is called {edge.name!r}; names of edges differ within a panel", key=f"{key}.cutouts.{k}")
        holes.append(finish_loop(turned))
    lines = {
        line: frozen(np.array([scope.point(pair, f"{key}.internal_lines.{line}.{k}") for k, pair in enumerate(pairs)]).reshape(-1, 2))
        for line, pairs in spec.internal_lines.items()
    }
    panel = Panel(
        name=name,
        edges=finish_loop(edges),
        grain_deg=scope.number(spec.grain, f"{key}.grain", -360.0, 360.0),
        placement=_placement(spec.placement, scope, f"{key}.placement"),
        fabric=spec.fabric,
        interfacing=spec.interfacing,
        layer=spec.layer,
        quantity=spec.quantity,
        holes=tuple(holes),
        regions=draft_regions(spec, edges, scope, key),
        folds=(*draft_folds(spec, lines, scope, key), *laid),
        internal_lines=lines,
        drill_holes={hole: scope.point(pair, f"{key}.drill_holes.{hole}") for hole, pair in spec.drill_holes.items()},
        points=points,
    )
    check_made(spec, panel, key)
    return cut_at_folds(panel if spec.mirror is None else unfold(panel, spec.mirror, f"{key}.mirror"))


def _check_source(spec: GarmentSpec, name: str, image: MirroredPanelSpec) -> None:
    source = spec.panels.get(image.mirrored_from)
    if not isinstance(source, PanelSpec):
        drawn = [other for other, panel in spec.panels.items() if isinstance(panel, PanelSpec)]
        raise SpecError(f"{image.mirrored_from!r} is not a drawn panel{did_you_mean(image.mirrored_from, drawn)}", key=f"panels.{name}.mirrored_from")


def _draft_mirrored(name: str, image: MirroredPanelSpec, source: Panel, scope: Scope) -> Panel:
    panel = mirrored_panel(source, name, _placement(image.placement, scope, f"panels.{name}.placement"))
    return replace(
        panel,
        fabric=image.fabric if image.fabric is not None else panel.fabric,
        layer=image.layer if image.layer is not None else panel.layer,
        quantity=image.quantity if image.quantity is not None else panel.quantity,
    )


def _placement(spec: PlacementSpec, scope: Scope, key: str) -> Wrap | Transform:
    if spec.wrap is not None:
        wrap, key = spec.wrap, f"{key}.wrap"
        flare, spiral = scope.number(wrap.flare, f"{key}.flare", -89.0, 89.0), scope.number(wrap.spiral, f"{key}.spiral", -200.0, 200.0)
        if flare != 0.0 and spiral != 0.0:
            raise SpecError("a panel goes on a cone (flare) or on a spiral, not on both", key=f"{key}.spiral")
        return Wrap(
            part=wrap.part,
            anchor_mm=scope.point(wrap.anchor, f"{key}.anchor"),
            angle_deg=scope.number(wrap.angle, f"{key}.angle", -360.0, 360.0),
            height_mm=scope.number(wrap.height, f"{key}.height", -5000.0, 5000.0),
            offset_mm=scope.number(wrap.offset, f"{key}.offset", -1000.0, 5000.0),
            scale=scope.number(wrap.scale, f"{key}.scale", 0.1, 10.0),
            turn_deg=scope.number(wrap.turn, f"{key}.turn", -360.0, 360.0),
            flare_deg=flare,
            spiral_mm=spiral,
        )
    assert spec.transform is not None  # the model allows no third form
    transform, key = spec.transform, f"{key}.transform"
    x, y, z = (scope.number(transform.translation[k], f"{key}.translation.{k}", -20_000.0, 20_000.0) for k in range(3))
    about_x, about_y, about_z = (scope.number(transform.rotation[k], f"{key}.rotation.{k}", -360.0, 360.0) for k in range(3))
    return Transform((x, y, z), (about_x, about_y, about_z))


def _dart_seams(panel: Panel) -> list[Seam]:
    """One seam for each dart and pleat, called panel.dart: the leg toward the apex meets the leg from it, mouth to mouth."""
    seams = []
    for k, edge in enumerate(panel.edges):
        after = (k + 1) % len(panel.edges)
        if edge.dart is not None and panel.edges[after].dart == edge.dart:
            seam = Seam(f"{panel.name}.{edge.dart}", (EdgeUse(panel.name, k, False),), (EdgeUse(panel.name, after, True),))
            seams.append(pleat_seam(seam, panel))
    return seams
