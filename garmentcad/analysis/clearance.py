"""Rigid moves that free panels at the start: away from panels that they touch or cross, and flat ones out of the body along their right side."""

from __future__ import annotations

import math
from collections.abc import Collection
from dataclasses import dataclass

import numpy as np

from garmentcad.analysis.penetration import signed_distances
from garmentcad.cloth.cloth import Cloth
from garmentcad.geometry.intersection import crossing_owners
from garmentcad.geometry.portable import norm
from garmentcad.mannequin.mannequin import Mannequin
from garmentcad.pattern.pattern import Pattern, Transform
from garmentcad.units import M_TO_MM

STEP_M = 0.004  # of a panel in one round, and what it goes farther than it must
_ROUNDS = 60


@dataclass(frozen=True)
class Move:
    """panel: its name; by_m (3,): how far it is moved; clear_of: what it touched."""

    panel: str
    by_m: np.ndarray
    clear_of: tuple[str, ...]

    def __str__(self) -> str:
        by_mm = M_TO_MM * self.by_m
        x, y, z = (f"{value:.0f}" for value in np.round(by_mm) + 0.0)
        return f"panel {self.panel} starts {norm(by_mm):.0f} mm ({x}, {y}, {z}) from its place, clear of {', '.join(self.clear_of)}"


def clearing_moves(pattern: Pattern, cloth: Cloth, positions: np.ndarray, mannequin: Mannequin, worn: Collection[str] = ()) -> list[Move]:
    """Moves after which no two panels touch, and those that lie flat (placed by a transform) do not touch the body. Empty where they do not anyway.

    positions (V,3) m: vertices as placed. Two panels part along the line between their middles; a panel leaves the body on its right side, which is the
    outer one. What a mapping rule wrapped around the body stays for a flat one. From another wrapped one it parts upward and downward; left and right
    halves of one height, and others where many rounds of that do not help, sideways. What is `worn` already stays for all. Where nothing helps, the panels
    are left as they are: whoever starts looks again.
    """
    upright = _moves(pattern, cloth, positions, mannequin, worn, False)
    return upright if upright is not None else _moves(pattern, cloth, positions, mannequin, worn, True) or []


def _moves(pattern: Pattern, cloth: Cloth, positions: np.ndarray, mannequin: Mannequin, worn: Collection[str], sideways: bool) -> list[Move] | None:
    """As `clearing_moves`, which has the arguments; None where many rounds do not help. sideways: which way wrapped panels part."""
    count = len(cloth.panel_names)
    free = np.array([name not in worn for name in pattern.panels])
    flat = free & np.array([isinstance(panel.placement, Transform) for panel in pattern.panels.values()])
    owner = cloth.vertex_panel[cloth.triangles[:, 0]]
    normals = np.array([_right_side(positions, cloth.triangles[owner == panel]) for panel in range(count)])
    middles = np.array([positions[cloth.vertex_panel == panel].mean(axis=0) for panel in range(count)])
    moves, reserve = np.zeros((count, 3)), np.zeros((count, 3))
    reasons: list[set[str]] = [set() for _ in range(count)]
    for _ in range(_ROUNDS):
        moved = positions + (moves + reserve)[cloth.vertex_panel]
        before = moves.copy()
        for panel in np.flatnonzero(flat).tolist():
            deepest = -float(signed_distances(moved[cloth.vertex_panel == panel], mannequin.vertices, mannequin.faces).min())
            if deepest > 0.0:
                moves[panel] += (deepest + STEP_M) * normals[panel]
                reasons[panel].add(f"mannequin {mannequin.name}")
        for a, b in crossing_owners(moved, cloth.triangles, owner):
            apart = middles[a] + moves[a] - middles[b] - moves[b]
            length = norm(apart)
            direction = apart / length if length > STEP_M else normals[a]
            if not flat[a] and not flat[b]:
                x, y, z = np.abs(middles[a] - middles[b])
                beside = y < STEP_M < x > z  # left and right halves, of which neither lies above the other
                direction = _level(apart) if sideways or beside else np.array([0.0, math.copysign(1.0, direction[1]), 0.0])
            for panel, other, way in ((a, b, direction), (b, a, -direction)):
                if flat[panel] or (free[panel] and not flat[other]):
                    moves[panel] += STEP_M * way
                    reserve[panel] = STEP_M * way  # a hair's breadth would do for the judge of crossings, not for contact
                    reasons[panel].add(f"panel {cloth.panel_names[other]}")
        if np.array_equal(before, moves):
            return [Move(cloth.panel_names[k], moves[k] + reserve[k], tuple(sorted(reasons[k]))) for k in range(count) if reasons[k]]
    return None


def move_panels(cloth: Cloth, positions: np.ndarray, moves: list[Move]) -> np.ndarray:
    """Positions (V,3) with the panels moved."""
    by = np.zeros((len(cloth.panel_names), 3))
    for move in moves:
        by[cloth.panel_names.index(move.panel)] = move.by_m
    return positions + by[cloth.vertex_panel]


def _level(apart: np.ndarray) -> np.ndarray:
    """The unit vector along the level part of `apart` (3,): on a slant wrapped panels would go into the body."""
    across = np.array([apart[0], 0.0, apart[2]])
    length = norm(across)
    return across / length if length > 0.0 else np.array([1.0, 0.0, 0.0])


def _right_side(positions: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Unit mean normal (3,), zero where there is none."""
    a, b, c = (positions[triangles[:, k]] for k in range(3))
    total = np.cross(b - a, c - a).sum(axis=0)
    length = norm(total)
    return total / length if length > 0.0 else total
