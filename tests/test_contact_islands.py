"""Pairs that hang together are swept together: islands as scipy finds them, and the same bits whatever the number of threads among which they are dealt."""

from __future__ import annotations

import itertools
from copy import deepcopy

import numpy as np
from loose_sheet import Sheet, fabric
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from garmentcad.arrays import indices
from garmentcad.cloth.state import State
from garmentcad.contact.contact import Contact
from garmentcad.contact.pairs import Pairs, Stand, fastest_of, make_pairs, room_for, take_stand
from garmentcad.contact.sweeps import deal_islands, keep_apart

DT = 1.5e-4
NODES, MANY, THREADS = 1000, 60, 3


def stand_of(pairs: Pairs, nodes: int, threads: int) -> Stand:
    return room_for(pairs, nodes)._replace(parts=np.zeros(threads + 1, np.int32), loads=np.zeros(threads, np.int32))


def test_islands_are_those_of_scipy_in_their_order_and_none_is_dealt_to_two_threads() -> None:
    rng = np.random.default_rng(7)
    nodes = indices([rng.choice(NODES, 4, replace=False) for _ in range(2 * MANY)])
    pairs = make_pairs(nodes, nodes[:0], np.full(NODES, 1e-3), np.zeros(NODES))
    stand = stand_of(pairs, NODES, THREADS)
    chosen = np.sort(rng.choice(2 * MANY, MANY, replace=False))
    stand.chosen[:MANY] = chosen
    stand.visits[:] = rng.integers(1, 10, 2 * MANY)
    deal_islands(MANY, pairs, stand)
    dealt, parts = stand.chosen[:MANY].copy(), stand.parts
    assert sorted(dealt) == list(chosen)
    assert parts[0] == 0
    assert parts[-1] == MANY
    links = coo_array((np.ones(4 * MANY), (np.repeat(np.arange(MANY), 4), MANY + nodes[chosen].ravel())), shape=(MANY + NODES,) * 2)
    label = dict(zip(chosen.tolist(), connected_components(links, directed=False)[1][:MANY].tolist()))
    islands = [label[n] for n in dealt.tolist()]
    begins = [c for c in range(MANY) if c == 0 or islands[c] != islands[c - 1]]
    assert 10 < len(begins) == len(set(islands))  # each in one piece
    assert set(parts[:-1].tolist()) <= {*begins, MANY}
    ends = {int(stand.end[stand.root[nodes[n, 0]]]) for n in dealt.tolist()}
    assert ends == {*begins[1:], MANY}
    for begin, end in zip(begins, [*begins[1:], MANY]):
        assert list(dealt[begin:end]) == sorted(dealt[begin:end])
    # By visits no part has more than its share and the largest island.
    visits = np.array([stand.visits[dealt[a:b]].sum() for a, b in itertools.pairwise(parts)])
    largest = max(stand.visits[dealt[a:b]].sum() for a, b in zip(begins, [*begins[1:], MANY]))
    assert visits.max() <= visits.mean() + largest


def test_the_sweeps_give_the_same_bits_whatever_the_number_of_threads() -> None:
    """Three sheets that fall on fixed ones and slide; each two stand apart from the others."""
    sheet = Sheet(6, panels=6)
    panel = sheet.cloth.vertex_panel
    corner = np.array([sheet.positions[panel == k].min(axis=0) for k in range(6)])
    upper = panel % 2 == 1
    places = sheet.positions - corner[panel] + np.column_stack([0.2 * (panel // 2), 0.95e-3 * upper, 0.003 * upper])
    contact = Contact(sheet.cloth, fabric(), inverse_masses=upper / sheet.cloth.masses)
    moving = np.random.default_rng(3).normal([0.1, -0.3, 0.0], 0.05, places.shape) * upper[:, None]
    state = sheet.state(places, moving)
    contact.start(state)
    found = [swept(contact, deepcopy(state), threads) for threads in (1, 2, 5)]
    _, _, _, pressed, parts = found[1]
    assert parts[0] < parts[1] < parts[2]  # both threads had something to do
    assert np.count_nonzero(pressed) > 150
    for velocities, impulse, work, held, _ in found[1:]:
        assert np.array_equal(velocities, found[0][0])
        assert np.array_equal(impulse, found[0][1])
        assert work == found[0][2] < 0.0
        assert np.array_equal(held, pressed)


def swept(contact: Contact, state: State, threads: int) -> tuple[np.ndarray, np.ndarray, float, np.ndarray, np.ndarray]:
    """Velocities, impulses, work, what was pressed and the parts after the sweeps of one step."""
    contact.load(state)
    surface, _, _, grip, planes, pairs, _, _, _, path = contact.arguments(state)
    stand = stand_of(pairs, contact.nodes, threads)
    motion, fastest = (contact.positions, contact.velocities, contact.inverse_masses, DT), fastest_of(contact.velocities)
    count = take_stand(pairs, path[0], 4.0 * fastest * DT, motion, surface, stand)
    work = keep_apart(count, pairs, stand, planes, grip, fastest, motion)
    return contact.velocities.copy(), pairs.impulse.copy(), work, stand.pressed.copy(), stand.parts.copy()
