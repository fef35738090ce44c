"""Lays are rigid, small, repeatable, and differ from panel to panel and from seed to seed."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from drawn import pattern, rectangle
from hand_made import cylinder_body

from garmentcad.pattern.pattern import Transform, Wrap
from garmentcad.placement.wrap import transform_points, wrap_points
from garmentcad.simulation.job import Job
from garmentcad.simulation.lay import DISPLACED_MM, TURNED_DEG, displaced

CORNERS = np.array([[0.0, 0.0], [200.0, 0.0], [200.0, 100.0], [0.0, 100.0]])
FLAT = Transform((10.0, 1000.0, 300.0), (0.0, 0.0, 30.0))
WRAP = Wrap("torso", (100.0, 50.0), 90.0, 1100.0, 30.0, 1.0, 0.0, 0.0)


def job() -> Job:
    panels = [replace(rectangle(200.0, 100.0, name=name), placement=rule) for name, rule in (("flat", FLAT), ("other", FLAT), ("wrapped", WRAP))]
    return Job(None, pattern(*panels), {}, cylinder_body())  # type: ignore[arg-type]


def corners(laid: Job) -> dict[str, np.ndarray]:
    """World points of the corners of each panel, m."""
    body = laid.mannequin.cylinders["torso"]
    rules = {name: panel.placement for name, panel in laid.pattern.panels.items()}
    return {name: wrap_points(CORNERS, rule, body) if isinstance(rule, Wrap) else transform_points(CORNERS, rule) for name, rule in rules.items()}


def test_panels_move_rigidly_and_little() -> None:
    before = corners(job())
    reach = {"flat": np.hypot(200.0, 100.0), "wrapped": np.hypot(100.0, 50.0)}  # from the point about which a panel turns, mm
    for seed in range(40):
        after = corners(displaced(job(), seed))
        for name in reach:
            way = 1000.0 * np.linalg.norm(after[name] - before[name], axis=1)
            assert 0.0 < way.max() <= 1.05 * (DISPLACED_MM + np.deg2rad(TURNED_DEG) * reach[name])
        np.testing.assert_allclose(np.linalg.norm(np.diff(after["flat"], axis=0), axis=1), [0.2, 0.1, 0.2], atol=1e-12)


def test_lays_are_repeatable_and_differ() -> None:
    one, again, other = (corners(displaced(job(), seed)) for seed in (3, 3, 4))
    for name, points in one.items():
        np.testing.assert_array_equal(points, again[name])
        assert np.abs(points - other[name]).max() > 1e-4
    assert np.abs(one["flat"] - one["other"]).max() > 1e-4


def test_the_whole_range_is_used() -> None:
    turns = [displaced(job(), seed).pattern.panels["wrapped"].placement.turn_deg for seed in range(200)]  # type: ignore[union-attr]
    assert min(turns) < -0.9 * TURNED_DEG
    assert max(turns) > 0.9 * TURNED_DEG
    heights = [displaced(job(), seed).pattern.panels["wrapped"].placement.height_mm - 1100.0 for seed in range(200)]  # type: ignore[union-attr]
    assert -DISPLACED_MM <= min(heights) < -0.6 * DISPLACED_MM
    assert DISPLACED_MM >= max(heights) > 0.6 * DISPLACED_MM
