"""Cloth against itself: which vertices and triangles, edges and edges are near each other, within and between panels."""

from __future__ import annotations

import numpy as np
from scipy.sparse import csr_matrix

from garmentcad.arrays import floats, indices, unique_pairs
from garmentcad.cloth.cloth import Cloth
from garmentcad.cloth.weld import welded_particles
from garmentcad.contact.elements import elements, unique_edges
from garmentcad.contact.near import EDGE_EDGE_ONCE, POINT_TRIANGLE, blocks_over, near_pairs
from garmentcad.units import MM_TO_M

_REST = 1.2  # pairs whose rest distance along the cloth is below this many gaps are left out
_PANEL_SHIFT = 100.0  # m between panels where they are laid out for their rest distances
_PASSED_EDGES = 2  # as far along the cloth, over stitches too, as its own corner may lie in a stitch's way


class ClothElements:
    """Vertices, edges and triangles of a cloth, and which of their pairs are in reach of each other. Particles that are stitched together count as one."""

    def __init__(self, cloth: Cloth, largest_gap: float) -> None:
        count, triangles = cloth.particle_count, cloth.particle_triangles
        identity = np.asarray(welded_particles(cloth))
        self._cloth, self._points, self._edges = cloth, np.unique(triangles), unique_edges(triangles)
        # Neighbours on the pattern stay neighbours on the body, so the trees are built there, once.
        rest = np.zeros((count, 3))
        rest[cloth.vertex_particle] = _laid_out(cloth)
        self._point_blocks = blocks_over(elements(self._points, identity), rest[self._points])
        self.triangle_blocks = blocks_over(elements(triangles, identity), _laid_out(cloth)[cloth.triangles].mean(axis=1))
        self.edge_blocks = blocks_over(elements(self._edges, identity), rest[self._edges].mean(axis=1))
        self._neighbours = _Neighbours(cloth, identity, self._edges, _REST * largest_gap)
        self._identity = identity
        self.let_pass(np.zeros(count, dtype=bool))

    def let_pass(self, passing: np.ndarray) -> None:
        """From now on particles `passing` (P,) bool pass through the cloth that is theirs within two edges, stitches counted as closed."""
        near, ends = np.zeros(len(passing), dtype=bool), self._identity[self._edges]
        near[self._identity[passing]] = True
        for _ in range(_PASSED_EDGES):
            near[ends[near[ends].any(axis=1)]] = True
        self._passing, self._passed = passing, near[self._identity]

    def pairs(self, positions: np.ndarray, reach: float) -> tuple[np.ndarray, np.ndarray]:
        """Nodes (N,4) of vertex-triangle and of edge-edge pairs of the cloth with itself that are closer than `reach` m, neighbours left out."""
        both = (positions, positions)
        touched = near_pairs(POINT_TRIANGLE, reach, self._point_blocks, self.triangle_blocks, both)
        crossed = near_pairs(EDGE_EDGE_ONCE, reach, self.edge_blocks, self.edge_blocks, both)
        touched = touched[~self._neighbours.vertex_triangle(self._points[touched[:, 0]], touched[:, 1])]
        crossed = crossed[~self._neighbours.edge_edge(crossed[:, 0], crossed[:, 1])]
        points = np.concatenate([self._points[touched[:, :1]], self.corners_of(touched[:, 1])], axis=1)
        edges = np.concatenate([self.ends_of(crossed[:, 0]), self.ends_of(crossed[:, 1])], axis=1)
        if self._passing.any():
            points, edges = points[self._kept(points)], edges[self._kept(edges)]
        return points, edges

    def corners_of(self, triangle: np.ndarray) -> np.ndarray:
        """Particles (K,3) of triangles (K,)."""
        return np.asarray(self._cloth.vertex_particle[self._cloth.triangles[triangle]])

    def ends_of(self, edge: np.ndarray) -> np.ndarray:
        """Particles (K,2) of edges (K,)."""
        return np.asarray(self._edges[edge])

    def _kept(self, nodes: np.ndarray) -> np.ndarray:
        """(K,) bool: of pairs by their nodes (K,4), those that do not pass."""
        return ~(self._passing[nodes].any(axis=1) & self._passed[nodes].all(axis=1))


