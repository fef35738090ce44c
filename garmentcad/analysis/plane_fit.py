"""Garment against body in any plane: the girth of each loop of the garment and that of what it goes around."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass

import numpy as np
from scipy.spatial import ConvexHull

from garmentcad.analysis.section import Chain, Plane, cut
from garmentcad.cloth.cloth import Cloth
from garmentcad.mannequin.mannequin import Mannequin
from garmentcad.mannequin.tape import plane_axes
from garmentcad.units import M_TO_MM

_PROBES = 12  # points of a body's loop that are asked whether the garment goes around them


@dataclass(frozen=True)
class LoopFit:
    """A closed loop of the garment and the body parts inside it. draped_mm: its length in space; pattern_mm: on the flat pattern; body_mm: a tape around those
    parts in the same plane (convex hull)."""

    parts: tuple[str, ...]
    draped_mm: float
    pattern_mm: float
    body_mm: float

    @property
    def ease_mm(self) -> float:
        return self.draped_mm - self.body_mm

    @property
    def pattern_ease_mm(self) -> float:
        return self.pattern_mm - self.body_mm


def loops_in_plane(cloth: Cloth, positions: np.ndarray, mannequin: Mannequin, plane: Plane) -> list[LoopFit]:
    """All loops of the garment at positions (P,3) m that go around a part of the body, sorted by part names.

    Of loops around the same parts the shortest counts: the layer next to the body. A skirt at the knee has one loop around both legs, trousers have two.
    """
    bodies = cut(mannequin.vertices, mannequin.faces, plane)
    names = [_part_of(chain, mannequin) for chain in bodies]
    inner: dict[tuple[int, ...], Chain] = {}
    for loop in cut(positions, cloth.particle_triangles, plane):
        inside = tuple(k for k, body in enumerate(bodies) if loop.closed and _goes_around(loop, body, plane))
        if inside and (inside not in inner or loop.length() < inner[inside].length()):
            inner[inside] = loop
    flat = cloth.vertex_uv_mm[cloth.triangles]
    found = [
        LoopFit(
            tuple(sorted({names[k] for k in inside})),
            M_TO_MM * loop.length(),
            loop.length_on(flat),
            M_TO_MM * _hull_girth(np.concatenate([bodies[k].points for k in inside]), plane),
        )
        for inside, loop in inner.items()
    ]
    return sorted(found, key=lambda loop: (loop.parts, loop.draped_mm))


def _part_of(chain: Chain, mannequin: Mannequin) -> str:
    """The part that most of a loop of the body lies on."""
    return mannequin.part_names[Counter(mannequin.face_part[chain.triangles].tolist()).most_common(1)[0][0]]


def _goes_around(loop: Chain, body: Chain, plane: Plane) -> bool:
    probes = body.points[:: max(1, len(body.points) // _PROBES)]
    return 2 * sum(loop.winds_around(point, plane) for point in probes) > len(probes)


def _hull_girth(points: np.ndarray, plane: Plane) -> float:
    return float(ConvexHull(points @ plane_axes(plane.normal).T).area)  # the area of a hull in two dimensions is its perimeter
