"""Cloth on itself, judged by ipctk; continuous tests without false negatives; the same bits on any number of threads."""

from __future__ import annotations

from copy import deepcopy
from dataclasses import replace

import numpy as np
import pytest
from command import printed_on_threads
from loose_sheet import Sheet, correct, crosses, fabric, reserve
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import dijkstra

from garmentcad.arrays import indices
from garmentcad.cloth.state import State
from garmentcad.contact.contact import Contact, load_pairs
from garmentcad.contact.pairs import EDGE_EDGE, VERTEX_TRIANGLE, Pairs, carry_over, distances, make_pairs, time_of_contact
from garmentcad.contact.planes import CLOSED
from tools.contact_queries import SHAPES, missed, queries

DT = 1.5e-4
GAP = 1e-3


def folded(sheet: Sheet, radius: float = 0.004) -> np.ndarray:
    """The sheet folded over a line that is not along the lattice, the upper half above the lower one and falling."""
    turn = np.radians(17)
    along = sheet.positions @ [np.cos(turn), 0, np.sin(turn)]
    across = sheet.positions @ [-np.sin(turn), 0, np.cos(turn)]
    arc = np.clip(along, 0, np.pi * radius)
    x = np.where(along < 0, along, radius * np.sin(arc / radius))
    x = np.where(along > np.pi * radius, np.pi * radius - along, x)
    y = radius * (1 - np.cos(arc / radius))
    return np.stack([x, y, across], axis=1)


def fold_and_fall(steps: int) -> tuple[Sheet, Contact, list]:
    sheet = Sheet(14)
    contact = Contact(sheet.cloth, fabric())
    state = sheet.state(folded(sheet))
    held = state.positions[:, 1] < 1e-9  # the lower half lies on a table
    contact.inverse_masses[held] = 0.0
    contact.start(state)
    states = []
    for step in range(steps):
        sheet.pull(state, DT)
        state.velocities[held] = 0.0
        assert correct(state, DT, contact) == 1.0
        state.positions += DT * state.velocities
        if step % 100 == 99:
            states.append(deepcopy(state))
    return sheet, contact, states


def test_folded_sheet_falls_on_itself() -> None:
    sheet, contact, states = fold_and_fall(800)
    triangles = sheet.cloth.particle_triangles
    upper = folded(sheet)[:, 1] > 0.0079
    for state in states:
        assert not crosses(state.positions, triangles)
    heights = states[-1].positions[upper, 1]
    last = deepcopy(states[-1])
    contact.start(last)
    pairs = load_pairs(last)
    distance = distances(pairs.nodes, pairs.kind, last.positions)
    assert (distance < 1.02 * pairs.gap).sum() > 50
    assert distance.min() > 0.95 * GAP
    assert np.median(heights) < 2.5 * GAP  # it did come down, and lies on the gap
    assert states[-1].work_j["friction"] <= 0.0


def test_a_copied_state_goes_on_with_the_same_bits() -> None:
    sheet, contact, states = fold_and_fall(200)
    other = Contact(sheet.cloth, fabric(), inverse_masses=contact.inverse_masses)
    one, two = states[0], deepcopy(states[0])
    for _ in range(100):
        for state, judge in ((one, contact), (two, other)):
            sheet.pull(state, DT)
            state.velocities[contact.inverse_masses == 0.0] = 0.0
            correct(state, DT, judge)
            state.positions += DT * state.velocities
    assert one.sha256() == two.sha256() == states[1].sha256()


def test_detection_by_travel_finds_the_pairs_of_detection_at_every_step() -> None:
    """At every step the pairs that may touch in it are the same, whether candidates are looked for now or were by the clock; few steps look."""
    sheet, contact, states = fold_and_fall(300)
    state, fresh = states[-1], Contact(sheet.cloth, fabric(), inverse_masses=contact.inverse_masses)
    looks, active = 0, 0

    def close(of: State) -> set[tuple[int, ...]]:
        pairs = load_pairs(of)
        return {tuple(nodes) for nodes in pairs.nodes[distances(pairs.nodes, pairs.kind, of.positions) < pairs.gap + 2 * reserve(state, DT)].tolist()}

    for _ in range(150):
        sheet.pull(state, DT)
        state.velocities[contact.inverse_masses == 0.0] = 0.0
        looks += contact.detect(state, reserve(state, DT))
        always = deepcopy(state)
        always.contact.clear()
        fresh.start(always)
        assert close(state) == close(always)
        active += len(close(always))
        contact.respond(state, DT)
        state.positions += DT * state.velocities
    assert active > 1000
    assert looks < 50


