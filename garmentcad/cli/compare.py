"""garmentcad compare: what differs between two draped garments."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated

import typer

from garmentcad.cli.output import Map, View


def compare(
    a: Annotated[Path, typer.Argument(help="A result folder.")],
    b: Annotated[Path, typer.Argument(help="Another: of another fabric, size, lattice or version.")],
    out: Annotated[Path | None, typer.Option("--out", "-o", help="The file to write: .png, .csv or .json.")] = None,
    view: Annotated[View, typer.Option(help="Of the picture: from where.")] = View.front,
    map_: Annotated[Map, typer.Option("--map", help="Of the picture: what to paint on both, on one scale.")] = Map.none,
    as_json: Annotated[bool, typer.Option("--json", help="Print the comparison as one JSON object and nothing else.")] = False,
) -> None:
    """Compare two draped garments: figures of both, their differences, and how far the shapes lie apart."""
    from rich.console import Console

    from garmentcad.export.compare import compare as compared
    from garmentcad.export.compare import comparison_data, comparison_tables, read_worn, write_comparison

    found = compared(read_worn(a), read_worn(b))
    if out is not None:
        write_comparison(out, (a, b), found, view.value, map_.value)
    if as_json:
        print(json.dumps(comparison_data(found), allow_nan=False))
        return
    for table in comparison_tables(found):
        Console().print(table)
    if out is not None:
        print(out)
