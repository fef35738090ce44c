"""A sheet as a table for people: every value with its unit, where it comes from and what was noticed about it."""

from __future__ import annotations

from typing import NamedTuple

from garmentcad.fabric.finding import Finding
from garmentcad.fabric.missing import Completed
from garmentcad.fabric.quantity import KEYS, quantity_of


class SheetLine(NamedTuple):
    """One line of the table. origin: the source, or `estimate: RULE`; assumed: the value was missing and a rule gave it; finding: what was noticed."""

    key: str
    value: float
    unit: str
    meaning: str
    origin: str
    assumed: bool
    finding: str


def sheet_remarks(completed: Completed) -> tuple[Finding, ...]:
    """What was noticed and belongs to no line of the table: of the file that it was read from, of its law."""
    return tuple(finding for finding in completed.findings if finding.key not in KEYS or completed.sheet.get(finding.key) is None)


def sheet_lines(completed: Completed) -> tuple[SheetLine, ...]:
    """The table of a completed sheet, one line a value, in the order of the testers."""
    said: dict[str, list[str]] = {}
    for finding in completed.findings:
        said.setdefault(finding.key, []).append(f"{finding.severity}: {finding.message}")
    lines = []
    for key in KEYS:
        value = completed.sheet.get(key)
        if value is not None:
            quantity = quantity_of(key)
            noticed = "; ".join(said.get(key, []))
            lines.append(SheetLine(key, value.value, quantity.unit, quantity.meaning, completed.sheet.origin(key), key in completed.assumed, noticed))
    return tuple(lines)
