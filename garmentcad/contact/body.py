"""A body as contact sees it: its surface, trees over its elements, and which of them are in reach of a cloth's.

Particles are held off the body one by one (planes.py), by so much that a flat triangle between them clears a bulge of the curvature that the surface has
there. Body vertices and edges against triangles and edges of the cloth matter where a feature is sharper than that: needles, edges of boxes, fingers.
"""

from __future__ import annotations

import numpy as np

from garmentcad.arrays import indices
from garmentcad.cloth.cloth import Cloth
from garmentcad.contact.bvh import build_tree, refit
from garmentcad.contact.cloth import ClothElements
from garmentcad.contact.elements import LEAST_GAP, elements, largest_around, unique_edges
from garmentcad.contact.near import EDGE_EDGE, TRIANGLE_POINT, blocks_over, near_pairs
from garmentcad.contact.surface import Surface, build_surface, bulge, convex_curvature, edge_of_side
from garmentcad.fabric.material import MaterialTable
from garmentcad.geometry.closest import CORNER, EDGE, FACE

CLEARANCE = 0.6e-3  # m, what a flat triangle keeps above the body's curve between its particles
LARGEST_GAP = 0.4  # of the lattice spacing
STRETCHED = 1.1  # of its length at rest, what a side of a triangle reaches
_FACES = 4  # in a leaf of the tree in which particles look one by one, at most; with 8 that takes a sixth longer
ELEMENT_GAP = 0.15e-3  # m, of body vertices and edges against cloth triangles and edges


def _rise(surface: Surface, spacing: float) -> np.ndarray:
    return np.asarray(CLEARANCE + 0.25 * spacing**2 * convex_curvature(surface))


def kept_gap(cloth: Cloth, materials: MaterialTable, vertices: np.ndarray, faces: np.ndarray, nearest: np.ndarray) -> np.ndarray:
    """Gap (P,) m up to which contact holds each particle of a cloth off a body, between mid-surfaces: half the fabric's thickness, at least 1 mm, more where
    the body bulges. nearest: (P,K) body vertices around each particle; the largest bulge of them counts, because contact goes by the face that it met."""
    own = np.maximum(0.5 * largest_around(cloth, materials.thickness), LEAST_GAP)
    rise = _rise(build_surface(vertices, faces), cloth.spacing)[nearest].max(axis=1)
    return np.maximum(own, np.minimum(rise, LARGEST_GAP * cloth.spacing))


def _rows_above(faces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Rows of a surface's pseudo-normals, features of a face after the other, (V,) above each vertex and (E,) above each edge of `unique_edges`."""
    side = np.arange(faces.size)
    per_face = 1 + FACE
    vertex = np.zeros(int(faces.max(initial=-1)) + 1, dtype=np.int32)
    vertex[faces.ravel()] = per_face * (side // 3) + CORNER + side % 3
    first = np.unique(edge_of_side(faces), return_index=True)[1]
    return vertex, indices(per_face * (first // 3) + EDGE + first % 3)


class BodyElements:
    """A body, vertices (V,3) m and faces (F,3) counter-clockwise from outside, under a cloth of a lattice `spacing` whose longest side of a triangle is
    `longest` at rest [m].

    rise: (V,) m, least gap at each vertex, because a flat triangle between particles h apart dips h^2/(4 R) below a bulge of radius R. largest_gap: m, up to
    which it counts. The vertices of `surface` are its own, and may move: then `refit_swept`.
    """

    def __init__(self, vertices: np.ndarray, faces: np.ndarray, spacing: float, longest: float) -> None:
        self.surface = build_surface(vertices, faces)
        count = len(self.surface.vertices)
        self.largest_gap = LARGEST_GAP * spacing
        self.rise = _rise(self.surface, spacing)
        kept = np.maximum(np.minimum(self.rise, self.largest_gap), LEAST_GAP)
        # Twice the element gap stays between a triangle at its particles' gap and the bulge, or the vertex is looked at by itself. A side may lie over the
        # vertex with its middle: the longest one, and longer while tension is soft.
        sharp = bulge(self.surface, 0.5 * STRETCHED * longest) > kept - 2.0 * ELEMENT_GAP
        edges = unique_edges(self.surface.faces)
        numbers = np.arange(count)
        above_point, above_edge = _rows_above(self.surface.faces)
        self.face_tree = build_tree(self.surface.vertices[self.surface.faces].mean(axis=1), _FACES)
        refit(self.face_tree, self.surface.faces, self.surface.vertices)
        self._points, self._above_point = elements(np.flatnonzero(sharp), numbers), above_point[sharp]
        near_sharp = sharp[edges].any(axis=1)
        self._edges, self._above_edge = elements(edges[near_sharp], numbers), above_edge[near_sharp]
        self._point_blocks = blocks_over(self._points, self.surface.vertices[sharp])
        self._edge_blocks = blocks_over(self._edges, self.surface.vertices[edges[near_sharp]].mean(axis=1))

    def pairs(self, cloth: ClothElements, positions: np.ndarray, reach: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Nodes (N,4) of body vertex-cloth triangle and of cloth edge-body edge pairs closer than `reach` m, and for both, one after the other, the rows
        of pseudo-normals above the body's element. Body vertices are numbered after the P particles of `positions` (P,3)."""
        count, both = len(positions), (positions, self.surface.vertices)
        # No cloth element shares an identity with one of the body, whatever their numbers: the cloth's are shifted.
        shift = np.int32(len(self.surface.vertices))
        triangles, edges = (part._replace(identity=part.identity + shift) for part in (cloth.triangle_blocks, cloth.edge_blocks))
        pierced = near_pairs(TRIANGLE_POINT, reach, triangles, self._point_blocks, both)
        crossed = near_pairs(EDGE_EDGE, reach, edges, self._edge_blocks, both)
        points = np.concatenate([count + self._points.nodes[pierced[:, 1], :1], cloth.corners_of(pierced[:, 0])], axis=1)
        crossing = np.concatenate([cloth.ends_of(crossed[:, 0]), count + self._edges.nodes[crossed[:, 1], :2]], axis=1)
        return points, crossing, np.concatenate([self._above_point[pierced[:, 1]], self._above_edge[crossed[:, 1]]])
