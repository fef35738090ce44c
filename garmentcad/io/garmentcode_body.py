"""Measurements of a body as GarmentCode's `body_measurements.yaml` has them (cm and degrees under the key `body`), in this program's names and mm."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import yaml

from garmentcad.errors import MannequinError, did_you_mean
from garmentcad.io.atomic import write_atomic
from garmentcad.io.yaml_file import read_yaml
from garmentcad.mannequin.mannequin import SHOULDER_RISE
from garmentcad.mannequin.sizes import full_sizes

FILE_ENDING = "body_measurements.yaml"
_CM_TO_MM = 10.0
_USED = ("bust", "waist", "hips", "height", "head_l", "waist_line", "hips_line", "crotch_hip_diff", "arm_length", "wrist", "leg_circ", "shoulder_w",
         "arm_pose_angle")  # fmt: skip
_UNUSED = ("armscye_depth", "back_width", "bum_points", "bust_line", "bust_points", "hip_back_width", "hip_inclination", "neck_w", "shoulder_incl", "underbust",
           "vert_bust_line", "waist_back_width", "waist_over_bust_line")  # fmt: skip


def is_garmentcode_body(data: Any) -> bool:
    """Whether the content of a YAML file looks like GarmentCode's body measurements."""
    return isinstance(data, dict) and isinstance(data.get("body"), dict)


def body_file_of(pattern: str | Path) -> Path | None:
    """The measurements beside a pattern file: NAME_body_measurements.yaml for NAME_specification.json, else body_measurements.yaml; None where neither is."""
    path = Path(pattern)
    own = path.with_name(path.stem.removesuffix("specification") + FILE_ENDING)
    return next((file for file in (own, path.with_name(FILE_ENDING)) if file.is_file()), None)


def write_body(body_file: Path, path: Path) -> Path:
    """Write GarmentCode's measurements as a mannequin file. MannequinError where they are refused, FileError where it cannot be written."""
    data = read_yaml(body_file)
    try:
        made = mannequin_of_body(data) if is_garmentcode_body(data) else data
    except MannequinError as fault:
        raise MannequinError(fault.message, file=str(body_file), key=fault.key) from None
    return write_atomic(path, yaml.safe_dump(made, sort_keys=False))


def mannequin_of_body(data: dict[str, Any]) -> dict[str, Any]:
    """Content of a mannequin file for the measurements. MannequinError (key path) for unknown names and values that are no numbers.

    What GarmentCode measures in its own way (widths of the back, bust line, inclinations) follows this program's rules. The file does not say whether the
    body is a woman's or a man's: a woman's where the hips are larger than the bust, an estimate.
    """
    for name in data:
        if name != "body":
            raise MannequinError(f"{name!r} is not a key of GarmentCode's measurements; allowed: body", key=str(name))
    body = data["body"]
    for name, value in body.items():
        if name not in (*_USED, *_UNUSED) and not name.startswith("_"):  # GarmentCode derives those with an underscore from the others
            raise MannequinError(f"{name!r} is not a measurement of GarmentCode{did_you_mean(name, (*_USED, *_UNUSED))}", key=f"body.{name}")
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise MannequinError(f"{value!r} is not a number", key=f"body.{name}")
    missing = [name for name in ("bust", "waist", "hips", "height", "head_l", "waist_line") if name not in body]
    if missing:
        raise MannequinError(f"measurements are missing: {', '.join(missing)}", key="body")
    kind = "woman" if body["hips"] >= body["bust"] else "man"
    sizes = {
        "bust": body["bust"], "waist": body["waist"], "hip": body["hips"], "stature": body["height"], "nape_to_waist": body["waist_line"],
        "waist_to_floor": body["height"] - body["head_l"] - body["waist_line"],  # head_l reaches from the nape up
    }  # fmt: skip
    for ours, theirs in (("waist_to_hip", "hips_line"), ("arm_length", "arm_length"), ("wrist", "wrist"), ("thigh", "leg_circ")):
        if theirs in body:
            sizes[ours] = body[theirs]
    if "hips_line" in body and "crotch_hip_diff" in body:
        sizes["body_rise"] = body["hips_line"] + body["crotch_hip_diff"]
    measurements = {name: round(_CM_TO_MM * value, 1) for name, value in sizes.items()}
    if "shoulder_w" in body:  # between the shoulder points: what is left of a half beside the neck, along its slope
        neck = full_sizes(kind, measurements)["neck_base"] / (2.0 * math.pi)
        measurements["shoulder"] = round((_CM_TO_MM * body["shoulder_w"] / 2.0 - neck) / SHOULDER_RISE, 1)
    made = {"schema": 1, "units": "mm", "kind": kind, "measurements": measurements}
    return made | ({"arm_angle": round(90.0 - body["arm_pose_angle"], 3)} if "arm_pose_angle" in body else {})
