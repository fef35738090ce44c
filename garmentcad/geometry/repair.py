"""Repair of scanned surfaces: stray pieces and double faces go, faces are turned alike, holes are closed. What was done is said, nothing is guessed."""

from __future__ import annotations

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import breadth_first_order, connected_components

STRAY = 0.05  # of all faces, up to which separate pieces are strays
FILLED = 0.05  # of the surface's area, up to which one hole is closed: the soles of both feet are 3 % of a body


def repaired(vertices: np.ndarray, faces: np.ndarray) -> tuple[np.ndarray, np.ndarray, tuple[str, ...]]:
    """A surface of vertices (V,3) and faces (F,3) as far as it can be repaired without guessing, and a sentence for each thing that was done.

    Holes get a vertex in their middle and a fan of faces around it. Larger holes, edges with more than two faces and surfaces with one side stay as they are.
    """
    notes: list[str] = []
    for step in (_without_doubles, _without_strays, _turned_alike):
        faces, note = step(len(vertices), faces)
        notes += note
    vertices, faces, note = _closed(vertices, faces)
    used, packed = np.unique(faces, return_inverse=True)
    return vertices[used], packed.reshape(-1, 3), tuple(notes + note)


def _without_doubles(count: int, faces: np.ndarray) -> tuple[np.ndarray, list[str]]:
    _, first = np.unique(np.sort(faces, axis=1), axis=0, return_index=True)
    gone = len(faces) - len(first)
    return faces[np.sort(first)], [f"{gone} faces lay on others and were left out"] if gone else []


def _without_strays(count: int, faces: np.ndarray) -> tuple[np.ndarray, list[str]]:
    half = _half_edges(faces)
    graph = coo_array((np.ones(len(half), dtype=bool), (half[:, 0], half[:, 1])), shape=(count, count))
    piece = connected_components(graph, directed=False)[1][faces[:, 0]]
    size = np.bincount(piece)
    main, others = int(size.argmax()), int((size > 0).sum()) - 1
    stray = len(faces) - int(size[main])
    if others == 0 or stray > STRAY * len(faces):
        return faces, []
    return faces[piece == main], [f"{others} separate pieces with {stray} faces were left out"]


def _turned_alike(count: int, faces: np.ndarray) -> tuple[np.ndarray, list[str]]:
    """Neighbours run along their edge in opposite directions; the side that most faces show stays."""
    half = _half_edges(faces)
    face, low_first = np.tile(np.arange(len(faces)), 3), half[:, 0] < half[:, 1]
    order = np.lexsort((half.max(axis=1), half.min(axis=1)))
    edge = np.sort(half, axis=1)[order]
    second = np.flatnonzero((edge[1:] == edge[:-1]).all(axis=1)) + 1
    a, b = order[second - 1], order[second]
    unlike = low_first[a] == low_first[b]  # both run the same way: one of them is turned
    if not unlike.any():
        return faces, []
    ends = np.concatenate([face[a], face[b]]), np.concatenate([face[b], face[a]])
    differs = {(i, j): bool(k) for i, j, k in zip(*ends, np.tile(unlike, 2))}
    graph = coo_array((np.ones(len(ends[0]), dtype=np.int8), ends), shape=(len(faces), len(faces))).tocsr()
    turned = np.zeros(len(faces), dtype=bool)
    seen = np.zeros(len(faces), dtype=bool)
    while not seen.all():
        walk, before = breadth_first_order(graph, int(np.argmin(seen)), directed=False)
        for here in walk[1:]:
            turned[here] = turned[before[here]] ^ differs[before[here], here]
        seen[walk] = True
        if turned[walk].sum() > 0.5 * len(walk):
            turned[walk] = ~turned[walk]
    return np.where(turned[:, None], faces[:, ::-1], faces), [f"{int(turned.sum())} faces were turned around"]


def _closed(vertices: np.ndarray, faces: np.ndarray) -> tuple[np.ndarray, np.ndarray, list[str]]:
    half = _half_edges(faces).astype(np.int64)
    there, back = half[:, 0] * len(vertices) + half[:, 1], half[:, 1] * len(vertices) + half[:, 0]
    after: dict[int, int] = {}
    for a, b in half[~np.isin(back, there)].tolist():
        if a in after:
            return vertices, faces, []  # two holes meet in a vertex: which rim goes on where would be guessed
        after[a] = b
    whole = float(_areas(vertices, faces).sum())
    added: list[np.ndarray] = []
    middles: list[np.ndarray] = []
    notes: list[str] = []
    while after:
        start, loop = next(iter(after)), []
        here = start
        while here in after:
            loop.append(here)
            here = after.pop(here)
        if here != start:
            return vertices, faces, []
        rim, number = vertices[loop], len(vertices) + len(middles)
        middle = rim.mean(axis=0)
        fan = np.array([[b, a, number] for a, b in zip(loop, loop[1:] + loop[:1])])
        area = float(_areas(np.vstack([rim, middle]), np.array([[(k + 1) % len(loop), k, len(loop)] for k in range(len(loop))])).sum())
        if area > FILLED * whole:
            return vertices, faces, []
        added.append(fan)
        middles.append(middle)
        notes.append(f"a hole of {len(loop)} edges and {100.0 * area / whole:.2f} % of the surface was closed")
    if not added:
        return vertices, faces, []
    return np.vstack([vertices, *middles]), np.vstack([faces, *added]), notes


def _half_edges(faces: np.ndarray) -> np.ndarray:
    return np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])


def _areas(vertices: np.ndarray, faces: np.ndarray) -> np.ndarray:
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    return np.asarray(0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1))
