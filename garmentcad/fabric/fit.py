"""From what a laboratory has (loops of the testers, FAST readings, a cantilever length, printed values) to a sheet with bounds."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

from garmentcad.errors import FabricError
from garmentcad.fabric.fast import FAST_QUANTITIES, fit_fast
from garmentcad.fabric.fit_friction import fit_friction
from garmentcad.fabric.fit_tension import fit_tension
from garmentcad.fabric.fitted import FittedValue, fitted_sheet
from garmentcad.fabric.missing import USUAL_FM
from garmentcad.fabric.recorded_loop import RecordedLoop
from garmentcad.fabric.sheet import KesSheet


class Fit(NamedTuple):
    """The sheet, gaps and all, and its fitted values with bounds."""

    sheet: KesSheet
    fitted: tuple[FittedValue, ...]


def fit_sheet(name: str, source: str, values: Mapping[str, float], loops: Sequence[RecordedLoop]) -> Fit:
    """values: FAST readings and values of the sheet by key. FabricError for readings that no cloth can have, what is no loop, a value had twice, and tension
    to different forces."""
    printed = {key: number for key, number in values.items() if key.partition(".")[0] not in FAST_QUANTITIES}
    fitted = [
        *fit_fast(values),
        *fit_tension([loop for loop in loops if loop.test == "tension"]),
        *fit_friction([loop for loop in loops if loop.test != "tension"]),
    ]
    force = next((value.value for value in fitted if value.key == "Fm"), USUAL_FM)
    printed_tension = [key for key in printed if key.partition(".")[0] in ("LT", "WT", "EMT")]
    if force != USUAL_FM and printed_tension:
        came = f"{', '.join(printed_tension)} as a tester prints them, at {USUAL_FM:g} gf/cm, beside tests to {force:g}"
        raise FabricError(f"{came}; one Fm belongs to a sheet, leave either out", key=printed_tension[0])
    return Fit(fitted_sheet(name, source, fitted, printed), tuple(fitted))
