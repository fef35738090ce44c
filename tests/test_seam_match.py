"""Seam matching against hand-computed places."""

from __future__ import annotations

import numpy as np
import pytest
from drawn import rectangle

from garmentcad.cloth.seam_match import match_seam
from garmentcad.errors import SpecError
from garmentcad.pattern.pattern import EdgeUse, Seam

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
