"""garmentcad render and export: pictures and files from a result folder, or a pattern's own files."""

from __future__ import annotations

import sys
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from garmentcad.cli.named import named_numbers
from garmentcad.errors import InputError, SpecError


class View(StrEnum):
    front = "front"
    back = "back"
    left = "left"
    right = "right"
    three_quarter = "three-quarter"


class Map(StrEnum):
    none = "none"
    strain = "strain"
    warp = "warp"
    weft = "weft"
    bias = "bias"
    limit = "limit"
    tension = "tension"
    pressure = "pressure"
    friction = "friction"
    distance = "distance"


def render(
    folder: Annotated[Path, typer.Argument(help="A result folder of `garmentcad drape`.")],
    out: Annotated[Path, typer.Option("--out", "-o", help="The PNG to write.")],
    view: Annotated[View, typer.Option(help="From where.")] = View.front,
    map_: Annotated[Map, typer.Option("--map", help="What to paint, with a legend.")] = Map.none,
) -> None:
    """Draw a draped garment."""
    from garmentcad.export.picture import render_picture
    from garmentcad.export.result_folder import read_result_folder

    if out.suffix != ".png":
        raise InputError(f"cannot write '{out.suffix or out.name}'; pictures are .png", file=str(out), key="--out")
    result = read_result_folder(folder)
    values = None if map_ is Map.none else result.maps.get(map_.value)
    if map_ is not Map.none and values is None:
        raise InputError(f"the folder has no map '{map_.value}'; it has: {', '.join(result.maps) or 'none'}", file=str(folder), key="--map")
    print(render_picture(out, result.state.positions, result.cloth, result.mannequin, view.value, map_.value, values))


def export(
    source: Annotated[str, typer.Argument(help="A result folder; or, for patterns, a shipped garment or a spec.")],
    out: Annotated[Path, typer.Option("--out", "-o", help="The file to write: .obj, .glb or .png (draped), .json (pattern, GarmentCode).")],
    mannequin: Annotated[str | None, typer.Option(help="Whom a pattern (.json) is drafted for, in place of the spec's.")] = None,
    values: Annotated[list[str] | None, typer.Option("--set", help="NAME=NUMBER: a parameter of a pattern (.json). May stand several times.")] = None,
) -> None:
    """Write a draped garment, or a pattern, in another format. What the format cannot say is said on stderr."""
    from garmentcad.export.glb import write_garment_glb
    from garmentcad.export.obj import write_garment_obj
    from garmentcad.export.picture import render_picture
    from garmentcad.export.result_folder import read_result_folder

    if out.suffix == ".json":
        _export_pattern(source, out, mannequin, named_numbers(values, "--set"))
        return
    kinds = {".obj": "mesh", ".glb": "scene", ".png": "picture", ".json": "pattern"}
    if out.suffix not in kinds:
        raise InputError(f"cannot write '{out.suffix or out.name}'; allowed are {', '.join(kinds)}", file=str(out), key="--out")
    if mannequin is not None:
        raise InputError(f"a draped garment stays on its mannequin; patterns are drafted for another one (.json), not {out.suffix}", key="--mannequin")
    if values:
        raise InputError(f"a draped garment has its parameters; patterns are drafted with others (.json), not {out.suffix}", key="--set")
    result = read_result_folder(Path(source))
    if out.suffix == ".obj":
        write_garment_obj(out, result.cloth, result.state.positions)
    elif out.suffix == ".glb":
        write_garment_glb(out, result.cloth, result.state.positions, result.mannequin)
    else:
        render_picture(out, result.state.positions, result.cloth, result.mannequin, "front")
    print(out)


def _export_pattern(source: str, out: Path, mannequin: str | None, values: dict[str, float]) -> None:
    from garmentcad.export.garmentcode import write_garmentcode
    from garmentcad.simulation.job import make_job

    job = make_job(source, mannequin=mannequin, values=values)
    try:
        notes = write_garmentcode(out, job.pattern, job.mannequin)
    except SpecError as fault:  # a pattern does not know its file
        raise SpecError(fault.message, file=job.spec.file, key=fault.key) from None
    for note in notes:
        print(f"note: {note}", file=sys.stderr)
    print(out)
