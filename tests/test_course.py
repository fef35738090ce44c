"""The course of a drape: a run that diverges goes back to its last whole state and on with a smaller step, or is given up with the place; cloth that rings
through a watch settles with the masses that it is watched with."""

from __future__ import annotations

import math

import numpy as np
import pytest
import trimesh
from test_dynamics import hanging, linear_fabric

from garmentcad.cloth.lattice import rectangle_cloth
from garmentcad.cloth.state import State
from garmentcad.contact.contact import Contact
from garmentcad.forces.assembly import ForceAssembly
from garmentcad.forces.gravity import ForceGravity
from garmentcad.forces.internal import internal_forces
from garmentcad.simulation import course as course_module
from garmentcad.simulation.course import (
    AIR_DRAG,
    FALL_DRAG,
    FALL_S,
    LOOSE_SOFTNESS,
    LOOSE_SPEED_CAP_M_S,
    SMALLEST_STEP_FACTOR,
    SOFTNESS,
    STANDS,
    STANDS_M_S,
    STEPS_PER_LOOK,
    Course,
    Progress,
)  # fmt: skip
from garmentcad.solve.dynamics import DivergedError, Dynamics
from garmentcad.solve.rest import Residual, patches
from garmentcad.solve.strain_limit import strain_limit

MATERIALS = linear_fabric()
CLOTH = rectangle_cloth(50.0, 100.0, 10.0, 0.0, MATERIALS)


class Underestimated(ForceAssembly):
    """Says that the cloth is softer than it is, so that the step is too large by the root of `share`."""

    share = 1.0

    def stiffness(self, positions: np.ndarray, out: np.ndarray) -> None:
        super().stiffness(positions, out)
        out /= self.share


def course(share: float, max_time_s: float, mode: str = "dynamics") -> tuple[Course, State]:
    forces = Underestimated(internal_forces(CLOTH, MATERIALS), CLOTH.particle_count, [ForceGravity(CLOTH.masses)])
    forces.share = share
    positions = hanging(CLOTH)
    dynamics = Dynamics(CLOTH, forces, strain_limit(CLOTH, MATERIALS), Contact(CLOTH, MATERIALS), positions[:, 1] > 0.0999)
    start = positions + 1e-5 * np.random.default_rng(0).standard_normal(positions.shape)
    state = State(start, np.zeros_like(start), phase="fall", run={"phase_from_s": 0.0})
    dynamics.start(state)
    return Course(dynamics, lambda softness: None, mode, max_time_s), state


def test_a_step_that_is_too_large_is_found_and_halved_until_it_holds() -> None:
    made, state = course(share=16.0, max_time_s=0.1)
    looked: list[int] = []
    assert made.run(state, lambda progress: looked.append(progress.step)) == "max_time"
    assert SMALLEST_STEP_FACTOR <= state.run["step_factor"] <= 0.5
    assert np.abs(state.positions - hanging(CLOTH)).max() < 5e-3
    assert looked == sorted(looked)
    assert len(set(looked)) == len(looked)  # a stretch that was undone is not told


@pytest.mark.parametrize(("loose", "coarse_s", "softness"), [(False, 1.0, SOFTNESS), (True, FALL_S, LOOSE_SOFTNESS)])
def test_on_a_finer_lattice_cloth_falls_softly_for_half_a_second(loose: bool, coarse_s: float, softness: float) -> None:
    """Sewn cloth leaves the coarse lattice while it is soft, loose cloth once its tension is back there."""
    made, state = course(1.0, 9.0, "drape")
    heard: list[float] = []
    coarse, fine = (Course(made.dynamics, heard.append, "drape", 9.0, loose, last) for last in (False, True))
    assert coarse.run(state, lambda progress: None) == "converged"
    look_s = 1.01 * STEPS_PER_LOOK * state.time_step_s
    assert coarse_s <= state.time_s < coarse_s + look_s
    assert heard[0] == softness
    assert (heard[-1] < 1.5) == loose
    began, state.phase = state.time_s, "fall"
    made.dynamics.softness = 1.0  # as of the new one that the finer lattice has
    heard.clear()

    def look(progress: Progress) -> None:
        if progress.phase == "settle":
            raise StopIteration

    with pytest.raises(StopIteration):
        fine.run(state, look)
    assert FALL_S - 1.0 - look_s < state.time_s - began < FALL_S - 1.0 + look_s
    assert heard[0] == softness
    assert heard[-1] < 1.5


