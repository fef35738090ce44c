"""A result folder: what a drape leaves behind, enough to draw and export it again without its spec.

report.json, garment.obj, garment.glb, mannequin.obj, state.npz (the State), cloth.npz (the Cloth), maps.npz (one value a particle for the pictures) and,
with the extra `view`, front.png and back.png. report.json goes first when a folder is reused and is written last: a folder that has one is whole.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryFile
from typing import Any

import numpy as np

from garmentcad.cloth.cloth import Cloth
from garmentcad.cloth.state import State
from garmentcad.errors import FileError
from garmentcad.export.cloth_file import read_cloth, write_cloth
from garmentcad.export.glb import write_garment_glb
from garmentcad.export.obj import FARTHEST_M, read_mannequin_obj, write_garment_obj, write_mannequin_obj
from garmentcad.export.picture import ViewMissing, render_pictures
from garmentcad.export.report import NO_NUMBERS, SCHEMA, blank_report, write_report
from garmentcad.io.atomic import remove_unfinished, write_atomic
from garmentcad.io.json_file import read_json
from garmentcad.io.npz_file import read_npz
from garmentcad.mannequin.mannequin import Mannequin
from garmentcad.pattern.parse import shown
from garmentcad.simulation.checkpoint import load_state, save_state

PICTURES = ("front", "back")
CHECKPOINT = "checkpoint.npz"
_SOLID = ("garment.obj", "garment.glb", "mannequin.obj")
_ARRAYS = ("state.npz", "cloth.npz", "maps.npz", CHECKPOINT)
_MOVEMENT = ("movement/frames.npz", "movement/frames.png")
_NAMES = ("garment", "fabric", "mannequin", "status")  # that every report has
_MOST_MAPS = 64  # what a folder of another version may have


@dataclass(frozen=True)
class Result:
    """What a result folder holds. maps: name -> (P,) values (strain no unit, tension N/m, pressure kPa); mannequin is None for a swatch."""

    report: dict[str, Any]
    cloth: Cloth
    state: State
    maps: dict[str, np.ndarray]
    mannequin: Mannequin | None


@dataclass(frozen=True)
class WrittenFolder:
    """files: what was written, report.json last; notes: what was left out, and why."""

    folder: Path
    files: tuple[Path, ...]
    notes: tuple[str, ...]


def make_folder(folder: Path) -> None:
    """Make the folder of a result, where there is none, and see whether files can be made in it. FileError where that cannot be done."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with TemporaryFile(dir=folder):
            pass
    except OSError as error:
        raise _no_folder(folder, error) from error


def _no_folder(folder: Path, error: OSError) -> FileError:
    return FileError(f"cannot be the folder of a result: {error.strerror or error}", file=str(folder))


def clear_folder(folder: Path, movement: bool) -> None:
    """Make the folder, and take away what makes it that of an earlier drape: a run that is broken off leaves no old report beside its checkpoint. FileError
    where that cannot be done. movement: whether the frames of a movement go, too. What a writer that was killed left half written goes in any case."""
    make_folder(folder)
    drawn = ("report.json", *_SOLID, *(f"{view}.png" for view in PICTURES))
    try:
        for name in (*drawn, *(_MOVEMENT if movement else ())):
            (folder / name).unlink(missing_ok=True)
        for name in (*drawn, *_ARRAYS, *_MOVEMENT):
            remove_unfinished(folder / name)
    except OSError as error:
        raise _no_folder(folder, error) from error


def write_result_folder(folder: str | Path, result: Result, identity: Mapping[str, str]) -> WrittenFolder:
    """Write all files of a result. identity: as `save_state` takes it. Without the extra `view` the pictures are left out, and a note says so."""
    folder = Path(folder)
    positions = result.state.positions
    notes: list[str] = []
    clear_folder(folder, movement=False)
    files = [folder / "state.npz"]
    save_state(folder / "state.npz", result.state, dict(identity))
    files.append(write_cloth(folder / "cloth.npz", result.cloth))
    files.append(write_atomic(folder / "maps.npz", lambda file: np.savez_compressed(file, **result.maps)))  # type: ignore[arg-type]
    finite = bool(np.isfinite(positions).all())
    drawn = {view: folder / f"{view}.png" for view in PICTURES}
    if result.mannequin is not None:
        files.append(write_mannequin_obj(folder / "mannequin.obj", result.mannequin))
    if finite:
        files.append(write_garment_obj(folder / "garment.obj", result.cloth, positions))
        files.append(write_garment_glb(folder / "garment.glb", result.cloth, positions, result.mannequin))
        try:
            files += render_pictures(drawn, positions, result.cloth, result.mannequin)
        except ViewMissing as missing:
            notes.append(f"no pictures: {missing}")
    else:
        notes.append("no garment.obj, garment.glb and pictures: positions are not finite")
    files.append(write_report(folder / "report.json", result.report))
    return WrittenFolder(folder, tuple(files), tuple(notes))


