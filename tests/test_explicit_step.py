"""The step of the machine's floor does what it says, particle by particle: otherwise it could be fast by leaving work out."""

from __future__ import annotations

import math

import numba
import numpy as np

from garmentcad.bench.explicit_step import COUNT, Sheet, explicit_steps, flat_sheet, floor_us, inner, springs

OFFSETS = {"near": ((0, 1), (1, 0)), "diagonal": ((1, 1), (1, -1)), "far": ((0, 2), (2, 0))}
LENGTHS = {"near": 1.0, "diagonal": math.sqrt(2.0), "far": 2.0}


def crumpled() -> Sheet:
    """The start with particles moved by a few millimetres and some of them in the ball, moving."""
    sheet, rng = flat_sheet(), np.random.default_rng(7)
    for axis in range(3):
        inner(sheet.positions[axis])[:] += 2e-3 * rng.standard_normal((COUNT, COUNT)) - (0.008 if axis == 1 else 0.0)
        inner(sheet.velocities[axis])[:] = rng.standard_normal((COUNT, COUNT))
    return sheet


def fields(padded: np.ndarray) -> np.ndarray:
    return np.stack([inner(padded[axis]) for axis in range(3)], axis=-1).copy()


def spring_forces(positions: np.ndarray) -> np.ndarray:
    """(n,n,3) N, spring by spring, each acting on both of its ends."""
    constants, force = springs(), np.zeros_like(positions)
    rows = np.arange(COUNT * COUNT).reshape(COUNT, COUNT)
    for kind, offsets in OFFSETS.items():
        for down, right in offsets:
            first = rows[: COUNT - down, max(0, -right) : COUNT - max(0, right)].ravel()
            second = first + down * COUNT + right
            apart = positions.reshape(-1, 3)[second] - positions.reshape(-1, 3)[first]
            length = np.linalg.norm(apart, axis=1, keepdims=True)
            pull = getattr(constants, kind) * (1.0 - LENGTHS[kind] * constants.spacing / length) * apart
            np.add.at(force.reshape(-1, 3), first, pull)
            np.add.at(force.reshape(-1, 3), second, -pull)
    return force


def stepped(positions: np.ndarray, velocities: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    constants = springs()
    dt = constants.time_step
    v = constants.keep * (velocities + dt * constants.inverse_mass * spring_forces(positions) - dt * np.array([0.0, 9.81, 0.0]))
    distance = np.linalg.norm(positions, axis=-1, keepdims=True)
    normal = positions / distance
    leaving = (v * normal).sum(axis=-1, keepdims=True)
    pressed = np.where(distance < constants.reach, np.minimum(leaving, 0.0), 0.0)
    slide = v - leaving * normal
    speed = np.linalg.norm(slide, axis=-1, keepdims=True)
    v = v - pressed * normal - slide * np.minimum(1.0, -constants.friction * pressed / speed)
    return positions + dt * v, v


def test_steps_equal_a_plain_evaluation() -> None:
    sheet = crumpled()
    positions, velocities = fields(sheet.positions), fields(sheet.velocities)
    assert 50 < (np.linalg.norm(positions, axis=-1) < springs().reach).sum() < COUNT * COUNT / 2
    for _ in range(2):
        positions, velocities = stepped(positions, velocities)
    explicit_steps(1, 1, springs(), sheet)
    assert np.allclose(fields(sheet.velocities), velocities, rtol=1e-9, atol=1e-9)
    assert np.allclose(fields(sheet.positions), positions, rtol=0.0, atol=1e-12)


def test_bands_give_the_same_bits() -> None:
    one, three = crumpled(), crumpled()
    explicit_steps(5, 1, springs(), one)
    explicit_steps(5, 3, springs(), three)
    assert np.array_equal(one.positions, three.positions)
    assert np.array_equal(one.velocities, three.velocities)


def test_measuring_leaves_the_threads_as_they_were() -> None:
    before = numba.get_num_threads()
    # Twelve roots and divisions a particle: no core does ten thousand particles in 10 us, and none needs a tenth of a second.
    assert 10.0 < floor_us(1) < 1e5
    assert numba.get_num_threads() == before
