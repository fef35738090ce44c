"""Findings on pins, buttons, elastics and belts: what cannot hold together, what holds the same twice, and lengths and places in other units."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator

import numpy as np

from garmentcad.analysis.inside import SHALLOW_M
from garmentcad.analysis.penetration import signed_distances
from garmentcad.check.body_part import HURTS_PA
from garmentcad.check.doctor import refusal
from garmentcad.check.finding import Finding
from garmentcad.cloth.cloth import Cloth
from garmentcad.cloth.locate import located
from garmentcad.cloth.weld import weld
from garmentcad.errors import InputError
from garmentcad.fabric.material import MaterialTable
from garmentcad.forces.band_lines import band_segments
from garmentcad.mannequin.mannequin import Mannequin
from garmentcad.pattern.pattern import EdgeUse, PanelPoint, Pattern, Pin
from garmentcad.pattern.runs import side_length
from garmentcad.solve.hardware import hardware_rows, redundance_message, redundances
from garmentcad.units import M_TO_MM, MM_TO_M

_GATHERED = 3.0  # a belt draws no more cloth together, and hangs around no body that is so many times slimmer: a length in cm or inches, say
_PARALLEL, _NEAR_M, _BESIDE_M = 0.9, 0.1, 0.3  # cosine between the layers of a button, and distances to its hole: over each other as placed, or beside
_INSIDE_M = 0.001  # layers nearer to each other say nothing
_WIDEST_M, _WAIST_MM = 0.1, 700.0  # of an elastic, and of a body that does not say; estimates
_FAR_M = 0.5  # between a pin and the point that it holds, as placed
_CROSSED_M = 0.05  # between two pins of a panel, and between the points that they hold: nearer ones may turn it as they like


def check_hardware(
    pattern: Pattern, flat: Cloth, positions: np.ndarray, materials: MaterialTable, mannequin: Mannequin, file: str | None = None
) -> Iterator[Finding]:
    """flat: the unsewn cloth of the pattern; positions: (V,3) m of its vertices as placed."""
    if not (pattern.pins or pattern.buttons or pattern.bands):
        return
    try:
        cloth, _ = weld(flat)
        rows = hardware_rows(pattern, cloth, materials, mannequin)
        band_segments(pattern, cloth)
    except InputError as error:
        yield refusal(type(error)(error.message, file=error.file or file, key=error.key))
        return
    for found in redundances(rows, cloth, mannequin):
        yield Finding(
            "warning", "redundant-constraints", file, None, redundance_message(found),
            "Leave one of them out; all of them are solved together as they are." if len(found.names) > 1 else "Leave it out, or move one of its points.",
        )  # fmt: skip
    yield from _check_pins(pattern, flat, positions, mannequin, file)
    yield from _check_buttons(pattern, flat, positions, file)
    yield from _check_elastics(pattern, mannequin, file)
    yield from _check_belts(pattern, mannequin, file)


def _check_pins(pattern: Pattern, flat: Cloth, positions: np.ndarray, mannequin: Mannequin, file: str | None) -> Iterator[Finding]:
    held: list[tuple[Pin, np.ndarray, np.ndarray]] = []
    for pin in pattern.pins:
        target = MM_TO_M * np.array(pin.offset_mm) + (0.0 if pin.landmark is None else mannequin.landmarks[pin.landmark])
        key = f"pins.{pin.name}.{'point' if pin.landmark is None else 'landmark'}"
        depth = -float(signed_distances(target[None], mannequin.vertices, mannequin.faces)[0])
        if pin.landmark is None and depth > 0.0:  # those to a landmark stand clear of the body by themselves
            yield Finding(
                "error" if depth > SHALLOW_M else "warning", "pin-inside-body", file, key,
                f"the point lies {depth * M_TO_MM:.0f} mm deep in {mannequin.name}, where no cloth can be",
                "Move it out of the body, or pin to a landmark, which keeps clear of it.",
            )  # fmt: skip
        placed = _on_panel(flat, positions, pin.at)[0]
        held.append((pin, placed, target))
        away = float(np.linalg.norm(placed - target))
        if away > _FAR_M:
            yield Finding(
                "warning", "pin-far", file, key, f"{pin.at} starts {away * M_TO_MM:.0f} mm from where the pin holds it",
                "Points are in mm, y is the height above the floor; correct the point, or place the panel near it.",
            )  # fmt: skip

    for (one, placed, target), (other, beside, aim) in itertools.combinations(held, 2):
        lies, drawn = placed - beside, target - aim
        apart = np.linalg.norm(lies), np.linalg.norm(drawn)
        if one.at.panel == other.at.panel and min(apart) > _CROSSED_M and lies @ drawn < -_PARALLEL * apart[0] * apart[1]:
            yield Finding(
                "warning", "pins-crossed", file, f"pins.{other.name}",
                f"{other.at} is drawn to where {one.at} starts and the other way round: the pins '{one.name}' and '{other.name}' turn {one.at.panel} over",
                "Swap the two, or lay the panel the other way round: seen from outside, +x of a panel on the back is the wearer's right.",
            )  # fmt: skip


def _check_buttons(pattern: Pattern, flat: Cloth, positions: np.ndarray, file: str | None) -> Iterator[Finding]:
    """Buttonholes that start on the wrong side of their buttons. Where the layers do not lie over each other as placed, nothing is known."""
    for button in pattern.buttons:
        (low, outward), (high, beside) = (_on_panel(flat, positions, point) for point in (button.button, button.buttonhole))
        between = outward + beside  # a hole beside its button on one round layer lies square to this
        inside, apart = (low - high) @ between / np.linalg.norm(between), np.linalg.norm(high - low)
        # On one layer that is round between them one may lie deeper than the other, along the way the layer turns by half its angle at most.
        round_m = 0.0 if apart < _NEAR_M else 0.5 * abs((low - high) @ (outward - beside))
        if outward @ beside > _PARALLEL and apart < _BESIDE_M and inside > _INSIDE_M + round_m:
            yield Finding(
                "warning", "button-inside", file, f"closures.{button.name}",
                f"the buttonhole {button.buttonhole} starts {inside * M_TO_MM:.0f} mm inside its button {button.button}; it has to lie outside, "
                "on the right side of the button's panel",
                f"Give {button.buttonhole.panel} a larger offset than {button.button.panel}, or swap button and buttonhole.",
            )  # fmt: skip


def _on_panel(flat: Cloth, positions: np.ndarray, point: PanelPoint) -> tuple[np.ndarray, np.ndarray]:
    """Place (3,) m of a point of a panel, and the unit normal (3,) of the panel's right side there. positions: (V,3) m of the vertices of the unsewn cloth."""
    place = located(flat, flat.panel_names.index(point.panel), np.array([point.uv_mm]))
    a, b, c = positions[place.vertices[0]]
    normal = np.cross(b - a, c - a)
    return place.weights[0] @ np.array([a, b, c]), normal / np.linalg.norm(normal)


