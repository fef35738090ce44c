"""Contact pressure against equilibrium of a tight tube and a resting sheet."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hand_made import flat, rectangles, tube

from garmentcad.analysis.pressure import contact_pressure
from garmentcad.analysis.tributary import draped_areas


def test_sheet_on_a_table_presses_with_its_weight() -> None:
    cloth = rectangles(10, 10, 0.01, 1, sewn=False)
    positions = flat(cloth)[:, [0, 2, 1]] + [0.0, 1e-3, 0.0]
    force = np.zeros_like(positions)
    force[:, 1] = -9.81 * 0.12 * 0.25e-4 * np.bincount(cloth.cells.corners.ravel())  # a quarter of each cell, as a lattice shares its mass
    normal = np.tile([0.0, 1.0, 0.0], (len(positions), 1))
    found = contact_pressure(force, normal, positions[:, 1], 1e-3, draped_areas(cloth, positions)).summary()
    assert found["mean_in_contact"] == pytest.approx(0.12 * 9.81 / 1000.0)
    assert found["max"] == pytest.approx(0.12 * 9.81 / 1000.0)


def test_tight_tube_obeys_the_hoop_law() -> None:
    """p = T / r: a polygon of links under tension T per width around a cylinder; its corners carry 2 T sin(pi/n) per side of 2 r sin(pi/n)."""
    columns, panels, radius, tension = 30, 2, 0.1, 50.0
    side = 2.0 * radius * math.sin(math.pi / 60)
    cloth = rectangles(columns, 5, side, panels, sewn=True)
    positions = tube(cloth, columns, panels, lambda row, angle: np.full_like(angle, radius), lambda row: row * side)
    ends = cloth.links.ends[cloth.links.direction == 1]
    width = cloth.links.width[cloth.links.direction == 1]
    pull = positions[ends[:, 1]] - positions[ends[:, 0]]
    pull *= (tension * width / np.linalg.norm(pull, axis=1))[:, None]
    force = np.zeros_like(positions)
    np.add.at(force, ends[:, 0], pull)
    np.add.at(force, ends[:, 1], -pull)
    normal = positions * [1.0, 0.0, 1.0] / radius
    pressure = contact_pressure(force, normal, np.full(len(positions), 1e-3), 1e-3, draped_areas(cloth, positions))
    assert pressure.kpa == pytest.approx(tension / radius / 1000.0, rel=1e-9)


def test_sheet_on_a_slope_rests_on_pressure_and_friction() -> None:
    """p = W g cos t, s = W g sin t; together they carry the weight, and each has the upward part that its direction says."""
    cloth, angle = rectangles(6, 4, 0.01, 1, sewn=False), math.radians(25.0)
    along, normal = np.array([math.cos(angle), math.sin(angle), 0.0]), np.array([-math.sin(angle), math.cos(angle), 0.0])
    positions = flat(cloth)[:, :1] * along + flat(cloth)[:, 1:2] * [0.0, 0.0, -1.0] + 1e-3 * normal
    force = np.zeros_like(positions)
    force[:, 1] = -9.81 * 0.12 * 0.25e-4 * np.bincount(cloth.cells.corners.ravel())
    found = contact_pressure(force, np.tile(normal, (len(positions), 1)), positions @ normal, 1e-3, draped_areas(cloth, positions))
    assert found.kpa == pytest.approx(0.12 * 9.81e-3 * math.cos(angle))
    assert found.friction_kpa == pytest.approx(0.12 * 9.81e-3 * math.sin(angle))
    weight = 0.12 * 9.81 * 24e-4
    support = {"weight": weight, "normal": weight * math.cos(angle) ** 2, "friction": weight * math.sin(angle) ** 2}
    assert found.support_n(weight) == pytest.approx(support)
    assert found.contact_area_m2() == pytest.approx(24e-4)


def test_pull_and_distance_do_not_count() -> None:
    force = np.array([[0.0, -1.0, 0.0], [0.0, 1.0, 0.0], [0.0, -3.0, 0.0], [0.0, -2.0, 0.0]])
    normal = np.tile([0.0, 1.0, 0.0], (4, 1))
    found = contact_pressure(force, normal, np.array([1.0e-3, 1.0e-3, 1.6e-3, 1.4e-3]), 1e-3, np.array([1e-3, 1e-3, 1e-3, 3e-3]))
    assert found.in_contact.tolist() == [True, True, False, True]
    assert found.kpa == pytest.approx([1.0, 0.0, 0.0, 2.0 / 3.0])
    assert found.summary()["mean_in_contact"] == pytest.approx((1.0 + 0.0 + 2.0) / 5.0)
    nothing = contact_pressure(force, normal, np.ones(4), 1e-3, np.ones(4)).summary()
    assert nothing == {"max": None, "mean_in_contact": None, "p95": None}
