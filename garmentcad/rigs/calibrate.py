"""Law values with which the virtual testers print a sheet (PHYSICS: the sheet is what a tester prints).

A clamped specimen gives a little less than the law it is made of: free edges carry no shear, contours are made of chords. Each law value is multiplied by input over
print until the prints agree, on a fine lattice, once for a fabric; a drape reads the result from the fabric's file.
"""

from __future__ import annotations

from collections.abc import Callable

from garmentcad.errors import FabricError
from garmentcad.fabric.sheet import CalibratedLaw, KesSheet, sheet_sha256
from garmentcad.rigs.kes import TESTERS, run_tester, sheet_materials

GRID_MM = 2.5
AGREED = 2e-3  # prints as near as that to the sheet are not corrected again
MOST_ROUNDS = 5
SOLVED = {"tension": ("LT", "EMT"), "shear": ("G",), "bending": ("B",)}  # what the laws have a value for


def calibrate(sheet: KesSheet, grid_mm: float = GRID_MM, say: Callable[[str], None] = lambda message: None) -> KesSheet:
    """A completed sheet with its `law`. say: told of each test. FabricError where the prints do not come near the sheet.

    Both directions of G share one law value, the mean, and one correction.
    """
    keys = [f"{name}.{tester.way}" for tester in TESTERS for name in SOLVED[tester.kind]]
    values = {key: sheet.number(key) for key in keys}
    waiting = {tester.kind for tester in TESTERS}
    for _ in range(MOST_ROUNDS):
        trial = with_law(sheet, values)
        materials = sheet_materials(trial)
        ratios: dict[str, float] = {}
        for tester in TESTERS:
            if tester.kind in waiting:
                say(f"calibration: {tester.name}")
                printed = run_tester(tester, sheet, materials, grid_mm).printed
                ratios |= {f"{name}.{tester.way}": sheet.number(f"{name}.{tester.way}") / printed[f"{name}.{tester.way}"] for name in SOLVED[tester.kind]}
        if "G.warp" in ratios:
            printed_mean = sheet.number("G.warp") / ratios["G.warp"] + sheet.number("G.weft") / ratios["G.weft"]
            ratios["G.warp"] = ratios["G.weft"] = (sheet.number("G.warp") + sheet.number("G.weft")) / printed_mean
        off = {key for key, ratio in ratios.items() if abs(ratio - 1.0) > AGREED}
        if not off:
            return trial
        values |= {key: values[key] * ratio for key, ratio in ratios.items()}
        waiting = {tester.kind for tester in TESTERS if any(key.partition(".")[0] in SOLVED[tester.kind] for key in off)}
    raise FabricError(f"the testers' prints do not come within {100 * AGREED:g} % of the sheet in {MOST_ROUNDS} rounds; left: {', '.join(sorted(off))}", key="law")


def with_law(sheet: KesSheet, values: dict[str, float]) -> KesSheet:
    """The completed sheet with these law values, bound to its numbers."""
    law = CalibratedLaw(sheet_sha256=sheet_sha256(sheet), values={key: float(f"{value:.6g}") for key, value in values.items()})
    return sheet.model_copy(update={"law": law})


def corrections_percent(sheet: KesSheet) -> dict[str, float]:
    """By how much each law value of a calibrated sheet differs from the sheet's own; empty without a law."""
    return {} if sheet.law is None else {key: 100.0 * (value / sheet.number(key) - 1.0) for key, value in sheet.law.values.items()}
