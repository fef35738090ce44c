"""Cut of a triangle mesh with a plane, as closed loops and open chains of points on mesh edges."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Plane:
    """Points x with normal . x = offset. normal: (3,) unit; offset in m."""

    normal: np.ndarray
    offset: float


def horizontal(height_m: float) -> Plane:
    """The plane at a height above the floor."""
    return Plane(np.array([0.0, 1.0, 0.0]), height_m)


@dataclass(frozen=True)
class Chain:
    """One connected line of the cut. points: (N,3) m, one a mesh edge (the first is not repeated at the end of a closed one).

    triangles: the mesh triangle of each segment points[k] -> points[k+1], N of them if closed, N-1 if open. ends: for each segment the two corners
    of its triangle's edge and the fraction along it, at start and end: (from, to, fraction) with `from` and `to` in 0..2.
    """

    points: np.ndarray
    triangles: np.ndarray
    closed: bool
    start_corners: np.ndarray  # (S,2) int
    start_fraction: np.ndarray  # (S,)
    end_corners: np.ndarray  # (S,2) int
    end_fraction: np.ndarray  # (S,)

    def length(self) -> float:
        """Length in space, m."""
        points = np.vstack([self.points, self.points[:1]]) if self.closed else self.points
        return float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())

    def steps_on(self, corner_uv: np.ndarray) -> np.ndarray:
        """(S,2) the same line on the flat pattern, segment by segment: corner_uv (F,3,2) holds the flat corners of each triangle; same unit as they have."""
        uv = corner_uv[self.triangles]
        rows = np.arange(len(uv))

        def flat(corners: np.ndarray, fraction: np.ndarray) -> np.ndarray:
            a, b = uv[rows, corners[:, 0]], uv[rows, corners[:, 1]]
            return np.asarray(a + fraction[:, None] * (b - a))

        return flat(self.end_corners, self.end_fraction) - flat(self.start_corners, self.start_fraction)

    def length_on(self, corner_uv: np.ndarray) -> float:
        """Length of that line."""
        return float(np.linalg.norm(self.steps_on(corner_uv), axis=1).sum())

    def span_around(self, center: np.ndarray, plane: Plane) -> float:
        """Angle about the line through `center` (3,) along the plane's normal, rad, within which the whole chain lies."""
        angle = np.sort(self._angles(center, plane))
        return 2.0 * math.pi - float(np.diff(np.append(angle, angle[0] + 2.0 * math.pi)).max())

    def winds_around(self, center: np.ndarray, plane: Plane) -> bool:
        """Whether a closed chain goes around the line through `center` (3,) along the plane's normal."""
        if not self.closed:
            return False
        angle = self._angles(center, plane)
        turn = np.diff(np.append(angle, angle[0]))
        return abs(float(((turn + math.pi) % (2.0 * math.pi) - math.pi).sum())) > math.pi

    def _angles(self, center: np.ndarray, plane: Plane) -> np.ndarray:
        side = np.cross(plane.normal, [1.0, 0.0, 0.0] if abs(plane.normal[0]) < 0.9 else [0.0, 0.0, 1.0])
        side /= math.sqrt(float(side @ side))
        other = np.cross(plane.normal, side)
        return np.arctan2((self.points - center) @ other, (self.points - center) @ side)


def cut(positions: np.ndarray, triangles: np.ndarray, plane: Plane) -> list[Chain]:
    """All chains in which `plane` cuts the mesh of `triangles` (F,3) over `positions` (P,3) m.

    A vertex exactly in the plane counts as above it, so every triangle is cut in one segment or not at all. Where more than two triangles share an edge, as
    where a lining is caught in a seam, the walk takes the first not yet used, and what it went around until it came back to the edge is a chain of its own:
    each layer is one, whatever the order of triangles. Chains come in order of their first triangle.
    """
    height = positions @ plane.normal - plane.offset
    above = (height >= 0.0)[triangles]
    crossed = np.flatnonzero((above[:, 0] != above[:, 1]) | (above[:, 1] != above[:, 2]))
    if len(crossed) == 0:
        return []
    between = above[crossed] != np.roll(above[crossed], -1, axis=1)  # by edge: corner and the next one lie on different sides
    first_corners = np.nonzero(between)[1].reshape(-1, 2)
    ends = np.stack([first_corners, (first_corners + 1) % 3], axis=2)
    corners = triangles[crossed[:, None, None], ends]  # (S, 2 ends, 2 particles)
    fraction = height[corners[..., 0]] / (height[corners[..., 0]] - height[corners[..., 1]])
    points = positions[corners[..., 0]] + fraction[..., None] * (positions[corners[..., 1]] - positions[corners[..., 0]])
    # Segments by mesh edge, each edge's in order: those of edge e are beside[starts[e] : starts[e + 1]].
    keys = (corners.min(axis=2).astype(np.int64) * len(positions) + corners.max(axis=2)).ravel()
    order = np.argsort(keys, kind="stable")
    begins = np.diff(keys[order], prepend=-1) > 0
    edge_of = np.empty(len(keys), dtype=np.int64)
    edge_of[order] = np.cumsum(begins) - 1
    beside, starts, edges = (order // 2).tolist(), [*np.flatnonzero(begins).tolist(), len(keys)], edge_of.reshape(-1, 2).tolist()
    used = [False] * len(crossed)

    def walk(segment: int, side: int) -> list[tuple[int, int]]:
        """Segments from `segment` on, leaving it through its end `side`: (segment, side through which it is left)."""
        path = [(segment, side)]
        while True:
            edge = edges[segment][side]
            following = next((other for other in beside[starts[edge] : starts[edge + 1]] if not used[other]), None)
            if following is None:
                return path
            used[following] = True
            segment, side = following, 1 - edges[following].index(edge)
            path.append((segment, side))

    chains = []
    for first in range(len(crossed)):
        if used[first]:
            continue
        used[first] = True
        path = walk(first, 1)
        last, left = path[-1]
        if len(path) <= 2 or edges[last][left] != edges[first][0]:
            path = [(segment, 1 - side) for segment, side in reversed(walk(first, 0)[1:])] + path
        for part, closed in _apart(path, edges):
            segments = np.array([segment for segment, _ in part])
            exits = np.array([side for _, side in part])
            enters = 1 - exits
            line = points[segments, enters]
            if not closed:
                line = np.vstack([line, points[segments[-1:], exits[-1:]]])
            chains.append(
                Chain(
                    line,
                    crossed[segments],
                    closed,
                    ends[segments, enters],
                    fraction[segments, enters],
                    ends[segments, exits],
                    fraction[segments, exits],
                )
            )
    return sorted(chains, key=lambda chain: int(chain.triangles.min()))


def _apart(path: list[tuple[int, int]], edges: list[list[int]]) -> list[tuple[list[tuple[int, int]], bool]]:
    """A path of segments, each with the side through which it is left, as the loops in it and what is left of it, and whether each is closed. edges: of both
    sides of each segment."""
    found: list[tuple[list[tuple[int, int]], bool]] = []
    way: list[tuple[int, int]] = []
    entered = {edges[path[0][0]][1 - path[0][1]]: 0}  # how many segments of the way lie before an edge
    for segment, side in path:
        way.append((segment, side))
        edge = edges[segment][side]
        since = entered.get(edge)
        if since is not None and len(way) - since > 2:
            found.append((way[since:], True))
            del way[since:]
            entered = {other: before for other, before in entered.items() if before <= since}
        else:
            entered[edge] = len(way)
    return found + ([(way, False)] if way else [])