@pytest.mark.parametrize("speed", [0.5, 3.0, 12.0])
def test_sheets_thrown_at_each_other_never_pass(speed: float) -> None:
    """Up to 4 gaps of way in one step; momentum stays."""
    sheet = Sheet(6, panels=2)
    half = 49
    positions = np.tile(sheet.positions[:half], (2, 1))
    turn = np.radians(23)
    positions[half:] = positions[half:] @ np.array([[np.cos(turn), 0, np.sin(turn)], [0, 1, 0], [-np.sin(turn), 0, np.cos(turn)]]) + [0.004, 0.0061, 0.003]
    velocities = np.zeros_like(positions)
    velocities[half:] = [0.2 * speed, -speed, 0.1 * speed]
    contact = Contact(sheet.cloth, fabric())
    state = sheet.state(positions, velocities)
    contact.start(state)
    momentum = sheet.cloth.masses @ state.velocities
    dt = GAP / 3
    for _ in range(40):
        assert correct(state, dt, contact) == 1.0
        state.positions += dt * state.velocities
        assert not crosses(state.positions, sheet.cloth.particle_triangles)
    np.testing.assert_allclose(sheet.cloth.masses @ state.velocities, momentum, atol=1e-12 + 1e-10 * np.abs(momentum).max())


@pytest.mark.parametrize("seed", range(6))
def test_fail_safe_stops_what_impulses_miss(seed: int) -> None:
    """Every particle flies its own way, several gaps in one step: normals of the start say little about the step."""
    rng = np.random.default_rng(seed)
    sheet = Sheet(6, panels=2)
    positions = np.concatenate([sheet.positions[:49], sheet.at(0.003, 0.003, 0.002)[:49]]) + rng.normal(0, 3e-4, (98, 3))
    contact = Contact(sheet.cloth, fabric())
    state = sheet.state(positions, rng.normal(0, 6.0, (98, 3)))
    contact.start(state)
    momentum = sheet.cloth.masses @ state.velocities
    dt = GAP / 3
    assert crosses(positions + dt * state.velocities, sheet.cloth.particle_triangles)
    correct(state, dt, contact)
    assert not crosses(positions + dt * state.velocities, sheet.cloth.particle_triangles)
    np.testing.assert_allclose(sheet.cloth.masses @ state.velocities, momentum, atol=1e-10 * np.abs(sheet.cloth.masses).sum() * 6)


@pytest.mark.parametrize("seed", [15, 98, 114])
def test_what_held_particles_throw_passes_nothing(seed: int) -> None:
    """Impulses near held particles throw free ones at ten times any speed before, toward a third sheet that nobody looked at."""
    rng = np.random.default_rng(seed)
    sheet = Sheet(6, panels=3)
    layers = [sheet.at(*middle)[:49] for middle in ((0.0, 0.0, 0.0), (0.003, 0.0011, 0.002), (-0.002, 0.0131, 0.001))]
    positions = np.concatenate(layers) + rng.normal(0, 2e-4, (147, 3))
    velocities = rng.normal(0, 3.0, (147, 3)) * np.repeat([1.0, 1.0, 0.1], 49)[:, None]
    contact = Contact(sheet.cloth, fabric(), inverse_masses=np.where(rng.random(147) < 0.5, 0.0, 1.0 / sheet.cloth.masses))
    state = sheet.state(positions, velocities)
    contact.start(state)
    dt = GAP / 3
    part = correct(state, dt, contact)
    assert np.linalg.norm(state.velocities, axis=1).max() > 10.0 * np.linalg.norm(velocities, axis=1).max()
    assert not crosses(positions + part * dt * state.velocities, sheet.cloth.particle_triangles)


