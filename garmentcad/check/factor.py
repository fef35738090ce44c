"""Findings on factors of a region that make cloth which no sheet could describe."""

from __future__ import annotations

from collections.abc import Iterator

from garmentcad.check.finding import Finding, Severity
from garmentcad.fabric.law_values import law_numbers
from garmentcad.fabric.missing import beyond_laws
from garmentcad.fabric.quantity import quantity_of
from garmentcad.fabric.sheet import KesSheet
from garmentcad.pattern.pattern import Region

LAYERS = 4  # that a part may be cut in: so many times the range of a sheet are worth knowing, but no slip


def check_factors(region: Region, sheet: KesSheet, key: str, file: str | None) -> Iterator[Finding]:
    """The value that each factor takes farthest out of the range that a sheet may have, and values that the laws cannot have together where those of the sheet
    can. sheet: completed, of the region's fabric; key: of the region."""
    numbers = law_numbers(sheet, region.factors)
    for name, factor in region.factors.items():
        quantity = quantity_of(name)
        low, high = quantity.possible
        off = {at: value for at, value in numbers.items() if f"{at}.".startswith(f"{name}.") and not low <= value <= high}
        if off:
            at, value = max(off.items(), key=lambda pair: abs(pair[1] - 0.5 * (low + high)))
            severity: Severity = "note" if low / LAYERS <= value <= LAYERS * high else "warning"
            if name == "Fm" and severity == "note":
                continue  # no property of the cloth: layers side by side are pulled with so many times the force of one
            yield Finding(
                severity, "factor-out-of-range", file, f"{key}.factors.{name}",
                f"times {factor:g}, {at} is {value:.4g} {quantity.unit}; a sheet may have {low:g} to {high:g} {quantity.unit}",
                "Factors multiply the values of the fabric: correct it, or name the sheet of such cloth as the region's fabric.",
            )  # fmt: skip
    of_sheet = {finding.key for finding in beyond_laws(law_numbers(sheet), sheet.shear_window_deg)}
    for beyond in beyond_laws(numbers, sheet.shear_window_deg):
        if beyond.key not in of_sheet:
            yield Finding(
                "warning", "factor-beyond-law", file, f"{key}.factors", f"{beyond.key}: {beyond.message}",
                "Give factors to values that go together (2HG5 with G, RT as a share of what is lost), or name the sheet of such cloth as the region's fabric.",
            )  # fmt: skip
