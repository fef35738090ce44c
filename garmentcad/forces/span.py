"""Contour spans: what keeps a contour free of saw teeth between the bend lines.

    d = sum_i c_i x_i,   E = k (d.d - (d.e)^2)/2   [J],   k = B_n/(8 l^2)   [N/m],   e along x_c - x_b
    B_n = B_warp c^4 + B_weft s^4 + 4 D66 c^2 s^2,  c cosine between contour and warp,  l mean distance of the four points

c_i are the spans' coefficients (cloth/contour_spans.py); d vanishes under rigid motion, uniform strain and, to first order, constant curvature along the
contour, so that the bending energy of smooth shapes stays that of the bend lines. What is left of d on an arc that turns by t a point, t^2 l, lies along the
middle side, by symmetry, and does not count. (With it a 20 cm strip at 10 mm bent to 1.5 /cm was 3.4 % too stiff.) A saw tooth of height a costs
4 B_n a^2/l^2 at each point, as much as a bend line of width l/2 there would. Source: finite differences; the orthotropic plate turned to the contour (PHYSICS:
B at angle t).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from garmentcad.arrays import entry, indices, kernel, making_kernel
from garmentcad.cloth.cloth import Cloth
from garmentcad.fabric.material import MaterialTable, bending_along
from garmentcad.forces.force import OneLaw
from garmentcad.forces.rows import PART

SHORTEST = 1e-2  # of the mean distance: a shorter middle side counts as so long


class SpanElements(NamedTuple):
    corners: np.ndarray  # (N,4) int32
    coefficients: np.ndarray  # (N,4)
    least: np.ndarray  # (N,) m2, floor of the squared length of the middle side
    stiffness: np.ndarray  # (N,) k, N/m


@making_kernel
def span_part(part, spans, positions, out):  # type: ignore[no-untyped-def]
    x, first = positions, part * PART
    left, side = np.empty(3), np.empty(3)
    for i in range(first, min(len(spans.stiffness), first + PART)):
        a, b, c, d = spans.corners[i, 0], spans.corners[i, 1], spans.corners[i, 2], spans.corners[i, 3]
        ca, cb, cc, cd = spans.coefficients[i, 0], spans.coefficients[i, 1], spans.coefficients[i, 2], spans.coefficients[i, 3]
        square = along = 0.0
        for axis in range(3):
            # the coefficients sum up to 0, so differences are enough (and are exact far from the origin)
            left[axis] = cb * (x[b, axis] - x[a, axis]) + cc * (x[c, axis] - x[a, axis]) + cd * (x[d, axis] - x[a, axis])
            side[axis] = x[c, axis] - x[b, axis]
            square += side[axis] * side[axis]
            along += left[axis] * side[axis]
        along /= max(square, spans.least[i])  # in sides
        scale = -spans.stiffness[i]
        for axis in range(3):
            pull = scale * (left[axis] - along * side[axis])
            turn = along * pull  # the side turns toward d
            out[4 * i, axis], out[4 * i + 1, axis], out[4 * i + 2, axis], out[4 * i + 3, axis] = ca * pull, cb * pull + turn, cc * pull - turn, cd * pull


@entry
@kernel
def write_span(spans, positions, velocities, out):  # type: ignore[no-untyped-def]
    """Forces on the corners of span i into out[4 i] to out[4 i + 3]."""
    for part in range(-(-len(spans.stiffness) // PART)):
        span_part(part, spans, positions, out)


class ForceSpan(OneLaw):
    """Contour spans of `cloth`."""

    name = "span"

    def __init__(self, cloth: Cloth, materials: MaterialTable) -> None:
        spans = cloth.spans
        stiffness = bending_along(materials, spans.material, spans.along_warp) / (8.0 * spans.length**2)
        self._spans = SpanElements(np.array(spans.corners), np.array(spans.coefficients), (SHORTEST * spans.length) ** 2, stiffness)
        self.arguments = (self._spans,)
        self.corners = indices(spans.corners).ravel()

    def write_forces(self, positions: np.ndarray, velocities: np.ndarray, out: np.ndarray, sliders: np.ndarray | None = None) -> None:
        write_span(*self.arguments, positions, velocities, out)

    def _left_and_along(self, positions: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """d (N,3), the middle side (N,3), and d along it in sides (N,)."""
        left = np.einsum("ni,nik->nk", self._spans.coefficients, positions[self._spans.corners])
        side = positions[self._spans.corners[:, 2]] - positions[self._spans.corners[:, 1]]
        return left, side, np.sum(left * side, axis=1) / np.maximum(np.sum(side**2, axis=1), self._spans.least)

    def energy(self, positions: np.ndarray, sliders: np.ndarray | None = None) -> float:
        left, side, along = self._left_and_along(positions)
        return float(np.sum(0.5 * self._spans.stiffness * np.sum((left - along[:, None] * side) ** 2, axis=1)))

    def write_stiffness_across(self, positions: np.ndarray, out: np.ndarray) -> None:
        self.write_stiffness(positions, out)

    def write_stiffness(self, positions: np.ndarray, out: np.ndarray) -> None:
        # |d(across)/dx_i| <= |c_i|, at the middle points and |d|/|side| more; a further factor covers the curvature of the side's direction
        left, side, _ = self._left_and_along(positions)
        reach = np.linalg.norm(left, axis=1) / np.sqrt(np.maximum(np.sum(side**2, axis=1), self._spans.least))
        size = np.abs(self._spans.coefficients) + reach[:, None] * np.array([0.0, 1.0, 1.0, 0.0])
        out[:] = (self._spans.stiffness[:, None] * size * (size + reach[:, None]).sum(axis=1, keepdims=True)).ravel()