def _check_elastics(pattern: Pattern, mannequin: Mannequin, file: str | None) -> Iterator[Finding]:
    """Elastics longer than what they are sewn to, and those that pull harder than the widest usual one may around the waist before it hurts. They are drawn out
    to the length of their cloth, and gathered cloth not beyond the body."""
    girth = _largest_girth(mannequin)
    most = HURTS_PA * _WIDEST_M * MM_TO_M * mannequin.measurements_mm.get("waist", _WAIST_MM) / (2.0 * math.pi)
    for band in pattern.bands:
        if band.ratio is None:
            continue
        along = sum(line_mm(pattern, line) for line in band.lines)
        out = min(along, girth) if girth > 0.0 else along
        pull = band.stiffness_n * (out / (band.ratio * along) - 1.0)
        if pull > most:
            yield Finding(
                "warning", "elastic-strong", file, f"elastics.{band.name}.stiffness",
                f"drawn out to {out:.0f} mm of the {along:.0f} mm of its cloth the elastic pulls {pull:.0f} N; around a waist "
                f"even one {_WIDEST_M * M_TO_MM:.0f} mm wide hurts from {most:.0f} N on",
                "stiffness is in N per unit of strain: what it takes to draw the elastic out to twice its length, some 10 to 100 N.",
            )  # fmt: skip
        if band.ratio > 1.0:
            yield Finding(
                "warning", "elastic-slack", file, f"elastics.{band.name}.ratio",
                f"the ratio is {band.ratio:g}: at rest the elastic is {band.ratio * along:.0f} mm long, and what it is sewn to {along:.0f} mm; "
                "it does not pull unless the cloth is stretched beyond that",
                "The ratio is that of the elastic at rest to its lines: below 1, usually 0.6 to 0.95.",
            )  # fmt: skip


def _check_belts(pattern: Pattern, mannequin: Mannequin, file: str | None) -> Iterator[Finding]:
    girth = _largest_girth(mannequin)
    for band in pattern.bands:
        if band.length_mm is None:
            continue
        around = sum(line_mm(pattern, line) for line in band.lines)
        if band.length_mm < around / _GATHERED or band.length_mm > _GATHERED * max(around, girth):
            yield Finding(
                "warning", "belt-length", file, f"belts.{band.name}.length",
                f"the belt is {band.length_mm:g} mm long, and the cloth along it {around:.0f} mm; the largest girth of {mannequin.name} is {girth:.0f} mm",
                "Its length is that of the whole ring when nothing pulls, in mm: about the girth that it goes around.",
            )  # fmt: skip


def _largest_girth(mannequin: Mannequin) -> float:
    """Of bust, waist and hip, mm; 0 where the body has none of them."""
    return max(mannequin.measurements_mm.get(name, 0.0) for name in ("bust", "waist", "hip"))


def line_mm(pattern: Pattern, line: tuple[EdgeUse, ...] | tuple[PanelPoint, PanelPoint]) -> float:
    """Length of a line of a band on the flat panel, mm."""
    first, last = line[0], line[-1]
    if isinstance(first, PanelPoint) and isinstance(last, PanelPoint):
        return math.dist(first.uv_mm, last.uv_mm)
    return side_length(pattern, line)  # type: ignore[arg-type]
