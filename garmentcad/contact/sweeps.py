"""Sweeps of impulses that keep pairs apart, island by island: pairs that hang together by their nodes, and have none in common with others.

A step is a few sweeps of inelastic impulses with Coulomb friction, which begin with those of the last step. Islands know nothing of each other, so threads
share them, and the bits are the same for any number of threads.
"""

from __future__ import annotations

import math

import numpy as np
from numba import prange

from garmentcad.arrays import inlined_kernel, kernel, long_kernel, parallel_kernel
from garmentcad.contact.pairs import combined, four, give_of, mark, row4
from garmentcad.contact.planes import demanded, held
from garmentcad.geometry.closest import along, dot, minus, row

_SWEEPS = 20  # of the impulses, at most
# Change of relative velocity at which the impulses have converged: m/s, far below what the rest test sees, or this share of the fastest speed.
_SETTLED, _SETTLED_SHARE = 1e-8, 1e-5


@inlined_kernel
def _impel(nodes, weights, impulse, inverse_masses, free):  # type: ignore[no-untyped-def]
    """Impulse on the four nodes of a pair, in their velocities free of planes."""
    for corner in range(4):
        node = nodes[corner]
        u = along(row(free, node), impulse, weights[corner] * inverse_masses[node])
        free[node, 0], free[node, 1], free[node, 2] = u


@inlined_kernel
def _settle(node, planes, grip, motion, free):  # type: ignore[no-untyped-def]
    """Velocity of a node after its planes. What they take, with friction, is no impulse of a pair: it comes back when the pair presses less. So it is taken
    anew from the velocity without it, `free`; and where pairs are content, the planes' own response afterwards changes nothing."""
    positions, velocities, inverse_masses, time_step = motion
    u = row(free, node)
    if node < len(planes.held) and planes.held[node] > 0 and inverse_masses[node] > 0.0:
        u, _ = held(node, planes, grip.friction[node], row(positions, node), u, time_step)
    velocities[node, 0], velocities[node, 1], velocities[node, 2] = u


@inlined_kernel
def _copy_rows(nodes, source, target):  # type: ignore[no-untyped-def]
    for node in nodes:
        target[node, 0], target[node, 1], target[node, 2] = source[node, 0], source[node, 1], source[node, 2]


@kernel
def _root(root, node):  # type: ignore[no-untyped-def]
    """The node that stands for all that hang together with `node`."""
    while root[node] != node:
        root[node] = root[root[node]]
        node = root[node]
    return node


@kernel
def deal_islands(many, pairs, stand):  # type: ignore[no-untyped-def]
    """Put the first `many` of `stand.chosen` in the order of their islands, pairs that hang together by their nodes, and deal these out to the threads, by the
    visits that they took last: thread k has chosen[parts[k] : parts[k + 1]], and an island ends before place `end` of the root of its nodes. Pairs of an
    island stay in their order."""
    chosen, dealt, root, size, load, end = stand.chosen, stand.dealt, stand.root, stand.size, stand.load, stand.end
    parts, loads = stand.parts, stand.loads
    threads = len(parts) - 1
    for c in range(many):
        for node in row4(pairs.nodes, chosen[c]):
            root[node], size[node], load[node], end[node] = node, 0, 0, -1
    for c in range(many):
        nodes = row4(pairs.nodes, chosen[c])
        together = _root(root, nodes[0])
        for corner in range(1, 4):
            root[_root(root, nodes[corner])] = together
    total = 0
    for c in range(many):
        node, dealt[c] = _root(root, pairs.nodes[chosen[c], 0]), chosen[c]
        size[node] += 1
        load[node] += stand.visits[chosen[c]]
        total += stand.visits[chosen[c]]
    # The large ones first, or the last one makes its part the largest by far. `end` is the part of an island until all are dealt out.
    parts[:], loads[:] = 0, 0
    for share in (4, 16, total):
        for c in range(many):
            node = _root(root, pairs.nodes[chosen[c], 0])
            if end[node] < 0 and load[node] * share >= total:
                end[node] = 0
                for k in range(1, threads):
                    if loads[k] < loads[end[node]]:
                        end[node] = k
                loads[end[node]] += load[node]
                parts[end[node] + 1] += size[node]
    for k in range(threads):
        parts[k + 1] += parts[k]
    for c in range(many):
        node = _root(root, pairs.nodes[dealt[c], 0])
        if size[node] > 0:
            k = end[node]
            end[node], parts[k], size[node] = parts[k], parts[k] + size[node], 0
        chosen[end[node]] = dealt[c]
        end[node] += 1
    for k in range(threads, 0, -1):
        parts[k] = parts[k - 1]
    parts[0] = 0


