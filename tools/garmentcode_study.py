"""Thousands of GarmentCode files with seeded faults through the reader: what comes out, how long it takes, and how much memory.

`python -m tools.garmentcode_study` writes docs/studies/garmentcode.md. `python -m tools.garmentcode_study FILE...` reads, checks and drapes files instead, at
20 mm, and prints a line for each: for files that may not be copied into this repository.
"""

from __future__ import annotations

import resource
import signal
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path
from typing import Any

from garmentcad.check.examine import examine
from garmentcad.errors import GarmentError
from garmentcad.export.drape import drape
from garmentcad.io.garmentcode_import import import_garmentcode
from garmentcad.io.spec_file import write_spec
from garmentcad.pattern.draft import draft
from tools.garmentcode_patterns import mutated

PAGE = Path(__file__).resolve().parent.parent / "docs" / "studies" / "garmentcode.md"
COUNT = 5000
LONGEST_S = 10  # of one file; a reader that takes longer hangs
MEMORY_BYTES = 2**30


def mutations() -> None:
    """Read COUNT mutated files in this process, whose memory is limited, and write the page."""
    resource.setrlimit(resource.RLIMIT_DATA, (MEMORY_BYTES, MEMORY_BYTES))
    signal.signal(signal.SIGALRM, _hang)
    ends: Counter[str] = Counter()
    longest = 0.0
    with tempfile.TemporaryDirectory() as name:
        path = Path(name) / "mutated.json"
        for seed in range(COUNT):
            path.write_bytes(mutated(seed))
            signal.alarm(LONGEST_S)
            began = time.perf_counter()
            try:
                spec = import_garmentcode(path).spec
                draft(spec, {})
                write_spec(spec, path.with_suffix(".yaml"))
                ends["read, drafted and written"] += 1
            except GarmentError as fault:
                ends[type(fault).__name__] += 1
            longest = max(longest, time.perf_counter() - began)
            signal.alarm(0)
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    lines = [
        "# GarmentCode files with faults", "",
        f"`python -m tools.garmentcode_study`: {COUNT} files, three patterns with numbers nudged, values replaced, moved, dropped or doubled, bytes changed.",
        f"None raised anything but a GarmentError, none took more than {longest:.2f} s; {memory:.0f} MiB at most (1,024 are allowed).", "",
        "| end | files |", "|---|---|", *(f"| {end} | {count} |" for end, count in ends.most_common()),
    ]  # fmt: skip
    PAGE.write_text("\n".join(lines) + "\n", encoding="utf-8")
    print("\n".join(lines))


def _hang(number: int, frame: Any) -> None:
    raise TimeoutError(f"a file took more than {LONGEST_S} s")


def files(paths: list[str]) -> None:
    """Read, check and drape each file on the body that it names."""
    for path in paths:
        errors = [str(finding) for finding in examine(path) if finding.severity == "error"]
        if errors:
            print(f"{path}: {len(errors)} errors: {errors[0]}")
            continue
        report = drape(path, grid_mm=20.0).report
        crossings = f"{report['self_intersections']} and {report['mannequin_intersections']} intersections"
        depth, took = report["mannequin_penetration_mm"]["max"], report["wall_time_s"]["total"]
        print(f"{path}: no errors; {report['status']}, {crossings}, {depth} mm penetration, {took:.0f} s", flush=True)


if __name__ == "__main__":
    if len(sys.argv) > 1:
        files(sys.argv[1:])
    else:
        mutations()