def test_a_run_that_ends_at_once_has_the_forces_of_its_phase() -> None:
    """One that is resumed with less time than it had: its residual is measured (98 g were told of a robe that was 0.003 g out of balance)."""
    made, state = course(1.0, 9.0, "drape")
    heard: list[float] = []
    assert Course(made.dynamics, heard.append, "drape", 0.0).run(state, lambda progress: None) == "max_time"
    assert (state.step, heard) == (0, [SOFTNESS])


@pytest.mark.parametrize("small", [False, True])
def test_a_small_piece_falls_as_in_dynamics_and_settles_as_in_drape_mode(small: bool) -> None:
    made, state = course(1.0, 9.0, "drape")
    heard: list[float] = []
    drape = Course(made.dynamics, heard.append, "drape", 9.0, loose=True, small=small)
    dynamics = made.dynamics
    falling: set[tuple[bool, bool, object, float]] = set()

    def look(progress: Progress) -> None:
        if progress.phase == "settle":
            raise StopIteration
        falling.add((dynamics.equalise, dynamics.measured, dynamics.drag, dynamics.speed_cap_m_s))

    with pytest.raises(StopIteration):
        drape.run(state, look)
    assert falling == {(False, True, AIR_DRAG, math.inf)} if small else {(True, False, FALL_DRAG, LOOSE_SPEED_CAP_M_S)}
    assert (heard == []) == small, "no tension is softened"
    drape.set_phase(state)
    assert (dynamics.equalise, dynamics.speed_cap_m_s) == (True, LOOSE_SPEED_CAP_M_S)


def test_no_retreat_where_the_step_is_right() -> None:
    made, state = course(share=1.0, max_time_s=0.05)
    assert made.run(state, lambda progress: None) == "max_time"
    assert "step_factor" not in state.run


def test_what_smaller_steps_do_not_help_is_given_up_with_its_place() -> None:
    made, state = course(share=4096.0, max_time_s=1.0)
    with pytest.raises(DivergedError, match=r"panel 'rectangle' at \(\d+, \d+\) mm reached .* phase fall"):
        made.run(state, lambda progress: None)
    assert state.run["step_factor"] == SMALLEST_STEP_FACTOR


@pytest.mark.parametrize(("thirds_m_s", "fictitious"), [((1.0, 0.5), False), ((0.001, 0.5), True)])
def test_what_rings_through_a_watch_settles_with_true_masses(monkeypatch: pytest.MonkeyPatch, thirds_m_s: tuple[float, float], fictitious: bool) -> None:
    """Speeds of the second and of the last third: what grows is a slow snap, which goes on under fictitious masses; what does not was set off by them."""
    monkeypatch.setattr(course_module, "residual", lambda *_: Residual(1.0, 1.0, np.ones(patches(CLOTH).max() + 1)))
    made, state = course(1.0, 2.0, "drape")
    state.phase, state.time_s = "watch", 1.0
    state.run = {"phase_from_s": 0.0, "watch_from_s": 0.0, "watch_rms_1": thirds_m_s[0], "watch_rms_2": thirds_m_s[1]}
    seen: list[tuple[str, bool]] = []

    def look(progress: Progress) -> None:
        seen.append((progress.phase, made.dynamics.equalise))
        if len(seen) == 2:
            raise StopIteration

    with pytest.raises(StopIteration):
        made.run(state, look)
    assert seen == [("settle", False), ("settle", fictitious)]


@pytest.mark.parametrize("mode", ["drape", "dynamics"])
def test_longer_steps_are_for_what_falls_and_for_the_first_watch(monkeypatch: pytest.MonkeyPatch, mode: str) -> None:
    monkeypatch.setattr(course_module, "residual", lambda *_: Residual(1.0, 1.0, np.ones(patches(CLOTH).max() + 1)))
    made, state = course(1.0, 2.0, mode)
    staged = {}
    for state.phase in ("fall", "settle", "watch"):
        made.set_phase(state)
        staged[state.phase] = made.dynamics.staged
    assert staged == {"fall": True, "settle": False, "watch": True}
    state.time_s, state.run = 1.0, {"phase_from_s": 0.0, "watch_from_s": 0.0, "watch_rms_1": 1.0}

    def look(progress: Progress) -> None:
        raise StopIteration

    with pytest.raises(StopIteration):
        made.run(state, look)
    assert state.phase == "settle"
    state.phase = "watch"
    made.set_phase(state)
    assert not made.dynamics.staged


