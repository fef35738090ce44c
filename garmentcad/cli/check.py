"""garmentcad check: the pattern doctor."""

from __future__ import annotations

import json
from dataclasses import asdict, replace
from typing import Annotated

import typer

from garmentcad.cli.named import named_numbers, option_of


def check(
    spec: Annotated[str, typer.Argument(help="A shipped garment or a YAML file.")],
    fabric: Annotated[str | None, typer.Option(help="In place of the spec's.")] = None,
    mannequin: Annotated[str | None, typer.Option(help="In place of the spec's.")] = None,
    grid: Annotated[float, typer.Option(help="Lattice spacing in mm of the drape that is meant; some findings depend on it.")] = 10.0,
    values: Annotated[list[str] | None, typer.Option("--set", help="NAME=NUMBER: a parameter, in place of the spec's value. May stand several times.")] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print the findings as one JSON object and nothing else.")] = False,
) -> None:
    """Find what is wrong with a pattern: every finding with its place, its numbers and a remedy. Exit code 2 only if there are errors."""
    from garmentcad.check.examine import examine

    found = examine(spec, mannequin, grid, fabric, named_numbers(values, "--set"))
    findings = [replace(finding, key=option_of(finding.key, finding.file)) for finding in found]
    errors = sum(finding.severity == "error" for finding in findings)
    if as_json:
        print(json.dumps({"findings": [asdict(finding) for finding in findings], "errors": errors}))
    else:
        for finding in findings:
            print(finding)
        print(f"{len(findings)} finding{'s' * (len(findings) != 1)}, {errors} error{'s' * (errors != 1)}")
    raise typer.Exit(2 if errors else 0)
