"""Does the garment sit where it was put? How far the waist came down from where it was placed, and how far the armholes are from the shoulders."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from garmentcad.analysis.body_line import SIDES
from garmentcad.cloth.cloth import Cloth
from garmentcad.mannequin.mannequin import Mannequin
from garmentcad.units import M_TO_MM

WAIST, ARMHOLE = "waist", "armhole"


@dataclass(frozen=True)
class Carried:
    """waist_drop_mm: mean height at which edges with the role `waist` were placed minus where they hang (positive: slid down), None without such edges.
    armhole_to_shoulder_mm: {left, right}: distance of the body's shoulder point from the nearest edge with the role `armhole` on that side, or None."""

    waist_drop_mm: float | None
    armhole_to_shoulder_mm: dict[str, float | None]


def carried(cloth: Cloth, placed: np.ndarray, positions: np.ndarray, mannequin: Mannequin, roles: Mapping[str, Sequence[str]]) -> Carried:
    """placed: (V,3) m of the vertices before sewing; positions: (P,3) m of the particles; roles: role -> keys of `Cloth.edge_vertices`."""
    drop = None
    if keys := roles.get(WAIST):
        vertices = np.concatenate([cloth.edge_vertices[key] for key in keys])
        drop = M_TO_MM * float((placed[vertices, 1] - positions[cloth.vertex_particle[vertices], 1]).mean())
    apart: dict[str, float | None] = dict.fromkeys(SIDES)
    armholes = [positions[cloth.vertex_particle[cloth.edge_vertices[key]]] for key in roles.get(ARMHOLE, ())]
    for side, outward in zip(SIDES, (1.0, -1.0), strict=True):
        point, mine = mannequin.landmarks.get(f"shoulder_point_{side}"), [line for line in armholes if outward * line[:, 0].mean() > 0.0]
        if point is not None and mine:
            apart[side] = M_TO_MM * min(_distance(point, line) for line in mine)
    return Carried(drop, apart)


def slip_mm(cloth: Cloth, positions: np.ndarray, body: np.ndarray, roles: Mapping[str, Sequence[str]]) -> np.ndarray | None:
    """(K,) mm by how far edges with the role `waist` have come down on a body that moves, in the mean over them, since the first of K frames; None without such
    edges. positions: (K,P,3) m of the particles, body: (K,V,3) m. Each particle is seen against the body vertex that was nearest to it in the first frame."""
    if not (keys := roles.get(WAIST)):
        return None
    waist = np.unique(cloth.vertex_particle[np.concatenate([cloth.edge_vertices[key] for key in keys])])
    under = cKDTree(body[0]).query(positions[0][waist])[1]
    above = positions[:, waist, 1] - body[:, under, 1]
    return np.asarray(M_TO_MM * (above[0] - above).mean(axis=1))


def _distance(point: np.ndarray, line: np.ndarray) -> float:
    """Of a point from a polyline (N,3), m."""
    start, way = line[:-1], np.diff(line, axis=0)
    square = np.maximum((way**2).sum(axis=1), 1e-30)
    share = np.clip(((point - start) * way).sum(axis=1) / square, 0.0, 1.0)
    return float(np.linalg.norm(start + share[:, None] * way - point, axis=1).min())
