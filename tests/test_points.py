"""Dynamic constraints against the solution of C'' + 2 r C' + r^2 C = 0 and against momentum."""

from __future__ import annotations

import numpy as np
import pytest

from garmentcad.constraints.points import ConstraintPoints, PointRows, apply_bonds, correct_speeds, demand_speeds, stitch_rows
from garmentcad.errors import InputError
from garmentcad.simulation.sewing import HOLDING_RATE


def run(constraint: ConstraintPoints, x: np.ndarray, v: np.ndarray, force: np.ndarray, inverse_masses: np.ndarray, dt: float, steps: int) -> None:
    bonds = constraint.bonds(constraint.speeds(v), np.zeros_like(constraint.targets))
    for _ in range(steps):
        demand_speeds(bonds, x, dt)
        v += dt * force * inverse_masses[:, None]
        correct_speeds(bonds, dt, v)
        x += dt * v


def test_gap_decays_as_critical_damping_whatever_forces_pull() -> None:
    rng = np.random.default_rng(1)
    x, v = rng.standard_normal((6, 3)), np.zeros((6, 3))
    inverse_masses = 1.0 / rng.uniform(0.5, 2.0, 6)
    stitches = np.array([[0, 1], [1, 2], [3, 4]])  # two rows share particle 1
    constraint = ConstraintPoints(stitch_rows(stitches, ("a", "a", "b")), inverse_masses, rate=10.0)
    start = constraint.gaps(x).copy()
    momentum = (v / inverse_masses[:, None]).sum(axis=0)
    force = np.zeros((6, 3))
    force[0], force[3] = [5.0, 0.0, -2.0], [-1.0, 3.0, 0.0]
    dt, steps = 1e-5, 30000
    run(constraint, x, v, force, inverse_masses, dt, steps)
    t = dt * steps
    assert np.allclose(constraint.gaps(x), start * (1.0 + 10.0 * t) * np.exp(-10.0 * t), atol=2e-4 * np.abs(start).max())
    # inner forces carry no momentum: only the outer force changes it
    assert np.allclose((v / inverse_masses[:, None]).sum(axis=0) - momentum, force.sum(axis=0) * t, atol=1e-9)


def test_a_row_holds_within_its_shank_and_decays_to_it_from_outside() -> None:
    """Two points on a thread of 2 mm: 1 mm apart they stay so; from 12 mm apart the 10 mm beyond it decay as (1 + r t) exp(-r t), along the line."""
    rows = PointRows(np.array([0, 0]), np.array([0, 1]), np.array([1.0, -1.0]), np.zeros((1, 3)), ("button",), np.array([2e-3]), np.zeros(1))
    constraint = ConstraintPoints(rows, np.ones(2), rate=10.0)
    x, v = np.array([[0.0, 0.6e-3, 0.8e-3], [0.0, 0.0, 0.0]]), np.array([[0.0, 0.3, 0.0], [0.0, 0.0, 0.1]])
    apply_bonds(constraint.bonds(np.zeros((1, 3)), np.zeros((1, 3))), x, 1e-4, v)
    assert v == pytest.approx(np.tile([0.0, 0.15, 0.05], (2, 1)), abs=1e-15)
    x, v = 12e-3 * np.array([[0.0, 0.6, 0.8], [0.0, 0.0, 0.0]]), np.zeros((2, 3))
    assert constraint.gaps(x)[0] == pytest.approx([0.0, 6e-3, 8e-3])
    run(constraint, x, v, np.zeros((2, 3)), np.ones(2), 1e-5, 30000)
    left = 10e-3 * (1.0 + 3.0) * np.exp(-3.0)
    assert x[0] - x[1] == pytest.approx((2e-3 + left) * np.array([0.0, 0.6, 0.8]), rel=1e-3)


