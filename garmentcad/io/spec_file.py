"""Garment specs as YAML files, and as files of other programs that become specs when they are read."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import yaml

from garmentcad.errors import InputError, SpecError
from garmentcad.io.arguments import refuse_unnamed
from garmentcad.io.atomic import write_atomic
from garmentcad.io.garmentcode_import import import_garmentcode
from garmentcad.io.shipped import shipped_file
from garmentcad.io.yaml_file import ENDINGS, plain_scalar, read_yaml, refuse_no_yaml
from garmentcad.pattern.outfit import OutfitSpec
from garmentcad.pattern.parse import checked, parse_spec, shown
from garmentcad.pattern.spec import GarmentSpec

SPEC_ENDINGS = (*ENDINGS, ".json")


def spec_path(name_or_file: str | Path) -> Path:
    """File of a spec: a shipped name (`flared-skirt`), or a path that ends in .yaml, .yml or .json. InputError for what is neither."""
    refuse_unnamed(name_or_file, "spec")
    return shipped_file("patterns", name_or_file) if isinstance(name_or_file, str) and not name_or_file.endswith(SPEC_ENDINGS) else Path(name_or_file)


def spec_folder(spec: GarmentSpec | OutfitSpec) -> Path:
    """Folder of the file that a spec was read from, for what it refers to; the working folder where there is none."""
    return Path() if spec.file is None else Path(spec.file).parent


def read_spec(name_or_file: str | Path) -> GarmentSpec:
    """A shipped garment, or the garment spec in a YAML file or of a GarmentCode file (.json).

    FileError for an unknown name and a file that is not plain YAML (or JSON), SpecError (file, key path, what came, what is allowed) for its content,
    InputError for what is neither a name nor a file.
    """
    path = spec_path(name_or_file)
    file = str(path)
    if file.endswith(".json"):
        return import_garmentcode(path).spec
    data = read_yaml(path)
    if not isinstance(data, dict):
        raise SpecError(f"a garment spec is a mapping, came {shown(data)}", file=file)
    for key, wanted in (("schema", 1), ("units", "mm")):
        if key not in data:  # a Python script may leave them out, a file says what it is
            raise SpecError(f"this key is missing; the first lines of a spec are `schema: 1` and `units: mm` (wanted here: {wanted})", file=file, key=key)
    return parse_spec(data, file)


def write_spec(spec: GarmentSpec, path: str | Path) -> Path:
    """Write a spec as YAML that `read_spec` reads back to an equal one. Values that are defaults are left out. FileError where it cannot be written, InputError
    for what is no GarmentSpec, no file, or a file that ends in neither .yaml nor .yml."""
    if not isinstance(spec, GarmentSpec):
        raise InputError(f"a GarmentSpec is wanted, came {shown(spec)}", key="spec")
    refuse_unnamed(path, "path")
    refuse_no_yaml(path)
    spec = checked(spec)
    data = {"schema": spec.schema_version, "units": spec.units, **spec.model_dump(mode="json", by_alias=True, exclude_defaults=True)}
    return write_atomic(path, yaml.dump(data, Dumper=_Dumper, sort_keys=False, allow_unicode=True, width=140))


class _Dumper(yaml.SafeDumper):
    """Plain YAML whose texts come back as texts: quoted wherever our own reader would see something else."""

    def ignore_aliases(self, data: Any) -> bool:
        return True


def _stays_text(value: str) -> bool:
    try:
        return isinstance(plain_scalar(value), str)
    except ValueError:
        return False


def _text(dumper: yaml.SafeDumper, value: str) -> yaml.ScalarNode:
    # Quoted where our reader would see something else, or would turn a rare line break into a plain one.
    plain = _stays_text(value) and not set(value) & set("\r\x85\u2028\u2029")
    style = None if plain else '"'
    return dumper.represent_scalar("tag:yaml.org,2002:str", value, style=style)


def _list(dumper: yaml.SafeDumper, value: list[Any]) -> yaml.SequenceNode:
    scalars = not any(isinstance(item, (list, dict)) for item in value)
    return dumper.represent_sequence("tag:yaml.org,2002:seq", value, flow_style=scalars)


_Dumper.add_representer(str, _text)
_Dumper.add_representer(list, _list)
