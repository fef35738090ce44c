"""All elements within reach of others: points and triangles, or edges.

Both sides have a tree of boxes (bvh.py), three levels of which are taken as one: blocks of eight boxes side by side, which a query holds against itself at
once. Level 0 has the elements of each leaf, level 1 the boxes of eight such blocks, and so on up to one block, of level 1 at least. The elements of a leaf walk
down the other tree together, up to its leaves. There each is tested against eight others at once: by their boxes, by whether they share a point, and by a line
along which they may be apart. What is left is measured; nearly all of it is within reach.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import prange

from garmentcad.arrays import CHUNKS, chunk_range, entry, indices, inlined_kernel, kernel, making_kernel, parallel_kernel, row_kernel
from garmentcad.contact.bvh import LEAF, build_tree
from garmentcad.geometry.closest import dot, point_triangle, row, segment_segment

_LOWEST = 0x0001020304050607  # times 256^k its highest byte is k
_EVERY = np.uint64(0x0101010101010101)  # of eight
_MOST_LEVELS = 11  # 8^11 leaves
_SURE = 1.0 + 1e-6  # what is called apart without its distance is so by more than round-off
_WIDTH = 16  # items found per query at the first try; fuller rows are searched again with room for all
_LATELY = 256  # leaves that stay laid out, 170 kB a part of the work; of 128 more had to be laid out twice
_LEAVES = 1 << 12  # of queries at a time, so that the room for what they find is small
POINT_TRIANGLE, TRIANGLE_POINT, EDGE_EDGE, EDGE_EDGE_ONCE = 0, 1, 2, 3


class Elements(NamedTuple):
    """Points (a, a, a), edges (a, b, b) or triangles (a, b, c). identity: who counts as the same point (twins of a seam); elements that share an
    identity never pair. All (N,3) int32."""

    nodes: np.ndarray
    identity: np.ndarray


class Blocks(NamedTuple):
    """A tree for `near_pairs`, with its elements by their places along the leaves. order: (N,) int32 element at each place; nodes, identity: (N,3) int32 of it;
    first (levels+1,) int64: number of the first block of each level, and of all blocks."""

    order: np.ndarray
    nodes: np.ndarray
    identity: np.ndarray
    first: np.ndarray


def blocks_over(elements: Elements, centers: np.ndarray) -> Blocks:
    """Blocks over the elements with these centers (N,D)."""
    tree = build_tree(centers)
    sizes = [len(tree.boxes) // 2]
    while sizes[-1] > 1 or len(sizes) == 1:
        sizes.append(-(-sizes[-1] // LEAF))
    nodes = indices(elements.nodes[tree.order])
    identity = nodes if elements.identity is elements.nodes else indices(elements.identity[tree.order])
    return Blocks(tree.order, nodes, identity, np.cumsum([0, *sizes]))


@inlined_kernel
def _shape(nodes, edge, positions):  # type: ignore[no-untyped-def]
    """Nine numbers of an element: its middle, then of an edge half the way from a to b and one over its square (0 where there is none), of a triangle or a
    point the ways from the middle to its first two corners; to the third one it is minus their sum."""
    a, b, c = row(positions, nodes[0]), row(positions, nodes[1]), row(positions, nodes[2])
    if edge:
        h = (0.5 * (b[0] - a[0]), 0.5 * (b[1] - a[1]), 0.5 * (b[2] - a[2]))
        square = dot(h, h)
        return a[0] + h[0], a[1] + h[1], a[2] + h[2], h[0], h[1], h[2], 1.0 / square if square > 0.0 else 0.0, 0.0, 0.0
    m = ((a[0] + b[0] + c[0]) / 3.0, (a[1] + b[1] + c[1]) / 3.0, (a[2] + b[2] + c[2]) / 3.0)
    return m[0], m[1], m[2], a[0] - m[0], a[1] - m[1], a[2] - m[2], b[0] - m[0], b[1] - m[1], b[2] - m[2]


@kernel
def _lay_out(leaf, slot, edges, items, positions, shapes, twins):  # type: ignore[no-untyped-def]
    """The elements of a leaf side by side: their shapes into shapes[slot] (9,LEAF), and who counts as their points into twins[slot] (3,LEAF)."""
    leaves, count = items.first[1], len(items.nodes)
    begin, end = leaf * count // leaves, (leaf + 1) * count // leaves
    for place in range(begin, end):
        shape, same = _shape(row(items.nodes, place), edges, positions), row(items.identity, place)
        for k in range(9):
            shapes[slot, k, place - begin] = shape[k]
        for k in range(3):
            twins[slot, k, place - begin] = same[k]


@kernel
def _box_leaves(span, items, positions, boxes):  # type: ignore[no-untyped-def]
    leaves, count = items.first[1], len(items.nodes)
    for leaf in range(span[0], span[1]):
        begin, end = leaf * count // leaves, (leaf + 1) * count // leaves
        for lane in range(LEAF):
            for axis in range(3):
                low, high = math.inf, -math.inf
                if begin + lane < end:
                    a, b, c = row(items.nodes, begin + lane)
                    x, y, z = positions[a, axis], positions[b, axis], positions[c, axis]
                    low, high = min(x, y, z), max(x, y, z)
                boxes[(6 * leaf + axis) * LEAF + lane], boxes[(6 * leaf + 3 + axis) * LEAF + lane] = low, high


@kernel
def _box_upper(first, boxes):  # type: ignore[no-untyped-def]
    """Boxes of the levels above the leaves."""
    for level in range(1, len(first) - 1):
        for block in range(first[level], first[level + 1]):
            for lane in range(LEAF):
                below = first[level - 1] + LEAF * (block - first[level]) + lane
                for axis in range(3):
                    low, high = math.inf, -math.inf
                    if below < first[level]:
                        for k in range(LEAF):
                            low, high = min(low, boxes[(6 * below + axis) * LEAF + k]), max(high, boxes[(6 * below + 3 + axis) * LEAF + k])
                    boxes[(6 * block + axis) * LEAF + lane], boxes[(6 * block + 3 + axis) * LEAF + lane] = low, high


@entry
@parallel_kernel
def _box(items, positions, boxes):  # type: ignore[no-untyped-def]
    """Set the boxes of a tree (6 x LEAF x blocks,) float32, m, from the positions (P,3) of its elements' nodes: low and then high corners of eight boxes side
    by side, empty ones where there are fewer."""
    for chunk in prange(CHUNKS):
        _box_leaves(chunk_range(chunk, items.first[1]), items, positions, boxes)
    _box_upper(items.first, boxes)


@row_kernel
def _meet(boxes, block, corners, many, out):  # type: ignore[no-untyped-def]
    """Which boxes of a block meet the boxes corners[:many] (N,6), low and high, into rows of out (N,LEAF) uint8. Rounding keeps the order of two numbers, so
    that none is lost by single precision."""
    # a length that is known only when it runs, or the loop is unrolled and not wide
    lanes = np.uint64(out.shape[1])
    first = np.uint64(6) * lanes * np.uint64(block)
    for n in range(many):
        x, y, z = np.float32(corners[n, 0]), np.float32(corners[n, 1]), np.float32(corners[n, 2])
        u, v, w = np.float32(corners[n, 3]), np.float32(corners[n, 4]), np.float32(corners[n, 5])
        for lane in range(lanes):
            a = first + lane
            b = a + lanes
            c = b + lanes
            d = c + lanes
            e = d + lanes
            out[n, lane] = max(max(max(boxes[a] - u, boxes[b] - v), max(boxes[c] - w, x - boxes[d])), max(y - boxes[e], z - boxes[e + lanes])) <= 0.0


@row_kernel
def _strangers(twins, slot, identity, begin, asked, many, out):  # type: ignore[no-untyped-def]
    """Which elements of a leaf, laid out side by side, have no point in common with the elements begin + asked[:many] of `identity`, into rows of out
    (LEAF,LEAF) uint8. Points (a, a, a) and triangles, or edges (a, b, b): the other three comparisons say nothing new."""
    for n in range(many):
        k = begin + asked[n]
        a, b, c = identity[k, 0], identity[k, 1], identity[k, 2]
        for lane in range(np.uint64(out.shape[1])):
            p, q, r = twins[slot, 0, lane], twins[slot, 1, lane], twins[slot, 2, lane]
            out[n, lane] = (p != a) & (q != a) & (r != a) & (p != b) & (p != c) & (q != b)


@row_kernel
def _not_apart(shapes, slot, own, asked, many, limit, out):  # type: ignore[no-untyped-def]
    """Which triangles or points of a leaf, laid out side by side, are not apart from points or triangles asked[:many] of `own` (LEAF,9), along the line
    through their middles, by more than the root of `limit`; into rows of out (LEAF,LEAF) uint8."""
    for n in range(many):
        k = asked[n]
        a, b, c, d, e, f, g, h, i = own[k, 0], own[k, 1], own[k, 2], own[k, 3], own[k, 4], own[k, 5], own[k, 6], own[k, 7], own[k, 8]
        for lane in range(np.uint64(out.shape[1])):
            x, y, z = shapes[slot, 0, lane] - a, shapes[slot, 1, lane] - b, shapes[slot, 2, lane] - c
            p = x * shapes[slot, 3, lane] + y * shapes[slot, 4, lane] + z * shapes[slot, 5, lane]
            q = x * shapes[slot, 6, lane] + y * shapes[slot, 7, lane] + z * shapes[slot, 8, lane]
            s, t = x * d + y * e + z * f, x * g + y * h + z * i
            square = x * x + y * y + z * z
            room = square - max(max(-p, -q), p + q) - max(max(s, t), -s - t)
            out[n, lane] = not ((room > 0.0) & (room * room > limit * square))


@row_kernel
def _edges_not_apart(shapes, slot, own, asked, many, limit, out):  # type: ignore[no-untyped-def]
    """Which edges of a leaf, laid out side by side, are not apart from the edges asked[:many] of `own` (LEAF,9) by more than the root of `limit`, along the
    line from the middle of those to the closest point of these; into rows of out (LEAF,LEAF) uint8."""
    for n in range(many):
        k = asked[n]
        a, b, c, d, e, f = own[k, 0], own[k, 1], own[k, 2], own[k, 3], own[k, 4], own[k, 5]
        for lane in range(np.uint64(out.shape[1])):
            x, y, z = shapes[slot, 0, lane] - a, shapes[slot, 1, lane] - b, shapes[slot, 2, lane] - c
            u, v, w = shapes[slot, 3, lane], shapes[slot, 4, lane], shapes[slot, 5, lane]
            t = min(max((x * u + y * v + z * w) * shapes[slot, 6, lane], -1.0), 1.0)
            p, q, r = x - t * u, y - t * v, z - t * w
            room = p * x + q * y + r * z - abs(p * d + q * e + r * f) - abs(p * u + q * v + r * w)
            out[n, lane] = not ((room > 0.0) & (room * room > limit * (p * p + q * q + r * r)))


@inlined_kernel
def _narrow(asking, near, many, masks):  # type: ignore[no-untyped-def]
    """Of the elements asking[:many], and the bytes of what each may be near, keep what the masks leave; the number of elements that still may be near any."""
    left = 0
    for n in range(many):
        asking[left], near[left] = asking[n], near[n] & masks[n]
        left += near[left] != 0
    return left


@kernel
def _within(kind, reach, one, other, own, theirs):  # type: ignore[no-untyped-def]
    """Whether two elements are within reach."""
    if kind == POINT_TRIANGLE:
        return point_triangle(row(own, one[0]), row(theirs, other[0]), row(theirs, other[1]), row(theirs, other[2]))[3] <= reach * reach
    if kind == TRIANGLE_POINT:
        return point_triangle(row(theirs, other[0]), row(own, one[0]), row(own, one[1]), row(own, one[2]))[3] <= reach * reach
    return segment_segment(row(own, one[0]), row(own, one[1]), row(theirs, other[0]), row(theirs, other[1]))[2] <= reach * reach


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
    """One number of what `_meet` found for one box, from its halves (2,) uint32. It writes them one after the other, and who reads at once what was written
    in two pieces waits until both are in the cache."""
    return np.uint64(halves[0]) | (np.uint64(halves[1]) << np.uint64(32))


@inlined_kernel
def _lowest(met):  # type: ignore[no-untyped-def]
    """Number of the lowest byte that is 1, in a number of such bytes and zeros."""
    return np.int64(((met & (~met + np.uint64(1))) * np.uint64(_LOWEST)) >> np.uint64(56))


@making_kernel
def _near_of(mine, search, queries, items, boxes, positions, rows, found):  # type: ignore[no-untyped-def]
    (kind, reach), (own, theirs), (leaves, starts) = search, positions, rows
    # By names of their own: here references to arrays are counted wherever a tuple gives one.
    own_nodes, own_twins, item_nodes, order, first = queries.nodes, queries.identity, items.nodes, items.order, items.first
    own_leaves, own_count, item_leaves, item_count = queries.first[1], len(own_nodes), first[1], len(item_nodes)
    top, once, one, edges = len(first) - 2, kind == EDGE_EDGE_ONCE, np.uint64(1), kind in (EDGE_EDGE, EDGE_EDGE_ONCE)
    limit, left, at = _SURE * reach * reach, np.empty(_MOST_LEVELS + 1, dtype=np.uint64), np.empty(_MOST_LEVELS + 1, dtype=np.int64)
    around, corners, own_shapes = np.empty((1, 6)), np.empty((LEAF, 6)), np.empty((LEAF, 9))
    # What is tested, a row for each element that asks, and of those that still do which they are and what they may be near.
    tested, asking, near = np.empty((LEAF, LEAF), dtype=np.uint8), np.empty(LEAF, dtype=np.int64), np.empty(LEAF, dtype=np.uint64)
    # Leaves that were met lately: neighbours meet the same ones.
    shapes, twins, laid_out = np.empty((_LATELY, 9, LEAF)), np.empty((_LATELY, 3, LEAF), dtype=np.int32), np.full(_LATELY, -1)
    masks, halves = tested.view(np.uint64).ravel(), tested.view(np.uint32).ravel()
    for n in range(mine[0], mine[1]):
        leaf, start = leaves[n], starts[n]
        begin, end = leaf * own_count // own_leaves, (leaf + 1) * own_count // own_leaves
        around[0, :3], around[0, 3:] = math.inf, -math.inf
        for k in range(end - begin):
            nodes = row(own_nodes, begin + k)
            a, b, c, shape = row(own, nodes[0]), row(own, nodes[1]), row(own, nodes[2]), _shape(nodes, edges, own)
            for axis in range(3):
                corners[k, axis], corners[k, 3 + axis] = min(a[axis], b[axis], c[axis]) - reach, max(a[axis], b[axis], c[axis]) + reach
                around[0, axis], around[0, 3 + axis] = min(around[0, axis], corners[k, axis]), max(around[0, 3 + axis], corners[k, 3 + axis])
            for i in range(9):
                own_shapes[k, i] = shape[i]
            found[start + k, 0] = 0
        level, block = top, np.int64(0)
        _meet(boxes, first[level], around, 1, tested)
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
                _meet(boxes, first[level] + block, around, 1, tested)
                met = _all_of(halves)
                continue
            first_of_leaf = below * item_count // item_leaves
            # Test after test, each for all elements that it is left to, so that they do not wait for each other.
            many = end - begin
            _meet(boxes, below, corners, many, tested)
            for k in range(many):
                asking[k], near[k] = k, _EVERY
            many = _narrow(asking, near, many, masks)
            if many == 0:
                continue
            slot = below % _LATELY
            if laid_out[slot] != below:
                _lay_out(below, slot, edges, items, theirs, shapes, twins)
                laid_out[slot] = below
            _strangers(twins, slot, own_twins, begin, asking, many, tested)
            many = _narrow(asking, near, many, masks)
            if edges:
                _edges_not_apart(shapes, slot, own_shapes, asking, many, limit, tested)
            else:
                _not_apart(shapes, slot, own_shapes, asking, many, limit, tested)
            many = _narrow(asking, near, many, masks)
            for i in range(many):
                k, inside = asking[i], near[i]
                while inside != 0:
                    place = first_of_leaf + _lowest(inside)
                    inside &= inside - one
                    if once and place <= begin + k:
                        continue
                    if _within(kind, reach, row(own_nodes, begin + k), row(item_nodes, place), own, theirs):
                        found[start + k, 0] += 1
                        _record(found, start + k, found[start + k, 0], order[place])


@entry
@parallel_kernel
def _near(kind, reach, queries, items, boxes, positions, leaves, starts, found):  # type: ignore[no-untyped-def]
    """For each query element of these leaves (L,), by their places from the row starts[n] on, the items within reach, rising: found (R,1+K), first their
    number. A number above K says that it overflowed."""
    for chunk in prange(CHUNKS):
        _near_of(chunk_range(chunk, len(leaves)), (kind, reach), queries, items, boxes, positions, (leaves, starts), found)


@entry
@kernel
def _tally(chosen, bounds, order, found, counts, again):  # type: ignore[no-untyped-def]
    """Numbers that were found for the elements of the chosen leaves into `counts` (N,). Leaves that overflowed go into `again` and found nothing: how many,
    and the largest number."""
    at, many, largest = 0, 0, 0
    for leaf in chosen:
        size, most = bounds[leaf + 1] - bounds[leaf], 0
        for k in range(size):
            most = max(most, found[at + k, 0])
        if most >= found.shape[1]:
            again[many] = leaf
            many, largest = many + 1, max(largest, most)
        for k in range(size):
            if most >= found.shape[1]:
                found[at + k, 0] = 0
            counts[order[bounds[leaf] + k]] = found[at + k, 0]
        at += size
    return many, largest


@entry
@kernel
def _collect(chosen, bounds, order, found, places, out):  # type: ignore[no-untyped-def]
    """Pairs of the elements of the chosen leaves with what was found for them, into out (K,2) from the place of each element on."""
    at = 0
    for leaf in chosen:
        for query in order[bounds[leaf] : bounds[leaf + 1]]:
            for k in range(found[at, 0]):
                out[places[query] + k, 0], out[places[query] + k, 1] = query, found[at, 1 + k]
            at += 1


def near_pairs(kind: int, reach: float, queries: Blocks, items: Blocks, positions: tuple[np.ndarray, np.ndarray]) -> np.ndarray:
    """All pairs (query, item) (K,2) int32 within `reach` that share no identity, in rising order.

    kind: POINT_TRIANGLE, TRIANGLE_POINT (queries are named first), EDGE_EDGE, or EDGE_EDGE_ONCE for edges among themselves, each pair once; positions: (P,3) of
    the queries' nodes and of the items' nodes, m, as is reach.
    """
    count, leaves, parts = len(queries.order), int(queries.first[1]), []
    if not count or not len(items.order):
        return np.empty((0, 2), dtype=np.int32)
    boxes = np.empty(items.first[-1] * 6 * LEAF, dtype=np.float32)
    _box(items, positions[1], boxes)
    bounds, counts = np.arange(leaves + 1) * count // leaves, np.zeros(count, dtype=np.int64)
    for begin in range(0, leaves, _LEAVES):
        chosen, width = np.arange(begin, min(begin + _LEAVES, leaves)), _WIDTH
        while len(chosen):
            starts = np.append(0, np.cumsum(bounds[chosen + 1] - bounds[chosen]))
            found = np.empty((starts[-1], 1 + width), dtype=np.int32)
            _near(kind, reach, queries, items, boxes, positions, chosen, starts, found)
            again = np.empty_like(chosen)
            many, width = _tally(chosen, bounds, queries.order, found, counts, again)
            parts.append((chosen, found))
            chosen = again[:many]
    pairs, places = np.empty((int(counts.sum()), 2), dtype=np.int32), np.cumsum(counts) - counts
    for chosen, found in parts:
        _collect(chosen, bounds, queries.order, found, places, pairs)
    if kind == EDGE_EDGE_ONCE:
        low, high = np.divmod(np.sort(pairs.min(axis=1) * np.int64(count) + pairs.max(axis=1)), count)
        return indices(np.column_stack([low, high]))
    return pairs
