"""Boxes and pairs against brute force."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.spatial

from garmentcad.contact.bvh import build_tree, refit
from garmentcad.contact.elements import elements
from garmentcad.contact.near import EDGE_EDGE, EDGE_EDGE_ONCE, POINT_TRIANGLE, TRIANGLE_POINT, Elements, blocks_over, near_pairs
from garmentcad.geometry.closest import point_triangle, segment_segment


def soup(rng: np.random.Generator, triangles: int) -> tuple[np.ndarray, np.ndarray]:
    """Positions and triangles that share vertices now and then."""
    positions = rng.uniform(0, 1, (2 * triangles + 4, 3))
    centers = rng.integers(0, len(positions), triangles)
    order = np.argsort(np.linalg.norm(positions[centers][:, None] - positions[None], axis=2), axis=1)
    return positions, order[:, [0, 1, 3]]


def brute(kind: int, reach: float, queries: Elements, items: Elements, own: np.ndarray, theirs: np.ndarray) -> list[tuple[int, int]]:
    found = []
    for i, (one, twins) in enumerate(zip(queries.nodes, queries.identity)):
        for j, (other, others) in enumerate(zip(items.nodes, items.identity)):
            if set(twins) & set(others) or (kind == EDGE_EDGE_ONCE and j <= i):
                continue
            a, b = [tuple(own[node]) for node in one], [tuple(theirs[node]) for node in other]
            if kind == POINT_TRIANGLE:
                distance2 = point_triangle(a[0], *b)[3]
            elif kind == TRIANGLE_POINT:
                distance2 = point_triangle(b[0], *a)[3]
            else:
                distance2 = segment_segment(a[0], a[1], b[0], b[1])[2]
            if distance2 <= reach * reach:
                found.append((i, j))
    return found


@pytest.mark.parametrize("far_m", [0.0, 3e5])  # where boxes in single precision are 30 mm coarse
@pytest.mark.parametrize("count", [1, 3, 5, 64, 101])
@pytest.mark.parametrize("kind", [POINT_TRIANGLE, TRIANGLE_POINT, EDGE_EDGE, EDGE_EDGE_ONCE])
def test_near_pairs_equal_brute_force(kind: int, count: int, far_m: float, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("garmentcad.contact.near._LEAVES", 5)  # of more leaves than that some take their turn later
    rng = np.random.default_rng(10 * kind + count)
    positions, triangles = soup(rng, count)
    triangles[0, 2] = triangles[0, 1]  # one that has shrunk to a line, and an edge to a point
    identity = np.arange(len(positions))
    identity[-1] = 0  # a twin
    kinds = {
        POINT_TRIANGLE: (np.arange(len(positions)), triangles),
        TRIANGLE_POINT: (triangles, np.arange(len(positions))),
        EDGE_EDGE: (triangles[:, :2], triangles[:, 1:]),
        EDGE_EDGE_ONCE: (triangles[:, :2], triangles[:, :2]),
    }
    queries, items = (elements(nodes, identity) for nodes in kinds[kind])
    moved = positions + rng.normal(0, 0.1, positions.shape) + far_m  # the tree's order is of the rest, its boxes are of now
    own, blocks = (blocks_over(part, positions[part.nodes].mean(axis=1)) for part in (queries, items))
    for reach in (0.02, 0.2, 0.6):  # the last overflows the first try's rows
        pairs = near_pairs(kind, reach, own, blocks, (moved, moved))
        assert [tuple(pair) for pair in pairs.tolist()] == brute(kind, reach, queries, items, moved, moved)


def test_an_edge_that_meets_a_thousand_leaves() -> None:
    """Three edges across 5,000 short ones, in one leaf that meets nearly all of 1,024: more than stay laid out."""
    rng = np.random.default_rng(11)
    starts = rng.uniform(0, 1, (5000, 3))
    positions = np.concatenate([starts, starts + rng.normal(0, 0.01, starts.shape), [[0, 0, 0], [0, 1, 0], [1, 0, 0]], [[1, 1, 1], [1, 0, 1], [0, 1, 1]]])
    identity = np.arange(len(positions))
    long = elements(np.array([[10000, 10003], [10001, 10004], [10002, 10005]]), identity)
    short = elements(np.stack([np.arange(5000), 5000 + np.arange(5000)], axis=1), identity)
    reach = 0.03
    blocks = [blocks_over(part, positions[part.nodes].mean(axis=1)) for part in (long, short)]
    found = brute(EDGE_EDGE, reach, long, short, positions, positions)
    assert len(found) > 50
    assert [tuple(pair) for pair in near_pairs(EDGE_EDGE, reach, *blocks, (positions, positions)).tolist()] == found


def test_edges_among_themselves_are_found_through_all_levels() -> None:
    """5,000 short edges: 1,024 leaves in 128, 16, 2 and 1 blocks."""
    rng = np.random.default_rng(7)
    starts = rng.uniform(0, 1, (5000, 3))
    positions = np.concatenate([starts, starts + rng.normal(0, 0.01, starts.shape)])
    edges = elements(np.stack([np.arange(5000), 5000 + np.arange(5000)], axis=1), np.arange(10000))
    reach = 0.02
    blocks = blocks_over(edges, starts)
    pairs = near_pairs(EDGE_EDGE_ONCE, reach, blocks, blocks, (positions, positions))
    middles = 0.5 * (positions[:5000] + positions[5000:])
    found = []
    for i, j in scipy.spatial.cKDTree(middles).query_pairs(reach + 0.1, output_type="ndarray").tolist():  # no edge is longer than 0.1
        if segment_segment(*(tuple(positions[node]) for node in (i, 5000 + i, j, 5000 + j)))[2] <= reach * reach:
            found.append((i, j))
    assert len(found) > 500
    assert [tuple(pair) for pair in pairs.tolist()] == sorted(found)


def test_boxes_hold_their_elements_and_every_element_has_one_leaf() -> None:
    rng = np.random.default_rng(3)
    positions, triangles = soup(rng, 77)
    tree = build_tree(positions[triangles].mean(axis=1))
    refit(tree, np.ascontiguousarray(triangles, dtype=np.int32), positions)
    assert sorted(tree.order) == list(range(77))
    leaves = len(tree.boxes) // 2
    for leaf in range(leaves):
        held = triangles[tree.order[leaf * 77 // leaves : (leaf + 1) * 77 // leaves]]
        assert 1 <= len(held) <= 8
        node = leaves + leaf
        while node:
            assert (tree.boxes[node, :3] <= positions[held].min(axis=(0, 1))).all()
            assert (tree.boxes[node, 3:] >= positions[held].max(axis=(0, 1))).all()
            node //= 2
    np.testing.assert_array_equal(tree.boxes[1], np.concatenate([positions[triangles].min(axis=(0, 1)), positions[triangles].max(axis=(0, 1))]))


def test_build_is_a_function_of_its_centers() -> None:
    centers = np.random.default_rng(4).uniform(0, 1, (1000, 2)).round(1)  # many ties
    np.testing.assert_array_equal(build_tree(centers).order, build_tree(centers.copy()).order)
    assert len(build_tree(np.zeros((0, 3))).order) == 0
