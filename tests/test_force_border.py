"""Border triangles: uniform strain is exact and damping takes energy."""

from __future__ import annotations

import numpy as np
import pytest
from force_checks import particle_forces
from hand_made import rectangles
from small_cloth import flat, materials, small_cloth
from test_clamped_strip import SHEAR, SLOPE, linear_material

from garmentcad.fabric.law_tension import loading, loading_energy
from garmentcad.forces.border import ForceBorder

CLOTH = small_cloth()
ONE = materials()
ONE = type(ONE)(*(np.repeat(column[:1], 2, axis=0) for column in ONE))  # both rows the first material
CURVES = [tuple(float(column[0, axis]) for column in (ONE.tension_strain, ONE.tension_force, ONE.tension_exponent, ONE.tension_slope)) for axis in (0, 1)]


@pytest.mark.parametrize(("warp", "weft"), [(0.02, 0.0), (0.0, 0.05), (0.06, 0.12), (-0.1, 0.03)])
def test_uniform_strain_is_exact(warp: float, weft: float) -> None:
    force = ForceBorder(CLOTH, ONE)
    positions = flat(CLOTH) * [1.0 + weft, 1.0 + warp, 1.0]
    density = loading_energy(warp, *CURVES[0]) + loading_energy(weft, *CURVES[1])
    area = float(CLOTH.border.area.sum())
    assert force.energy(positions) == pytest.approx(density * area, rel=1e-10)
    # virtual work of widening and of lengthening the strip: tension times area
    work = (particle_forces(force, positions) * flat(CLOTH)).sum(axis=0)
    assert work[0] == pytest.approx(-loading(weft, *CURVES[1])[0] * area, rel=1e-9, abs=1e-12)
    assert work[1] == pytest.approx(-loading(warp, *CURVES[0])[0] * area, rel=1e-9, abs=1e-12)


@pytest.mark.parametrize("gamma", [0.04, -0.3])
def test_uniform_shear_is_exact(gamma: float) -> None:
    weft, warp = flat(CLOTH)[:, 0], flat(CLOTH)[:, 1]
    positions = np.column_stack([weft + np.sin(gamma) * warp, np.cos(gamma) * warp, np.zeros_like(weft)])
    assert ForceBorder(CLOTH, ONE).energy(positions) == pytest.approx(0.5 * 45.0 * gamma**2 * CLOTH.border.area.sum(), rel=1e-10)


def test_damping_takes_energy() -> None:
    velocities = np.random.default_rng(0).normal(size=(CLOTH.particle_count, 3))
    power = np.sum(particle_forces(ForceBorder(CLOTH, ONE, 1e-5), flat(CLOTH), velocities) * velocities)
    assert power < -1e-4


def test_collapsed_triangles_are_finite() -> None:
    for positions in (np.zeros((CLOTH.particle_count, 3)), flat(CLOTH) * [0.0, 1.0, 0.0]):
        assert np.isfinite(particle_forces(ForceBorder(CLOTH, ONE, 1e-5), positions, flat(CLOTH))).all()


def test_no_zigzag_is_without_force() -> None:
    """A band of border triangles against plain triangles of the same linear sheet, assembled here: means over patches make no motion stiffer than these are,
    and none softer than a twentieth of it. (Without a share of their own, triangles of a band at rest were found strained by +29 and -21 %.)"""
    band, step = rectangles(8, 2, 0.01, 1, sewn=False, border=True), 1e-8
    force, rest, count = ForceBorder(band, linear_material()), flat(band), band.particle_count
    laws, plain = np.zeros((2 * count, 2 * count)), np.zeros((2 * count, 2 * count))
    for k in range(2 * count):
        moved = [rest.copy(), rest.copy()]
        for sign, positions in zip((1.0, -1.0), moved):
            positions[k // 2, k % 2] += sign * step
        ahead, behind = (particle_forces(force, positions)[:, :2].ravel() for positions in moved)
        laws[:, k] = (behind - ahead) / (2.0 * step)
    for corners in band.particle_triangles:
        sides = np.column_stack([rest[corners, :2], np.ones(3)])
        x, y = np.linalg.inv(sides)[:2]  # gradients of the corners' shares
        strains, at = np.zeros((3, 6)), np.ravel([[2 * c, 2 * c + 1] for c in corners])
        strains[0, 0::2], strains[1, 1::2], strains[2, 0::2], strains[2, 1::2] = x, y, y, x
        plain[np.ix_(at, at)] += 0.5 * abs(np.linalg.det(sides)) * strains.T @ np.diag([SLOPE, SLOPE, SHEAR]) @ strains
    energy, modes = np.linalg.eigh(plain)
    strained = modes[:, 3:] / np.sqrt(energy[3:])  # all but rigid motion
    share = np.linalg.eigvalsh(strained.T @ laws @ strained)
    assert share.min() > 0.05  # 0.023 by shear alone
    assert share.max() < 1.0 + 1e-6
