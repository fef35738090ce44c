"""Where the elastics and belts of a pattern run on its cloth."""

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


def band_segments(pattern: Pattern, cloth: Cloth) -> BandSegments:
    """The bands of a pattern on its cloth, welded or not. SpecError for a line that leaves its panel."""
    particles, weights, groups, rest, stiffness, owner = [], [], [], [], [], []
    for number, band in enumerate(pattern.bands):
        chains = [_chain(pattern, cloth, band, k) for k in range(len(band.lines))]
        if band.ratio is None:
            assert band.length_mm is not None
            ring = Anchors(*(np.concatenate([np.asarray(getattr(chain, name)) for chain, _ in chains]) for name in Anchors._fields))
            ends = np.column_stack([np.arange(len(ring.weights)), np.roll(np.arange(len(ring.weights)), -1)])
            ends = ends[~_same(ring, ends)]
            parts, lengths = [(ring, ends)], [MM_TO_M * band.length_mm]
        else:
            parts, lengths = [], []
            for chain, places in chains:
                ends = np.column_stack([np.arange(len(places) - 1), np.arange(1, len(places))])
                ends = ends[~_same(chain, ends)]
                parts += [(chain, pair[None]) for pair in ends]
                lengths += list(band.ratio * MM_TO_M * np.linalg.norm(places[ends[:, 1]] - places[ends[:, 0]], axis=1))
        for (chain, ends), length in zip(parts, lengths, strict=True):
            particles.append(chain.particles[ends])
            weights.append(chain.weights[ends])
            groups.append(len(ends))
            rest.append(length)
            stiffness.append(band.stiffness_n)
            owner.append(number)
    if not groups:
        return no_bands()
    return BandSegments(
        indices(np.concatenate(particles)), floats(np.concatenate(weights)), indices(np.cumsum([0, *groups])), floats(rest), floats(stiffness), indices(owner)
    )


def _chain(pattern: Pattern, cloth: Cloth, band: Band, number: int) -> tuple[Anchors, np.ndarray]:
    """Points of one line of a band as they follow one another, and their places (N,2) mm on the panel."""
    line = band.lines[number]
    if isinstance(line[0], EdgeUse):
        vertices = _edge_vertices(pattern, cloth, line)  # type: ignore[arg-type]
        alone = np.tile([1.0, 0.0, 0.0], (len(vertices), 1))
        return Anchors(np.repeat(cloth.vertex_particle[vertices], 3).reshape(-1, 3), alone), cloth.vertex_uv_mm[vertices]
    a, b = (np.array(end.uv_mm) for end in line)  # type: ignore[union-attr]
    count = max(1, math.ceil(norm(b - a) * MM_TO_M / cloth.spacing))
    places = a + np.linspace(0.0, 1.0, count + 1)[:, None] * (b - a)
    return anchors(cloth, line[0].panel, places), places


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


def _same(chain: Anchors, ends: np.ndarray) -> np.ndarray:
    """Pairs whose two points are one particle: the two sides of a seam, or of a dart's mouth."""
    single = chain.weights.max(axis=1) == 1.0
    particle = chain.particles[np.arange(len(chain.weights)), chain.weights.argmax(axis=1)]
    return np.asarray(single[ends].all(axis=1) & (particle[ends[:, 0]] == particle[ends[:, 1]]))