def test_impulse_stops_at_the_gap_and_is_inelastic() -> None:
    """One particle over the middle of a fixed triangle: it arrives at the gap and stays there."""
    sheet = Sheet(1, panels=2)
    positions = np.array([[0, 0, 0], [0.01, 0, 0], [0, 0, -0.01], [0.01, 0, -0.01], [0.004, 0.003, -0.003], [5, 5, 0], [0, 5, 0], [5, 5, 5]], dtype=float)
    inverse = np.array([0, 0, 0, 0, 1.0, 0, 0, 0]) / sheet.cloth.masses
    contact = Contact(sheet.cloth, fabric(friction=0.0), inverse_masses=inverse)
    state = sheet.state(positions, np.eye(8)[:, 4:5] * [0.0, -1.0, 0.0])
    contact.start(state)
    for _ in range(60):
        correct(state, 1e-4, contact)
        state.positions += 1e-4 * state.velocities
    assert state.positions[4, 1] == pytest.approx(GAP + CLOSED, abs=1e-9)
    assert abs(state.velocities[4, 1]) < 1e-9


def test_neighbours_along_the_cloth_are_no_contact() -> None:
    """Two panels stitched along a side and closed, with a seam of elements much shorter than the gap: at rest nothing may push."""
    sheet = Sheet(6, panels=2)
    cloth, rows = sheet.cloth, 7
    grid = np.arange(2 * 49).reshape(2, rows, 7)
    stitches = np.stack([grid[0, :, -1], grid[1, :, 0]], axis=1)
    uv = cloth.vertex_uv_mm.copy()
    uv[grid[0, :, -2].ravel(), 0] = uv[grid[0, :, -1].ravel(), 0] - 0.4  # a column 0.4 mm from the seam
    uv[grid[1, 2, :].ravel(), 1] = uv[grid[1, 1, :].ravel(), 1] + 0.3  # and a row 0.3 mm from its neighbour
    uv[grid[0, 2, :].ravel(), 1] = uv[grid[0, 1, :].ravel(), 1] + 0.3
    cloth = replace(cloth, vertex_uv_mm=uv, stitches=indices(stitches), stitch_seam=np.zeros(len(stitches), dtype=np.int32))
    positions = np.zeros((98, 3))
    positions[:, :2] = uv / 1000
    positions[49:, 0] += 0.06
    contact = Contact(cloth, fabric())
    state = sheet.state(positions)
    contact.start(state)
    correct(state, 1e-4, contact)
    assert np.abs(state.velocities).max() == 0.0
    # The rule is about the cloth, not about space: the same panels laid on each other do push.
    positions[49:, 0] -= 0.06
    positions[49:, 2] += 0.5e-3
    state = sheet.state(positions)
    contact.start(state)
    correct(state, 1e-4, contact)
    assert np.abs(state.velocities[grid[0, 3:, 2:4]]).max() > 0.01


def test_what_is_let_pass_goes_through_its_own_cloth_alone() -> None:
    """A stitch whose end lies over its cloth: of its pairs those stay that name a node more than two edges away, over the stitch too; and all of others."""
    sheet = Sheet(6, panels=2)
    grid = np.arange(2 * 49).reshape(2, 7, 7)
    stitches = np.stack([grid[0, :, -1], grid[1, :, 0]], axis=1)
    cloth = replace(sheet.cloth, stitches=indices(stitches), stitch_seam=np.zeros(len(stitches), dtype=np.int32))
    positions = np.column_stack([1e-3 * cloth.vertex_uv_mm, np.zeros(98)])
    positions[49:] += [0.042, 0.0, 2e-3]  # the second panel lies over two columns of the first one, along the seam
    passing = np.zeros(98, dtype=bool)
    passing[stitches[3]] = True
    contact, state = Contact(cloth, fabric()), sheet.state(positions)
    contact.start(state)
    before = load_pairs(state).nodes
    contact.let_pass(state, passing)
    after = load_pairs(state).nodes
    one, other = np.concatenate([sheet.ends, stitches, sheet.ends[:, ::-1], stitches[:, ::-1]]).T
    way = np.repeat([1.0, 1e-6, 1.0, 1e-6], [len(sheet.ends), len(stitches)] * 2)  # closed stitches are no way
    far = dijkstra(csr_matrix((way, (one, other)), shape=(98, 98)), indices=stitches[3]).min(axis=0) > 2.5
    stay = ~np.isin(before, stitches[3]).any(axis=1) | far[before].any(axis=1)
    assert 0 < np.count_nonzero(~stay) < np.count_nonzero(np.isin(before, stitches[3]).any(axis=1)), "some of its pairs go, others stay"
    assert sorted(after.tolist()) == sorted(before[stay].tolist())
    contact.let_pass(state, np.zeros(98, dtype=bool))
    assert sorted(load_pairs(state).nodes.tolist()) == sorted(before.tolist())


