"""Lines of a garment that a picture shows: where sewn edges meet, and where the cloth ends."""

from __future__ import annotations

import numpy as np

from garmentcad.cloth.cloth import Cloth


def seam_and_free_edges(cloth: Cloth) -> tuple[np.ndarray, np.ndarray]:
    """Pairs of particles (S,2) along seams and dart legs, and (B,2) along hems and other free edges.

    An edge of one panel that one triangle alone uses lies on the contour. Where two contour edges have the same two particles they are sewn together.
    """
    corners = cloth.triangles.astype(np.int64)
    edges = np.sort(np.concatenate([corners[:, [0, 1]], corners[:, [1, 2]], corners[:, [2, 0]]]), axis=1)
    unique, counts = np.unique(edges, axis=0, return_counts=True)
    contour = np.sort(cloth.vertex_particle[unique[counts == 1]], axis=1)
    pairs, uses = np.unique(contour, axis=0, return_counts=True)
    return pairs[uses > 1], pairs[uses == 1]


def polylines(edges: np.ndarray) -> list[np.ndarray]:
    """The pairs (E,2) chained into runs of particles, so that a line is drawn with joints; a run ends where other than two edges meet."""
    neighbours: dict[int, list[int]] = {}
    for a, b in edges.tolist():
        neighbours.setdefault(a, []).append(b)
        neighbours.setdefault(b, []).append(a)
    left = {(a, b) for a, b in edges.tolist()}

    def take(a: int, b: int) -> bool:
        pair = (min(a, b), max(a, b))
        if pair in left:
            left.remove(pair)
            return True
        return False

    def run(a: int, b: int) -> np.ndarray:
        line = [a, b]
        while len(neighbours[line[-1]]) == 2:
            following = next((other for other in neighbours[line[-1]] if take(line[-1], other)), None)
            if following is None:
                break
            line.append(following)
        return np.array(line)

    ends = [particle for particle in sorted(neighbours) if len(neighbours[particle]) != 2]
    starts = ends + sorted(set(neighbours) - set(ends))  # what is left after the open runs are closed rings
    return [run(a, b) for a in starts for b in neighbours[a] if take(a, b)]
