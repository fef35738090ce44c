"""Elastics and belts: tension along lines over the cloth.

    T = k max(L/L0 - 1, 0)   [N]      E = k L0 max(L/L0 - 1, 0)^2/2   [J]

L is the length of a group of segments that share one tension, L0 [m] its rest length, k [N] the stiffness per unit of strain. A sewn elastic has a group for
each segment (it cannot slip on the cloth), a belt one for its whole ring (it slides along it without friction). Slack bands carry nothing: they fold.

    L = sum of share times length over the segments of a group

A band is as long as the arc through its points. Two chords in a row are shorter than it by a third of what they are longer than the one over both (Richardson's
extrapolation); so that one is a segment of the group, too, with a negative share.

Segments end at points of the cloth, each a weighted mean of three particles. What presses a taut band onto the body is T times its curvature, and comes from
the corners between its segments; cloth below carries it by contact. The masses of bands are neglected.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from garmentcad.arrays import entry, kernel
from garmentcad.forces.force import OneLaw

CORNERS = 6  # of a segment: three particles at each end
SHORTEST_M = 1e-6  # a shorter segment has no direction


class BandSegments(NamedTuple):
    """Segments of all bands. Group g holds the segments start[g] to start[g+1]."""

    particles: np.ndarray  # (S,2,3) int32 of both ends
    weights: np.ndarray  # (S,2,3)
    share: np.ndarray  # (S,) of its length in that of its group
    start: np.ndarray  # (G+1,) int32
    rest: np.ndarray  # (G,) m
    stiffness: np.ndarray  # (G,) N
    band: np.ndarray  # (G,) int32 row of the pattern's bands


def no_bands() -> BandSegments:
    """The segments of a garment without bands."""
    none = np.zeros(0, dtype=np.int32)
    return BandSegments(np.zeros((0, 2, 3), np.int32), np.zeros((0, 2, 3)), np.zeros(0), np.zeros(1, np.int32), np.zeros(0), np.zeros(0), none)


@kernel
def _side(band, segment, positions):  # type: ignore[no-untyped-def]
    x = y = z = 0.0
    for k in range(3):
        a, b = band.particles[segment, 0, k], band.particles[segment, 1, k]
        wa, wb = band.weights[segment, 0, k], band.weights[segment, 1, k]
        x += wb * positions[b, 0] - wa * positions[a, 0]
        y += wb * positions[b, 1] - wa * positions[a, 1]
        z += wb * positions[b, 2] - wa * positions[a, 2]
    return x, y, z, math.sqrt(x * x + y * y + z * z)


@entry
@kernel
def write_bands(band, positions, out):  # type: ignore[no-untyped-def]
    """Forces on the corners of segment s into out[6 s] to out[6 s + 5]."""
    for group in range(len(band.rest)):
        length = 0.0
        for s in range(band.start[group], band.start[group + 1]):
            length += band.share[s] * _side(band, s, positions)[3]
        tension = band.stiffness[group] * max(length / band.rest[group] - 1.0, 0.0)
        for s in range(band.start[group], band.start[group + 1]):
            x, y, z, side = _side(band, s, positions)
            pull = band.share[s] * tension / max(side, SHORTEST_M)
            for k in range(3):
                at_a, at_b = pull * band.weights[s, 0, k], -pull * band.weights[s, 1, k]
                out[6 * s + k, 0], out[6 * s + k, 1], out[6 * s + k, 2] = at_a * x, at_a * y, at_a * z
                out[6 * s + 3 + k, 0], out[6 * s + 3 + k, 1], out[6 * s + 3 + k, 2] = at_b * x, at_b * y, at_b * z


class ForceBand(OneLaw):
    """Tension of the bands of a cloth."""

    name = "band"

    def __init__(self, segments: BandSegments) -> None:
        self.segments = segments
        self.arguments = (segments,)
        self.corners = segments.particles.ravel()
        self._group = np.repeat(np.arange(len(segments.rest)), np.diff(segments.start))

    def write_forces(self, positions: np.ndarray, velocities: np.ndarray, out: np.ndarray, sliders: np.ndarray | None = None) -> None:
        write_bands(self.segments, positions, out)

    def lengths(self, positions: np.ndarray) -> np.ndarray:
        """Length (G,) m of each group."""
        return np.bincount(self._group, self.segments.share * np.linalg.norm(self._sides(positions), axis=1), len(self.segments.rest))

    def tensions(self, positions: np.ndarray) -> np.ndarray:
        """Tension (G,) N of each group."""
        return self.segments.stiffness * np.maximum(self.lengths(positions) / self.segments.rest - 1.0, 0.0)

    def energy(self, positions: np.ndarray, sliders: np.ndarray | None = None) -> float:
        strain = np.maximum(self.lengths(positions) / self.segments.rest - 1.0, 0.0)
        return float(np.sum(0.5 * self.segments.stiffness * self.segments.rest * strain**2))

    def write_stiffness(self, positions: np.ndarray, out: np.ndarray) -> None:
        # Along the ring a group resists by k/L0 times how far a node lengthens it, which at a node between two segments is their change of direction only;
        # across it by T over the segments' lengths.
        segments, sides = self.segments, self._sides(positions)
        size = np.maximum(np.linalg.norm(sides, axis=1), SHORTEST_M)
        pull = (segments.share[:, None] * sides / size[:, None])[:, None, None, :] * np.array([-1.0, 1.0])[:, None, None] * segments.weights[..., None]
        key = (self._group[:, None, None] * (int(segments.particles.max(initial=0)) + 1) + segments.particles).ravel()
        _, node = np.unique(key, return_inverse=True)
        node = node.ravel()
        gradient = np.linalg.norm(np.column_stack([np.bincount(node, pull[..., axis].ravel()) for axis in range(3)]), axis=1)
        slots = np.bincount(node)[node]  # a node's bound is shared by its slots
        group = np.repeat(self._group, CORNERS)
        first = np.unique(node, return_index=True)[1]
        total = np.bincount(group[first], gradient, len(segments.rest))
        along = (segments.stiffness / segments.rest)[group] * gradient[node] * total[group] / slots
        self.write_stiffness_across(positions, out)
        out += along

    def write_stiffness_across(self, positions: np.ndarray, out: np.ndarray) -> None:
        size = np.maximum(np.linalg.norm(self._sides(positions), axis=1), SHORTEST_M)
        out[:] = 2.0 * np.repeat(np.abs(self.segments.share) * self.tensions(positions)[self._group] / size, CORNERS) * self.segments.weights.ravel()

    def _sides(self, positions: np.ndarray) -> np.ndarray:
        ends = np.einsum("sek,sekx->sex", self.segments.weights, positions[self.segments.particles])
        return np.asarray(ends[:, 1] - ends[:, 0])
