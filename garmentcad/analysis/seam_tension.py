"""Tension across seams: how strongly each panel pulls on the threads that join it to the other.

Take the sewn garment apart in thought, every panel in its draped shape. On each vertex of a sewn edge the elements of its own panel then leave a force f that
the seam holds: at rest f_a + f_b = 0 but for what touches the sewn particle and the stiffness of the seam itself. So the seam carries

    F = (f_a - f_b) / 2

at each stitch, divided by the rest length that the stitch stands for (the mean of both sides; of gathers the shorter one, which they are drawn into). Its
part across the seam, positive where it pulls the panels apart, is the tension; its part along the seam is the shear that makes a seam slip or pucker.
Across is the mean way from one panel into the other over a few stitches: where cloth lies in ridges along its seam, single stitches pull out of it this way
and that, several times as hard as all of them together.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.ndimage import uniform_filter1d

from garmentcad.cloth.cloth import Cloth
from garmentcad.cloth.gathers import EASED
from garmentcad.pattern.pattern import Pattern
from garmentcad.pattern.runs import side_length
from garmentcad.units import MM_TO_M

_AROUND = 4  # stitches before and after one, over which the way across is the mean
_LONGEST_STEP = 1.01  # of the lattice spacing: neighbours on an outline lie no farther apart


@dataclass(frozen=True)
class SeamTension:
    """Of one seam: length_mm on the pattern, N/m across it (mean over its stitches and the largest one), and N/m along it (mean of the amounts)."""

    length_mm: float
    mean_n_m: float
    max_n_m: float
    along_n_m: float


def seam_lengths(pattern: Pattern) -> dict[str, float]:
    """Length of every seam by name, mm: the mean of both sides, of gathers the shorter one; of a zip that of its closed part."""
    closed = {seam.name: 1.0 if seam.closed is None else seam.closed for seam in pattern.seams}
    return {seam.name: closed[seam.name] * float(_sewn(*(side_length(pattern, side) for side in (seam.a, seam.b)))) for seam in pattern.seams}


def seam_tension(flat: Cloth, positions: np.ndarray, forces: np.ndarray, lengths_mm: Mapping[str, float]) -> dict[str, SeamTension | None]:
    """Tension of every seam by name; None for a seam that has no stitch of its own.

    flat: the cloth before welding, whose particles are its vertices; positions (V,3) m, forces (V,3) N: where each vertex lies in the garment and the internal
    forces of its own panel and its weight; lengths_mm: `seam_lengths`. Stitches that share a vertex are left out of the tension, as where seams meet: its
    force belongs to all of them.
    """
    inward = _inward(flat, positions)
    shared = np.bincount(flat.stitches.ravel(), minlength=len(positions)) > 1
    found: dict[str, SeamTension | None] = {}
    for number, name in enumerate(flat.seam_names):
        a, b = flat.stitches[flat.stitch_seam == number].T
        length, way = _lengths_and_ways(flat, a, b, 0.5 * (positions[a] + positions[b]))
        counted = ~(shared[a] | shared[b]) & (length > 0.0)
        if not counted.any():
            found[name] = None
            continue
        pull = 0.5 * (forces[a] - forces[b])
        along = (pull * way).sum(axis=1)
        mean_way, apart = (uniform_filter1d(ways, 2 * _AROUND + 1, axis=0, mode="nearest") for ways in (way, inward[a] - inward[b]))
        mean_way = _unit(mean_way)
        across = _unit(apart - (apart * mean_way).sum(axis=1, keepdims=True) * mean_way)
        opening = (pull * across).sum(axis=1)
        total = float(length[counted].sum())
        found[name] = SeamTension(
            lengths_mm[name],
            float(opening[counted].sum()) / total,
            float((opening[counted] / length[counted]).max()),
            float(np.abs(along[counted]).sum()) / total,
        )
    return found


def _inward(flat: Cloth, positions: np.ndarray) -> np.ndarray:
    """(V,3) from each vertex to the middle of the triangles around it."""
    middle = np.repeat(positions[flat.triangles].mean(axis=1), 3, axis=0)
    corners = flat.triangles.ravel()
    count = np.bincount(corners, minlength=len(positions)).clip(1)
    sums = np.column_stack([np.bincount(corners, middle[:, axis], len(positions)) for axis in range(3)])
    return np.asarray(sums / count[:, None] - positions)


def _lengths_and_ways(flat: Cloth, a: np.ndarray, b: np.ndarray, middle: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Rest length (S,) m that each stitch of a seam stands for, half the way to the stitches before and after it, and its unit direction (S,3) in space."""
    steps = []
    for vertices in (a, b):
        one, other = vertices[:-1], vertices[1:]
        step = MM_TO_M * np.linalg.norm(flat.vertex_uv_mm[other] - flat.vertex_uv_mm[one], axis=1)
        # a side that goes on in another panel, or elsewhere on the outline, has no length there
        joined = (flat.vertex_panel[one] == flat.vertex_panel[other]) & (step < _LONGEST_STEP * flat.spacing)
        steps.append(np.where(joined, step, 0.0))
    step = np.where(np.minimum(*steps) > 0.0, _sewn(*steps), np.maximum(*steps))
    length = 0.5 * (np.append(step, 0.0) + np.append(0.0, step))
    return length, _unit(np.gradient(middle, axis=0) if len(a) > 1 else np.zeros((len(a), 3)))


def _sewn(one: ArrayLike, other: ArrayLike) -> np.ndarray:
    """How long two lengths are once they are sewn to each other: their mean, of gathers the shorter one."""
    shorter, longer = np.minimum(one, other), np.maximum(one, other)
    return np.where(longer > EASED * shorter, shorter, 0.5 * (shorter + longer))


def _unit(vectors: np.ndarray) -> np.ndarray:
    """(N,3), those without length as they are."""
    size = np.linalg.norm(vectors, axis=1, keepdims=True)
    return np.asarray(np.divide(vectors, size, out=np.zeros_like(vectors), where=size > 0.0))
