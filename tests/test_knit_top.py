"""The knit top: smaller than the body, its neckband smaller than its neckline; both go over the head within what the fabric gives."""

from __future__ import annotations

import math

import pytest
import shapely
from test_shipped_patterns import BODIES, drafted, edge_length, measurements, polygon

from garmentcad.io.fabric_file import load_fabric
from garmentcad.io.shipped import shipped_file
from garmentcad.pattern.pattern import Pattern

# By hand: 4.5, 6, 8, 10.25 and 7.5 % less than the bust; 80 more than the waist, for women less a fifteenth of what the bust has beyond 800.
DRAFTED = {
    "woman-76": (725.8, 682.667), "woman-88": (827.2, 794.667), "woman-104": (956.8, 944.0), "woman-122": (1094.95, 1112.0), "man-100": (925.0, 960.0)
}  # fmt: skip


def across(pattern: Pattern, height: float) -> float:
    """Width of front and back together at a height of the draft, mm."""
    level = shapely.LineString([(-1e4, height), (1e4, height)])
    return sum(polygon(pattern.panels[name]).intersection(level).length for name in ("front", "back"))


@pytest.mark.parametrize("body", BODIES)
def test_it_is_smaller_than_the_body(body: str) -> None:
    pattern, given = drafted("knit-top", body), measurements(body)
    bust, waist = DRAFTED[body]
    assert across(pattern, pattern.panels["front"].points["underarm"][1] - 1e-3) == pytest.approx(bust, abs=0.1)
    assert across(pattern, -given["nape_to_waist"]) == pytest.approx(waist, abs=0.1)
    assert across(pattern, -given["nape_to_waist"] - given["waist_to_hip"]) == pytest.approx(0.95 * given["hip"], abs=0.1)


@pytest.mark.parametrize("body", BODIES)
def test_neckband_and_sleeve(body: str) -> None:
    pattern, given = drafted("knit-top", body), measurements(body)
    front, back, sleeve, band = (pattern.panels[name] for name in ("front", "back", "sleeve_left", "neckband"))
    neckline = sum(edge_length(panel, "neck", "neck_m", "neck_side", "neck_side_m") for panel in (front, back))
    assert neckline == pytest.approx(given["neck_base"] + 110.0)
    assert edge_length(band, "top") == pytest.approx(0.9 * neckline)
    armholes = [edge_length(panel, "armhole_top", "armhole", "armhole_low") for panel in (front, back)]
    cap = [edge_length(sleeve, *(f"{part}_{side}" for part in ("crown", "cap", "hollow"))) for side in ("front", "back")]
    assert cap == pytest.approx(armholes)
    # armhole by hand: from the shoulder point down, a quarter circle to the side
    points = front.points
    low = points["underarm"][0] - points["armhole_low"][0]
    top = points["shoulder"][0] - points["armhole_top"][0]
    slope = math.radians(20.0)
    by_hand = top / (1.0 - math.cos(slope)) * slope + points["armhole_top"][1] - points["armhole_low"][1] + 0.5 * math.pi * low
    assert armholes[0] == pytest.approx(by_hand)
    bicep = sleeve.points["underarm_back"][0] - sleeve.points["underarm_front"][0]
    angle = math.radians(54.0)
    assert bicep == pytest.approx(2.0 * armholes[0] * (0.7 * math.sin(angle) / angle + 0.3 * math.cos(angle)))
    assert 0.0 < bicep / given["top_arm"] - 1.0 < 0.3
    assert edge_length(sleeve, "hem") == pytest.approx(given["top_arm"])


def test_the_head_goes_through_within_what_the_fabric_gives() -> None:
    """A head of 575 through the neckband of woman-88, of 432 along the courses: 33 %, at 50 gf/cm of the tester; the single cloth of the neckline 20 %."""
    band = drafted("knit-top", "woman-88").panels["neckband"]
    wanted = 100.0 * (575.0 / edge_length(band, "top") - 1.0)
    courses = load_fabric(shipped_file("fabrics", "interlock-knit")).sheet.EMT.weft.value
    assert wanted == pytest.approx(33.1, abs=0.1)
    assert wanted < courses
