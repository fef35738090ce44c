"""Tree of axis-aligned boxes over points, edges or triangles: build once, refit when they move, find all elements within reach of others.

The tree is a complete binary tree in heap order (root 1, children 2i and 2i + 1), so that it needs no pointers and a walk needs no stack: after a
subtree comes node + 1 without its trailing zero bits, and a walk that arrives at 1 is done. Leaf j of n_leaves holds the elements
order[j n // n_leaves : (j + 1) n // n_leaves].

Pairs are looked for in the same tree with three of its levels taken as one: blocks of eight boxes side by side, which one query holds against itself at once.
Level 0 has the elements of each leaf, level 1 the boxes of eight such blocks, and so on up to one block.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import prange

from garmentcad.arrays import CHUNKS, chunk_range, entry, floats, indices, kernel, making_kernel, parallel_kernel
from garmentcad.geometry.closest import point_triangle, row, segment_segment

LEAF = 8  # elements in a leaf, at most, and boxes in a block: which of them a query meets is read as one number of 8 bytes
_LOWEST = 0x0001020304050607  # times 256^k its highest byte is k
_MOST_LEVELS = 11  # 8^11 leaves
_SURE = 1.0 + 1e-6  # what is called apart without its distance is so by more than round-off
_WIDTH = 16  # items found per query at the first try; fuller rows are searched again with room for all
_QUERIES = 1 << 15  # at a time, so that the room for what they find is small
POINT_TRIANGLE, TRIANGLE_POINT, EDGE_EDGE, EDGE_EDGE_ONCE = 0, 1, 2, 3


class Tree(NamedTuple):
    """order: (N,) int32 elements along the leaves. boxes: (2 n_leaves, 6) low and high corners of the nodes; row 0 is unused."""

    order: np.ndarray
    boxes: np.ndarray


class Blocks(NamedTuple):
    """A tree for `near_pairs`. order: as of the tree; first (levels+1,): number of the first block of each level, and of all blocks; boxes (6 x LEAF x blocks,)
    in single precision: low and then high corners of eight boxes side by side, empty ones where there are fewer."""

    order: np.ndarray
    first: np.ndarray
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


def tree_over(elements: Elements, positions: np.ndarray, leaf: int = LEAF) -> Tree:
    """Tree built over the elements at these positions (P,3) of their nodes. Boxes are not set."""
    return build_tree(positions[elements.nodes].mean(axis=1), leaf)


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
def _write_blocks(blocks, nodes, positions):  # type: ignore[no-untyped-def]
    """Set `blocks.boxes`, level by level."""
    order, first, out = blocks
    leaves, count = first[1], len(order)
    for leaf in range(leaves):
        begin, end = leaf * count // leaves, (leaf + 1) * count // leaves
        for lane in range(LEAF):
            for axis in range(3):
                low, high = math.inf, -math.inf
                if begin + lane < end:
                    a, b, c = row(nodes, order[begin + lane])
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


@kernel
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


@kernel
def _share(one, other):  # type: ignore[no-untyped-def]
    for i in range(3):
        for j in range(3):
            if one[i] == other[j]:
                return True
    return False


@kernel
def _record(found, place, hits, item):  # type: ignore[no-untyped-def]
    """The next item of a query, in rising order, where there is room."""
    if hits < found.shape[1]:
        while hits > 1 and found[place, hits - 1] > item:
            found[place, hits] = found[place, hits - 1]
            hits -= 1
        found[place, hits] = item


@making_kernel
def _near_of(places, search, sides, blocks, positions, rows, found):  # type: ignore[no-untyped-def]
    (kind, reach), (own, theirs) = search, positions
    # By names of their own: here references to arrays are counted wherever a tuple gives one.
    queries, items = sides
    own_nodes, own_twins, item_nodes, item_twins = queries.nodes, queries.identity, items.nodes, items.identity
    order, first, boxes = blocks
    leaves, count, top, once = first[1], len(order), len(first) - 2, kind == EDGE_EDGE_ONCE
    halvings = 0  # that make the leaves: a shift takes a tenth of a division
    while 1 << halvings < leaves:
        halvings += 1
    meets, left, at = np.empty(LEAF, dtype=np.uint8), np.empty(_MOST_LEVELS + 1, dtype=np.uint64), np.empty(_MOST_LEVELS + 1, dtype=np.int64)
    all_of, one = meets.view(np.uint64), np.uint64(1)
    for place in range(places[0], places[1]):
        # Among themselves: each element looks at those after it in the tree, from its own leaf on.
        slot_before = rows[place] if once else -1
        query = order[slot_before] if once else rows[place]
        begin = ((slot_before + 1) * leaves + count - 1) // count - 1 if once else 0
        nodes, twins = row(own_nodes, query), row(own_twins, query)
        a, b, c = row(own, nodes[0]), row(own, nodes[1]), row(own, nodes[2])
        low = (min(a[0], b[0], c[0]) - reach, min(a[1], b[1], c[1]) - reach, min(a[2], b[2], c[2]) - reach)
        high = (max(a[0], b[0], c[0]) + reach, max(a[1], b[1], c[1]) + reach, max(a[2], b[2], c[2]) + reach)
        hits, level, block = 0, top, np.int64(0)
        _meets(boxes, first[level], low, high, meets)
        met = all_of[0]
        while True:
            if met == 0:
                if level == top:
                    break
                level += 1
                met, block = left[level], at[level]
                continue
            lane = np.int64(((met & (~met + one)) * np.uint64(_LOWEST)) >> np.uint64(56))
            met &= met - one
            if level > 0:
                below = LEAF * block + lane
                if (below + 1) << (3 * (level - 1)) > begin:
                    left[level], at[level] = met, block
                    level, block = level - 1, below
                    _meets(boxes, first[level] + block, low, high, meets)
                    met = all_of[0]
            else:
                slot = (block * count >> halvings) + lane
                if slot > slot_before:
                    item = order[slot]
                    if not _share(twins, row(item_twins, item)) and _within(kind, reach, nodes, row(item_nodes, item), own, theirs):
                        hits += 1
                        _record(found, place, hits, item)
        found[place, 0] = hits


@entry
@parallel_kernel
def _near(kind, reach, queries, items, blocks, positions, rows, found):  # type: ignore[no-untyped-def]
    """For each query element of `rows` (of edges among themselves: for each slot of the tree) the items within reach, rising: found (R,1+K), first their
    number. A number above K says that it overflowed."""
    for chunk in prange(CHUNKS):
        _near_of(chunk_range(chunk, len(rows)), (kind, reach), (queries, items), blocks, positions, rows, found)


def blocks_of(tree: Tree, elements: Elements, positions: np.ndarray) -> Blocks:
    """Blocks of a tree over these elements, of at most LEAF a leaf, at positions (P,3) of their nodes. The boxes of the tree itself may be old."""
    sizes = [len(tree.boxes) // 2]
    while sizes[-1] > 1:
        sizes.append(-(-sizes[-1] // LEAF))
    first = np.cumsum([0, *sizes])
    blocks = Blocks(tree.order, first, np.empty(first[-1] * 6 * LEAF, dtype=np.float32))
    _write_blocks(blocks, elements.nodes, positions)
    return blocks


def near_pairs(kind: int, reach: float, queries: Elements, items: Elements, blocks: Blocks, positions: tuple[np.ndarray, np.ndarray]) -> np.ndarray:
    """All pairs (query, item) (K,2) int32 within `reach` that share no identity, in rising order.

    kind: POINT_TRIANGLE, TRIANGLE_POINT (queries are named first), EDGE_EDGE, or EDGE_EDGE_ONCE for edges among themselves, each pair once;
    positions: of the queries' nodes and of the items' nodes, m, as is reach; blocks: over the items, where they are.
    """
    parts = []
    for begin in range(0, len(queries.nodes), _QUERIES):
        rows, width = np.arange(begin, min(begin + _QUERIES, len(queries.nodes)), dtype=np.int32), _WIDTH
        while len(rows):
            found = np.empty((len(rows), 1 + width), dtype=np.int32)
            _near(kind, reach, queries, items, blocks, positions, rows, found)
            counts = found[:, 0]
            kept = np.flatnonzero((counts > 0) & (counts <= width))
            filled = np.arange(width) < counts[kept, None]
            parts.append(np.stack([np.repeat(rows[kept], counts[kept]), found[kept, 1:][filled]], axis=1))
            rows, width = rows[counts > width], int(counts.max())
    pairs = np.concatenate(parts) if parts else np.zeros((0, 2), dtype=np.int32)
    if kind == EDGE_EDGE_ONCE:
        pairs[:, 0] = blocks.order[pairs[:, 0]]
        pairs.sort(axis=1)
        return indices(pairs[np.lexsort((pairs[:, 1], pairs[:, 0]))])
    return indices(pairs[np.lexsort((pairs[:, 1], pairs[:, 0]))] if len(parts) > 1 else pairs)
