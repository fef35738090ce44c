"""Which triangles cross: an exact judge, independent of the solver's contact.

Two triangles cross where an edge of one meets the other. Signs come from floating point where its error bound leaves no doubt, else from whole
numbers, so a verdict is never a matter of rounding. Touching counts as crossing, except between triangles that share a vertex: there only an edge
that passes through the inside of the other triangle counts.
"""

from __future__ import annotations

import math

import numpy as np

from garmentcad.arrays import entry, floats, frozen, indices, kernel
from garmentcad.geometry.closest import cross, dot, minus, row

_NO, _DOUBT, _YES = 0, 1, 2  # the greatest of the verdicts on its edges is that on a pair
_DET_ERROR = 1e-14  # of the sum of the absolute terms of a 3 x 3 determinant of differences (a dozen roundings of 1.1e-16 each)
_AXIS_ERROR = 1e-14  # of length times length, for the projection of a difference on an axis
_USUAL_PAIRS = 16  # of overlapping boxes, for each triangle: room for these is there from the start
Point = tuple[int, int, int]


def crossing_triangle_pairs(positions: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Pairs (K,2) of triangles (F,3) of one mesh that cross, each pair once, rising. positions: (P,3)."""
    positions, triangles = floats(positions), indices(triangles)
    return _crossing(positions, triangles, indices(np.arange(len(triangles))))


def crossing_triangle_pairs_between(positions: np.ndarray, triangles: np.ndarray, other_positions: np.ndarray, other_triangles: np.ndarray) -> np.ndarray:
    """Pairs (K,2) of a triangle of the first mesh and a triangle of the second mesh that cross, rising."""
    both = floats(np.concatenate([positions, other_positions]))
    joined = indices(np.concatenate([triangles, np.asarray(other_triangles) + len(positions)]))
    return _crossing(both, joined, indices(np.arange(len(joined)) >= len(triangles))) - [0, len(triangles)]


def crossing_owners(positions: np.ndarray, triangles: np.ndarray, owner: np.ndarray) -> dict[tuple[int, int], int]:
    """Rising pairs of different owners of which a triangle of one crosses a triangle of the other, and how many pairs of triangles do at least. owner: (F,).

    Where whole parts lie on each other every verdict takes exact arithmetic: it is asked for owners of whom nothing is sure, and up to their first crossing.
    """
    positions, triangles = floats(positions), indices(triangles)
    near = _near(positions, triangles, indices(owner))
    verdict = _verdicts(near, positions, triangles)
    owners = np.sort(owner[near], axis=1)
    sure, doubt = verdict == _YES, verdict == _DOUBT
    pairs, counts = np.unique(owners[sure], axis=0, return_counts=True)
    found = {(a, b): count for (a, b), count in zip(pairs.tolist(), counts.tolist())}
    for a, b in np.unique(owners[doubt], axis=0).tolist():
        doubtful = near[doubt & (owners == (a, b)).all(axis=1)]
        if (a, b) not in found and any(_cross_exactly(positions, triangles[one], triangles[other]) for one, other in doubtful):
            found[a, b] = 1
    return dict(sorted(found.items()))


def _crossing(positions: np.ndarray, triangles: np.ndarray, group: np.ndarray) -> np.ndarray:
    """Crossing pairs of triangles of different groups (F,)."""
    near = _near(positions, triangles, group)
    verdict = _verdicts(near, positions, triangles)
    for pair in np.flatnonzero(verdict == _DOUBT):
        verdict[pair] = _YES if _cross_exactly(positions, triangles[near[pair, 0]], triangles[near[pair, 1]]) else _NO
    found = near[verdict == _YES]
    return found[np.lexsort((found[:, 1], found[:, 0]))]


def _near(positions: np.ndarray, triangles: np.ndarray, group: np.ndarray) -> np.ndarray:
    """Pairs (K,2) of triangles of different groups (F,) whose boxes overlap."""
    if len(triangles) == 0:
        return np.zeros((0, 2), dtype=np.int32)
    corners = positions[triangles]
    boxes = floats(np.concatenate([corners.min(axis=1), corners.max(axis=1)], axis=1))
    # Sweep along the widest axis: boxes in rising order of their low sides.
    axis = int(np.argmax(boxes[:, 3:].max(axis=0) - boxes[:, :3].min(axis=0)))
    order = indices(np.argsort(boxes[:, axis], kind="stable"))
    near = np.empty((_USUAL_PAIRS * len(order), 2), dtype=np.int32)
    count = _sweep(order, boxes, axis, group, near)
    if count > len(near):
        near = np.empty((count, 2), dtype=np.int32)
        _sweep(order, boxes, axis, group, near)
    return near[:count]


def _verdicts(near: np.ndarray, positions: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Verdicts (K,) int8 on pairs, in floating point."""
    verdict = np.empty(len(near), dtype=np.int8)
    _judge(near, frozen(positions[:]), frozen(triangles[:]), verdict)  # always so: a kernel is compiled anew for arrays that may be written
    return verdict


@entry
@kernel
def _sweep(order, boxes, axis, group, pairs):  # type: ignore[no-untyped-def]
    """Pairs of different groups whose boxes overlap; returns their number and stores as many as fit."""
    second, third = (axis + 1) % 3, (axis + 2) % 3
    count = 0
    for i in range(len(order)):
        one = order[i]
        for j in range(i + 1, len(order)):
            other = order[j]
            if boxes[other, axis] > boxes[one, 3 + axis]:
                break
            if group[one] == group[other]:
                continue
            if boxes[one, second] > boxes[other, 3 + second] or boxes[other, second] > boxes[one, 3 + second]:
                continue
            if boxes[one, third] > boxes[other, 3 + third] or boxes[other, third] > boxes[one, 3 + third]:
                continue
            if count < len(pairs):
                pairs[count, 0], pairs[count, 1] = min(one, other), max(one, other)
            count += 1
    return count


@kernel
def _volume_sign(points, a, b, c, d):  # type: ignore[no-untyped-def]
    """Sign of (b - a) x (c - a) . (d - a), 0 in doubt."""
    ux, uy, uz = points[b, 0] - points[a, 0], points[b, 1] - points[a, 1], points[b, 2] - points[a, 2]
    vx, vy, vz = points[c, 0] - points[a, 0], points[c, 1] - points[a, 1], points[c, 2] - points[a, 2]
    wx, wy, wz = points[d, 0] - points[a, 0], points[d, 1] - points[a, 1], points[d, 2] - points[a, 2]
    value = (uy * vz - uz * vy) * wx + (uz * vx - ux * vz) * wy + (ux * vy - uy * vx) * wz
    size = (abs(uy * vz) + abs(uz * vy)) * abs(wx) + (abs(uz * vx) + abs(ux * vz)) * abs(wy) + (abs(ux * vy) + abs(uy * vx)) * abs(wz)
    if abs(value) > _DET_ERROR * size:
        return 1 if value > 0.0 else -1
    return 0


@kernel
def _parted_along(axis, p, q, a, b, c):  # type: ignore[no-untyped-def]
    """True if the projections on `axis` of p and q lie surely apart from those of a, b, c."""
    vp, vq, vb, vc = minus(p, a), minus(q, a), minus(b, a), minus(c, a)
    far = max(dot(vp, vp), dot(vq, vq), dot(vb, vb), dot(vc, vc))
    doubt = _AXIS_ERROR * math.sqrt(dot(axis, axis) * far)
    ep, eq, eb, ec = dot(vp, axis), dot(vq, axis), dot(vb, axis), dot(vc, axis)
    return min(ep, eq) > max(0.0, eb, ec) + doubt or max(ep, eq) < min(0.0, eb, ec) - doubt


@kernel
def _parted(p, q, a, b, c):  # type: ignore[no-untyped-def]
    """True if a plane upright on abc, along one of its edges or along pq, surely keeps the segment pq apart from the triangle."""
    n = cross(minus(b, a), minus(c, a))
    return (
        _parted_along(cross(n, minus(b, a)), p, q, a, b, c)
        or _parted_along(cross(n, minus(c, b)), p, q, a, b, c)
        or _parted_along(cross(n, minus(a, c)), p, q, a, b, c)
        or _parted_along(cross(n, minus(q, p)), p, q, a, b, c)
    )


@kernel
def _edge_verdict(points, p, q, a, b, c):  # type: ignore[no-untyped-def]
    """Does the segment pq meet the triangle abc?"""
    side_p, side_q = _volume_sign(points, a, b, c, p), _volume_sign(points, a, b, c, q)
    if side_p * side_q > 0:
        return _NO
    turn_a, turn_b, turn_c = _volume_sign(points, p, q, a, b), _volume_sign(points, p, q, b, c), _volume_sign(points, p, q, c, a)
    if max(turn_a, turn_b, turn_c) > 0 and min(turn_a, turn_b, turn_c) < 0:
        return _NO
    if side_p * side_q < 0 and turn_a != 0 and turn_b != 0 and turn_c != 0:
        return _YES
    return _NO if _parted(row(points, p), row(points, q), row(points, a), row(points, b), row(points, c)) else _DOUBT


@kernel
def _pair_verdict(points, one, other):  # type: ignore[no-untyped-def]
    shared, at_one, at_other = 0, 0, 0
    for i in range(3):
        for j in range(3):
            if one[i] == other[j]:
                shared, at_one, at_other = shared + 1, i, j
    # Triangles over a common edge meet elsewhere only if they are folded flat onto each other, which is touching.
    if shared > 1:
        return _NO
    verdict = _NO
    for k in range(3):
        # Only the edge opposite a shared vertex can pass through the inside of the other triangle.
        if shared == 0 or k == (at_one + 1) % 3:
            verdict = max(verdict, _edge_verdict(points, one[k], one[(k + 1) % 3], other[0], other[1], other[2]))
        if shared == 0 or k == (at_other + 1) % 3:
            verdict = max(verdict, _edge_verdict(points, other[k], other[(k + 1) % 3], one[0], one[1], one[2]))
    return verdict


@entry
@kernel
def _judge(pairs, points, triangles, verdict):  # type: ignore[no-untyped-def]
    for k in range(len(pairs)):
        verdict[k] = _pair_verdict(points, triangles[pairs[k, 0]], triangles[pairs[k, 1]])


def _cross_exactly(positions: np.ndarray, one: np.ndarray, other: np.ndarray) -> bool:
    """The verdict in whole numbers: floats are multiples of powers of two, and where triangles meet does not depend on their size."""
    ratios = {int(node): [float(value).as_integer_ratio() for value in positions[node]] for node in (*one, *other)}
    scale = max(below for ratio in ratios.values() for _, below in ratio)
    at: dict[int, Point] = {}
    for node, ratio in ratios.items():
        x, y, z = (above * (scale // below) for above, below in ratio)
        at[node] = (x, y, z)
    shared = set(map(int, one)) & set(map(int, other))
    for edges_of, face in ((one, other), (other, one)):
        triangle = [at[int(node)] for node in face]
        for k in range(3):
            p, q = int(edges_of[k]), int(edges_of[(k + 1) % 3])
            if not shared.intersection((p, q)) and _segment_meets(at[p], at[q], triangle, strictly=bool(shared)):
                return True
    return False


def _volume(a: Point, b: Point, c: Point, d: Point) -> int:
    u, v, w = ([x - y for x, y in zip(end, a)] for end in (b, c, d))
    return (u[1] * v[2] - u[2] * v[1]) * w[0] + (u[2] * v[0] - u[0] * v[2]) * w[1] + (u[0] * v[1] - u[1] * v[0]) * w[2]


def _segment_meets(p: Point, q: Point, triangle: list[Point], strictly: bool) -> bool:
    a, b, c = triangle
    side_p, side_q = _volume(a, b, c, p), _volume(a, b, c, q)
    if side_p == 0 and side_q == 0:
        return not strictly and _meet_in_plane(p, q, triangle)
    turns = [_volume(p, q, a, b), _volume(p, q, b, c), _volume(p, q, c, a)]
    if strictly:
        return side_p * side_q < 0 and (all(turn > 0 for turn in turns) or all(turn < 0 for turn in turns))
    return side_p * side_q <= 0 and (all(turn >= 0 for turn in turns) or all(turn <= 0 for turn in turns))


def _meet_in_plane(p: Point, q: Point, triangle: list[Point]) -> bool:
    """Closed segment against closed triangle in one plane; a triangle without area counts as its edges, which are tested against the other triangle."""
    a, b, c = triangle
    u, v = ([x - y for x, y in zip(end, a)] for end in (b, c))
    normal = (u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0])
    dropped = next((axis for axis in range(3) if normal[axis] != 0), None)
    if dropped is None:
        return False
    first, second = (axis for axis in range(3) if axis != dropped)

    def turn(x: Point, y: Point, z: Point) -> int:
        return (y[first] - x[first]) * (z[second] - x[second]) - (y[second] - x[second]) * (z[first] - x[first])

    # In a plane, separating lines along the triangle's edges and along the segment are all that is needed.
    way = turn(a, b, c)
    for start, end in ((a, b), (b, c), (c, a)):
        if turn(start, end, p) * way < 0 and turn(start, end, q) * way < 0:
            return False
    sides = [turn(p, q, corner) for corner in triangle]
    return not (all(side > 0 for side in sides) or all(side < 0 for side in sides))
