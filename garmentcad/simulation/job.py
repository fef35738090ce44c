"""A job: everything that decides the outcome of one drape, read and checked, with the hashes that identify it."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import astuple, dataclass, field
from numbers import Integral
from pathlib import Path
from typing import get_args

import numpy as np

from garmentcad import __version__
from garmentcad.analysis.run_record import Mode
from garmentcad.cloth.lattice import check_grid
from garmentcad.cloth.panel_mesh import PARTICLE_CAP
from garmentcad.contact.path import BodyPath
from garmentcad.errors import FileError, InputError
from garmentcad.fabric.missing import Completed
from garmentcad.fabric.sheet import KesSheet, drape_sha256
from garmentcad.io.arguments import as_number, as_values, refuse_no_garment, refuse_unnamed
from garmentcad.io.fabric_file import load_fabric
from garmentcad.io.mannequin_file import read_mannequin
from garmentcad.io.outfit_file import read_worn
from garmentcad.io.pose_file import read_poses
from garmentcad.io.shipped import Kind, resolve_reference
from garmentcad.io.spec_file import spec_folder
from garmentcad.mannequin.mannequin import Mannequin, refuse_no_body
from garmentcad.mannequin.motion import KeyFrame, motion
from garmentcad.pattern.draft import draft
from garmentcad.pattern.outfit import OutfitSpec, put_on
from garmentcad.pattern.parse import checked, shown
from garmentcad.pattern.pattern import Pattern, fabric_apart, named_fabrics, with_fabrics
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
    max_time_s: float = 20.0
    folder: Path = field(default_factory=Path)  # of the spec, for references
    worn: tuple[GarmentSpec, ...] = ()
    poses: tuple[KeyFrame, ...] = ()  # that the body goes through once the garment hangs at rest
    max_particles: int = PARTICLE_CAP  # a larger drape is refused

    @property
    def spec_sha256(self) -> str:
        """Hash of the spec as plain data (comments and layout of the file do not count, nor do its tests: they change no drape)."""
        specs = [self.spec, *self.worn]
        data = [(spec.model_copy(update={"tests": {}}) if isinstance(spec, GarmentSpec) else spec).model_dump(mode="json") for spec in specs]
        return hashlib.sha256(json.dumps(data if self.worn else data[0], sort_keys=True).encode()).hexdigest()

    @property
    def identity(self) -> dict[str, str]:
        """What a checkpoint must agree with."""
        body = hashlib.sha256(self.mannequin.vertices.tobytes() + self.mannequin.faces.tobytes())
        for points in (self.mannequin.landmarks, {name: np.hstack(astuple(cylinder)) for name, cylinder in self.mannequin.cylinders.items()}):
            for name, place in sorted(points.items()):
                body.update(name.encode() + place.tobytes())
        body.update(json.dumps(self.mannequin.measurements_mm, sort_keys=True).encode())  # the pattern is drafted by them
        # by their own names: a spec knows a fabric that stands in place of its own by the name of that one
        sheets = ", ".join(f"{completed.sheet.name} {drape_sha256(completed.sheet)}" for _, completed in sorted(self.fabrics.items()))
        return {
            "spec": self.spec_sha256, "fabric": sheets, "mannequin": body.hexdigest(), "grid_mm": f"{self.grid_mm:.12g}", "seed": str(self.seed),
            "mode": self.mode, "version": __version__,
        }  # fmt: skip


def make_job(
    spec: str | Path | GarmentSpec,
    fabric: str | Path | KesSheet | None = None,
    mannequin: str | Path | Mannequin | None = None,
    *,
    grid_mm: float = 10.0,
    seed: int = 0,
    mode: Mode = "drape",
    max_time_s: float = 20.0,
    max_particles: int = PARTICLE_CAP,
    pose: str | Path | None = None,
    values: Mapping[str, float] | None = None,
) -> Job:
    """Read everything that a drape needs. spec: a shipped name, a file, or a model; fabric, mannequin: a shipped name, a file, or a sheet or body, in place of
    the spec's own; grid_mm: spacing of the lattice (2 to 50); seed: of the 0.01 mm jitter of the start; mode: 'drape' for the shape at rest, 'dynamics' for
    motion with true masses; max_time_s: most simulated seconds (up to 600); max_particles: more are
    refused, by an estimate before anything is allocated; pose: key frames, a shipped name or a file; values: of parameters, in place of
    the spec's. InputError for anything that is refused."""
    grid_mm, max_time_s = as_number(grid_mm, "grid_mm", "a number of mm"), as_number(max_time_s, "max_time_s", "a number of simulated seconds")
    check_grid(grid_mm)
    if not 0.0 < max_time_s <= 600.0:
        raise InputError(f"{max_time_s:g} simulated seconds; more than 0 and at most 600 are allowed", key="max_time_s")
    if isinstance(seed, bool) or not isinstance(seed, Integral) or not 0 <= seed < 1 << 63:
        raise InputError(f"seed {shown(seed)}; a whole number from 0 to 2^63 - 1 is allowed", key="seed")
    if isinstance(max_particles, bool) or not isinstance(max_particles, Integral) or max_particles < 1:
        raise InputError(f"{shown(max_particles)} particles; a positive whole number is allowed", key="max_particles")
    if mode not in get_args(Mode):
        raise InputError(f"mode {shown(mode)}; {' or '.join(get_args(Mode))} is allowed", key="mode")
    for key, named, made in (("fabric", fabric, KesSheet), ("mannequin", mannequin, Mannequin), ("pose", pose, None)):
        if named is not None:
            refuse_unnamed(named, key, made)
    refuse_no_garment(spec)
    values = as_values(values)
    model = checked(spec) if isinstance(spec, GarmentSpec) else read_worn(spec)
    if isinstance(model, GarmentSpec):
        model, folder = with_values(model, values), spec_folder(model)
        body = _body(model, mannequin)
        pattern = draft(model, body.measurements_mm)
        if fabric is not None:
            pattern = fabric_apart(pattern)
        fabrics = {name: load_fabric(_referred(model, name, "fabrics", key)) for name, key in sorted(named_fabrics(pattern).items())}
        fabrics[pattern.fabric] = load_fabric(fabric if fabric is not None else _referred(model, pattern.fabric, "fabrics", "fabric"))
        outfit: GarmentSpec | OutfitSpec = model
        worn: tuple[GarmentSpec, ...] = ()
    else:
        if fabric is not None:
            raise InputError("an outfit has a fabric for each garment; name them in its file", key="fabric")
        if values:
            raise InputError("an outfit has values of parameters for each garment; name them in its file", key="values")
        (outfit, worn), folder = model, spec_folder(model[0])
        body = _body(outfit, mannequin)
        pattern, fabrics = _dressed(outfit, worn, body.measurements_mm)
    poses = () if pose is None else tuple(read_poses(pose))
    if poses:
        _refuse_motion(body, poses)
    return Job(outfit, pattern, fabrics, body, float(grid_mm), seed, mode, max_time_s, folder, worn, poses, max_particles)


