"""Tree of axis-aligned boxes over points, edges or triangles: build once, refit when they move, find all elements within reach of others.

The tree is a complete binary tree in heap order (root 1, children 2i and 2i + 1), so that it needs no pointers and a walk needs no stack: after a
subtree comes node + 1 without its trailing zero bits, and a walk that arrives at 1 is done. Leaf j of n_leaves holds the elements
order[j n // n_leaves : (j + 1) n // n_leaves].

Pairs are looked for between two such trees, three levels of which are taken as one: blocks of eight boxes side by side, which a query holds against itself at
once. Level 0 has the elements of each leaf, level 1 the boxes of eight such blocks, and so on up to one block, of level 1 at least. The elements of a leaf walk
down the other tree together, up to its leaves.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import prange

from garmentcad.arrays import CHUNKS, chunk_range, entry, floats, indices, inlined_kernel, kernel, making_kernel, parallel_kernel, row_kernel
from garmentcad.geometry.closest import point_triangle, row, segment_segment

LEAF = 8  # elements in a leaf, at most, and boxes in a block: which of them a query meets is read as one number of 8 bytes
_LOWEST = 0x0001020304050607  # times 256^k its highest byte is k
_MOST_LEVELS = 11  # 8^11 leaves
_SURE = 1.0 + 1e-6  # what is called apart without its distance is so by more than round-off
_WIDTH = 16  # items found per query at the first try; fuller rows are searched again with room for all
_LEAVES = 1 << 12  # of queries at a time, so that the room for what they find is small
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


class Blocks(NamedTuple):
    """A tree for `near_pairs`, with its elements by their places along the leaves. order: (N,) int32 element at each place; nodes, identity: (N,3) int32 of it;
    first (levels+1,) int64: number of the first block of each level, and of all blocks; boxes (6 x LEAF x blocks,) float32, m: low and then high corners of
    eight boxes side by side, empty ones where there are fewer."""

    order: np.ndarray
    nodes: np.ndarray
    identity: np.ndarray
    first: np.ndarray
    boxes: np.ndarray


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


@entry
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


def blocks_over(elements: Elements, centers: np.ndarray) -> Blocks:
    """Blocks over the elements with these centers (N,D). Boxes are not set: `set_boxes`."""
    tree = build_tree(centers)
    sizes = [len(tree.boxes) // 2]
    while sizes[-1] > 1 or len(sizes) == 1:
        sizes.append(-(-sizes[-1] // LEAF))
    first = np.cumsum([0, *sizes])
    boxes = np.empty(first[-1] * 6 * LEAF, dtype=np.float32)
    nodes = indices(elements.nodes[tree.order])
    identity = nodes if elements.identity is elements.nodes else indices(elements.identity[tree.order])
    return Blocks(tree.order, nodes, identity, first, boxes)


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


@entry
@kernel
def set_boxes(blocks, positions):  # type: ignore[no-untyped-def]
    """Set the boxes, in place, from the positions (P,3) of the elements' nodes."""
    nodes, first, out = blocks.nodes, blocks.first, blocks.boxes
    leaves, count = first[1], len(nodes)
    for leaf in range(leaves):
        begin, end = leaf * count // leaves, (leaf + 1) * count // leaves
        for lane in range(LEAF):
            for axis in range(3):
                low, high = math.inf, -math.inf
                if begin + lane < end:
                    a, b, c = row(nodes, begin + lane)
                    x, y, z = positions[a, axis], positions[b, axis], positions[c, axis]
                    low, high = min(x, y, z), max(x, y, z)
                out[(6 * leaf + axis) * LEAF + lane], out[(6 * leaf + 3 + axis) * LEAF + lane] = low, high
    for level in range(1, len(first) - 1):
        for block in range(first[level], first[level + 1]):
            for lane in range(LEAF):
                below = first[level - 1] + LEAF * (block - first[level]) + lane
                for axis in range(3):
                    low, high = math.inf, -math.inf
                    if below < first[level]:
                        for k in range(LEAF):
                            low, high = min(low, out[(6 * below + axis) * LEAF + k]), max(high, out[(6 * below + 3 + axis) * LEAF + k])
                    out[(6 * block + axis) * LEAF + lane], out[(6 * block + 3 + axis) * LEAF + lane] = low, high


