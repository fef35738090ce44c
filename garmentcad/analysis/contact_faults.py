"""What contact must never let happen, counted and placed by judges that the solver does not use: cloth through itself, through the body, inside the body."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass

import numpy as np

from garmentcad.analysis.penetration import penetration_mm, signed_distances
from garmentcad.cloth.cloth import Cloth
from garmentcad.geometry.intersection import crossing_triangle_pairs, crossing_triangle_pairs_between
from garmentcad.mannequin.mannequin import Mannequin

LISTED = 4  # panels, or pairs of them, in one sentence


@dataclass(frozen=True)
class ContactFaults:
    """self_intersections, mannequin_intersections: pairs of triangles that cross. mannequin_penetration_mm: greatest depth inside the body.
    said: a sentence for each kind that there is, with its places on the pattern (mm on the panels as drawn) and on the body."""

    self_intersections: int
    mannequin_intersections: int
    mannequin_penetration_mm: float
    said: tuple[str, ...]

    def __bool__(self) -> bool:
        return bool(self.self_intersections or self.mannequin_intersections or self.mannequin_penetration_mm > 0.0)


def contact_faults(
    cloth: Cloth, positions: np.ndarray, mannequin: Mannequin, vertices: np.ndarray | None = None, distances: np.ndarray | None = None
) -> ContactFaults:
    """Judge particles at finite positions (P,3) m. vertices: (V,3) m of the body where it has moved. distances: `signed_distances` of the particles
    from it, where they are known already."""
    triangles, faces = cloth.particle_triangles, mannequin.faces
    vertices = mannequin.vertices if vertices is None else vertices
    own = crossing_triangle_pairs(positions, triangles)
    through = crossing_triangle_pairs_between(positions, triangles, vertices, faces)
    if distances is None:
        distances = signed_distances(positions, vertices, faces)
    depth = penetration_mm(positions, triangles, vertices, faces, distances)
    said = []
    if len(own):
        said.append(f"the cloth crosses itself in {len(own)} pairs of triangles: {_self_places(cloth, own)}")
    if len(through):
        parts = [mannequin.part_names[part] for part in np.unique(mannequin.face_part[through[:, 1]])]
        said.append(f"the cloth crosses the body ({', '.join(parts)}) in {len(through)} pairs of triangles: {_listed(cloth, through[:, :1])}")
    if depth > 0.0:
        deepest = np.flatnonzero((distances[triangles] <= distances.min()).any(axis=1))[:1]
        said.append(f"the cloth lies up to {depth:.3g} mm inside the body: deepest particle in {_listed(cloth, deepest[:, None])}")
    return ContactFaults(len(own), len(through), depth, tuple(said))


def _self_places(cloth: Cloth, pairs: np.ndarray) -> str:
    """Panels of crossing pairs (N,2) of triangles and a place in each; the panel of the smaller number first, so that each two panels are told once."""
    owner = cloth.vertex_panel[cloth.triangles[:, 0]]
    swapped = owner[pairs[:, 0]] > owner[pairs[:, 1]]
    return _listed(cloth, np.where(swapped[:, None], pairs[:, ::-1], pairs))


def _listed(cloth: Cloth, triangles: np.ndarray) -> str:
    """Panels of triangles (N,1) or of pairs (N,2), those with most first: how many, and where the one nearest to their middle lies on the pattern."""
    owner = cloth.vertex_panel[cloth.triangles[:, 0]]
    middles = cloth.vertex_uv_mm[cloth.triangles].mean(axis=1)
    panels = [tuple(row) for row in owner[triangles].tolist()]
    ranked = sorted(Counter(panels).items(), key=lambda found: (-found[1], found[0]))
    told = []
    for group, count in ranked[:LISTED]:
        mine = triangles[[panel == group for panel in panels]]
        places = middles[mine].reshape(count, -1)
        nearest = mine[np.argmin(((places - places.mean(axis=0)) ** 2).sum(axis=1))]
        at = " and ".join(
            f"'{cloth.panel_names[panel]}' at ({middles[one, 0]:.0f}, {middles[one, 1]:.0f}) mm" for panel, one in zip(group, nearest, strict=True)
        )
        told.append(f"{count} of {at}" if len(triangles) > 1 else at)
    more = sum(count for _, count in ranked[LISTED:])
    return "; ".join(told) + (f"; {more} elsewhere" if more else "")
