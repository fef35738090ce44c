"""Tree of axis-aligned boxes over points, edges or triangles: build once, refit when they move, find all elements within reach of others.

The tree is a complete binary tree in heap order (root 1, children 2i and 2i + 1), so that it needs no pointers and a walk needs no stack: after a
subtree comes node + 1 without its trailing zero bits, and a walk that arrives at 1 is done. Leaf j of n_leaves holds the elements
order[j n // n_leaves : (j + 1) n // n_leaves].
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import prange

from garmentcad.arrays import CHUNKS, chunk_range, floats, indices, kernel, long_kernel, parallel_kernel
from garmentcad.geometry.closest import point_triangle, row, segment_segment

LEAF = 8  # elements in a leaf, at most: `near_pairs` takes as long with 2, and needs four boxes for each of these then
_WIDTH = 16  # items found per query at the first try; fuller rows are searched again with room for all
_QUERIES = 1 << 15  # at a time, so that the room for what they find is small
POINT_TRIANGLE, TRIANGLE_POINT, EDGE_EDGE, EDGE_EDGE_ONCE = 0, 1, 2, 3


class Tree(NamedTuple):
    """order: (N,) int32 elements along the leaves. boxes: (2 n_leaves, 6) low and high corners of the nodes; row 0 is unused."""

    order: np.ndarray
    boxes: np.ndarray


class Elements(NamedTuple):
    """Points (a, a, a), edges (a, b, b) or triangles (a, b, c). identity: who counts as the same point (twins of a seam); elements that share an
    identity never pair. All (N,3) int32."""

    nodes: np.ndarray
    identity: np.ndarray


def build_tree(centers: np.ndarray, leaf: int = LEAF) -> Tree:
    """Tree over elements with these centers (N,D), D <= 3: halved at the median along the widest axis, level by level, until no leaf
    has more than `leaf`. Boxes are not set: refit.

    Deterministic: it depends on the centers' order and values alone.
    """
    count = len(centers)
    if count == 0:
        return Tree(indices([]), floats(np.zeros((2, 6))))
    levels = max(0, math.ceil(math.log2(max(count, 1) / leaf)))
    order = np.arange(count)
    for level in range(levels):
        starts = np.arange((1 << level) + 1) * count >> level
        part = np.repeat(np.arange(1 << level), np.diff(starts))
        points = centers[order]
        filled = starts[:-1][np.diff(starts) > 0]
        extent = np.zeros((1 << level, centers.shape[1]))
        extent[np.diff(starts) > 0] = np.maximum.reduceat(points, filled) - np.minimum.reduceat(points, filled)
        axis = np.argmax(extent, axis=1)
        order = order[np.lexsort((points[np.arange(count), axis[part]], part))]
    return Tree(indices(order), floats(np.zeros((2 << levels, 6))))


@kernel
def refit(tree, nodes, positions):  # type: ignore[no-untyped-def]
    """Set the boxes of the tree from the positions (P,3) of the elements' nodes (N,3)."""
    leaves, count = len(tree.boxes) // 2, len(tree.order)
    for leaf in range(leaves):
        for axis in range(3):
            low, high = math.inf, -math.inf
            for place in range(leaf * count // leaves, (leaf + 1) * count // leaves):
                for corner in range(3):
                    value = positions[nodes[tree.order[place], corner], axis]
                    low, high = min(low, value), max(high, value)
            tree.boxes[leaves + leaf, axis], tree.boxes[leaves + leaf, 3 + axis] = low, high
    for node in range(leaves - 1, 0, -1):
        for axis in range(3):
            tree.boxes[node, axis] = min(tree.boxes[2 * node, axis], tree.boxes[2 * node + 1, axis])
            tree.boxes[node, 3 + axis] = max(tree.boxes[2 * node, 3 + axis], tree.boxes[2 * node + 1, 3 + axis])


def refit_swept(tree: Tree, nodes: np.ndarray, hull: list[np.ndarray]) -> None:
    """Set the boxes of the tree around elements whose nodes stay within the hull of the same rows (P,3) of several positions."""
    boxes = []
    for positions in hull:
        refit(tree, nodes, positions)
        boxes.append(tree.boxes.copy())
    tree.boxes[:, :3], tree.boxes[:, 3:] = np.min(boxes, axis=0)[:, :3], np.max(boxes, axis=0)[:, 3:]


def fitted_tree(elements: Elements, positions: np.ndarray, leaf: int = LEAF) -> Tree:
    """Tree built over the elements at these positions (P,3) of their nodes, with its boxes."""
    tree = build_tree(positions[elements.nodes].mean(axis=1), leaf)
    refit(tree, elements.nodes, positions)
    return tree


@kernel
def node_after(node):  # type: ignore[no-untyped-def]
    """The node that follows the subtree of `node` in a walk; 1 at the end."""
    node += 1
    while node & 1 == 0:
        node >>= 1
    return node


@kernel
def box_distance2(boxes, node, p):  # type: ignore[no-untyped-def]
    """Squared distance of the point p from the box of a node, 0 inside."""
    x = max(boxes[node, 0] - p[0], p[0] - boxes[node, 3], 0.0)
    y = max(boxes[node, 1] - p[1], p[1] - boxes[node, 4], 0.0)
    z = max(boxes[node, 2] - p[2], p[2] - boxes[node, 5], 0.0)
    return x * x + y * y + z * z


@kernel
def _apart(boxes, node, low, high):  # type: ignore[no-untyped-def]
    if boxes[node, 0] > high[0] or boxes[node, 1] > high[1] or boxes[node, 2] > high[2]:
        return True
    return boxes[node, 3] < low[0] or boxes[node, 4] < low[1] or boxes[node, 5] < low[2]


@kernel
def _beyond(nodes, positions, low, high):  # type: ignore[no-untyped-def]
    a, b, c = nodes
    for axis in range(3):
        x, y, z = positions[a, axis], positions[b, axis], positions[c, axis]
        if min(x, y, z) > high[axis] or max(x, y, z) < low[axis]:
            return True
    return False


@kernel
def _distance2(kind, one, other, own, theirs):  # type: ignore[no-untyped-def]
    if kind == POINT_TRIANGLE:
        return point_triangle(row(own, one[0]), row(theirs, other[0]), row(theirs, other[1]), row(theirs, other[2]))[3]
    if kind == TRIANGLE_POINT:
        return point_triangle(row(theirs, other[0]), row(own, one[0]), row(own, one[1]), row(own, one[2]))[3]
    return segment_segment(row(own, one[0]), row(own, one[1]), row(theirs, other[0]), row(theirs, other[1]))[2]


@kernel
def _share(one, other):  # type: ignore[no-untyped-def]
    for i in range(3):
        for j in range(3):
            if one[i] == other[j]:
                return True
    return False


@long_kernel
def _near_of(places, search, sides, tree, positions, rows, found):  # type: ignore[no-untyped-def]
    (kind, reach), (queries, items), (own, theirs) = search, sides, positions
    leaves, count = len(tree.boxes) // 2, len(tree.order)
    for place in range(places[0], places[1]):
        # Among themselves: each element looks at those after it in the tree, from its own leaf on.
        slot_before = rows[place] if kind == EDGE_EDGE_ONCE else -1
        query = tree.order[slot_before] if kind == EDGE_EDGE_ONCE else rows[place]
        nodes, twins = row(queries.nodes, query), row(queries.identity, query)
        a, b, c = row(own, nodes[0]), row(own, nodes[1]), row(own, nodes[2])
        low = (min(a[0], b[0], c[0]) - reach, min(a[1], b[1], c[1]) - reach, min(a[2], b[2], c[2]) - reach)
        high = (max(a[0], b[0], c[0]) + reach, max(a[1], b[1], c[1]) + reach, max(a[2], b[2], c[2]) + reach)
        hits = 0
        node = leaves + ((slot_before + 1) * leaves + count - 1) // count - 1 if kind == EDGE_EDGE_ONCE else 1
        while True:
            apart = _apart(tree.boxes, node, low, high)
            if not apart and node < leaves:
                node *= 2
                continue
            if not apart:
                for slot in range(max(slot_before + 1, (node - leaves) * count // leaves), (node - leaves + 1) * count // leaves):
                    item = tree.order[slot]
                    if _beyond(row(items.nodes, item), theirs, low, high) or _share(twins, row(items.identity, item)):
                        continue
                    if _distance2(kind, nodes, row(items.nodes, item), own, theirs) <= reach * reach:
                        hits += 1
                        if hits < found.shape[1]:
                            back = hits
                            while back > 1 and found[place, back - 1] > item:
                                found[place, back] = found[place, back - 1]
                                back -= 1
                            found[place, back] = item
            node = node_after(node)
            if node == 1:
                break
        found[place, 0] = hits


@parallel_kernel
def _near(kind, reach, queries, items, tree, positions, rows, found):  # type: ignore[no-untyped-def]
    """For each query element of `rows` (of edges among themselves: for each slot of the tree) the items within reach, rising: found (R,1+K), first their
    number. A number above K says that it overflowed."""
    for chunk in prange(CHUNKS):
        _near_of(chunk_range(chunk, len(rows)), (kind, reach), (queries, items), tree, positions, rows, found)


def near_pairs(kind: int, reach: float, queries: Elements, items: Elements, tree: Tree, positions: tuple[np.ndarray, np.ndarray]) -> np.ndarray:
    """All pairs (query, item) (K,2) int32 within `reach` that share no identity, in rising order.

    kind: POINT_TRIANGLE, TRIANGLE_POINT (queries are named first), EDGE_EDGE, or EDGE_EDGE_ONCE for edges among themselves, each pair once;
    positions: of the queries' nodes and of the items' nodes; tree: over the items, refitted.
    """
    parts = []
    for first in range(0, len(queries.nodes), _QUERIES):
        rows, width = np.arange(first, min(first + _QUERIES, len(queries.nodes)), dtype=np.int32), _WIDTH
        while len(rows):
            found = np.empty((len(rows), 1 + width), dtype=np.int32)
            _near(kind, reach, queries, items, tree, positions, rows, found)
            counts = found[:, 0]
            kept = np.flatnonzero((counts > 0) & (counts <= width))
            filled = np.arange(width) < counts[kept, None]
            parts.append(np.stack([np.repeat(rows[kept], counts[kept]), found[kept, 1:][filled]], axis=1))
            rows, width = rows[counts > width], int(counts.max())
    pairs = np.concatenate(parts) if parts else np.zeros((0, 2), dtype=np.int32)
    if kind == EDGE_EDGE_ONCE:
        pairs[:, 0] = tree.order[pairs[:, 0]]
        pairs.sort(axis=1)
        return indices(pairs[np.lexsort((pairs[:, 1], pairs[:, 0]))])
    return indices(pairs[np.lexsort((pairs[:, 1], pairs[:, 0]))] if len(parts) > 1 else pairs)
