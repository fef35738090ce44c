"""Checkpoint: one State in one .npz file without pickle, written whole or not at all."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from pydantic import ConfigDict, Field

from garmentcad.cloth.state import State
from garmentcad.errors import CheckpointError, InputError
from garmentcad.io.atomic import write_atomic
from garmentcad.io.npz_file import read_npz
from garmentcad.pattern.model import Model
from garmentcad.pattern.parse import parse_model

SCHEMA = 3
MOST_HEAD_BYTES = 2_000_000
# What is told of a difference between hashes alone, which would tell a person nothing.
_HASHED = {"spec": "spec: the garment, or a parameter that was set, is another one", "mannequin": "mannequin: another body, or another pose of it"}
_POINTS = ("positions", "velocities", "constraint_speeds", "constraint_forces")


class Head(Model):
    """What is no array. Numbers may be nan or inf: the state of a run that diverged is kept, too."""

    model_config = ConfigDict(strict=True, allow_inf_nan=True)

    schema_version: Literal[3] = Field(alias="schema")
    identity: dict[str, str]
    time_s: float
    step: Annotated[int, Field(ge=0, lt=2**63)]
    time_step_s: float
    phase: str
    run: dict[str, float]
    work_j: dict[str, float]
    said: list[str] = Field(default_factory=list)


def save_state(path: Path, state: State, identity: dict[str, str]) -> None:
    """Write `state`. identity: what the run is (hashes of spec, fabric, mannequin, program version); `load_state` demands the same."""
    head = {
        "schema": SCHEMA, "identity": identity, "time_s": state.time_s, "step": state.step, "time_step_s": state.time_step_s, "phase": state.phase,
        "run": state.run, "work_j": state.work_j, "said": list(state.said),
    }  # fmt: skip
    arrays = {name: getattr(state, name) for name in (*_POINTS, "fold_angles")}
    arrays |= {"head": np.frombuffer(json.dumps(head).encode(), dtype=np.uint8)}
    arrays |= {f"friction.{name}": array for name, array in state.friction.items()} | {f"contact.{name}": array for name, array in state.contact.items()}
    write_atomic(path, lambda stream: np.savez(stream, **arrays))  # type: ignore[arg-type]


def load_state(path: Path, identity: dict[str, str] | None = None) -> State:
    """Read a State. CheckpointError where the file is torn, is none of this program, or was made by another run than `identity` says. Whether its arrays
    fit a cloth is not known here."""
    if not Path(path).exists():
        raise CheckpointError("there is no checkpoint to resume from", file=str(path))
    try:
        arrays = read_npz(path)
        head = _head(arrays.pop("head"))
        points = {name: _floats(arrays, name, (len(arrays[name]), 3)) for name in _POINTS}
        state = State(
            points["positions"], points["velocities"], head.time_s, head.step, head.time_step_s, head.phase, points["constraint_speeds"],
            {name[9:]: array for name, array in arrays.items() if name.startswith("friction.")},
            {name[8:]: array for name, array in arrays.items() if name.startswith("contact.")},
            dict(head.run), dict(head.work_j), points["constraint_forces"], _floats(arrays, "fold_angles", (arrays["fold_angles"].size,)),
            tuple(head.said),
        )  # fmt: skip
    except InputError as error:
        what = f"head.{error.key}: {error.message}" if error.key else error.message
        raise CheckpointError(f"not a whole checkpoint of this program: {what}", file=str(path)) from None
    except (ValueError, KeyError, TypeError, RecursionError) as error:
        raise CheckpointError(f"not a whole checkpoint of this program ({type(error).__name__}: {error})", file=str(path)) from None
    if identity is not None and head.identity != identity:
        unlike = [key for key in sorted({*head.identity, *identity}) if head.identity.get(key) != identity.get(key)]
        differing = ", ".join(_HASHED.get(key) or f"{key}: {head.identity.get(key)} there, {identity.get(key)} here" for key in unlike)
        raise CheckpointError(f"the checkpoint belongs to another run ({differing})", file=str(path))
    return state


def _head(packed: np.ndarray) -> Head:
    if packed.dtype != np.uint8 or packed.size > MOST_HEAD_BYTES:
        raise ValueError(f"its head is {packed.size} x {packed.dtype}; at most {MOST_HEAD_BYTES} bytes are wanted")
    return parse_model(Head, json.loads(packed.tobytes().decode()))


def _floats(arrays: dict[str, np.ndarray], name: str, shape: tuple[int, ...]) -> np.ndarray:
    array = arrays[name]
    if array.dtype != np.float64 or array.shape != shape:
        raise ValueError(f"{name} came as {array.dtype} {array.shape}; float64 {shape} is wanted")
    return np.ascontiguousarray(array)
