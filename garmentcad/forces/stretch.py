"""Stretch and repel: tension along warp and weft in the lattice links.

    E = w l0 f(e)   [J]      e = |x_b - x_a|/l0 - 1
    F = w (T(e) + tau k de/dt)   [N] along the link

T [N/m] is the tensile curve of the sheet and f [J/m2] its integral (fabric/law_tension.py), w the tributary width, l0 the rest length. Damping acts on the
strain rate alone, with the initial slope k of the curve: when a link stiffens its damping ratio falls, so that damping never costs time step.
Source: KES-FB1 curve; pairs of lattice neighbours after Provot (1995).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import prange

from garmentcad.arrays import CHUNKS, chunk_range, indices, kernel, parallel_kernel
from garmentcad.cloth.cloth import Cloth
from garmentcad.fabric.law_tension import tension
from garmentcad.fabric.material import MaterialTable
from garmentcad.forces.tension_curves import tension_at, tension_curves


class StretchElements(NamedTuple):
    ends: np.ndarray  # (L,2) int32
    rest_length: np.ndarray  # (L,) m
    inverse_rest: np.ndarray  # (L,) 1/m
    width: np.ndarray  # (L,) m
    curve: np.ndarray  # (L,) int32 row of the tension curves


@kernel
def _stretch_of(items, links, curves, damping_time, positions, velocities, out):  # type: ignore[no-untyped-def]
    for i in range(items[0], items[1]):
        a, b = links.ends[i, 0], links.ends[i, 1]
        dx = positions[b, 0] - positions[a, 0]
        dy = positions[b, 1] - positions[a, 1]
        dz = positions[b, 2] - positions[a, 2]
        length = math.sqrt(dx * dx + dy * dy + dz * dz)
        scale = 0.0
        if length > 0.0:
            c = links.curve[i]
            inverse = 1.0 / length
            inverse_rest = links.inverse_rest[i]
            slope = curves.slope[c]
            stretch = (velocities[b, 0] - velocities[a, 0]) * dx + (velocities[b, 1] - velocities[a, 1]) * dy + (velocities[b, 2] - velocities[a, 2]) * dz
            force = tension((length - links.rest_length[i]) * inverse_rest, curves.em[c], curves.fm[c], curves.exponent[c], slope)[0]
            scale = links.width[i] * inverse * (force + damping_time * slope * stretch * inverse * inverse_rest)
        out[2 * i, 0], out[2 * i, 1], out[2 * i, 2] = scale * dx, scale * dy, scale * dz
        out[2 * i + 1, 0], out[2 * i + 1, 1], out[2 * i + 1, 2] = -scale * dx, -scale * dy, -scale * dz


@parallel_kernel
def write_stretch(links, curves, damping_time, positions, velocities, out):  # type: ignore[no-untyped-def]
    """Force on end a into out[2 i], on end b into out[2 i + 1]."""
    for chunk in prange(CHUNKS):
        _stretch_of(chunk_range(chunk, len(links.curve)), links, curves, damping_time, positions, velocities, out)


class ForceStretch:
    """Tension of the links of `cloth`. damping_time: tau [s]."""

    name = "stretch"

    def __init__(self, cloth: Cloth, materials: MaterialTable, damping_time: float = 0.0) -> None:
        links = cloth.links
        self._links = StretchElements(
            np.array(links.ends), np.array(links.rest_length), 1.0 / links.rest_length, np.array(links.width), indices(2 * links.material + links.direction)
        )
        self._curves = tension_curves(materials)
        self.damping_time = damping_time
        self.corners = indices(links.ends).ravel()

    def write_forces(self, positions: np.ndarray, velocities: np.ndarray, out: np.ndarray) -> None:
        write_stretch(self._links, self._curves, self.damping_time, positions, velocities, out)

    def _strain(self, positions: np.ndarray) -> np.ndarray:
        ends = self._links.ends
        return np.linalg.norm(positions[ends[:, 1]] - positions[ends[:, 0]], axis=1) / self._links.rest_length - 1.0

    def energy(self, positions: np.ndarray) -> float:
        energy, _, _ = tension_at(self._curves, self._links.curve, self._strain(positions))
        return float(np.sum(energy * self._links.width * self._links.rest_length))

    def write_stiffness(self, positions: np.ndarray, out: np.ndarray) -> None:
        # |K_aa| + |K_ab| = 2 max(T', T/(1 + e)) w/l0: along the link, and across it, where only tension stiffens
        strain = self._strain(positions)
        _, force, tangent = tension_at(self._curves, self._links.curve, strain)
        across = np.where(strain > 0.0, force / (1.0 + np.maximum(strain, 0.0)), 0.0)
        out[:] = np.repeat(2.0 * np.maximum(tangent, across) * self._links.width / self._links.rest_length, 2)

    def write_rest_stiffness(self, out: np.ndarray) -> None:
        """`write_stiffness` at rest, wherever the panels lie."""
        out[:] = np.repeat(2.0 * self._curves.slope[self._links.curve] * self._links.width / self._links.rest_length, 2)
