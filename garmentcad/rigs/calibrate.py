"""Law values with which the virtual testers print a sheet (PHYSICS: the sheet is what a tester prints).

A clamped specimen gives a little less than the law it is made of: free edges carry no shear, contours are made of chords. Each law value is multiplied by
input over print until the prints agree, on a fine lattice, once for a fabric; a drape reads the result from the fabric's file.
"""

from __future__ import annotations

import math
from collections.abc import Callable

from garmentcad.errors import FabricError
from garmentcad.fabric.missing import least_by_law
from garmentcad.fabric.quantity import quantity_of
from garmentcad.fabric.sheet import CalibratedLaw, KesSheet, sheet_sha256
from garmentcad.rigs.kes import TESTERS, KesTester, run_tester, sheet_materials
from garmentcad.rigs.shear import clamped_share

GRID_MM = 2.5
AGREED = 2e-3  # prints as near as that to the sheet need no correction
SURE = 0.03  # after a smaller correction a print needs no second look: prints follow their law values within a tenth of the correction
MOST_ROUNDS = 5
# What the testers print and the laws have values for.
SOLVED = {"tension": ("LT", "EMT", "RT"), "shear": ("G", "2HG", "2HG5"), "bending": ("B", "2HB")}
_SHARED = SOLVED["shear"]  # one trellis law for both directions: the mean, and one correction


def calibrate(sheet: KesSheet, grid_mm: float = GRID_MM, say: Callable[[str], None] = lambda message: None) -> KesSheet:
    """A completed sheet with its `law`. say: told of each test.

    What no law prints beside the sheet's other values (`least_by_law`, of which the sheet's findings tell) it comes as near to as a law does. After MOST_ROUNDS
    the last values stand: what they leave is in every passport. FabricError where one has run to the end of what a sheet may have: no law prints that value.
    """
    keys = [key for tester in TESTERS for key in _solved(tester)]
    numbers = {key: sheet.number(key) for key in keys}
    wanted = {key: max(number, least_by_law(key, numbers)) for key, number in numbers.items()}
    values, prints = dict(wanted), dict(wanted)
    waiting = set(TESTERS)
    for _ in range(MOST_ROUNDS):
        materials = sheet_materials(with_law(sheet, values))
        ratios: dict[str, float] = {}
        for tester in TESTERS:
            if tester in waiting:
                say(f"calibration: {tester.name}")
                prints |= run_tester(tester, sheet, materials, grid_mm, sides=1).printed
                ratios |= {key: _wanted_over_printed(key, wanted[key], prints[key]) for key in _solved(tester)}
        for name in _SHARED:
            if f"{name}.warp" in ratios:
                ratios[f"{name}.warp"] = ratios[f"{name}.weft"] = math.sqrt(ratios[f"{name}.warp"] * ratios[f"{name}.weft"])
        values |= {key: _corrected(key, values[key], ratio) for key, ratio in ratios.items() if abs(ratio - 1.0) > AGREED}
        off = {key for key, ratio in ratios.items() if abs(ratio - 1.0) > SURE}
        waiting = {tester for tester in TESTERS if off & set(_solved(tester))}
        if not waiting:
            break
    astray = [key for key in off if values[key] in quantity_of(key).possible]
    if astray:
        key = max(astray, key=lambda one: abs(math.log(abs(ratios[one]))))
        raise FabricError(f"no law prints it: the virtual tester makes {prints[key]:.3g} of {values[key]:g}, the last that a law may have", key=key)
    return with_law(sheet, values)


def _solved(tester: KesTester) -> list[str]:
    """Keys of the law values that a tester prints."""
    return [f"{name}.{tester.way}" for name in SOLVED[tester.kind] if (name, tester.way) != ("2HB", "bias")]  # see `run_tester`


def _wanted_over_printed(key: str, wanted: float, printed: float) -> float:
    """By which the law value is multiplied; of RT what counts is the loss."""
    if key.startswith("RT"):
        wanted, printed = 100.0 - wanted, 100.0 - printed
    return wanted / printed if abs(printed) > 1e-6 else 1.0


def _corrected(key: str, value: float, ratio: float) -> float:
    low, high = quantity_of(key).possible
    return min(max(100.0 - ratio * (100.0 - value) if key.startswith("RT") else ratio * value, low), high)


def with_law(sheet: KesSheet, values: dict[str, float]) -> KesSheet:
    """The completed sheet with these law values, bound to its numbers."""
    law = CalibratedLaw(sheet_sha256=sheet_sha256(sheet), values={key: float(f"{value:.6g}") for key, value in values.items()})
    return sheet.model_copy(update={"law": law})


def corrections_percent(sheet: KesSheet) -> dict[str, float]:
    """By how much each law value of a calibrated sheet differs from the sheet's own, where that is not 0; empty without a law."""
    law = {} if sheet.law is None else sheet.law.values
    return {key: 100.0 * (value / sheet.number(key) - 1.0) for key, value in law.items() if sheet.number(key) != 0.0}


def beyond_tester_percent(sheet: KesSheet) -> dict[str, float]:
    """The corrections of a calibrated sheet without those that a clamped specimen calls for by theory (`clamped_share`; one for both directions, as the law
    has one trellis): what is left is the lattice's own, and what the theory leaves out."""
    share = math.prod(clamped_share(sheet_materials(sheet))) ** 0.5
    return {key: (100.0 + percent) * share - 100.0 if key.split(".")[0] in _SHARED else percent for key, percent in corrections_percent(sheet).items()}
