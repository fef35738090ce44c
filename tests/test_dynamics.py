"""The stepper against closed forms: free fall, a hanging strip's stretch, its rest test; strain limiting; the same bits on any number of threads."""

from __future__ import annotations

import math
from typing import Any

import numba
import numpy as np
import pytest
import trimesh
from elastic import linear
from small_cloth import materials, small_cloth

from garmentcad.arrays import CHUNKS, frozen
from garmentcad.cloth.cloth import Cloth
from garmentcad.cloth.lattice import rectangle_cloth
from garmentcad.cloth.state import State
from garmentcad.constraints.points import ConstraintPoints, PointRows
from garmentcad.contact.contact import Contact
from garmentcad.contact.planes import fresh_planes, respond_planes
from garmentcad.fabric.material import MaterialTable
from garmentcad.forces.assembly import ForceAssembly, Sums
from garmentcad.forces.gravity import ForceGravity
from garmentcad.forces.internal import internal_forces
from garmentcad.forces.time_step import SmallMotion
from garmentcad.solve.dynamics import RUNAWAY_M_S, STEPS_PER_ESTIMATE, DivergedError, Dynamics, IntersectingError
from garmentcad.solve.rest import RESIDUAL_G, patches, residual
from garmentcad.solve.steps import CUT, DONE, MOST_CUTS, advance_velocities
from garmentcad.solve.strain_limit import RETURN_M_S, least_headroom, pull_back, strain_limit
from garmentcad.units import GRAVITY_M_S2

STIFFNESS = 2000.0  # N/m, warp and weft alike, linear
MASS = 0.15  # kg/m2


def linear_fabric(limit: float = 0.4) -> MaterialTable:
    return linear(MASS, STIFFNESS, limit, shear=45.0, thickness=5e-4, friction=0.3)


def hanging(cloth: Cloth) -> np.ndarray:
    return np.column_stack([cloth.vertex_uv_mm * 1e-3, np.zeros(len(cloth.vertex_uv_mm))])


def dynamics_of(cloth: Cloth, fixed: np.ndarray | None, drag: float, materials: MaterialTable) -> Dynamics:
    forces = ForceAssembly(internal_forces(cloth, materials), cloth.particle_count, [ForceGravity(cloth.masses)])
    dynamics = Dynamics(cloth, forces, strain_limit(cloth, materials), Contact(cloth, materials), fixed)
    dynamics.drag = drag
    return dynamics


def test_free_fall_is_exact_and_untouched_by_internal_damping() -> None:
    materials = linear_fabric()
    cloth = rectangle_cloth(60.0, 40.0, 10.0, 20.0, materials)
    state = State(hanging(cloth), np.zeros((cloth.particle_count, 3)))
    shape = state.positions - state.positions[0]
    dynamics = dynamics_of(cloth, None, 0.0, materials)
    dynamics.start(state)
    start = state.positions[:, 1].copy()
    dynamics.advance(state, 500)
    # velocity first, then position: the sum over steps is g t (t + dt)/2
    assert np.allclose(start - state.positions[:, 1], 0.5 * GRAVITY_M_S2 * state.time_s * (state.time_s + state.time_step_s), rtol=1e-9)
    assert np.abs(state.positions - state.positions[0] - shape).max() < 1e-12


def test_in_motion_the_frequency_is_measured_anew_where_cloth_stiffens_and_seldom_else(monkeypatch: pytest.MonkeyPatch) -> None:
    measured: list[int] = []

    class Counted(SmallMotion):
        def __init__(self, laws: ForceAssembly, positions: np.ndarray) -> None:
            measured.append(state.step)
            super().__init__(laws, positions)

    monkeypatch.setattr("garmentcad.solve.dynamics.SmallMotion", Counted)
    cloth = small_cloth()
    state = State(hanging(cloth), np.zeros((cloth.particle_count, 3)))
    dynamics = dynamics_of(cloth, None, 0.0, materials())
    dynamics.measured = True
    dynamics.start(state)
    dynamics.advance(state, 8 * STEPS_PER_ESTIMATE)
    assert len(measured) < 5
    state.positions += [0.5, 0.0, 0.0]
    state.contact["stiff_wait"][1] = state.step + 1
    known = len(measured)
    dynamics.estimate_time_step(state)
    assert len(measured) == known
    before = state.time_step_s
    # tension of KES curves is stiffer where cloth is stretched
    state.positions *= [1.05, 1.05, 1.0]
    dynamics.estimate_time_step(state)
    assert len(measured) == known + 1
    assert state.time_step_s < 0.9 * before
    # and what waits is looked at when its time is up
    state.positions += [0.5, 0.0, 0.0]
    state.contact["stiff_wait"][1] = state.step
    dynamics.estimate_time_step(state)
    assert len(measured) == known + 2


