"""Small faults that placing or a change of the lattice leaves: cloth that is pricked by the body, corners that lie through each other or on each other."""

from __future__ import annotations

import numpy as np

from garmentcad.cloth.weld import joined_particles
from garmentcad.contact.elements import unique_edges
from garmentcad.contact.pairs import VERTEX_TRIANGLE, Pairs
from garmentcad.geometry.intersection import crossing_triangle_pairs, crossing_triangle_pairs_between
from garmentcad.geometry.portable import norm

# Where a sharp part of the body stands out between particles, their triangles are moved off it by so many parts of the spacing at a time.
_LIFT = 0.05
PRICKED = 0.4  # of the spacing: how deep a prick may be
# Of a corner, each half-way to where its neighbours lie. One was enough after welding where it was seen; tops of pleats, whose two sides are sewn to one point
# beside their fold and lie on each other on the finer lattice, take up to eleven.
_TURNS = 24
# What is closer than this touches: contact lets nothing that it holds lose most of its distance, and what has none cannot move. It is moved apart by so much.
TOUCHING_M, _APART_M = 1e-6, 0.05e-3


def off_body(positions: np.ndarray, triangles: np.ndarray, vertices: np.ndarray, faces: np.ndarray, spacing: float, depth_m: float) -> np.ndarray:
    """Positions (P,3) m of cloth whose triangles (F,3) lie up to depth_m deep in the body (vertices (V,3) m, faces), moved off it where they cross it, by no
    more than that; others stay. What still crosses afterwards does so deeper."""
    moved = positions.copy()
    for _ in range(round(depth_m / (_LIFT * spacing))):
        pairs = crossing_triangle_pairs_between(moved, triangles, vertices, faces)
        if len(pairs) == 0:
            break
        a, b, c = (vertices[faces[pairs[:, 1], corner]] for corner in range(3))
        out = np.cross(b - a, c - a)
        out /= np.linalg.norm(out, axis=1)[:, None]
        way = np.zeros_like(moved)
        np.add.at(way, triangles[pairs[:, 0]].ravel(), np.repeat(out, 3, axis=0))
        size = np.linalg.norm(way, axis=1)[:, None]
        moved += _LIFT * spacing * np.divide(way, size, out=np.zeros_like(way), where=size > 0.0)
    return moved


def turned_out(positions: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Positions (P,3) of cloth whose triangles (F,3) cross each other, with the corners that do turned out: each goes half-way to the mean of its neighbours,
    a few times. What still crosses afterwards is no mere corner."""
    turned, edges = positions.copy(), unique_edges(triangles)
    one, other = np.concatenate([edges, edges[:, ::-1]]).T
    count = np.bincount(one, minlength=len(positions))
    for _ in range(_TURNS):
        pairs = crossing_triangle_pairs(turned, triangles)
        if len(pairs) == 0:
            break
        corners = np.unique(triangles[pairs])
        mean = np.column_stack([np.bincount(one, turned[other, axis], len(positions)) for axis in range(3)])[corners] / count[corners, None]
        turned[corners] += 0.5 * (mean - turned[corners])
    return turned


def parted(positions: np.ndarray, triangles: np.ndarray, pairs: Pairs) -> np.ndarray:
    """Positions (P,3) m of cloth that does not cross itself, with these pairs of it that touch moved a little apart, each to the side on which nothing crosses;
    what would cross on both stays. Where two panels are sewn together around a corner, one triangle of each has the same three points on a coarse lattice, and
    the edges that cut it on a finer one meet."""
    moved = positions
    for nodes, kind in zip(pairs.nodes, pairs.kind, strict=True):
        a, b, c, d = positions[nodes]
        vertex = kind == VERTEX_TRIANGLE
        normal = np.cross(c - b, d - b) if vertex else np.cross(b - a, d - c)
        first = [1.0, -1.0, -1.0, -1.0] if vertex else [1.0, 1.0, -1.0, -1.0]
        way = 0.5 * _APART_M * np.array(first)[:, None] * (normal / max(norm(normal), 1e-30))
        for side in (1.0, -1.0):
            tried = moved.copy()
            tried[nodes] += side * way
            if len(crossing_triangle_pairs(tried, triangles)) == 0:
                moved = tried
                break
    return moved


def pulled_out(positions: np.ndarray, triangles: np.ndarray, stitches: np.ndarray, standing: np.ndarray) -> np.ndarray:
    """Positions (P,3) of cloth whose stitches (S,2) close, with the corners pulled out that would stand through it where those that are `standing` open (S,)
    bool have closed; as they are where something crosses that is no mere corner."""
    shut = joined_particles(stitches, len(positions))
    middle = np.column_stack([np.bincount(shut, positions[:, axis]) for axis in range(3)]) / np.bincount(shut)[:, None]
    closed = shut[triangles]
    if not np.isin(closed[crossing_triangle_pairs(middle, closed)], shut[stitches[standing]]).any():
        return positions
    turned = turned_out(middle, closed)
    return positions if len(crossing_triangle_pairs(turned, closed)) else positions + (turned - middle)[shut]