def test_end_that_contact_keeps_from_its_share_leaves_a_spring_of_the_rate() -> None:
    """Contact keeps particle 1 where it is; a force F pulls particle 0 from it. A gap C that stays demands the speed -r C / 2 of the two, of which each takes
    half: particle 0 is at rest where F dt / m - (F dt / m + r C / 2) / 2 = 0. So C = 2 F dt / (m r)."""
    mass, pull, dt = 1e-4, 0.1, 70e-6
    gaps = []
    for rate in (150.0, HOLDING_RATE):
        constraint = ConstraintPoints(stitch_rows(np.array([[0, 1]]), ("button",)), np.full(2, 1.0 / mass), rate)
        bonds = constraint.bonds(np.zeros((1, 3)), np.zeros((1, 3)))
        x, v = np.zeros((2, 3)), np.zeros((2, 3))
        for _ in range(20000):
            v[0, 1] += dt * pull / mass
            apply_bonds(bonds, x, dt, v)
            v[1] = 0.0
            x += dt * v
        gaps.append(x[0, 1])
        assert np.abs(v).max() < 1e-9
        assert x[0, 1] == pytest.approx(2.0 * pull * dt / (mass * rate), rel=1e-6)
    assert gaps[1] < 0.2 * gaps[0]


def test_steps_too_long_for_the_rate_take_a_lower_one() -> None:
    x, v = np.array([[1e-3, 0.0, 0.0], [0.0, 0.0, 0.0]]), np.zeros((2, 3))
    constraint = ConstraintPoints(stitch_rows(np.array([[0, 1]]), ("pin",)), np.ones(2), rate=1e5)
    run(constraint, x, v, np.zeros((2, 3)), np.ones(2), 1e-3, 200)
    assert np.abs(constraint.gaps(x)).max() < 1e-8


def test_cycle_of_stitches_is_solved_and_named() -> None:
    x, v = np.random.default_rng(2).standard_normal((3, 3)), np.zeros((3, 3))
    constraint = ConstraintPoints(stitch_rows(np.array([[0, 1], [1, 2], [2, 0]]), ("p", "q", "r")), np.ones(3), rate=20.0)
    assert constraint.redundant == ("p", "q", "r")
    run(constraint, x, v, np.zeros((3, 3)), np.ones(3), 1e-4, 10000)
    assert np.abs(constraint.gaps(x)).max() < 1e-6


def test_pin_holds_a_weighted_point_under_load() -> None:
    rows = PointRows.plain(np.array([0, 0]), np.array([0, 1]), np.array([0.25, 0.75]), np.array([[0.0, 1.0, 0.0]]), ("pin",))
    x, v = np.array([[1.0, 1.0, 0.0], [-1.0 / 3.0, 1.0, 0.0]]), np.zeros((2, 3))
    constraint = ConstraintPoints(rows, np.ones(2), rate=30.0)
    run(constraint, x, v, np.array([[0.0, -9.81, 0.0], [0.0, -9.81, 0.0]]), np.ones(2), 1e-4, 5000)
    assert np.abs(constraint.gaps(x)).max() < 1e-12


def test_row_on_fixed_particles_is_refused_by_name() -> None:
    with pytest.raises(InputError, match="side"):
        ConstraintPoints(stitch_rows(np.array([[0, 1]]), ("side",)), np.zeros(2), rate=1.0)


def test_a_blocked_end_feeds_nothing_into_the_other() -> None:
    """One end is held by something that acts after the constraint, and pulled hard: the other end still closes at the demanded pace."""
    x, v = np.array([[0.0, 0.0, 0.0], [0.1, 0.0, 0.0]]), np.zeros((2, 3))
    constraint = ConstraintPoints(stitch_rows(np.array([[0, 1]]), ("side",)), np.ones(2), rate=10.0)
    bonds, dt, fastest = constraint.bonds(np.zeros((1, 3)), np.zeros((1, 3))), 1e-4, 0.0
    for _ in range(20000):
        demand_speeds(bonds, x, dt)
        v[0, 1] += dt * 50.0
        correct_speeds(bonds, dt, v)
        v[0] = 0.0
        x += dt * v
        fastest = max(fastest, float(np.linalg.norm(v[1])))
    assert fastest < 1.0
    assert np.linalg.norm(constraint.gaps(x)) < 2e-3


