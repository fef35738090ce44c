"""garmentcad import: a garment of another program as a spec."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated

import typer


def import_file(
    file: Annotated[Path, typer.Argument(help="A GarmentCode pattern (.json).")],
    out: Annotated[Path, typer.Option("--out", "-o", help="The spec to write (.yaml).")],
) -> None:
    """Turn a pattern of another program into a garment spec. What was assumed or left out is said on stderr."""
    from garmentcad.errors import InputError
    from garmentcad.io.garmentcode_body import body_file_of, write_body
    from garmentcad.io.garmentcode_import import import_garmentcode
    from garmentcad.io.spec_file import write_spec
    from garmentcad.io.yaml_file import refuse_no_yaml

    if file.suffix != ".json":
        raise InputError(f"cannot import '{file.suffix or file.name}'; allowed is .json (GarmentCode)", file=str(file))
    refuse_no_yaml(out, "--out")
    made = import_garmentcode(file)
    spec, body = made.spec, body_file_of(file)
    if body is not None:  # a spec refers to files in its own folder
        beside = out.with_name(f"{out.stem}-body.yaml")
        write_body(body, beside)
        spec = spec.model_copy(update={"mannequin": beside.name})
        print(beside)
    write_spec(spec, out)
    for note in made.notes:
        print(f"note: {note}", file=sys.stderr)
    print(out)
