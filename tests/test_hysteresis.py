"""Internal friction in motion: strips that stick, loops of whole cloths, energy, the same bits on any number of threads and through a checkpoint."""

from __future__ import annotations

import math
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from command import printed_on_threads
from elastic import linear

from garmentcad.arrays import floats
from garmentcad.cloth.cloth import Cloth
from garmentcad.cloth.lattice import rectangle_cloth
from garmentcad.cloth.state import State
from garmentcad.contact.contact import Contact
from garmentcad.fabric.law_bending import STICK
from garmentcad.fabric.law_shear import stick_way
from garmentcad.fabric.material import MaterialTable
from garmentcad.forces.assembly import ForceAssembly
from garmentcad.forces.gravity import ForceGravity
from garmentcad.forces.internal import internal_forces, soften
from garmentcad.simulation.checkpoint import load_state, save_state
from garmentcad.simulation.course import Course
from garmentcad.solve.dynamics import Dynamics
from garmentcad.solve.strain_limit import strain_limit
from garmentcad.units import GRAVITY_M_S2

MASS, BENDING, HOLD = 0.15, 1e-4, 1.5e-3  # kg/m2, N.m, H of bending N: B = 1 gf.cm2/cm, 2HB = 0.31 gf.cm/cm


def fabric(hold: float = HOLD, shear: float = 0.6, tension: float = 0.2) -> MaterialTable:
    """Internal friction of bending [N], shear (H at 5 degrees, two thirds of it at half a degree) [N/m] and tension (c)."""
    both = floats([[1.0, 1.0]])
    limits = shear * floats([[2.0 / 3.0, 1.0]])
    return linear(MASS, 600.0, limit=0.4, shear=30.0, thickness=5e-4, friction=0.3, bending=BENDING)._replace(
        bending_friction=hold * both, tension_friction=tension * both, shear_friction=limits, shear_way=floats([stick_way(*limits[0], 30.0)]),
    )  # fmt: skip


def moving(cloth: Cloth, materials: MaterialTable, fixed: np.ndarray, gravity: float = GRAVITY_M_S2, drag: float = 20.0) -> Dynamics:
    forces = ForceAssembly(internal_forces(cloth, materials), cloth.particle_count, [ForceGravity(cloth.masses, gravity)])
    dynamics = Dynamics(cloth, forces, strain_limit(cloth, materials), Contact(cloth, materials), fixed)
    dynamics.drag = drag
    return dynamics


def lying(cloth: Cloth) -> np.ndarray:
    """Weft to x, warp to -z, right side up."""
    uv = cloth.vertex_uv_mm * 1e-3
    return np.column_stack([uv[:, 0], np.zeros(len(uv)), -uv[:, 1]])


def droop(hold: float) -> tuple[float, float]:
    """Of a strip with two fixed columns, between which lies the clamp, after 1 s of damped motion; over its free length, m, which comes second."""
    cloth = rectangle_cloth(50.0, 40.0, 10.0, 0.0, fabric(hold))
    positions = lying(cloth)
    columns = np.unique(positions[:, 0].round(9))
    held, tip = positions[:, 0] < columns[1] + 1e-6, positions[:, 0] > columns[-1] - 1e-6
    length = float(columns[-1] - columns[:2].mean())
    dynamics = moving(cloth, fabric(hold), held)
    state = State(positions, np.zeros_like(positions))
    dynamics.start(state)
    while state.time_s < 1.0:
        dynamics.advance(state, 400)
    return -float(state.positions[tip, 1].mean()) / length, length


def test_a_strip_shorter_than_its_friction_holds_hardly_droops() -> None:
    """W g L^2/2 < H, L = sqrt(2HB/(W g)): nothing slides, and the stick spring leaves 1/(1 + STICK) of the elastic droop, Gamma/8."""
    elastic, length = droop(0.0)
    assert length < math.sqrt(2.0 * HOLD / (MASS * GRAVITY_M_S2))
    gamma = MASS * GRAVITY_M_S2 * length**3 / BENDING
    assert gamma > 0.5
    assert 0.7 * gamma / 8.0 < elastic < gamma / 8.0
    assert droop(HOLD)[0] == pytest.approx(elastic / (1.0 + STICK), rel=0.2)


def bent(cloth: Cloth, curvature: float) -> np.ndarray:
    uv = cloth.vertex_uv_mm * 1e-3
    angle = curvature * uv[:, 0]
    if abs(curvature) < 1e-9:
        return lying(cloth)
    return np.column_stack([np.sin(angle) / curvature, (1.0 - np.cos(angle)) / curvature, -uv[:, 1]])


