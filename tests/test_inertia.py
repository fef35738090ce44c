"""Fictitious inertia of drape mode: against dense matrices, closed forms of slopes, and shapes at rest."""

from __future__ import annotations

import math
from copy import deepcopy

import numpy as np
import pytest
from elastic import linear
from force_checks import tangent_by_differences

from garmentcad.cloth.cloth import Cloth
from garmentcad.cloth.lattice import rectangle_cloth
from garmentcad.cloth.state import State
from garmentcad.contact.contact import Contact
from garmentcad.forces.assembly import ForceAssembly
from garmentcad.forces.band import BandSegments, ForceBand
from garmentcad.forces.gravity import ForceGravity
from garmentcad.forces.internal import internal_forces
from garmentcad.forces.time_step import SmallMotion
from garmentcad.solve.dynamics import SAFETY, Dynamics
from garmentcad.solve.inertia import MOST_LIGHTER, REACH, light_across, normals_at, root_eased, slopes, turned
from garmentcad.solve.rest import patches, residual
from garmentcad.solve.strain_limit import strain_limit

MATERIALS = linear(0.15, 2000.0, 0.4, shear=45.0, thickness=5e-4, friction=0.3)


def strip() -> Cloth:
    return rectangle_cloth(200.0, 40.0, 10.0, 0.0, MATERIALS)


def bent(cloth: Cloth, radius: float) -> np.ndarray:
    """On a cylinder about the panel's y axis."""
    u, v = cloth.vertex_uv_mm.T * 1e-3
    return np.column_stack([radius * np.sin(u / radius), v, radius * np.cos(u / radius)])


def test_normals_and_slopes_of_a_cylinder() -> None:
    """A side that spans an angle t rises by sin(t/2) against the normals at its ends; triangles of about the same area lean to either side of a particle."""
    cloth, radius = strip(), 0.05
    positions = bent(cloth, radius)
    normals, steepest = np.empty_like(positions), np.empty(len(positions))
    normals_at(cloth.particle_triangles, positions, normals)
    slopes(cloth.particle_triangles, positions, normals, steepest)
    u, v = cloth.vertex_uv_mm.T
    inner = (u > 25.0) & (u < 175.0) & (v > 15.0) & (v < 25.0)
    outward = positions * np.array([1.0, 0.0, 1.0]) / radius
    assert inner.sum() > 10
    assert np.abs((normals * outward).sum(axis=1)[inner]) == pytest.approx(1.0, abs=2e-3)
    assert steepest[inner] == pytest.approx(math.sin(0.5 * 0.01 / radius), rel=0.02)


def test_what_is_lighter_and_by_how_much() -> None:
    cloth = strip()
    stiff = cloth.vertex_uv_mm[:, 0] > 100.0
    limp = np.where(stiff, 80.0, 1e6)
    flat = light_across(cloth.particle_triangles, bent(cloth, 1e3), limp)
    assert (flat[stiff] ** 2).sum(axis=1) == pytest.approx(80.0 * REACH**2 - 1.0)
    assert (flat[~stiff] ** 2).sum(axis=1) == pytest.approx(MOST_LIGHTER - 1.0)
    assert np.all(light_across(cloth.particle_triangles, bent(cloth, 1e3), 0.0 * limp) == 0.0)
    sharp = light_across(cloth.particle_triangles, bent(cloth, 0.02), limp)
    u, v = cloth.vertex_uv_mm.T
    inner = (u > 25.0) & (u < 75.0) & (v > 15.0) & (v < 25.0)
    assert 1.0 + (sharp[inner] ** 2).sum(axis=1) == pytest.approx((REACH / math.sin(0.25)) ** 2, rel=0.05)


def test_root_is_the_root() -> None:
    rng = np.random.default_rng(0)
    across, vectors = 3.0 * rng.standard_normal((20, 3)), rng.standard_normal((20, 3))
    across[0] = 0.0
    whole = np.array([(np.eye(3) + np.outer(a, a)) @ v for a, v in zip(across, vectors)])
    assert root_eased(root_eased(vectors, across), across) == pytest.approx(whole, rel=1e-12)


