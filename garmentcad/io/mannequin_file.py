"""Mannequins by name or file: YAML files of measurements (the shipped ones too) and body scans."""

from __future__ import annotations

import functools
import zipfile
from dataclasses import fields, replace
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import AfterValidator, Field
from pydantic_core import PydanticCustomError

from garmentcad.arrays import FrozenDict, frozen
from garmentcad.errors import FileError, MannequinError, did_you_mean
from garmentcad.io.arguments import refuse_unnamed
from garmentcad.io.garmentcode_body import is_garmentcode_body, mannequin_of_body
from garmentcad.io.mesh_file import MESH_ENDINGS, read_mesh
from garmentcad.io.shipped import resolve_reference, shipped_file, shipped_folder, shipped_names
from garmentcad.io.yaml_file import read_yaml
from garmentcad.mannequin.human import KINDS, HumanModel
from garmentcad.mannequin.make import make_mannequin
from garmentcad.mannequin.mannequin import Mannequin
from garmentcad.mannequin.pads import ShoulderPads
from garmentcad.mannequin.pose import ARM_ANGLE_DEG
from garmentcad.mannequin.scan import mannequin_of_scan
from garmentcad.pattern.model import Model
from garmentcad.pattern.parse import parse_model
from garmentcad.schema_version import SchemaVersion, as_written

BodyLine = Literal["knee", "crotch", "hip", "waist", "bust", "armpit", "shoulder", "neck_front", "nape"]


def _scan_name(name: str) -> str:
    if set(name) & set("/\\") or not name.lower().endswith(MESH_ENDINGS):
        raise PydanticCustomError("scan", "{said}", {"said": f"a file beside this one is wanted, with the ending {', '.join(MESH_ENDINGS)}"})
    return name


class ScanSpec(Model):
    """A body scan with what is known of it. unit: of its numbers; heights: of body lines above the floor, mm, in place of those by proportion."""

    schema_version: SchemaVersion = Field(default=1, alias="schema")
    units: Literal["mm"] = "mm"
    scan: Annotated[str, AfterValidator(_scan_name)]
    description: str = ""
    unit: Literal["m", "dm", "cm", "inch", "mm"] | None = None
    heights: dict[BodyLine, Annotated[float, Field(strict=True)]] = Field(default_factory=dict)


_KEYS = {"schema", "units", "kind", "description", "source", "measurements", "arm_angle", "shoulder_pads", "form"}


def mannequin_names() -> list[str]:
    """Names of the shipped mannequins, by kind and size."""

    def place(name: str) -> tuple[str, int, str]:
        kind, _, size = name.partition("-")
        return kind, int(size) if size.isdigit() else 0, size

    return sorted(shipped_names("mannequins"), key=place)


def read_mannequin(name_or_path: str | Path) -> Mannequin:
    """A mannequin from a shipped name (woman-88), a YAML file of measurements (this program's or GarmentCode's), or an OBJ, PLY, STL or GLB scan.

    Shipped bodies are made once in a process (0.8 s each) and are read-only; any other file is read anew each time: it may have changed.
    FileError, MannequinError or MeshError (with file and key) when it is refused.
    """
    refuse_unnamed(name_or_path, "mannequin")
    text = str(name_or_path)
    suffix = Path(text).suffix.lower()
    if suffix in MESH_ENDINGS:
        return _scanned(parse_model(ScanSpec, {"scan": Path(text).name}, text), text)
    if suffix not in (".yaml", ".yml", "") or (suffix == "" and "/" in text):
        raise FileError(f"the ending {suffix!r} is not that of a mannequin; allowed: .yaml, {', '.join(MESH_ENDINGS)}", file=text)
    path = Path(text) if suffix else shipped_file("mannequins", text)
    return _shipped(path) if path.parent == shipped_folder("mannequins") else _read(path, text)


@functools.lru_cache(maxsize=8)
def _shipped(path: Path) -> Mannequin:
    """A body for many askers, read-only: they could else change it for each other. It stays one object, by which others keep what they find out about it."""
    body = _read(path, str(path))
    axes = [axis for cylinder in body.cylinders.values() for axis in (cylinder.origin, cylinder.up, cylinder.ref)]
    for array in (*body.landmarks.values(), *axes, *([] if body.rig is None else body.rig.joints.values())):
        frozen(array)
    return replace(body, measurements_mm=FrozenDict(body.measurements_mm), landmarks=FrozenDict(body.landmarks), cylinders=FrozenDict(body.cylinders))


def _read(path: Path, text: str) -> Mannequin:
    """The body in a YAML file; text: the file as the user wrote it."""
    data = read_yaml(path)
    if isinstance(data, dict) and "scan" in data:
        return _scanned(parse_model(ScanSpec, data, text), text)
    try:
        return mannequin_of(checked_spec(mannequin_of_body(data) if is_garmentcode_body(data) else data, text), path.stem)
    except MannequinError as fault:
        raise MannequinError(fault.message, file=text, key=fault.key) from None


