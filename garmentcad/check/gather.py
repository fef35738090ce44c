"""Findings on gathers: more cloth drawn into a seam than its fabric folds into, or than the lattice shows."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from garmentcad.check.finding import Finding
from garmentcad.cloth.gathers import COARSEST_GATHERED_MM, EASED, GATHERED
from garmentcad.fabric.material import MaterialRow, material_row
from garmentcad.fabric.sheet import KesSheet
from garmentcad.pattern.pattern import Pattern
from garmentcad.pattern.runs import side_length
from garmentcad.units import GRAVITY_M_S2, M_TO_MM

_THICKNESS_MM = 0.6
_BENDING_MM = 20.0


def fullest(row: MaterialRow) -> float:
    """Largest ratio of cloth to seam: the smaller of 1 + 0.6 mm / T0 (layers that lie side by side) and 1 + (20 mm / c)^3, c = (B/(W g))^(1/3) (folds that
    open as they leave the seam).

    An estimate: both numbers are set so that voile comes to 4, suiting to 2, denim to 1.6, overcoating to 1.3, where sewing guides advise 3 to 1 for sheers,
    2 to 1 for medium cloth and 1.5 to 1 for heavy cloth.
    """
    bending = 0.5 * sum(row.bending)
    cube_mm3 = bending / (row.areal_mass * GRAVITY_M_S2) * M_TO_MM**3
    return max(EASED, min(1.0 + _THICKNESS_MM / (row.thickness * M_TO_MM), 1.0 + _BENDING_MM**3 / cube_mm3))


def check_gathers(pattern: Pattern, sheets: Mapping[str, KesSheet], file: str | None, grid_mm: float) -> Iterator[Finding]:
    """Every seam whose one side is much longer, against the fabrics of that side's panels and the lattice."""
    limits = {name: fullest(material_row(sheet)) for name, sheet in sheets.items()}
    for seam in pattern.seams:
        a, b = side_length(pattern, seam.a), side_length(pattern, seam.b)
        if min(a, b) <= 0.0:
            continue
        ratio, side = max((a / b, seam.a), (b / a, seam.b), key=lambda pair: pair[0])
        if ratio > GATHERED and grid_mm > COARSEST_GATHERED_MM:
            yield Finding(
                "note", "gather-coarse", file, f"seams.{seam.name}",
                f"{max(a, b):.0f} mm are gathered into {min(a, b):.0f} mm: on a lattice of {grid_mm:g} mm they hang in few wide folds",
                f"Drape it at {COARSEST_GATHERED_MM:g} mm or less (`--grid`).",
            )  # fmt: skip
        fabric = min((pattern.panels[use.panel].fabric or pattern.fabric for use in side), key=lambda name: limits[name])
        if ratio > limits[fabric]:
            yield Finding(
                "warning", "gather-too-tight", file, f"seams.{seam.name}",
                f"{max(a, b):.0f} mm of {sheets[fabric].name} are gathered into {min(a, b):.0f} mm, {ratio:.2f} to 1; "
                f"by its thickness and bending it folds into {limits[fabric]:.2f} to 1 at most (an estimate)",
                "Take less fullness, or a thinner and softer fabric; pleats take up more than gathers.",
            )  # fmt: skip