def test_frequency_of_light_cloth_is_the_largest_eigenvalue() -> None:
    """And light cloth needs no shorter steps than heavy cloth."""
    cloth = strip()
    positions = bent(cloth, 0.04)
    forces = ForceAssembly(internal_forces(cloth, MATERIALS), cloth.particle_count)
    whole, bending = np.empty(cloth.particle_count), np.empty(cloth.particle_count)
    forces.stiffness(positions, whole)
    forces.stiffness_across(positions, bending)
    across = light_across(cloth.particle_triangles, positions, whole / bending)
    tangent = tangent_by_differences(forces, positions)
    root = np.zeros_like(tangent)
    for p, a in enumerate(across):
        values, vectors = np.linalg.eigh((np.eye(3) + np.outer(a, a)) / cloth.masses[p])
        root[3 * p : 3 * p + 3, 3 * p : 3 * p + 3] = vectors @ np.diag(np.sqrt(values)) @ vectors.T
    light = math.sqrt(np.linalg.eigvalsh(root @ tangent @ root)[-1])
    scale = 1.0 / np.sqrt(cloth.masses)[:, None]
    motion = SmallMotion(forces, positions)
    assert motion.highest_frequency(lambda vectors: scale * root_eased(vectors, across)) == pytest.approx(light, rel=0.01)
    heavy = motion.highest_frequency(lambda vectors: scale * vectors)
    assert light < 1.02 * heavy
    assert (across**2).sum(axis=1).max() > 10.0


def test_the_time_step_of_light_cloth_under_a_taut_band_is_that_of_its_highest_frequency() -> None:
    """A band pulls across the cloth by its tension; counted out, cloth below it was so light that a tube top flipped at the speed cap until its time was up."""
    cloth = strip()
    flat = np.column_stack([cloth.vertex_uv_mm * 1e-3, np.zeros(cloth.particle_count)])[cloth.vertex_particle.argsort()]
    row = np.flatnonzero(flat[:, 1] == flat[:, 1].max())
    row = row[np.argsort(flat[row, 0])]
    ends = np.repeat(np.column_stack([row[:-1], row[1:]])[:, :, None], 3, axis=2).astype(np.int32)
    count = len(ends)
    band = ForceBand(
        BandSegments(ends, np.tile([1.0, 0.0, 0.0], (count, 2, 1)), np.ones(count), np.arange(count + 1, dtype=np.int32), np.full(count, 0.008),
                     np.full(count, 40.0), np.zeros(count, np.int32))
    )  # fmt: skip
    forces = ForceAssembly([*internal_forces(cloth, MATERIALS), band], cloth.particle_count)
    dynamics = Dynamics(cloth, forces, strain_limit(cloth, MATERIALS), Contact(cloth, MATERIALS))
    dynamics.equalise = dynamics.lighten = dynamics.measured = True
    state = State(flat, np.zeros_like(flat))
    dynamics.start(state)
    root = np.zeros((3 * len(flat), 3 * len(flat)))
    for p, a in enumerate(dynamics.across):
        values, vectors = np.linalg.eigh((np.eye(3) + np.outer(a, a)) * dynamics.inverse_masses[p])
        root[3 * p : 3 * p + 3, 3 * p : 3 * p + 3] = vectors @ np.diag(np.sqrt(values)) @ vectors.T
    highest = math.sqrt(np.linalg.eigvalsh(root @ tangent_by_differences(forces, flat) @ root)[-1])
    assert state.time_step_s == pytest.approx(2.0 * SAFETY / highest, rel=0.01)
    lighter = 1.0 + (dynamics.across[row] ** 2).sum(axis=1)
    heavy = 2.0 * SAFETY * np.sqrt(cloth.masses / dynamics._stiffness)
    assert state.time_step_s > 0.99 * np.median(heavy), "steps stay as long as without"
    assert 1.0 <= lighter.max() < MOST_LIGHTER


def hung(lighten: bool) -> tuple[float, int]:
    """Sag of a strip that hangs in an arc between two held ends, and steps until it rests."""
    cloth, radius = strip(), 0.1
    u, v = cloth.vertex_uv_mm.T * 1e-3
    angle = (u - 0.1) / radius
    start = np.column_stack([radius * np.sin(angle), radius * (math.cos(1.0) - np.cos(angle)), v])
    fixed = (u < 1e-6) | (u > 0.2 - 1e-6)
    forces = ForceAssembly(internal_forces(cloth, MATERIALS), cloth.particle_count, [ForceGravity(cloth.masses)])
    dynamics = Dynamics(cloth, forces, strain_limit(cloth, MATERIALS), Contact(cloth, MATERIALS), fixed)
    dynamics.drag, dynamics.equalise, dynamics.speed_cap_m_s = 10.0, True, 1.0  # drag of 20 /s brakes light and heavy cloth alike
    state = State(start, np.zeros_like(start))
    dynamics.start(state)
    dynamics.advance(state, 1920)
    dynamics.lighten, dynamics.measured, dynamics.steady, fallen = lighten, True, True, state.step
    patch = patches(cloth)
    while residual(dynamics, state, patch).rms_g > 2e-4:
        dynamics.advance(state, 96)
        assert state.step < 60000
    return float(state.positions[:, 1].min()), state.step - fallen


