"""The sheath dress: Aldrich's close fitting bodice with the bust dart turned into the side seam, and a skirt whose darts meet those of the bodice."""

from __future__ import annotations

import math

import numpy as np
import pytest
import shapely
from test_shipped_patterns import BODIES, drafted, edge_length, measurements, polygon

WOMEN = [body for body in BODIES if body.startswith("woman")]


def turned_back(point: tuple[float, float], pivot: tuple[float, float], angle: float) -> tuple[float, float]:
    """A point turned clockwise about a pivot."""
    x, y = point[0] - pivot[0], point[1] - pivot[1]
    return pivot[0] + math.cos(angle) * x + math.sin(angle) * y, pivot[1] - math.sin(angle) * x + math.cos(angle) * y


def test_the_bust_dart_of_the_book_closed_at_the_shoulder() -> None:
    """Bust 880: a shoulder dart of 70 from the neck point, neck base / 5 - 7 = 67 from centre front, to a point 70 farther out. The bust point stands half
    of (324 + 70) / 2 from centre front and as high as the body's. Turned back by the angle of this dart, the underarm lies on the armhole line again, and half
    of the finished bust reaches from centre to centre."""
    front, back = (drafted("sheath-dress", "woman-88").panels[name] for name in ("front", "back_right"))
    pivot = (98.5, -(15.0 + 1680.0 * (0.863 - 0.72)))
    shoulder_dart = math.atan2(-pivot[1], 67.0 - 98.5) - math.atan2(-pivot[1], 67.0 + 70.0 - 98.5)
    assert math.degrees(shoulder_dart) == pytest.approx(15.6, abs=0.2)
    under = turned_back(front.points["underarm"], pivot, shoulder_dart)
    assert under[1] == pytest.approx(-(15.0 + 210.0 + 15.0)) == pytest.approx(back.points["underarm"][1])
    assert under[0] + back.points["underarm"][0] == pytest.approx((880.0 + 80.0) / 2.0)
    # the shoulder falls by 8 + 210 / 5, in front by 15 more, over 122.5; the armhole takes 10 of it
    tip = turned_back(front.points["shoulder"], pivot, shoulder_dart)
    neck = turned_back((67.0, 0.0), pivot, shoulder_dart)
    assert neck == pytest.approx((67.0 + 70.0, 0.0), abs=1.5), "the book's legs differ by a millimetre"
    assert math.dist(tip, neck) == pytest.approx(112.5)
    assert (neck[1] - tip[1]) / 112.5 == pytest.approx((8.0 + 42.0 + 15.0) / 122.5)
    # the dart in the side seam has the same angle, seen from the bust point
    legs = [front.points[name] for name in ("dart_low", "dart_high")]
    seen = [math.atan2(y - pivot[1], x - pivot[0]) for x, y in legs]
    assert seen[1] - seen[0] == pytest.approx(shoulder_dart)


@pytest.mark.parametrize("body", WOMEN)
def test_girths_and_darts(body: str) -> None:
    panels, given = drafted("sheath-dress", body).panels, measurements(body)
    bodice, skirt = [panels["front"], panels["back_left"], panels["back_right"]], [panels["skirt_front"], panels["skirt_back_left"], panels["skirt_back_right"]]
    assert [sum(edge_length(panel, *(name for name in ("waist", "waist_m") if panel.name.endswith("front") or name == "waist")) for panel in part)
            for part in (bodice, skirt)] == pytest.approx([given["waist"] + 60.0] * 2, abs=1e-6)  # fmt: skip
    level = shapely.LineString([(-1e4, -given["waist_to_hip"]), (1e4, -given["waist_to_hip"])])
    assert sum(polygon(panel).intersection(level).length for panel in skirt) == pytest.approx(given["hip"] + 85.0, abs=0.1)
    under = shapely.LineString([(-1e4, panels["back_right"].points["underarm"][1] - 1e-6), (1e4, panels["back_right"].points["underarm"][1] - 1e-6)])
    assert polygon(panels["back_right"]).intersection(under).length == pytest.approx(panels["back_right"].points["underarm"][0], abs=0.1)
    for panel in (*bodice, *skirt):
        a, b = (np.array(panel.points[f"waist_dart_{end}"]) for end in "ab")
        assert 10.0 < float(np.linalg.norm(a - b)) < 45.0, panel.name
    # the first leg of each waist dart meets that of the skirt: as far from the centre along the waist seam
    for one, other in (("front", "skirt_front"), ("back_right", "skirt_back_right")):
        at = [min(abs(panels[name].points[f"waist_dart_{end}"][0]) for end in "ab") for name in (one, other)]
        assert at[0] == pytest.approx(at[1], abs=0.6)
    low, high, apex = (np.array(panels["front"].points[name]) for name in ("dart_low", "dart_high", "dart_apex"))
    assert np.linalg.norm(low - apex) == pytest.approx(np.linalg.norm(high - apex))
    assert 20.0 < np.linalg.norm(low - high) < 110.0


def test_a_larger_bust_has_a_larger_dart() -> None:
    angles = []
    for body in WOMEN:
        points = drafted("sheath-dress", body).panels["front"].points
        low, high, apex = (np.array(points[name]) for name in ("dart_low", "dart_high", "dart_apex"))
        angles.append(math.acos(float((low - apex) @ (high - apex)) / float(np.linalg.norm(low - apex) * np.linalg.norm(high - apex))))
    assert angles == sorted(angles)