def read_report(folder: str | Path) -> dict[str, Any]:
    """report.json of a result folder, of this version or an older one. Raises FileError where there is none, or something else."""
    path = Path(folder) / "report.json"
    if Path(folder).is_file():
        raise FileError("is a file; the folder of a finished drape is wanted", file=str(folder))
    if not path.exists():
        raise FileError("no such file: this is not the folder of a finished drape", file=str(path))
    report = read_json(path)
    if not isinstance(report, dict) or "schema" not in report:
        raise FileError("is not a report of garmentcad", file=str(path))
    if report["schema"] != SCHEMA:
        raise FileError(f"{shown(report['schema'])} came; this version reads {SCHEMA}", file=str(path), key="schema")
    for key in _NAMES:
        if not isinstance(report.get(key), str):
            raise FileError(f"a text is wanted, came {shown(report.get(key))}", file=str(path), key=key)
    grid_mm = report.get("grid_mm")
    if isinstance(grid_mm, bool) or not isinstance(grid_mm, (int, float)) or grid_mm <= 0.0:
        raise FileError(f"a number of mm is wanted, came {shown(grid_mm)}", file=str(path), key="grid_mm")
    for key, like in blank_report().items():
        if isinstance(like, dict) and not isinstance(report.get(key, like), dict):
            raise FileError(f"a mapping is wanted, came {shown(report[key])}", file=str(path), key=key)
        if key in report and key not in NO_NUMBERS:
            _refuse_no_number(report[key], key, path)
    return report


def _refuse_no_number(value: Any, key: str, path: Path) -> None:
    """FileError for a value of a report, or one in a mapping of values, that is neither a number nor not measured."""
    if isinstance(value, dict):
        for name, inner in value.items():
            _refuse_no_number(inner, f"{key}.{name}", path)
    elif value is not None and key not in NO_NUMBERS and (isinstance(value, bool) or not isinstance(value, (int, float))):
        raise FileError(f"a number or null is wanted, came {shown(value)}", file=str(path), key=key)


def read_result_folder(folder: str | Path) -> Result:
    """Read a result folder. Raises FileError (or CheckpointError, MeshError) naming the file that is missing or torn; FileError, too, where the
    run diverged so far that there is no shape to draw or measure."""
    folder = Path(folder)
    report = read_report(folder)
    cloth = read_cloth(folder / "cloth.npz")
    if not (folder / "state.npz").exists():
        raise FileError("no such file: the folder of this drape is not whole", file=str(folder / "state.npz"))
    state = load_state(folder / "state.npz")
    if report.get("state_sha256", made := state.sha256()) != made:
        raise FileError("is the end of another drape than report.json tells of (its state_sha256 is another one)", file=str(folder / "state.npz"))
    if state.positions.shape != (cloth.particle_count, 3):
        raise FileError(f"holds {state.positions.shape} positions where cloth.npz has {cloth.particle_count} particles", file=str(folder / "state.npz"))
    if not (np.abs(state.positions) < FARTHEST_M).all():
        raise FileError(f"positions are not finite: this run ended as {report['status']} and has no shape to draw or measure", file=str(folder / "state.npz"))
    maps = read_npz(folder / "maps.npz", _MOST_MAPS * (8 * cloth.particle_count + 1024))
    for name, values in maps.items():
        if values.shape != (cloth.particle_count,):
            raise FileError(f"{name} has shape {values.shape} where cloth.npz has {cloth.particle_count} particles", file=str(folder / "maps.npz"))
        if values.dtype.kind != "f" or not np.isfinite(values).all():
            raise FileError(f"{name} came as {values.dtype}; finite numbers are wanted", file=str(folder / "maps.npz"))
    body = folder / "mannequin.obj"
    return Result(report, cloth, state, maps, read_mannequin_obj(body) if body.exists() else None)
