"""Which values the report of a garment will have: what every report has, and what the garment names itself."""

from __future__ import annotations

from dataclasses import fields
from typing import Any

from garmentcad.analysis.folds import fold_lines
from garmentcad.analysis.run_record import BAND_KEYS
from garmentcad.analysis.seam_tension import SeamTension
from garmentcad.export.report import blank_report
from garmentcad.pattern.pattern import Pattern
from garmentcad.simulation.record import versions

_SEAM_KEYS = tuple(field.name for field in fields(SeamTension))


def known_values(pattern: Pattern) -> dict[str, Any]:
    """The report of a pattern before it is draped: every key, values None."""
    held = [*(pin.name for pin in pattern.pins), *(button.name for button in pattern.buttons)]
    report = blank_report()
    report["constraints"] |= {"gap_mm": dict.fromkeys(held), "speed_m_s": dict.fromkeys(held)}
    named = {
        "versions": dict.fromkeys(versions()),
        "bands": {band.name: dict.fromkeys(BAND_KEYS) for band in pattern.bands},
        "fold_deg": dict.fromkeys(fold_lines(pattern)),
        "seam_tension": {seam.name: dict.fromkeys(_SEAM_KEYS) for seam in pattern.seams},
    }
    return report | named