def test_a_strip_bent_far_keeps_its_residual_curvature_and_does_not_creep() -> None:
    materials = fabric(shear=0.0, tension=0.0)
    cloth = rectangle_cloth(80.0, 50.0, 10.0, 0.0, materials)
    # slowly: a strip that swings past its residual curvature sticks below it
    dynamics = moving(cloth, materials, np.zeros(cloth.particle_count, dtype=bool), gravity=0.0, drag=300.0)
    state = State(bent(cloth, 0.0), np.zeros((cloth.particle_count, 3)))
    dynamics.start(state)
    for curvature in np.linspace(0.0, 60.0, 401):
        state.positions[:] = bent(cloth, curvature)
        dynamics.forces.add_up(state.positions, np.zeros_like(state.velocities), np.zeros_like(state.velocities), state.friction)
    while state.time_s < 1.5:
        dynamics.advance(state, 400)
    left = shape_curvature(cloth, state)
    assert 0.9 * HOLD / BENDING < left <= 1.03 * HOLD / BENDING  # 2HB/(2 B), on seven links and by three points
    sliders, shape = {name: held.copy() for name, held in state.friction.items()}, state.positions.copy()
    while state.time_s < 2.5:
        dynamics.advance(state, 400)
    assert np.abs(state.positions - shape).max() < 1e-6
    assert all(np.allclose(state.friction[name], held, rtol=0.0, atol=1e-9) for name, held in sliders.items())


def shape_curvature(cloth: Cloth, state: State) -> float:
    """1/m, from the chord between three columns of the strip: ends and middle."""
    uv = cloth.vertex_uv_mm
    ends = [state.positions[np.abs(uv[:, 0] - place) < 5.1].mean(axis=0) for place in (10.0, 40.0, 70.0)]
    a, b, c = (np.linalg.norm(p - q) for p, q in ((ends[0], ends[1]), (ends[1], ends[2]), (ends[2], ends[0])))
    half = 0.5 * (a + b + c)
    return float(4.0 * math.sqrt(half * (half - a) * (half - b) * (half - c)) / (a * b * c))


@pytest.mark.parametrize("kind", ["shear", "bending", "tension"])
def test_loops_of_a_whole_cloth(kind: str) -> None:
    """Work that a closed path of the whole cloth takes is the loop's area times the cloth's, whatever carries it: lattice, border, contour lines."""
    materials = fabric()
    cloth = rectangle_cloth(83.0, 64.0, 10.0, 0.0, materials)
    forces = ForceAssembly(internal_forces(cloth, materials), cloth.particle_count)
    uv, area = cloth.vertex_uv_mm * 1e-3, 83.0 * 64.0 * 1e-6
    largest = {"shear": math.radians(12.0), "bending": 60.0, "tension": 0.15}[kind]

    def placed(strain: float) -> np.ndarray:
        if kind == "bending":
            return bent(cloth, strain)
        flat = np.column_stack([uv, np.zeros(len(uv))])
        if kind == "tension":
            return flat * [1.0 + strain, 1.0, 1.0]
        return np.column_stack([uv[:, 0] + math.sin(strain) * uv[:, 1], math.cos(strain) * uv[:, 1], np.zeros(len(uv))])

    sliders = forces.slack()
    still, found = np.zeros_like(placed(0.0)), np.zeros_like(placed(0.0))
    turn = np.linspace(0.0, 1.0, 301)
    one = [turn, turn[::-1]] if kind == "tension" else [turn, turn[::-1], -turn, -turn[::-1]]
    path = largest * np.concatenate(one + one)
    work, before, pull, begin = 0.0, placed(0.0), None, len(path) // 2
    for k, strain in enumerate(path):
        here = placed(float(strain))
        forces.add_up(here, still, found, sliders)
        if k > begin:
            work -= float(np.sum(0.5 * (found + pull) * (here - before)))
        before, pull = here, found.copy()
    if kind == "bending":
        way = HOLD / (STICK * BENDING)
        expected = 4.0 * HOLD * (largest - way)
    elif kind == "tension":
        f, c = 600.0, 0.2  # linear F; the loop between F and (1 - 2c) F, less what the two turns cut off
        expected = loop_area(lambda e, s: tension_stress(e, s, f, c), largest)
    else:
        expected = loop_area(shear_stress, largest, both_ways=True)
    assert work == pytest.approx(expected * area, rel=0.02)


def tension_stress(strain: float, slider: float, stiffness: float, c: float) -> tuple[float, float]:
    way = 0.1 * 0.2
    slider = min(max(slider, strain - way), strain + way)
    return stiffness * strain * (1.0 - c + c * (strain - slider) / way), slider


def shear_stress(angle: float, slider: float) -> tuple[float, float]:
    limit = 0.4 + 0.2 * min(max((math.degrees(abs(angle)) - 0.5) / 4.5, 0.0), 1.0)
    way = 0.4 / (10.0 * 30.0)
    slider = min(max(slider, angle - way), angle + way)
    return 30.0 * angle + limit * (angle - slider) / way, slider


