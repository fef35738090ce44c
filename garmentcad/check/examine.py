"""From the name of a spec to all findings: reading, drafting, the pattern on the table, and the panels as placed on the mannequin."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from garmentcad.analysis.clearance import clearing_moves, move_panels
from garmentcad.check.doctor import check_pattern, refusal, worst_first
from garmentcad.check.finding import Finding
from garmentcad.check.placement import check_moves, check_placement, check_twists
from garmentcad.cloth.lattice import build_cloth
from garmentcad.errors import InputError
from garmentcad.fabric.material import material_row, material_table
from garmentcad.io.fabric_file import load_fabric
from garmentcad.io.mannequin_file import read_mannequin
from garmentcad.io.outfit_file import read_worn
from garmentcad.io.shipped import resolve_reference
from garmentcad.io.spec_file import spec_folder
from garmentcad.mannequin.mannequin import Mannequin
from garmentcad.pattern.draft import draft_errors
from garmentcad.pattern.pattern import Pattern, named_fabrics
from garmentcad.pattern.spec import GarmentSpec
from garmentcad.placement.place import place_vertices


def examine(spec: str | Path | GarmentSpec, mannequin: str | None = None, grid_mm: float = 10.0) -> list[Finding]:
    """All findings on a garment, or on every garment of an outfit, errors first. spec: a shipped name, a file or a model; mannequin: in place of the spec's.

    Input that cannot be read at all is a finding too, not an exception. Panels are placed only when they have no errors of their own.
    """
    try:
        read = spec if isinstance(spec, GarmentSpec) else read_worn(spec)
        if not isinstance(read, GarmentSpec):
            outfit, garments = read
            worn_by = mannequin if mannequin is not None else str(resolve_reference(outfit.mannequin, "mannequins", spec_folder(outfit)))
            return worst_first([finding for garment in garments for finding in examine(garment, worn_by, grid_mm)])
        spec, folder = read, spec_folder(read)
        body = read_mannequin(mannequin if mannequin is not None else resolve_reference(spec.mannequin, "mannequins", folder))
    except InputError as error:
        return [refusal(error)]
    pattern, errors = draft_errors(spec, body.measurements_mm)
    if pattern is None:
        return [refusal(error) for error in errors]
    found = check_pattern(spec, pattern, grid_mm)
    found += _check_fabrics(spec, pattern, folder)
    if not any(finding.severity == "error" for finding in found):
        found += _check_placed(spec, pattern, body, folder, grid_mm)
    return worst_first(found)


def _check_fabrics(spec: GarmentSpec, pattern: Pattern, folder: Path) -> list[Finding]:
    """Fabrics that cannot be read; then regions whose factors or interfacing make impossible cloth."""
    found, sheets = [], {}
    for fabric, key in {**named_fabrics(pattern), pattern.fabric: "fabric"}.items():
        try:
            sheets[fabric] = load_fabric(resolve_reference(fabric, "fabrics", folder)).sheet
        except InputError as error:
            found.append(refusal(type(error)(error.message, file=error.file or spec.file, key=error.key or key)))
    if found:
        return found
    for panel in pattern.panels.values():
        for region in panel.regions:
            sheet = sheets[region.fabric or panel.fabric or pattern.fabric]
            try:
                material_row(sheet, region.factors, sheets[region.interfacing] if region.interfacing else None)
            except InputError as error:
                found.append(refusal(type(error)(error.message, file=spec.file, key=f"panels.{panel.name}.regions.{region.name}.{error.key}")))
    return found


def _check_placed(spec: GarmentSpec, pattern: Pattern, body: Mannequin, folder: Path, grid_mm: float) -> list[Finding]:
    sheet = load_fabric(resolve_reference(pattern.fabric, "fabrics", folder)).sheet
    try:
        # Where the panels lie does not depend on the fabric: one row is enough.
        cloth = build_cloth(pattern, lambda _, points: np.zeros(len(points), dtype=np.int32), material_table([material_row(sheet)]), grid_mm)
        positions = place_vertices(pattern, cloth, body)
    except InputError as error:
        return [refusal(type(error)(error.message, file=error.file or spec.file, key=error.key))]
    moves = clearing_moves(pattern, cloth, positions, body)
    positions = move_panels(cloth, positions, moves)
    return [*check_moves(moves, spec.file), *check_twists(pattern, cloth, positions, spec.file), *check_placement(cloth, positions, body, spec.file)]
