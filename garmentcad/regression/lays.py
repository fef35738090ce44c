"""Several lays of one garment, draped."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from garmentcad.errors import TangledError
from garmentcad.export.drape import finish
from garmentcad.export.result_folder import Result
from garmentcad.simulation.course import Progress
from garmentcad.simulation.job import Job
from garmentcad.simulation.lay import displaced


@dataclass(frozen=True)
class Lay:
    """One drape of several. seed: of the displacement; 0 is the start as drafted."""

    seed: int
    result: Result


def drape_lays(job: Job, lays: int, done: Callable[[Lay], None], look: Callable[[Progress], None], first: int = 0) -> tuple[list[Lay], int]:
    """Lays from the seed `first` on (the start as drafted, and then those that differ), and how many starts were refused because displaced panels crossed.

    done: told of each lay. TangledError where the start as drafted, or more starts than lays, are refused.
    """
    drapes: list[Lay] = []
    seed, refused = first, 0
    while len(drapes) < lays:
        try:
            result, _ = finish(displaced(job, seed) if seed else job, look, None)
        except TangledError:
            if seed == 0 or refused > lays:
                raise
            refused += 1
        else:
            drapes.append(Lay(seed, result))
            done(drapes[-1])
        seed += 1
    return drapes, refused
