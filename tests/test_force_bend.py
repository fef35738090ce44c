"""Bending lines: M = B kappa at any curvature, interpolated arms, and folds that are finite."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from force_checks import particle_forces
from small_cloth import COLUMNS, ROWS, H, flat, materials, small_cloth

from garmentcad.cloth.cloth import WEFT
from garmentcad.forces.bend import ForceBend, across_lines
from garmentcad.forces.lattice import ForceLattice

CLOTH, MATERIALS = small_cloth(), materials()


def only(mask: np.ndarray) -> ForceBend:
    return ForceBend(type(CLOTH.bends)(*(column[mask] for column in CLOTH.bends)), across_lines(CLOTH.bends)[mask], MATERIALS)


def only_in_lattice(mask: np.ndarray) -> ForceLattice:
    bends = CLOTH.bends._replace(width=np.where(mask, CLOTH.bends.width, 0.0))
    return ForceLattice(replace(CLOTH, bends=bends), MATERIALS, ("bend",))


def one_line(turn: float, length: float = H, make=only) -> tuple[ForceBend | ForceLattice, np.ndarray, int]:
    """A single weft line whose end is turned up by `turn`; its centre's index. make: as a line of its own, or in the rows of the lattice."""
    chosen = int(np.flatnonzero((CLOTH.bends.direction == WEFT) & (CLOTH.bends.weight_a == 0) & (CLOTH.bends.weight_b == 0))[0])
    positions = flat(CLOTH)
    center, end = CLOTH.bends.center[chosen], CLOTH.bends.arm_b[chosen, 0]
    positions[end] = positions[center] + length * np.array([math.cos(turn), 0.0, math.sin(turn)])
    return make(np.arange(len(CLOTH.bends.center)) == chosen), positions, chosen


@pytest.mark.parametrize("make", [only, only_in_lattice])
@pytest.mark.parametrize("turn", [1e-9, 1e-4, 0.05, 0.1001, 0.5, 1.6, 3.0, 3.14159])
def test_moment_is_b_times_curvature(turn: float, make) -> None:
    force, positions, chosen = one_line(turn, make=make)
    stiffness = MATERIALS.bending[CLOTH.bends.material[chosen], WEFT] * CLOTH.bends.width[chosen]
    assert force.energy(positions) == pytest.approx(0.5 * stiffness * turn**2 / H, rel=1e-6)
    # the force on the end, times its arm, is the moment B w t/h
    end = particle_forces(force, positions)[CLOTH.bends.arm_b[chosen, 0]]
    assert np.linalg.norm(end) * H == pytest.approx(stiffness * turn / H, rel=1e-6)
    assert end @ [math.cos(turn), 0.0, math.sin(turn)] == pytest.approx(0.0, abs=1e-9 * float(np.linalg.norm(end)))


def test_a_rolled_cloth_has_cylinder_energy() -> None:
    # weft rolled on a cylinder: kappa is the same in all weft lines, interpolated arms included to second order in h/R
    radius = 0.05
    angle = flat(CLOTH)[:, 0] / radius
    positions = np.column_stack([radius * np.sin(angle), flat(CLOTH)[:, 1], radius * np.cos(angle)])
    lines = CLOTH.bends
    weft = lines.direction == WEFT
    area = lines.width[weft] * 0.5 * (lines.length_a + lines.length_b)[weft]
    expected = float(np.sum(0.5 * MATERIALS.bending[lines.material[weft], WEFT] * area / radius**2))
    assert only(weft).energy(positions) == pytest.approx(expected, rel=0.01)
    assert only(~weft).energy(positions) == pytest.approx(0.0, abs=1e-12 * expected)


@pytest.mark.parametrize("make", [only, only_in_lattice])
def test_folded_flat_and_zero_arms_are_finite(make) -> None:
    for turn, length in ((math.pi, H), (0.3, 0.0), (0.3, 1e-12 * H), (math.pi, 1e-6 * H)):
        force, positions, _ = one_line(turn, length, make)
        forces = particle_forces(force, positions)
        assert np.isfinite(forces).all()
        assert np.abs(forces).max() < 2.0 * MATERIALS.bending.max() * CLOTH.bends.width.max() / H**2 * math.pi
    everything = make(np.ones(len(CLOTH.bends.center), dtype=bool))
    assert np.isfinite(particle_forces(everything, np.zeros((COLUMNS * ROWS + ROWS + 1, 3)))).all()


def test_flat_cloth_has_no_force() -> None:
    for force in (ForceBend(CLOTH.bends, across_lines(CLOTH.bends), MATERIALS), ForceLattice(CLOTH, MATERIALS, ("bend",))):
        assert np.abs(particle_forces(force, flat(CLOTH))).max() < 1e-15