def _scanned(spec: ScanSpec, file: str) -> Mannequin:
    try:
        vertices, faces, notes = read_mesh(resolve_reference(spec.scan, "mannequins", Path(file).parent), spec.unit)
        return mannequin_of_scan(vertices, faces, name=Path(file).stem, heights_mm=spec.heights, notes=notes)
    except MannequinError as fault:
        raise MannequinError(fault.message, file=file, key=fault.key) from None


def mannequin_of(spec: dict[str, Any], name: str) -> Mannequin:
    """The mannequin of a checked spec. MannequinError (with key) for measurements that are refused."""
    return make_mannequin(
        read_human(spec["kind"]),
        spec["measurements"],
        name=name,
        arm_angle_deg=spec.get("arm_angle", ARM_ANGLE_DEG),
        pads=None if spec.get("shoulder_pads") is None else ShoulderPads(**spec["shoulder_pads"]),
        form=spec.get("form", False),
    )


def checked_spec(data: Any, file: str) -> dict[str, Any]:
    """The content of a mannequin file. MannequinError (file, key) for what is refused before a body is made."""
    if not isinstance(data, dict):
        raise MannequinError(f"a mapping is wanted, with {', '.join(sorted(_KEYS))}; this is a {type(data).__name__}", file=file)
    for key in data:
        if key not in _KEYS:
            raise MannequinError(f"{key!r} is not a key of a mannequin file{did_you_mean(str(key), _KEYS)}", file=file)
    for key, wanted in (("schema", 1), ("units", "mm")):
        if as_written(data.get(key)) != wanted:
            raise MannequinError(f"{data.get(key)!r} is refused; allowed: {wanted}", file=file, key=key)
    if not isinstance(data.get("kind"), str) or data["kind"] not in KINDS:
        raise MannequinError(f"{data.get('kind')!r} is not a kind of body; allowed: {', '.join(KINDS)}", file=file, key="kind")
    if not isinstance(data.get("measurements"), dict):
        raise MannequinError("a mapping of measurement names to mm is wanted", file=file, key="measurements")
    angle = data.get("arm_angle", ARM_ANGLE_DEG)
    if isinstance(angle, bool) or not isinstance(angle, int | float):
        raise MannequinError(f"{angle!r} is not a number of degrees", file=file, key="arm_angle")
    if not isinstance(data.get("form", False), bool):
        raise MannequinError(f"{data['form']!r} is refused; allowed: true, false", file=file, key="form")
    pads, names = data.get("shoulder_pads"), {field.name for field in fields(ShoulderPads)}
    if pads is not None and (not isinstance(pads, dict) or "thickness" not in pads or not set(pads) <= names):
        raise MannequinError(
            f"a mapping with thickness and, if wanted, {', '.join(sorted(names - {'thickness'}))} in mm is wanted", file=file, key="shoulder_pads"
        )
    return data


@functools.lru_cache(maxsize=2)
def read_human(kind: str) -> HumanModel:
    """The shipped bodies of a kind (woman or man) from human.npz. FileError when the file is damaged."""
    path = shipped_file("mannequins", "human.npz")
    gender = KINDS[kind]
    try:
        with np.load(path, allow_pickle=False) as data:
            arrays = {name: data[name] for name in data.files}
        names = [str(name) for name in arrays["target_names"]]
        mine = [k for k, name in enumerate(names) if name.count("-") != 2 or name.startswith(gender + "-")]
        rings = [str(name) for name in arrays["joint_names"]]
        keep = [k for k, name in enumerate(rings) if "_" not in name or name.endswith("_" + gender)]
        suffix = "_" + gender
        marks = {str(name): int(vertex) for name, vertex in zip(arrays["landmark_names"], arrays["landmark_vertices"])}
        others = tuple("_" + other for other in KINDS.values() if other != gender)
        return HumanModel(
            kind=kind,
            base=frozen(arrays["base"]),
            faces=frozen(arrays["faces"]),
            border=int(arrays["border"]),
            target_names=tuple(names[k] for k in mine),
            targets=frozen(arrays["targets"][mine] * arrays["target_scale"][mine, None, None]),
            joint_names=tuple(rings[k].replace(suffix, "_level") for k in keep),
            joints=frozen(arrays["joints"][keep]),
            joint_targets=frozen(arrays["joint_targets"][np.ix_(mine, keep)]),
            arm_weight=frozen(arrays["arm_weight"].astype(np.float64)),
            leg_weight=frozen(arrays["leg_weight"].astype(np.float64)),
            landmarks={name.removesuffix(suffix): vertex for name, vertex in marks.items() if not name.endswith(others)},
            part_names=tuple(str(name) for name in arrays["part_names"]),
            face_part=frozen(arrays["face_part"]),
        )
    except (OSError, ValueError, KeyError, IndexError, zipfile.BadZipFile) as fault:
        raise FileError(f"the shipped body file is damaged: {fault}; build it anew with tools/build_human.py", file=str(path)) from None