@kernel
def _write_contacts(span, pairs, stand, motion):  # type: ignore[no-untyped-def]
    """Into `stand.contacts` and `stand.corners` all that the sweeps need of the pairs chosen[span[0] : span[1]]: side by side, because their places among all
    pairs lie far apart, and their visits are many. Impulses are those of the last step, without what is no longer sliding."""
    for c in range(span[0], span[1]):
        n, contact = stand.chosen[c], stand.contacts[c]
        nodes, weights, normal, before = row4(pairs.nodes, n), row4(stand.weights, n), row(stand.normal, n), row4(pairs.impulse, n)
        for corner in range(4):
            stand.corners[c, corner], contact[corner] = nodes[corner], weights[corner]
        slide = (before[1], before[2], before[3])
        slide = along(slide, normal, -dot(slide, normal))
        for axis in range(3):
            contact[4 + axis], contact[11 + axis] = normal[axis], slide[axis]
        contact[7] = demanded(stand.distance[n] - pairs.gap[n], motion[3])
        contact[8], contact[9], contact[10], contact[15] = give_of(nodes, weights, motion[2]), pairs.friction[n], before[0], 1.0


@long_kernel
def sweep(span, stand, planes, grip, settled, motion):  # type: ignore[no-untyped-def]
    """Sweeps over the contacts span[0] to span[1] - 1, none of whose nodes belongs to another; settled: change of relative velocity, m/s, at which they have
    converged. Impulses, friction's work on the nodes [J] and the number of visits go into columns 10 to 15 of `stand.contacts`."""
    _, velocities, inverse_masses, _ = motion
    contacts, corners, free, stirred, visited = stand.contacts, stand.corners, stand.free, stand.stirred, stand.visited
    for c in range(span[0], span[1]):
        nodes = row4(corners, c)
        _copy_rows(nodes, velocities, free)
        for node in nodes:
            stirred[node] = -1
    for c in range(span[0], span[1]):
        slide = (contacts[c, 11], contacts[c, 12], contacts[c, 13])
        start = along(slide, (contacts[c, 4], contacts[c, 5], contacts[c, 6]), contacts[c, 10])
        _impel(row4(corners, c), row4(contacts, c), start, inverse_masses, free)
        visited[c] = 0
    for c in range(span[0], span[1]):
        for node in row4(corners, c):
            if stirred[node] < 0:
                stirred[node] = 0
                _settle(node, planes, grip, motion, free)
    # A pair is content until a node of it is stirred: most are after the first visits, a few that hang together go on.
    visit = 0
    for _ in range(_SWEEPS):
        before_sweep = visit
        for c in range(span[0], span[1]):
            nodes = row4(corners, c)
            if max(stirred[nodes[0]], stirred[nodes[1]], stirred[nodes[2]], stirred[nodes[3]]) < visited[c]:
                continue
            visit += 1
            visited[c] = visit
            contacts[c, 15] += 1.0
            weights, normal, give = row4(contacts, c), (contacts[c, 4], contacts[c, 5], contacts[c, 6]), contacts[c, 8]
            p, q, r, s = four(velocities, nodes)
            speed = combined(weights, p, q, r, s)
            before = contacts[c, 10]
            contacts[c, 10] = max(0.0, before + (contacts[c, 7] - dot(speed, normal)) / give)
            step = contacts[c, 10] - before
            # Friction: the impulse that would stop the sliding, cut to the cone of the normal impulse so far.
            slide = along(speed, normal, -dot(speed, normal))
            grasp = (contacts[c, 11], contacts[c, 12], contacts[c, 13])
            goal = minus(grasp, (slide[0] / give, slide[1] / give, slide[2] / give))
            size, limit = math.sqrt(dot(goal, goal)), contacts[c, 9] * contacts[c, 10]
            if size > limit:
                goal = (goal[0] * limit / size, goal[1] * limit / size, goal[2] * limit / size)
            change = minus(goal, grasp)
            contacts[c, 11], contacts[c, 12], contacts[c, 13] = goal
            change = along(change, normal, step)
            if dot(change, change) > 0.0:
                _impel(nodes, weights, change, inverse_masses, free)
                for node in nodes:
                    _settle(node, planes, grip, motion, free)
                if math.sqrt(dot(change, change)) * give >= settled:
                    for node in nodes:
                        stirred[node] = visit
        if visit == before_sweep:
            break
    for c in range(span[0], span[1]):
        p, q, r, s = four(velocities, row4(corners, c))
        contacts[c, 14] = dot((contacts[c, 11], contacts[c, 12], contacts[c, 13]), combined(row4(contacts, c), p, q, r, s))
    # The planes' own response follows, with their friction: it needs the velocities with which particles press on the body.
    for c in range(span[0], span[1]):
        _copy_rows(row4(corners, c), free, velocities)


