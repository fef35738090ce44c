"""Flat panels that touch at the start are moved apart, rigidly, by as much as it takes; what touches nothing stays."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from drawn import materials
from test_check_placement import body

import garmentcad.geometry.intersection as intersection
from garmentcad.analysis.clearance import STEP_M, clearing_moves, move_panels
from garmentcad.analysis.penetration import signed_distances
from garmentcad.cloth.lattice import build_cloth
from garmentcad.geometry.intersection import crossing_triangle_pairs
from garmentcad.pattern.draft import draft
from garmentcad.pattern.parse import parse_spec
from garmentcad.pattern.pattern import Wrap
from garmentcad.placement.place import place_vertices

POST_M = 0.1  # radius of the body


def started(**places: tuple[list[float], list[float]]) -> Any:
    """Squares of 200 mm by name: translation mm, rotation degrees."""
    panels = {
        name: {
            "points": {"a": [0, 0], "b": [200, 0], "c": [200, 200], "d": [0, 200]},
            "edges": [{"name": f"e{k}", "from": "abcd"[k], "to": "bcda"[k]} for k in range(4)],
            "placement": {"transform": {"translation": translation, "rotation": rotation}},
        }
        for name, (translation, rotation) in places.items()
    }
    pattern = draft(parse_spec({"name": "squares", "fabric": "x", "mannequin": "post", "panels": panels}), {})
    cloth = build_cloth(pattern, lambda _, points: np.zeros(len(points), dtype=np.int32), materials(0.2), 20.0)
    return pattern, cloth, place_vertices(pattern, cloth, body())


def test_what_touches_nothing_stays() -> None:
    pattern, cloth, positions = started(left=([5, 500, 200], [0, 0, 0]), right=([-205, 500, 200], [0, 0, 0]))
    assert clearing_moves(pattern, cloth, positions, body()) == []


def test_halves_that_share_the_middle_part_sideways() -> None:
    """As the fronts of a GarmentCode shirt: x from 0 and to 0, in one plane."""
    pattern, cloth, positions = started(left=([0, 500, 200], [0, 0, 0]), right=([-200, 500, 200], [0, 0, 0]))
    assert len(crossing_triangle_pairs(positions, cloth.triangles)) > 0
    moves = clearing_moves(pattern, cloth, positions, body())
    assert [(move.panel, move.clear_of) for move in moves] == [("left", ("panel right",)), ("right", ("panel left",))]
    assert moves[0].by_m == pytest.approx([2 * STEP_M, 0, 0])
    assert moves[1].by_m == pytest.approx([-2 * STEP_M, 0, 0])
    assert len(crossing_triangle_pairs(move_panels(cloth, positions, moves), cloth.triangles)) == 0
    assert str(moves[0]) == "panel left starts 8 mm (8, 0, 0) from its place, clear of panel right"


@pytest.mark.parametrize("turn", [0.0, 180.0])
def test_a_panel_leaves_the_body_on_its_right_side(turn: float) -> None:
    """A plane 90 mm in front of the axis of a post of 100 mm, or behind it: it goes out, never through."""
    x, z = (-100.0, 90.0) if turn == 0.0 else (100.0, -90.0)
    pattern, cloth, positions = started(front=([x, 500, z], [0, turn, 0]))
    (move,) = clearing_moves(pattern, cloth, positions, body())
    assert move.clear_of == ("mannequin post",)
    assert move.by_m[:2] == pytest.approx([0, 0])
    assert np.sign(move.by_m[2]) == np.sign(z)
    moved = move_panels(cloth, positions, [move])
    assert 0.0 < signed_distances(moved, body().vertices, body().faces).min() <= STEP_M
    assert moved - positions == pytest.approx(np.tile(move.by_m, (len(positions), 1)))


def test_panels_that_cross_in_depth() -> None:
    pattern, cloth, positions = started(a=([-100, 500, 200], [0, 0, 0]), b=([-100, 500, 150], [-30, 0, 0]), c=([-100, 800, 200], [0, 0, 0]))
    moves = clearing_moves(pattern, cloth, positions, body())
    assert {move.panel for move in moves} == {"a", "b"}
    assert len(crossing_triangle_pairs(move_panels(cloth, positions, moves), cloth.triangles)) == 0


def around_post(panels: dict[str, Any], grid_mm: float) -> Any:
    """Panels in the plane z = 0, laid around the post as a mapping rule would lay them."""
    pattern = draft(parse_spec({"name": "wrapped", "fabric": "x", "mannequin": "post", "panels": panels}), {})
    cloth = build_cloth(pattern, lambda _, points: np.zeros(len(points), dtype=np.int32), materials(0.2), grid_mm)
    positions = place_vertices(pattern, cloth, body())
    angle = positions[:, 0] / 0.12
    positions[:, 0], positions[:, 2] = 0.12 * np.sin(angle), 0.12 * np.cos(angle)
    wrapped = Wrap("post", (0.0, 0.0), 0.0, 500.0, 20.0, 1.0)
    return replace(pattern, panels={name: replace(panel, placement=wrapped) for name, panel in pattern.panels.items()}), cloth, positions


def test_what_a_rule_wrapped_parts_upward_and_downward_and_what_is_worn_stays() -> None:
    """Two bands around a post, one askew: they cross in a corner."""
    wraps = {"above": (560, 4.0), "below": (505, 0.0)}
    panels = {
        name: {
            "points": {"a": [-150, 0], "b": [150, 0], "c": [150, 50], "d": [-150, 50]},
            "edges": [{"name": f"e{k}", "from": "abcd"[k], "to": "bcda"[k]} for k in range(4)],
            "placement": {"transform": {"translation": [0, height, 120], "rotation": [0, 0, turn]}},
        }
        for name, (height, turn) in wraps.items()
    }
    pattern, cloth, positions = around_post(panels, 10.0)
    assert len(crossing_triangle_pairs(positions, cloth.triangles)) > 0
    moves = clearing_moves(pattern, cloth, positions, body())
    assert {move.panel: (move.by_m[1] > 0.0, move.by_m[[0, 2]].tolist()) for move in moves} == {"above": (True, [0.0, 0.0]), "below": (False, [0.0, 0.0])}
    assert len(crossing_triangle_pairs(move_panels(cloth, positions, moves), cloth.triangles)) == 0
    (move,) = clearing_moves(pattern, cloth, positions, body(), worn=("below",))
    assert move.panel == "above"


def test_wrapped_halves_beside_each_other_part_sideways() -> None:
    """Two halves of a back whose edges cross in a wedge, as one of them is turned: up and down they would have to go as far as the edges are long."""
    panels = {
        name: {
            "points": {"a": [low, -900], "b": [low + 150, -900], "c": [low + 150, 0], "d": [low, 0]},
            "edges": [{"name": f"e{k}", "from": "abcd"[k], "to": "bcda"[k]} for k in range(4)],
            "placement": {"transform": {"translation": [way, 1000, 0], "rotation": [0, 0, turn]}},
        }
        for name, low, way, turn in (("right", 0, 5, -2), ("left", -150, -5, 0))
    }
    pattern, cloth, positions = around_post(panels, 20.0)
    assert len(crossing_triangle_pairs(positions, cloth.triangles)) > 0
    moves = clearing_moves(pattern, cloth, positions, body())
    assert {move.panel for move in moves} == {"left", "right"}
    for move in moves:
        x, y, z = move.by_m
        assert y == 0.0
        assert abs(z) < 0.3 * abs(x) <= 0.3 * 0.02
    assert len(crossing_triangle_pairs(move_panels(cloth, positions, moves), cloth.triangles)) == 0


def test_panels_in_one_place_are_judged_up_to_their_first_crossing(monkeypatch: pytest.MonkeyPatch) -> None:
    """Every verdict on coplanar panels takes exact arithmetic, and there are thousands of near triangles in each of some 25 rounds."""
    pattern, cloth, positions = started(front=([-100, 500, 200], [0, 0, 0]), back=([-100, 500, 200], [0, 0, 0]))
    wrapped = Wrap("post", (0.0, 0.0), 0.0, 500.0, 20.0, 1.0)
    pattern = replace(pattern, panels={name: replace(panel, placement=wrapped) for name, panel in pattern.panels.items()})
    exactly, judged = intersection._cross_exactly, []
    monkeypatch.setattr(intersection, "_cross_exactly", lambda *of: judged.append(of) or exactly(*of))
    moves = clearing_moves(pattern, cloth, positions, body())
    assert sorted(move.by_m[1] for move in moves) == pytest.approx([-0.104, 0.104], abs=STEP_M)
    assert 10 < len(judged) < 100
    monkeypatch.undo()
    assert len(crossing_triangle_pairs(move_panels(cloth, positions, moves), cloth.triangles)) == 0


def test_wrapped_halves_of_one_height_part_sideways_at_once() -> None:
    """Left and right forks that overlap by 20 mm: up and down they would start at two heights, and one leg hang higher than the other."""
    panels = {
        name: {
            "points": {"a": [low, 0], "b": [low + 150, 0], "c": [low + 150, 60], "d": [low, 60]},
            "edges": [{"name": f"e{k}", "from": "abcd"[k], "to": "bcda"[k]} for k in range(4)],
            "placement": {"transform": {"translation": [0, 500, 0], "rotation": [0, 0, turn]}},
        }
        for name, low, turn in (("right", -10, 3), ("left", -140, -3))
    }
    pattern, cloth, positions = around_post(panels, 10.0)
    assert len(crossing_triangle_pairs(positions, cloth.triangles)) > 0
    moves = {move.panel: move.by_m for move in clearing_moves(pattern, cloth, positions, body())}
    assert moves["right"][0] > 0.0 > moves["left"][0]
    assert moves["right"] == pytest.approx(moves["left"] * [-1.0, 0.0, 1.0], abs=1e-6)
