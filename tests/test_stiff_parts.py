"""Longer steps where little of the cloth is stiff: which steps are stable by theory, and the same motion as with short ones."""

from __future__ import annotations

import numpy as np
import pytest
from elastic import linear

from garmentcad.cloth.cloth import Cloth
from garmentcad.cloth.lattice import build_cloth
from garmentcad.cloth.state import State
from garmentcad.contact.contact import Contact
from garmentcad.fabric.material import MaterialTable
from garmentcad.forces.assembly import ForceAssembly
from garmentcad.forces.button import ForceButton, Shanks
from garmentcad.forces.gravity import ForceGravity
from garmentcad.forces.internal import internal_forces
from garmentcad.forces.time_step import DAMPING_RATIO, SAFETY
from garmentcad.geometry.curve import Line
from garmentcad.pattern.pattern import Edge, Panel, Pattern, Transform
from garmentcad.solve import dynamics as stepper
from garmentcad.solve.dynamics import Dynamics
from garmentcad.solve.stiff_parts import MOST_STAGES, reaches, stages_for, step_of
from garmentcad.solve.strain_limit import strain_limit

H_MM, HEIGHT_MM, BAND_MM = 10.0, 240.0, 40.0
STIFFER = 12.0  # the band on top, than the rest


def growth(stages: int, turn: float, damping_ratio: float) -> float:
    """Largest factor by which a step of a mode with dt omega = `turn` stretches (x, dt v): the eigenvalues of the step, written out for one mode."""

    def acceleration(x: np.ndarray, v: np.ndarray) -> np.ndarray:  # times dt^2, v times dt; rows are what x and v are before the step
        return -(turn**2) * x - 2.0 * damping_ratio * turn * v

    x, v = np.array([1.0, 0.0]), np.array([0.0, 1.0])
    ahead = np.zeros(2)
    for reach in reaches(stages):
        ahead = reach * acceleration(x + ahead, v + 2.0 * ahead)
    v = v + acceleration(x + ahead, v + 2.0 * ahead)
    return float(np.abs(np.linalg.eigvals(np.array([x + v, v]))).max())


@pytest.mark.parametrize("stages", range(1, MOST_STAGES + 1))
@pytest.mark.parametrize("damping_ratio", [0.0, DAMPING_RATIO])
def test_steps_are_stable_as_far_as_they_are_taken_and_not_much_farther(stages: int, damping_ratio: float) -> None:
    """damping_ratio: of the stiffest mode; lower ones have less in proportion."""
    most = 2.0 * SAFETY * step_of(stages, 1.0, 1e9)
    turns = np.linspace(1e-3, 1.0, 400) * most
    assert max(growth(stages, turn, damping_ratio * turn / most) for turn in turns) < 1.0 + 1e-12
    assert max(growth(stages, turn, 0.0) for turn in 1.45 * turns) > 1.05


@pytest.mark.parametrize("stages", range(2, MOST_STAGES + 1))
def test_slow_motion_is_that_of_short_steps(stages: int) -> None:
    """A mode far below the stiffest keeps its frequency: the eigenvalues of a step turn by dt omega (1 + (dt omega)^2 O(1))."""
    turn, ahead = 0.02, np.zeros(2)
    x, v = np.array([1.0, 0.0]), np.array([0.0, 1.0])
    for reach in reaches(stages):
        ahead = -reach * turn**2 * (x + ahead)
    v = v - turn**2 * (x + ahead)
    angle = float(np.abs(np.angle(np.linalg.eigvals(np.array([x + v, v])))).max())
    assert angle == pytest.approx(turn, rel=3e-4)


def materials() -> MaterialTable:
    limp = linear(0.15, 500.0, 10.0, shear=30.0, thickness=5e-4, friction=0.3)
    stiff = linear(0.15, 500.0 * STIFFER, 10.0, shear=30.0 * STIFFER, thickness=5e-4, friction=0.3)
    return MaterialTable(*(np.concatenate(both) for both in zip(limp, stiff)))


def banded() -> tuple[Cloth, MaterialTable]:
    """A sheet of 200 x 240 mm whose upper 40 mm are stiffer."""
    table = materials()

    def material_of(panel: Panel, points: np.ndarray) -> np.ndarray:
        return np.where(points[:, 1] > HEIGHT_MM - BAND_MM, 1, 0)

    corners = [(0.0, 0.0), (200.0, 0.0), (200.0, HEIGHT_MM), (0.0, HEIGHT_MM)]
    edges = tuple(Edge(f"e{k}", f"p{k}", f"p{(k + 1) % 4}", Line(corners[k], corners[(k + 1) % 4])) for k in range(4))
    pattern = Pattern("banded", {"sheet": Panel("sheet", edges, 0.0, Transform((0.0, 0.0, 0.0), (0.0, 0.0, 0.0)))}, (), "none", "none", {}, {})
    return build_cloth(pattern, material_of, table, H_MM), table


