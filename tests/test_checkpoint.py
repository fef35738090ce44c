"""A checkpoint gives back every bit, or is refused with its file and reason."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from garmentcad.cloth.state import State
from garmentcad.errors import CheckpointError, FileError
from garmentcad.simulation import keeper, run
from garmentcad.simulation.checkpoint import load_state, save_state
from garmentcad.simulation.course import Progress
from garmentcad.simulation.job import Job, make_job

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


def rewritten(path: Path, change: Callable[[dict[str, Any], dict[str, Any]], Any]) -> Path:
    """The file beside `path` with what `change` makes of its arrays and its head (a head of its own where it gives one)."""
    with np.load(path) as file:
        arrays: dict[str, Any] = dict(file)
    head = json.loads(arrays.pop("head").tobytes())
    made = change(arrays, head)
    raw = made if isinstance(made, bytes) else json.dumps(head if made is None else made).encode()
    changed = path.with_name("changed.npz")
    np.savez(changed, head=np.frombuffer(raw, np.uint8), **arrays)
    return changed


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda arrays, head: [1], r"a mapping is wanted, came \[1\]"),
        (lambda arrays, head: b"[" * 200_000, "RecursionError"),
        (lambda arrays, head: head | {"schema": 99}, "head.schema: .*came 99"),
        (lambda arrays, head: head | {"identity": ["x"]}, "head.identity"),
        (lambda arrays, head: head | {"run": [1]}, "head.run"),
        (lambda arrays, head: head | {"time_s": "1"}, "head.time_s: .*came '1'"),
        (lambda arrays, head: head | {"step": 10**400}, "head.step"),
        (lambda arrays, head: arrays.update(positions=np.full((7, 3), "x")), r"positions came as <U1 \(7, 3\)"),
        (lambda arrays, head: arrays.update(velocities=np.zeros((7, 2))), r"velocities came as float64 \(7, 2\); float64 \(7, 3\) is wanted"),
        (lambda arrays, head: arrays.update(fold_angles=np.zeros((2, 2))), "fold_angles"),
    ],
)
def test_what_is_no_checkpoint_of_this_program_is_refused(change: Any, message: str, tmp_path: Path) -> None:
    save_state(tmp_path / "c.npz", some_state(), IDENTITY)
    with pytest.raises(CheckpointError, match=rf"changed\.npz: not a whole checkpoint of this program.*{message}"):
        load_state(rewritten(tmp_path / "c.npz", change), IDENTITY)


class Stopped(Exception):
    pass


def stop(progress: Progress) -> None:
    raise Stopped


@pytest.fixture(scope="module")
def begun(tmp_path_factory: pytest.TempPathFactory) -> tuple[Job, Path]:
    """A job, and its checkpoint a few steps on."""
    job, path = make_job("straight-skirt", grid_mm=50.0), tmp_path_factory.mktemp("begun") / "checkpoint.npz"

    def look(progress: Progress) -> None:
        if progress.step > 300:
            raise Stopped

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(keeper, "CHECKPOINT_EVERY_S", 0.0)
        with pytest.raises(Stopped):
            run.run(job, look, path)
    with pytest.raises(Stopped):
        run.run(job, stop, rewritten(path, lambda arrays, head: None), resume=True)
    return job, path


def by(name: str, change: Callable[[np.ndarray], np.ndarray]) -> Callable[[dict[str, Any], dict[str, Any]], None]:
    return lambda arrays, head: arrays.update({name: change(arrays[name])})


def first_is_nan(array: np.ndarray) -> np.ndarray:
    array.flat[0] = np.nan
    return array


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda arrays, head: head | {"phase": "dance"}, "phase 'dance'; allowed are close, press"),
        (lambda arrays, head: head | {"phase": "fall", "run": {}}, "in the phase fall phase_from_s is missing"),
        (lambda arrays, head: head | {"run": head["run"] | {"level": 7}}, "level 7; 0 to 0 is allowed"),
        (lambda arrays, head: head | {"run": head["run"] | {"step_factor": 0.0}}, "step_factor 0"),
        (lambda arrays, head: head | {"run": head["run"] | {"sewing": -5.0}}, "sewing -5; 0 to 1 is allowed"),
        (lambda arrays, head: head | {"run": head["run"] | {"sewing": 0.5}}, "sewing 0.5; 0 to 1 is allowed"),
        (lambda arrays, head: head | {"time_step_s": float("nan")}, "time_step_s is not finite"),
        (lambda arrays, head: head | {"work_j": {}}, "work_j holds nothing"),
        (lambda arrays, head: arrays.update(positions=arrays["positions"][:100], velocities=arrays["velocities"][:100]), r"positions came as \(100, 3\)"),
        (by("positions", first_is_nan), "positions are not finite"),
        (by("fold_angles", lambda array: np.zeros(5)), r"fold_angles came as \(5,\); \(0,\) is wanted"),
        (by("friction.lattice", lambda array: array[:1]), r"friction.lattice came as float64 \(1, "),
        (by("friction.border", first_is_nan), "friction.border is not finite"),
        (by("contact.pair_nodes", lambda array: array + np.int32(10**7)), "contact.pair_nodes holds 100"),
        (by("contact.pair_outside", lambda array: array + np.int32(10**7)), "contact.pair_outside holds "),
        (by("contact.planes_held", lambda array: array + np.int32(10**7)), "contact.planes_held holds "),
        (by("contact.pair_kind", lambda array: array.astype(np.int64)), "contact.pair_kind came as int64"),
        (by("contact.planes_home", np.asfortranarray), "contact.planes_home"),
        (lambda arrays, head: arrays.__delitem__("contact.stiff_wait"), "contact.stiff_wait is missing"),
        (lambda arrays, head: arrays.update({"contact.other": np.zeros(1)}), "contact.other is none of this version"),
        (by("contact.pair_impulse", first_is_nan), "contact.pair_impulse is not a number"),
    ],
)
def test_what_the_run_could_not_go_on_from_is_refused(begun: tuple[Job, Path], change: Any, message: str) -> None:
    job, path = begun
    with pytest.raises(CheckpointError, match=rf"changed\.npz: the checkpoint does not fit this run: {message}"):
        run.run(job, stop, rewritten(path, change), resume=True)


@pytest.mark.parametrize(("max_time_s", "phase"), [(0.02, "close"), (0.9, "fall")])
def test_a_resumed_run_repeats_what_was_said_of_its_start(max_time_s: float, phase: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    place = run._placed

    def placed(*given: Any) -> np.ndarray:
        given[-1].append("panel 'front' was moved")
        return place(*given)

    monkeypatch.setattr(run, "_placed", placed)
    job, kept = make_job("straight-skirt", grid_mm=50.0, max_time_s=max_time_s), tmp_path / "checkpoint.npz"
    whole = run.run(job, lambda progress: None, kept)
    assert (whole.state.phase, whole.warnings[0]) == (phase, "panel 'front' was moved")
    assert run.run(job, lambda progress: None, kept, resume=True).warnings == whole.warnings


def test_a_disk_that_is_full_later_on_does_not_end_a_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """One that is so at the first checkpoint does, and so it does where the run is stopped: nothing would be left to go on from."""
    full = [True]

    def save(path: Path, state: State, identity: dict[str, str]) -> None:
        if full[0]:
            raise FileError("cannot write: No space left on device", file=str(path))
        save_state(path, state, identity)

    monkeypatch.setattr(keeper, "save_state", save)
    monkeypatch.setattr(keeper, "CHECKPOINT_EVERY_S", 0.0)
    stopped: list[int] = []
    job = make_job("straight-skirt", grid_mm=50.0)
    keep = keeper.Keeper(job, tmp_path / "c.npz", lambda progress: None, stopped, lambda: None, lambda: None)
    keep.state, now = some_state(), Progress("fall", 42, 1.25, None, None, 0.1, None)
    with pytest.raises(FileError, match="No space left"):
        keep(now)
    full[0] = False
    keep(now)
    full[0], keep.state.step = True, 43
    with pytest.warns(UserWarning, match=r"c\.npz: cannot write: No space left on device; the run goes on"):
        keep(now)
    assert load_state(tmp_path / "c.npz").step == 42
    full[0] = False
    keep(now)
    assert load_state(tmp_path / "c.npz").step == 43
    full[0] = True
    stopped.append(2)
    with pytest.raises(FileError, match="No space left"):
        keep(now)