@pytest.mark.parametrize("between", [0, 1, 3])
def test_only_cuts_in_a_row_end_a_run(monkeypatch: pytest.MonkeyPatch, between: int) -> None:
    """Every step is cut, or every second, or every fourth."""
    cloth = rectangle_cloth(60.0, 40.0, 10.0, 20.0, linear_fabric())
    state = State(hanging(cloth), np.zeros((cloth.particle_count, 3)))
    dynamics = dynamics_of(cloth, None, 0.0, linear_fabric())
    dynamics.start(state)

    def steps(order, controls, forces, stiff, sums, bonds, limit, contact, clock):  # type: ignore[no-untyped-def]
        clock[:] = min(order[0], between + 1), 0.0, 0.0, -1.0, 0.5, 0.0
        return CUT if order[0] > between else DONE

    monkeypatch.setattr("garmentcad.solve.dynamics.run_steps", steps)
    if between:
        dynamics.advance(state, 3 * MOST_CUTS * (between + 1))
        assert dynamics.cut_steps > MOST_CUTS
    else:
        with pytest.raises(IntersectingError, match="20 steps in a row"):
            dynamics.advance(state, 3 * MOST_CUTS)
        assert dynamics.cut_steps == MOST_CUTS


def test_what_another_process_compiles_is_what_the_steps_call(monkeypatch: pytest.MonkeyPatch) -> None:
    """For other types of arguments it would be compiled in vain, and nobody would see it but by the clock."""
    cloth = rectangle_cloth(60.0, 40.0, 10.0, 20.0, linear_fabric())
    state = State(hanging(cloth), np.zeros((cloth.particle_count, 3)))
    dynamics = dynamics_of(cloth, None, 0.0, linear_fabric())
    dynamics.start(state)
    dynamics.advance(state, 1)
    wanted: list[tuple[Any, tuple[Any, ...]]] = []
    monkeypatch.setattr("garmentcad.solve.dynamics.compile_beside", lambda *kernels: wanted.extend(kernels))
    dynamics._compile_beside()
    assert len(wanted) == 4
    for kernel, arguments in wanted:
        assert tuple(map(numba.typeof, arguments)) in kernel.overloads, kernel


@pytest.mark.parametrize("equalise", [False, True])
def test_hanging_strip_stretches_by_theory_and_comes_to_rest(equalise: bool) -> None:
    """Stretch of a strip under its weight: W g L^2/(2 Y) (PHYSICS 5), whatever masses slow its border down."""
    materials = linear_fabric()
    length = 0.2
    cloth = rectangle_cloth(50.0, 200.0, 10.0, 0.0, materials)
    positions = hanging(cloth)
    fixed = positions[:, 1] > length - 1e-6
    dynamics = dynamics_of(cloth, fixed, 60.0, materials)
    dynamics.equalise = equalise
    state = State(positions, np.zeros_like(positions))
    dynamics.start(state)
    patch = patches(cloth)
    assert residual(dynamics, state, patch).rms_g > 0.5  # it has just been let go
    before = state.positions.copy()
    dynamics.advance(state, 12000)
    left = residual(dynamics, state, patch)
    assert left.at_rest
    assert left.rms_g < RESIDUAL_G
    low = before[:, 1] < 1e-9
    sunk = float(np.mean((before - state.positions)[low, 1]))
    assert sunk == pytest.approx(MASS * GRAVITY_M_S2 * length**2 / (2.0 * STIFFNESS), rel=0.03)


def test_strain_limit_stops_a_link_at_its_limit() -> None:
    materials = linear_fabric(limit=0.1)
    cloth = rectangle_cloth(50.0, 50.0, 10.0, 0.0, materials)
    positions = hanging(cloth)
    velocities = np.zeros_like(positions)
    right = positions[:, 0] > 0.035
    velocities[right, 0] = 60.0
    inverse_masses = 1.0 / cloth.masses
    momentum = (cloth.masses[:, None] * velocities).sum(axis=0)
    limit, dt = strain_limit(cloth, materials), 1e-4
    assert least_headroom(positions, limit)[0] == pytest.approx(0.1 * 0.01)
    pull_back(positions, limit, inverse_masses, dt, velocities)
    ends = cloth.links.ends
    ahead = positions + dt * velocities
    stretched = np.linalg.norm(ahead[ends[:, 1]] - ahead[ends[:, 0]], axis=1) / cloth.links.rest_length - 1.0
    assert stretched.max() <= 0.1 + 1e-3
    assert np.allclose((cloth.masses[:, None] * velocities).sum(axis=0), momentum, rtol=1e-12)


