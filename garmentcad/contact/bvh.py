"""Tree of axis-aligned boxes over points, edges or triangles: build once, refit when they move.

The tree is a complete binary tree in heap order (root 1, children 2i and 2i + 1), so that it needs no pointers and a walk needs no stack: after a
subtree comes node + 1 without its trailing zero bits, and a walk that arrives at 1 is done. Leaf j of n_leaves holds the elements
order[j n // n_leaves : (j + 1) n // n_leaves].
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from garmentcad.arrays import entry, floats, indices, kernel

LEAF = 8  # elements in a leaf, at most


class Tree(NamedTuple):
    """order: (N,) int32 elements along the leaves. boxes: (2 n_leaves, 6) low and high corners of the nodes; row 0 is unused."""

    order: np.ndarray
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
