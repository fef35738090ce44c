"""Contours against counts and lengths worked out by hand; refused outlines name their place."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
import shapely
from drawn import disc, panel, pattern, rectangle

from garmentcad.cloth.contour import sample_contours
from garmentcad.errors import SpecError
from garmentcad.pattern.pattern import EdgeUse, Seam

DART = [(0, 0), (300, 0), (300, 200), (165, 200), (150, 100), (135, 200), (0, 200)]


def seam(name: str, a, b) -> Seam:
    return Seam(name, tuple(EdgeUse(*use) for use in a), tuple(EdgeUse(*use) for use in b))


def test_edges_are_cut_into_equal_parts_no_longer_than_the_grid() -> None:
    contours, stitches = sample_contours(pattern(rectangle(105, 50)), 10.0)
    contour = contours["front"]
    assert stitches == []
    assert [len(points) for points in contour.edge_points] == [12, 6, 12, 6]
    assert len(contour.points_mm) == 11 + 5 + 11 + 5
    steps = np.hypot(*(contour.points_mm[contour.segments[:, 1]] - contour.points_mm[contour.segments[:, 0]]).T)
    assert steps[:11] == pytest.approx(np.full(11, 105 / 11))
    assert contour.polygon.area == pytest.approx(5250.0, rel=1e-12)
    assert contour.edge_points[3][-1] == 0
    assert not contour.sewn.any()


def test_circle_and_tiny_loops_have_three_points_at_least() -> None:
    circle = sample_contours(pattern(disc(100.0)), 10.0)[0]["disc"]
    assert len(circle.points_mm) == math.ceil(2 * math.pi * 10)
    assert np.hypot(*circle.points_mm.T) == pytest.approx(np.full(63, 100.0))
    assert len(sample_contours(pattern(disc(1.0)), 100.0)[0]["disc"].points_mm) == 3


def test_holes_are_contours_too() -> None:
    holed = panel([(0, 0), (100, 0), (100, 100), (0, 100)], holes=[[(40, 40), (40, 60), (60, 60), (60, 40)]])
    contour = sample_contours(pattern(holed), 10.0)[0]["front"]
    assert contour.loop_start.tolist() == [0, 40, 48]
    assert contour.polygon.area == pytest.approx(10_000 - 400)
    assert contour.segments[47].tolist() == [47, 40]
    assert contour.edge_points[4].tolist() == [40, 41, 42]


def test_seam_over_a_dart_stitches_both_legs_to_one_place() -> None:
    # The top is sewn to a band of equal length; the dart legs are skipped, and are a seam of their own.
    front, band = panel(DART), rectangle(270, 30, name="band")
    sewn = pattern(
        front,
        band,
        seams=(seam("dart", [("front", 3, False)], [("front", 4, True)]), seam("waist", [("front", 6 - 1, True), ("front", 2, True)], [("band", 0, False)])),
    )
    contours, (dart, waist) = sample_contours(sewn, 10.0)
    edges = contours["front"].edge_points
    assert dart[:, 1].tolist() == edges[3][:-1].tolist()  # the apex is one point already
    assert dart[:, 3].tolist() == edges[4][:0:-1].tolist()
    assert len(waist) == 2 * 14 + 2  # 135 mm on each side of the dart; two stitches where it closes
    at_dart = waist[waist[:, 3] == contours["band"].edge_points[0][14]]
    assert set(at_dart[:, 1].tolist()) == {int(edges[5][0]), int(edges[2][-1])}
    assert waist[:, 0].tolist() == [0] * 30
    assert waist[:, 2].tolist() == [1] * 30
    assert contours["front"].sewn.sum() == 2 * 11 + 28
    assert np.all(np.diff(waist[:, 3]) >= 0)


def test_seams_pair_points_at_equal_fractions() -> None:
    sewn = pattern(rectangle(200, 300), rectangle(200, 324, name="back"), seams=(seam("side", [("front", 1, False)], [("back", 3, True)]),))
    contours, (side,) = sample_contours(sewn, 10.0)
    y_a = contours["front"].points_mm[side[:, 1], 1]
    y_b = contours["back"].points_mm[side[:, 3], 1]
    assert y_a == pytest.approx(np.linspace(0, 300, 34))
    assert y_b == pytest.approx(np.linspace(0, 324, 34))


def test_an_edge_belongs_to_one_seam() -> None:
    uses = [("front", 1, False)], [("back", 3, True)]
    sewn = pattern(rectangle(200, 300), rectangle(200, 300, name="back"), seams=(seam("side", *uses), seam("again", *uses)))
    with pytest.raises(SpecError, match=r"seams\.again: edge front\.e1 is sewn in side and in again"):
        sample_contours(sewn, 10.0)


@pytest.mark.parametrize(
    ("points", "holes", "said"),
    [
        ([(0, 0), (0, 100), (100, 100), (100, 0)], (), "the outline runs clockwise"),
        ([(0, 0), (100, 100), (100, 0), (0, 120)], (), r"crosses or touches itself near \(5\d\.\d, 5\d\.\d\)"),
        ([(0, 0), (100, 0), (100, 0.001), (0, 100)], (), "edge e1 has a length of 0.001 mm"),
        ([(0, 0), (100, 0), (100, 100), (0, 100)], [[(40, 40), (60, 40), (60, 60)]], "hole 1 runs counter-clockwise"),
        ([(0, 0), (100, 0), (100, 100), (0, 100)], [[(40, 40), (60, 60), (160, 40)]], "a hole, .*meets the outline"),
        ([(0, 0), (math.nan, 0), (100, 100), (0, 100)], (), "edge e0 has a length of nan mm"),
    ],
)
def test_refused_outlines_name_their_place(points, holes, said) -> None:
    with pytest.raises(SpecError, match=rf"panels\.front: .*{said}"):
        sample_contours(pattern(panel(points, holes=holes)), 10.0)


def test_open_outline() -> None:
    drawn = rectangle(100, 50)
    with pytest.raises(SpecError, match=r"panels\.front: edge e0 ends 50 mm from the start of e2"):
        sample_contours(pattern(replace(drawn, edges=drawn.edges[:1] + drawn.edges[2:])), 10.0)


def test_polygon_is_what_was_drawn() -> None:
    contour = sample_contours(pattern(panel(DART)), 7.0)[0]["front"]
    assert contour.polygon.area == pytest.approx(shapely.Polygon(DART).area, rel=1e-12)
