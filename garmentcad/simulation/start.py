"""A start is refused where panels cross each other or lie deep inside the mannequin: a tangle stays one. What lies a little inside is moved out."""

from __future__ import annotations

from collections.abc import Collection

import numpy as np

from garmentcad.analysis.inside import SHALLOW_M, place_inside, remedy_inside
from garmentcad.analysis.penetration import signed_distances
from garmentcad.cloth.cloth import Cloth
from garmentcad.errors import TangledError
from garmentcad.geometry.intersection import crossing_triangle_pairs
from garmentcad.mannequin.mannequin import Mannequin
from garmentcad.simulation.mend import PRICKED, off_body
from garmentcad.units import M_TO_MM

LISTED = 5


def refuse_tangled(cloth: Cloth, positions: np.ndarray, mannequin: Mannequin, worn: Collection[str] = ()) -> None:
    """TangledError naming the panels, the number of pairs and a remedy. worn: panels that hang already; how they do is no matter of placement."""
    panels = np.asarray(cloth.panel_names)
    hangs = np.isin(panels, list(worn))[cloth.vertex_panel]
    vertex_positions = positions[cloth.vertex_particle]
    depth = -signed_distances(vertex_positions, mannequin.vertices, mannequin.faces)
    deep = (depth > SHALLOW_M) & ~hangs
    if deep.any():
        named = []
        for index in np.unique(cloth.vertex_panel[deep]):
            mine = deep & (cloth.vertex_panel == index)
            place = place_inside(vertex_positions[mine], mannequin)
            named.append(f"{panels[index]}: {int(mine.sum())} points, up to {M_TO_MM * float(depth[mine].max()):.0f} mm deep, {place}")
        remedy = remedy_inside(vertex_positions[deep], mannequin)
        raise TangledError(f"panels start inside mannequin {mannequin.name} ({'; '.join(named)}); {remedy}", key="panels")
    pairs = [pair for pair in crossing_triangle_pairs(positions, cloth.particle_triangles) if not hangs[cloth.triangles[pair, 0]].all()]
    if len(pairs):
        owner = panels[cloth.vertex_panel[cloth.triangles[:, 0]]]
        listed = ", ".join(sorted({" x ".join(sorted((str(owner[i]), str(owner[j])))) for i, j in pairs})[:LISTED])
        raise TangledError(f"panels start crossing each other in {len(pairs)} pairs of triangles ({listed}); move their placements apart", key="panels")


def freed(cloth: Cloth, positions: np.ndarray, mannequin: Mannequin) -> np.ndarray:
    """Positions (P,3) m of a start that is not refused, with what lies a little inside the mannequin moved out of it; as they are where that would make the
    cloth cross itself. Contact alone would tear it: it pushes points outward, and triangles into which parts of the body stand inward."""
    depth = SHALLOW_M + PRICKED * cloth.spacing
    outside = off_body(positions, cloth.particle_triangles, mannequin.vertices, mannequin.faces, cloth.spacing, depth)
    return positions if len(crossing_triangle_pairs(outside, cloth.particle_triangles)) else outside
