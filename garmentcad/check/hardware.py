"""Findings on pins, buttons, elastics and belts: what cannot hold together, and what holds the same twice."""

from __future__ import annotations

from collections.abc import Iterator

from garmentcad.check.doctor import refusal
from garmentcad.check.finding import Finding
from garmentcad.cloth.cloth import Cloth
from garmentcad.cloth.weld import weld
from garmentcad.errors import InputError
from garmentcad.fabric.material import MaterialTable
from garmentcad.forces.band_lines import band_segments
from garmentcad.mannequin.mannequin import Mannequin
from garmentcad.pattern.pattern import Pattern
from garmentcad.solve.hardware import hardware_rows, redundance_message, redundances


def check_hardware(pattern: Pattern, flat: Cloth, materials: MaterialTable, mannequin: Mannequin, file: str | None = None) -> Iterator[Finding]:
    """flat: the unsewn cloth of the pattern."""
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
            "warning", "redundant-constraints", file, None, redundance_message(found), "Leave one of them out; all of them are solved together as they are."
        )  # fmt: skip
