"""Which material lies where: a row for each panel, followed by one for each of its regions, and the function that says which row a point of a panel has."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from shapely import Polygon, contains_xy

from garmentcad.cloth.lattice import MaterialOf
from garmentcad.errors import FabricError, SpecError
from garmentcad.fabric.material import MaterialRow, MaterialTable, material_row, material_table
from garmentcad.fabric.sheet import KesSheet
from garmentcad.pattern.pattern import Panel, Pattern, Region, key_of, parts_of

_HAIR_MM = 0.05  # what lies on the outline of a region is in it: panels that are drawn as halves have cells on the line where both of its images end


def first_rows(pattern: Pattern) -> dict[str, int]:
    """The row of each panel; its regions have those after it, in their order. Regions may share a name: the pieces of a band."""
    rows, found = 0, {}
    for panel in pattern.panels.values():
        found[panel.name] = rows
        rows += 1 + len(panel.regions)
    return found


def sheet_of(part: Panel | Region, panel: Panel, pattern: Pattern, sheets: Mapping[str, KesSheet]) -> KesSheet:
    """The sheet of a panel, or of one of its regions, before factors and interfacing."""
    return sheets[part.fabric or panel.fabric or pattern.fabric]


def row_of(part: Panel | Region, panel: Panel, pattern: Pattern, sheets: Mapping[str, KesSheet]) -> MaterialRow:
    """The row of a panel, or of one of its regions. SpecError with the key of the factors or the interfacing that make impossible cloth."""
    sheet = sheet_of(part, panel, pattern, sheets)
    factors = part.factors if isinstance(part, Region) else None
    try:
        return material_row(sheet, factors, sheets[part.interfacing] if part.interfacing else None)
    except FabricError as fault:
        key = fault.key or ""
        if key.startswith("factors."):
            raise SpecError(fault.message, key=f"{key_of(part, panel)}.{key}") from None
        made, of = (f"{part.interfacing!r} fused to it", "interfacing") if part.interfacing else ("its factors", "factors")
        raise SpecError(f"with {made} the cloth is impossible: {key} = {fault.message}", key=f"{key_of(part, panel)}.{of}") from None


def lay_out_sheets(pattern: Pattern, sheets: Mapping[str, KesSheet]) -> tuple[MaterialTable, MaterialOf]:
    """Material table of a pattern, and `material_of(panel, points_mm (N,2)) -> rows (N,)`. Where regions overlap, the later one counts.

    sheets: completed, by the name under which panels and regions refer to them. SpecError with the key of the panel or region whose factors or interfacing
    make impossible cloth.
    """
    rows, of_panel = list[MaterialRow](), first_rows(pattern)
    for panel in pattern.panels.values():
        for part in parts_of(panel):
            rows.append(row_of(part, panel, pattern, sheets))

    def material_of(panel: Panel, points_mm: np.ndarray) -> np.ndarray:
        found = np.full(len(points_mm), of_panel[panel.name], dtype=np.int32)
        for row, region in enumerate(panel.regions, of_panel[panel.name] + 1):
            area = Polygon(region.polygon_mm).buffer(_HAIR_MM, join_style="mitre")
            found[contains_xy(area, points_mm[:, 0], points_mm[:, 1])] = row
        return found

    return material_table(rows), material_of
