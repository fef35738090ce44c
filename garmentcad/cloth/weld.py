"""Welding: the stitched particles of a cloth become one, and the sew lines get hinges."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace
from itertools import combinations
from typing import NamedTuple

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from garmentcad.arrays import floats, frozen, indices
from garmentcad.cloth.cloth import Cloth, Hinges
from garmentcad.cloth.gathers import gathered
from garmentcad.cloth.hinges import made_hinges
from garmentcad.errors import SpecError
from garmentcad.units import M_TO_MM


def welded_particles(cloth: Cloth) -> np.ndarray:
    """(P,) int32: the particle that each particle becomes when all stitches close."""
    return joined_particles(cloth.stitches, cloth.particle_count)


def joined_particles(stitches: np.ndarray, count: int) -> np.ndarray:
    """(P,) int32: what each of `count` particles becomes when stitches (S,2) close, chains of stitches included. Numbered by their first particle."""
    graph = coo_array((np.ones(len(stitches), dtype=np.int8), (stitches[:, 0], stitches[:, 1])), shape=(count, count))
    _, label = connected_components(graph, directed=False)
    _, first = np.unique(label, return_index=True)
    rank = np.empty(len(first), dtype=np.int32)
    rank[np.argsort(first)] = np.arange(len(first))
    return frozen(indices(rank[label]))


def weld(cloth: Cloth) -> tuple[Cloth, np.ndarray]:
    """The cloth with every stitch closed, and the map (P,) int32 from old particles to new ones.

    Cloth without stitches is returned itself. Masses add up, elements keep their rest values but where cloth is gathered (gathers.py), and each stretch of sew
    line between two border triangles becomes a hinge. Raises SpecError when two corners of one element would become one particle: the panel is so narrow there
    that its mesh joins both sides of the seam.
    """
    particle = welded_particles(cloth)
    if len(cloth.stitches) == 0:
        return cloth, particle
    _refuse_collapse(cloth, particle)
    sewn = _sewn_edges(cloth, particle)
    made = made_hinges(cloth.border, sewn.ends, sewn.row, sewn.corner, cloth.seam_fold[sewn.seam], cloth.seam_bend_factor[sewn.seam])
    made = made._replace(corners=indices(particle[made.corners]))
    old = cloth.hinges._replace(corners=particle[cloth.hinges.corners])
    bends = cloth.bends
    welded = replace(
        cloth,
        vertex_particle=frozen(indices(particle[cloth.vertex_particle])),
        masses=frozen(floats(np.bincount(particle, weights=cloth.masses))),
        links=cloth.links._replace(ends=frozen(particle[cloth.links.ends])),
        cells=cloth.cells._replace(corners=frozen(particle[cloth.cells.corners])),
        border=gathered(cloth.border, sewn.row, sewn.corner)._replace(corners=frozen(particle[cloth.border.corners])),
        bends=bends._replace(center=frozen(particle[bends.center]), arm_a=frozen(particle[bends.arm_a]), arm_b=frozen(particle[bends.arm_b])),
        spans=cloth.spans._replace(corners=frozen(particle[cloth.spans.corners])),
        hinges=Hinges(*(frozen(np.concatenate(pair)) for pair in zip(old, made))),
        stitches=frozen(cloth.stitches[:0]),
        stitch_seam=frozen(cloth.stitch_seam[:0]),
    )
    return welded, particle


def weld_seams(cloth: Cloth, names: Collection[str]) -> tuple[Cloth, np.ndarray]:
    """As `weld`, but only the seams called `names`; the others stay to be sewn."""
    mine = np.isin(cloth.stitch_seam, [k for k, name in enumerate(cloth.seam_names) if name in names])
    welded, particle = weld(replace(cloth, stitches=cloth.stitches[mine], stitch_seam=cloth.stitch_seam[mine]))
    return replace(welded, stitches=frozen(indices(particle[cloth.stitches[~mine]])), stitch_seam=frozen(indices(cloth.stitch_seam[~mine]))), particle


def _refuse_collapse(cloth: Cloth, particle: np.ndarray) -> None:
    corners = particle[cloth.particle_triangles]
    flat = np.flatnonzero((corners == np.roll(corners, 1, axis=1)).any(axis=1))
    if len(flat) == 0:
        return
    vertices = cloth.triangles[flat[0]]
    panel = cloth.panel_names[cloth.vertex_panel[vertices[0]]]
    u, v = cloth.vertex_uv_mm[vertices].mean(axis=0)
    touched = np.isin(cloth.stitches, cloth.vertex_particle[vertices]).any(axis=1)
    seams = ", ".join(sorted({cloth.seam_names[seam] for seam in cloth.stitch_seam[touched]}))
    text = f"seam {seams} sews two corners of the same triangle together near ({u:.1f}, {v:.1f}) mm ({len(flat)} such places in all)"
    raise SpecError(f"{text}; the panel is too narrow there for a grid of {cloth.spacing * M_TO_MM:g} mm: use a smaller grid", key=f"panels.{panel}")


class _SewnEdges(NamedTuple):
    """Pairs of border triangles whose contour edges become one, side a first."""

    ends: np.ndarray  # (H,2) particles of side a's edge, in the direction of its outline: the wing of side a lies to its left on the right side of the fabric
    row: np.ndarray  # (H,2) triangles
    corner: np.ndarray  # (H,2) of each triangle that does not lie on the edge
    seam: np.ndarray  # (H,)


def _sewn_edges(cloth: Cloth, particle: np.ndarray) -> _SewnEdges:
    """Of a cloth whose particles (P,) become `particle` (see `welded_particles`)."""
    border = cloth.border
    ends = np.concatenate([border.corners[:, [k, (k + 1) % 3]] for k in range(3)])
    triangle = np.tile(np.arange(len(border.corners)), 3)
    wing = np.repeat([2, 0, 1], len(border.corners))
    before, after = (_edge_groups(numbers) for numbers in (ends, particle[ends]))
    alone = np.bincount(before)[before] == 1  # inner edges are shared before welding, lattice edges stay alone
    candidates = np.flatnonzero(alone)
    candidates = candidates[np.argsort(after[candidates], kind="stable")]
    _, start, size = np.unique(after[candidates], return_index=True, return_counts=True)
    # Of layers that are caught in one seam those pairs count that stitches join.
    several = [(start[size == many], pair) for many in np.unique(size[size > 1]).tolist() for pair in combinations(range(many), 2)]
    pairs = np.concatenate([np.empty((0, 2), candidates.dtype), *(candidates[first[:, None] + pair] for first, pair in several)])
    seam, first_is_a = _seam_of(cloth, particle, ends, pairs)
    pairs, seam = np.where(first_is_a[:, None], pairs, pairs[:, ::-1])[seam >= 0], seam[seam >= 0]
    order = np.lexsort((ends[pairs[:, 0], 0], seam)) if len(pairs) else np.arange(0)
    pairs, seam = pairs[order], seam[order]
    return _SewnEdges(ends[pairs[:, 0]], triangle[pairs], wing[pairs], seam)


def _edge_groups(ends: np.ndarray) -> np.ndarray:
    """(E,) the same number for edges with the same two ends."""
    key = ends.min(axis=1).astype(np.int64) * (int(ends.max(initial=0)) + 1) + ends.max(axis=1)
    return np.unique(key, return_inverse=True)[1]


def _seam_of(cloth: Cloth, particle: np.ndarray, ends: np.ndarray, pairs: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """For each pair of edges (H,2): the seam that sews it, -1 for none, and whether the first edge lies on side a."""
    count = cloth.particle_count
    key = cloth.stitches[:, 0].astype(np.int64) * count + cloth.stitches[:, 1]
    order = np.argsort(key, kind="stable")
    seam, first_is_a = np.full(len(pairs), -1), np.ones(len(pairs), dtype=bool)
    if len(key) == 0:
        return seam, first_is_a
    one, two = ends[pairs[:, 0]], ends[pairs[:, 1]]
    same_way = particle[one[:, 0]] == particle[two[:, 0]]
    two = np.where(same_way[:, None], two, two[:, ::-1])
    for end in (0, 1):
        for a, b, is_a in ((one, two, True), (two, one, False)):
            wanted = a[:, end].astype(np.int64) * count + b[:, end]
            place = np.minimum(np.searchsorted(key[order], wanted), len(key) - 1)
            hit = (key[order][place] == wanted) & (seam < 0)
            seam[hit], first_is_a[hit] = cloth.stitch_seam[order][place][hit], is_a
    return seam, first_is_a
