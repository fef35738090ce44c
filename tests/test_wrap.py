"""Wrapping is isometric: distances between near points on the panel are kept, whatever the rule, and anchors land where the rule says."""

from __future__ import annotations

import numpy as np
import pytest

from garmentcad.mannequin.mannequin import ArrangementCylinder
from garmentcad.pattern.pattern import Transform, Wrap
from garmentcad.placement.wrap import transform_points, wrap_points

TORSO = ArrangementCylinder(np.array([0.0, 0.0, 0.01]), np.array([0.0, 1.0, 0.0]), np.array([0.0, 0.0, 1.0]), 0.12, 0.17)


@pytest.mark.parametrize(("flare", "spiral"), [(0.0, 0.0), (30.0, 0.0), (-15.0, 0.0), (0.0, 40.0), (0.0, -40.0)])
@pytest.mark.parametrize("turn", [0.0, 25.0])
def test_wrapping_keeps_lengths_and_right_side_out(flare: float, spiral: float, turn: float) -> None:
    wrap = Wrap("torso", (100.0, -50.0), 40.0, 1000.0, offset_mm=20.0, turn_deg=turn, flare_deg=flare, spiral_mm=spiral)
    start = np.random.default_rng(0).uniform(-250.0, 250.0, (60, 2))
    step = 0.05
    here, right, up = (wrap_points(start + shift, wrap, TORSO) for shift in ([0.0, 0.0], [step, 0.0], [0.0, step]))
    du, dv = (right - here) / (step * 1e-3), (up - here) / (step * 1e-3)
    assert np.allclose(np.linalg.norm(du, axis=1), 1.0, atol=2e-3)
    assert np.allclose(np.linalg.norm(dv, axis=1), 1.0, atol=2e-3)
    assert np.allclose((du * dv).sum(axis=1), 0.0, atol=2e-3)
    outward = here - TORSO.origin
    outward[:, 1] = 0.0
    assert ((np.cross(du, dv) * outward).sum(axis=1) > 0.0).all()


def test_anchor_lands_at_angle_and_height() -> None:
    wrap = Wrap("torso", (100.0, -50.0), 90.0, 1000.0, offset_mm=20.0)
    assert np.allclose(wrap_points(np.array([[100.0, -50.0]]), wrap, TORSO), [[0.19, 1.0, 0.01]], atol=1e-6)
    quarter = wrap_points(np.array([[100.0, 0.0]]), Wrap("torso", (100.0, 0.0), 0.0, 500.0, offset_mm=0.0, scale=2.0), TORSO)
    assert np.allclose(quarter, [[0.0, 0.5, 0.25]], atol=1e-9)


def test_half_circle_becomes_a_closed_cone() -> None:
    """A sector of 180 degrees is a cone of half apex angle 30: both straight sides meet behind."""
    radius = 1000.0 * 0.145 / np.sin(np.pi / 6)
    wrap = Wrap("torso", (0.0, -radius), 0.0, 1000.0, offset_mm=0.0, flare_deg=30.0)
    sides = wrap_points(np.array([[-radius, 0.0], [radius, 0.0], [-2 * radius, 0.0], [2 * radius, 0.0]]), wrap, TORSO)
    assert np.allclose(sides[0], sides[1], atol=1e-9)
    assert np.allclose(sides[2], sides[3], atol=1e-9)
    assert sides[2, 1] < sides[0, 1]


def test_ends_on_a_spiral_lie_over_each_other() -> None:
    """After each turn a strip stands as much farther out as the spiral says; its length is that of an Archimedean spiral."""
    round_arm = ArrangementCylinder(np.zeros(3), TORSO.up, TORSO.ref, 0.05, 0.05)
    wrap = Wrap("arm_left", (0.0, 0.0), 0.0, 500.0, offset_mm=0.0, spiral_mm=8.0)
    growth = 8.0 / (2.0 * np.pi)
    radius = np.array([50.0, 58.0, 66.0])
    length = 0.5 * (radius * np.sqrt(radius**2 + growth**2) / growth + growth * np.arcsinh(radius / growth))
    turns = wrap_points(np.column_stack([length - length[0], np.zeros(3)]), wrap, round_arm)
    assert turns == pytest.approx(np.column_stack([np.zeros(3), np.full(3, 0.5), 1e-3 * radius]), abs=1e-7)


def test_a_tapered_sleeve_goes_equally_far_around_everywhere() -> None:
    """One that is cut from a sector of 18 degrees goes around 0.7 of a cone that narrows downward by a half apex angle of asin(18 / 360 / 0.7)."""
    half, taper = np.radians(9.0), np.arcsin(18.0 / 360.0 / 0.7)
    mean = 0.5 * (TORSO.radius_ref + TORSO.radius_side)
    top = 1000.0 * mean / np.sin(taper)
    wrap = Wrap("torso", (0.0, 0.0), 0.0, 500.0, offset_mm=0.0, flare_deg=-float(np.degrees(taper)))
    for down in (0.0, 600.0):
        edge = (top - down) * np.sin(half), (top - down) * np.cos(half) - top
        ends = wrap_points(np.array([[-edge[0], edge[1]], edge]), wrap, TORSO) - TORSO.origin
        assert np.degrees(np.arctan2(ends[:, 0], ends[:, 2])) == pytest.approx([-126.0, 126.0])
        assert ends[:, 1] == pytest.approx(0.5 - 1e-3 * down * np.cos(taper))
        assert np.hypot(ends[:, 0], ends[:, 2]) == pytest.approx(mean - 1e-3 * down * np.sin(taper))


def test_transform_is_extrinsic_x_then_y_then_z() -> None:
    moved = transform_points(np.array([[0.0, 100.0]]), Transform((0.0, 0.0, 10.0), (90.0, 90.0, 0.0)))
    # (0,1,0) -> about x -> (0,0,1) -> about y -> (1,0,0)
    assert np.allclose(moved, [[0.1, 0.0, 0.01]], atol=1e-12)
