"""A checkpoint gives back every bit, or is refused with its file and reason."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from garmentcad.cloth.state import State
from garmentcad.errors import CheckpointError
from garmentcad.simulation.checkpoint import load_state, save_state

IDENTITY = {"spec": "a", "seed": "0"}


def some_state() -> State:
    rng = np.random.default_rng(0)
    return State(
        rng.standard_normal((7, 3)), rng.standard_normal((7, 3)), 1.25, 42, 3e-5, "settle", rng.standard_normal((2, 3)),
        {"bend": rng.standard_normal(4)}, {"body_faces": np.arange(6, dtype=np.int32).reshape(3, 2)}, {"phase_from_s": 0.1 + 0.2},
        {"friction": -1e-17, "damping": 0.0}, rng.standard_normal((2, 3)), np.array([2.5, -0.1]),
    )  # fmt: skip


def test_round_trip_keeps_every_bit(tmp_path: Path) -> None:
    state = some_state()
    save_state(tmp_path / "c.npz", state, IDENTITY)
    back = load_state(tmp_path / "c.npz", IDENTITY)
    assert back.sha256() == state.sha256()
    assert (back.time_s, back.step, back.time_step_s, back.phase) == (state.time_s, state.step, state.time_step_s, state.phase)
    assert back.run == state.run
    assert back.work_j == state.work_j
    assert back.fold_angles.tobytes() == state.fold_angles.tobytes()
    assert back.constraint_speeds.tobytes() == state.constraint_speeds.tobytes()
    assert back.constraint_forces.tobytes() == state.constraint_forces.tobytes()
    assert back.contact["body_faces"].dtype == np.int32
    assert np.array_equal(back.contact["body_faces"], state.contact["body_faces"])


def test_hash_sees_velocities_and_friction() -> None:
    first, second, third = some_state(), some_state(), some_state()
    second.velocities[3, 1] = np.nextafter(second.velocities[3, 1], 9.0)
    third.friction["bend"][0] += 1e-15
    assert len({first.sha256(), second.sha256(), third.sha256()}) == 3


@pytest.mark.parametrize("cut", [0, 10, 200, -30])
def test_torn_file_is_refused(cut: int, tmp_path: Path) -> None:
    path = tmp_path / "c.npz"
    save_state(path, some_state(), IDENTITY)
    path.write_bytes(path.read_bytes()[:cut])
    with pytest.raises(CheckpointError, match=r"c\.npz"):
        load_state(path, IDENTITY)


def test_another_run_is_refused_by_what_differs(tmp_path: Path) -> None:
    save_state(tmp_path / "c.npz", some_state(), IDENTITY)
    with pytest.raises(CheckpointError, match="seed: 0 there, 1 here"):
        load_state(tmp_path / "c.npz", {"spec": "a", "seed": "1"})