def test_a_link_that_is_too_long_comes_back_no_faster_than_it_may() -> None:
    materials = linear_fabric(limit=0.1)
    cloth = rectangle_cloth(50.0, 50.0, 10.0, 0.0, materials)
    positions = hanging(cloth)
    positions[positions[:, 0] > 0.035, 0] += 0.01
    velocities, limit, dt = np.zeros_like(positions), strain_limit(cloth, materials), 1e-4
    overshoot = -least_headroom(positions, limit)[0]
    assert overshoot == pytest.approx(0.009)
    pull_back(positions, limit, 1.0 / cloth.masses, dt, velocities)
    ends = cloth.links.ends
    along = np.einsum("lc,lc->l", velocities[ends[:, 1]] - velocities[ends[:, 0]], positions[ends[:, 1]] - positions[ends[:, 0]])
    closing = -(along / np.linalg.norm(positions[ends[:, 1]] - positions[ends[:, 0]], axis=1)).min()
    assert closing == pytest.approx(RETURN_M_S, rel=1e-3)


def test_a_torn_link_is_caught_with_its_place() -> None:
    materials = linear_fabric(limit=0.1)
    cloth = rectangle_cloth(50.0, 50.0, 10.0, 0.0, materials)
    state = State(hanging(cloth), np.zeros((cloth.particle_count, 3)))
    dynamics = dynamics_of(cloth, None, 0.0, materials)
    dynamics.start(state)
    dynamics.step_factor = 0.1  # or the pull of the link is caught first, by the speed it makes
    state.positions[state.positions[:, 0] > 0.035, 0] += 0.02
    with pytest.raises(DivergedError, match=r"panel 'rectangle' at \(\d+, \d+\) mm .* came apart: a link is over 2 times .* step 0"):
        dynamics.advance(state, 1)


def test_same_bits_on_any_number_of_threads() -> None:
    materials = linear_fabric()
    cloth = rectangle_cloth(150.0, 150.0, 10.0, 30.0, materials)
    found = set()
    for threads in (1, 2):
        if threads > numba.config.NUMBA_NUM_THREADS:
            continue
        numba.set_num_threads(threads)
        positions = hanging(cloth) + 1e-4 * np.random.default_rng(5).standard_normal((cloth.particle_count, 3))
        dynamics = dynamics_of(cloth, positions[:, 1] > 0.149, 2.0, materials)
        dynamics.equalise = True
        state = State(positions, np.zeros_like(positions))
        dynamics.start(state)
        dynamics.advance(state, 300)
        found.add(state.sha256())
    assert len(found) == 1


def test_runaway_and_nan_are_caught_with_their_place() -> None:
    materials = linear_fabric()
    cloth = rectangle_cloth(50.0, 50.0, 10.0, 0.0, materials)
    for bad in (2.0 * RUNAWAY_M_S, np.nan):
        state = State(hanging(cloth), np.zeros((cloth.particle_count, 3)))
        dynamics = dynamics_of(cloth, None, 0.0, materials)
        dynamics.start(state)
        state.velocities[7, 1] = bad
        with pytest.raises(DivergedError) as caught:
            dynamics.advance(state, 1)
        u, v = cloth.vertex_uv_mm[7]
        assert f"panel 'rectangle' at ({u:.0f}, {v:.0f}) mm" in str(caught.value)


