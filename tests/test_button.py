"""The law of buttons: gradient, balance, stiffness bound; what is free, and what holds."""

from __future__ import annotations

import numpy as np
import pytest
from force_checks import balance_error, gradient_error, particle_forces, stiffness_over_bound

from garmentcad.forces.button import ForceButton, Shanks

BELOW = np.array([[0.0, 0.0, 0.0], [0.02, 0.0, 0.0], [0.0, 0.02, 0.0]])
LENGTH, STIFFNESS, DAMPING = 2e-3, 2e4, 0.3


def button(hole: list[float]) -> tuple[ForceButton, np.ndarray]:
    """A button over the middle of a triangle in the plane z = 0, whose hole is `hole` (3,) m from it."""
    place = BELOW.mean(axis=0) + hole
    above = BELOW[:, [1, 0, 2]] - BELOW.mean(axis=0)[[1, 0, 2]] + place
    particles, thirds = np.array([[[0, 1, 2], [3, 4, 5]]], dtype=np.int32), np.full((1, 2, 3), 1.0 / 3.0)
    shanks = Shanks(particles, thirds, np.array([LENGTH]), np.array([STIFFNESS]), np.array([DAMPING]))
    return ForceButton(shanks), np.concatenate([BELOW, above])


@pytest.mark.parametrize("up", [-1e-3, 1e-3, 3e-3])
def test_force_is_the_gradient_and_balances_and_is_bounded(up: float) -> None:
    """Below the cloth, along the shank and beyond it; on skewed triangles with weights of their own."""
    rng = np.random.default_rng(7)
    force, positions = button([0.4e-3, -0.3e-3, up])
    positions = positions + 2e-3 * rng.standard_normal(positions.shape) * [[1.0, 1.0, 0.1]]
    weights = rng.uniform(0.1, 1.0, (1, 2, 3))
    force = ForceButton(force.shanks._replace(weights=weights / weights.sum(axis=2, keepdims=True)))
    assert gradient_error(force, positions, 1e-7) < 1e-6
    assert max(balance_error(force, positions)) < 1e-12
    assert 0.05 < stiffness_over_bound(force, positions, np.ones(6), 1e-9) <= 1.0


def test_the_hole_is_free_along_the_shank() -> None:
    for up in (0.0, 0.5 * LENGTH, LENGTH):
        force, positions = button([0.0, 0.0, up])
        assert np.abs(particle_forces(force, positions)).max() < 1e-12
        assert force.gaps(positions) == pytest.approx(0.0, abs=1e-15)


@pytest.mark.parametrize(
    ("hole", "pull"),
    [([1e-4, 0.0, 1e-3], [-2.0, 0.0, 0.0]), ([0.0, 0.0, LENGTH + 5e-5], [0.0, 0.0, -1.0]), ([0.0, 0.0, -1e-4], [0.0, 0.0, 2.0])],
)
def test_beside_the_shank_and_beyond_its_ends_it_pulls_by_the_thread(hole: list[float], pull: list[float]) -> None:
    force, positions = button(hole)
    found = particle_forces(force, positions)
    assert found[3:].sum(axis=0) == pytest.approx(pull, abs=1e-9)
    assert found[:3].sum(axis=0) == pytest.approx(-np.array(pull), abs=1e-9)


def test_yielding_shanks_pull_less_and_are_damped_alike() -> None:
    force, positions = button([1e-4, 0.0, 1e-3])
    soft = ForceButton(force.shanks)
    for softness in (4.0, 64.0):  # the last one counts
        soft.soften(softness)
    assert particle_forces(soft, positions) == pytest.approx(particle_forces(force, positions) / 64.0)
    ratio = [shanks.damping[0] / np.sqrt(shanks.stiffness[0]) for shanks in (force.shanks, soft.shanks)]
    assert ratio[0] == pytest.approx(ratio[1])


def test_what_pulls_beside_tilts_the_shank() -> None:
    """2 N at 1 mm above the cloth turn it by 2 mN.m."""
    force, positions = button([1e-4, 0.0, 1e-3])
    found = particle_forces(force, positions)[:3]
    assert np.cross(BELOW - BELOW.mean(axis=0), found).sum(axis=0) == pytest.approx([0.0, 2e-3, 0.0], abs=1e-9)


@pytest.mark.parametrize("up", [-1e-3, 1e-3, 3e-3])
def test_damping_takes_the_speed_of_what_stretches_it(up: float) -> None:
    """The power of damping is -c (|r|'^2 + e'^2), both by central differences along the motion, of the ways across the shank and beyond its ends; it carries no
    momentum and no torque, and a motion as a whole is not damped."""
    rng = np.random.default_rng(11)
    force, positions = button([0.4e-3, -0.3e-3, up])
    positions = positions + 2e-3 * rng.standard_normal(positions.shape) * [[1.0, 1.0, 0.1]]
    velocities = rng.standard_normal(positions.shape)
    still = particle_forces(force, positions)
    damping = particle_forces(force, positions, velocities) - still

    def left(time_s: float) -> np.ndarray:
        moved = positions + time_s * velocities
        a, b, c = moved[:3]
        n = np.cross(b - a, c - a) / np.linalg.norm(np.cross(b - a, c - a))
        apart = moved[3:].mean(axis=0) - moved[:3].mean(axis=0)
        return np.array([np.linalg.norm(apart - (apart @ n) * n), apart @ n - np.clip(apart @ n, 0.0, LENGTH)])

    rates = (left(1e-7) - left(-1e-7)) / 2e-7
    far = (np.linalg.norm(left(1e-7)) - np.linalg.norm(left(-1e-7))) / 2e-7
    assert force.speeds(positions, velocities) == pytest.approx(abs(far), rel=1e-5)
    assert (damping * velocities).sum() == pytest.approx(-DAMPING * (rates**2).sum(), rel=1e-5)
    assert damping.sum(axis=0) == pytest.approx(0.0, abs=1e-12)
    assert np.cross(positions, damping).sum(axis=0) == pytest.approx(0.0, abs=1e-12)
    as_a_whole = np.array([0.2, 0.1, -0.4]) + np.cross([3.0, -2.0, 1.0], positions)
    assert np.abs(particle_forces(force, positions, as_a_whole) - still).max() < 1e-12 * np.abs(still).max()


def test_a_hole_that_lies_beside_the_shank_is_damped_at_its_end() -> None:
    """A third of a micrometre beside and 10 nm beyond, as the layers of a placket hang: what pulls them apart is damped by all of c."""
    force, positions = button([0.34e-6, 0.0, LENGTH + 1e-8])
    velocities = np.zeros_like(positions)
    velocities[3:, 2] = 1e-4
    damping = particle_forces(force, positions, velocities) - particle_forces(force, positions)
    assert damping[3:].sum(axis=0) == pytest.approx([0.0, 0.0, -1e-4 * DAMPING], rel=1e-6, abs=1e-12)
