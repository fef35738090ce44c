"""garmentcad fabric fit: from tester curves, FAST readings or a cantilever length to a sheet with bounds."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated

import typer

from garmentcad.errors import InputError


def fit(
    files: Annotated[list[Path], typer.Argument(help="CSV files of one fabric: tester curves, or FAST readings, lengths and printed values.")],
    out: Annotated[Path, typer.Option("--out", "-o", help="The sheet to write (.yaml); its name is the fabric's.")],
    as_json: Annotated[bool, typer.Option("--json", help="One JSON object and nothing else.")] = False,
) -> None:
    """Fit a sheet to tests, with the bounds that they leave."""
    from garmentcad.fabric.fit import fit_sheet
    from garmentcad.fabric.quantity import quantity_of
    from garmentcad.io.fabric_file import write_fabric
    from garmentcad.io.fit_csv import read_fit_files
    from garmentcad.io.yaml_file import ENDINGS, refuse_no_yaml

    if out.name.lower() in ENDINGS:
        raise InputError(f"a name is wanted before the ending {out.name}; it becomes the fabric's", file=str(out), key="--out")
    refuse_no_yaml(out, "--out")
    values, loops, findings, texts = read_fit_files(files)
    sheet, fitted, assumed, remarks = fit_sheet(out.stem, values, loops, texts)
    write_fabric(sheet, out)
    said = [str(finding) for finding in (*findings, *remarks)]
    rows = [{**value._asdict(), "unit": quantity_of(value.key).unit} for value in fitted]
    if as_json:
        print(json.dumps({"fabric": sheet.name, "sheet": str(out), "fitted": rows, "assumed": sorted(assumed), "findings": said}))
        return
    from rich.console import Console

    from garmentcad.export.table import PlainTable

    table = PlainTable(f"{sheet.name}: {out}")
    for column in ("value", "", "bounds", "unit", "how"):
        table.add_column(column, overflow="fold")
    for value in fitted:
        table.add_row(value.key, f"{value.value:.4g}", f"{value.low:.4g} to {value.high:.4g}", quantity_of(value.key).unit, value.how)
    Console().print(table)
    for line in said:
        print(line)
