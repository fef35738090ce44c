"""The fit of a draped garment as a file and as a table: what the report measured, lines that the user names, error bars."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from rich.table import Table

from garmentcad.analysis.body_line import BodyLine
from garmentcad.analysis.ease import EASE_LINES
from garmentcad.analysis.figures import FIT_KEYS, Figure, figures
from garmentcad.analysis.plane_fit import loops_in_plane
from garmentcad.analysis.refinement import error_bars
from garmentcad.errors import InputError
from garmentcad.export.result_folder import Result
from garmentcad.export.table import PlainTable
from garmentcad.io.atomic import write_atomic

IDENTITY = ("schema", "garment", "fabric", "mannequin", "grid_mm", "seed", "mode", "status", "versions", "spec_sha256", "fabric_sha256", "mannequin_sha256",
            "state_sha256")  # fmt: skip
SAME_GARMENT = ("spec_sha256", "fabric", "mannequin", "mode")
SAME_VALUES = ("fabric_sha256", "mannequin_sha256")  # where both reports have them
FORMATS = (".json", ".csv")
_OWN_TABLE = ("ease_mm", "pattern_ease_mm", "body_girth_mm", "ease_level_mm", "lines", "seam_tension")


def fit_of(result: Result, lines: Sequence[BodyLine] = (), coarser: Sequence[Result] = ()) -> dict[str, Any]:
    """The fit as plain data: identity, every figure of `FIT_KEYS` that the report has, `lines` measured now and, with results of the same garment on coarser
    lattices, `error_bars` by path. InputError for a coarser result of another garment, fabric, mannequin or mode, or not at rest, for
    lines of a garment without a body, and for lines with a name of the report's own."""
    made = _with_lines(result, lines)
    if coarser:
        for other in coarser:
            unlike = [key for key in SAME_GARMENT if other.report.get(key) != result.report.get(key)]
            known = [key for key in SAME_VALUES if key in other.report and key in result.report]
            unlike += [f"the values of the {key.removesuffix('_sha256')}" for key in known if other.report[key] != result.report[key]]
            if unlike:
                raise InputError(f"the coarser drape is another one: {', '.join(unlike)} differ", key="coarser")
            if other.report["status"] != "converged":
                raise InputError(f"the coarser drape ended as {other.report['status']}; one that came to rest is wanted", key="coarser")
        pairs = [(float(other.report["grid_mm"]), figures(_with_lines(other, lines))) for other in coarser]
        made["error_bars"] = error_bars(figures(made), float(result.report["grid_mm"]), pairs)
    return made


def _with_lines(result: Result, lines: Sequence[BodyLine]) -> dict[str, Any]:
    made = {key: result.report[key] for key in (*IDENTITY, *FIT_KEYS) if key in result.report}
    if not lines:
        return made
    if result.mannequin is None:
        raise InputError("this result has no mannequin to measure a line on", key="lines")
    measured: dict[str, Any] = {}
    for line in lines:
        if line.name in EASE_LINES:
            own = ", ".join(EASE_LINES)
            raise InputError(f"{line.name!r} is the name of a line that every report has; allowed are names other than {own}", key="lines")
        if line.name in measured:
            raise InputError(f"the line {line.name} stands twice; each name may stand once", key="lines")
        loops = loops_in_plane(result.cloth, result.state.positions, result.mannequin, line.plane)
        names = ("draped_mm", "pattern_mm", "body_mm", "ease_mm", "pattern_ease_mm")
        found: dict[str, dict[str, float | None]] = {}
        for loop in loops:
            own = parts = "+".join(loop.parts)
            number = 1
            while own in found:  # a plane may cut a part twice
                own = f"{parts}_{(number := number + 1)}"
            found[own] = {name: getattr(loop, name) for name in names}
        measured[line.name] = found
    return made | {"lines": measured}


def write_fit(path: Path, fit: Mapping[str, Any]) -> Path:
    """Write a fit as .json (all of it) or .csv (a row a figure: quantity, value, error, unit). InputError for another ending."""
    if path.suffix not in FORMATS:
        raise InputError(f"cannot write '{path.suffix or path.name}'; allowed are {', '.join(FORMATS)}", file=str(path))
    if path.suffix == ".json":
        return write_atomic(path, fit_json(fit))
    bars = fit.get("error_bars", {})
    rows = [(name, _cell(figure.value), _cell(bars.get(name)), figure.unit) for name, figure in figures(fit).items()]
    return write_atomic(path, csv_text(("quantity", "value", "error", "unit"), rows))


def fit_json(fit: Mapping[str, Any]) -> str:
    """The text of a .json file."""
    return json.dumps(fit, indent=2, ensure_ascii=False, allow_nan=False) + "\n"


def csv_text(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Rows of cells as CSV."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerows([head, *rows])
    return text.getvalue()


def fit_tables(fit: Mapping[str, Any]) -> list[Table]:
    """For the terminal: lines on the body, seams, and all other figures that were measured; with error bars where there are some."""
    found, bars = figures(fit), fit.get("error_bars", {})

    def cell(path: str) -> str:
        return shown(found.get(path)) + (f" ± {bars[path]:.2g}" if bars.get(path) else "")

    lines = plain_table("line", "body mm", "ease mm", "pattern ease mm", "level mm")
    for name, ease in fit.get("ease_mm", {}).items():
        if ease is not None:
            lines.add_row(name, *(cell(f"{key}.{name}") for key in ("body_girth_mm", "ease_mm", "pattern_ease_mm", "ease_level_mm")))
    for name, loops in fit.get("lines", {}).items():
        if not loops:
            lines.add_row(f"{name} (cuts no cloth)", "", "", "", "")
        for parts in loops:
            lines.add_row(f"{name} ({parts})", *(cell(f"lines.{name}.{parts}.{key}") for key in ("body_mm", "ease_mm", "pattern_ease_mm")), "")
    lines.title = f"{fit['garment']} · {fit['fabric']} · {fit['mannequin']} · {fit['grid_mm']:g} mm"
    lines.title += "" if fit["status"] == "converged" else f" · NOT CONVERGED ({fit['status']})"
    seams = plain_table("seam", "length mm", "across N/m", "most N/m", "along N/m")
    for name, seam in fit.get("seam_tension", {}).items():
        if seam is not None:
            seams.add_row(name, *(cell(f"seam_tension.{name}.{key}") for key in ("length_mm", "mean_n_m", "max_n_m", "along_n_m")))
    rest = plain_table("quantity", "value")
    rest.add_column("unit")
    for path, figure in found.items():
        if figure.value is not None and path.split(".")[0] not in _OWN_TABLE:
            rest.add_row(path, cell(path), figure.unit)
    return [table for table in (lines, seams, rest) if table.row_count]


def plain_table(first: str, *others: str) -> Table:
    """An empty table: a column of names, which fold where the terminal is narrow, and columns of numbers, which never lose a digit."""
    table = PlainTable()
    table.add_column(first, overflow="fold")
    for other in others:
        table.add_column(other, justify="right", no_wrap=True)
    return table


def shown(figure: Figure | None) -> str:
    """A value for a table: to a tenth of a millimetre, else three digits."""
    if figure is None or figure.value is None:
        return "–"
    if figure.unit == "mm":
        return f"{figure.value:.1f}"
    return f"{figure.value:.3g}" if abs(figure.value) < 1000.0 else f"{figure.value:.0f}"


def _cell(value: float | None) -> str:
    return "" if value is None else f"{value:.9g}"
