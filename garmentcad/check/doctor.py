"""The pattern doctor: what is wrong with a pattern, before any cloth is made of it."""

from __future__ import annotations

from garmentcad.check.finding import Finding
from garmentcad.check.grain import check_grain
from garmentcad.check.outline import check_panel
from garmentcad.check.seam import check_seams
from garmentcad.check.sleeve import check_sleeves
from garmentcad.check.unused import check_unused
from garmentcad.errors import ExpressionError, InputError, SpecError
from garmentcad.pattern.pattern import Pattern
from garmentcad.pattern.spec import GarmentSpec


def check_pattern(spec: GarmentSpec, pattern: Pattern, grid_mm: float = 10.0) -> list[Finding]:
    """Findings on a drafted pattern, errors first: outlines, sizes against the lattice spacing, regions, grain, seams, notches, sleeves, names.

    What keeps a spec from being drafted at all (open outline, unknown edges and points) is an error of `draft_errors`; `refusal` makes a finding of one.
    """
    found = [finding for panel in pattern.panels.values() for finding in check_panel(panel, grid_mm, spec.file)]
    found += [*check_grain(pattern, spec.file), *check_seams(pattern, spec.file), *check_sleeves(pattern, spec.file), *check_unused(spec)]
    return worst_first(found)


def refusal(error: InputError) -> Finding:
    """The finding for input that was refused: the message itself says what is allowed."""
    remedy = ""
    if isinstance(error, (SpecError, ExpressionError)) and error.file is not None:
        foreign = error.file.lower().endswith(".json")
        page = "docs/garmentcode.md says what is read of a GarmentCode file" if foreign else "docs/spec.md describes every key of a spec"
        remedy = f"Correct it; {page}."
    return Finding("error", "refused", error.file, error.key, error.message.rstrip("."), remedy)


def worst_first(findings: list[Finding]) -> list[Finding]:
    """Errors, then warnings, then notes, otherwise in the order given."""
    return sorted(findings, key=lambda finding: ("error", "warning", "note").index(finding.severity))
