"""Pairs that must keep their distance, vertex against triangle or edge against edge: where they stand, impulses, and the test that nothing passed.

A pair names four nodes. VT: vertex, then the triangle's corners; EE: the two ends of one edge, then of the other. Weights w (their sum is 0) give
the vector between the closest points, sum w x, and the relative velocity there, sum w v; an impulse J along it changes v_i by J w_i / m_i.

The side on which a pair stands is remembered while it is closer than half its gap, so that a pair that came through is pushed back the way it came.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import prange

from garmentcad.arrays import CHUNKS, chunk_range, indices, kernel, parallel_kernel
from garmentcad.cloth.state import State
from garmentcad.geometry.closest import FACE, along, cross, distance_between, dot, minus, point_triangle, row, segment_segment, unit

VERTEX_TRIANGLE, EDGE_EDGE = 0, 1
PUSH_SPEED = 0.25  # m/s, fastest separation of a pair that stands below its gap
PUSH_TIME = 5e-3  # s, time constant of that separation
# m: this close to its gap a pair is closed. Without it what rests on something may still approach by the room that is left, a fraction of a micrometre
# in a step of some 10 us, which looks like several g.
CLOSED = 2e-6
_SWEEPS = 20  # of the impulses, at most
_ROUNDS = 20  # of the fail-safe, at most
_GENTLE_ROUNDS = 12  # of them with impulses along the normal; then colliding nodes move as one
_ADVANCES = 64  # of the continuous test, at most
_KEPT = 0.2  # share of its distance that a pair keeps within a step, whatever happens
_PARALLEL = 0.05  # sine below which the common normal of two edges says nothing
_SETTLED = 1e-9  # m/s, change of relative velocity at which the impulses have converged


class Pairs(NamedTuple):
    """The candidates of one detection."""

    nodes: np.ndarray  # (N,4) int32
    kind: np.ndarray  # (N,) int32 VERTEX_TRIANGLE or EDGE_EDGE
    gap: np.ndarray  # (N,) m
    friction: np.ndarray  # (N,)
    side: np.ndarray  # (N,) +1 or -1, 0 while unknown; changes as the pair moves
    distance: np.ndarray  # (N,) m at detection
    home: np.ndarray  # (P,3) m, positions of all nodes at detection


class Stand(NamedTuple):
    """Where the pairs stand at the beginning of a step."""

    weights: np.ndarray  # (N,4)
    normal: np.ndarray  # (N,3) from the second element to the first
    distance: np.ndarray  # (N,) m along the normal; negative for a pair that came through; a lower bound for a pair that is too far to matter
    active: np.ndarray  # (N,) bool, may come below its gap in the step


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


@kernel
def longest(vectors):  # type: ignore[no-untyped-def]
    """Length of the longest row of (N,3)."""
    square = 0.0
    for n in range(len(vectors)):
        square = max(square, dot(row(vectors, n), row(vectors, n)))
    return math.sqrt(square)


@kernel
def farthest(positions, home):  # type: ignore[no-untyped-def]
    """The longest way from `home` to `positions`, both (N,3), m."""
    way = 0.0
    for n in range(len(positions)):
        way = max(way, distance_between(positions, home, n))
    return way


@kernel
def _row4(array, index):  # type: ignore[no-untyped-def]
    """Row `index` of an (N,4) array as a tuple."""
    return array[index, 0], array[index, 1], array[index, 2], array[index, 3]


@kernel
def _four(points, nodes):  # type: ignore[no-untyped-def]
    return row(points, nodes[0]), row(points, nodes[1]), row(points, nodes[2]), row(points, nodes[3])


@kernel
def _strayed(nodes, first, last, positions, home):  # type: ignore[no-untyped-def]
    way = 0.0
    for corner in range(first, last):
        way = max(way, distance_between(positions, home, nodes[corner]))
    return way


@kernel
def _stand_range(span, pairs, positions, velocities, reserves, time_step, stand):  # type: ignore[no-untyped-def]
    reserve, farthest_way = reserves
    for n in range(span[0], span[1]):
        # Most pairs are ruled out by the longest way of any node, without a look at their own.
        bound = pairs.distance[n] - 2.0 * farthest_way
        if bound - reserve > 1.1 * pairs.gap[n]:
            stand.distance[n], stand.active[n] = bound, False
            continue
        kind, nodes = pairs.kind[n], _row4(pairs.nodes, n)
        split = 1 if kind == VERTEX_TRIANGLE else 2
        bound = pairs.distance[n] - _strayed(nodes, 0, split, positions, pairs.home) - _strayed(nodes, split, 4, positions, pairs.home)
        if bound - reserve > 1.1 * pairs.gap[n]:
            stand.distance[n], stand.active[n] = bound, False
            continue
        a, b, c, d = _four(positions, nodes)
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
        height = dot(apart, facing)
        if pairs.side[n] == 0.0 or not inside or not sharp or distance > 0.5 * pairs.gap[n]:
            pairs.side[n] = 1.0 if height >= 0.0 else -1.0
        side = pairs.side[n]
        if (inside and sharp) or distance < 1e-9:
            normal, distance = (side * facing[0], side * facing[1], side * facing[2]), side * height
        else:
            normal = (apart[0] / distance, apart[1] / distance, apart[2] / distance)
        p, q, r, s = _four(velocities, nodes)
        closing = dot(combined(weights, p, q, r, s), normal)
        for corner in range(4):
            stand.weights[n, corner] = weights[corner]
        for axis in range(3):
            stand.normal[n, axis] = normal[axis]
        stand.distance[n] = distance
        # A little earlier than at the gap: the impulses of a neighbour may bring it closer than its own velocity does.
        stand.active[n] = distance + time_step * closing < 1.1 * pairs.gap[n]


@parallel_kernel
def _take_stand(pairs, positions, velocities, reserves, time_step, stand):  # type: ignore[no-untyped-def]
    """Stand of all pairs. reserves: the most that two points approach each other in the step, and the longest way since detection, m."""
    for chunk in prange(CHUNKS):
        _stand_range(chunk_range(chunk, len(pairs.nodes)), pairs, positions, velocities, reserves, time_step, stand)


@kernel
def _push(velocities, inverse_masses, nodes, weights, impulse):  # type: ignore[no-untyped-def]
    for corner in range(4):
        share = weights[corner] * inverse_masses[nodes[corner]]
        for axis in range(3):
            velocities[nodes[corner], axis] += share * impulse[axis]


@kernel
def _solve(pairs, stand, chosen, inverse_masses, time_step, impulses, velocities):  # type: ignore[no-untyped-def]
    """Sweeps of inelastic impulses with Coulomb friction over the `chosen` pairs, in their order; impulses (C,4): along the normal, and friction.

    Returns the work of friction on the nodes, J.
    """
    for _ in range(_SWEEPS):
        largest = 0.0
        for c in range(len(chosen)):
            n = chosen[c]
            nodes, weights = _row4(pairs.nodes, n), _row4(stand.weights, n)
            normal = row(stand.normal, n)
            give = 0.0
            for corner in range(4):
                give += weights[corner] ** 2 * inverse_masses[nodes[corner]]
            if give == 0.0:
                continue
            p, q, r, s = _four(velocities, nodes)
            speed = combined(weights, p, q, r, s)
            room = stand.distance[n] - pairs.gap[n]
            wanted = min(0.0, CLOSED - room) / time_step if room > 0.0 else min(PUSH_SPEED, -room / max(PUSH_TIME, time_step))
            before = impulses[c, 0]
            impulses[c, 0] = max(0.0, before + (wanted - dot(speed, normal)) / give)
            step = impulses[c, 0] - before
            _push(velocities, inverse_masses, nodes, weights, (step * normal[0], step * normal[1], step * normal[2]))
            largest = max(largest, abs(step) * give)
            # Friction: the impulse that would stop the sliding, cut to the cone of the normal impulse so far.
            slide = along(speed, normal, -dot(speed, normal))
            held = (impulses[c, 1], impulses[c, 2], impulses[c, 3])
            goal = minus(held, (slide[0] / give, slide[1] / give, slide[2] / give))
            size, limit = math.sqrt(dot(goal, goal)), pairs.friction[n] * impulses[c, 0]
            if size > limit:
                goal = (goal[0] * limit / size, goal[1] * limit / size, goal[2] * limit / size)
            change = minus(goal, held)
            impulses[c, 1], impulses[c, 2], impulses[c, 3] = goal
            _push(velocities, inverse_masses, nodes, weights, change)
            largest = max(largest, math.sqrt(dot(change, change)) * give)
        if largest < _SETTLED:
            break
    work = 0.0
    for c in range(len(chosen)):
        p, q, r, s = _four(velocities, _row4(pairs.nodes, chosen[c]))
        work += dot((impulses[c, 1], impulses[c, 2], impulses[c, 3]), combined(_row4(stand.weights, chosen[c]), p, q, r, s))
    return work


@kernel
def time_of_contact(kind, nodes, positions, velocities, time_step, kept):  # type: ignore[no-untyped-def]
    """Part of the step (0 to 1) up to which the pair surely stays farther apart than `kept` m; 2 if it does so to the end.

    Advances by no more than the remaining distance allows: no two points of the elements approach faster than the fastest nodes, so nothing is missed. A
    pair that slides along very close may end early, after a fixed number of advances.
    """
    a, b, c, d = _four(positions, nodes)
    p, q, r, s = _four(velocities, nodes)
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
def _stop(pairs, stand, near, inverse_masses, positions, time_step, velocities):  # type: ignore[no-untyped-def]
    """Fail-safe over the pairs `near`: what would lose most of its distance in the step is stopped. Returns how many still would after all rounds."""
    colliding = 0
    for turn in range(_ROUNDS + 1):
        colliding = 0
        for n in near:
            if stand.distance[n] <= 0.0:
                continue
            nodes, kind = _row4(pairs.nodes, n), pairs.kind[n]
            t = time_of_contact(kind, nodes, positions, velocities, time_step, _KEPT * min(stand.distance[n], pairs.gap[n]))
            if t > 1.0:
                continue
            colliding += 1
            if turn == _ROUNDS:
                continue
            a, b, c, d = _four(positions, nodes)
            p, q, r, s = _four(velocities, nodes)
            now = t * time_step
            weights, apart, _ = closest_points(kind, along(a, p, now), along(b, q, now), along(c, r, now), along(d, s, now))
            normal = unit(apart)
            give = 0.0
            for corner in range(4):
                give += weights[corner] ** 2 * inverse_masses[nodes[corner]]
            closing = dot(combined(weights, p, q, r, s), normal)
            if give == 0.0:
                continue
            if turn < _GENTLE_ROUNDS:
                size = max(0.0, -closing / give)
                _push(velocities, inverse_masses, nodes, weights, (size * normal[0], size * normal[1], size * normal[2]))
                continue
            mass, motion = 0.0, (0.0, 0.0, 0.0)
            held = False
            for corner in range(4):
                if inverse_masses[nodes[corner]] == 0.0:
                    held = True
                else:
                    mass += 1.0 / inverse_masses[nodes[corner]]
                    motion = along(motion, row(velocities, nodes[corner]), 1.0 / inverse_masses[nodes[corner]])
            for corner in range(4):
                if inverse_masses[nodes[corner]] > 0.0:
                    for axis in range(3):
                        velocities[nodes[corner], axis] = 0.0 if held else motion[axis] / mass
        if colliding == 0:
            break
    return colliding


@kernel
def _measure(nodes, kind, positions, distance):  # type: ignore[no-untyped-def]
    for n in range(len(nodes)):
        a, b, c, d = _four(positions, _row4(nodes, n))
        _, apart, _ = closest_points(kind[n], a, b, c, d)
        distance[n] = math.sqrt(dot(apart, apart))


def room_for(pairs: Pairs, stand: Stand | None) -> Stand:
    """Room for where the pairs stand: the given one if it is large enough."""
    count = len(pairs.nodes)
    if stand is not None and len(stand.distance) >= count:
        return stand
    return Stand(np.empty((count, 4)), np.empty((count, 3)), np.empty(count), np.empty(count, dtype=np.bool_))


def keep_apart(
    pairs: Pairs, stand: Stand, positions: np.ndarray, velocities: np.ndarray, inverse_masses: np.ndarray, time_step: float
) -> tuple[float, int]:
    """Correct velocities (P,3) in place so that the pairs keep their gaps over the step, or come back to them gently.

    stand: room, see `room_for`. Returns the work of friction (J, negative) and the number of pairs that the fail-safe could not stop.
    """
    count = len(pairs.nodes)
    if count == 0:
        return 0.0, 0
    reserves = (2.0 * longest(velocities) * time_step, farthest(positions, pairs.home))
    _take_stand(pairs, positions, velocities, reserves, time_step, stand)
    chosen = np.flatnonzero(stand.active[:count])
    work = _solve(pairs, stand, chosen, inverse_masses, time_step, np.zeros((len(chosen), 4)), velocities) if len(chosen) else 0.0
    near = np.flatnonzero(stand.distance[:count] * (1.0 - _KEPT) < 2.0 * longest(velocities) * time_step)
    return work, _stop(pairs, stand, near, inverse_masses, positions, time_step, velocities) if len(near) else 0


def candidates(vertex_triangle: np.ndarray, edge_edge: np.ndarray, positions: np.ndarray, gap: np.ndarray, friction: np.ndarray) -> Pairs:
    """Pairs from node rows (N,4) of both kinds, at their positions (P,3) of detection. gap, friction: (P,) of the nodes; a pair takes the mean of its two
    elements' means. The side is the one where the pair first stands."""
    nodes = indices(np.concatenate([vertex_triangle, edge_edge]).reshape(-1, 4))
    kind = np.repeat(indices([VERTEX_TRIANGLE, EDGE_EDGE]), [len(vertex_triangle), len(edge_edge)])
    share = np.where(kind[:, None] == VERTEX_TRIANGLE, [3 / 6, 1 / 6, 1 / 6, 1 / 6], 1 / 4)
    distance = np.empty(len(nodes))
    _measure(nodes, kind, positions, distance)
    return Pairs(nodes, kind, (share * gap[nodes]).sum(axis=1), (share * friction[nodes]).sum(axis=1), np.zeros(len(nodes)), distance, positions.copy())


def store_pairs(state: State, name: str, pairs: Pairs, margin: float) -> None:
    """Put the pairs of the contact `name` into the state, with the margin (m) that they cover. Pairs that were there before and stand close keep their side."""
    if f"{name}_pair_nodes" in state.contact:
        before = load_pairs(state, name)
        close = np.flatnonzero(pairs.distance < 0.5 * pairs.gap)
        if len(close):
            sides = dict(zip(map(tuple, before.nodes.tolist()), before.side.tolist()))
            pairs.side[close] = [sides.get(tuple(nodes), 0.0) for nodes in pairs.nodes[close].tolist()]
    for key, array in pairs._asdict().items():
        state.contact[f"{name}_pair_{key}"] = array
    state.contact[f"{name}_pair_margin"] = np.array([margin])


def load_pairs(state: State, name: str) -> Pairs:
    """The pairs of the contact `name` in the state; the arrays are the state's own."""
    return Pairs(*(state.contact[f"{name}_pair_{key}"] for key in Pairs._fields))
