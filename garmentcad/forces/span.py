"""Contour spans: what keeps a contour free of saw teeth between the bend lines.

    d = sum_i c_i x_i,   E = k d.d/2   [J],   k = B_n/(8 l^2)   [N/m]
    B_n = B_warp c^4 + B_weft s^4 + 4 D66 c^2 s^2,  c cosine between contour and warp,  l mean distance of the four points

c_i are the spans' coefficients (cloth/contour_spans.py); d vanishes under rigid motion, uniform strain and constant curvature along the contour, so that the
bending energy of smooth shapes stays that of the bend lines. A saw tooth of height a costs 4 B_n a^2/l^2 at each point, as much as a bend line of width
l/2 there would. Source: finite differences; the orthotropic plate turned to the contour (PHYSICS: B at angle t).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from garmentcad.arrays import indices, kernel
from garmentcad.cloth.cloth import Cloth
from garmentcad.fabric.material import MaterialTable, bending_along
from garmentcad.forces.force import OneLaw
from garmentcad.forces.rows import PART


class SpanElements(NamedTuple):
    corners: np.ndarray  # (N,4) int32
    coefficients: np.ndarray  # (N,4)
    stiffness: np.ndarray  # (N,) k, N/m


@kernel
def span_part(part, spans, positions, out):  # type: ignore[no-untyped-def]
    x, first = positions, part * PART
    for i in range(first, min(len(spans.stiffness), first + PART)):
        a, b, c, d = spans.corners[i, 0], spans.corners[i, 1], spans.corners[i, 2], spans.corners[i, 3]
        ca, cb, cc, cd = spans.coefficients[i, 0], spans.coefficients[i, 1], spans.coefficients[i, 2], spans.coefficients[i, 3]
        scale = -spans.stiffness[i]
        for axis in range(3):
            # the coefficients sum up to 0, so differences are enough (and are exact far from the origin)
            pull = scale * (cb * (x[b, axis] - x[a, axis]) + cc * (x[c, axis] - x[a, axis]) + cd * (x[d, axis] - x[a, axis]))
            out[4 * i, axis], out[4 * i + 1, axis], out[4 * i + 2, axis], out[4 * i + 3, axis] = ca * pull, cb * pull, cc * pull, cd * pull


@kernel
def write_span(spans, positions, velocities, out):  # type: ignore[no-untyped-def]
    """Forces on the corners of span i into out[4 i] to out[4 i + 3]."""
    for part in range(-(-len(spans.stiffness) // PART)):
        span_part(np.int64(part), spans, positions, out)


class ForceSpan(OneLaw):
    """Contour spans of `cloth`."""

    name = "span"

    def __init__(self, cloth: Cloth, materials: MaterialTable) -> None:
        spans = cloth.spans
        stiffness = bending_along(materials, spans.material, spans.along_warp) / (8.0 * spans.length**2)
        self._spans = SpanElements(np.array(spans.corners), np.array(spans.coefficients), stiffness)
        self.arguments = (self._spans,)
        self.corners = indices(spans.corners).ravel()

    def write_forces(self, positions: np.ndarray, velocities: np.ndarray, out: np.ndarray, sliders: np.ndarray | None = None) -> None:
        write_span(*self.arguments, positions, velocities, out)

    def energy(self, positions: np.ndarray, sliders: np.ndarray | None = None) -> float:
        left = np.einsum("ni,nik->nk", self._spans.coefficients, positions[self._spans.corners])
        return float(np.sum(0.5 * self._spans.stiffness * np.sum(left**2, axis=1)))

    def write_stiffness(self, positions: np.ndarray, out: np.ndarray) -> None:
        size = np.abs(self._spans.coefficients)
        out[:] = (self._spans.stiffness[:, None] * size * size.sum(axis=1, keepdims=True)).ravel()
