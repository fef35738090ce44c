"""The trousers: Aldrich's block by hand, on the flat pattern and against the body that they go around."""

from __future__ import annotations

import math

import numpy as np
import pytest
import shapely
import trimesh
from test_shipped_patterns import BODIES, drafted, edge_length, interior_angle, measurements, polygon

from garmentcad.io.mannequin_file import read_mannequin
from garmentcad.io.shipped import shipped_file
from garmentcad.io.spec_file import read_spec
from garmentcad.pattern.draft import draft


def test_the_block_by_hand() -> None:
    """Hip 960, waist 720, waist line 1041.6, hip line 835.6, crotch 772.8, knee not used. Of the book's points, in mm from the crease line and from the waist
    seam, which lies 42 below the waist line: 5 at -95, 6-8 = 245, 5-9 = 65, 16 at -71.25, 17-25 = 255, 9-23 = 32.5; the crotch 268.8 + 15 - 42 lower."""
    pattern = drafted("trousers", "woman-88")
    front, back = pattern.panels["front_left"], pattern.panels["back_right"]
    assert front.points["hip_center"] == pytest.approx((-95.0, -164.0))
    assert front.points["hip_side"] == pytest.approx((150.0, -164.0))
    assert front.points["fork"] == pytest.approx((-160.0, -241.8))
    assert front.points["waist_center"] == pytest.approx((-85.0, 0.0))
    assert front.points["waist_side"] == pytest.approx((-85.0 + 185.0 + 20.0, 0.0))
    assert back.points["hip_side"] == pytest.approx((-71.25 + 255.0, -164.0))
    assert back.points["fork"][0] == pytest.approx(-160.0 - 32.5)
    assert -241.8 - 8.0 < back.points["fork"][1] < -241.8, "the book lowers it by 5; here by what makes both inside legs as long"
    assert back.points["seat"] == pytest.approx((-71.25, -241.8 + 283.8 / 2.0))
    # the centre back leans by 20 from the seat point to 20 above the waist line; drawn to 20 above the seam
    assert back.points["waist_center"] == pytest.approx((-71.25 + 20.0 * (20.0 + 99.9) / (20.0 + 141.9), 20.0))
    assert back.points["waist_side"][1] == pytest.approx(0.0, abs=3.0), "the book's corner lies on the waist line"
    # knee half-way from crotch to floor, 50 up: (-241.8 - 999.6) / 2 + 50; front 2 (105 + 13) wide, back 20 more
    assert [abs(front.points[name][0]) for name in ("hem_in", "hem_out", "knee_in", "knee_out")] == pytest.approx([105.0, 105.0, 118.0, 118.0])
    assert front.points["knee_in"][1] == pytest.approx(-570.7)
    assert back.points["knee_out"] == pytest.approx((128.0, -570.7))


@pytest.mark.parametrize("body", BODIES)
def test_girths_and_crotch(body: str) -> None:
    pattern, given = drafted("trousers", body), measurements(body)
    front, back, band = (pattern.panels[name] for name in ("front_left", "back_right", "waistband"))
    assert 2.0 * (edge_length(front, "waist") + edge_length(back, "waist")) == pytest.approx(given["waist"] + 20.0, abs=1e-6)
    assert edge_length(band, "top") == pytest.approx(given["waist"] + 20.0)
    intakes = [math.dist(panel.points[f"{dart}_a"], panel.points[f"{dart}_b"]) for panel, dart in ((front, "dart"), (back, "dart_center"), (back, "dart_side"))]
    assert intakes == pytest.approx([20.0, 20.0, 20.0])
    level = front.points["hip_side"][1] - 1e-6
    across = [polygon(panel).intersection(shapely.LineString([(-1e4, level), (1e4, level)])).length for panel in (front, back)]
    assert across[0] == pytest.approx(given["hip"] / 4.0 + 5.0, abs=0.5)
    assert across[1] > given["hip"] / 4.0 + 15.0, "and what the seat curve has gained there"
    assert 30.0 < 2.0 * sum(across) - given["hip"] < 90.0
    # the crotch seams meet at the fork without a step, and the thigh goes in
    for panel in (front, back):
        crotch = next(edge for edge in panel.edges if edge.name == "crotch")
        assert crotch.curve.tangents_at(1.0 if crotch.end == "fork" else 0.0)[0][1] == pytest.approx(0.0, abs=1e-6)
        assert 55.0 < interior_angle(panel, "fork") < 90.0
    low = front.points["fork"][1] - 20.0
    thigh = sum(polygon(panel).intersection(shapely.LineString([(-1e4, low), (1e4, low)])).length for panel in (front, back))
    assert 60.0 < thigh - given["thigh"] < 190.0


@pytest.mark.parametrize("mannequin", ["woman-76", "woman-122", "man-100"])
def test_the_crotch_seam_goes_around_the_body(mannequin: str) -> None:
    """Against the section of the body at the middle, from the height of the waist seam through the crotch: longer, by what a hand can hold."""
    body = read_mannequin(mannequin)
    pattern = draft(read_spec(shipped_file("patterns", "trousers")), body.measurements_mm)
    seam = sum(edge_length(pattern.panels[name], "center", "crotch") for name in ("front_left", "back_right"))
    below = body.measurements_mm["waist_height"] - pattern.values["band_below"]
    section = trimesh.intersections.mesh_plane(trimesh.Trimesh(body.vertices, body.faces, process=False), [1, 0, 0], [4e-4, 0, 0])
    heights = 1e3 * section[..., 1]
    section = section[(heights.max(axis=1) <= below) & (heights.min(axis=1) > body.measurements_mm["crotch_height"] - 50.0)]
    around = 1e3 * float(np.linalg.norm(section[:, 0] - section[:, 1], axis=1).sum())
    assert 30.0 < seam - around < 90.0


def test_a_straight_figure_wears_them_lower() -> None:
    assert drafted("trousers", "woman-88").values["band_below"] == 42.0
    assert drafted("trousers", "man-100").values["band_below"] == pytest.approx(42.0 + 0.9 * 80.0)
