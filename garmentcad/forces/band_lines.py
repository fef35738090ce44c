"""Where the elastics and belts of a pattern run on its cloth.

A band holds the cloth at every second spacing. What lies between two such points folds out where the band draws them together: through every particle a band
could not become shorter than the cloth, and squeezed it in its own plane (a waist 30 % too wide was, by 30 %).
"""

from __future__ import annotations

import math

import numpy as np

from garmentcad.arrays import floats, indices
from garmentcad.cloth.cloth import Cloth
from garmentcad.cloth.locate import Anchors, anchors
from garmentcad.forces.band import BandSegments, no_bands
from garmentcad.geometry.portable import norm
from garmentcad.pattern.pattern import Band, EdgeUse, Pattern
from garmentcad.units import MM_TO_M

_APART = 2  # spacings between points at which a band holds the cloth


def band_segments(pattern: Pattern, cloth: Cloth) -> BandSegments:
    """The bands of a pattern on its cloth, welded or not. SpecError for a line that leaves its panel."""
    particles, weights, shares, groups, rest, stiffness, owner = [], [], [], [], [], [], []
    for number, band in enumerate(pattern.bands):
        chains = [_chain(pattern, cloth, band, k) for k in range(len(band.lines))]
        if band.ratio is None:
            assert band.length_mm is not None
            ring = Anchors(*(np.concatenate([np.asarray(getattr(chain, name)) for chain, _ in chains]) for name in Anchors._fields))
            points = np.flatnonzero(~_same_as_next(ring))
            arcs = [np.concatenate(each) for each in zip(*_arcs(len(points), True))]
            parts, lengths = [(ring, points[arcs[0]], arcs[1])], [MM_TO_M * band.length_mm]
        else:
            parts, lengths = [], []
            for chain, along in chains:
                parts += [(chain, ends, share) for ends, share in _arcs(len(along) - 1, False)]
                lengths += list(band.ratio * MM_TO_M * np.diff(along))
        for (chain, ends, share), length in zip(parts, lengths, strict=True):
            particles.append(chain.particles[ends])
            weights.append(chain.weights[ends])
            shares.append(share)
            groups.append(len(ends))
            rest.append(length)
            stiffness.append(band.stiffness_n)
            owner.append(number)
    if not groups:
        return no_bands()
    return BandSegments(
        indices(np.concatenate(particles)), floats(np.concatenate(weights)), floats(np.concatenate(shares)),
        indices(np.cumsum([0, *groups])), floats(rest), floats(stiffness), indices(owner),
    )  # fmt: skip


def _arcs(count: int, closed: bool) -> list[tuple[np.ndarray, np.ndarray]]:
    """Of each of the `count` arcs between neighbours in a chain of points, which is closed or has one point more: pairs (S,2) of points, and the share (S,)
    that the length of each has in that of the arc."""
    found = []
    for k in range(count):
        ends, share = [(k, k + 1)], [1.0]
        # Of two arcs in a row each is longer than its chord by a sixth of what both chords are longer than the one over them. An arc goes by the mean of what
        # its two neighbours say; one at an end of a chain is taken for its chord.
        for first in (k - 1, k) if closed or 0 < k < count - 1 else ():
            ends += [(first, first + 1), (first + 1, first + 2), (first, first + 2)]
            share += [1.0 / 12.0, 1.0 / 12.0, -1.0 / 12.0]
        found.append((np.array(ends) % (count if closed else count + 1), np.array(share)))
    return found


def _chain(pattern: Pattern, cloth: Cloth, band: Band, number: int) -> tuple[Anchors, np.ndarray]:
    """Points of one line of a band as they follow one another, and how far (N,) mm along it they lie on the flat panel."""
    line = band.lines[number]
    if isinstance(line[0], EdgeUse):
        vertices = _edge_vertices(pattern, cloth, line)  # type: ignore[arg-type]
        particles = cloth.vertex_particle[vertices]
        moved = np.concatenate([[True], np.diff(particles) != 0])  # not so over the mouth of a dart, whose two ends are one particle
        steps = np.linalg.norm(np.diff(cloth.vertex_uv_mm[vertices], axis=0), axis=1)
        along = np.concatenate([[0.0], np.cumsum(np.where(moved[1:], steps, 0.0))])[moved]
        last = len(along) - 1  # of an odd number of spacings the last three go together: one alone could not fold
        held = np.append(_APART * np.arange(max(1, last // _APART)), last)
        alone = np.tile([1.0, 0.0, 0.0], (len(held), 1))
        return Anchors(np.repeat(particles[moved][held], 3).reshape(-1, 3), alone), along[held]
    a, b = (np.array(end.uv_mm) for end in line)  # type: ignore[union-attr]
    count = max(1, math.ceil(norm(b - a) * MM_TO_M / (_APART * cloth.spacing)))
    share = np.linspace(0.0, 1.0, count + 1)
    return anchors(cloth, line[0].panel, a + share[:, None] * (b - a)), share * norm(b - a)


def _edge_vertices(pattern: Pattern, cloth: Cloth, uses: tuple[EdgeUse, ...]) -> np.ndarray:
    """Vertices along edge pieces in the order of the run; those of a corner once."""
    found: list[int] = []
    for use in uses:
        edge = pattern.panels[use.panel].edges[use.edge]
        vertices = cloth.edge_vertices[f"{use.panel}.{edge.name}"]
        uv = cloth.vertex_uv_mm[vertices]
        first, last = (int(np.argmin(np.linalg.norm(uv - np.array(point), axis=1))) for point in (edge.curve.start, edge.curve.end))
        piece = vertices[first : (last if last > first else len(vertices)) + 1].tolist()
        piece = piece[::-1] if use.reverse else piece
        found += piece[1:] if found and found[-1] == piece[0] else piece
    return np.array(found)


def _same_as_next(ring: Anchors) -> np.ndarray:
    """Which points of a closed ring are one particle with the one that follows: the two sides of a seam."""
    single = ring.weights.max(axis=1) == 1.0
    particle = ring.particles[np.arange(len(ring.weights)), ring.weights.argmax(axis=1)]
    return np.asarray(single & np.roll(single, -1) & (particle == np.roll(particle, -1)))