def _refuse_motion(body: Mannequin, poses: tuple[KeyFrame, ...]) -> None:
    """What the body cannot do, or not as fast, is refused before anything is draped."""
    times, vertices = motion(body, poses)
    try:
        BodyPath(times, vertices)
    except InputError as error:
        raise InputError(error.message, key="pose") from None


def _body(spec: GarmentSpec | OutfitSpec, given: str | Path | Mannequin | None) -> Mannequin:
    """The body of a job: the one given, or that of the spec."""
    if isinstance(given, Mannequin):
        refuse_no_body(given)
        return given
    return read_mannequin(given if given is not None else _referred(spec, spec.mannequin, "mannequins", "mannequin"))


def _referred(spec: GarmentSpec | OutfitSpec, text: str, kind: Kind, key: str) -> Path:
    """The file that a spec names under `key`. FileError (with the spec's file and that key) as `resolve_reference`."""
    try:
        return resolve_reference(text, kind, spec_folder(spec))
    except FileError as fault:
        raise FileError(fault.message, file=spec.file, key=key) from None


def _dressed(outfit: OutfitSpec, worn: tuple[GarmentSpec, ...], measurements_mm: dict[str, float]) -> tuple[Pattern, dict[str, Completed]]:
    """The pattern of an outfit, and its sheets: a file that a garment names is sought in that garment's folder."""
    patterns: list[Pattern] = []
    fabrics: dict[str, Completed] = {}
    for k, (garment, entry) in enumerate(zip(worn, outfit.garments, strict=True)):
        try:
            given = with_values(garment, entry.values)
        except InputError as fault:
            raise type(fault)(fault.message, file=outfit.file, key=f"garments.{k}.values") from None
        pattern = draft(given, measurements_mm)
        if entry.fabric is not None:
            pattern = fabric_apart(pattern)
        places = {name: _referred(garment, name, "fabrics", key) for name, key in named_fabrics(pattern).items()}
        if entry.fabric is not None:
            places[pattern.fabric] = _referred(outfit, entry.fabric, "fabrics", f"garments.{k}.fabric")
        else:
            places[pattern.fabric] = _referred(garment, pattern.fabric, "fabrics", "fabric")
        fabrics |= {str(place): load_fabric(place) for place in places.values()}
        patterns.append(with_fabrics(pattern, {name: str(place) for name, place in places.items()}))
    return put_on(outfit.name, patterns, outfit.mannequin), fabrics