@pytest.mark.parametrize(("left_g", "status"), [(1.0, "max_time"), (0.0, "converged")])
def test_what_stands_still_tries_true_masses_and_ends_where_it_is_out_of_balance(monkeypatch: pytest.MonkeyPatch, left_g: float, status: str) -> None:
    """Of cloth that is held but for one particle; a residual that stays while nothing moves is no nearer to rest at any later time."""
    monkeypatch.setattr(course_module, "residual", lambda *_: Residual(left_g, left_g, np.full(patches(CLOTH).max() + 1, left_g)))
    made, state = course(1.0, 20.0, "drape")
    made.dynamics.hold_still(np.arange(CLOTH.particle_count) > 0)
    state.phase, seen = "settle", []
    assert made.run(state, lambda progress: seen.append(made.dynamics.equalise)) == status
    assert state.time_s < 10.0
    assert (STANDS in state.run) == (status == "max_time")
    assert seen == sorted(seen, reverse=True), "true masses from where it stood still with others"
    assert (seen[0], seen[-1]) == (True, False)


def test_what_is_far_out_of_balance_is_held_before_its_last_speed_is_gone(monkeypatch: pytest.MonkeyPatch) -> None:
    """1e5 g would drive cloth at 4,900 m/s against the strongest drag: below 3e-4 of that it is held, with true masses too."""
    monkeypatch.setattr(course_module, "residual", lambda *_: Residual(1e5, 1e5, np.full(patches(CLOTH).max() + 1, 1e5)))
    made, state = course(1.0, 20.0, "drape")
    made.dynamics.hold_still(np.arange(CLOTH.particle_count) > 0)
    state.phase, speeds = "settle", []
    assert made.run(state, lambda progress: speeds.append(progress.rms_speed_m_s)) == "max_time"
    assert STANDS in state.run
    assert speeds[-1] > STANDS_M_S


def test_a_patch_out_of_balance_that_stands_still_tries_true_masses_too(monkeypatch: pytest.MonkeyPatch) -> None:
    """A residual that is small in all, so that hardly any speed is less than a part of what it would give."""
    monkeypatch.setattr(course_module, "residual", lambda *_: Residual(1e-6, 1.0, np.full(patches(CLOTH).max() + 1, 1.0)))
    made, state = course(1.0, 20.0, "drape")
    made.dynamics.hold_still(np.arange(CLOTH.particle_count) > 0)
    state.phase, seen = "settle", []
    made.run(state, lambda progress: seen.append(made.dynamics.equalise))
    assert (seen[0], seen[-1]) == (True, False)


def test_what_is_held_out_of_balance_does_not_creep_to_a_standstill(monkeypatch: pytest.MonkeyPatch) -> None:
    """A robe under a belt settled for two seconds at 23 g. Under the most drag, 200 /s, what is free would move at 1.1 m/s."""
    monkeypatch.setattr(course_module, "residual", lambda *_: Residual(23.0, 23.0, np.full(patches(CLOTH).max() + 1, 23.0)))
    made, state = course(1.0, 20.0, "drape")
    made.dynamics.hold_still(np.arange(CLOTH.particle_count) > 0)
    state.velocities[0] = [0.0, 0.0, 0.5]
    state.phase, seen = "settle", []
    made.run(state, lambda progress: seen.append((made.dynamics.equalise, progress.rms_speed_m_s)))
    speeds = [speed for equalise, speed in seen if equalise]
    assert 1e-6 < speeds[-1] < 4e-4 < speeds[-2]


def test_what_has_fallen_past_the_body_altogether_ends() -> None:
    """Shorts without an elastic fell for 10 s, seven metres below the floor."""
    below = trimesh.creation.icosphere(radius=0.02)
    body = np.add(below.vertices, [0.0, -0.5, 1.0]), np.asarray(below.faces)
    state = course(1.0, 5.0)[1]
    forces = ForceAssembly(internal_forces(CLOTH, MATERIALS), CLOTH.particle_count, [ForceGravity(CLOTH.masses)])
    dynamics = Dynamics(CLOTH, forces, strain_limit(CLOTH, MATERIALS), Contact(CLOTH, MATERIALS, body))
    dynamics.start(state)
    assert Course(dynamics, lambda softness: None, "dynamics", 5.0).run(state, lambda progress: None) == "max_time"
    assert state.positions[:, 1].max() < -0.52
    assert state.positions[:, 1].max() > -1.0, "and no farther"
