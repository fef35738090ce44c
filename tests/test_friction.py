"""Coulomb friction against theory, by the stepper of every run: the incline, on a body and on cloth, and the belt around a fixed cylinder."""

from __future__ import annotations

import math

import numpy as np
import pytest
import trimesh
from drawn import pattern, rectangle
from elastic import linear

from garmentcad.cloth.cloth import Cloth
from garmentcad.cloth.lattice import build_cloth, rectangle_cloth
from garmentcad.cloth.state import State
from garmentcad.contact.contact import Contact
from garmentcad.fabric.material import MaterialTable
from garmentcad.forces.assembly import ForceAssembly
from garmentcad.forces.gravity import ForceGravity
from garmentcad.forces.internal import internal_forces
from garmentcad.simulation.course import UNCUT_M_S
from garmentcad.solve.dynamics import RUNAWAY_M_S, DivergedError, Dynamics
from garmentcad.solve.strain_limit import strain_limit
from garmentcad.units import GRAVITY_M_S2

MU = 0.35
SLIP_DEG = math.degrees(math.atan(MU))
OFFSET_DEG = 0.25  # on both sides of SLIP_DEG
GAP = 1e-3


def fabric(tension_n_m: float) -> MaterialTable:
    return linear(0.15, tension_n_m, limit=0.4, shear=0.02 * tension_n_m, thickness=5e-4, friction=MU)


def moved(cloth: Cloth, materials: MaterialTable, weights: np.ndarray, body: tuple[np.ndarray, np.ndarray] | None, fixed: np.ndarray | None = None) -> Dynamics:
    """weights: (P,) kg, what gravity pulls."""
    forces = ForceAssembly(internal_forces(cloth, materials), cloth.particle_count, [ForceGravity(weights)])
    return Dynamics(cloth, forces, strain_limit(cloth, materials), Contact(cloth, materials, body), fixed)


def advance(dynamics: Dynamics, state: State, seconds: float) -> None:
    end = state.time_s + seconds
    while state.time_s < end - 1e-9:
        dynamics.advance(state, min(96, math.ceil((end - state.time_s) / state.time_step_s)))


def tilted(degrees: float) -> np.ndarray:
    """Rotation about z; the slope falls toward -x."""
    angle = math.radians(degrees)
    return np.array([[math.cos(angle), -math.sin(angle), 0.0], [math.sin(angle), math.cos(angle), 0.0], [0.0, 0.0, 1.0]])


def slid(degrees: float, state: State) -> float:
    """Way of a block from rest, m: velocity first, then position."""
    angle = math.radians(degrees)
    return 0.5 * GRAVITY_M_S2 * (math.sin(angle) - MU * math.cos(angle)) * state.time_s * (state.time_s + state.time_step_s)


def strip_on_plate(degrees: float, seconds: float, cap_m_s: float = math.inf) -> tuple[np.ndarray, State, Cloth]:
    """Way of each particle down a plate of many triangles, m, of a strip whose grain is askew to it. cap_m_s: forces make no particle faster."""
    turn, materials = tilted(degrees), fabric(60.0)
    cloth = rectangle_cloth(60.0, 30.0, 10.0, 17.0, materials)
    u, v = 1e-3 * cloth.vertex_uv_mm.T
    plate = trimesh.creation.box(extents=(0.5, 0.1, 0.5)).subdivide().subdivide().subdivide()
    start = np.column_stack([u, np.full(len(u), 0.05 + GAP), -v]) @ turn.T
    state = State(start.copy(), np.zeros_like(start))
    dynamics = moved(cloth, materials, cloth.masses, (plate.vertices @ turn.T, plate.faces))
    dynamics.speed_cap_m_s = cap_m_s
    dynamics.start(state)
    advance(dynamics, state, seconds)
    return (start - state.positions) @ turn[:, 0], state, cloth


def test_strip_on_a_plate_sticks_below_the_angle_of_friction() -> None:
    """Not even slowly: nothing in 20 s."""
    way, state, _ = strip_on_plate(SLIP_DEG - OFFSET_DEG, 20.0)
    assert np.abs(way).max() < 1e-9
    assert state.work_j["friction"] == pytest.approx(0.0, abs=1e-15)


def test_strip_on_a_plate_slides_above_it_as_coulomb_says() -> None:
    """Over the edges between the plate's triangles, too: they are no bumps."""
    degrees = SLIP_DEG + OFFSET_DEG
    way, state, cloth = strip_on_plate(degrees, 1.0)
    assert way == pytest.approx(slid(degrees, state), rel=1e-6)
    pressed = float(cloth.masses.sum()) * GRAVITY_M_S2 * math.cos(math.radians(degrees))
    assert state.work_j["friction"] == pytest.approx(-MU * pressed * slid(degrees, state), rel=1e-6)


@pytest.mark.parametrize("offset", [-OFFSET_DEG, OFFSET_DEG])
def test_friction_holds_no_more_where_speeds_are_capped(offset: float) -> None:
    """Weight alone leads to more than twice the cap in each step. Cut to that it would be held on this slope, and on steeper ones."""
    cap = 2e-4
    way, state, _ = strip_on_plate(SLIP_DEG + offset, 0.3, cap)
    assert GRAVITY_M_S2 * math.sin(math.radians(SLIP_DEG)) * state.time_step_s > 2.0 * cap
    if offset < 0.0:
        assert np.abs(way).max() < 1e-9
    else:
        assert way == pytest.approx(cap * state.time_s, rel=0.05)


