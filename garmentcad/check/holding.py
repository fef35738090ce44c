"""Findings on what holds a garment on the body: nothing, too wide a waist, a slack elastic, a belt over an open garment."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from garmentcad.check.body_part import BodyPart
from garmentcad.check.finding import Finding
from garmentcad.check.hardware import line_mm
from garmentcad.check.unsewn import check_apart, panels_together
from garmentcad.cloth.cloth import Cloth
from garmentcad.cloth.locate import located
from garmentcad.mannequin.mannequin import Mannequin
from garmentcad.pattern.pattern import Band, EdgeUse, Pattern, Wrap
from garmentcad.units import M_TO_MM

_LEAST_MM = 3.0
_SLIDES_M = 0.100  # an elastic is meant to hold where it is sewn; waists of cloth find their place on the hip
_FREE_M = 0.050  # of a belt from line to line


def check_held(pattern: Pattern, sewn: Cloth, ringed: np.ndarray, file: str | None) -> Iterator[Finding]:
    """What is sewn together and held by nothing, or held and joined to nothing else. ringed (panels,): whether a ring goes over the panel."""
    points = [pin.at for pin in pattern.pins] + [end for button in pattern.buttons for end in (button.button, button.buttonhole)]
    holding = {point.panel for point in points} | {line[0].panel for band in pattern.bands for line in band.lines}
    held = ringed | np.isin(sewn.panel_names, sorted(holding))
    together = panels_together(sewn)
    loose = ~np.isin(together, together[held])
    if loose.all():
        yield Finding(
            "warning", "holds-nowhere", file, "panels",
            "sewn as it is placed, no closed ring of cloth goes around the trunk, the neck, an arm or a leg, and there is no button, pin or band: it may fall",
            "Place the panels around the body (the back of a garment at the angle 180), sew what is open, or hold it by buttons, pins or a belt.",
        )  # fmt: skip
        return
    for part in np.unique(together[loose]):
        names = [sewn.panel_names[panel] for panel in np.flatnonzero(together == part)]
        yield Finding(
            "warning", "holds-nowhere", file, f"panels.{names[0]}",
            f"{', '.join(names)}: not sewn to the rest of the garment, and no ring of cloth around the body, no button, pin or band holds it: it may fall",
            "Sew it to the rest, or hold it by buttons or pins.",
        )  # fmt: skip
    yield from check_apart(pattern, sewn, loose, file)


def check_falling(
    pattern: Pattern, sewn: Cloth, positions: np.ndarray, trunk: BodyPart, rings: list[tuple[float, float]], body: Mannequin, file: str | None
) -> Iterator[Finding]:
    """A garment that hangs from nothing and is wider around the trunk than all that lies below. positions (P,3) m; rings: levels, m, and lengths, mm."""
    height = M_TO_MM * float(positions[:, 1].max())
    on_arms = any(isinstance(panel.placement, Wrap) and panel.placement.part.startswith("arm") for panel in pattern.panels.values())
    if on_arms or pattern.pins or pattern.buttons or height > body.measurements_mm.get("shoulder_height", np.inf):
        return
    drops = []
    for level, length, name in _around(pattern, sewn, positions, trunk, rings):
        held_at = trunk.levels[(trunk.levels <= level) & (trunk.girths > length - _LEAST_MM)]
        drops.append((level - float(held_at.max(initial=-np.inf)), level, length, name))
    if not drops:
        return
    drop, level, length, name = min(drops)
    if not np.isfinite(drop):
        _, level, length, _ = min(drops, key=lambda found: found[2])
        widest = float(trunk.girths[trunk.levels <= level].max(initial=0.0))
        yield Finding(
            "warning", "falls-down", file, None,
            f"nothing holds the garment up: where it is narrowest around the trunk, {level * M_TO_MM:.0f} mm up, it measures {length:.0f} mm, "
            f"and the body below nowhere more than {widest:.0f} mm",
            "Give it a waist, an elastic or a belt of about the girth that it shall hold to, or straps over the shoulders.",
        )  # fmt: skip
    elif drop > _SLIDES_M and any(band.name == name and band.ratio is not None for band in pattern.bands):
        girth = float(np.interp(level, trunk.levels, trunk.girths))
        yield Finding(
            "warning", "slides-down", file, f"elastics.{name}",
            f"{level * M_TO_MM:.0f} mm up the garment measures {length:.0f} mm with its elastic at rest, and the body {girth:.0f} mm: "
            f"it is slack there, and slides down by {drop * M_TO_MM:.0f} mm",
            "Make the ratio smaller, so that the elastic is shorter than the body's girth.",
        )  # fmt: skip


def _around(pattern: Pattern, sewn: Cloth, positions: np.ndarray, trunk: BodyPart, rings: list[tuple[float, float]]) -> Iterator[tuple[float, float, str]]:
    """Level, m, and length at rest, mm, of what goes around the trunk: rings of cloth (without a name), the nearest of them drawn in by an elastic, belts."""
    yield from ((level, length, "") for level, length in rings)
    for band in pattern.bands:
        level = _level(pattern, sewn, positions, trunk, band)
        if band.length_mm is not None:
            yield level, band.length_mm, band.name
        elif rings and band.ratio is not None and band.ratio < 1.0:
            _, length = min(rings, key=lambda ring: abs(ring[0] - level))
            yield level, length - (1.0 - band.ratio) * sum(line_mm(pattern, line) for line in band.lines), band.name


def check_belts(pattern: Pattern, sewn: Cloth, positions: np.ndarray, trunk: BodyPart, reach: float, file: str | None) -> Iterator[Finding]:
    """Belts over cloth that does not go around the trunk. positions (P,3) m; reach: how far, m, the cloth may come to lie from where it is placed."""
    for band in pattern.bands:
        rules = [pattern.panels[line[0].panel].placement for line in band.lines]
        girths = trunk.girths_near(_level(pattern, sewn, positions, trunk, band), reach)
        if band.length_mm is None or len(girths) == 0 or any(isinstance(rule, Wrap) and rule.part != "torso" for rule in rules):
            continue
        ends = _ends(pattern, sewn, positions, band)
        free = float(np.linalg.norm(np.roll(ends[:, 0], -1, axis=0) - ends[:, 1], axis=1).max())
        along, girth = sum(line_mm(pattern, line) for line in band.lines), float(girths.min())
        if free > _FREE_M and along < girth - _FREE_M * M_TO_MM:
            yield Finding(
                "warning", "belt-through-body", file, f"belts.{band.name}.along",
                f"the belt runs over {along:.0f} mm of cloth, and the body measures {girth:.0f} mm there: from line to line it is a straight line, "
                f"and over the missing {girth - along:.0f} mm goes through the body",
                "A belt needs cloth all around: lead it over panels that meet or overlap, or hold an open garment by pins.",
            )  # fmt: skip


def _ends(pattern: Pattern, sewn: Cloth, positions: np.ndarray, band: Band) -> np.ndarray:
    """First and last points (L,2,3) m of the lines of a band."""
    found = np.empty((len(band.lines), 2, 3))
    for k, line in enumerate(band.lines):
        places = []
        for end, last in ((line[0], False), (line[-1], True)):
            if isinstance(end, EdgeUse):
                curve = pattern.panels[end.panel].edges[end.edge].curve
                places.append(curve.start if end.reverse == last else curve.end)
            else:
                places.append(end.uv_mm)
        place = located(sewn, sewn.panel_names.index(line[0].panel), np.array(places))
        found[k] = np.einsum("nc,ncx->nx", place.weights, positions[sewn.vertex_particle[place.vertices]])
    return found


def _level(pattern: Pattern, sewn: Cloth, positions: np.ndarray, part: BodyPart, band: Band) -> float:
    """Mean level along a part, m, of the ends of a band's lines."""
    return float((_ends(pattern, sewn, positions, band) @ part.axis).mean())