class _Neighbours:
    """Pairs of elements whose rest distance along the cloth, over welded particles and edges too, is below `reach`; they never count as contact.

    The shortest way from an element to another one leaves the first at a corner p or enters the second at one. So all follows from the edges near each
    corner on its panel: triangles over such an edge, or at an end of it that is near as well, are near p; edges at p are near that edge.
    """

    def __init__(self, cloth: Cloth, identity: np.ndarray, edges: np.ndarray, reach: float) -> None:
        vertices, laid = np.arange(len(cloth.vertex_panel)), _laid_out(cloth)
        points, sides = elements(vertices, vertices), elements(unique_edges(cloth.triangles), vertices)
        ways = blocks_over(sides, laid[sides.nodes[:, :2]].mean(axis=1))
        near = near_pairs(POINT_TRIANGLE, reach, blocks_over(points, laid), ways, (laid, laid))
        welded = identity[cloth.vertex_particle]
        corner, ends = near[:, 0], sides.nodes[near[:, 1], :2]
        count, triangles = int(identity.max(initial=0)) + 1, welded[cloth.triangles]
        whole, edge = unique_pairs(identity[edges])
        self._edge = indices(edge)
        self._identity = identity
        at_edge = _incidence(np.arange(len(whole))[:, None], whole, (len(whole), count))
        at_triangle = _incidence(np.arange(len(triangles))[:, None], triangles, (len(triangles), count))
        side = _row_of(whole, np.sort(welded[ends], axis=1))
        near_edge = _incidence(welded[corner][:, None], side[:, None], (count, len(whole)))
        close = np.linalg.norm(laid[ends] - laid[corner][:, None], axis=2) <= reach
        near_point = _incidence(np.repeat(welded[corner], 2).reshape(-1, 2)[close][:, None], welded[ends][close][:, None], (count, count))
        near_point = near_point + near_point.T
        over_edge = (at_edge @ at_triangle.T) == 2
        self._triangle_count = len(triangles)
        self._vertex_triangle = _keys(near_edge @ over_edge + near_point @ at_triangle.T)
        edge_edge = at_edge @ near_edge + at_edge @ near_point @ at_edge.T
        self._edge_edge = _keys(edge_edge + edge_edge.T)

    def vertex_triangle(self, particle: np.ndarray, triangle: np.ndarray) -> np.ndarray:
        """(K,) bool for particles and triangles (K,)."""
        return _among(self._identity[particle].astype(np.int64) * self._triangle_count + triangle, self._vertex_triangle)

    def edge_edge(self, one: np.ndarray, other: np.ndarray) -> np.ndarray:
        """(K,) bool for pairs of edges (K,)."""
        width = int(self._edge.max(initial=0)) + 1
        return _among(self._edge[one].astype(np.int64) * width + self._edge[other], self._edge_edge)


def _laid_out(cloth: Cloth) -> np.ndarray:
    """(V,3) m: the vertices on their panels, every panel in a plane of its own."""
    return floats(np.column_stack([cloth.vertex_uv_mm * MM_TO_M, _PANEL_SHIFT * cloth.vertex_panel]))


def _incidence(rows: np.ndarray, columns: np.ndarray, shape: tuple[int, int]) -> csr_matrix:
    """Matrix of counts: 1 for each pair of a row and a column (arrays that broadcast)."""
    rows, columns = np.broadcast_arrays(rows, columns)
    return csr_matrix((np.ones(rows.size, dtype=np.int32), (rows.ravel(), columns.ravel())), shape=shape)


def _row_of(table: np.ndarray, rows: np.ndarray) -> np.ndarray:
    """Index in the rising `table` (N,2) of each of its `rows` (K,2)."""
    width = int(table.max(initial=0)) + 1
    return np.searchsorted(table[:, 0].astype(np.int64) * width + table[:, 1], rows[:, 0].astype(np.int64) * width + rows[:, 1])


def _keys(matrix: csr_matrix) -> np.ndarray:
    """row * columns + column of the entries of a matrix of counts, rising."""
    matrix.sum_duplicates()
    rows = np.repeat(np.arange(matrix.shape[0], dtype=np.int64), np.diff(matrix.indptr))
    return rows * matrix.shape[1] + matrix.indices


def _among(keys: np.ndarray, rising: np.ndarray) -> np.ndarray:
    """(K,) bool: which keys (K,) are in `rising`.

    Keys come nearly sorted, so that a search stays in one place of memory; np.isin sorts both, which took four fifths of a detection.
    """
    if len(rising) == 0:
        return np.zeros(len(keys), dtype=bool)
    return np.asarray(rising[np.minimum(np.searchsorted(rising, keys), len(rising) - 1)] == keys)
