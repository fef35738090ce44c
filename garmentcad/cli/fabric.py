"""garmentcad fabric: what sheets there are and what they say."""

from __future__ import annotations

import json
from typing import Annotated

import typer

from garmentcad.cli.fabric_fit import fit

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
    from garmentcad.fabric.describe import sheet_lines
    from garmentcad.fabric.missing import measured_fraction
    from garmentcad.io.fabric_file import fabric_path, load_fabric

    completed = load_fabric(fabric_path(name))
    rows, measured = sheet_lines(completed), measured_fraction(completed.sheet)
    if as_json:
        print(json.dumps({"fabric": completed.sheet.name, "measured_fraction": measured, "rows": [row._asdict() for row in rows]}))
        return
    from rich.console import Console
    from rich.table import Table

    table = Table(title=f"{completed.sheet.name}: {100 * measured:.0f} % measured", title_justify="left")
    for column in ("value", "", "unit", "from", "noticed"):
        table.add_column(column, overflow="fold")
    for row in rows:
        table.add_row(row.key, f"{row.value:.4g}", row.unit, row.origin, row.finding)
    Console().print(table)