@long_kernel
def _sweep_islands(k, pairs, stand, planes, grip, settled, motion):  # type: ignore[no-untyped-def]
    """The islands of thread k, one after the other: what one of them needs stays near."""
    begin = stand.parts[k]
    while begin < stand.parts[k + 1]:
        span = begin, stand.end[_root(stand.root, pairs.nodes[stand.chosen[begin], 0])]
        _write_contacts(span, pairs, stand, motion)
        sweep(span, stand, planes, grip, settled, motion)
        for c in range(span[0], span[1]):
            n = stand.chosen[c]
            pairs.impulse[n, 0], pairs.impulse[n, 1] = stand.contacts[c, 10], stand.contacts[c, 11]
            pairs.impulse[n, 2], pairs.impulse[n, 3] = stand.contacts[c, 12], stand.contacts[c, 13]
            stand.work[n], stand.visits[n] = stand.contacts[c, 14], np.int32(stand.contacts[c, 15])
            mark(n, pairs, stand)
        begin = span[1]


@parallel_kernel
def _sweep_all(pairs, stand, planes, grip, settled, motion):  # type: ignore[no-untyped-def]
    for k in prange(len(stand.parts) - 1):
        _sweep_islands(np.int64(k), pairs, stand, planes, grip, settled, motion)


@long_kernel
def keep_apart(count, pairs, stand, planes, grip, fastest, motion):  # type: ignore[no-untyped-def]
    """Correct velocities in place so that the first `count` pairs of `stand.looked` keep their gaps over the step, or come back to them gently: sweeps of
    inelastic impulses with Coulomb friction over the active ones, in their order, island by island.

    fastest: m/s, of all nodes; motion: positions, velocities (N,3), inverse masses (N,) of particles and body vertices, time step. Returns the work of
    friction on the nodes, J, negative.
    """
    chosen, many = stand.chosen, 0
    stand.pressed[:] = 0
    for place in range(count):
        n = stand.looked[place]
        stand.work[n] = 0.0
        if stand.active[n] and give_of(row4(pairs.nodes, n), row4(stand.weights, n), motion[2]) > 0.0:
            chosen[many] = n
            many += 1
        else:
            pairs.impulse[n, 0] = pairs.impulse[n, 1] = pairs.impulse[n, 2] = pairs.impulse[n, 3] = 0.0
    if many == 0:
        return 0.0
    deal_islands(many, pairs, stand)
    settled = max(_SETTLED, _SETTLED_SHARE * fastest)
    _sweep_all(pairs, stand, planes, grip, settled, motion)
    work = 0.0
    for place in range(count):
        work += stand.work[stand.looked[place]]
    return work
