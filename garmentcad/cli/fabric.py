"""garmentcad fabric: what sheets there are and what they say."""

from __future__ import annotations

import json
import re
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from garmentcad.cli.fabric_fit import fit

if TYPE_CHECKING:
    from garmentcad.rigs.passport import Passport

app = typer.Typer(no_args_is_help=True, help="KES sheets.")
app.command("fit")(fit)


@app.command("list")
def list_fabrics() -> None:
    """Shipped fabrics, one a line: mass per area, measured share of the sheet, what it is."""
    from garmentcad.fabric.missing import measured_fraction
    from garmentcad.io.fabric_file import fabric_names, fabric_path, read_fabric
    from garmentcad.units import G_M2_TO_KG_M2, MG_CM2_TO_KG_M2

    for name in fabric_names():
        sheet = read_fabric(fabric_path(name))
        weight = sheet.number("W") * MG_CM2_TO_KG_M2 / G_M2_TO_KG_M2
        print(f"{name:24} {weight:4.0f} g/m2 {100 * measured_fraction(sheet):4.0f} % measured  {sheet.description.splitlines()[0]}")


@app.command("show")
def show(
    name: Annotated[str, typer.Argument(help="A shipped fabric or a file.")],
    as_json: Annotated[bool, typer.Option("--json", help="One JSON object and nothing else.")] = False,
) -> None:
    """Every value of a sheet with its unit, its source or the rule of its estimate, and what was noticed."""
    from garmentcad.fabric.describe import sheet_lines, sheet_remarks
    from garmentcad.fabric.missing import measured_fraction
    from garmentcad.io.fabric_file import fabric_path, load_fabric

    completed = load_fabric(fabric_path(name))
    rows, measured = sheet_lines(completed), measured_fraction(completed.sheet)
    remarks = [str(finding) for finding in sheet_remarks(completed)]
    if as_json:
        print(json.dumps({"fabric": completed.sheet.name, "measured_fraction": measured, "rows": [row._asdict() for row in rows], "findings": remarks}))
        return
    from rich.console import Console

    from garmentcad.export.table import PlainTable

    table = PlainTable(f"{completed.sheet.name}: {100 * measured:.0f} % measured")
    for column in ("value", "", "unit", "from", "noticed"):
        table.add_column(column, overflow="fold")
    for row in rows:
        table.add_row(row.key, f"{row.value:.4g}", row.unit, row.origin, row.finding)
    Console().print(table)
    for remark in remarks:
        print(remark)


@app.command("test")
def write_passport(
    name: Annotated[str, typer.Argument(help="A shipped fabric or a file.")],
    out: Annotated[Path | None, typer.Option("--out", "-o", help="Folder of the passport. Default: out/fabric-NAME.")] = None,
    grid: Annotated[float, typer.Option(help="Lattice spacing in mm; 12.5 leaves four cells between the clamps.", min=1.0, max=12.5)] = 10.0,
    lays: Annotated[int, typer.Option(help="Lays on the drapemeter; 0 leaves it out.", min=0, max=100)] = 5,
    disc: Annotated[str, typer.Option(help="Disc and specimen of the drapemeter, cm: 18/24, 18/30, 18/36 or 12.7/25.4.")] = "18/30",
    as_json: Annotated[bool, typer.Option("--json", help="One JSON object and nothing else.")] = False,
) -> None:
    """The fabric passport: what virtual Kawabata testers, a cantilever and a drapemeter print of a sheet, beside the sheet.

    A sheet without law values is calibrated first (minutes, once), and its file keeps them. Exit code 3 where a drape did not come to rest.
    """
    from garmentcad.errors import FileError, InputError
    from garmentcad.export.report import report_json
    from garmentcad.export.result_folder import make_folder
    from garmentcad.fabric.sheet import is_calibrated
    from garmentcad.io.atomic import write_atomic
    from garmentcad.io.fabric_file import fabric_path, load_fabric, write_law
    from garmentcad.rigs.calibrate import calibrate
    from garmentcad.rigs.cusick import GEOMETRIES
    from garmentcad.rigs.passport import make_passport
    from garmentcad.rigs.passport_page import write_page

    def say(message: str) -> None:
        if not as_json:
            print(message, file=sys.stderr, flush=True)

    path = fabric_path(name)
    sheet, findings, _ = load_fabric(path)
    for finding in findings:
        if finding.severity == "warning":
            print(finding, file=sys.stderr)
    if disc not in GEOMETRIES:
        raise InputError(f"{disc!r} came; allowed are {', '.join(GEOMETRIES)}", key="--disc")
    folder = out if out is not None else Path("out") / ("fabric-" + re.sub(r"[^\w.+-]+", "-", sheet.name))  # a name may hold a slash
    make_folder(folder)  # before minutes of work, not after
    if not is_calibrated(sheet):
        sheet = calibrate(sheet, say=say)
        assert sheet.law is not None
        try:
            if path.suffix.lower() == ".csv":
                raise FileError("law values have no place in a CSV file", file=str(path))
            write_law(path, sheet.law)
        except FileError as error:
            print(f"warning: the calibration is not kept: {error}", file=sys.stderr)
    passport = make_passport(sheet, grid, lays, disc, say)
    write_atomic(folder / "passport.json", report_json(passport.figures))
    write_page(folder / "passport.html", passport)
    if as_json:
        print(json.dumps(passport.figures, allow_nan=False))
    else:
        _print_passport(passport, folder)
    raise typer.Exit(0 if passport.converged else 3)


def _print_passport(passport: Passport, folder: Path) -> None:
    from rich.console import Console

    from garmentcad.export.table import PlainTable

    table = PlainTable(f"{passport.sheet.name} at {passport.figures['grid_mm']:g} mm")
    for column in ("value", "sheet", "virtual tester", "error, %"):
        table.add_column(column, justify="right")
    for key, row in passport.figures["kes"].items():
        given, error = row["input"], row["error_percent"]
        table.add_row(key, "-" if given is None else f"{given:.4g}", f"{row['simulated']:.4g}", "-" if error is None else f"{error:+.2f}")
    for way in ("warp", "weft"):
        table.add_row(f"bending length {way}, mm", "", f"{passport.figures['cantilever'][way]['bending_length_mm']:.1f}", "")
    drape = passport.figures["drape"]
    if drape is not None:
        table.add_row("drape coefficient, %", "", f"{drape['dc_percent']['mean']:.1f}", "")
        table.add_row("nodes", "", f"{drape['nodes']['mean']:.1f}", "")
    Console().print(table)
    print(f"  {folder / 'passport.html'}")