@row_kernel
def _meets(boxes, block, low, high, out):  # type: ignore[no-untyped-def]
    """Which boxes of a block meet the box from low to high, into out (LEAF,) uint8. Rounding keeps the order of two numbers, so that none is lost by single
    precision."""
    x, y, z = np.float32(low[0]), np.float32(low[1]), np.float32(low[2])
    u, v, w = np.float32(high[0]), np.float32(high[1]), np.float32(high[2])
    # a length that is known only when it runs, or the loop is unrolled and not wide
    lanes = np.uint64(len(out))
    first = np.uint64(6) * lanes * np.uint64(block)
    for lane in range(lanes):
        a = first + lane
        b = a + lanes
        c = b + lanes
        d = c + lanes
        e = d + lanes
        out[lane] = max(max(max(boxes[a] - u, boxes[b] - v), max(boxes[c] - w, x - boxes[d])), max(y - boxes[e], z - boxes[e + lanes])) <= 0.0


@kernel
def _point_apart(p, a, b, c, reach):  # type: ignore[no-untyped-def]
    """Whether a point is farther from a triangle than `reach` along the line to it from the triangle's middle."""
    x, y, z = 3.0 * p[0] - (a[0] + b[0] + c[0]), 3.0 * p[1] - (a[1] + b[1] + c[1]), 3.0 * p[2] - (a[2] + b[2] + c[2])
    from_a = x * (p[0] - a[0]) + y * (p[1] - a[1]) + z * (p[2] - a[2])
    from_b = x * (p[0] - b[0]) + y * (p[1] - b[1]) + z * (p[2] - b[2])
    from_c = x * (p[0] - c[0]) + y * (p[1] - c[1]) + z * (p[2] - c[2])
    room = min(from_a, from_b, from_c)
    return room > 0.0 and room * room > _SURE * reach * reach * (x * x + y * y + z * z)


@kernel
def _edges_apart(p, q, r, s, reach):  # type: ignore[no-untyped-def]
    """Whether edges pq and rs are farther apart than `reach` along the line through their middles."""
    x, y, z = (r[0] + s[0]) - (p[0] + q[0]), (r[1] + s[1]) - (p[1] + q[1]), (r[2] + s[2]) - (p[2] + q[2])
    along = abs(x * (q[0] - p[0]) + y * (q[1] - p[1]) + z * (q[2] - p[2])) + abs(x * (s[0] - r[0]) + y * (s[1] - r[1]) + z * (s[2] - r[2]))
    square = x * x + y * y + z * z  # of twice the way from middle to middle
    room = square - along
    return room > 0.0 and room * room > 4.0 * _SURE * reach * reach * square


@kernel
def _within(kind, reach, one, other, own, theirs):  # type: ignore[no-untyped-def]
    """Whether two elements are within reach. Three of four that are not, on a cloth, are apart along one line, which is found in a fifth of the time."""
    if kind == POINT_TRIANGLE:
        p, a, b, c = row(own, one[0]), row(theirs, other[0]), row(theirs, other[1]), row(theirs, other[2])
        return not _point_apart(p, a, b, c, reach) and point_triangle(p, a, b, c)[3] <= reach * reach
    if kind == TRIANGLE_POINT:
        p, a, b, c = row(theirs, other[0]), row(own, one[0]), row(own, one[1]), row(own, one[2])
        return not _point_apart(p, a, b, c, reach) and point_triangle(p, a, b, c)[3] <= reach * reach
    p, q, r, s = row(own, one[0]), row(own, one[1]), row(theirs, other[0]), row(theirs, other[1])
    return not _edges_apart(p, q, r, s, reach) and segment_segment(p, q, r, s)[2] <= reach * reach


