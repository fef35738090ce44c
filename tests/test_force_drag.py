"""Air drag: relative to the air, proportional to mass."""

from __future__ import annotations

import numpy as np

from garmentcad.forces.drag import ForceDrag


def drag(force: ForceDrag, velocities: np.ndarray) -> np.ndarray:
    out = np.zeros_like(velocities)
    force.add_forces(np.zeros_like(velocities), velocities, out)
    return out


def test_drag_is_minus_mass_rate_relative_velocity() -> None:
    rng = np.random.default_rng(0)
    masses, velocities = rng.uniform(1.0, 2.0, 50), rng.normal(size=(50, 3))
    np.testing.assert_allclose(drag(ForceDrag(masses, 3.0, (1.0, 0.0, -2.0)), velocities), -3.0 * masses[:, None] * (velocities - [1.0, 0.0, -2.0]), rtol=1e-14)
    assert ForceDrag(masses).energy(velocities) == 0.0


def test_no_drag_when_moving_with_the_air() -> None:
    assert not drag(ForceDrag(np.ones(4), 5.0, (1.0, 2.0, 3.0)), np.tile([1.0, 2.0, 3.0], (4, 1))).any()


def test_rate_and_air_can_be_changed() -> None:
    force = ForceDrag(np.ones(4), 5.0)
    force.set(2.0, (0.0, 0.0, 1.0))
    np.testing.assert_allclose(drag(force, np.ones((4, 3))), np.tile([-2.0, -2.0, 0.0], (4, 1)))


def test_drag_follows_the_mass_that_resists() -> None:
    force = ForceDrag(np.ones(4), 5.0)
    force.set_inertia(np.array([1.0, 2.0, 12.0, 1.0]))
    np.testing.assert_allclose(drag(force, np.ones((4, 3)))[:, 0], [-5.0, -10.0, -60.0, -5.0])