def test_a_push_without_motion_and_a_motion_by_push_alone_are_no_unrest() -> None:
    """A sheet that lies 0.4 mm too deep on a table: contact lifts it gently, which alone is no unrest; its weight, not held by the lift, would be."""
    materials = linear_fabric()
    cloth = rectangle_cloth(40.0, 40.0, 10.0, 0.0, materials)
    table = trimesh.creation.box(extents=(0.2, 0.02, 0.2))
    flat = np.column_stack([cloth.vertex_uv_mm[:, 0] * 1e-3 - 0.02, np.full(cloth.particle_count, 0.0106), 0.02 - cloth.vertex_uv_mm[:, 1] * 1e-3])
    contact = Contact(cloth, materials, (np.asarray(table.vertices), np.asarray(table.faces)))
    for lifted, expected in ((0.0, 0.0), (0.1, 1.0)):
        forces = ForceAssembly(internal_forces(cloth, materials), cloth.particle_count, [ForceGravity(cloth.masses)])
        state = State(flat + np.array([0.0, lifted, 0.0]), np.zeros_like(flat))
        dynamics = Dynamics(cloth, forces, strain_limit(cloth, materials), contact)
        dynamics.start(state)
        assert residual(dynamics, state, patches(cloth)).rms_g == pytest.approx(expected, abs=1e-9)


def test_the_speed_cap_holds_against_forces_and_keeps_their_direction() -> None:
    materials = linear_fabric()
    cloth = rectangle_cloth(40.0, 40.0, 10.0, 0.0, materials)
    dynamics = dynamics_of(cloth, None, 0.0, materials)
    dynamics.speed_cap_m_s = 0.5
    state = State(hanging(cloth), np.tile([0.3, 0.0, 0.0], (cloth.particle_count, 1)))
    dynamics.start(state)
    dynamics.advance(state, 2000)
    assert np.linalg.norm(state.velocities, axis=1) == pytest.approx(0.5, rel=1e-9)
    assert (state.velocities[:, 1] < 0.0).all()
    assert (state.velocities[:, 0] > 0.0).all()


class _Pulls:
    """A force whose corners are those of some particles: all that a sum asks for."""

    def __init__(self, name: str, corners: np.ndarray) -> None:
        self.name, self.corners = name, corners


def test_velocities_are_those_of_the_sum_of_all_forces() -> None:
    """Two forces on 301 particles, the first with a row for each of most of them. Added up by numpy; inertia differs across a direction of each particle."""
    count, rng = 301, np.random.default_rng(11)
    own = np.where(rng.random(count) < 0.8, np.arange(count), -1).astype(np.int32)
    # in two places, as along seams: most particles have one row
    others = np.concatenate([rng.integers(20, 50, 400), rng.integers(200, 230, 90)]).astype(np.int32)
    masses, drag, across = frozen(0.5 + rng.random(count)), 10.0 * rng.random(count), rng.standard_normal((count, 3))
    sums = ForceAssembly([_Pulls("lattice", own), _Pulls("border", others)], count, [ForceGravity(masses)]).sums(masses)
    assert 0 < len(sums.mixed) < 150
    before, dt, none = rng.standard_normal((count, 3)), 1e-3, np.zeros((count, 3))
    before[::50] = 0.0
    corners, used = np.concatenate([own, others]), np.concatenate([own, others]) >= 0
    for forces in (rng.standard_normal((len(corners), 3)) for _ in range(2)):
        # forces write their own rows anew; in those of particles that are not the first one's stands what was added up before
        sums.corner_forces[used] = forces[used]
        force = np.zeros((count, 3))
        np.add.at(force, corners[used], forces[used])
        force[:, 1] -= GRAVITY_M_S2 * masses
        force += across * (across * force).sum(axis=1)[:, None]
        inverse = np.where(np.arange(count) % 10 == 0, 0.0, 1.0 / masses)
        expected = np.where(inverse[:, None] > 0.0, (1.0 - dt * drag[:, None]) * before + dt * inverse[:, None] * force, before)
        velocities, out = before.copy(), np.zeros((CHUNKS, 2))
        planes, free = fresh_planes(none, False), np.zeros(count, np.int8)
        advance_velocities(sums, (dt, math.inf), (drag, inverse, across), planes, np.zeros(count), free, none, velocities, out)
        assert velocities == pytest.approx(expected, rel=1e-12, abs=1e-15)
        assert out[:, 0].max() == pytest.approx((expected**2).sum(axis=1).max(), rel=1e-12)