@inlined_kernel
def _share(one, other):  # type: ignore[no-untyped-def]
    """Whether two elements have a point in common; all compared, because half of those that are near have, and no guess of which is better than that."""
    first = (one[0] == other[0]) | (one[0] == other[1]) | (one[0] == other[2])
    second = (one[1] == other[0]) | (one[1] == other[1]) | (one[1] == other[2])
    third = (one[2] == other[0]) | (one[2] == other[1]) | (one[2] == other[2])
    return first | second | third


@kernel
def _record(found, place, hits, item):  # type: ignore[no-untyped-def]
    """The next item of a query, in rising order, where there is room."""
    if hits < found.shape[1]:
        while hits > 1 and found[place, hits - 1] > item:
            found[place, hits] = found[place, hits - 1]
            hits -= 1
        found[place, hits] = item


@inlined_kernel
def _all_of(halves):  # type: ignore[no-untyped-def]
    """One number of what `_meets` found, from its halves (2,) uint32. It writes them one after the other, and who reads at once what was written in two pieces
    waits until both are in the cache."""
    return np.uint64(halves[0]) | (np.uint64(halves[1]) << np.uint64(32))


@inlined_kernel
def _lowest(met):  # type: ignore[no-untyped-def]
    """Number of the lowest byte that is 1, in a number of such bytes and zeros."""
    return np.int64(((met & (~met + np.uint64(1))) * np.uint64(_LOWEST)) >> np.uint64(56))


@making_kernel
def _near_of(mine, search, queries, items, positions, rows, found):  # type: ignore[no-untyped-def]
    (kind, reach), (own, theirs), (leaves, starts) = search, positions, rows
    # By names of their own: here references to arrays are counted wherever a tuple gives one.
    own_nodes, own_twins, item_nodes, item_twins, order, first, boxes = (
        queries.nodes, queries.identity, items.nodes, items.identity, items.order, items.first, items.boxes,
    )  # fmt: skip
    own_leaves, own_count, item_leaves, item_count = queries.first[1], len(own_nodes), first[1], len(item_nodes)
    top, once, one = len(first) - 2, kind == EDGE_EDGE_ONCE, np.uint64(1)
    meets, left, at = np.empty(LEAF, dtype=np.uint8), np.empty(_MOST_LEVELS + 1, dtype=np.uint64), np.empty(_MOST_LEVELS + 1, dtype=np.int64)
    halves, corners = meets.view(np.uint32), np.empty((LEAF, 6))
    for n in range(mine[0], mine[1]):
        leaf, start = leaves[n], starts[n]
        begin, end = leaf * own_count // own_leaves, (leaf + 1) * own_count // own_leaves
        low, high = (math.inf, math.inf, math.inf), (-math.inf, -math.inf, -math.inf)
        for k in range(end - begin):
            nodes = row(own_nodes, begin + k)
            a, b, c = row(own, nodes[0]), row(own, nodes[1]), row(own, nodes[2])
            for axis in range(3):
                corners[k, axis], corners[k, 3 + axis] = min(a[axis], b[axis], c[axis]) - reach, max(a[axis], b[axis], c[axis]) + reach
            low = (min(low[0], corners[k, 0]), min(low[1], corners[k, 1]), min(low[2], corners[k, 2]))
            high = (max(high[0], corners[k, 3]), max(high[1], corners[k, 4]), max(high[2], corners[k, 5]))
            found[start + k, 0] = 0
        level, block = top, np.int64(0)
        _meets(boxes, first[level], low, high, meets)
        met = _all_of(halves)
        while True:
            if met == 0:
                if level == top:
                    break
                level += 1
                met, block = left[level], at[level]
                continue
            below = LEAF * block + _lowest(met)
            met &= met - one
            # Among themselves each element looks at those after it in the tree.
            if once and (below + 1) << (3 * (level - 1)) <= leaf:
                continue
            if level > 1:
                left[level], at[level] = met, block
                level, block = level - 1, below
                _meets(boxes, first[level] + block, low, high, meets)
                met = _all_of(halves)
                continue
            first_of_leaf = below * item_count // item_leaves
            for k in range(end - begin):
                _meets(boxes, below, (corners[k, 0], corners[k, 1], corners[k, 2]), (corners[k, 3], corners[k, 4], corners[k, 5]), meets)
                inside, nodes, twins = _all_of(halves), row(own_nodes, begin + k), row(own_twins, begin + k)
                while inside != 0:
                    place = first_of_leaf + _lowest(inside)
                    inside &= inside - one
                    if once and place <= begin + k:
                        continue
                    if not _share(twins, row(item_twins, place)) and _within(kind, reach, nodes, row(item_nodes, place), own, theirs):
                        found[start + k, 0] += 1
                        _record(found, start + k, found[start + k, 0], order[place])