@pytest.mark.parametrize("kind", [VERTEX_TRIANGLE, EDGE_EDGE])
def test_no_query_with_a_known_contact_passes_unseen(kind: int) -> None:
    """2,000 of the study's queries, degenerate ones included."""
    shapes = set()
    for query in queries(kind, 1000, seed=kind + 1):
        unseen, distance = missed(kind, query)
        assert not unseen
        assert distance < 1e-12
        shapes.add(query.shape)
    assert len(shapes) == len(SHAPES)


def test_what_does_not_meet_is_let_pass() -> None:
    nodes = (0, 1, 2, 3)
    away = np.array([[0.2, 1.0, 0.2], [0, 0, 0], [1, 0, 0], [0, 0, 1.0]])
    still = np.zeros((4, 3))
    assert time_of_contact(VERTEX_TRIANGLE, nodes, away, still, 1.0, 1e-3) == 2.0
    falling = np.eye(4)[:, :1] * [0.0, -0.9, 0.0]
    assert time_of_contact(VERTEX_TRIANGLE, nodes, away, falling, 1.0, 1e-3) == 2.0
    assert time_of_contact(VERTEX_TRIANGLE, nodes, away, 2 * falling, 1.0, 1e-3) == pytest.approx(0.999 / 1.8, abs=1e-4)


def layers(*heights: float) -> tuple[Sheet, np.ndarray, np.ndarray]:
    """Level sheets one above the other: all of them, where their particles are, and the sheet of each."""
    sheet = Sheet(3, panels=len(heights))
    panel = sheet.cloth.vertex_panel[np.argsort(sheet.cloth.vertex_particle)]
    corner = np.array([sheet.positions[panel == k].min(axis=0) for k in range(len(heights))])
    positions = sheet.positions - corner[panel]
    positions[:, 1] = np.array(heights)[panel]
    positions[:, [0, 2]] += 0.0013 * panel[:, None]
    return sheet, positions, panel


def test_what_is_pressed_together_with_all_might_does_not_pass() -> None:
    """Both sheets follow their clamps at 1 m/s, and no impulse moves them: steps are cut, down to nothing before round-off hides which side is which."""
    sheet, positions, panel = layers(0.0, 2e-3)
    contact, state = Contact(sheet.cloth, fabric(), inverse_masses=np.zeros(len(panel))), sheet.state(positions)
    contact.start(state)
    for _ in range(60):
        state.velocities[:] = 0.0
        state.velocities[panel == 1, 1] = -1.0
        part = correct(state, 1e-4, contact)
        state.positions += part * 1e-4 * state.velocities
        assert state.positions[panel == 1, 1].min() > 1e-9
    assert part == 0.0
    assert not crosses(state.positions, sheet.cloth.particle_triangles)
    state.velocities[panel == 1, 1] = 1.0
    assert correct(state, 1e-4, contact) == 1.0  # and comes free


def test_what_stands_too_close_is_kept_apart_though_it_leaves_by_itself() -> None:
    """A sheet rises from one that is held, half a gap below it, and another falls upon it: it does not go down again."""
    sheet, positions, panel = layers(0.0, 0.5e-3, 1.6e-3)
    contact, state = Contact(sheet.cloth, fabric(0.0), inverse_masses=np.array([0.0, 1.0, 1.0])[panel]), sheet.state(positions)
    contact.start(state)
    state.velocities[:, 1] = np.array([0.0, 10.0, -10.0])[panel]
    assert correct(state, 1e-4, contact) == 1.0
    assert state.velocities[panel == 1, 1].min() > 0.0


