"""From the name of a spec to all findings: reading, drafting, the pattern on the table, and the panels as placed on the mannequin."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

from garmentcad.analysis.clearance import clearing_moves, move_panels
from garmentcad.check.doctor import check_pattern, refusal, worst_first
from garmentcad.check.factor import check_factors
from garmentcad.check.finding import Finding
from garmentcad.check.gather import check_gathers
from garmentcad.check.hardware import check_hardware
from garmentcad.check.placement import check_crossed, check_far, check_moves, check_placement, check_reach, check_twists
from garmentcad.check.region import check_regions
from garmentcad.check.wearing import check_wearing
from garmentcad.cloth.lattice import build_cloth, check_grid
from garmentcad.cloth.materials import lay_out_sheets, row_of, sheet_of
from garmentcad.errors import InputError, SpecError
from garmentcad.fabric.missing import Completed
from garmentcad.fabric.sheet import KesSheet
from garmentcad.io.arguments import as_number, as_values, refuse_no_garment, refuse_unnamed
from garmentcad.io.fabric_file import load_fabric
from garmentcad.io.mannequin_file import read_mannequin
from garmentcad.io.outfit_file import read_worn
from garmentcad.io.shipped import resolve_reference
from garmentcad.io.spec_file import spec_folder
from garmentcad.mannequin.mannequin import Mannequin, refuse_no_body
from garmentcad.pattern.draft import draft_errors
from garmentcad.pattern.outfit import OutfitSpec, put_on
from garmentcad.pattern.parse import checked
from garmentcad.pattern.pattern import Pattern, Region, fabric_apart, key_of, named_fabrics, parts_of
from garmentcad.pattern.scope import with_values
from garmentcad.pattern.spec import GarmentSpec
from garmentcad.placement.place import place_vertices


def examine(
    spec: str | Path | GarmentSpec,
    mannequin: str | Path | Mannequin | None = None,
    grid_mm: float = 10.0,
    fabric: str | Path | KesSheet | None = None,
    values: Mapping[str, float] | None = None,
) -> list[Finding]:
    """All findings on a garment, or on every garment of an outfit, errors first. spec: a shipped name, a file or a model; mannequin, fabric: a shipped name,
    a file, or a body or sheet, in place of the spec's own; values: of parameters, alike. An outfit has fabrics and values for each garment and takes none.

    Input that cannot be read at all is a finding too, not an exception. Panels are placed only when they have no errors of their own.
    """
    try:
        check_grid(as_number(grid_mm, "grid_mm", "a number of mm"))
        for key, named, made in (("mannequin", mannequin, Mannequin), ("fabric", fabric, KesSheet)):
            if named is not None:
                refuse_unnamed(named, key, made)
        refuse_no_garment(spec)
        values = as_values(values)
        read = checked(spec) if isinstance(spec, GarmentSpec) else read_worn(spec)
        if isinstance(read, GarmentSpec):
            garment = with_values(read, values)
            other = None if fabric is None else _Named(partial(load_fabric, fabric), None, "fabric")
            return worst_first(_examine_garment(garment, _read_body(garment, mannequin), grid_mm, other)[1])
        if fabric is not None:
            raise InputError("an outfit has a fabric for each garment; name them in its file", key="fabric")
        if values:
            raise InputError("an outfit has values of parameters for each garment; name them in its file", key="values")
        return worst_first(_examine_outfit(*read, _read_body(read[0], mannequin), grid_mm))
    except InputError as error:
        return [refusal(fault) for fault in (error, *error.others)]


@dataclass(frozen=True)
class _Named:
    """A fabric as it was named. read: its sheet; file, key: where the name stands."""

    read: Callable[[], Completed]
    file: str | None
    key: str


def _load_named(name: str, spec: GarmentSpec | OutfitSpec) -> Completed:
    """The fabric that a spec names."""
    return load_fabric(resolve_reference(name, "fabrics", spec_folder(spec)))


def _read_body(spec: GarmentSpec | OutfitSpec, mannequin: str | Path | Mannequin | None) -> Mannequin:
    """The body that a spec names, or another one in its place. InputError says where it was named."""
    if isinstance(mannequin, Mannequin):
        refuse_no_body(mannequin)
        return mannequin
    try:
        return read_mannequin(mannequin if mannequin is not None else resolve_reference(spec.mannequin, "mannequins", spec_folder(spec)))
    except InputError as error:
        raise _named_at(error, *((spec.file, "mannequin") if mannequin is None else (None, "mannequin"))) from None


def _named_at(error: InputError, file: str | None, key: str) -> InputError:
    """The fault of what file and key name; one inside a file of its own has its place already."""
    return error if error.file is not None else type(error)(error.message, file=file, key=key)


def _examine_outfit(outfit: OutfitSpec, garments: Sequence[GarmentSpec], body: Mannequin, grid_mm: float) -> list[Finding]:
    """Every garment by itself, as the outfit has it; then their names."""
    found: list[Finding] = []
    patterns = []
    for k, (garment, entry) in enumerate(zip(garments, outfit.garments, strict=True)):
        key = f"garments.{k}"
        other = None
        if entry.fabric is not None:
            other = _Named(partial(_load_named, entry.fabric, outfit), outfit.file, f"{key}.fabric")
        try:
            worn = with_values(garment, entry.values)
        except InputError as error:
            found.append(refusal(type(error)(error.message, file=outfit.file, key=f"{key}.values")))
            continue
        pattern, its_own = _examine_garment(worn, body, grid_mm, other)
        places = {f"parameters.{name}.value": f"{key}.values.{name}" for name in entry.values}
        found += [replace(one, file=outfit.file, key=places[one.key]) if one.key in places else one for one in its_own]
        patterns += [] if pattern is None else [pattern]
    try:
        if patterns:
            put_on(outfit.name, patterns, outfit.mannequin)
    except InputError as error:
        found.append(refusal(type(error)(error.message, file=outfit.file, key=error.key)))
    return found


def _examine_garment(spec: GarmentSpec, body: Mannequin, grid_mm: float, other: _Named | None) -> tuple[Pattern | None, list[Finding]]:
    """The pattern, where it can be drafted, and all findings on it. other: a fabric in place of its own."""
    pattern, errors = draft_errors(spec, body.measurements_mm)
    if pattern is None:
        return None, [refusal(error) for error in errors]
    if other is not None:
        pattern = fabric_apart(pattern)
    found = check_pattern(spec, pattern, grid_mm)
    sheets, faults = _read_sheets(spec, pattern, other)
    found += faults or _check_fabrics(spec, pattern, sheets, grid_mm)
    if not any(finding.severity == "error" for finding in found):
        found += _check_placed(spec, pattern, body, sheets, grid_mm)
    return pattern, found


def _read_sheets(spec: GarmentSpec, pattern: Pattern, other: _Named | None) -> tuple[dict[str, KesSheet], list[Finding]]:
    """Every sheet that the pattern names, completed, `other` in place of its own; and a finding for each that cannot be read."""
    found, sheets = [], {}
    for name, key in {**named_fabrics(pattern), pattern.fabric: "fabric"}.items():
        named = _Named(partial(_load_named, name, spec), spec.file, key)
        if other is not None and name == pattern.fabric:
            named = other
        try:
            sheets[name] = named.read().sheet
        except InputError as error:
            found.append(refusal(_named_at(error, named.file, named.key)))
    return sheets, found


def _check_fabrics(spec: GarmentSpec, pattern: Pattern, sheets: dict[str, KesSheet], grid_mm: float) -> list[Finding]:
    """Panels and regions whose factors or interfacing make impossible cloth, or take it out of the range of sheets; then gathers."""
    found: dict[str, list[Finding]] = {}  # by key: a region, its mirror images and the pieces of a band have one fault
    for panel in pattern.panels.values():
        for part in parts_of(panel):
            key = key_of(part, panel)
            try:
                row_of(part, panel, pattern, sheets)
            except InputError as error:
                found[key] = [refusal(SpecError(error.message, file=spec.file, key=error.key))]
                continue
            if isinstance(part, Region):
                found[key] = list(check_factors(part, sheet_of(part, panel, pattern, sheets), key, spec.file))
    return [*itertools.chain.from_iterable(found.values()), *check_gathers(pattern, sheets, spec.file, grid_mm)]


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
    reach = [*check_reach(pattern, cloth, positions, body, spec.file), *check_far(pattern, cloth, positions, body, spec.file)]
    sewn = [*check_twists(pattern, cloth, positions, spec.file), *check_crossed(pattern, cloth, positions, spec.file)]
    placed = [*check_moves(moves, spec.file), *reach, *sewn, *check_placement(cloth, positions, body, spec.file)]
    return [*placed, *worn, *check_regions(pattern, cloth, spec.file), *check_hardware(pattern, cloth, positions, materials, body, spec.file)]
