"""Generated contact queries with known answers: pairs of elements that meet at a known rational time, degenerate ones included.

`python -m tools.contact_queries` runs 100,000 of them and writes docs/studies/contact-queries.md; the tests run 2,000.
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from pathlib import Path
from typing import NamedTuple

import numpy as np

from garmentcad.contact.pairs import EDGE_EDGE, VERTEX_TRIANGLE, closest_points, time_of_contact

PAGE = Path(__file__).resolve().parent.parent / "docs" / "studies" / "contact-queries.md"
COUNT = 100_000
KEPT_M = 1e-3
SHAPES = ("ordinary", "flat triangle or parallel edges", "point or edge without length", "four nodes in a plane")


class Query(NamedTuple):
    """Four nodes at the start of a unit step, their velocities, the part of the step at which they meet, their places then; shape: index in SHAPES."""

    start: np.ndarray
    velocities: np.ndarray
    time: float
    meeting: np.ndarray
    shape: int


def queries(kind: int, count: int, seed: int) -> Iterator[Query]:
    """`count` queries of VERTEX_TRIANGLE or EDGE_EDGE, a quarter of each shape. All numbers are exact in binary: nothing is rounded on the way."""
    rng = np.random.default_rng(seed)
    for number in range(count):
        shape = number % len(SHAPES)
        time = Fraction(int(rng.integers(1, 64)), 64)

        a, b, c = (_point(rng, flat=shape == 3) for _ in range(3))
        if kind == VERTEX_TRIANGLE:
            if shape == 1:
                c = _between(a, b, Fraction(int(rng.integers(-16, 33)), 16))
            elif shape == 2:
                b, c = list(a), list(a)
            weights = [Fraction(int(k), 16) for k in rng.multinomial(16, [1 / 3] * 3)]
            meeting = [[sum((w * corner[axis] for w, corner in zip(weights, (a, b, c))), Fraction()) for axis in range(3)], a, b, c]
        else:
            direction = c
            if shape == 1:
                direction = [int(rng.integers(-2, 3)) * (y - x) for x, y in zip(a, b)]
            elif shape == 2:
                direction = [Fraction()] * 3
            s, t = (Fraction(int(k), 16) for k in rng.integers(0, 17, 2))
            c = [x - t * d for x, d in zip(_between(a, b, s), direction)]
            meeting = [a, b, c, [x + d for x, d in zip(c, direction)]]
        speeds = [[Fraction(int(k), 4) for k in rng.integers(-8, 9, 3)] for _ in range(4)]
        start = np.array([[float(x - time * v) for x, v in zip(node, speed)] for node, speed in zip(meeting, speeds)])
        places = np.array([[float(x) for x in node] for node in meeting])
        yield Query(start, np.array([[float(v) for v in speed] for speed in speeds]), float(time), places, shape)


def _point(rng: np.random.Generator, flat: bool) -> list[Fraction]:
    place = [Fraction(int(k), 8) for k in rng.integers(-8, 9, 3)]
    return [*place[:2], Fraction()] if flat else place


def _between(a: list[Fraction], b: list[Fraction], share: Fraction) -> list[Fraction]:
    return [x + share * (y - x) for x, y in zip(a, b)]


def missed(kind: int, query: Query) -> tuple[bool, float]:
    """Whether the continuous test lets the pair pass, and the distance that the closest-point test finds where they meet, m."""
    found = time_of_contact(kind, (0, 1, 2, 3), query.start, query.velocities, 1.0, KEPT_M)
    _, apart, _ = closest_points(kind, *(tuple(float(x) for x in node) for node in query.meeting))
    return bool(found > query.time), float(np.linalg.norm(apart))


def main() -> None:
    """Run the study and write its page."""
    command = f"`python -m tools.contact_queries`: {COUNT} generated queries, seed 0, kept distance {KEPT_M * 1e3:g} mm."
    lines = ["# Contact queries with known times", "", command, ""]
    lines += ["| pair | shape | queries | passed unseen | largest distance found where they meet, m |", "|---|---|---|---|---|"]
    for kind, name in ((VERTEX_TRIANGLE, "vertex and triangle"), (EDGE_EDGE, "edge and edge")):
        table = np.zeros((len(SHAPES), 3))
        for query in queries(kind, COUNT // 2, seed=0):
            unseen, distance = missed(kind, query)
            row = table[query.shape]
            row[0], row[1], row[2] = row[0] + 1, row[1] + unseen, max(row[2], distance)
        lines += [f"| {name} | {shape} | {row[0]:.0f} | {row[1]:.0f} | {row[2]:.1e} |" for shape, row in zip(SHAPES, table)]
    PAGE.write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
