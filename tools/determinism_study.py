"""The bits in which a drape ends, for several numbers of threads and kinds of processor, each run in a process of its own.

`python -m tools.determinism_study` writes docs/studies/determinism.md; with names of garments it runs those only.

Another processor is played: numpy and its linear algebra are told to use none of the instructions that this one has beyond the oldest they know, or only
some of them, and kernels are compiled for any processor of 64 bits.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

from numpy._core._multiarray_umath import __cpu_dispatch__

PAGE = Path(__file__).resolve().parent.parent / "docs" / "studies" / "determinism.md"
GARMENTS = ("t-shirt", "straight-skirt", "pleated-skirt", "wrap-skirt")
OPTIONS = ("--grid", "20")
OWN = "this one"
PROCESSORS = {
    OWN: {},
    "numpy and BLAS without AVX-512": {
        "OPENBLAS_CORETYPE": "Haswell",
        "NPY_DISABLE_CPU_FEATURES": " ".join(name for name in __cpu_dispatch__ if name != "X86_V3"),
    },
    "numpy and BLAS of 2008": {"OPENBLAS_CORETYPE": "Prescott", "NPY_DISABLE_CPU_FEATURES": " ".join(__cpu_dispatch__)},
    "kernels for any x86-64": {"NUMBA_CPU_NAME": "generic", "NUMBA_CPU_FEATURES": ""},
}
RUNS = (*((OWN, threads) for threads in (1, 2, 2, 2, 4)), *((name, 2) for name in PROCESSORS if name != OWN))


def report(garment: str, processor: str, threads: int) -> dict[str, object]:
    """Report of a drape in a fresh process."""
    environment = os.environ | PROCESSORS[processor] | {"NUMBA_NUM_THREADS": str(threads)}
    with tempfile.TemporaryDirectory() as folder:
        command = [sys.executable, "-m", "garmentcad", "drape", garment, *OPTIONS, "--json", "--quiet", "-o", folder]
        done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    if not done.stdout.strip():
        raise SystemExit(f"exit {done.returncode}: {done.stderr}")
    return dict(json.loads(done.stdout))


def main(garments: tuple[str, ...]) -> None:
    """Run the study and write its page."""
    said = f"`python -m tools.determinism_study {' '.join(garments)}".rstrip() + f"`: `garmentcad drape GARMENT {' '.join(OPTIONS)}`, {os.cpu_count()} cores."
    table = ["| garment | processor | threads | status | steps | state_sha256 |", "|---|---|---|---|---|---|"]
    found: dict[str, set[object]] = {garment: set() for garment in garments}
    for garment in garments:
        for processor, threads in RUNS:
            row = report(garment, processor, threads)
            if row["threads"] != threads:
                raise SystemExit(f"{garment}: {threads} threads asked for, {row['threads']} used")
            found[garment].add(row["state_sha256"])
            table.append(f"| {garment} | {processor} | {threads} | {row['status']} | {row['steps']} | `{row['state_sha256']}` |")
            print(table[-1], flush=True)
    equal = "All runs of a garment end in the same bits."
    differ = [garment for garment in garments if len(found[garment]) > 1]
    line = f"NOT the same bits: {', '.join(differ)}." if differ else equal
    print(line)
    PAGE.write_text("\n".join(["# Same bits for any number of threads, on any x86-64 processor", "", said, "", line, "", *table]) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main(tuple(sys.argv[1:]) or GARMENTS)
