"""The wrap skirt's draft: sectors of one circle whose fronts overlap, and an inner button that meets its hole where both fronts lie."""

from __future__ import annotations

import math

import pytest
from test_shipped_patterns import drafted, measurements, polygon

from garmentcad.check.examine import examine
from garmentcad.io.shipped import shipped_file
from garmentcad.pattern.runs import side_length

BODIES = ("woman-76", "woman-88", "woman-122")


def turn(point: tuple[float, float]) -> float:
    """Angle of a point about the apex, from straight down, rad."""
    return math.atan2(point[0], -point[1])


@pytest.mark.parametrize("body", BODIES)
def test_fronts_and_back_are_sectors_of_one_circle(body: str) -> None:
    pattern = drafted("wrap-skirt", body)
    radius = (measurements(body)["waist"] + 20.0) / 2.0 / math.radians(60.0)
    for name, share in (("back", 1.0), ("front_over", 0.88), ("front_under", 0.88)):
        area = share * math.radians(60.0) / 2.0 * ((radius + 550.0) ** 2 - radius**2)
        assert polygon(pattern.panels[name]).area == pytest.approx(area, rel=1e-4)
    for seam in pattern.seams:
        assert side_length(pattern, seam.a) == pytest.approx(550.0)
        assert side_length(pattern, seam.b) == pytest.approx(550.0)


@pytest.mark.parametrize("body", BODIES)
def test_the_inner_button_meets_its_hole_where_the_fronts_lie_over_each_other(body: str) -> None:
    """Both lie as far from the right side seam around the waist, and as far below it."""
    pattern = drafted("wrap-skirt", body)
    over, under = pattern.panels["front_over"], pattern.panels["front_under"]
    button, hole = under.drill_holes["corner"], over.drill_holes["inside"]
    assert math.hypot(*button) == pytest.approx(math.hypot(*hole))
    half_ring = math.radians(60.0)
    from_right = turn(hole) - turn(over.points["waist_side"])
    from_left = turn(under.points["waist_side"]) - turn(button)
    assert from_right + from_left == pytest.approx(half_ring, abs=1e-9)


@pytest.mark.parametrize("body", ["woman-76", "woman-88", "woman-122"])
def test_the_doctor_finds_nothing(body: str) -> None:
    assert [str(finding) for finding in examine(shipped_file("patterns", "wrap-skirt"), body)] == []
