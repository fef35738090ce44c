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
    """Shipped fabrics, one a line."""
    from garmentcad.io.fabric_file import fabric_names, fabric_path, load_fabric

    for name in fabric_names():
        print(f"{name:24} {load_fabric(fabric_path(name)).sheet.description.splitlines()[0]}")


@app.command("show")
def show(
    name: Annotated[str, typer.Argument(help="A shipped fabric or a file.")],
    as_json: Annotated[bool, typer.Option("--json", help="One JSON object and nothing else.")] = False,
) -> None:
    """Every value of a sheet with its unit, its source or the rule of its estimate, and what was noticed."""
    from garmentcad.fabric.describe import sheet_lines
    from garmentcad.io.fabric_file import fabric_path, load_fabric

    completed = load_fabric(fabric_path(name))
    rows = sheet_lines(completed)
    if as_json:
        print(json.dumps({"fabric": completed.sheet.name, "rows": [row._asdict() for row in rows]}))
        return
    from rich.console import Console
    from rich.table import Table

    table = Table(title=completed.sheet.name, title_justify="left")
    for column in ("value", "", "unit", "from", "noticed"):
        table.add_column(column, overflow="fold")
    for row in rows:
        table.add_row(row.key, f"{row.value:.4g}", row.unit, row.origin, row.finding)
    Console().print(table)
