"""Pairs that must keep their distance, vertex against triangle or edge against edge: where they stand, impulses, and the test that nothing passed.

A pair names four nodes: particles of the cloth, and after them the vertices of the body. VT: vertex, then the triangle's corners; EE: the two ends of one
edge, then of the other. Weights w (their sum is 0) give the vector between the closest points, sum w x, and the relative velocity there, sum w v; an impulse
J along it changes v_i by J w_i / m_i. Particles that touch the body are held by its planes (planes.py) within the same sweeps.

The side on which a pair stands is remembered while it is closer than half its gap, so that a pair that came through is pushed back the way it came. On a
body nothing need be remembered: it has an outside. (Two body edges that meet in a vertex, one of which held a cloth edge below itself by a micrometre and
the other above, pinned a sleeve with 120 N each.)
Impulses are remembered from step to step; sweeps.py finds them.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import get_num_threads, prange

from garmentcad.arrays import CHUNKS, chunk_range, entry, indices, inlined_kernel, kernel, long_kernel, parallel_kernel
from garmentcad.contact.planes import allowed
from garmentcad.geometry.closest import CORNER, EDGE, FACE, along, cross, dot, minus, point_triangle, row, segment_segment, unit

VERTEX_TRIANGLE, EDGE_EDGE = 0, 1
BY_CLOTH, BY_BODY = 1, 2  # what holds a node, the stronger word last
NEARLY = 1.1  # gaps: a little earlier than at the gap a pair is solved, because a neighbour's impulses may bring it closer than its own velocity does
_ROUNDS = 20  # of the fail-safe, at most
_GENTLE_ROUNDS = 12  # of them with impulses along the normal; then colliding nodes move as one
_ADVANCES = 64  # of the continuous test, at most
KEPT = 0.2  # share of its distance that a pair keeps within a step, whatever happens
# Below this distance, m, it keeps all but so much of it: else step after step would bring it down to round-off, where nobody can tell its sides apart.
LEAST_ROOM, _LOST_THERE = 1e-8, 1e-4
_PARALLEL = 0.05  # sine below which the common normal of two edges says nothing
_SIDEWAYS = 0.1  # cosine to the pseudo-normal of a body below which a normal is neither inward nor outward


class Pairs(NamedTuple):
    """The candidates of one detection, by their distance then."""

    nodes: np.ndarray  # (N,4) int32
    kind: np.ndarray  # (N,) int32 VERTEX_TRIANGLE or EDGE_EDGE
    gap: np.ndarray  # (N,) m
    friction: np.ndarray  # (N,)
    moving: np.ndarray  # (N,) 2.0 where both elements move, 1.0 where one belongs to a body that never does
    outside: np.ndarray  # (N,) int32 row of the body's pseudo-normals, those of a face after the other, above its vertex or edge; -1 for cloth with cloth
    due: np.ndarray  # (N,) m, path of the fastest nodes since detection at which the pair may matter; later as it is looked at
    side: np.ndarray  # (N,) +1 or -1, 0 while unknown; changes as the pair moves
    impulse: np.ndarray  # (N,4) N.s along the normal, then of friction; of the last step


class Stand(NamedTuple):
    """Where the pairs stand at the beginning of a step."""

    weights: np.ndarray  # (N,4)
    normal: np.ndarray  # (N,3) from the second element to the first
    distance: np.ndarray  # (N,) m along the normal; negative for a pair that came through
    active: np.ndarray  # (N,) bool, may come below its gap in the step
    looked: np.ndarray  # (N,) int32, the pairs that were due in this step
    chosen: np.ndarray  # (N,) int32, room for the active ones
    dealt: np.ndarray  # (N,) int32, room to put them in another order
    parts: np.ndarray  # (threads+1,) int32, where each thread's part of the chosen begins
    loads: np.ndarray  # (threads,) int32, room for the visits in it
    root: np.ndarray  # (nodes,) int32, room for the node that stands for all that hang together,
    size: np.ndarray  # (nodes,) int32, for how many pairs these are,
    load: np.ndarray  # (nodes,) int32, for how many visits they took,
    end: np.ndarray  # (nodes,) int32, and for where they end among the chosen
    contacts: np.ndarray  # (N,16) room for weights, normal, speed demanded, give, friction, impulse (4), work, visits of the chosen
    corners: np.ndarray  # (N,4) int32, room for their nodes
    free: np.ndarray  # (nodes,3) m/s, room for the velocities of their nodes free of planes
    stirred: np.ndarray  # (nodes,) int32, room for the visit that last changed a node's velocity
    visited: np.ndarray  # (N,) int32, room for the last visit to each of the chosen
    visits: np.ndarray  # (N,) int32, of the sweeps to each pair, when it was last chosen, and one
    work: np.ndarray  # (N,) J, room for what friction took at each pair
    pressed: np.ndarray  # (nodes,) int8, whether an impulse held a node apart from something in the last step: BY_CLOTH, or BY_BODY


@kernel
def closest_points(kind, a, b, c, d):  # type: ignore[no-untyped-def]
    """Weights of the four nodes, the vector from the second element to the first, and whether both closest points lie inside their elements."""
    if kind == VERTEX_TRIANGLE:
        u, v, w, _, feature = point_triangle(a, b, c, d)
        weights = (1.0, -u, -v, -w)
        inside = feature == FACE
    else:
        s, t, _ = segment_segment(a, b, c, d)
        weights = (1.0 - s, s, t - 1.0, -t)
        inside = 0.0 < s < 1.0 and 0.0 < t < 1.0
    return weights, combined(weights, a, b, c, d), inside


@kernel
def combined(w, a, b, c, d):  # type: ignore[no-untyped-def]
    """w0 a + w1 b + w2 c + w3 d; the weights sum up to 0, so differences to a are enough (and are exact far from the origin)."""
    b, c, d = minus(b, a), minus(c, a), minus(d, a)
    return along(along((w[1] * b[0], w[1] * b[1], w[1] * b[2]), c, w[2]), d, w[3])


@inlined_kernel
def row4(array, index):  # type: ignore[no-untyped-def]
    """Row `index` of an (N,4) array as a tuple."""
    return array[index, 0], array[index, 1], array[index, 2], array[index, 3]


@inlined_kernel
def four(points, nodes):  # type: ignore[no-untyped-def]
    return row(points, nodes[0]), row(points, nodes[1]), row(points, nodes[2]), row(points, nodes[3])


@kernel
def _leads_inward(n, pairs, surface, weights, normal):  # type: ignore[no-untyped-def]
    """Whether `normal`, from the second element of a pair to the first, holds the cloth of a pair with a body inside it."""
    face, feature = pairs.outside[n] // (FACE + 1), pairs.outside[n] % (FACE + 1)
    if pairs.kind[n] == EDGE_EDGE and (weights[2] == 0.0 or weights[3] == 0.0):
        # The end of the edge, which runs from the lower vertex to the higher one.
        one, other = feature - EDGE, (feature - EDGE + 1) % 3
        at_lower = weights[3] == 0.0
        feature = CORNER + (one if (surface.faces[face, one] < surface.faces[face, other]) == at_lower else other)
    lean = dot(normal, (surface.normals[face, feature, 0], surface.normals[face, feature, 1], surface.normals[face, feature, 2]))
    return lean > _SIDEWAYS if pairs.kind[n] == VERTEX_TRIANGLE else lean < -_SIDEWAYS


@kernel
def _stand_range(span, pairs, path, motion, surface, stand):  # type: ignore[no-untyped-def]
    positions, velocities, _, time_step = motion
    for place in range(span[0], span[1]):
        n = stand.looked[place]
        kind, nodes = pairs.kind[n], row4(pairs.nodes, n)
        a, b, c, d = four(positions, nodes)
        weights, apart, inside = closest_points(kind, a, b, c, d)
        if kind == VERTEX_TRIANGLE:
            facing = cross(minus(c, b), minus(d, b))
            sharp = True
        else:
            e, f = minus(b, a), minus(d, c)
            facing = cross(e, f)
            sharp = dot(facing, facing) > _PARALLEL * _PARALLEL * dot(e, e) * dot(f, f)
        facing = unit(facing)
        distance = math.sqrt(dot(apart, apart))
        spare = max(0.0, (distance - NEARLY * pairs.gap[n]) / pairs.moving[n])
        height = dot(apart, facing)
        if pairs.side[n] == 0.0 or not inside or not sharp or distance > 0.5 * pairs.gap[n]:
            pairs.side[n] = 1.0 if height >= 0.0 else -1.0
        side = pairs.side[n]
        if (inside and sharp) or distance < 1e-9:
            normal, distance = (side * facing[0], side * facing[1], side * facing[2]), side * height
        else:
            normal = (apart[0] / distance, apart[1] / distance, apart[2] / distance)
        if pairs.outside[n] >= 0 and abs(distance) <= 0.5 * pairs.gap[n] and _leads_inward(n, pairs, surface, weights, normal):
            normal, distance = (-normal[0], -normal[1], -normal[2]), -distance
        p, q, r, s = four(velocities, nodes)
        closing = dot(combined(weights, p, q, r, s), normal)
        for corner in range(4):
            stand.weights[n, corner] = weights[corner]
        for axis in range(3):
            stand.normal[n, axis] = normal[axis]
        stand.distance[n] = distance
        # One below its gap is solved whatever its own velocities are: those of its neighbours' impulses may be others.
        stand.active[n] = distance < pairs.gap[n] or distance + time_step * closing < NEARLY * pairs.gap[n]
        pairs.due[n] = path if stand.active[n] else path + spare


@parallel_kernel
def _take_stand(count, pairs, path, motion, surface, stand):  # type: ignore[no-untyped-def]
    for chunk in prange(CHUNKS):
        _stand_range(chunk_range(chunk, count), pairs, path, motion, surface, stand)


@kernel
def take_stand(pairs, path, reach, motion, surface, stand):  # type: ignore[no-untyped-def]
    """Stand of the pairs that are due in a step in which no node goes farther than `reach` m, after a `path` m since detection; they are the first of
    `stand.looked`. motion: as of `keep_apart`; surface: of the body. Returns their number."""
    count = 0
    for n in range(len(pairs.due)):
        stand.looked[count] = n
        if pairs.due[n] <= path + reach:
            count += 1
    if count > 0:
        _take_stand(count, pairs, path, motion, surface, stand)
    return count


@kernel
def _push(nodes, weights, impulse, planes, motion):  # type: ignore[no-untyped-def]
    """Impulse on the four nodes of a pair; particles on the body keep what its planes allow."""
    positions, velocities, inverse_masses, time_step = motion
    for corner in range(4):
        node = nodes[corner]
        if inverse_masses[node] == 0.0:
            continue
        v = along(row(velocities, node), impulse, weights[corner] * inverse_masses[node])
        if planes.held[node] > 0:
            v = allowed(planes, node, row(positions, node), v, time_step)
        velocities[node, 0], velocities[node, 1], velocities[node, 2] = v


@inlined_kernel
def give_of(nodes, weights, inverse_masses):  # type: ignore[no-untyped-def]
    """Change of the relative velocity for a unit impulse, 1/kg."""
    give = 0.0
    for corner in range(4):
        give += weights[corner] ** 2 * inverse_masses[nodes[corner]]
    return give


@kernel
def mark(n, pairs, stand):  # type: ignore[no-untyped-def]
    if pairs.impulse[n, 0] > 0.0:
        by = BY_BODY if pairs.outside[n] >= 0 else BY_CLOTH
        for node in row4(pairs.nodes, n):
            stand.pressed[node] = max(stand.pressed[node], by)


@kernel
def mark_pressed(pairs, stand):  # type: ignore[no-untyped-def]
    """Set `stand.pressed` from the impulses of the last step."""
    stand.pressed[:] = 0
    for n in range(len(pairs.impulse)):
        mark(n, pairs, stand)


@kernel
def time_of_contact(kind, nodes, positions, velocities, time_step, kept):  # type: ignore[no-untyped-def]
    """Part of the step (0 to 1) up to which the pair surely stays farther apart than `kept` m; 2 if it does so to the end.

    Advances by no more than the remaining distance allows: no two points of the elements approach faster than the fastest nodes, so nothing is missed. A
    pair that slides along very close may end early, after a fixed number of advances.
    """
    a, b, c, d = four(positions, nodes)
    p, q, r, s = four(velocities, nodes)
    mean = (0.25 * (p[0] + q[0] + r[0] + s[0]), 0.25 * (p[1] + q[1] + r[1] + s[1]), 0.25 * (p[2] + q[2] + r[2] + s[2]))
    p, q, r, s = minus(p, mean), minus(q, mean), minus(r, mean), minus(s, mean)
    pp, qq, rr, ss = math.sqrt(dot(p, p)), math.sqrt(dot(q, q)), math.sqrt(dot(r, r)), math.sqrt(dot(s, s))
    way = time_step * (pp + max(qq, rr, ss) if kind == VERTEX_TRIANGLE else max(pp, qq) + max(rr, ss))
    t = 0.0
    for _ in range(_ADVANCES):
        now = t * time_step
        _, apart, _ = closest_points(kind, along(a, p, now), along(b, q, now), along(c, r, now), along(d, s, now))
        room = math.sqrt(dot(apart, apart)) - kept
        if room <= 0.01 * kept:
            return t
        if room >= (1.0 - t) * way:
            return 2.0
        t += room / way
    return t


@kernel
def _collide(n, pairs, stand, motion):  # type: ignore[no-untyped-def]
    """Part of the step after which pair n would lose most of its distance, 0 where it has none left to lose; 2 if it keeps it."""
    positions, velocities, _, time_step = motion
    distance, nodes = stand.distance[n], row4(pairs.nodes, n)
    if distance < LEAST_ROOM:
        p, q, r, s = four(velocities, nodes)
        if time_step * dot(combined(row4(stand.weights, n), p, q, r, s), row(stand.normal, n)) < -_LOST_THERE * distance:
            return 0.0
    return time_of_contact(pairs.kind[n], nodes, positions, velocities, time_step, KEPT * min(distance, pairs.gap[n]))


@kernel
def _part(n, turn, t, pairs, planes, motion):  # type: ignore[no-untyped-def]
    """Take from pair n the motion in which it would meet at the part t of the step."""
    positions, velocities, inverse_masses, time_step = motion
    nodes, now = row4(pairs.nodes, n), t * time_step
    a, b, c, d = four(positions, nodes)
    p, q, r, s = four(velocities, nodes)
    weights, apart, _ = closest_points(pairs.kind[n], along(a, p, now), along(b, q, now), along(c, r, now), along(d, s, now))
    normal, give = unit(apart), give_of(nodes, weights, inverse_masses)
    if give == 0.0:
        return
    if turn < _GENTLE_ROUNDS:
        size = max(0.0, -dot(combined(weights, p, q, r, s), normal) / give)
        _push(nodes, weights, (size * normal[0], size * normal[1], size * normal[2]), planes, motion)
        return
    mass, sum_ = 0.0, (0.0, 0.0, 0.0)
    still, led = 0, (0.0, 0.0, 0.0)
    for corner in range(4):
        if inverse_masses[nodes[corner]] == 0.0:
            still, led = still + 1, along(led, row(velocities, nodes[corner]), 1.0)
        else:
            mass += 1.0 / inverse_masses[nodes[corner]]
            sum_ = along(sum_, row(velocities, nodes[corner]), 1.0 / inverse_masses[nodes[corner]])
    for corner in range(4):
        if inverse_masses[nodes[corner]] > 0.0:
            for axis in range(3):
                velocities[nodes[corner], axis] = led[axis] / still if still > 0 else sum_[axis] / mass


@long_kernel
def stop_collisions(count, pairs, stand, planes, fastest, motion):  # type: ignore[no-untyped-def]
    """Fail-safe over the first `count` pairs of `stand.looked`: what would lose most of its distance in the step is stopped, in at most 20 rounds.

    fastest: m/s, of all nodes. Returns the part of the step that is safe (1 where all of it is), the pair that limits it, and whether velocities changed.
    """
    time_step = motion[3]
    chosen, many = stand.chosen, 0
    for place in range(count):
        n = stand.looked[place]
        if stand.distance[n] > 0.0 and stand.distance[n] * (1.0 - KEPT) < 2.0 * fastest * time_step:
            chosen[many] = n
            many += 1
    for turn in range(_ROUNDS):
        colliding = 0
        for c in range(many):
            t = _collide(chosen[c], pairs, stand, motion)
            if t <= 1.0:
                colliding += 1
                _part(chosen[c], turn, t, pairs, planes, motion)
        if colliding == 0:
            return 1.0, -1, turn > 0
    part, worst = 1.0, -1
    for c in range(many):
        t = _collide(chosen[c], pairs, stand, motion)
        if t < part:
            part, worst = t, chosen[c]
    return part, worst, True


@entry
@kernel
def fastest_of(velocities):  # type: ignore[no-untyped-def]
    """Largest speed of rows (N,3), m/s; infinite where one is not a number."""
    square = 0.0
    for n in range(len(velocities)):
        one = dot(row(velocities, n), row(velocities, n))
        # A speed that is not a number must not hide behind a comparison that is false.
        square = max(square, one) if one == one else math.inf
    return math.sqrt(square)


@entry
@kernel
def _measure(nodes, kind, positions, distance):  # type: ignore[no-untyped-def]
    for n in range(len(nodes)):
        a, b, c, d = four(positions, row4(nodes, n))
        _, apart, _ = closest_points(kind[n], a, b, c, d)
        distance[n] = math.sqrt(dot(apart, apart))


def distances(nodes: np.ndarray, kind: np.ndarray, positions: np.ndarray) -> np.ndarray:
    """(N,) m of pairs with these nodes (N,4) and kinds (N,)."""
    found = np.empty(len(nodes))
    _measure(nodes, kind, positions, found)
    return found


def room_for(pairs: Pairs, nodes: int) -> Stand:
    """Room for where the pairs of so many nodes stand."""
    count, threads = len(pairs.nodes), get_num_threads()
    looked, chosen, dealt, visited = (np.empty(count, np.int32) for _ in range(4))
    root, size, load, end, stirred = (np.empty(nodes, np.int32) for _ in range(5))
    parts, loads, visits, pressed = np.zeros(threads + 1, np.int32), np.zeros(threads, np.int32), np.ones(count, np.int32), np.zeros(nodes, np.int8)
    return Stand(
        np.empty((count, 4)), np.empty((count, 3)), np.empty(count), np.empty(count, np.bool_), looked, chosen, dealt, parts, loads, root, size, load, end,
        np.empty((count, 16)), np.empty((count, 4), np.int32), np.empty((nodes, 3)), stirred, visited, visits, np.empty(count), pressed,
    )  # fmt: skip


def make_pairs(vertex_triangle: np.ndarray, edge_edge: np.ndarray, gap: np.ndarray, friction: np.ndarray) -> Pairs:
    """Pairs from node rows (N,4) of both kinds. gap, friction: (P,) of the nodes; a pair takes the mean of its two elements' means. All are due,
    and of cloth with cloth."""
    nodes = indices(np.concatenate([vertex_triangle, edge_edge]).reshape(-1, 4))
    kind = np.repeat(indices([VERTEX_TRIANGLE, EDGE_EDGE]), [len(vertex_triangle), len(edge_edge)])
    count = len(nodes)
    first, others = np.where(kind == VERTEX_TRIANGLE, 3 / 6, 1 / 4), np.where(kind == VERTEX_TRIANGLE, 1 / 6, 1 / 4)
    a, b, c, d = nodes.T
    gaps, frictions = (first * values[a] + others * values[b] + others * values[c] + others * values[d] for values in (gap, friction))
    outside = np.full(count, -1, dtype=np.int32)
    return Pairs(nodes, kind, gaps, frictions, np.full(count, 2.0), outside, np.zeros(count), np.zeros(count), np.zeros((count, 4)))


def joined(*parts: Pairs) -> Pairs:
    """All pairs of several lists."""
    return Pairs(*(np.concatenate(columns) for columns in zip(*parts)))


def by_distance(pairs: Pairs, positions: np.ndarray) -> Pairs:
    """The pairs by rising distance beyond their gaps at these positions (P,3) of all nodes, due when the nodes may have gone that far."""
    due = (distances(pairs.nodes, pairs.kind, positions) - NEARLY * pairs.gap) / pairs.moving
    order = np.argsort(due, kind="stable")
    return Pairs(*(column.take(order, axis=0) for column in pairs._replace(due=due)))  # rows of four in a tenth of the time that an index takes


def carry_over(before: Pairs, path_m: float, pairs: Pairs) -> None:
    """Pairs that were there before and stood close, a path of `path_m` after detection, keep their side and impulse. A vertex and a triangle may have the same
    four nodes as two edges, whose side means another thing."""
    known, close = np.flatnonzero((before.impulse[:, 0] > 0.0) | (before.due <= path_m)), int(np.searchsorted(pairs.due, 0.0))
    keys = np.column_stack([np.append(before.kind[known], pairs.kind[:close]), np.concatenate([before.nodes[known], pairs.nodes[:close]])])
    order = np.lexsort(keys.T)  # of two that are alike, the one that was there before comes first
    again = np.flatnonzero((keys[order[1:]] == keys[order[:-1]]).all(axis=1))
    source, now = known[order[again]], order[again + 1] - len(known)
    pairs.side[now], pairs.impulse[now] = before.side[source], before.impulse[source]
