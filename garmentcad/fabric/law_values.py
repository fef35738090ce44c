"""The numbers of a completed sheet that the laws start from: calibrated where it carries them, times the factors of a region."""

from __future__ import annotations

import math
from collections.abc import Mapping

from garmentcad.errors import FabricError
from garmentcad.fabric.missing import FILLED
from garmentcad.fabric.quantity import quantity_of
from garmentcad.fabric.sheet import KesSheet, is_calibrated

_READ = tuple(key for key in FILLED if not key.startswith("WT."))  # what the laws read: WT follows from LT and EMT


def law_numbers(sheet: KesSheet, factors: Mapping[str, float] | None = None) -> dict[str, float]:
    """Number of every key that a rule can fill (`missing.FILLED`), in the testers' units.

    factors: by KES name for all directions (`B`) or one of them (`B.warp`); both multiply. FabricError for a name that no law reads, a factor that is not a
    finite number above 0, or a sheet with a gap.
    """
    factors = factors or {}
    for key, factor in factors.items():
        try:
            quantity_of(key)
        except FabricError as fault:
            raise FabricError(fault.message, key=f"factors.{key}") from None
        if not any(key in (read, read.partition(".")[0]) for read in _READ):
            names = ", ".join(dict.fromkeys(read.partition(".")[0] for read in _READ))
            raise FabricError(f"no law reads {key}; a factor may be on {names}, or on one direction, such as B.warp", key=f"factors.{key}")
        if isinstance(factor, bool) or not isinstance(factor, int | float) or not (math.isfinite(factor) and factor > 0.0):
            raise FabricError(f"factor {factor!r}; a finite number above 0 is allowed", key=f"factors.{key}")
    calibrated = sheet.law.values if sheet.law is not None and is_calibrated(sheet) else {}
    found = {}
    for key in FILLED:
        name, way = key.partition(".")[::2]
        found[key] = calibrated.get(key, sheet.number(key)) * factors.get(key, 1.0) * (factors.get(name, 1.0) if way else 1.0)
    return found
