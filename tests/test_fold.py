"""Fold lines: from the spec to the pattern, and the share that pressing leaves."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from elastic import linear

from garmentcad.cloth.lattice import panel_cloth
from garmentcad.errors import SpecError
from garmentcad.fabric.pressing import pressed_share
from garmentcad.pattern.draft import draft
from garmentcad.pattern.parse import parse_spec
from garmentcad.pattern.pattern import Panel


def panel(**more: Any) -> Panel:
    drawn = {
        "points": {"a": [0, 0], "b": [200, 0], "c": [200, 400], "d": [0, 400]},
        "edges": [{"name": f"e_{name}", "from": name, "to": after} for name, after in zip("abcd", "bcda")],
        "internal_lines": {
            "center": [[0, 0], [0, 400]],
            "one": [[80, 0], [80, 400]],
            "two": [[110, 0], [110, "10 * 20"]],
            "dot": [[5, 5], [5, 5]],
            "slant": [[200, -50], [-100, 250]],
        },
        "placement": {"transform": {"translation": [0, 0, 0]}},
        **more,
    }
    return draft(parse_spec({"name": "x", "fabric": "wool", "mannequin": "woman-88", "panels": {"p": drawn}}, "x.yaml"), {}).panels["p"]


def test_a_fold_is_pressed_unless_it_is_said_how() -> None:
    folds = [{"name": f"f{k}", "line": "one", "angle": -150, "strength": 2, **more} for k, more in enumerate(({}, {"pressed": False}, {"pressed": "0.4 * 2"}))]
    made = panel(folds=folds).folds
    assert [fold.pressed for fold in made] == [None, 0.0, 0.8]
    assert (made[0].angle_deg, made[0].strength) == (-150.0, 2.0)
    assert made[0].points_mm.tolist() == [[80.0, 0.0], [80.0, 400.0]]


def test_edges_are_cut_where_folds_meet_them() -> None:
    made = panel(folds=[{"name": "f", "line": "slant", "angle": 9}, {"name": "inside", "line": "two", "angle": 9}])
    pieces = [(edge.name, edge.piece, edge.start, edge.end) for edge in made.edges]
    assert pieces[:2] == [("e_a", 1, "a", "inside_1"), ("e_a", 2, "inside_1", "f_1")]
    assert [name for name, *_ in pieces] == ["e_a", "e_a", "e_a", "e_b", "e_c", "e_d", "e_d"]
    assert made.points["f_1"] == pytest.approx((150.0, 0.0), abs=1e-9)
    assert made.points["f_2"] == pytest.approx((0.0, 150.0), abs=1e-9)


def test_mirrored_folds_keep_their_side_of_the_fabric_and_one_on_the_mirror_stays_one() -> None:
    drawn = panel(
        edges=[{"name": name, "from": name[0], "to": name[1]} for name in ("ab", "bc", "cd", "da")],
        mirror="da",
        folds=[{"name": "crease", "line": "center", "angle": -170}],
        pleats=[{"name": "k", "edge": "cd", "at": {"mm": 80, "from": "d"}, "depth": 30}],
    )
    assert [fold.name for fold in drawn.folds] == ["crease", "k_1_fold", "k_1_under", "k_1_fold_m", "k_1_under_m"]
    assert [fold.angle_deg for fold in drawn.folds] == [-170.0, -170.0, 170.0, -170.0, 170.0]
    assert np.array_equal(drawn.folds[3].points_mm, [[-80.0, 400.0], [-80.0, 0.0]])


@pytest.mark.parametrize(("more", "key", "message"), [
    ({"folds": [{"name": "f", "line": "onee", "angle": 9}]}, "folds.0.line", "did you mean 'one'"),
    ({"folds": [{"name": "f", "line": "dot", "angle": 9}]}, "folds.0.line", "has no length"),
    ({"folds": [{"name": "f", "line": "one", "angle": 190}]}, "folds.0.angle", "came 190; allowed is -180 to 180"),
    ({"folds": [{"name": "f", "line": "one", "angle": 9, "pressed": 1.2}]}, "folds.0.pressed", "came 1.2; allowed is 0 to 1"),
    ({"folds": [{"name": "f", "line": "one", "angle": 9, "strength": 0}]}, "folds.0.strength", "allowed is 0.1 to 100"),
    ({"folds": [{"name": "f", "line": "one", "angle": 9}, {"name": "f", "line": "two", "angle": 9}]}, "folds.1.name", "a second fold is called 'f'"),
    ({"folds": [{"name": "f", "line": "one", "angle": 9, "pressed": []}]}, "folds.0.pressed", "a number or an expression is wanted"),
])  # fmt: skip
def test_faults(more: dict[str, Any], key: str, message: str) -> None:
    with pytest.raises(SpecError) as caught:
        panel(**more)
    assert caught.value.key == f"panels.p.{key}"
    assert message in caught.value.message


def test_the_fibre_that_sets_best_holds_the_fold() -> None:
    assert pressed_share("100% wool") == 0.85
    assert pressed_share("55% polyester, 45% Wool") == 0.9
    assert pressed_share(None) == pressed_share("hemp") == 0.75


def test_a_fold_that_goes_through_a_dart_is_refused_and_one_that_begins_at_its_point_is_not() -> None:
    lines = {"through": [[110, 400], [110, 0]], "from_point": [[100, 300], [100, 0]]}
    darts = [{"name": "dart", "edge": "e_c", "at": 0.5, "intake": 30, "length": 100}]
    made = panel(internal_lines=lines, darts=darts, folds=[{"name": "f", "line": "from_point", "angle": -150}])
    assert [edge.name for edge in made.edges].count("dart_leg_a") == 1
    with pytest.raises(SpecError, match=r"goes through 'dart', a dart or pleat, whose leg it crosses at \(110.0, 366.7\) mm; end it at the point") as caught:
        panel(internal_lines=lines, darts=darts, folds=[{"name": "f", "line": "through", "angle": -150}])
    assert caught.value.key == "panels.p.folds.f"


def test_a_fold_that_ends_in_the_depth_of_a_pleat_is_refused() -> None:
    pleats = [{"name": "k", "edge": "e_c", "at": {"mm": 80, "from": "d"}, "depth": 30}]
    with pytest.raises(SpecError, match=r"goes through 'k_1', a dart or pleat, whose leg it crosses at \(100.0, 400.0\) mm"):
        panel(internal_lines={"top": [[100, 400], [100, 200]]}, pleats=pleats, folds=[{"name": "f", "line": "top", "angle": -150}])


@pytest.mark.parametrize("half_mm", [51.25, 63.17, 88.41, 97.03])
def test_a_fold_in_the_middle_of_a_curve_cuts_it_there(half_mm: float) -> None:
    """Where the line meets a sampled point of the curve but for rounding, that may differ from one way to draw the point to another (51.25)."""
    corners = {"a": [-half_mm, 0], "b": [half_mm, 0], "c": [half_mm, 300], "d": [-half_mm, 300]}
    hem = {"name": "hem", "from": "a", "to": "b", "cubic": [[-34.2, -8], [34.2, -8]]}
    edges = [hem, *({"name": name, "from": name[0], "to": name[1]} for name in ("bc", "cd", "da"))]
    made = panel(points=corners, edges=edges, internal_lines={"m": [[0, -1000], [0, 1000]]}, folds=[{"name": "f", "line": "m", "angle": 90}])
    assert [edge.name for edge in made.edges] == ["hem", "hem", "bc", "cd", "cd", "da"]
    assert made.points["f_1"] == pytest.approx((0.0, -6.0), abs=1e-9)
    assert made.points["f_2"] == pytest.approx((0.0, 300.0), abs=1e-9)


@pytest.mark.parametrize(
    "what",
    [
        {"darts": [{"name": "d", "edge": "none", "at": 0.5, "intake": 5, "length": 50}]},
        {"notches": [{"edge": "none", "at": {"mm": 0, "from": "b"}, "name": "n"}]},
    ],
)
def test_nothing_has_a_place_on_an_edge_without_length(what: dict[str, Any]) -> None:
    corners = {"a": [0, 0], "b": [200, 0], "e": [200, 0], "c": [200, 400], "d": [0, 400]}
    edges = [{"name": "none" if name == "be" else name, "from": name[0], "to": name[1]} for name in ("ab", "be", "ec", "cd", "da")]
    with pytest.raises(SpecError, match="edge 'none' has no length from 'b' to 'e'") as caught:
        panel(points=corners, edges=edges, **what)
    assert caught.value.key == f"panels.p.{next(iter(what))}.0.at"


@pytest.mark.parametrize("turn", np.linspace(0.0, 6.2, 63))
def test_a_fold_that_goes_on_along_the_outline_folds_inside_alone(turn: float) -> None:
    """A vent: above its extension of 100 mm the line is the edge. Whether an intersection of both is cut there was a matter of round-off."""
    c, s = np.cos(turn), np.sin(turn)
    turned = [[c * x - s * y, s * x + c * y] for x, y in ([0, 0], [140, 0], [140, 100], [100, 100], [100, 300], [0, 300], [100, -20], [100, 320])]
    made = panel(
        points=dict(zip("abcdef", turned[:6])),
        edges=[{"name": f"e_{name}", "from": name, "to": after} for name, after in zip("abcdef", "bcdefa")],
        internal_lines={"vent": turned[6:]},
        folds=[{"name": "vent", "line": "vent", "angle": 90}],
    )
    cloth = panel_cloth(made, linear(0.15, 2000.0, 0.1, 50.0, 0.3e-3, 0.3), 0, 10.0)
    assert cloth.hinges.length.sum() == pytest.approx(0.1, abs=1e-9)
    assert cloth.border.area.min() > 1e-6


@pytest.mark.parametrize(("line", "length"), [([[-20, 100], [320, 100]], 400.0), ([[-20, 90], [60, 100], [320, 100]], 2.0 * (60.0**2 + 7.5**2) ** 0.5 + 280.0)])
def test_what_a_fold_has_beyond_the_mirror_edge_is_its_image(line: list[list[float]], length: float) -> None:
    made = panel(
        edges=[{"name": name, "from": name[0], "to": name[1]} for name in ("ab", "bc", "cd", "da")],
        mirror="da", internal_lines={"level": line}, folds=[{"name": "level", "line": "level", "angle": 90}],
    )  # fmt: skip
    assert [fold.name for fold in made.folds] == ["level", "level_m"]
    cloth = panel_cloth(made, linear(0.15, 2000.0, 0.1, 50.0, 0.3e-3, 0.3), 0, 10.0)
    assert 1000.0 * cloth.hinges.length.sum() == pytest.approx(length, abs=1e-6)


def test_a_fold_that_crosses_the_mirror_edge_twice_is_refused() -> None:
    with pytest.raises(SpecError, match="'z' crosses the mirror edge more than once"):
        panel(
            edges=[{"name": name, "from": name[0], "to": name[1]} for name in ("ab", "bc", "cd", "da")],
            mirror="da", internal_lines={"z": [[50, 100], [-50, 150], [50, 200]]}, folds=[{"name": "z", "line": "z", "angle": 90}],
        )  # fmt: skip