def test_cap_bounds_the_force() -> None:
    constraint = ConstraintPoints(stitch_rows(np.array([[0, 1]]), ("side",)), np.ones(2), rate=10.0, cap=0.5)
    v = np.zeros((2, 3))
    correct_speeds(constraint.bonds(np.array([[3.0, 0.0, 0.0]]), np.zeros((1, 3))), 0.01, v)
    assert np.allclose(v, [[0.005, 0.0, 0.0], [-0.005, 0.0, 0.0]])


@pytest.mark.parametrize(("least_speed", "share", "expected"), [(0.0, 0.1, 2.0 * 0.02 / 14.0), (0.05, 0.1, 10.0 * 0.02 * 1e-4), (0.05, 0.5, 2.0 * 0.02 * 1e-4)])
def test_ends_that_something_drives_apart_close_with_a_floor_on_their_speed(least_speed: float, share: float, expected: float) -> None:
    """A contact takes 0.02 m/s from the closing speed in every step. The decay demands r C/2 and stalls where that is as slow; the floor does so where a share
    of the way in a step is."""
    constraint = ConstraintPoints(stitch_rows(np.array([[0, 1]]), ("armhole",)), np.ones(2), rate=14.0, least_speed=least_speed)
    constraint.least_share = share
    x, v = np.array([[0.01, 0.0, 0.0], [0.0, 0.0, 0.0]]), np.zeros((2, 3))
    bonds, dt = constraint.bonds(np.zeros((1, 3)), np.zeros((1, 3))), 1e-4
    for _ in range(20000):
        demand_speeds(bonds, x, dt)
        correct_speeds(bonds, dt, v)
        v += [[0.01, 0.0, 0.0], [-0.01, 0.0, 0.0]]
        x += dt * v
    assert float(np.linalg.norm(constraint.gaps(x))) == pytest.approx(expected, rel=0.01)


def test_ends_that_circle_each_other_close() -> None:
    """A closing speed of 1 m/s takes ten steps for 1.3 mm. They went round and round at that distance, at 3 m/s, and a seam stood open."""
    constraint = ConstraintPoints(stitch_rows(np.array([[0, 1]]), ("a",)), np.ones(2), rate=14.0, least_speed=1.0)
    x, v = np.array([[0.65e-3, 0.0, 0.0], [-0.65e-3, 0.0, 0.0]]), np.array([[0.0, 1.5, 0.5], [0.0, -1.5, -0.5]])
    bonds, apart = constraint.bonds(constraint.speeds(v), np.zeros((1, 3))), []
    for _ in range(40):
        apply_bonds(bonds, x, 1.9e-4, v)
        x += 1.9e-4 * v
        apart.append(np.linalg.norm(x[0] - x[1]))
    assert max(apart) < 1.4e-3
    assert max(apart[15:]) < 0.05e-3
    assert x.mean(axis=0) == pytest.approx(0.0, abs=1e-12)


def test_each_row_has_a_floor_of_its_own() -> None:
    rows = stitch_rows(np.array([[0, 1], [2, 3]]), ("sewn", "late"))
    constraint = ConstraintPoints(rows, np.ones(4), rate=14.0, least_speed=np.array([1.0, 0.05]))
    x, wanted = np.array([[0.01, 0.0, 0.0], [0.0, 0.0, 0.0], [0.01, 0.0, 0.0], [0.0, 0.0, 0.0]]), np.zeros((2, 3))
    demand_speeds(constraint.bonds(wanted, np.zeros((2, 3))), x, 1e-4)
    assert wanted == pytest.approx(np.array([[-1.0, 0.0, 0.0], [-0.05, 0.0, 0.0]]))


def test_a_garment_without_seams_has_no_rows() -> None:
    constraint = ConstraintPoints(stitch_rows(np.zeros((0, 2), dtype=np.int32), ()), np.ones(3), rate=10.0)
    assert constraint.gaps(np.ones((3, 3))).shape == (0, 3)
    v = np.ones((3, 3))
    bonds = constraint.bonds(np.zeros((0, 3)), np.zeros((0, 3)))
    demand_speeds(bonds, np.ones((3, 3)), 1e-4)
    correct_speeds(bonds, 1e-4, v)
    assert np.array_equal(v, np.ones((3, 3)))
