"""The figures of a garment, one a row: what tables, files and comparisons are made of."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

# Keys of report.json that say how a garment fits, in the order of a fit table; "lines" holds what was measured in planes that the user named.
FIT_KEYS = (
    "ease_mm", "pattern_ease_mm", "body_girth_mm", "ease_level_mm", "lines", "hem_height_mm", "hem_range_mm", "hem_uneven_mm", "waist_drop_mm",
    "armhole_to_shoulder_mm", "strain_percent", "strain_of_limit_percent", "strain_over_limit_percent", "trellis_deg", "tension_n_m", "seam_tension",
    "pressure_kpa", "friction_kpa", "contact_area_m2", "support_n", "distance_mm", "mass_kg",
)  # fmt: skip
UNITS = {"_mm": "mm", "_percent": "%", "_deg": "°", "_n_m": "N/m", "_kpa": "kPa", "_m2": "m²", "_n": "N", "_kg": "kg"}


@dataclass(frozen=True)
class Figure:
    """A number and its unit; value is None where it was not measured."""

    value: float | None
    unit: str


def figures(report: Mapping[str, Any]) -> dict[str, Figure]:
    """Figures of a report or fit file by path (`ease_mm.waist`), those of FIT_KEYS that it has. The unit is that in the name, of the key or what holds it."""
    found: dict[str, Figure] = {}
    for key in FIT_KEYS:
        if key in report:
            _collect(found, (key,), report[key])
    return found


def _collect(found: dict[str, Figure], path: tuple[str, ...], value: Any) -> None:
    if isinstance(value, Mapping):
        for key, item in value.items():
            _collect(found, (*path, str(key)), item)
    elif isinstance(value, (int, float)) and not isinstance(value, bool):
        found[".".join(path)] = Figure(float(value), _unit(path))
    elif value is None and _unit(path):  # without one it is no figure, but what would hold some
        found[".".join(path)] = Figure(None, _unit(path))


def _unit(path: tuple[str, ...]) -> str:
    return next((UNITS[ending] for key in reversed(path) for ending in UNITS if key.endswith(ending)), "")
