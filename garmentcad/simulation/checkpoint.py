"""Checkpoint: one State in one .npz file without pickle, written whole or not at all."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np

from garmentcad.cloth.state import State
from garmentcad.errors import CheckpointError, FileError
from garmentcad.io.atomic import write_atomic
from garmentcad.io.npz_file import read_npz

SCHEMA = 3


def save_state(path: Path, state: State, identity: dict[str, str]) -> None:
    """Write `state`. identity: what the run is (hashes of spec, fabric, mannequin, program version); `load_state` demands the same."""
    head = {
        "schema": SCHEMA, "identity": identity, "time_s": state.time_s, "step": state.step, "time_step_s": state.time_step_s, "phase": state.phase,
        "run": state.run, "work_j": state.work_j,
    }  # fmt: skip
    arrays = {name: getattr(state, name) for name in ("positions", "velocities", "constraint_speeds", "constraint_forces", "fold_angles")}
    arrays |= {"head": np.frombuffer(json.dumps(head).encode(), dtype=np.uint8)}
    arrays |= {f"friction.{name}": array for name, array in state.friction.items()} | {f"contact.{name}": array for name, array in state.contact.items()}
    write_atomic(path, lambda stream: np.savez(stream, **arrays))  # type: ignore[arg-type]


def load_state(path: Path, identity: dict[str, str] | None = None) -> State:
    """Read a State. CheckpointError where the file is torn, or was made by another run than `identity` says."""
    if not Path(path).exists():
        raise CheckpointError("there is no checkpoint to resume from", file=str(path))
    try:
        arrays = read_npz(path)
        head = json.loads(bytes(arrays.pop("head")).decode())
        state = State(
            arrays["positions"], arrays["velocities"], head["time_s"], head["step"], head["time_step_s"], head["phase"], arrays["constraint_speeds"],
            {name[9:]: array for name, array in arrays.items() if name.startswith("friction.")},
            {name[8:]: array for name, array in arrays.items() if name.startswith("contact.")},
            head["run"], head["work_j"], arrays["constraint_forces"], arrays["fold_angles"],
        )  # fmt: skip
        made_by = head["identity"]
    except FileError as error:
        raise CheckpointError(f"not a whole checkpoint of this program: {error.message}", file=str(path)) from None
    except (ValueError, KeyError) as error:
        raise CheckpointError(f"not a whole checkpoint of this program ({type(error).__name__}: {error})", file=str(path)) from None
    if identity is not None and made_by != identity:
        unlike = [key for key in sorted({*made_by, *identity}) if made_by.get(key) != identity.get(key)]
        differing = ", ".join(f"{key}: {made_by.get(key)} there, {identity.get(key)} here" for key in unlike)
        raise CheckpointError(f"the checkpoint belongs to another run ({differing})", file=str(path))
    return state
