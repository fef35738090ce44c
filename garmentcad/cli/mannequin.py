"""garmentcad mannequin: what bodies there are, how they measure, and bodies of other measurements."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated

import typer

from garmentcad.cli.named import named_numbers
from garmentcad.errors import InputError, did_you_mean
from garmentcad.units import M_TO_MM

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
    """Measurements of a mannequin in mm, the radii of the cylinders on which panels are wrapped, and the landmarks that pins go by (x to its left, y above the
    floor, z to the front)."""
    from garmentcad.io.mannequin_file import read_mannequin

    body = read_mannequin(name)
    radii = {part: (M_TO_MM * around.radius_ref, M_TO_MM * around.radius_side) for part, around in body.cylinders.items()}
    marks = {mark: [M_TO_MM * float(value) for value in place] for mark, place in sorted(body.landmarks.items())}
    if as_json:
        found = {"mannequin": body.name, "measurements_mm": body.measurements_mm, "estimated": list(body.estimated), "notes": list(body.notes)}
        print(json.dumps(found | {"cylinder_radii_mm": radii, "landmarks_mm": marks}))
        return
    for key, value in sorted(body.measurements_mm.items()):
        print(f"{key:20} {value:8.1f} mm{'  (not measured on this body)' if key in body.estimated else ''}")
    for part, (at_0, at_90) in radii.items():
        print(f"cylinder {part:11} {at_0:8.1f} mm radius at the angle 0, {at_90:.1f} mm at 90")
    for mark, (x, y, z) in marks.items():
        print(f"landmark {mark:24} {x:8.1f} {y:8.1f} {z:8.1f} mm")
    for note in body.notes:
        print(note)


@app.command("make")
def make(
    source: Annotated[str, typer.Argument(help="woman or man; or a shipped mannequin, a measurements file or a scan, to write in another format.")],
    measurements: Annotated[list[str] | None, typer.Argument(help="NAME=MM for woman and man: bust=860 waist=690 hip=950 ...")] = None,
    out: Annotated[Path, typer.Option("--out", "-o", help=".yaml (for --mannequin), .obj (the surface, m) or .png.")] = Path("body.yaml"),
    arm_angle: Annotated[float | None, typer.Option(help="Of the arms from the vertical, in degrees.")] = None,
    form: Annotated[bool, typer.Option("--form", help="A dress form: no head, no arms.")] = False,
    pad: Annotated[str | None, typer.Option(help="Shoulder pads in mm: THICKNESS[,LENGTH[,WIDTH[,OVERHANG]]].")] = None,
    pose: Annotated[str | None, typer.Option(help="Shipped motion or pose file; its last pose is written (.obj, .png).")] = None,
) -> None:
    """Make a body of measurements, or write a mannequin as a surface or picture."""
    from dataclasses import replace

    import yaml

    from garmentcad.export.obj import write_mannequin_obj
    from garmentcad.export.picture import render_body
    from garmentcad.io.atomic import write_atomic
    from garmentcad.io.mannequin_file import KINDS, checked_spec, mannequin_names, mannequin_of, read_mannequin
    from garmentcad.io.pose_file import read_poses
    from garmentcad.mannequin.motion import motion

    known = [*KINDS, *mannequin_names()]
    if not Path(source).suffix and source not in known:
        raise InputError(f"{source[:100]!r} is no kind of body, no shipped mannequin and no file{did_you_mean(source, known)}")
    if out.suffix not in (".yaml", ".obj", ".png"):
        raise InputError(f"cannot write {out.suffix or out.name!r}; allowed are .yaml, .obj, .png", key="--out")
    if out.suffix == ".yaml" and (source not in KINDS or pose is not None):
        raise InputError("a measurements file is written for woman or man with measurements, without a pose; write .obj", key="--out")
    if source in KINDS:
        spec = {"schema": 1, "units": "mm", "kind": source, "measurements": named_numbers(measurements, source)}
        spec |= {} if arm_angle is None else {"arm_angle": arm_angle}
        spec |= {"form": True} if form else {}
        spec |= {} if pad is None else {"shoulder_pads": _pads(pad)}
        body = mannequin_of(checked_spec(spec, source), out.stem)
    elif measurements or arm_angle is not None or form or pad is not None:
        raise InputError("measurements, --arm-angle, --form and --pad go with woman or man", key=source)
    else:
        body = read_mannequin(source)
    if pose is not None:
        body = replace(body, vertices=motion(body, read_poses(pose))[1][-1])
    if out.suffix == ".yaml":
        write_atomic(out, yaml.safe_dump(spec, sort_keys=False))
    elif out.suffix == ".obj":
        write_mannequin_obj(out, body)
    else:
        render_body(out, body, "three-quarter")
    print(out)


def _pads(text: str) -> dict[str, float]:
    values = [_number(value, "--pad") for value in text.split(",")]
    if len(values) > 4:
        raise InputError(f"{len(values)} values; at most 4 are allowed", key="--pad")
    return dict(zip(("thickness", "length", "width", "overhang"), values))


def _number(text: str, key: str) -> float:
    try:
        return float(text)
    except ValueError:
        raise InputError(f"{text!r} is not a number of mm", key=key) from None
