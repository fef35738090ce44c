"""From the name of a spec to all findings: reading, drafting, the pattern on the table, and the panels as placed on the mannequin."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from garmentcad.analysis.clearance import clearing_moves, move_panels
from garmentcad.check.doctor import check_pattern, refusal, worst_first
from garmentcad.check.finding import Finding
from garmentcad.check.gather import check_gathers
from garmentcad.check.hardware import check_hardware
from garmentcad.check.placement import check_moves, check_placement, check_reach, check_twists
from garmentcad.check.wearing import check_wearing
from garmentcad.cloth.lattice import build_cloth, check_grid
from garmentcad.cloth.materials import lay_out_sheets
from garmentcad.errors import InputError
from garmentcad.fabric.material import material_row
from garmentcad.fabric.sheet import KesSheet
from garmentcad.io.fabric_file import fabric_path, load_fabric
from garmentcad.io.mannequin_file import read_mannequin
from garmentcad.io.outfit_file import read_worn
from garmentcad.io.shipped import resolve_reference
from garmentcad.io.spec_file import spec_folder
from garmentcad.mannequin.mannequin import Mannequin
from garmentcad.pattern.draft import draft_errors
from garmentcad.pattern.pattern import Pattern, named_fabrics
from garmentcad.pattern.scope import with_values
from garmentcad.pattern.spec import GarmentSpec
from garmentcad.placement.place import place_vertices


def examine(
    spec: str | Path | GarmentSpec,
    mannequin: str | None = None,
    grid_mm: float = 10.0,
    fabric: str | None = None,
    values: Mapping[str, float] | None = None,
) -> list[Finding]:
    """All findings on a garment, or on every garment of an outfit, errors first. spec: a shipped name, a file or a model; mannequin, fabric: a shipped name or
    a file, in place of the spec's own; values: of parameters, alike. An outfit has fabrics and values for each garment and takes none.

    Input that cannot be read at all is a finding too, not an exception. Panels are placed only when they have no errors of their own.
    """
    try:
        check_grid(grid_mm)
        read = spec if isinstance(spec, GarmentSpec) else read_worn(spec)
        if not isinstance(read, GarmentSpec):
            if fabric is not None:
                raise InputError("an outfit has a fabric for each garment; name them in its file", key="--fabric")
            if values:
                raise InputError("an outfit has values of parameters for each garment; name them in its file", key="--set")
            outfit, garments = read
            worn_by = mannequin if mannequin is not None else str(resolve_reference(outfit.mannequin, "mannequins", spec_folder(outfit)))
            named = zip(garments, outfit.garments, strict=True)
            return worst_first([finding for garment, entry in named for finding in examine(garment, worn_by, grid_mm, values=entry.values)])
        spec, folder = with_values(read, values or {}), spec_folder(read)
        body = read_mannequin(mannequin if mannequin is not None else resolve_reference(spec.mannequin, "mannequins", folder))
    except InputError as error:
        return [refusal(fault) for fault in (error, *error.others)]
    pattern, errors = draft_errors(spec, body.measurements_mm)
    if pattern is None:
        return [refusal(error) for error in errors]
    found = check_pattern(spec, pattern, grid_mm)
    sheets, faults = _read_sheets(spec, pattern, folder, fabric)
    found += faults or _check_fabrics(spec, pattern, sheets)
    if not any(finding.severity == "error" for finding in found):
        found += _check_placed(spec, pattern, body, sheets, grid_mm)
    return worst_first(found)


def _read_sheets(spec: GarmentSpec, pattern: Pattern, folder: Path, fabric: str | None) -> tuple[dict[str, KesSheet], list[Finding]]:
    """Every sheet that the pattern names, completed, `fabric` in place of its own; and a finding for each that cannot be read."""
    found, sheets = [], {}
    for name, key in {**named_fabrics(pattern), pattern.fabric: "fabric"}.items():
        other = fabric if name == pattern.fabric else None
        file, key = (spec.file, key) if other is None else (None, "--fabric")
        try:
            sheets[name] = load_fabric(resolve_reference(name, "fabrics", folder) if other is None else fabric_path(other)).sheet
        except InputError as error:
            found.append(refusal(type(error)(error.message, file=error.file or file, key=error.key or key)))
    return sheets, found


def _check_fabrics(spec: GarmentSpec, pattern: Pattern, sheets: dict[str, KesSheet]) -> list[Finding]:
    """Regions whose factors or interfacing make impossible cloth; then gathers."""
    found = []
    for panel in pattern.panels.values():
        for region in panel.regions:
            sheet = sheets[region.fabric or panel.fabric or pattern.fabric]
            try:
                material_row(sheet, region.factors, sheets[region.interfacing] if region.interfacing else None)
            except InputError as error:
                found.append(refusal(type(error)(error.message, file=spec.file, key=f"panels.{panel.name}.regions.{region.name}.{error.key}")))
    return [*found, *check_gathers(pattern, sheets, spec.file)]


def _check_placed(spec: GarmentSpec, pattern: Pattern, body: Mannequin, sheets: dict[str, KesSheet], grid_mm: float) -> list[Finding]:
    try:
        materials, material_of = lay_out_sheets(pattern, sheets)
        cloth = build_cloth(pattern, material_of, materials, grid_mm)
        positions = place_vertices(pattern, cloth, body)
        worn = list(check_wearing(pattern, cloth, positions, materials, body, spec.file))
    except InputError as error:
        return [refusal(type(error)(error.message, file=error.file or spec.file, key=error.key))]
    moves = clearing_moves(pattern, cloth, positions, body)
    positions = move_panels(cloth, positions, moves)
    reach = check_reach(pattern, cloth, positions, body, spec.file)
    placed = [*check_moves(moves, spec.file), *reach, *check_twists(pattern, cloth, positions, spec.file), *check_placement(cloth, positions, body, spec.file)]
    return [*placed, *worn, *check_hardware(pattern, cloth, materials, body, spec.file)]