@entry
@parallel_kernel
def _near(kind, reach, queries, items, positions, leaves, starts, found):  # type: ignore[no-untyped-def]
    """For each query element of these leaves (L,), by their places from the row starts[n] on, the items within reach, rising: found (R,1+K), first their
    number. A number above K says that it overflowed."""
    for chunk in prange(CHUNKS):
        _near_of(chunk_range(chunk, len(leaves)), (kind, reach), queries, items, positions, (leaves, starts), found)


@entry
@kernel
def _collect(queries, found, places, out):  # type: ignore[no-untyped-def]
    """Pairs of the query of each row (R,) with what `_near` found, into out (K,2) from the place of the query on."""
    for n in range(len(queries)):
        for k in range(found[n, 0]):
            out[places[queries[n]] + k, 0], out[places[queries[n]] + k, 1] = queries[n], found[n, 1 + k]


def near_pairs(kind: int, reach: float, queries: Blocks, items: Blocks, positions: tuple[np.ndarray, np.ndarray]) -> np.ndarray:
    """All pairs (query, item) (K,2) int32 within `reach` that share no identity, in rising order.

    kind: POINT_TRIANGLE, TRIANGLE_POINT (queries are named first), EDGE_EDGE, or EDGE_EDGE_ONCE for edges among themselves, each pair once; items: with boxes
    where they are; positions: of the queries' nodes and of the items' nodes, m, as is reach.
    """
    count, leaves, parts = len(queries.order), int(queries.first[1]), []
    bounds, counts = np.arange(leaves + 1) * count // leaves, np.zeros(count, dtype=np.int64)
    for begin in range(0, leaves if count and len(items.order) else 0, _LEAVES):
        chosen, width = np.arange(begin, min(begin + _LEAVES, leaves)), _WIDTH
        while len(chosen):
            sizes = bounds[chosen + 1] - bounds[chosen]
            starts = np.append(0, np.cumsum(sizes))
            found = np.empty((starts[-1], 1 + width), dtype=np.int32)
            _near(kind, reach, queries, items, positions, chosen, starts, found)
            most = np.maximum.reduceat(found[:, 0], starts[:-1])
            found[np.repeat(most > width, sizes), 0] = 0  # all of a leaf are looked for again
            asked = queries.order[np.repeat(bounds[chosen] - starts[:-1], sizes) + np.arange(starts[-1])]
            counts[asked] += found[:, 0]
            parts.append((asked, found))
            chosen, width = chosen[most > width], int(most.max())
    pairs, places = np.empty((int(counts.sum()), 2), dtype=np.int32), np.cumsum(counts) - counts
    for asked, found in parts:
        _collect(asked, found, places, pairs)
    if kind == EDGE_EDGE_ONCE:
        pairs.sort(axis=1)
        return indices(pairs[np.lexsort((pairs[:, 1], pairs[:, 0]))])
    return pairs
