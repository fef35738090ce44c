"""The men's shirt: fronts that button over each other, a yoke that reaches over the shoulders, a collar as long as the neckline, cuffs."""

from __future__ import annotations

import math

import numpy as np
import pytest
from test_shipped_patterns import edge_length, polygon, side_ends, side_length

from garmentcad.check.examine import examine
from garmentcad.io.mannequin_file import read_mannequin
from garmentcad.io.shipped import shipped_file
from garmentcad.io.spec_file import read_spec
from garmentcad.pattern.draft import draft
from garmentcad.pattern.pattern import Pattern

SHIRT = shipped_file("patterns", "mens-shirt")
MEN = ("man-84", "man-92", "man-100", "man-116", "man-120")


def drafted(body: str) -> tuple[Pattern, dict[str, float]]:
    given = read_mannequin(body).measurements_mm
    return draft(read_spec(SHIRT), given), given


@pytest.mark.parametrize("body", MEN)
def test_it_drafts_for_all_men(body: str) -> None:
    pattern, _ = drafted(body)
    for name, panel in pattern.panels.items():
        assert polygon(panel).is_valid, name
        assert polygon(panel).exterior.is_ccw, name
        assert min(edge.curve.length for edge in panel.edges) > 3.0, name
    for seam in pattern.seams:
        assert side_length(pattern, seam.a) == pytest.approx((1.0 + seam.ease) * side_length(pattern, seam.b), abs=1e-6), seam.name
    used = [(use.panel, use.edge) for seam in pattern.seams for use in (*seam.a, *seam.b)]
    assert len(used) == len(set(used))


@pytest.mark.parametrize("body", MEN)
def test_girths_with_the_buttons_closed(body: str) -> None:
    pattern, given = drafted(body)
    panels = pattern.panels
    assert 2.0 * (panels["front_left"].points["underarm"][0] + panels["back"].points["underarm"][0]) == pytest.approx(given["bust"] + 180.0)
    assert 2.0 * sum(panels[name].points["hem_side"][0] for name in ("front_left", "back")) == pytest.approx(max(given["bust"] + 180.0, given["hip"] + 100.0))
    neckline = sum(edge_length(panels[name], "neck_side", "neck") for name in ("front_left", "front_right"))
    neckline += edge_length(panels["yoke"], "neck_front", "neck_side", "neck", "neck_front_m", "neck_side_m", "neck_m")
    assert neckline == pytest.approx(given["neck_base"] + 35.0), "from centre front to centre front"
    assert edge_length(panels["stand"], "seam_back", "seam_front", "seam_back_m", "seam_front_m") == pytest.approx(neckline + 36.0)


def test_the_yoke_has_no_shoulder_seam() -> None:
    """The strip before the shoulder line, turned about that line, is what is missing between the fronts and their neck points 20 above the nape."""
    pattern, given = drafted("man-100")
    yoke, front = pattern.panels["yoke"], pattern.panels["front_left"]
    shoulder, neck = (np.array(yoke.points[name]) for name in ("shoulder", "neck"))
    assert neck[1] == pytest.approx(20.0)
    assert math.dist(shoulder, neck) == pytest.approx(given["shoulder"] + 8.0)
    for on_yoke, on_front, at in (("front_shoulder", "shoulder", shoulder), ("front_neck", "neck", neck)):
        out, down = np.array(yoke.points[on_yoke]) - at, np.array(front.points[on_front]) - at
        assert out == pytest.approx(-down), "mirrored about a line square to both"
        assert np.linalg.norm(out) == pytest.approx(28.0)
        assert out @ (shoulder - neck) == pytest.approx(0.0, abs=1e-9)


def test_buttons_lie_on_the_centre_of_both_fronts() -> None:
    pattern, _ = drafted("man-100")
    buttons = [button for button in pattern.buttons if button.button.panel == "front_right"]
    assert [button.buttonhole.panel for button in buttons] == ["front_left"] * 6
    heights = [button.button.uv_mm[1] for button in buttons]
    for button, height in zip(buttons, heights, strict=True):
        assert button.button.uv_mm == pytest.approx((0.0, height))
        assert button.buttonhole.uv_mm == pytest.approx((0.0, height))
    neck, hem = pattern.panels["front_left"].points["neck_edge"][1], pattern.panels["front_left"].points["hem_edge"][1]
    assert heights[0] == pytest.approx(neck - 65.0)
    assert heights[-1] == pytest.approx(hem + 150.0)
    assert np.diff(heights) == pytest.approx([np.diff(heights)[0]] * 5)
    # the left end of the stand, with the buttonhole, ends where the left front does
    ends = {seam.name: side_ends(pattern, seam.a)[1] + " " + side_ends(pattern, seam.b)[1] for seam in pattern.seams}
    assert (ends["neck_left"], ends["neck_right"]) == ("end_m neck_edge", "end neck_edge")


def test_the_leaf_is_sewn_to_the_stand_from_centre_front_to_centre_front() -> None:
    pattern, given = drafted("man-100")
    seams = {seam.name: seam for seam in pattern.seams}
    drop = 2.0 * math.pi * 30.0 * 10.0 / 360.0  # upper edge of a sector of 10 degrees and 30 high, over the whole stand
    share = (given["neck_base"] + 35.0) / (given["neck_base"] + 35.0 + 36.0)
    assert side_length(pattern, seams["collar"].b) == pytest.approx(given["neck_base"] + 35.0 - share * drop)
    assert seams["collar"].fold_angle_deg == 165.0, "toward the right side of the stand"
    leaf = pattern.panels["collar"]
    assert edge_length(leaf, "end") == pytest.approx(math.hypot(70.0, 25.0))
    outer = edge_length(leaf, "outer", "outer_m")
    assert outer > side_length(pattern, seams["collar"].b) + 30.0, "it goes around the stand, and over its seam"


def test_the_collar_closes_after_the_body_the_left_end_over_the_right_one_and_the_leaf_last() -> None:
    pattern, _ = drafted("man-100")
    order = {seam.name: seam.order for seam in pattern.seams}
    later = {"neck_back": 2, "neck_right": 2, "cuff_left": 2, "cuff_right": 2, "neck_left": 3, "collar": 4}
    assert order == {name: later.get(name, 1) for name in order}


@pytest.mark.parametrize("side", ["left", "right"])
def test_a_cuff_goes_around_the_wrist_and_its_ends_over_each_other(side: str) -> None:
    pattern, given = drafted("man-100")
    seam = next(seam for seam in pattern.seams if seam.name == f"cuff_{side}")
    finished = given["wrist"] + 75.0
    assert side_length(pattern, seam.b) == pytest.approx(finished)
    assert side_length(pattern, seam.a) == pytest.approx(given["wrist"] + 125.0), "the rest is gathered"
    cuff = pattern.panels[f"cuff_{side}"]
    assert edge_length(cuff, "low") == pytest.approx(finished + 36.0)
    button = next(button for button in pattern.buttons if button.name == f"button_cuff_{side}")
    apart = np.subtract(button.button.uv_mm, button.buttonhole.uv_mm)
    assert np.abs(apart) == pytest.approx([finished, 0.0]), "what lies between them goes once around"
    sleeve = pattern.panels[f"sleeve_{side}"]
    assert edge_length(sleeve, "placket_front") == pytest.approx(60.0)
    assert edge_length(sleeve, "placket_back") == pytest.approx(60.0)


@pytest.mark.parametrize("body", ["man-92", "man-100", "man-116"])
def test_the_doctor_finds_nothing(body: str) -> None:
    assert [str(finding) for finding in examine(SHIRT, body, 15.0)] == []
