"""Outfit files: which garments are worn over each other."""

from __future__ import annotations

from pathlib import Path

from garmentcad.io.shipped import resolve_reference
from garmentcad.io.spec_file import SPEC_ENDINGS, read_spec, spec_path
from garmentcad.io.yaml_file import read_yaml
from garmentcad.pattern.outfit import OutfitSpec
from garmentcad.pattern.parse import parse_model
from garmentcad.pattern.spec import GarmentSpec


def read_worn(name_or_file: str | Path) -> GarmentSpec | tuple[OutfitSpec, tuple[GarmentSpec, ...]]:
    """A garment; or, for a file with the key `garments`, an outfit and its garments, inner to outer. FileError or SpecError for what is refused."""
    path = spec_path(name_or_file)
    data = None if str(path).endswith(".json") else read_yaml(path)
    if not isinstance(data, dict) or "garments" not in data:
        return read_spec(path)
    outfit = parse_model(OutfitSpec, data, str(path))
    outfit._file = str(path)
    return outfit, tuple(read_spec(_worn_file(worn.garment, path.parent)) for worn in outfit.garments)


def _worn_file(garment: str, folder: Path) -> Path:
    named = garment.endswith(SPEC_ENDINGS)
    return resolve_reference(garment, "patterns", folder) if named else spec_path(garment)
