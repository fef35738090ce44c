"""The fabric passport: a sheet beside what the virtual testers print of it, and how the fabric drapes."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from garmentcad import __version__
from garmentcad.fabric.cantilever import STANDARD_CHORD_DEG
from garmentcad.fabric.material import MaterialTable
from garmentcad.fabric.missing import measured_fraction
from garmentcad.fabric.sheet import KesSheet, is_calibrated, sheet_sha256
from garmentcad.rigs.calibrate import GRID_MM, beyond_tester_percent, corrections_percent
from garmentcad.rigs.cusick import GEOMETRIES, LAYS, USUAL, Drape, Drapemeter
from garmentcad.rigs.kes import TESTERS, KesTester, Record, run_tester, sheet_materials
from garmentcad.rigs.strip import elastic_bending_length, standard_overhang

SCHEMA = 1
_STRIPS = {"warp": 0.0, "weft": 90.0}  # degrees from the length of the strip to its warp


@dataclass(frozen=True)
class Passport:
    """figures: the JSON object; records: what the testers recorded; drapes: the lays."""

    sheet: KesSheet
    figures: dict[str, Any]
    records: dict[KesTester, Record]
    drapes: list[Drape]

    @property
    def converged(self) -> bool:
        """Whether every lay came to rest."""
        return all(drape.status == "converged" for drape in self.drapes)


def make_passport(sheet: KesSheet, grid_mm: float, lays: int = LAYS, geometry: str = USUAL, say: Callable[[str], None] = lambda message: None) -> Passport:
    """Run all testers on a completed sheet. lays: on the drapemeter; 0 leaves it out. say: told of each test."""
    began = time.perf_counter()
    materials = sheet_materials(sheet)
    records: dict[KesTester, Record] = {}
    for tester in TESTERS:
        say(tester.name)
        records[tester] = run_tester(tester, sheet, materials, grid_mm)
    say("cantilever")
    cantilever = _cantilever_figures(materials)
    drapes, drapemeter = [], Drapemeter(materials, grid_mm, geometry)
    for seed in range(lays):
        say(f"drapemeter, lay {seed + 1} of {lays}")
        drapes.append(drapemeter.lay(seed))
    figures = {
        "schema": SCHEMA,
        "fabric": sheet.name,
        "sheet_sha256": sheet_sha256(sheet),
        "version": __version__,
        "grid_mm": grid_mm,
        "measured_fraction": measured_fraction(sheet),
        "uncalibrated": not is_calibrated(sheet),
        "law": _law_figures(sheet) if sheet.law else None,
        "kes": _compared(sheet, records),
        "bending_range_per_cm": {tester.way: float(record.branches[0].x[-1]) for tester, record in records.items() if tester.kind == "bending"},
        "cantilever": cantilever,
        "drape": _drape_figures(drapes, geometry) if drapes else None,
        "wall_time_s": time.perf_counter() - began,
    }
    return Passport(sheet, figures, records, drapes)


def _law_figures(sheet: KesSheet) -> dict[str, Any]:
    values = dict(sheet.law.values) if sheet.law else {}
    return {"grid_mm": GRID_MM, "values": values, "corrections_percent": corrections_percent(sheet), "beyond_tester_percent": beyond_tester_percent(sheet)}


def _compared(sheet: KesSheet, records: dict[KesTester, Record]) -> dict[str, dict[str, float | None]]:
    rows: dict[str, dict[str, float | None]] = {}
    for record in records.values():
        for key, simulated in record.printed.items():
            given = sheet.get(key)
            wanted = None if given is None else given.value
            rows[key] = {"input": wanted, "simulated": simulated, "error_percent": 100.0 * (simulated / wanted - 1.0) if wanted else None}
    return rows


def _cantilever_figures(materials: MaterialTable) -> dict[str, Any]:
    """The standard test of bending (ASTM D1388), and the bending length that B alone gives, without friction."""
    figures: dict[str, Any] = {"chord_deg": STANDARD_CHORD_DEG}
    for way, angle_deg in _STRIPS.items():
        overhang = standard_overhang(materials, angle_deg)
        without = elastic_bending_length(materials, angle_deg)
        figures[way] = {"overhang_mm": overhang, "bending_length_mm": 0.5 * overhang, "without_friction_mm": without}
    return figures


def _drape_figures(drapes: list[Drape], geometry: str) -> dict[str, Any]:
    coefficients, nodes = [drape.dc_percent for drape in drapes], [drape.shadow.nodes for drape in drapes]

    def spread(values: list[Any]) -> dict[str, Any]:
        return {"mean": float(np.mean(values)), "sd": float(np.std(values, ddof=1)) if len(values) > 1 else None}

    return {
        "geometry_cm": geometry,
        "disc_mm": GEOMETRIES[geometry].disc_mm,
        "specimen_mm": GEOMETRIES[geometry].specimen_mm,
        "status": [drape.status for drape in drapes],
        "dc_percent": spread(coefficients) | {"lays": coefficients},
        "nodes": spread(nodes) | {"lays": nodes},
        "rim_max_mm": float(np.mean([drape.shadow.rim_mm.max() for drape in drapes])),
        "rim_min_mm": float(np.mean([drape.shadow.rim_mm.min() for drape in drapes])),
        "lowest_mm": float(np.mean([drape.lowest_mm for drape in drapes])),
    }
