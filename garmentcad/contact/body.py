"""A body as contact sees it: its surface, trees over its elements, and which of them are in reach of a cloth's.

Particles are held off the body one by one (planes.py). Its vertices and edges against triangles and edges of the cloth matter where a sharp feature of the
body lies between particles.
"""

from __future__ import annotations

import numpy as np

from garmentcad.contact.bvh import EDGE_EDGE, TRIANGLE_POINT, fitted_tree, near_pairs
from garmentcad.contact.cloth import ClothElements
from garmentcad.contact.elements import elements, unique_edges
from garmentcad.contact.surface import build_surface, convex_curvature

CLEARANCE = 0.6e-3  # m, what a flat triangle keeps above the body's curve between its particles
LARGEST_GAP = 0.4  # of the lattice spacing


class BodyElements:
    """A still body: vertices (V,3) m, faces (F,3) counter-clockwise from outside."""

    def __init__(self, vertices: np.ndarray, faces: np.ndarray) -> None:
        self.surface = build_surface(vertices, faces)
        count = len(self.surface.vertices)
        self.curvature = convex_curvature(self.surface)
        self.face_tree = fitted_tree(elements(self.surface.faces, np.arange(count)), self.surface.vertices)
        self._points = elements(np.arange(count), np.arange(count))
        self._edges = elements(unique_edges(self.surface.faces), np.arange(count))
        self._point_tree = fitted_tree(self._points, self.surface.vertices)
        self._edge_tree = fitted_tree(self._edges, self.surface.vertices)

    def rise(self, spacing: float) -> np.ndarray:
        """(V,) m: least gap at each vertex, because a flat triangle between particles h apart dips h^2/(4 R) below a bulge of radius R."""
        return CLEARANCE + 0.25 * spacing**2 * self.curvature

    def pairs(self, cloth: ClothElements, positions: np.ndarray, reach: float) -> tuple[np.ndarray, np.ndarray]:
        """Nodes (N,4) of body vertex-cloth triangle and of cloth edge-body edge pairs closer than `reach` m. Body vertices are numbered after the P particles
        of `positions` (P,3)."""
        count, both = len(positions), (positions, self.surface.vertices)
        # No cloth element shares an identity with one of the body, whatever their numbers: the cloth's are shifted.
        triangles, edges = (part._replace(identity=part.identity + len(self.surface.vertices)) for part in (cloth.triangles, cloth.edges))
        pierced = near_pairs(TRIANGLE_POINT, reach, triangles, self._points, self._point_tree, both)
        crossed = near_pairs(EDGE_EDGE, reach, edges, self._edges, self._edge_tree, both)
        points = np.concatenate([count + self._points.nodes[pierced[:, 1], :1], triangles.nodes[pierced[:, 0]]], axis=1)
        crossing = np.concatenate([edges.nodes[crossed[:, 0], :2], count + self._edges.nodes[crossed[:, 1], :2]], axis=1)
        return points, crossing
