"""Cut of a triangle mesh with a plane, as closed loops and open chains of points on mesh edges."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from garmentcad.arrays import entry, indices, kernel, rows_by_key


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
    keys = corners.min(axis=2).astype(np.int64) * len(positions) + corners.max(axis=2)
    edge_of = np.unique(keys.ravel(), return_inverse=True)[1].ravel()
    starts, beside = rows_by_key(edge_of, int(edge_of.max()) + 1)  # segments by mesh edge, each edge's in order
    count = len(crossed)
    paths, begins, closed = np.empty((count, 2), dtype=np.int32), np.zeros(count + 1, dtype=np.int32), np.zeros(count, dtype=np.int32)
    edges, route, before, used = indices(edge_of.reshape(-1, 2)), np.empty((2 * count, 2), dtype=np.int32), np.full(len(starts), -1), np.zeros(count, np.int32)
    found = _walk((starts, beside // 2, edges, used), route, before, paths, begins, closed)
    chains = [_chain(paths[begins[k] : begins[k + 1]], bool(closed[k]), crossed, ends, fraction, points) for k in range(found)]
    return sorted(chains, key=lambda chain: int(chain.triangles.min()))


def _chain(path: np.ndarray, closed: bool, crossed: np.ndarray, ends: np.ndarray, fraction: np.ndarray, points: np.ndarray) -> Chain:
    """The chain of a path (N,2) of segments, each with the side through which it is left."""
    segments, exits = path.T
    enters = 1 - exits
    line = points[segments, enters]
    if not closed:
        line = np.vstack([line, points[segments[-1:], exits[-1:]]])
    return Chain(line, crossed[segments], closed, ends[segments, enters], fraction[segments, enters], ends[segments, exits], fraction[segments, exits])


@kernel
def _follow(mesh, segment, side, step, route, at):  # type: ignore[no-untyped-def]
    """Goes on from a segment at row `at` of the route, through its end `side`, as far as there are segments, a row up (step 1) or down (-1) for each; returns
    the last row. Rows say through which side a segment is left by who goes up."""
    starts, beside, edges, used = mesh
    while True:
        edge, following = edges[segment, side], -1
        for k in range(starts[edge], starts[edge + 1]):
            if not used[beside[k]]:
                following = beside[k]
                break
        if following < 0:
            return at
        used[following] = 1
        segment, side = following, 1 if edges[following, 0] == edge else 0
        at += step
        route[at, 0], route[at, 1] = segment, side if step > 0 else 1 - side


@entry
@kernel
def _walk(mesh, route, before, paths, begins, closed):  # type: ignore[no-untyped-def]
    """Paths of segments, each with the side through which it is left, in `paths` (S,2), where each begins in it, and whether it is closed; returns how many
    there are. mesh: segments of each edge (starts, segments), edges of both sides of each segment (S,2), used (S,) 0; route (2S,2): room for a way; before:
    by edge, room for how many segments of the way lie before it, -1."""
    edges, used, middle = mesh[2], mesh[3], len(paths)
    found = written = 0
    for segment in range(middle):
        if used[segment]:
            continue
        used[segment] = 1
        route[middle, 0], route[middle, 1] = segment, 1
        first, last = middle, _follow(mesh, segment, 1, 1, route, middle)
        if last - first < 2 or edges[route[last, 0], route[last, 1]] != edges[segment, 0]:
            first = _follow(mesh, segment, 0, -1, route, middle)
        # Loops are taken out of the way as soon as it is back at an edge: rows first to end stay.
        entered, end = edges[route[first, 0], 1 - route[first, 1]], first
        before[entered] = 0
        for row in range(first, last + 1):
            route[end, 0], route[end, 1] = route[row, 0], route[row, 1]
            end += 1
            edge = edges[route[row, 0], route[row, 1]]
            since = before[edge]
            if since < 0 or end - first - since <= 2:
                before[edge] = end - first
                continue
            for k in range(first + since, end):
                paths[written, 0], paths[written, 1] = route[k, 0], route[k, 1]
                written += 1
                passed = edges[route[k, 0], route[k, 1]]
                if before[passed] > since:
                    before[passed] = -1
            end = first + since
            closed[found] = 1
            found += 1
            begins[found] = written
        before[entered] = -1
        for k in range(first, end):
            paths[written, 0], paths[written, 1] = route[k, 0], route[k, 1]
            written += 1
            before[edges[route[k, 0], route[k, 1]]] = -1
        if end > first:
            found += 1
            begins[found] = written
    return found
