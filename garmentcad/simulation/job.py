"""A job: everything that decides the outcome of one drape, read and checked, with the hashes that identify it."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import get_args

from garmentcad import __version__
from garmentcad.analysis.run_record import Mode
from garmentcad.cloth.lattice import check_grid
from garmentcad.errors import InputError
from garmentcad.fabric.missing import Completed
from garmentcad.fabric.sheet import sheet_sha256
from garmentcad.io.fabric_file import fabric_path, load_fabric
from garmentcad.io.mannequin_file import read_mannequin
from garmentcad.io.outfit_file import read_worn
from garmentcad.io.pose_file import read_poses
from garmentcad.io.shipped import resolve_reference
from garmentcad.io.spec_file import spec_folder
from garmentcad.mannequin.mannequin import Mannequin
from garmentcad.mannequin.motion import KeyFrame, motion
from garmentcad.pattern.draft import draft
from garmentcad.pattern.outfit import OutfitSpec, put_on
from garmentcad.pattern.parse import shown
from garmentcad.pattern.pattern import Pattern, named_fabrics, with_fabrics
from garmentcad.pattern.scope import with_values
from garmentcad.pattern.spec import GarmentSpec


@dataclass(frozen=True)
class Job:
    """One drape to do. fabrics: completed sheets by the name under which pattern and regions refer to them; the pattern's own default is among them.
    spec: of the garment, or of an outfit, whose garments are `worn`, inner to outer."""

    spec: GarmentSpec | OutfitSpec
    pattern: Pattern
    fabrics: dict[str, Completed]
    mannequin: Mannequin
    grid_mm: float = 10.0
    seed: int = 0
    mode: Mode = "drape"
    max_time_s: float = 12.0
    folder: Path = field(default_factory=Path)  # of the spec, for references
    worn: tuple[GarmentSpec, ...] = ()
    poses: tuple[KeyFrame, ...] = ()  # that the body goes through once the garment hangs at rest

    @property
    def spec_sha256(self) -> str:
        """Hash of the spec as plain data (comments and layout of the file do not count, nor do its tests: they change no drape)."""
        specs = [self.spec, *self.worn]
        data = [(spec.model_copy(update={"tests": {}}) if isinstance(spec, GarmentSpec) else spec).model_dump(mode="json") for spec in specs]
        return hashlib.sha256(json.dumps(data if self.worn else data[0], sort_keys=True).encode()).hexdigest()

    @property
    def identity(self) -> dict[str, str]:
        """What a checkpoint must agree with."""
        body = hashlib.sha256(self.mannequin.vertices.tobytes() + self.mannequin.faces.tobytes()).hexdigest()
        sheets = {name: sheet_sha256(completed.sheet) for name, completed in sorted(self.fabrics.items())}
        return {
            "spec": self.spec_sha256, "fabric": json.dumps(sheets), "mannequin": body, "grid_mm": f"{self.grid_mm:g}", "seed": str(self.seed),
            "mode": self.mode, "version": __version__,
        }  # fmt: skip


def make_job(
    spec: str | Path | GarmentSpec,
    fabric: str | None = None,
    mannequin: str | None = None,
    *,
    grid_mm: float = 10.0,
    seed: int = 0,
    mode: Mode = "drape",
    max_time_s: float = 12.0,
    pose: str | None = None,
    values: Mapping[str, float] | None = None,
) -> Job:
    """Read everything that a drape needs. spec: a shipped name, a file, or a model; fabric, mannequin: a shipped name or a file, in place of the spec's own;
    pose: key frames, a shipped name or a file; values: of parameters, in place of the spec's. InputError for anything that is refused."""
    check_grid(grid_mm)
    if not 0.0 < max_time_s <= 600.0:
        raise InputError(f"{max_time_s:g} simulated seconds; more than 0 and at most 600 are allowed", key="--max-time")
    if seed < 0:
        raise InputError(f"seed {seed}; 0 or a positive number is allowed", key="--seed")
    if mode not in get_args(Mode):
        raise InputError(f"mode {shown(mode)}; {' or '.join(get_args(Mode))} is allowed", key="--mode")
    model = spec if isinstance(spec, GarmentSpec) else read_worn(spec)
    if isinstance(model, GarmentSpec):
        model, folder = with_values(model, values or {}), spec_folder(model)
        body = read_mannequin(mannequin if mannequin is not None else resolve_reference(model.mannequin, "mannequins", folder))
        pattern = draft(model, body.measurements_mm)
        fabrics = {name: load_fabric(resolve_reference(name, "fabrics", folder)) for name in sorted(named_fabrics(pattern))}
        own = fabric_path(fabric) if fabric is not None else resolve_reference(pattern.fabric, "fabrics", folder)
        fabrics[pattern.fabric] = load_fabric(own)
        outfit: GarmentSpec | OutfitSpec = model
        worn: tuple[GarmentSpec, ...] = ()
    else:
        if fabric is not None:
            raise InputError("an outfit has a fabric for each garment; name them in its file", key="--fabric")
        if values:
            raise InputError("an outfit has values of parameters for each garment; name them in its file", key="--set")
        (outfit, worn), folder = model, spec_folder(model[0])
        body = read_mannequin(mannequin if mannequin is not None else resolve_reference(outfit.mannequin, "mannequins", folder))
        pattern, fabrics = _dressed(outfit, worn, body.measurements_mm, folder)
    poses = () if pose is None else tuple(read_poses(pose))
    if poses:
        motion(body, poses)  # refuses what the body cannot do, before anything is draped
    return Job(outfit, pattern, fabrics, body, float(grid_mm), seed, mode, max_time_s, folder, worn, poses)


def _dressed(outfit: OutfitSpec, worn: tuple[GarmentSpec, ...], measurements_mm: dict[str, float], folder: Path) -> tuple[Pattern, dict[str, Completed]]:
    """The pattern of an outfit, and its sheets: a file that a garment names is sought in that garment's folder."""
    patterns: list[Pattern] = []
    fabrics: dict[str, Completed] = {}
    for garment, entry in zip(worn, outfit.garments, strict=True):
        pattern = draft(garment, measurements_mm, entry.values)
        places = {name: resolve_reference(name, "fabrics", spec_folder(garment)) for name in (*named_fabrics(pattern), pattern.fabric)}
        if entry.fabric is not None:
            places[pattern.fabric] = resolve_reference(entry.fabric, "fabrics", folder)
        fabrics |= {str(place): load_fabric(place) for place in places.values()}
        patterns.append(with_fabrics(pattern, {name: str(place) for name, place in places.items()}))
    return put_on(outfit.name, patterns, outfit.mannequin), fabrics
