"""garmentcad compare: what differs between two draped garments."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Annotated

import typer

from garmentcad.cli.output import Map, View
from garmentcad.errors import InputError


def compare(
    a: Annotated[Path, typer.Argument(help="A result folder.")],
    b: Annotated[Path, typer.Argument(help="Another: of another fabric, size, lattice or version.")],
    out: Annotated[Path | None, typer.Option("--out", "-o", help="The file to write: .png, .csv or .json.")] = None,
    view: Annotated[View | None, typer.Option(help="Of the picture: from where.", show_default="front")] = None,
    map_: Annotated[Map | None, typer.Option("--map", help="Of the picture: what to paint on both, on one scale.", show_default="none")] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print the comparison as one JSON object and nothing else.")] = False,
) -> None:
    """Compare two draped garments: figures of both, their differences, and how far the shapes lie apart."""
    from rich.console import Console

    from garmentcad.export.compare import compare as compared
    from garmentcad.export.compare import comparison_data, comparison_tables, read_worn, write_comparison

    if out is None or out.suffix != ".png":
        for option, value in (("--view", view), ("--map", map_)):
            if value is not None:
                raise InputError(f"{value.value} is said of a picture; write one (-o FILE.png)", key=option)
    found = compared(read_worn(a), read_worn(b))
    if out is not None:
        write_comparison(out, (a, b), found, (view or View.front).value, (map_ or Map.none).value)
    if as_json:
        print(json.dumps(comparison_data(found), allow_nan=False))
        return
    for letter, status in zip("AB", found.status):
        if status != "converged":
            print(f"garmentcad: {letter} ended as {status}: its figures are not those of a garment at rest", file=sys.stderr)
    for table in comparison_tables(found):
        Console().print(table)
    if out is not None:
        print(out)
