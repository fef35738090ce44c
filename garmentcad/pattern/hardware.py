"""Pins, buttons, zips, elastics and belts of a spec on the panels of a pattern."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, TypeVar

from garmentcad.errors import InputError, SpecError, did_you_mean
from garmentcad.pattern.pattern import Band, Button, EdgeUse, Panel, PanelPoint, Pin, Seam
from garmentcad.pattern.runs import resolve_side
from garmentcad.pattern.scope import MAX_COORDINATE_MM, Scope
from garmentcad.pattern.spec import BeltSpec, ButtonSpec, ElasticSpec, GarmentSpec, LineSpec, PinSpec, SpacePoint, ZipSpec

_Made = TypeVar("_Made")
_LARGEST_STIFFNESS_N = 1e6


def draft_hardware(
    spec: GarmentSpec, panels: Mapping[str, Panel], scope: Scope, keep: Callable[[InputError], None]
) -> tuple[tuple[Pin, ...], tuple[Button, ...], tuple[Seam, ...], tuple[Band, ...]]:
    """Pins, buttons, zips (seams that are partly closed) and bands. keep: is given every fault; what has one is left out."""
    buttons: list[tuple[str, Any]] = [(f"closures.{k}", closure) for k, closure in enumerate(spec.closures) if isinstance(closure, ButtonSpec)]
    zips: list[tuple[str, Any]] = [(f"closures.{k}", closure) for k, closure in enumerate(spec.closures) if isinstance(closure, ZipSpec)]
    pins: list[tuple[str, Any]] = [(f"pins.{k}", pin) for k, pin in enumerate(spec.pins)]
    elastics: list[tuple[str, Any]] = [(f"elastics.{k}", elastic) for k, elastic in enumerate(spec.elastics)]
    belts: list[tuple[str, Any]] = [(f"belts.{k}", belt) for k, belt in enumerate(spec.belts)]
    taken = {seam.name for seam in spec.seams}
    for key, part in [*buttons, *zips, *pins, *elastics, *belts]:
        if part.name in taken:
            keep(SpecError(f"the name {part.name!r} is given twice; seams, closures, pins, elastics and belts have names of their own", key=f"{key}.name"))
        taken.add(part.name)

    def drafted(make: Callable[[Any, Mapping[str, Panel], Scope, str], _Made], parts: Sequence[tuple[str, Any]]) -> tuple[_Made, ...]:
        found = []
        for key, part in parts:
            try:
                found.append(make(part, panels, scope, key))
            except InputError as fault:
                keep(fault)
        return tuple(found)

    return drafted(_pin, pins), drafted(_button, buttons), drafted(_zip, zips), drafted(_elastic, elastics) + drafted(_belt, belts)


def _pin(spec: PinSpec, panels: Mapping[str, Panel], scope: Scope, key: str) -> Pin:
    if spec.landmark is None:
        assert spec.point is not None  # the model allows no third form
        if any(part != 0.0 for part in spec.offset):
            raise SpecError("an offset belongs to a landmark; move the point itself", key=f"{key}.offset")
        place = _space_point(spec.point, scope, f"{key}.point")
    else:
        place = _space_point(spec.offset, scope, f"{key}.offset")
    return Pin(spec.name, _panel_point(spec.at, panels, f"{key}.at"), spec.landmark, place)


def _button(spec: ButtonSpec, panels: Mapping[str, Panel], scope: Scope, key: str) -> Button:
    button, hole = (_panel_point(name, panels, f"{key}.{end}") for name, end in ((spec.button, "button"), (spec.buttonhole, "buttonhole")))
    if button == hole:
        raise SpecError(f"button and buttonhole are the same point {spec.button!r}", key=key)
    return Button(spec.name, button, hole, spec.order)


def _zip(spec: ZipSpec, panels: Mapping[str, Panel], scope: Scope, key: str) -> Seam:
    return Seam(
        spec.name,
        resolve_side(spec.zip.a, panels, f"{key}.zip.a"),
        resolve_side(spec.zip.b, panels, f"{key}.zip.b"),
        bend_factor=scope.number(spec.bend_factor, f"{key}.bend_factor", 0.0, 1000.0),
        closed=scope.number(spec.closed, f"{key}.closed", 0.0, 1.0),
    )


def _elastic(spec: ElasticSpec, panels: Mapping[str, Panel], scope: Scope, key: str) -> Band:
    stiffness = scope.number(spec.stiffness, f"{key}.stiffness", 1e-3, _LARGEST_STIFFNESS_N)
    return Band(spec.name, _lines(spec.along, panels, f"{key}.along"), stiffness, ratio=scope.number(spec.ratio, f"{key}.ratio", 0.1, 1.5))


def _belt(spec: BeltSpec, panels: Mapping[str, Panel], scope: Scope, key: str) -> Band:
    stiffness = scope.number(spec.stiffness, f"{key}.stiffness", 1e-3, _LARGEST_STIFFNESS_N)
    return Band(spec.name, _lines(spec.along, panels, f"{key}.along"), stiffness, length_mm=scope.positive(spec.length, f"{key}.length"))


def _lines(lines: Sequence[LineSpec], panels: Mapping[str, Panel], key: str) -> tuple[tuple[EdgeUse, ...] | tuple[PanelPoint, PanelPoint], ...]:
    found: list[tuple[EdgeUse, ...] | tuple[PanelPoint, PanelPoint]] = []
    seen: set[frozenset[str]] = set()
    for k, line in enumerate(lines):
        where = f"{key}.{k}"
        ends = frozenset(line)
        if ends in seen:
            raise SpecError(f"the line from {line[0]!r} to {line[1]!r} is given twice; each line of an elastic or a belt stands there once", key=where)
        seen.add(ends)
        parts = [name.count(".") for name in line]
        if parts[0] != parts[1]:
            raise SpecError("both ends of a line are written panel.edge.point (along the outline) or both panel.point (straight across the panel)", key=where)
        if parts[0] == 2:
            found.append(resolve_side(line, panels, where))
            continue
        a, b = (_panel_point(name, panels, f"{where}.{end}") for end, name in enumerate(line))
        if a.panel != b.panel or a.uv_mm == b.uv_mm:
            raise SpecError(f"a straight line joins two different points of one panel, came {line[0]!r} and {line[1]!r}", key=where)
        found.append((a, b))
    return tuple(found)


def _panel_point(text: str, panels: Mapping[str, Panel], key: str) -> PanelPoint:
    panel, name = text.split(".")
    if panel not in panels:
        raise SpecError(f"no panel is called {panel!r}{did_you_mean(panel, panels)}", key=key)
    known = panels[panel].points | panels[panel].drill_holes
    if name not in known:
        raise SpecError(f"panel {panel!r} has no point and no drill hole {name!r}{did_you_mean(name, known)}", key=key)
    return PanelPoint(panel, name, known[name])


def _space_point(triple: SpacePoint, scope: Scope, key: str) -> tuple[float, float, float]:
    x, y, z = (scope.number(triple[k], f"{key}.{k}", -MAX_COORDINATE_MM, MAX_COORDINATE_MM) for k in range(3))
    return x, y, z