@pytest.mark.parametrize("cap", [UNCUT_M_S, math.inf])
def test_what_presses_on_a_body_is_no_run_that_diverges_where_speeds_are_capped(cap: float) -> None:
    """A load that would lead to more in one step than a run may reach, as that of a taut elastic."""
    materials = fabric(60.0)
    cloth = rectangle_cloth(60.0, 30.0, 10.0, 0.0, materials)
    u, v = 1e-3 * cloth.vertex_uv_mm.T
    plate = trimesh.creation.box(extents=(0.5, 0.1, 0.5))
    state = State(np.column_stack([u, np.full(len(u), 0.05 + GAP), -v]), np.zeros((len(u), 3)))
    dynamics = moved(cloth, materials, 1e5 * cloth.masses, (plate.vertices, plate.faces))
    dynamics.speed_cap_m_s, start = cap, state.positions.copy()
    dynamics.start(state)
    assert 1e5 * GRAVITY_M_S2 * state.time_step_s > RUNAWAY_M_S
    if cap == math.inf:
        with pytest.raises(DivergedError):
            dynamics.advance(state, 20)
    else:
        dynamics.advance(state, 20)
        assert state.positions == pytest.approx(start, abs=1e-5)


@pytest.mark.parametrize(("offset", "sticks"), [(-OFFSET_DEG, True), (OFFSET_DEG, False)])
def test_cloth_on_a_held_cloth(offset: float, sticks: bool) -> None:
    """The upper cloth's particles stand anywhere in the lower one's triangles."""
    turn, materials = tilted(SLIP_DEG + offset), fabric(60.0)
    cloth = build_cloth(pattern(rectangle(150, 80, name="lower"), rectangle(40, 30, 23.0, "upper")), lambda _, at: np.zeros(len(at), int), materials)
    u, v = 1e-3 * cloth.vertex_uv_mm.T
    upper = cloth.vertex_panel == 1
    start = np.column_stack([u, np.zeros(len(u)), -v])
    start[upper] += [0.06, GAP, -0.025]
    start = start @ turn.T
    state = State(start.copy(), np.zeros_like(start))
    dynamics = moved(cloth, materials, cloth.masses, None, ~upper)
    dynamics.start(state)
    advance(dynamics, state, 3.0 if sticks else 0.5)
    way = ((start - state.positions) @ turn[:, 0])[upper]
    if sticks:
        assert np.abs(way).max() < 1e-7
    else:
        assert way == pytest.approx(slid(SLIP_DEG + offset, state), rel=0.1)


class Belt:
    """A strip laid over a fixed cylinder, both ends hanging: the angle of wrap is pi. Only its ends carry weight; tension is that of an end, N.

    300 sides: the strip climbs their slopes of 0.6 degrees, which differ from particle to particle.
    """

    def __init__(self, tension: float) -> None:
        radius, grid, hang, width = 0.05, 0.01, 0.03, 0.02
        materials = fabric(500.0)
        around = radius + 0.6e-3 + grid**2 / (4.0 * radius)  # where contact holds it (docs/contact.md)
        length = math.pi * around + 2.0 * hang
        cloth = rectangle_cloth(1e3 * width, 1e3 * length, 1e3 * grid, 0.0, materials)
        u, v = 1e-3 * cloth.vertex_uv_mm.T
        angle = np.clip((v - 0.5 * length) / around, -0.5 * math.pi, 0.5 * math.pi)
        down = np.abs(v - 0.5 * length - around * angle)
        start = np.column_stack([around * np.sin(angle), around * np.cos(angle) - down, u - 0.5 * width])
        self.ends = [cloth.edge_vertices[f"rectangle.{end}"] for end in ("bottom", "top")]
        capsule = trimesh.creation.capsule(height=0.06, radius=radius, count=[16, 300])
        capsule.apply_translation([0.0, 0.0, -capsule.bounds[:, 2].mean()])
        self.forces = internal_forces(cloth, materials)
        self.dynamics = moved(cloth, materials, np.zeros(cloth.particle_count), (np.asarray(capsule.vertices), np.asarray(capsule.faces)))
        self.dynamics.drag = 20.0
        self.state = State(start, np.zeros_like(start))
        self.dynamics.start(self.state)
        for part in np.linspace(0.1, 1.0, 10):
            self.pull(part * tension, part * tension, 0.05)

    def pull(self, one: float, other: float, seconds: float) -> None:
        weights = np.zeros(self.dynamics.cloth.particle_count)
        for end, tension in zip(self.ends, (one, other)):
            share = np.ones(len(end))
            share[[0, -1]] = 0.5
            weights[end] += tension / GRAVITY_M_S2 * share / share.sum()
        self.dynamics.forces = ForceAssembly(self.forces, len(weights), [ForceGravity(weights)])
        advance(self.dynamics, self.state, seconds)

    def raised(self) -> float:
        """Height of the end that is pulled less, m."""
        return float(self.state.positions[self.ends[0], 1].mean())


def test_belt_slips_around_a_cylinder_at_the_ratio_of_eytelwein() -> None:
    """Tensions T2/T1 = exp(mu phi): at 3 % less nothing moves, at 3 % more the whole belt runs off."""
    tension, ratio = 0.05, math.exp(MU * math.pi)
    belt = Belt(tension)
    for part in np.linspace(1.0 / ratio, 0.97, 60):
        belt.pull(tension, part * ratio * tension, 0.02)
    belt.pull(tension, 0.97 * ratio * tension, 0.3)
    before = belt.raised()
    belt.pull(tension, 0.97 * ratio * tension, 0.5)
    assert abs(belt.raised() - before) < 1e-6
    for part in np.linspace(0.97, 1.03, 20):
        belt.pull(tension, part * ratio * tension, 0.02)
    before = belt.raised()
    belt.pull(tension, 1.03 * ratio * tension, 0.2)
    assert belt.raised() - before > 5e-3