@pytest.mark.parametrize("wrong", [math.nan, -math.nan, math.inf, -math.inf])
def test_a_speed_that_is_no_number_does_not_hide(wrong: float) -> None:
    forces, out = np.zeros((5, 3)), np.zeros((CHUNKS, 2))
    forces[3, 1] = wrong
    none = np.zeros(0, np.int32), np.zeros(CHUNKS + 1, np.int32)
    sums = Sums(np.arange(6, dtype=np.int32), np.arange(5, dtype=np.int32), *none, forces, np.zeros(5), frozen(np.ones(5)))
    places, inertia = np.zeros((5, 3)), (np.zeros(5), np.ones(5), np.zeros((5, 3)))
    advance_velocities(sums, (1e-3, math.inf), inertia, fresh_planes(places, False), np.zeros(5), np.zeros(5, np.int8), places, np.zeros((5, 3)), out)
    assert out[:, 0].max() == math.inf


@pytest.mark.parametrize("wrong", [math.nan, -math.nan, math.inf, 3.0])
def test_contact_tells_the_fastest_of_what_is_near_nothing(wrong: float) -> None:
    """All particles are far from any body; the fixed one counts as well."""
    cloth = rectangle_cloth(50.0, 50.0, 10.0, 0.0, materials())
    for place, inverse_mass in ((7, 1.0), (7, 0.0)):
        contact = Contact(cloth, materials())
        state = contact.blank()
        surface, tree, largest, grip, planes, _, _, pace, out, _ = contact.arguments(state)
        planes.due[:] = math.inf
        velocities, inverse_masses = np.full((cloth.particle_count, 3), 0.1), np.full(cloth.particle_count, 1.0)
        velocities[place], inverse_masses[place] = [0.0, wrong, 0.0], inverse_mass
        respond_planes(surface, tree, largest, planes, grip, state.positions, velocities, inverse_masses, 1e-4, pace, out)
        assert out[:, 1].max() == (9.0 if wrong == 3.0 else math.inf)
        assert grip.near.any() == (wrong != 3.0 and inverse_mass > 0.0), "what may go anywhere is not sifted out"


def test_the_cap_leaves_what_the_body_takes_and_nothing_else() -> None:
    """Six particles of 1 kg near a floor, friction 0.2, steps of 1 ms, cap 1 m/s: pressed where it lies, 3 mm above, and 3 mm above on something between; drawn
    along and down, by more than the cap and what friction can take, and by less; lifted."""
    forces = np.array([[0.0, -50e3, 0.0], [0.0, -50e3, 0.0], [0.0, -50e3, 0.0], [30e3, -40e3, 0.0], [7e3, -40e3, 0.0], [0.0, 50e3, 0.0]])
    positions, planes = np.zeros((6, 3)), fresh_planes(np.zeros((6, 3)), False)
    planes.held[:], planes.normal[:, 0], planes.room[1:3, 0] = 1, [0.0, 1.0, 0.0], 3e-3
    none = np.zeros(0, np.int32), np.zeros(CHUNKS + 1, np.int32)
    sums = Sums(np.arange(7, dtype=np.int32), np.arange(6, dtype=np.int32), *none, forces, np.zeros(6), frozen(np.ones(6)))
    velocities, out = np.zeros((6, 3)), np.zeros((CHUNKS, 2))
    pressed, inertia = np.array([0, 0, 1, 0, 0, 0], np.int8), (np.zeros(6), np.ones(6), np.zeros((6, 3)))
    advance_velocities(sums, (1e-3, 1.0), inertia, planes, np.full(6, 0.2), pressed, positions, velocities, out)
    expected = np.array([[0.0, -50.0, 0.0], [0.0, -1.0, 0.0], [0.0, -50.0, 0.0], [9.0, -40.0, 0.0], [7.0, -40.0, 0.0], [0.0, 1.0, 0.0]])
    assert velocities == pytest.approx(expected, abs=1e-12)
    assert math.sqrt(out[:, 0].max()) == pytest.approx(math.sqrt(2.0)), "what contact takes is no speed"


