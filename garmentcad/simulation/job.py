"""A job: everything that decides the outcome of one drape, read and checked, with the hashes that identify it."""

from __future__ import annotations

import hashlib
import json
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal

from garmentcad import __version__
from garmentcad.errors import InputError
from garmentcad.fabric.missing import Completed
from garmentcad.fabric.sheet import sheet_sha256
from garmentcad.io.fabric_file import fabric_path, load_fabric
from garmentcad.io.mannequin_file import read_mannequin
from garmentcad.io.pose_file import read_poses
from garmentcad.io.shipped import resolve_reference
from garmentcad.io.spec_file import read_spec, spec_folder, spec_path
from garmentcad.mannequin.mannequin import Mannequin
from garmentcad.mannequin.motion import KeyFrame, motion
from garmentcad.pattern.draft import draft
from garmentcad.pattern.pattern import Pattern, named_fabrics
from garmentcad.pattern.spec import GarmentSpec

Mode = Literal["drape", "dynamics"]
GRID_MM = (2.0, 50.0)


@dataclass(frozen=True)
class Job:
    """One drape to do. fabrics: completed sheets by the name under which pattern and regions refer to them; the pattern's own default is among them."""

    spec: GarmentSpec
    pattern: Pattern
    fabrics: dict[str, Completed]
    mannequin: Mannequin
    grid_mm: float = 10.0
    seed: int = 0
    mode: Mode = "drape"
    max_time_s: float = 12.0
    folder: Path = field(default_factory=Path)  # of the spec, for references
    poses: tuple[KeyFrame, ...] = ()  # that the body goes through once the garment hangs at rest

    @property
    def spec_sha256(self) -> str:
        """Hash of the spec as plain data (comments and layout of the file do not count, nor do its tests: they change no drape)."""
        garment = self.spec.model_copy(update={"tests": {}})
        return hashlib.sha256(json.dumps(garment.model_dump(mode="json"), sort_keys=True).encode()).hexdigest()

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
) -> Job:
    """Read everything that a drape needs. spec: a shipped name, a file, or a model; fabric, mannequin: a shipped name or a file, in place of the spec's own;
    pose: key frames, a shipped name or a file. InputError for anything that is refused."""
    if not GRID_MM[0] <= grid_mm <= GRID_MM[1]:
        raise InputError(f"grid of {grid_mm:g} mm; {GRID_MM[0]:g} to {GRID_MM[1]:g} mm is allowed", key="--grid")
    if not 0.0 < max_time_s <= 600.0:
        raise InputError(f"{max_time_s:g} simulated seconds; more than 0 and at most 600 are allowed", key="--max-time")
    if seed < 0:
        raise InputError(f"seed {seed}; 0 or a positive number is allowed", key="--seed")
    model = spec if isinstance(spec, GarmentSpec) else read_spec(spec_path(spec))
    folder = spec_folder(model)
    body = read_mannequin(mannequin if mannequin is not None else resolve_reference(model.mannequin, "mannequins", folder))
    poses = () if pose is None else tuple(read_poses(pose))
    if poses:
        motion(body, poses)  # refuses what the body cannot do, before anything is draped
    pattern = draft(model, body.measurements_mm)
    fabrics = {name: load_fabric(resolve_reference(name, "fabrics", folder)) for name in sorted(named_fabrics(pattern))}
    fabrics[pattern.fabric] = load_fabric(fabric_path(fabric)) if fabric is not None else load_fabric(resolve_reference(pattern.fabric, "fabrics", folder))
    return Job(model, pattern, fabrics, body, float(grid_mm), seed, mode, max_time_s, folder, poses)
