"""Garments with their fabric, and body scans, thousands of each with seeded faults: what comes out, how long it takes, how much memory.

`python -m tools.fuzz_study`, a part of `make study`, runs the batches that have no row in docs/studies/fuzz.jsonl yet and writes fuzz.md; with TEXT only
those with TEXT in their name. Each batch runs in a child process whose memory is limited; a case that does not end is killed and named.
"""

from __future__ import annotations

import hashlib
import multiprocessing
import resource
import signal
import sys
import tempfile
import time
import warnings
from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

from garmentcad import __version__
from garmentcad.errors import GarmentError
from garmentcad.io.atomic import write_atomic
from garmentcad.simulation.study import StudyCase, run_study
from tools.fuzz_cases import try_garment, try_scan, write_garment, write_scan

FOLDER = Path(__file__).resolve().parent.parent / "docs" / "studies"
KINDS: dict[str, tuple[int, Callable[[int, Path], Path], Callable[[Path], str]]] = {
    "garment": (20_000, write_garment, try_garment), "scan": (5_000, write_scan, try_scan),
}  # fmt: skip
BATCH = 250
LONGEST_S = 30.0  # of processor time for one case; what takes longer hangs
FIRST_S = 600.0  # for the first one, which may have kernels to compile
PATIENCE_S = 1800.0  # for a case that waits for something that never comes
MEMORY_BYTES = 2**30


@dataclass
class Outcome:
    """What came of some cases. ends: how many ended how; faults: seed -> what is no GarmentError; slowest: processor seconds and seed; memory_mib: at most."""

    ends: Counter[str] = field(default_factory=Counter)
    faults: dict[int, str] = field(default_factory=dict)
    slowest: tuple[float, int] = (0.0, -1)
    memory_mib: float = 0.0


def run_cases(kind: str, first: int, count: int) -> Outcome:
    """Cases `first` to `first + count - 1` of a kind in a child process."""
    outcome, seed = Outcome(), first
    context = multiprocessing.get_context("spawn")  # kernels on several threads do not survive a fork
    while seed < first + count:  # after a case that had to be killed, a new child takes the rest
        receive, send = context.Pipe(duplex=False)
        child = context.Process(target=_in_child, args=(kind, seed, first + count, send))
        child.start()
        send.close()
        while seed < first + count:
            try:
                if not receive.poll(PATIENCE_S):
                    raise TimeoutError
                end, fault, seconds, outcome.memory_mib = receive.recv()
            except (EOFError, TimeoutError) as what:
                outcome.faults[seed] = "it waits" if isinstance(what, TimeoutError) else f"the process died, or more than {LONGEST_S:g} s"
                seed += 1
                break
            if fault:
                outcome.faults[seed] = fault
            else:
                outcome.ends[end] += 1
            outcome.slowest = max(outcome.slowest, (seconds, seed))
            seed += 1
        child.kill()
        child.join()
    return outcome


def _in_child(kind: str, first: int, end: int, send: Connection) -> None:
    resource.setrlimit(resource.RLIMIT_DATA, (MEMORY_BYTES, MEMORY_BYTES))
    warnings.simplefilter("ignore")
    signal.signal(signal.SIGPROF, signal.SIG_DFL)  # ends the process, compiled code included
    _, write, attempt = KINDS[kind]
    with tempfile.TemporaryDirectory() as name:
        for seed in range(first, end):
            path = write(seed, Path(name))
            signal.setitimer(signal.ITIMER_PROF, FIRST_S if seed == first else LONGEST_S)
            began = time.process_time()
            came, fault = "", ""
            try:
                came = attempt(path)
            except Exception as what:  # the study looks for just these
                fault = f"{type(what).__name__}: {str(what)[:200]}"
            signal.setitimer(signal.ITIMER_PROF, 0.0)
            path.unlink()
            memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
            send.send((came, fault, time.process_time() - began, memory))


def study(only: str | None) -> None:
    """Run the batches that are missing and write the page."""
    made = hashlib.sha256(b"".join(Path(__file__).with_name(name).read_bytes() for name in ("fuzz_cases.py", "faults.py"))).hexdigest()
    cases = [
        StudyCase(f"{kind} {first}", made, "", "", __version__, {"kind": kind, "first": first})
        for kind, (count, _, _) in KINDS.items()
        for first in range(0, count, BATCH)
    ]  # fmt: skip

    def run_case(case: StudyCase) -> Mapping[str, Any]:
        outcome = run_cases(case.parameters["kind"], case.parameters["first"], BATCH)
        if outcome.faults:
            raise GarmentError("; ".join(f"seed {seed}: {fault}" for seed, fault in outcome.faults.items()))
        return {
            "ends": dict(outcome.ends),
            "slowest_s": round(outcome.slowest[0], 2),
            "slowest_seed": outcome.slowest[1],
            "memory_mib": round(outcome.memory_mib),
        }

    done = run_study("fuzz", cases, run_case, FOLDER, only=only, say=lambda message: print(message, flush=True))
    page = ["# Garments, fabrics and scans with faults", "", __doc__ or ""]
    for kind, (wanted, _, _) in KINDS.items():
        rows = [row for row in done.rows if row["kind"] == kind]
        ends: Counter[str] = Counter()
        for row in rows:
            ends.update(row["ends"])
        slowest, memory = (max((row[name] for row in rows), default=0) for name in ("slowest_s", "memory_mib"))
        page += [
            f"## {kind}: {ends.total():,} of {wanted:,} cases", "",
            f"None raised anything but a GarmentError, none took more than {slowest:.1f} s of processor time; {memory} MiB at most (1,024 are allowed).", "",
            "| end | cases |", "|---|---|", *(f"| {end} | {count:,} |" for end, count in ends.most_common()), "",
        ]  # fmt: skip
    write_atomic(FOLDER / "fuzz.md", "\n".join(page))
    for name, message in done.failed.items():
        print(f"fault: {name}: {message}", file=sys.stderr)


if __name__ == "__main__":
    study(sys.argv[1] if len(sys.argv) > 1 else None)
