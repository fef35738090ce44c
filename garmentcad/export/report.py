"""report.json: every number of a run, in one order, in valid JSON."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import fields
from pathlib import Path
from typing import Any, get_type_hints

import numpy as np
from rich.table import Table
from rich.text import Text

from garmentcad.analysis.body_line import SIDES
from garmentcad.analysis.ease import EASE_LINES
from garmentcad.analysis.hem_shape import HemShape
from garmentcad.analysis.measures import Measures, unmeasured
from garmentcad.analysis.run_record import Mode, RunRecord, Status
from garmentcad.export.table import PlainTable
from garmentcad.io.atomic import write_atomic

SCHEMA = 1
# Nested keys that scripts rely on.
NESTED = {
    "wall_time_s": ("setup", "drape", "total"),
    "rest": ("max_speed_m_s", "rms_speed_m_s", "kinetic_j_per_kg", "residual_g_rms"),
    "constraints": ("max_gap_mm", "max_speed_m_s", "conflicting", "gap_mm", "speed_m_s"),
    "energy_j": ("stretch", "shear", "bend", "band", "gravity", "friction_work", "internal_friction_work", "damping_work"),
}
# Values that are words, lists, true or false; all others are numbers, or null where they were not measured.
WORDS = frozenset(name for name, kind in get_type_hints(RunRecord).items() if kind in (str, Mode, Status, dict[str, str]))
LISTS = frozenset({"warnings", "constraints.conflicting"})
SWITCHES = frozenset({"uncalibrated"})
NO_NUMBERS = WORDS | LISTS | SWITCHES
HEM_KEYS = tuple(field.name for field in fields(HemShape))
SIGNIFICANT_DIGITS = 9
STATUS_STYLE = {"converged": "green", "max_time": "yellow", "diverged": "red", "intersecting": "red"}


def build_report(record: RunRecord, measures: Measures) -> dict[str, Any]:
    """The report as plain dicts, lists, strings and finite numbers, in the order in which it is written. What is not finite or was not measured is None.

    Raises ValueError where a nested dict of `record` lacks a key (a fault of the caller).
    """
    for name, keys in NESTED.items():
        missing = [key for key in keys if key not in getattr(record, name)]
        if missing:
            raise ValueError(f"RunRecord.{name} lacks {', '.join(missing)}")
    eases = {name: measures.ease.get(name) for name in EASE_LINES}
    hem = measures.hem
    report = {
        "schema": SCHEMA,
        "garment": record.garment,
        "fabric": record.fabric,
        "mannequin": record.mannequin,
        "grid_mm": record.grid_mm,
        "seed": record.seed,
        "mode": record.mode,
        "threads": record.threads,
        "versions": dict(sorted(record.versions.items())),
        "spec_sha256": record.spec_sha256,
        "fabric_sha256": record.fabric_sha256,
        "mannequin_sha256": record.mannequin_sha256,
        "state_sha256": record.state_sha256,
        "status": record.status,
        "particles": measures.particles,
        "triangles": measures.triangles,
        "panels": measures.panels,
        "mass_kg": measures.mass_kg,
        "seams": record.seams,
        "welds": record.welds,
        "steps": record.steps,
        "time_step_s": record.time_step_s,
        "simulated_time_s": record.simulated_time_s,
        "wall_time_s": _ordered("wall_time_s", record.wall_time_s),
        "rest": _ordered("rest", record.rest),
        "strain_percent": measures.strain_percent,
        "trellis_deg": measures.trellis_deg,
        "strain_over_limit_percent": measures.strain_over_limit_percent,
        "strain_of_limit_percent": measures.strain_of_limit_percent,
        "tension_n_m": measures.tension_n_m,
        "constraints": _ordered("constraints", record.constraints),
        "bands": record.bands,
        "seam_gap_mm": {"max": record.seam_gap_mm},
        "mannequin_penetration_mm": {"max": record.mannequin_penetration_mm},
        "self_intersections": record.self_intersections,
        "mannequin_intersections": record.mannequin_intersections,
        "pattern_ease_mm": {name: None if ease is None else ease.pattern_mm for name, ease in eases.items()},
        "ease_mm": {name: None if ease is None else ease.draped_mm for name, ease in eases.items()},
        "body_girth_mm": {name: None if ease is None else ease.body_mm for name, ease in eases.items()},
        "ease_level_mm": {name: None if ease is None else ease.level_mm for name, ease in eases.items()},
        "hem_height_mm": None if hem is None else hem.mean_mm,
        "hem_range_mm": {"min": None if hem is None else hem.low_mm, "max": None if hem is None else hem.high_mm},
        "hem_uneven_mm": None if hem is None else hem.uneven_mm,
        "hem": {name: None if measures.hem_shape is None else getattr(measures.hem_shape, name) for name in HEM_KEYS},
        "waist_drop_mm": None if measures.carried is None else measures.carried.waist_drop_mm,
        "armhole_to_shoulder_mm": dict.fromkeys(SIDES) if measures.carried is None else measures.carried.armhole_to_shoulder_mm,
        "fold_deg": measures.fold_deg,
        "pressure_kpa": measures.pressure_kpa,
        "friction_kpa": measures.friction_kpa,
        "support_n": measures.support_n,
        "contact_area_m2": measures.contact_area_m2,
        "distance_mm": measures.distance_mm,
        "seam_tension": {name: None if seam is None else vars(seam) for name, seam in measures.seams.items()},
        "energy_j": _ordered("energy_j", record.energy_j),
        "uncalibrated": record.uncalibrated,
        "warnings": list(record.warnings),
    }
    return {key: _plain(value) for key, value in report.items()}


def blank_report() -> dict[str, Any]:
    """The report of a run of which nothing is known: every key that each report has, values None; nothing in what the garment names itself."""
    known: dict[str, Any] = {field.name: None for field in fields(RunRecord)} | {name: dict.fromkeys(keys) for name, keys in NESTED.items()}
    known["constraints"] |= {"gap_mm": {}, "speed_m_s": {}}
    return build_report(RunRecord(**known | {"versions": {}, "warnings": (), "bands": {}}), unmeasured(0, 0, 0, 0.0))


def report_json(report: Mapping[str, Any]) -> str:
    """The text of report.json."""
    return json.dumps(report, indent=2, ensure_ascii=False, allow_nan=False) + "\n"


def write_report(path: str | Path, report: Mapping[str, Any]) -> Path:
    """Write report.json."""
    return write_atomic(path, report_json(report))


def report_table(report: Mapping[str, Any]) -> Table:
    """The figures that a person looks at first, for the terminal."""
    table = PlainTable(f"{report['garment']} · {report['fabric']} · {report['mannequin']}", show_header=False, pad_edge=False)
    table.add_column("quantity", style="dim", no_wrap=True)
    table.add_column("value")
    status = report["status"]
    table.add_row("status", Text(status, style=STATUS_STYLE[status]))
    table.add_row("lattice", f"{_show(report['grid_mm'], ' mm')}, {report['particles']} particles, {report['triangles']} triangles, {report['panels']} panels")
    step = _show(_thousandfold(report["time_step_s"]), " ms")
    table.add_row("motion", f"{report['steps']} steps of {step}, {_show(report['simulated_time_s'], ' s')} simulated")
    wall = report["wall_time_s"]
    table.add_row("wall time", f"{_show(wall['setup'], ' s')} setup, {_show(wall['drape'], ' s')} drape, {_show(wall['total'], ' s')} in all")
    table.add_row("rest", f"residual {_show(report['rest']['residual_g_rms'], ' g', 2)}, RMS speed {_show(report['rest']['rms_speed_m_s'], ' m/s', 2)}")
    for name in EASE_LINES:
        draped, drafted = report["ease_mm"][name], report["pattern_ease_mm"][name]
        if draped is not None:
            table.add_row(f"ease {name.replace('_', ' ')}", f"{draped:+.1f} mm draped, {drafted:+.1f} mm on the pattern")
    if report["hem_height_mm"] is not None:
        span = report["hem_range_mm"]
        table.add_row("hem height", f"{report['hem_height_mm']:.0f} mm ({span['min']:.0f} to {span['max']:.0f})")
    if report["hem"]["nodes"] is not None:
        table.add_row("hem from above", f"{report['hem']['nodes']} nodes, drape coefficient {report['hem']['drape_coefficient_percent']:.1f} %")
    if report["waist_drop_mm"] is not None:
        drop = report["waist_drop_mm"]
        table.add_row("waist", f"{abs(drop):.1f} mm {'below' if drop >= 0.0 else 'above'} where it was placed")
    reach = [value for value in report["armhole_to_shoulder_mm"].values() if value is not None]
    if reach:
        table.add_row("armholes", f"{' and '.join(f'{value:.1f}' for value in reach)} mm from the shoulder points")
    for name, angle in report["fold_deg"].items():
        table.add_row(f"fold {name}", _show(angle, "°"))
    for axis, values in report["strain_percent"].items():
        table.add_row(f"strain {axis}", f"median {_show(values['p50'], ' %')}, p99 {_show(values['p99'], ' %')}, max {_show(values['max'], ' %')}")
    trellis, pressure = report["trellis_deg"], report["pressure_kpa"]
    table.add_row("trellis angle", f"p99 {_show(trellis['p99'], '°')}, {_show(trellis['over_8_percent'], ' %')} of the area over 8°")
    table.add_row("pressure", f"max {_show(pressure['max'], ' kPa')}, mean in contact {_show(pressure['mean_in_contact'], ' kPa')}")
    for name, gap in report["constraints"]["gap_mm"].items():
        table.add_row(f"held by {name}", f"within {_show(gap, ' mm', 2)}")
    for name, band in report["bands"].items():
        table.add_row(f"band {name}", f"{_show(band['tension_n'], ' N')}, {band['length_mm']:.0f} mm long, {band['rest_length_mm']:.0f} mm at rest")
    table.add_row("seam gap at welding", _show(report["seam_gap_mm"]["max"], " mm", 2))
    crossings = _count(report["self_intersections"]), " in the cloth, ", _count(report["mannequin_intersections"]), " with the mannequin"
    table.add_row("intersections", Text.assemble(*crossings))
    table.add_row("deepest penetration", _show(report["mannequin_penetration_mm"]["max"], " mm", 2))
    if "movement" in report:
        table.add_row("movement", _movement(report["movement"]))
    if report["uncalibrated"]:
        table.add_row("fabric law", "uncalibrated: values as printed on the sheet")
    for warning in report["warnings"]:
        table.add_row(Text("warning", style="yellow"), warning)
    return table


def _movement(moved: Mapping[str, Any]) -> str:
    if "frames" not in moved:
        return str(moved["status"])
    found = f"{moved['self_intersections']} intersections in the cloth, {moved['mannequin_intersections']} with the mannequin"
    slip = "" if moved["waist_slip_mm"] is None else f", the waist slips by {_show(moved['waist_slip_mm'], ' mm')}"
    deepest = f"deepest penetration {_show(moved['mannequin_penetration_mm'], ' mm', 2)}"
    return f"{moved['status']}, {len(moved['frames'])} frames in {_show(moved['seconds'], ' s')}: at most {found}, {deepest}{slip}"


def _ordered(name: str, values: Mapping[str, Any]) -> dict[str, Any]:
    first = {key: values[key] for key in NESTED[name]}
    return first | {key: values[key] for key in sorted(values) if key not in first}


def _plain(value: Any) -> Any:
    """Python numbers with nine significant digits; None for what is not finite."""
    if isinstance(value, Mapping):
        return {str(key): _plain(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(item) for item in value]
    if isinstance(value, np.ndarray):
        return _plain(value.tolist())
    if isinstance(value, (bool, np.bool_)):
        return bool(value)
    if isinstance(value, (int, np.integer)):
        return int(value)
    if isinstance(value, (float, np.floating)):
        return float(f"{float(value):.{SIGNIFICANT_DIGITS}g}") if math.isfinite(value) else None
    return value


def _thousandfold(value: float | None) -> float | None:
    return None if value is None else 1000.0 * value


def _show(value: float | None, unit: str, digits: int = 3) -> str:
    return "not measured" if value is None else (f"{value:.{digits}g}" if abs(value) < 10.0**digits else f"{value:.0f}") + unit


def _count(value: int | None) -> Text:
    return Text("not counted" if value is None else f"{value}", style="red" if value else "")
