"""Elastics and belts: gradient, balance and stiffness bound; tension of a ring against closed form; where bands run on a pattern."""

from __future__ import annotations

import math

import numpy as np
import pytest
from drawn import rectangle
from force_checks import balance_error, gradient_error, particle_forces, stiffness_over_bound
from small_cloth import materials

from garmentcad.cloth.lattice import build_cloth
from garmentcad.cloth.weld import weld
from garmentcad.errors import SpecError
from garmentcad.forces.band import BandSegments, ForceBand, no_bands
from garmentcad.forces.band_lines import band_segments
from garmentcad.pattern.pattern import Band, EdgeUse, PanelPoint, Pattern, Seam


def ring(count: int, one_group: bool, rest_m: float, stiffness: float = 50.0) -> BandSegments:
    """A ring over `count` particles."""
    ends = np.column_stack([np.arange(count), np.roll(np.arange(count), -1)])
    groups = 1 if one_group else count
    return BandSegments(
        np.repeat(ends[:, :, None], 3, axis=2).astype(np.int32), np.tile([1.0, 0.0, 0.0], (count, 2, 1)), np.ones(count),
        np.array([0, count] if one_group else range(count + 1), dtype=np.int32), np.full(groups, rest_m / groups), np.full(groups, stiffness),
        np.zeros(groups, dtype=np.int32),
    )  # fmt: skip


def random_band(one_group: bool) -> tuple[ForceBand, np.ndarray]:
    """Seven segments between weighted points of twelve particles."""
    rng = np.random.default_rng(3)
    positions = rng.standard_normal((12, 3))
    points, weights = rng.integers(0, 12, (8, 3)).astype(np.int32), rng.uniform(0.1, 1.0, (8, 3))
    weights /= weights.sum(axis=1, keepdims=True)
    ends = np.column_stack([np.arange(7), np.arange(1, 8)])
    groups = 1 if one_group else 7
    start = np.array([0, 7] if one_group else range(8), dtype=np.int32)
    share = np.array([1.0, 4.0 / 3.0, -1.0 / 6.0, 1.0, 1.0, -0.2, 1.0]) if one_group else np.ones(7)
    rest, stiffness = np.full(groups, 1.0 / groups), np.full(groups, 3.0)
    made = ForceBand(BandSegments(points[ends], weights[ends], share, start, rest, stiffness, np.zeros(groups, dtype=np.int32)))
    return made, positions


@pytest.mark.parametrize("one_group", [False, True])
def test_force_is_the_gradient_and_balances_and_is_bounded(one_group: bool) -> None:
    force, positions = random_band(one_group)
    assert gradient_error(force, positions, 1e-5) < 1e-8
    assert max(balance_error(force, positions)) < 1e-13
    assert 0.05 < stiffness_over_bound(force, positions, np.ones(12)) <= 1.0


@pytest.mark.parametrize("one_group", [False, True])
def test_a_ring_presses_by_its_tension(one_group: bool) -> None:
    """Stretched around a circle of n points at radius r: T = k (2 n r sin(pi/n)/L0 - 1), and inward 2 T sin(pi/n) at each point."""
    count, radius, rest = 24, 0.12, 0.6
    angle = 2.0 * math.pi * np.arange(count) / count
    outward = np.column_stack([np.cos(angle), np.zeros(count), np.sin(angle)])
    force = ForceBand(ring(count, one_group, rest))
    tension = 50.0 * (2.0 * count * radius * math.sin(math.pi / count) / rest - 1.0)
    assert force.tensions(radius * outward) == pytest.approx(tension, rel=1e-12)
    assert particle_forces(force, radius * outward) == pytest.approx(-2.0 * tension * math.sin(math.pi / count) * outward, abs=1e-12)
    # slack: it folds
    assert np.abs(particle_forces(force, 0.7 * radius * outward)).max() == 0.0
    assert force.energy(0.7 * radius * outward) == 0.0


def test_a_belt_shares_its_tension_and_an_elastic_does_not() -> None:
    count = 24
    angle = 2.0 * math.pi * np.arange(count) / count
    oval = np.column_stack([0.16 * np.cos(angle), np.zeros(count), 0.10 * np.sin(angle)])
    assert len(set(np.round(ForceBand(ring(count, True, 0.6)).tensions(oval), 12))) == 1
    elastic = ForceBand(ring(count, False, 0.6)).tensions(oval)
    assert elastic.max() > 1.3 * elastic.min()


def tube() -> Pattern:
    """Two rectangles of 200 x 100 mm sewn into a tube of 400 mm."""
    front, back = rectangle(200.0, 100.0, name="front"), rectangle(200.0, 100.0, name="back")
    right, left = 1, 3
    seams = (
        Seam("one", (EdgeUse("front", right, False),), (EdgeUse("back", left, True),)),
        Seam("two", (EdgeUse("front", left, True),), (EdgeUse("back", right, False),)),
    )
    return Pattern("tube", {"front": front, "back": back}, seams, "", "", {}, {})


def segments_of(*bands: Band) -> tuple[BandSegments, ForceBand, np.ndarray]:
    made = tube()
    made = Pattern(made.name, made.panels, made.seams, "", "", {}, {}, bands=bands)
    flat = build_cloth(made, lambda _, points: np.zeros(len(points), dtype=np.int32), materials(), 10.0)
    cloth, _ = weld(flat)
    angle = (cloth.vertex_uv_mm[:, 0] + 200.0 * cloth.vertex_panel) / 400.0 * 2.0 * math.pi
    at_vertex = np.column_stack([0.1 * np.cos(angle), cloth.vertex_uv_mm[:, 1] / 1000.0, -0.1 * np.sin(angle)])
    positions = np.empty((cloth.particle_count, 3))
    positions[cloth.vertex_particle] = at_vertex
    found = band_segments(made, cloth)
    return found, ForceBand(found), positions


def test_an_elastic_along_edges_goes_round_and_rests_by_its_ratio() -> None:
    top = 2
    found, force, positions = segments_of(Band("waist", ((EdgeUse("front", top, True),), (EdgeUse("back", top, True),)), 30.0, ratio=0.8))
    assert found.rest.sum() == pytest.approx(0.8 * 0.4)
    degree = np.bincount(found.particles[found.share == 1.0, :, 0].ravel())
    assert set(degree[degree > 0]) == {2}  # closed where the side seams are welded
    assert force.lengths(positions).sum() == pytest.approx(2.0 * math.pi * 0.1, rel=2e-3)


def test_a_belt_on_straight_lines_is_one_ring_of_its_length() -> None:
    lines = tuple((PanelPoint(panel, "a", (0.0, 55.0)), PanelPoint(panel, "b", (200.0, 55.0))) for panel in ("front", "back"))
    found, force, positions = segments_of(Band("belt", lines, 500.0, length_mm=350.0))
    assert found.rest == pytest.approx([0.35])
    around = 2.0 * math.pi * 0.1  # on chords of 10 mm of 400
    assert force.lengths(positions)[0] == pytest.approx(around, rel=2e-3)
    assert force.tensions(positions)[0] == pytest.approx(500.0 * (around / 0.35 - 1.0), rel=5e-3)


def test_a_line_off_the_panel_is_refused_and_no_bands_are_none() -> None:
    with pytest.raises(SpecError, match="outside the panel"):
        segments_of(Band("belt", ((PanelPoint("front", "a", (0.0, 120.0)), PanelPoint("front", "b", (200.0, 120.0))),), 5.0, length_mm=350.0))
    assert len(segments_of()[0].rest) == len(no_bands().rest) == 0
