"""Seam matching against hand-computed places."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from drawn import rectangle

from garmentcad.check.seam import check_seams
from garmentcad.cloth.seam_match import match_seam
from garmentcad.errors import SpecError
from garmentcad.pattern.draft import draft
from garmentcad.pattern.parse import parse_spec
from garmentcad.pattern.pattern import EdgeUse, Seam
from garmentcad.pattern.runs import side_notches

RIGHT, LEFT, BOTTOM, TOP = 1, 3, 0, 2


def seam(a, b) -> Seam:
    return Seam("side", tuple(EdgeUse(*use) for use in a), tuple(EdgeUse(*use) for use in b))


def test_both_sides_get_equal_parts_by_the_longer_side() -> None:
    panels = {"front": rectangle(200, 300), "back": rectangle(200, 324, name="back")}
    match = match_seam(seam([("front", RIGHT, False)], [("back", LEFT, True)]), panels, 10.0)
    assert match.count == 34  # 324 mm in parts of at most 10 mm
    assert match.fractions_a[0] == pytest.approx(np.linspace(0, 1, 34), abs=1e-12)
    assert match.fractions_b[0] == pytest.approx(np.linspace(0, 1, 34), abs=1e-12)
    assert match.fractions_a[0][[0, -1]].tolist() == match.fractions_b[0][[0, -1]].tolist() == [0.0, 1.0]


def test_notches_meet_and_ease_is_spread_between_them() -> None:
    # 1/4 of side a meets 1/2 of side b; b is used backward.
    panels = {
        "front": rectangle(200, 200, notches={RIGHT: (("hip", 0.25), ("only here", 0.6))}),
        "back": rectangle(200, 200, name="back", notches={LEFT: (("hip", 0.5),)}),
    }
    match = match_seam(seam([("front", RIGHT, False)], [("back", LEFT, True)]), panels, 20.0)
    a, b = match.fractions_a[0], 1.0 - match.fractions_b[0][::-1]
    assert match.count == 1 + 5 + 8  # max(50, 100)/20 and max(150, 100)/20 parts
    assert a[5] == pytest.approx(0.25)
    assert b[5] == pytest.approx(0.5)
    assert np.diff(a[:6]) == pytest.approx(np.full(5, 0.05))
    assert np.diff(b[5:]) == pytest.approx(np.full(8, 0.0625))


def test_vertices_of_either_side_are_samples_and_close_ones_are_sewn_together() -> None:
    # Side a: 100 + 100 mm; side b: 60.4 + 139.6 mm; and once nearly equal.
    a = {"a1": rectangle(100, 50, name="a1"), "a2": rectangle(100, 50, name="a2")}
    b = {"b1": rectangle(60.4, 50, name="b1"), "b2": rectangle(139.6, 50, name="b2")}
    uses_a, uses_b = [("a1", BOTTOM, False), ("a2", BOTTOM, False)], [("b1", TOP, True), ("b2", TOP, True)]
    match = match_seam(seam(uses_a, uses_b), a | b, 1000.0)
    assert match.count == 4
    assert match.joints_a.tolist() == [0, 2, 3]
    assert match.joints_b.tolist() == [0, 1, 3]
    assert match.fractions_a[0] == pytest.approx([0, 0.604, 1])
    near = {"b1": rectangle(99.5, 50, name="b1"), "b2": rectangle(100.5, 50, name="b2")}
    match = match_seam(seam(uses_a, uses_b), a | near, 1000.0)
    assert match.count == 3
    assert match.joints_a.tolist() == match.joints_b.tolist() == [0, 1, 2]


def test_close_vertices_of_one_side_both_stay() -> None:
    narrow = {"a1": rectangle(50, 50, name="a1"), "a2": rectangle(0.4, 50, name="a2"), "a3": rectangle(50, 50, name="a3"), "b": rectangle(100.4, 50, name="b")}
    match = match_seam(seam([(name, BOTTOM, False) for name in ("a1", "a2", "a3")], [("b", TOP, True)]), narrow, 1000.0)
    assert match.count == 4
    assert 1.0 - match.fractions_b[0][::-1] == pytest.approx([0, 50 / 100.4, 50.4 / 100.4, 1])


def test_notch_near_a_vertex_is_sewn_to_it() -> None:
    panels = {
        "a1": rectangle(50, 50, name="a1"),
        "a2": rectangle(50, 50, name="a2"),
        "b": rectangle(100, 50, name="b", notches={TOP: (("point", 0.492),)}),
    }
    panels["a1"] = rectangle(50, 50, name="a1", notches={BOTTOM: (("point", 0.99),)})
    match = match_seam(seam([("a1", BOTTOM, False), ("a2", BOTTOM, False)], [("b", TOP, True)]), panels, 1000.0)
    assert match.count == 3
    assert (1.0 - match.fractions_b[0][::-1])[1] == pytest.approx(1 - 0.492)


def test_faults_are_named() -> None:
    swapped = {
        "front": rectangle(200, 200, notches={RIGHT: (("one", 0.25), ("two", 0.5))}),
        "back": rectangle(200, 200, name="back", notches={RIGHT: (("two", 0.25), ("one", 0.5))}),
    }
    with pytest.raises(SpecError, match=r"seams\.side.*one, two.*another order"):
        match_seam(seam([("front", RIGHT, False)], [("back", RIGHT, False)]), swapped, 10.0)
    with pytest.raises(SpecError, match="no edge 7 of panel 'front'"):
        match_seam(seam([("front", 7, False)], [("back", RIGHT, False)]), swapped, 10.0)
    with pytest.raises(SpecError, match="no edges"):
        match_seam(seam([], [("back", RIGHT, False)]), swapped, 10.0)
    double = {"front": rectangle(200, 200, notches={RIGHT: (("one", 0.25), ("one", 0.5))})}
    with pytest.raises(SpecError, match="two notches named 'one'"):
        match_seam(seam([("front", RIGHT, False)], [("front", LEFT, True)]), double, 10.0)


def half(width: float, height: float, seamed: str) -> dict[str, Any]:
    """Right half of a panel with its edge `seamed` (top or low) notched at centre front and 60 mm from there, mirrored over its left edge."""
    points = {"a": [0, 0], "b": [width, 0], "c": [width, height], "d": [0, height]}
    names = [("low", "a", "b"), ("side", "b", "c"), ("top", "c", "d"), ("cf", "d", "a")]
    middle = "d" if seamed == "top" else "a"
    return {
        "points": points, "edges": [{"name": name, "from": start, "to": end} for name, start, end in names], "mirror": "cf",
        "notches": [{"edge": seamed, "at": {"mm": mm, "from": middle}, "name": name} for name, mm in (("centre", 0), ("n", 60))],
        "placement": {"transform": {"translation": [0, 0, 0]}},
    }  # fmt: skip


def test_a_notch_and_its_image_meet_their_like_over_the_fold() -> None:
    """A half front of 100 mm on a half band of 105 mm, both unfolded, and on a whole one that has the notches by name."""
    whole = half(105, 40, "low") | {"mirror": None}
    whole["points"] = {"a": [-105, 0], "b": [105, 0], "c": [105, 40], "d": [-105, 40]}
    whole["notches"] = [{"edge": "low", "at": {"mm": mm, "from": "a"}, "name": name} for name, mm in (("n_m", 45), ("centre", 105), ("n", 165))]
    for band, run in ((half(105, 40, "low"), ["band.low_m.b_m", "band.low.b"]), (whole, ["band.low.a", "band.low.b"])):
        seams = [{"name": "waist", "a": ["front.top_m.c_m", "front.top.c"], "b": run, "ease": 100 / 105 - 1}]
        spec = parse_spec({"name": "x", "fabric": "wool", "mannequin": "m", "panels": {"front": half(100, 300, "top"), "band": band}, "seams": seams})
        pattern = draft(spec, {})
        assert side_notches(pattern.panels, pattern.seams[0].a) == [("n_m", pytest.approx(40)), ("centre", pytest.approx(100)), ("n", pytest.approx(160))]
        assert side_notches(pattern.panels, pattern.seams[0].b) == [("n_m", pytest.approx(45)), ("centre", pytest.approx(105)), ("n", pytest.approx(165))]
        assert [finding.code for finding in check_seams(pattern, None)] == []
        match = match_seam(pattern.seams[0], pattern.panels, 1000.0)
        assert match.count == 5
        assert np.concatenate([1.0 - match.fractions_a[0][::-1], 1.0 - match.fractions_a[1][::-1]]) == pytest.approx([0.0, 0.4, 1.0, 0.0, 0.6, 1.0])


def test_two_notches_at_one_place_are_two() -> None:
    panels = {"front": rectangle(200, 200, notches={RIGHT: (("hip", 0.25), ("back", 0.25))})}
    assert side_notches(panels, (EdgeUse("front", RIGHT, True),)) == [("hip", 150.0), ("back", 150.0)]


def test_the_image_alone_keeps_the_name() -> None:
    panel = half(100, 300, "top")
    panel["notches"].append({"edge": "side", "at": 0.5, "name": "hip"})
    seams = [{"name": "side", "a": ["p.side_m.b_m", "p.side_m.c_m"], "b": ["q.side.b", "q.side.c"]}]
    pattern = draft(parse_spec({"name": "x", "fabric": "wool", "mannequin": "m", "panels": {"p": panel, "q": panel}, "seams": seams}), {})
    assert side_notches(pattern.panels, pattern.seams[0].a) == side_notches(pattern.panels, pattern.seams[0].b) == [("hip", 150.0)]
