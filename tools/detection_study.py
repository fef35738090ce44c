"""What the decoupled clock of detection saves, and that it misses nothing: against detection at every step, on the same states.

`python -m tools.detection_study [--grid 20]` writes docs/studies/detection.md. At three places of a drape a stretch of steps is done one by one. After each,
all pairs nearer than 1.1 gaps are looked for anew, and must be those that the kept candidates hold; the time of such a search, which needs no margin beyond
1.1 gaps and the way of one step, is what detection at every step would cost.
"""

from __future__ import annotations

import argparse
import math
import os
import signal
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

from garmentcad.bench.cases import case_job
from garmentcad.cloth.lattice import build_cloth
from garmentcad.cloth.state import State
from garmentcad.cloth.weld import weld
from garmentcad.contact.contact import Contact, load_pairs
from garmentcad.contact.pairs import NEARLY, distances
from garmentcad.simulation.checkpoint import load_state
from garmentcad.simulation.course import Course, Progress
from garmentcad.simulation.job import Job
from garmentcad.simulation.keeper import Interrupted
from garmentcad.simulation.materials import lay_out
from garmentcad.simulation.run import run
from garmentcad.simulation.stepper import make_dynamics

PAGE = Path(__file__).resolve().parent.parent / "docs" / "studies" / "detection.md"
CASES = ("cloth-on-ball", "t-shirt", "flared-skirt")
PLACES = (("fall", 4), ("settle", 2), ("settle", 5))  # phase, and how many looks into it
STEPS = 384


@dataclass(frozen=True)
class Row:
    """A stretch of steps. looks: of the decoupled clock; ours_s, each_s: wall time of these, and of a search at every step; missed: pairs."""

    case: str
    place: str
    fastest_m_s: float
    looks: int
    ours_s: float
    each_s: float
    touching: int
    missed: int


def state_at(job: Job, phase: str, look: int) -> State:
    """The state at the k-th look of a phase on the job's own lattice."""
    count = 0

    def watch(progress: Progress) -> None:
        nonlocal count
        count += progress.phase == phase
        if count == look:
            os.kill(os.getpid(), signal.SIGINT)

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "checkpoint.npz"
        try:
            run(job, watch, path)
        except Interrupted:
            return load_state(path)
    raise SystemExit(f"{job.pattern.name}: phase {phase} has fewer than {look} looks")


def touching(contact: Contact, state: State, pairs: object) -> set[bytes]:
    """Pairs that a step may have to keep apart: nearer than 1.1 gaps."""
    contact.load(state)
    near = distances(pairs.nodes, pairs.kind, contact.positions) < NEARLY * pairs.gap  # type: ignore[attr-defined]
    return {row.tobytes() for row in pairs.nodes[near]}  # type: ignore[attr-defined]


def measured(case: str, job: Job, phase: str, look: int) -> Row:
    """One stretch."""
    state = state_at(job, phase, look)
    materials, material_of = lay_out(job)
    cloth, _ = weld(build_cloth(job.pattern, material_of, materials, job.grid_mm))
    dynamics, soften_all = make_dynamics(job, cloth, materials, state.fold_angles)
    course, contact = Course(dynamics, soften_all, job.mode, job.max_time_s), dynamics.contact
    course.set_phase(state)
    dynamics.advance(state, 1)
    looks, each, missed, seen, fastest = 0, 0.0, 0, 0, 0.0
    began = dynamics.seconds["detection"]
    beyond = 0.5 * (NEARLY - 1.0) * float(load_pairs(state).gap.max(initial=0.0))
    for _ in range(STEPS):
        home = state.contact["pair_home"]
        dynamics.advance(state, 1)
        looks += state.contact["pair_home"] is not home
        speed = math.sqrt((state.velocities**2).sum(axis=1).max())  # the body stands still
        fastest = max(fastest, speed)
        t0 = time.perf_counter()
        fresh = contact.near(state, speed * state.time_step_s + beyond)
        each += time.perf_counter() - t0
        there, kept = touching(contact, state, fresh), touching(contact, state, load_pairs(state))
        seen, missed = max(seen, len(there)), missed + len(there - kept)
    return Row(case, f"{phase}, {state.time_s:.2f} s", fastest, looks, dynamics.seconds["detection"] - began, each, seen, missed)


def page(rows: list[Row], grid_mm: float) -> str:
    """The table."""
    lines = [
        "# Detection: the decoupled clock against a search at every step", "",
        f"`python -m tools.detection_study --grid {grid_mm:g}`: {STEPS} steps at each place. Both searches use the same trees; the one at every step looks no",
        "farther than the gap and the way of that step.",
        "Pairs nearer than 1.1 gaps are compared after every step.", "",
        "| case | place | fastest, m/s | looks | detection, s | at every step, s | factor | touching pairs, at most | missed |",
        "|---|---|---|---|---|---|---|---|---|",
    ]  # fmt: skip
    for row in rows:
        factor = f"{row.each_s / row.ours_s:.1f}" if row.ours_s > 0.0 else "no look"
        cells = [row.case, row.place, f"{row.fastest_m_s:.2f}", row.looks, f"{row.ours_s:.2f}", f"{row.each_s:.2f}", factor, row.touching, row.missed]
        lines.append(f"| {' | '.join(map(str, cells))} |")
    whole = sum(row.each_s for row in rows) / max(1e-9, sum(row.ours_s for row in rows))
    lines += ["", f"Over all rows: a factor of {whole:.1f}; {sum(row.missed for row in rows)} pairs missed."]
    return "\n".join(lines) + "\n"


def main() -> None:
    """Run the study and write its page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--grid", type=float, default=20.0)
    grid = parser.parse_args().grid
    rows = []
    for case in CASES:
        for phase, look in PLACES:
            rows.append(measured(case, case_job(case, grid, "wool-suiting", 0), phase, look))
            print(rows[-1], flush=True)
    PAGE.write_text(page(rows, grid), encoding="utf-8")


if __name__ == "__main__":
    main()
