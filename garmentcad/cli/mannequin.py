"""garmentcad mannequin: what bodies there are and how they measure."""

from __future__ import annotations

import json
from typing import Annotated

import typer

app = typer.Typer(no_args_is_help=True, help="Mannequins.")


@app.command("list")
def list_mannequins() -> None:
    """Shipped mannequins, one a line."""
    from garmentcad.io.mannequin_file import mannequin_names

    for name in mannequin_names():
        print(name)


@app.command("show")
def show(
    name: Annotated[str, typer.Argument(help="A shipped mannequin or a file.")],
    as_json: Annotated[bool, typer.Option("--json", help="One JSON object and nothing else.")] = False,
) -> None:
    """Measurements of a mannequin in mm."""
    from garmentcad.io.mannequin_file import read_mannequin

    body = read_mannequin(name)
    if as_json:
        print(json.dumps({"mannequin": body.name, "measurements_mm": body.measurements_mm}))
        return
    for key, value in sorted(body.measurements_mm.items()):
        print(f"{key:20} {value:8.1f} mm")
