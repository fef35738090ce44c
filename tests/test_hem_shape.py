"""Nodes and shadow of hems drawn by formula; the shadow of a hem that crosses itself against a flood fill."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hand_made import rectangles, tube
from scipy import ndimage
from scipy.signal import find_peaks

from garmentcad.analysis.hem_shape import RAYS, HemShape, hem_shape, node_count, rim

COLUMNS = 90
HEMS = ["front.hem", "back.hem"]


def skirt(radius_of_angle, shift=(0.0, 0.0, 0.0)) -> HemShape | None:
    """Shape of a hem of 2 x 90 stretches of 10 mm at radii [m] by angle, its axis moved by `shift`."""
    cloth = rectangles(COLUMNS, 2, 0.01, 2, sewn=True)
    positions = tube(cloth, COLUMNS, 2, lambda row, angle: radius_of_angle(angle), lambda row: 0.4 + 0.01 * row)
    return hem_shape(cloth, positions + np.array(shift), HEMS)


@pytest.mark.parametrize(("nodes", "wave_m"), [(7, 0.03), (4, 0.0016), (2, 0.05)])
def test_waves_on_a_circle(nodes: int, wave_m: float) -> None:
    """r = R + a cos(n t): n nodes of prominence 2a, area pi (R^2 + a^2/2)."""
    found = skirt(lambda angle: 0.2 + wave_m * np.cos(nodes * angle), shift=(0.1, 0.0, -0.3))
    assert found is not None
    assert found.nodes == nodes
    area = math.pi * (0.2**2 + 0.5 * wave_m**2)
    assert found.shadow_m2 == pytest.approx(area, rel=0.004)  # the hem is a polygon of 180 corners
    assert found.drape_coefficient_percent == pytest.approx(100.0 * area / (1.8**2 / (4.0 * math.pi)), rel=0.004)
    assert found.radius_high_mm == pytest.approx(1000.0 * (0.2 + wave_m), abs=0.5)
    assert found.radius_low_mm == pytest.approx(1000.0 * (0.2 - wave_m), abs=0.5)


def test_waves_below_the_prominence_are_no_nodes() -> None:
    found = skirt(lambda angle: 0.2 + 0.0014 * np.cos(9 * angle))
    assert found is not None
    assert found.nodes == 0


def test_a_ripple_on_a_fold_is_one_node_and_two_only_where_it_stands_out() -> None:
    angle = 2.0 * math.pi * np.arange(RAYS) / RAYS
    split = 0.2 + 0.03 * np.cos(2 * angle) - 0.01 * np.exp(-((angle - math.pi) ** 2) / 0.01)
    assert node_count(split) == 3
    assert node_count(split, prominence_m=0.02) == 2
    for turn in (1, 100, 359):  # wherever the curve is opened
        assert node_count(np.roll(split, turn)) == 3
    assert node_count(np.full(RAYS, 0.2)) == 0


def test_nodes_are_the_peaks_that_scipy_finds() -> None:
    """On random walks that end where they began."""
    random = np.random.default_rng(3)
    counts = []
    for _ in range(300):
        walk = np.cumsum(random.normal(0.0, 1.5e-3, RAYS))
        radius = 0.2 + walk - np.linspace(0.0, walk[-1], RAYS)
        turned = np.roll(radius, -int(radius.argmin()))
        counts.append(len(find_peaks(np.append(turned, turned[0]), prominence=5e-3)[0]))
        assert node_count(radius, prominence_m=5e-3) == counts[-1]
    assert max(counts) > 2 * min(counts) > 0
    # Two maxima of one height with a dent between them that is no fold are one node.
    assert node_count(np.array([0.19, 0.21, 0.209, 0.21, 0.19, 0.2])) == 2


def test_shadow_of_a_hem_that_crosses_itself() -> None:
    """Overhanging folds: (R + a cos nt) turned by b sin(nt) runs back under itself. Against pixels that no way from outside reaches."""
    t = 2.0 * math.pi * np.arange(2000) / 2000
    turned = t + 0.45 * np.sin(6 * t)
    line = (0.2 + 0.06 * np.cos(6 * t))[:, None] * np.column_stack([np.cos(turned), np.sin(turned)])
    radius, area = rim(line)
    step = 5e-4
    fine = np.concatenate([line + share * (np.roll(line, -1, axis=0) - line) for share in np.linspace(0.0, 1.0, 9)])
    pixel = np.round(fine / step).astype(int)
    picture = np.zeros(2 * (pixel.max(axis=0) + 3), dtype=bool)
    picture[tuple((pixel + np.array(picture.shape) // 2).T)] = True
    labels, _ = ndimage.label(~picture)
    filled = (labels != labels[0, 0]).sum() * step**2
    border = 0.5 * picture.sum() * step**2  # about half of each border pixel lies inside
    assert area == pytest.approx(filled - border, rel=0.01)
    assert area > math.pi * 0.2**2 * 1.05
    assert node_count(radius) == 6
    assert radius.max() == pytest.approx(0.26, abs=5e-4)


def test_an_open_hem_has_no_shadow() -> None:
    cloth = rectangles(4, 2, 0.01, 1, sewn=False)
    positions = np.column_stack([cloth.vertex_uv_mm / 1000.0, np.zeros(len(cloth.vertex_uv_mm))])
    assert hem_shape(cloth, positions, ["front.hem"]) is None
    assert hem_shape(cloth, positions, []) is None
    with pytest.raises(KeyError):
        hem_shape(cloth, positions, ["front.nothing"])


def test_two_legs_count_together() -> None:
    """Two tubes side by side: both hems' nodes, shadows and circles."""
    cloth = rectangles(COLUMNS, 1, 0.01, 2, sewn=False)
    rows = cloth.particle_count // 2 // (COLUMNS + 1)
    angle = 2.0 * math.pi * np.arange(COLUMNS + 1) / COLUMNS
    one = np.concatenate([np.column_stack([0.1 * np.sin(angle), np.full(COLUMNS + 1, 0.01 * row), 0.1 * np.cos(angle)]) for row in range(rows)])
    positions = np.concatenate([one, one + np.array([0.3, 0.0, 0.0])])
    particle = cloth.vertex_particle.copy()
    for panel in range(2):  # close each tube on itself
        for row in range(rows):
            first = (panel * rows + row) * (COLUMNS + 1)
            particle[first + COLUMNS] = particle[first]
    object.__setattr__(cloth, "vertex_particle", particle)
    found = hem_shape(cloth, positions, HEMS)
    assert found is not None
    assert found.shadow_m2 == pytest.approx(2.0 * math.pi * 0.01, rel=0.002)
    assert found.drape_coefficient_percent == pytest.approx(100.0 * 2.0 * math.pi * 0.01 / (2.0 * 0.9**2 / (4.0 * math.pi)), rel=0.002)
    assert found.nodes == 0
