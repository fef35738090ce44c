"""Contact with a body that moves on a given path: Coulomb on an accelerated plate, a ball through cloth, a belt on a turning roller, same bits."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import igl
import numpy as np
import pytest
import trimesh
from command import printed_on_threads
from loose_sheet import least_distance
from test_dynamics import linear_fabric

from garmentcad.cloth.cloth import Cloth
from garmentcad.cloth.lattice import rectangle_cloth
from garmentcad.cloth.state import State
from garmentcad.cloth.weld import weld
from garmentcad.contact.contact import Contact
from garmentcad.contact.path import FASTEST_M_S, BodyPath
from garmentcad.errors import GarmentError
from garmentcad.forces.assembly import ForceAssembly
from garmentcad.forces.gravity import ForceGravity
from garmentcad.forces.internal import internal_forces
from garmentcad.geometry.intersection import crossing_triangle_pairs, crossing_triangle_pairs_between
from garmentcad.simulation.checkpoint import load_state, save_state
from garmentcad.solve.dynamics import Dynamics
from garmentcad.solve.strain_limit import strain_limit
from garmentcad.units import GRAVITY_M_S2

MATERIALS = linear_fabric()
TURN = 2.2 * np.pi
MU = float(MATERIALS.friction_body[0])
Body = tuple[np.ndarray, np.ndarray]


def shifted(vertices: np.ndarray, x: float = 0.0, y: float = 0.0, z: float = 0.0) -> np.ndarray:
    return np.asarray(vertices) + np.array([x, y, z])


def turned(vertices: np.ndarray, axis: list[float], angle: float) -> np.ndarray:
    return trimesh.transform_points(vertices, trimesh.transformations.rotation_matrix(angle, axis))


def moved(cloth: Cloth, body: Body, path: BodyPath, fixed: np.ndarray | None = None, weight: bool = True) -> Dynamics:
    forces = ForceAssembly(internal_forces(cloth, MATERIALS), cloth.particle_count, [ForceGravity(cloth.masses)] if weight else [])
    return Dynamics(cloth, forces, strain_limit(cloth, MATERIALS), Contact(cloth, MATERIALS, body, path=path), fixed)


def fresh(dynamics: Dynamics, positions: np.ndarray) -> State:
    state = State(positions.copy(), np.zeros_like(positions))
    dynamics.start(state)
    return state


def advance_to(dynamics: Dynamics, state: State, time_s: float, look: Callable[[], None] = lambda: None) -> None:
    while state.time_s < time_s:
        dynamics.advance(state, 192)
        look()


def on_accelerated_plate(acceleration: float, time_s: float) -> tuple[State, np.ndarray]:
    """A patch on a plate that starts from rest; the state at the end, and where the patch was, both of them in m."""
    box = trimesh.creation.box(extents=(1.2, 0.2, 0.6))
    vertices, cloth = shifted(box.vertices, y=-0.1), rectangle_cloth(80.0, 60.0, 10.0, 20.0, MATERIALS)
    times = np.linspace(0.0, 1.0, 21)
    dynamics = moved(cloth, (vertices, box.faces), BodyPath(times, vertices + np.multiply.outer(0.5 * acceleration * times**2, [[1.0, 0.0, 0.0]])))
    flat = cloth.vertex_uv_mm * 1e-3
    start = np.column_stack([flat[:, 0] - 0.04, np.full(len(flat), 1e-3), 0.16 - flat[:, 1]])  # beside the diagonal of the plate
    state = fresh(dynamics, start)
    advance_to(dynamics, state, time_s)
    return state, start


def test_patch_on_an_accelerated_plate_sticks_below_mu_g() -> None:
    acceleration = 0.97 * MU * GRAVITY_M_S2
    state, start = on_accelerated_plate(acceleration, 0.4)
    plate = np.array([0.5 * acceleration * state.time_s**2, 0.0, 0.0])
    assert plate[0] > 0.2
    assert np.abs(state.positions - start - plate).max() < 1e-6
    assert state.work_j["friction"] == pytest.approx(0.0, abs=1e-9)


def test_patch_on_an_accelerated_plate_slips_above_it_with_mu_g() -> None:
    state, start = on_accelerated_plate(1.5 * MU * GRAVITY_M_S2, 0.4)
    way = (state.positions - start)[:, 0]
    assert way.mean() == pytest.approx(0.5 * MU * GRAVITY_M_S2 * state.time_s**2, rel=0.02)
    assert np.ptp(way) < 1e-4
    mass = 0.15 * 0.08 * 0.06
    heat = MU * mass * GRAVITY_M_S2 * 0.5 * 0.5 * MU * GRAVITY_M_S2 * state.time_s**2  # friction times the way that plate and patch slide past each other
    assert state.work_j["friction"] == pytest.approx(-heat, rel=0.02)


def into_hanging_cloth() -> tuple[Dynamics, np.ndarray, Body, BodyPath]:
    """A ball at 1 m/s along z into a curtain held at its upper edge."""
    ball = trimesh.creation.icosphere(subdivisions=3, radius=0.05)
    vertices = shifted(ball.vertices, 0.003, -0.12, -0.08)
    cloth = rectangle_cloth(200.0, 200.0, 10.0, 30.0, MATERIALS)
    path = BodyPath(np.array([0.0, 0.25]), np.stack([vertices, shifted(vertices, z=0.25)]))
    positions = np.column_stack([cloth.vertex_uv_mm * 1e-3 - [0.1, 0.2], np.zeros(cloth.particle_count)])
    dynamics = moved(cloth, (vertices, np.asarray(ball.faces)), path, positions[:, 1] > -1e-6)
    dynamics.drag = 2.0
    return dynamics, positions, (vertices, np.asarray(ball.faces)), path


def test_ball_goes_into_a_hanging_cloth_and_not_through() -> None:
    dynamics, positions, (_, faces), path = into_hanging_cloth()
    triangles, state = dynamics.cloth.particle_triangles, fresh(dynamics, positions)
    closest = []

    def look() -> None:
        body = path.at(state.time_s)
        closest.append(least_distance(state.positions, triangles, body, faces))
        assert len(crossing_triangle_pairs(state.positions, triangles)) == 0
        assert len(crossing_triangle_pairs_between(state.positions, triangles, body, faces)) == 0

    advance_to(dynamics, state, 0.3, look)
    assert min(closest) > 0.3e-3
    assert max(closest[10:30]) < 2.5e-3  # they touch
    assert state.positions[:, 2].max() > 0.15


@pytest.mark.parametrize(("falling", "below", "time_s"), [(True, 0.005, 0.03), (False, 0.02, 0.01)])
def test_needle_from_below_lifts_a_sheet_and_does_not_pierce_it(falling: bool, below: float, time_s: float) -> None:
    """A tip between particles of a sheet that sinks towards it, or that does not move before it comes: pairs of elements see that the body moves."""
    cone = trimesh.creation.cone(radius=0.012, height=0.05, sections=12)
    vertices, faces = shifted(cone.vertices[:, [1, 2, 0]], y=-0.05 - below), np.asarray(cone.faces)
    cloth = rectangle_cloth(80.0, 80.0, 10.0, 0.0, MATERIALS)
    flat = cloth.vertex_uv_mm * 1e-3
    positions = np.column_stack([flat[:, 0] - 0.0447, np.zeros(len(flat)), 0.0433 - flat[:, 1]])
    path = BodyPath(np.array([0.0, time_s]), np.stack([vertices, shifted(vertices, y=below + 0.01)]))
    dynamics = moved(cloth, (vertices, faces), path, np.abs(flat - 0.04).max(axis=1) > 0.039, falling)
    state = fresh(dynamics, positions)

    def look() -> None:
        assert len(crossing_triangle_pairs_between(state.positions, cloth.particle_triangles, path.at(state.time_s), faces)) == 0

    advance_to(dynamics, state, time_s, look)
    assert state.positions[:, 1].max() > 0.007


def band() -> tuple[Cloth, np.ndarray, float]:
    """A closed band around the z axis, where its particles are without strain, and the radius there."""
    flat = rectangle_cloth(320.0, 30.0, 10.0, 0.0, MATERIALS)
    u, v = flat.vertex_uv_mm.T
    ends = [np.flatnonzero(u == side)[np.argsort(v[u == side])] for side in (0.0, 320.0)]
    stitches = flat.vertex_particle[np.column_stack(ends)]
    one = np.zeros(1)
    sewn = replace(flat, stitches=stitches, stitch_seam=np.zeros(len(stitches), np.int32), seam_names=("side",), seam_fold=one, seam_bend_factor=one + 1.0)
    cloth, _ = weld(sewn)
    radius = 0.01 / (2.0 * np.sin(np.pi / 32))
    angle = 2.0 * np.pi * u / 320.0
    positions = np.zeros((cloth.particle_count, 3))
    positions[cloth.vertex_particle] = np.column_stack([radius * np.sin(angle), radius * np.cos(angle), 1e-3 * v - 0.015])
    return cloth, positions, radius


def at_the_top(cloth: Cloth, positions: np.ndarray) -> float:
    """Place along the band, mm, of what lies over the axis."""
    row = np.flatnonzero(np.abs(cloth.vertex_uv_mm[:, 1] - 10.0) < 1e-6)
    row = row[np.argsort(cloth.vertex_uv_mm[row, 0])]
    x, y = positions[cloth.vertex_particle[row], :2].T
    k = int(np.flatnonzero((x[:-1] * x[1:] <= 0.0) & (y[:-1] > 0.0))[0])
    return float(cloth.vertex_uv_mm[row[k], 0] + 10.0 * x[k] / (x[k] - x[k + 1]))


@pytest.mark.parametrize("looser", [-0.004, 0.15])
def test_roller_takes_a_band_with_it(looser: float) -> None:
    """A closed band around a roller with a level axis, from rest to rest in 1.1 turns: a snug one turns by the same angle, a loose one that hangs
    from the roller goes the same way along its surface."""
    cloth, positions, across = band()
    gap = 1.1e-3  # about what contact keeps off a roller of this size
    roller = trimesh.creation.cylinder(radius=across / (1.0 + looser) - gap, height=0.08, sections=96)
    vertices, faces = np.asarray(roller.vertices), np.asarray(roller.faces)
    times = np.linspace(0.0, 1.0, 61)
    angles = TURN * times**3 * (10.0 - 15.0 * times + 6.0 * times**2)
    path = BodyPath(times + 0.3, np.stack([turned(vertices, [0.0, 0.0, 1.0], angle) for angle in angles]))
    dynamics = moved(cloth, (vertices, faces), path)
    dynamics.drag = 3.0
    if looser > 0.0:
        positions[:, 1] -= across - roller.vertices[:, 1].max() - 1.3e-3  # it hangs from the top
    state = fresh(dynamics, positions)
    advance_to(dynamics, state, 0.3)
    before = state.positions.copy()
    advance_to(dynamics, state, 1.4)
    after = state.positions
    if looser < 0.0:
        slip = np.linalg.norm(after - turned(before, [0.0, 0.0, 1.0], TURN), axis=1)
        assert slip.max() < np.radians(0.2) * across
        return
    way = (at_the_top(cloth, after) - at_the_top(cloth, before)) % 320.0
    between = 2.0 * np.arcsin(5.0 / (1e3 * np.linalg.norm(after[:, :2], axis=1).min()))  # the angle from particle to particle that lie on the roller
    assert way == pytest.approx(10.0 * TURN / between, rel=0.003)
    assert igl.signed_distance(after, path.at(state.time_s), faces)[0].min() > 0.9e-3


def test_parts_of_a_body_that_close_on_what_rests_between_them_are_seen() -> None:
    """Cloth beside a wall that it does not touch, and a second wall that comes: relative to the first one nothing moves but the body itself."""
    wall = trimesh.creation.box(extents=(0.4, 0.4, 0.2))
    count = len(wall.vertices)
    apart, closed = (np.concatenate([shifted(wall.vertices, z=-0.1), shifted(wall.vertices, z=0.1 + room)]) for room in (0.03, 0.0022))
    faces = np.concatenate([wall.faces, wall.faces + count])
    cloth = rectangle_cloth(50.0, 50.0, 10.0, 0.0, MATERIALS)
    positions = np.column_stack([cloth.vertex_uv_mm * 1e-3 - 0.027, np.full(cloth.particle_count, 1.4e-3)])
    path = BodyPath(np.array([0.0, 0.1]), np.stack([apart, closed]))
    dynamics = moved(cloth, (apart, faces), path, weight=False)
    dynamics.drag = 5.0
    state = fresh(dynamics, positions)
    advance_to(dynamics, state, 0.12)
    for half in (slice(0, count), slice(count, 2 * count)):
        assert igl.signed_distance(state.positions, path.at(1.0)[half], np.asarray(wall.faces))[0].min() > 0.98e-3


def test_same_bits_after_a_checkpoint_in_the_middle_of_the_motion(tmp_path: Path) -> None:
    dynamics, positions, _, _ = into_hanging_cloth()
    state = fresh(dynamics, positions)
    advance_to(dynamics, state, 0.1)
    save_state(tmp_path / "mid.npz", state, {})
    resumed, again = load_state(tmp_path / "mid.npz"), into_hanging_cloth()[0]
    dynamics.advance(state, 960)
    again.advance(resumed, 960)
    assert state.contact["planes_held"].sum() > 10
    assert resumed.sha256() == state.sha256()
    assert resumed.work_j == state.work_j


SCRIPT = """
from test_contact_moving import advance_to, fresh, into_hanging_cloth
dynamics, positions, _, _ = into_hanging_cloth()
state = fresh(dynamics, positions)
advance_to(dynamics, state, 0.12)
print(state.sha256(), state.work_j["friction"].hex())
"""


def test_same_bits_on_one_and_two_threads() -> None:
    one, two = printed_on_threads(SCRIPT, (1, 2))
    assert len(one) > 60
    assert one == two


def test_path_goes_through_its_frames_with_constant_acceleration_and_stands_outside() -> None:
    point = np.array([[0.1, 0.2, 0.3]])
    times = np.array([1.0, 1.1, 1.3, 1.35])
    frames = point + np.multiply.outer(2.0 * (times - 1.0) ** 2, [[1.0, 0.0, -1.0]])
    path = BodyPath(times, frames)
    for time_s in (1.0, 1.03, 1.1, 1.2, 1.349):
        np.testing.assert_allclose(path.at(time_s), point + 2.0 * (time_s - 1.0) ** 2 * np.array([1.0, 0.0, -1.0]), atol=1e-15)
    np.testing.assert_array_equal(path.at(0.5), frames[0])
    np.testing.assert_array_equal(path.at(2.0), frames[-1])
    start, leg = path.leg(1.02, 0.01)
    np.testing.assert_allclose(leg.at(start, 0.007), path.at(1.027), atol=1e-15)
    for time_s in (0.5, 1.4):
        assert len(path.leg(time_s, 0.01)[1].first) == 0
    turning = BodyPath(np.linspace(0.0, 1.0, 37), np.stack([turned(point, [0.0, 1.0, 0.0], angle) for angle in np.linspace(0.0, 2.0 * np.pi, 37)]))
    for time_s in np.linspace(0.0, 1.0, 50):
        assert np.linalg.norm(turning.at(time_s) - turned(point, [0.0, 1.0, 0.0], 2.0 * np.pi * time_s)) < 1e-4


def test_a_path_that_makes_no_sense_is_refused() -> None:
    still = np.zeros((2, 4, 3))
    fast = still + np.array([0.0, 1.01 * FASTEST_M_S])[:, None, None] * [1.0, 0.0, 0.0]
    nothing = np.where(np.arange(2)[:, None, None] > 0, np.nan, still)
    for times, frames, told in (
        ([0.0, 1.0], fast, "10.1 m/s between 0 and 1 s"),
        ([0.0, 0.0], still, "must rise"),
        ([0.0, 1.0, 2.0], still, r"\(3,\)"),
        ([0.0, 1.0], nothing, "not finite"),
    ):
        with pytest.raises(GarmentError, match=told):
            BodyPath(np.array(times), frames)
    ball = trimesh.creation.icosphere(subdivisions=0, radius=0.1)
    cloth = rectangle_cloth(20.0, 20.0, 10.0, 0.0, MATERIALS)
    with pytest.raises(GarmentError, match="4 vertices for a body of 12"):
        Contact(cloth, MATERIALS, (ball.vertices, ball.faces), path=BodyPath(np.array([0.0, 1.0]), still))
