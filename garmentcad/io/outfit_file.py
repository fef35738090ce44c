"""Outfit files: which garments are worn over each other."""

from __future__ import annotations

from pathlib import Path

from garmentcad.errors import FileError, did_you_mean
from garmentcad.io.shipped import resolve_reference, shipped_file, shipped_names
from garmentcad.io.spec_file import SPEC_ENDINGS, read_spec, spec_path
from garmentcad.io.yaml_file import read_yaml
from garmentcad.pattern.outfit import OutfitSpec
from garmentcad.pattern.parse import parse_model
from garmentcad.pattern.spec import GarmentSpec


def read_worn(name_or_file: str | Path) -> GarmentSpec | tuple[OutfitSpec, tuple[GarmentSpec, ...]]:
    """A garment; or, for a file with the key `garments`, an outfit and its garments, inner to outer: a shipped name or a file. FileError or SpecError for what
    is refused."""
    path = _shipped_outfit(name_or_file) or spec_path(name_or_file)
    data = None if str(path).endswith(".json") else read_yaml(path)
    if not isinstance(data, dict) or "garments" not in data:
        return read_spec(path)
    outfit = parse_model(OutfitSpec, data, str(path))
    outfit._file = str(path)
    return outfit, tuple(_worn(worn.garment, path, f"garments.{k}.garment") for k, worn in enumerate(outfit.garments))


def _shipped_outfit(name_or_file: str | Path) -> Path | None:
    """File of the shipped outfit of that name; None where a file is meant or a garment has the name. FileError where neither has it."""
    if not isinstance(name_or_file, str) or name_or_file.endswith(SPEC_ENDINGS):
        return None
    garments, outfits = shipped_names("patterns"), shipped_names("outfits")
    if name_or_file in outfits:
        return shipped_file("outfits", name_or_file)
    if name_or_file not in garments and Path(name_or_file).exists():
        kind = "a folder" if Path(name_or_file).is_dir() else "a file"
        raise FileError(f"is {kind}; the file of a spec ends in {', '.join(SPEC_ENDINGS)}", file=name_or_file)
    if name_or_file not in garments:
        raise FileError(f"no shipped garment or outfit is called {name_or_file[:100]!r}{did_you_mean(name_or_file, garments + outfits)}")
    return None


def _worn(garment: str, outfit: Path, key: str) -> GarmentSpec:
    """A garment of an outfit; faults of its own name its own file, one that is not there names the outfit's."""
    try:
        file = resolve_reference(garment, "patterns", outfit.parent) if garment.endswith(SPEC_ENDINGS) else spec_path(garment)
    except FileError as fault:
        raise FileError(fault.message, file=str(outfit), key=key) from None
    return read_spec(file)