def test_shape_at_rest_does_not_depend_on_inertia_but_light_cloth_is_there_sooner() -> None:
    heavy, steps = hung(False)
    light, fewer = hung(True)
    assert heavy < -0.03
    assert light == pytest.approx(heavy, abs=2e-6)
    assert fewer < 0.95 * steps


def about_y(angle: float) -> np.ndarray:
    return np.array([[math.cos(angle), 0.0, math.sin(angle)], [0.0, 1.0, 0.0], [-math.sin(angle), 0.0, math.cos(angle)]])


def test_how_far_light_cloth_has_turned() -> None:
    """At most for what is lightest, and not at all for what keeps its mass."""
    cloth = strip()
    flat = np.column_stack([cloth.vertex_uv_mm * 1e-3, np.zeros(cloth.particle_count)])
    limp = np.where(cloth.vertex_uv_mm[:, 0] > 100.0, 80.0, 0.0)
    across = light_across(cloth.particle_triangles, flat, limp)
    assert turned(cloth.particle_triangles, flat, across) == pytest.approx(0.0, abs=1e-12)
    assert turned(cloth.particle_triangles, flat + 0.3, across) == pytest.approx(0.0, abs=1e-12)
    assert turned(cloth.particle_triangles, flat @ about_y(0.1).T, across) == pytest.approx((80.0 * REACH**2 - 1.0) * math.sin(0.1) ** 2)


def spinning(spin: float) -> tuple[Dynamics, State]:
    """A strip that turns about its middle at so many rad/s, light across itself, in a run that looks at its stiffness seldom: it never changes."""
    cloth = strip()
    u, v = cloth.vertex_uv_mm.T * 1e-3
    flat = np.column_stack([u - 0.1, v, np.zeros(len(u))])
    state = State(flat, np.cross([0.0, spin, 0.0], flat) + 1e-4 * np.random.default_rng(0).standard_normal(flat.shape))
    dynamics = stepper(cloth)
    dynamics.start(state)
    return dynamics, state


def stepper(cloth: Cloth) -> Dynamics:
    forces = ForceAssembly(internal_forces(cloth, MATERIALS), cloth.particle_count)
    dynamics = Dynamics(cloth, forces, strain_limit(cloth, MATERIALS), Contact(cloth, MATERIALS))
    dynamics.equalise = dynamics.lighten = dynamics.measured = dynamics.steady = True
    dynamics.speed_cap_m_s = 5.0
    return dynamics


def test_light_cloth_that_turns_does_not_ring() -> None:
    """What is light across the cloth would be light along it when it has turned, where it is stiff, and fly to and fro at the speed cap."""
    dynamics, state = spinning(10.0)
    fastest, way = 0.0, 0.0
    for _ in range(24):
        dynamics.advance(state, 96)
        with dynamics.true_masses(state):
            assert not dynamics.across.any()
        fastest = max(fastest, float(np.linalg.norm(state.velocities, axis=1).max()))
        way = max(way, turned(dynamics.cloth.particle_triangles, state.positions, dynamics.across))
    rim = state.positions[dynamics.cloth.vertex_uv_mm[:, 0] == 200.0].mean(axis=0)
    assert math.degrees(math.atan2(-rim[2], rim[0])) > 30.0
    assert fastest < 1.0, "no faster than the ends began"
    assert 0.0 < way < 0.16


def test_a_resumed_run_turns_light_cloth_alike() -> None:
    dynamics, state = spinning(2.0)
    while state.step >= state.contact["stiff_wait"][1] or np.array_equal(state.contact["light_home"], state.contact["stiff_home"]):
        dynamics.advance(state, 96)
    read = deepcopy(state)
    for run, moved in ((dynamics, state), (stepper(dynamics.cloth), read)):
        run.advance(moved, 96)
    assert read.sha256() == state.sha256()