def test_the_speed_cap_takes_nothing_from_what_presses_on_a_body() -> None:
    """A sheet with a fixed border, 3 mm over the tip of a cone: what tension adds in a step to the corners over the tip is above the cap, each by another
    factor, and contact takes it all. At rest the forces of all corners balance, not the capped ones. It comes down at the cap, which takes 1.5 s."""
    materials = linear_fabric()
    cloth = rectangle_cloth(80.0, 80.0, 10.0, 0.0, materials)
    u, v = (cloth.vertex_uv_mm * 1e-3 - 0.04).T
    cone = trimesh.creation.cone(radius=0.02, height=0.04, sections=16)
    tip = np.asarray(cone.vertices)[:, [0, 2, 1]] + [0.002, -0.037, 0.0035]
    contact = Contact(cloth, materials, (tip, np.asarray(cone.faces)[:, ::-1]))
    border = np.maximum(abs(u), abs(v)) > 0.0399
    apart = np.hypot(u - 0.002, v + 0.0035)
    flat = np.column_stack([u, np.where(border, 0.0, 0.006 * np.clip(1.0 - apart / 0.04, 0.0, 1.0)), -v])
    forces = ForceAssembly(internal_forces(cloth, materials), cloth.particle_count, [ForceGravity(cloth.masses)])
    dynamics = Dynamics(cloth, forces, strain_limit(cloth, materials), contact, border)
    dynamics.drag, dynamics.speed_cap_m_s = 100.0, 2e-3
    state = State(flat, np.zeros_like(flat))
    dynamics.start(state)
    dynamics.advance(state, 36000)
    pressed = np.linalg.norm(dynamics.net_forces(state) / cloth.masses[:, None], axis=1)[~border].max() * state.time_step_s
    assert pressed > 2.0 * dynamics.speed_cap_m_s
    assert residual(dynamics, state, patches(cloth)).rms_g < 0.02


@pytest.mark.parametrize("measured", [False, True])
@pytest.mark.parametrize("equalise", [False, True])
def test_where_all_is_held_steps_are_taken_all_the_same(measured: bool, equalise: bool) -> None:
    fabric = linear_fabric()
    cloth = rectangle_cloth(60.0, 40.0, 10.0, 0.0, fabric)
    state = State(hanging(cloth), np.zeros((cloth.particle_count, 3)))
    dynamics = dynamics_of(cloth, np.ones(cloth.particle_count, dtype=bool), 0.0, fabric)
    dynamics.measured, dynamics.equalise = measured, equalise
    dynamics.start(state)
    dynamics.advance(state, 3)
    assert 0.0 < state.time_s < 1.0
    assert np.array_equal(state.positions, hanging(cloth))


@pytest.mark.parametrize("gap_m", [math.nan, 1e3])
def test_what_a_condition_throws_after_the_forces_ends_the_run(gap_m: float) -> None:
    """A pin whose place is no number, or a kilometre away: looks for candidates would go on for ever, as none covers such a way."""
    fabric = linear_fabric()
    cloth = rectangle_cloth(100.0, 100.0, 10.0, 0.0, fabric)
    state = State(hanging(cloth), np.zeros((cloth.particle_count, 3)))
    dynamics = dynamics_of(cloth, None, 0.0, fabric)
    top = int(np.argmax(state.positions[:, 1]))
    rows = PointRows.plain(np.array([0]), np.array([top]), np.array([1.0]), state.positions[top][None] + [0.0, 0.0, gap_m], ("pin",))
    dynamics.constraint = ConstraintPoints(rows, dynamics.inverse_masses, 1000.0, np.inf, nodes=dynamics.contact.nodes)
    state.constraint_speeds, state.constraint_forces = np.zeros((1, 3)), np.zeros((1, 3))
    dynamics.start(state)
    looks: list[int] = []
    found = dynamics.contact._find_pairs

    def counted(state: State, reserve_m: float) -> None:
        looks.append(state.step)
        if len(looks) > 50:
            raise RuntimeError("no end of looks")
        found(state, reserve_m)

    dynamics.contact._find_pairs = counted  # type: ignore[method-assign]
    with pytest.raises(DivergedError, match="the limit is"):
        dynamics.advance(state, 96)


def test_cut_steps_in_a_row_are_counted_in_the_state(monkeypatch: pytest.MonkeyPatch) -> None:
    """A run that is resumed between them ends at the same step."""
    fabric = linear_fabric()
    cloth = rectangle_cloth(60.0, 40.0, 10.0, 0.0, fabric)

    def cut(*arguments: Any) -> int:
        clock = arguments[-1]
        clock[:] = [1.0, 0.0, 0.0, -1.0, 0.5, 0.0]
        return CUT

    def fresh() -> Dynamics:
        return dynamics_of(cloth, None, 0.0, fabric)

    state = State(hanging(cloth), np.zeros((cloth.particle_count, 3)))
    first = fresh()
    first.start(state)
    monkeypatch.setattr("garmentcad.solve.dynamics.run_steps", cut)
    first.advance(state, MOST_CUTS - 3)
    resumed = fresh()
    with pytest.raises(IntersectingError):
        resumed.advance(state, MOST_CUTS)
    assert state.step == MOST_CUTS