SCRIPT = """
import numpy as np, trimesh
from loose_sheet import Sheet, fabric
from test_contact_cloth import fold_and_fall
from garmentcad.contact.contact import Contact
ball = trimesh.creation.icosphere(subdivisions=3, radius=0.03)
sheet = Sheet(14)
contact = Contact(sheet.cloth, fabric(), (ball.vertices, ball.faces))
state = sheet.state(sheet.at(0.002, 0.034, 0.001))
contact.start(state)
for _ in range(500):
    sheet.step(state, 1.5e-4, contact)
fallen = fold_and_fall(400)[2][-1]
for end in (state, fallen):
    print(end.sha256(), end.work_j["friction"].hex())
print(len(fallen.contact["pair_nodes"]))
"""


def test_same_bits_on_one_two_and_four_threads() -> None:
    printed = set(printed_on_threads(SCRIPT))
    assert len(printed) == 1
    assert int(printed.pop().split()[-1]) > 100


def test_a_vertex_and_a_triangle_do_not_take_over_from_two_edges_of_the_same_nodes() -> None:
    """(v; a, b, c) and (v, a)-(b, c): the side of one is not that of the other."""
    nodes, gap, friction = np.array([[3, 0, 1, 2]]), np.full(4, 1e-3), np.full(4, 0.3)
    before = make_pairs(nodes, nodes, gap, friction)
    before.side[:] = before.impulse[:, 0] = np.array([1.0, -1.0])
    before.due[:] = -1.0
    for first, second in ((before, make_pairs(nodes, nodes, gap, friction)), (by_kind(before, [1, 0]), make_pairs(nodes, nodes, gap, friction))):
        second.due[:] = -1.0
        carry_over(first, 0.0, second)
        assert second.side.tolist() == second.impulse[:, 0].tolist() == [1.0, -1.0]
    alone = make_pairs(nodes, np.zeros((0, 4), dtype=np.int32), gap, friction)
    alone.due[:] = -1.0
    carry_over(by_kind(before, [1]), 0.0, alone)
    assert alone.side.tolist() == [0.0]


def by_kind(pairs: Pairs, order: list[int]) -> Pairs:
    return Pairs(*(column[order] for column in pairs))


def test_a_vertex_that_two_edges_of_its_nodes_came_close_with_is_not_pressed_through() -> None:
    """Every triangle of a loose sheet whose corner an edge joins to a vertex above it: 0.4 mm above, one look, then pressed on at 0.05 m/s."""
    sheet = Sheet(4)
    edges = set(map(tuple, sheet.ends.tolist()))
    triangles, count = sheet.cloth.particle_triangles.tolist(), sheet.cloth.particle_count
    chosen = [(v, *f) for f in triangles for v in range(count) if v not in f and v < f[0] and (v, f[0]) in edges and f[1] < f[2]]
    assert len(chosen) > 20
    for v, a, b, c in chosen[::4]:
        places = sheet.positions.copy()
        others = np.setdiff1d(np.arange(count), [v, a, b, c])
        places[others] = np.random.default_rng(v).uniform(-0.3, 0.3, (len(others), 3)) + np.array([0.0, 0.0, 5.0])
        places[[a, b, c, v]] = [[0.0, 0.0, 0.0], [0.010, -0.005, 0.0], [0.010, 0.005, 0.0], [0.0095, 0.0002, 0.0004]]
        contact, state = Contact(sheet.cloth, fabric()), sheet.state(places)
        contact.start(state)
        contact.inverse_masses[:] = 0.0
        contact.inverse_masses[v] = 1.0 / sheet.cloth.masses[v]
        contact.respond(state, 1e-4)
        state.velocities[:] = 0.0
        contact._find_pairs(state, 0.0)
        for _ in range(100):
            state.velocities[:] = 0.0
            state.velocities[v, 2] = -0.05
            contact.detect(state, 5e-6)
            state.positions += contact.respond(state, 1e-4) * 1e-4 * state.velocities
        assert state.positions[v, 2] > 0.0
