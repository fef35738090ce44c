"""garmentcad fit: how a draped garment fits, as numbers."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated

import typer


def fit(
    folder: Annotated[Path, typer.Argument(help="A result folder of `garmentcad drape`.")],
    out: Annotated[Path | None, typer.Option("--out", "-o", help="The file to write: .json or .csv.")] = None,
    line: Annotated[list[str] | None, typer.Option(help="Measure here, too: NAME=HEIGHT in mm above the floor, or NAME=x,y,z:nx,ny,nz.")] = None,
    coarser: Annotated[list[Path] | None, typer.Option(help="A result of the same garment on a coarser lattice: error bars.")] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print the fit as one JSON object and nothing else.")] = False,
) -> None:
    """Fit of a draped garment: ease, hem, strain, tension, seams, pressure, distance."""
    from rich.console import Console

    from garmentcad.analysis.body_line import parse_line
    from garmentcad.export.fit import fit_json, fit_of, fit_tables, write_fit
    from garmentcad.export.result_folder import read_result_folder

    lines = [parse_line(text) for text in line or []]
    made = fit_of(read_result_folder(folder), lines, [read_result_folder(other) for other in coarser or []])
    if out is not None:
        write_fit(out, made)
    if as_json:
        print(fit_json(made), end="")
        return
    if made["status"] != "converged":
        print(f"garmentcad: this drape ended as {made['status']}: its figures are not those of a garment at rest", file=sys.stderr)
    for table in fit_tables(made):
        Console().print(table)
    if out is not None:
        print(out)
