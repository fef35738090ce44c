"""Constrained Delaunay triangulation of a region given by its directed border edges.

All points are corners of the result and no others are. The points are first moved by about 1e-8 of their extent, so that none are collinear and no four
lie on a circle: the Delaunay triangulation is then unique, missing edges can be put in by plain flips (Sloan 1993, "A fast algorithm for generating
constrained Delaunay triangulations", Computers & Structures 47) and no corner of zero height can arise at a point within a straight border, because the
triangle over it would have a circle that holds every point across. Inside and outside follow from the direction of the border edges alone.
"""

from __future__ import annotations

import numpy as np
from scipy.spatial import Delaunay

from garmentcad.arrays import indices
from garmentcad.errors import GarmentError

_JITTER = 1e-8  # of the extent; far above round-off of the tests below, far below any feature that a pattern has


class TriangulationError(GarmentError):
    """The border edges do not bound a region: they cross, or do not close; or an inner edge crosses one."""


def constrained_triangles(points: np.ndarray, border: np.ndarray, inner: np.ndarray | None = None) -> np.ndarray:
    """Counter-clockwise triangles (T,3) int32 that fill the region to the left of the directed `border` edges (E,2) and have the `inner` edges (I,2).

    points (N,2): distances between them must be above 1e-6 of their extent; points outside the region are allowed and not used.
    Raises TriangulationError when edges cross or the region is open.
    """
    extent = float(np.ptp(points, axis=0).max())
    noise = np.random.default_rng(0).uniform(-1.0, 1.0, points.shape) * (_JITTER * extent)
    moved = points - points.mean(axis=0) + noise
    mesh = _Flips(moved, Delaunay(moved).simplices)
    edges = border.tolist() + ([] if inner is None else inner.tolist())
    fixed = {(min(a, b), max(a, b)) for a, b in edges}
    for a, b in edges:
        mesh.insert(a, b, fixed)
    triangles = mesh.flood(border)
    return triangles[np.lexsort(triangles.T[::-1])]


class _Flips:
    """A triangulation as the map from each directed edge to the corner on its left."""

    def __init__(self, points: np.ndarray, triangles: np.ndarray) -> None:
        self.points: list[tuple[float, float]] = [(x, y) for x, y in points.tolist()]
        self.apex: dict[tuple[int, int], int] = {}
        self.leaving: list[set[int]] = [set() for _ in self.points]
        for a, b, c in triangles.tolist():
            self._add(a, b, c)

    def _add(self, a: int, b: int, c: int) -> None:
        for start, end, tip in ((a, b, c), (b, c, a), (c, a, b)):
            self.apex[start, end] = tip
            self.leaving[start].add(end)

    def _turn(self, a: int, b: int, c: int) -> float:
        """Twice the area of abc: positive when c lies to the left of a -> b."""
        (ax, ay), (bx, by), (cx, cy) = self.points[a], self.points[b], self.points[c]
        return (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)

    def _in_circle(self, a: int, b: int, c: int, d: int) -> bool:
        """Whether d lies inside the circle through the counter-clockwise triangle abc."""
        dx, dy = self.points[d]
        (ax, ay), (bx, by), (cx, cy) = ((x - dx, y - dy) for x, y in (self.points[a], self.points[b], self.points[c]))
        a2, b2, c2 = ax * ax + ay * ay, bx * bx + by * by, cx * cx + cy * cy
        return ax * (by * c2 - b2 * cy) - ay * (bx * c2 - b2 * cx) + a2 * (bx * cy - by * cx) > 0.0

    def _flip(self, a: int, b: int) -> tuple[int, int]:
        """Replace the edge ab by the other diagonal of its quadrilateral; returns that edge."""
        left, right = self.apex.pop((a, b)), self.apex.pop((b, a))
        self.leaving[a].discard(b)
        self.leaving[b].discard(a)
        self._add(right, b, left)
        self._add(left, a, right)
        return left, right

    def _crossed(self, a: int, b: int) -> list[tuple[int, int]]:
        """Edges (right end, left end) that the segment ab crosses, in order from a."""
        for right in self.leaving[a]:
            left = self.apex[a, right]
            if self._turn(a, b, right) < 0.0 < self._turn(a, b, left):
                break
        else:
            raise TriangulationError(f"no triangle of point {a} looks toward point {b}")
        crossed = []
        while True:
            crossed.append((right, left))
            tip = self.apex.get((left, right))
            if tip is None:
                raise TriangulationError(f"the way from point {a} to point {b} leaves the triangulation")
            if tip == b:
                return crossed
            if self._turn(a, b, tip) > 0.0:
                left = tip
            else:
                right = tip

    def insert(self, a: int, b: int, fixed: set[tuple[int, int]]) -> None:
        """Make ab an edge, and what had to change for it Delaunay again."""
        if (a, b) in self.apex or (b, a) in self.apex:
            return
        crossed = self._crossed(a, b)
        if any((min(edge), max(edge)) in fixed for edge in crossed):
            raise TriangulationError(f"border edges cross near points {a} and {b}")
        made = []
        patience = 100 + 10 * len(crossed) ** 2
        while crossed:
            patience -= 1
            if patience < 0:
                raise TriangulationError(f"the edge between points {a} and {b} cannot be put in")
            p, q = crossed.pop(0)
            left, right = self.apex[p, q], self.apex[q, p]
            if self._turn(left, right, p) * self._turn(left, right, q) >= 0.0:
                crossed.append((p, q))  # not convex yet: wait for its neighbours
                continue
            edge = self._flip(p, q)
            if not {a, b} & set(edge) and self._turn(a, b, left) * self._turn(a, b, right) < 0.0:
                crossed.append(edge)
            else:
                made.append(edge)
        self._restore(made, fixed)

    def _restore(self, edges: list[tuple[int, int]], fixed: set[tuple[int, int]]) -> None:
        while edges:
            a, b = edges.pop()
            if (min(a, b), max(a, b)) in fixed or (a, b) not in self.apex or (b, a) not in self.apex:
                continue
            left, right = self.apex[a, b], self.apex[b, a]
            if self._in_circle(a, b, left, right):
                self._flip(a, b)
                edges += [(right, b), (b, left), (left, a), (a, right)]

    def flood(self, border: np.ndarray) -> np.ndarray:
        """Triangles to the left of the border edges, and all that are reached from them without crossing one."""
        todo = [(a, b) for a, b in border.tolist()]
        found: dict[tuple[int, int, int], None] = {}
        inside = set(todo)
        outside = {(b, a) for a, b in todo}
        while todo:
            a, b = todo.pop()
            if (a, b) not in self.apex:
                raise TriangulationError(f"the region is open at the edge of points {a} and {b}")
            c = self.apex[a, b]
            triangle = min((a, b, c), (b, c, a), (c, a, b))
            if triangle in found:
                continue
            found[triangle] = None
            for p, q in ((a, b), (b, c), (c, a)):
                if (p, q) in outside:
                    raise TriangulationError(f"the border edge of points {p} and {q} has the region on its wrong side")
                if (p, q) not in inside:
                    todo.append((q, p))
        return indices(list(found)).reshape(-1, 3)