def loop_area(law, largest: float, both_ways: bool = False) -> float:
    turn = np.linspace(0.0, 1.0, 4001)
    one = np.concatenate([turn, turn[::-1], -turn, -turn[::-1]] if both_ways else [turn, turn[::-1]])
    slider, area, before = 0.0, 0.0, None
    for k, strain in enumerate(largest * np.concatenate([one, one])):
        stress, slider = law(float(strain), slider)
        if before is not None and k >= len(one):
            area += 0.5 * (stress + before[1]) * (strain - before[0])
        before = strain, stress
    return area


def test_energy_of_a_swinging_cloth_never_grows_with_what_friction_takes() -> None:
    """Kinetic, stored and potential energy and what internal friction took, under light drag and true masses: 0.1 % of the range at most upward."""
    materials = fabric()
    cloth = rectangle_cloth(120.0, 100.0, 10.0, 15.0, materials)
    positions = lying(cloth)
    corner = (positions[:, 0] < 0.006) & (np.abs(positions[:, 2] + 0.05) > 0.044)
    dynamics = moving(cloth, materials, corner, drag=0.5)
    dynamics.step_factor = 0.5
    state = State(positions, np.zeros_like(positions))
    dynamics.start(state)
    found, taken = [], []
    while state.time_s < 0.6:
        dynamics.advance(state, 40)
        stored = sum(dynamics.forces.energy(state.positions, state.friction).values())
        taken.append(-state.work_j["internal_friction"])
        found.append(dynamics.measures(state)[0] + stored + taken[-1])
    energy = np.array(found)
    span = float(np.ptp(energy - np.array(taken)))
    assert taken[-1] > 0.05 * span
    assert np.all(np.diff(taken) >= 0.0)
    assert np.max(energy - np.minimum.accumulate(energy)) < 1e-3 * span


def falling(steps: int, tmp: Path | None = None) -> State:
    """A cloth of several blocks of rows that swings down from an edge; by way of a checkpoint in the middle where there is a folder."""
    materials = fabric()
    cloth = rectangle_cloth(600.0, 500.0, 10.0, 25.0, materials)
    positions = lying(cloth) + 1e-4 * np.random.default_rng(3).standard_normal((cloth.particle_count, 3))
    state = State(positions, np.zeros_like(positions))
    dynamics = moving(cloth, materials, positions[:, 0] < 0.006, drag=2.0)
    dynamics.start(state)
    dynamics.advance(state, steps // 2)
    if tmp is not None:
        save_state(tmp / "c.npz", state, {})
        state = load_state(tmp / "c.npz", {})
        dynamics = moving(cloth, materials, positions[:, 0] < 0.006, drag=2.0)
    dynamics.advance(state, steps - steps // 2)
    return state


def test_drape_mode_leaves_no_trace_of_its_softness() -> None:
    """A strip of 300 mm under ten times its weight, at rest after the soft fall: long by W g L^2/(2 Y), as cloth that was loaded once; what comes back from a
    larger strain would be longer by half; what swings while it settles leaves a few percent."""
    materials, gravity = fabric(), 10.0 * GRAVITY_M_S2
    cloth = rectangle_cloth(60.0, 300.0, 20.0, 0.0, materials)
    start = np.column_stack([cloth.vertex_uv_mm * 1e-3, np.zeros(cloth.particle_count)])
    dynamics = moving(cloth, materials, start[:, 1] > 0.2999, gravity)
    state = State(start.copy(), np.zeros_like(start), phase="fall", run={"phase_from_s": 0.0})
    dynamics.start(state)
    softer = partial(soften, dynamics.forces.forces, cloth, materials)
    assert Course(dynamics, softer, "drape", 20.0).run(state, lambda progress: None) == "converged"
    bottom = start[:, 1] < 1e-4
    longer = float((start[bottom, 1] - state.positions[bottom, 1]).mean())
    assert longer == pytest.approx(MASS * gravity * 0.3**2 / (2.0 * 600.0), rel=0.05)


def test_resumed_in_the_same_bits(tmp_path: Path) -> None:
    whole, resumed = falling(384), falling(384, tmp_path)
    assert whole.work_j == resumed.work_j
    assert whole.work_j["internal_friction"] < 0.0
    assert whole.sha256() == resumed.sha256()


def test_same_bits_for_1_2_and_4_threads() -> None:
    printed = printed_on_threads("import test_hysteresis as t; s = t.falling(300); print(s.sha256(), s.work_j)")
    assert len(printed[0]) > 60
    assert len(set(printed)) == 1
