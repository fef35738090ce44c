"""Seam hinges: sign, rest angle and stiffness."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from force_checks import particle_forces
from small_cloth import H, flat, materials, small_cloth

from garmentcad.arrays import floats, indices
from garmentcad.cloth.cloth import Hinges
from garmentcad.forces.hinge import ForceHinge

MATERIALS = materials()


def folded(angle: float, rest: float = 0.0, across_warp: tuple[float, float] = (1.0, 1.0)) -> tuple[ForceHinge, np.ndarray]:
    """One hinge over the edge from particle 1 up to particle 6; its right wing (7 or 2) is folded toward the right side (+z) by `angle`."""
    cloth = small_cloth()
    sizes = floats([0.01]), floats([1.0]), floats([rest]), floats([2.0])
    hinge = Hinges(indices([[1, 6, 0, 7]]), *sizes, indices([[0, 1]]), floats([across_warp]), indices([-1]))
    positions = flat(cloth)
    positions[7] = positions[6] + H * np.array([math.cos(angle), 0.0, math.sin(angle)])
    return ForceHinge(replace(cloth, hinges=hinge), MATERIALS), positions


@pytest.mark.parametrize("angle", [-3.0, -0.4, 0.0, 1e-7, 0.4, 2.0, 3.1])
def test_energy_and_moment(angle: float) -> None:
    force, positions = folded(angle, rest=0.2)
    stiffness = 2.0 * 0.5 * (MATERIALS.bending[0, 0] + MATERIALS.bending[1, 0])  # factor, mean of both sides, length^2/(A_a + A_b) = 1
    assert force.energy(positions) == pytest.approx(0.5 * stiffness * (angle - 0.2) ** 2, rel=1e-7)
    square = np.array([-math.sin(angle), 0.0, math.cos(angle)])
    assert particle_forces(force, positions)[7] @ square * H == pytest.approx(-stiffness * (angle - 0.2), rel=1e-7)


def test_stiffness_across_the_edge() -> None:
    # B at an angle to the warp: B_warp c^4 + B_weft s^4 + 4 D66 c^2 s^2, the mean over both sides
    c = math.cos(math.radians(30.0))
    force, positions = folded(0.5, across_warp=(c, 0.0))
    (warp, weft), other = MATERIALS.bending[0], MATERIALS.bending[1, 1]
    side = warp * c**4 + weft * (1 - c * c) ** 2 + 4 * MATERIALS.twist[0] * c * c * (1 - c * c)
    assert force.energy(positions) == pytest.approx(0.5 * 2.0 * 0.5 * (side + other) * 0.25, rel=1e-9)


def test_a_wing_on_the_edge_is_finite() -> None:
    force, positions = folded(0.5)
    positions[7] = positions[6]
    assert np.isfinite(particle_forces(force, positions)).all()
    assert np.isfinite(particle_forces(force, np.zeros_like(positions))).all()