def swinging(stages: int, monkeypatch: pytest.MonkeyPatch, damping_ratio: float = 0.0, button: ForceButton | None = None) -> tuple[Dynamics, State]:
    """The sheet hangs from its upper edge and swings in true motion. stages: all of it is one block, so that none would pay."""
    cloth, table = banded()
    monkeypatch.setattr(stepper, "stages_for", lambda *_: stages)
    laws = internal_forces(cloth, table, damping_ratio) + ([] if button is None else [button])
    forces = ForceAssembly(laws, cloth.particle_count, [ForceGravity(cloth.masses)])
    positions = np.column_stack([cloth.vertex_uv_mm * 1e-3, np.zeros(len(cloth.vertex_uv_mm))])
    depth = 1e-3 * HEIGHT_MM - positions[:, 1]
    dynamics = Dynamics(cloth, forces, strain_limit(cloth, table), Contact(cloth, table), depth < 1e-9)
    dynamics.measured = True
    state = State(positions, 3.0 * depth[:, None] * [0.0, 0.0, 1.0])
    dynamics.start(state)
    return dynamics, state


def test_stages_pay_where_little_is_stiff() -> None:
    assert stages_for(1.0, 1.5, 0.1) == 2
    assert stages_for(1.0, 3.0, 0.1) == 3
    assert stages_for(1.0, 3.0, 1.0) == 1
    assert stages_for(1.0, 1.05, 0.1) == 1


def test_a_stiff_band_no_longer_shortens_the_steps(monkeypatch: pytest.MonkeyPatch) -> None:
    short, state_of_short = swinging(1, monkeypatch)
    long, state = swinging(3, monkeypatch)
    assert state.time_step_s > 2.2 * state_of_short.time_step_s
    particles = long._stiff[1]
    assert len(particles) > 50
    assert (long.cloth.vertex_uv_mm[particles, 1] > HEIGHT_MM - BAND_MM - H_MM).all()
    assert (len(short._stiff[2]), len(long._stiff[2])) == (0, 2)


def test_what_a_shank_holds_takes_no_longer_steps(monkeypatch: pytest.MonkeyPatch) -> None:
    """Shanks are damped far more than cloth, and no frequency shows it."""
    plain, _ = swinging(3, monkeypatch)
    triangles = plain.cloth.particle_triangles
    stiff = triangles[np.isin(triangles, plain._stiff[1]).all(axis=1)]
    held = stiff[[0, -1]]
    shanks = Shanks(held[None], np.full((1, 2, 3), 1.0 / 3.0), np.array([2e-3]), np.array([1e-6]), np.array([0.0]))
    buttoned, _ = swinging(3, monkeypatch, button=ForceButton(shanks))
    assert len(np.unique(held)) == 6
    assert set(buttoned._stiff[1].tolist()) == set(plain._stiff[1].tolist()) - set(held.ravel().tolist())


@pytest.mark.parametrize("damping_ratio", [0.0, DAMPING_RATIO])
def test_the_motion_is_that_of_short_steps_and_takes_no_energy_from_nowhere(damping_ratio: float, monkeypatch: pytest.MonkeyPatch) -> None:
    """Against steps a quarter as long as those of one evaluation, after a tenth of a second, in which the hem goes 7 cm."""
    exact, state_of_exact = swinging(1, monkeypatch, damping_ratio)
    exact.step_factor = 0.25
    long, state = swinging(3, monkeypatch, damping_ratio)
    swing = long.measures(state)[0]
    energies = []
    for _ in range(40):
        long.advance(state, 24)
        energies.append(sum(long.forces.energy(state.positions).values()) + long.measures(state)[0])
    while state_of_exact.time_s < state.time_s:
        exact.advance(state_of_exact, 1 + int((state.time_s - state_of_exact.time_s) / state_of_exact.time_step_s))
    rest = state.time_s - state_of_exact.time_s
    apart = np.linalg.norm(state.positions - (state_of_exact.positions + rest * state_of_exact.velocities), axis=1)
    assert np.abs(state.positions[:, 2]).max() > 0.05
    assert apart.max() < 2e-5
    assert max(energies) - energies[0] < 1e-3 * swing


def test_a_step_is_what_the_equations_say(monkeypatch: pytest.MonkeyPatch) -> None:
    """Written out with the forces of the whole cloth, and with something that holds some of its band."""
    dynamics, state = swinging(3, monkeypatch, DAMPING_RATIO)
    dynamics.advance(state, 7)
    dynamics.estimate_time_step(state)
    held = 1e-3 * np.random.default_rng(1).standard_normal(state.positions.shape)
    state.contact["stiff_held"][:] = held
    x, v, dt, inverse_masses = state.positions.copy(), state.velocities.copy(), state.time_step_s, dynamics.true_inverse_masses[:, None]
    stiff = np.zeros_like(inverse_masses)
    stiff[dynamics._stiff[1]] = 1.0
    ahead, force = np.zeros_like(x), np.zeros_like(x)
    for reach in reaches(3):
        dynamics.forces.add_up(x + ahead, v + 2.0 / dt * ahead, force)
        ahead = stiff * reach * dt**2 * inverse_masses * (force + held)
    dynamics.forces.add_up(x + ahead, v + 2.0 / dt * ahead, force)
    dynamics.advance(state, 1)
    assert np.abs(ahead).max() > 1e-7
    assert np.allclose(state.velocities, v + dt * inverse_masses * force, rtol=1e-9, atol=1e-12)
    assert np.allclose(state.positions, x + dt * state.velocities, rtol=0.0, atol=1e-15)
    # nothing held the band in this step, the eighth
    assert np.allclose(state.contact["stiff_held"], np.where(stiff > 0.0, 7.0 / 8.0 * held, held), rtol=1e-9, atol=1e-15)
