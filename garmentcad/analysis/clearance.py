"""Rigid moves that free flat panels at the start: away from panels that they touch or cross, out of the body, and out from under other panels."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely

from garmentcad.analysis.penetration import signed_distances
from garmentcad.cloth.cloth import Cloth
from garmentcad.geometry.intersection import crossing_triangle_pairs
from garmentcad.geometry.polygon import loop_points
from garmentcad.mannequin.mannequin import Mannequin
from garmentcad.pattern.pattern import Pattern, Transform
from garmentcad.units import M_TO_MM, MM_TO_M

STEP_M = 0.004  # of a panel in one round, and what it goes farther than it must
OVER_M = 0.030  # between a panel that comes out from under another one and that panel
_ROUNDS = 60
_ALIKE = 0.9  # cosine between the right sides of panels that lie over each other
_OVERLAP_MM2 = 400.0
_MOSTLY = 0.5  # of its area that a panel lies over another one, where it is meant to: a lapel, a pocket


@dataclass(frozen=True)
class Move:
    """panel: its name; by_m (3,): how far it is moved; clear_of: what it touched."""

    panel: str
    by_m: np.ndarray
    clear_of: tuple[str, ...]

    def __str__(self) -> str:
        by_mm = M_TO_MM * self.by_m
        x, y, z = (f"{value:.0f}" for value in np.round(by_mm) + 0.0)
        return f"panel {self.panel} starts {np.linalg.norm(by_mm):.0f} mm ({x}, {y}, {z}) from its place, clear of {', '.join(self.clear_of)}"


def clearing_moves(pattern: Pattern, cloth: Cloth, positions: np.ndarray, mannequin: Mannequin) -> list[Move]:
    """Moves after which the panels that lie flat (placed by a transform) touch neither each other nor the body. Empty where they do not anyway.

    positions (V,3) m: vertices as placed. A panel that reaches between another one and the body would be caught there when their seams close (the sleeve of a
    shirt under its front): it comes out to the right side of the other. Two panels part along the line between their middles; a panel leaves the body on its
    right side, which is the outer one. What a mapping rule wrapped stays. Where many rounds do not help, the panels are left as they are: whoever starts
    looks again.
    """
    count = len(cloth.panel_names)
    flat = np.array([isinstance(panel.placement, Transform) for panel in pattern.panels.values()])
    owner = cloth.vertex_panel[cloth.triangles[:, 0]]
    normals = np.array([_right_side(positions, cloth.triangles[owner == panel]) for panel in range(count)])
    middles = np.array([positions[cloth.vertex_panel == panel].mean(axis=0) for panel in range(count)])
    moves, reserve = np.zeros((count, 3)), np.zeros((count, 3))
    reasons: list[set[str]] = [set() for _ in range(count)]
    for inner, outer, way in _covered(pattern):
        if np.linalg.norm(way) > np.linalg.norm(moves[inner]):
            moves[inner] = way
        reasons[inner].add(f"panel {cloth.panel_names[outer]}")
    for _ in range(_ROUNDS if flat.any() else 0):
        moved = positions + (moves + reserve)[cloth.vertex_panel]
        before = moves.copy()
        depth = -signed_distances(moved, mannequin.vertices, mannequin.faces)
        for panel in np.flatnonzero(flat):
            deepest = float(depth[cloth.vertex_panel == panel].max())
            if deepest > 0.0:
                moves[panel] += (deepest + STEP_M) * normals[panel]
                reasons[panel].add(f"mannequin {mannequin.name}")
        pairs = np.unique(np.sort(owner[crossing_triangle_pairs(moved, cloth.triangles)], axis=1), axis=0)
        for a, b in pairs[pairs[:, 0] != pairs[:, 1]].tolist():
            apart = middles[a] + moves[a] - middles[b] - moves[b]
            length = float(np.linalg.norm(apart))
            direction = apart / length if length > STEP_M else normals[a]
            for panel, other, way in ((a, b, direction), (b, a, -direction)):
                if flat[panel]:
                    moves[panel] += STEP_M * way
                    reserve[panel] = STEP_M * way  # a hair's breadth would do for the judge of crossings, not for contact
                    reasons[panel].add(f"panel {cloth.panel_names[other]}")
        if np.array_equal(before, moves):
            return [Move(cloth.panel_names[k], moves[k] + reserve[k], tuple(sorted(reasons[k]))) for k in range(count) if reasons[k]]
    return []


def _covered(pattern: Pattern) -> list[tuple[int, int, np.ndarray]]:
    """Flat panels that reach under others: number of the inner panel, of the outer one, and the way (3,) m over it."""
    flat = [(k, panel, panel.placement) for k, panel in enumerate(pattern.panels.values()) if isinstance(panel.placement, Transform)]
    outlines = {k: loop_points([edge.curve for edge in panel.edges]) for k, panel, _ in flat}
    found = []
    for outer, _, over in flat:
        frame = over.matrix
        cover = shapely.Polygon(outlines[outer]).buffer(0.0)
        for inner, _, under in flat:
            if inner == outer or under.matrix[:, 2] @ frame[:, 2] < _ALIKE:
                continue
            inside = np.column_stack([outlines[inner], np.zeros(len(outlines[inner]))]) @ under.matrix.T + under.translation_mm
            local = (inside - over.translation_mm) @ frame
            overlap = cover.intersection(shapely.Polygon(local[:, :2]).buffer(0.0)).area
            depth = -float(local[:, 2].min())
            if local[:, 2].max() < 0.0 and _OVERLAP_MM2 < overlap < _MOSTLY * cover.area:
                found.append((inner, outer, (depth * MM_TO_M + OVER_M) * frame[:, 2]))
    return found


def move_panels(cloth: Cloth, positions: np.ndarray, moves: list[Move]) -> np.ndarray:
    """Positions (V,3) with the panels moved."""
    by = np.zeros((len(cloth.panel_names), 3))
    for move in moves:
        by[cloth.panel_names.index(move.panel)] = move.by_m
    return positions + by[cloth.vertex_panel]


def _right_side(positions: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Unit mean normal (3,), zero where there is none."""
    a, b, c = (positions[triangles[:, k]] for k in range(3))
    total = np.cross(b - a, c - a).sum(axis=0)
    length = float(np.linalg.norm(total))
    return total / length if length > 0.0 else total
