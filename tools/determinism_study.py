"""The bits in which a drape ends, for several numbers of threads, each run in a process of its own.

`python -m tools.determinism_study` writes docs/studies/determinism.md; with names of garments it runs those only.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

PAGE = Path(__file__).resolve().parent.parent / "docs" / "studies" / "determinism.md"
GARMENTS = ("t-shirt", "straight-skirt", "flared-skirt")
OPTIONS = ("--fabric", "wool-suiting", "--grid", "20")
THREADS = (1, 2, 2, 2, 4)  # one run each


def report(garment: str, threads: int) -> dict[str, object]:
    """Report of a drape in a fresh process."""
    with tempfile.TemporaryDirectory() as folder:
        command = [sys.executable, "-m", "garmentcad", "drape", garment, *OPTIONS, "--json", "--quiet", "-o", folder]
        done = subprocess.run(command, env=os.environ | {"NUMBA_NUM_THREADS": str(threads)}, capture_output=True, text=True, check=False)
    if not done.stdout.strip():
        raise SystemExit(f"exit {done.returncode}: {done.stderr}")
    return dict(json.loads(done.stdout))


def main(garments: tuple[str, ...]) -> None:
    """Run the study and write its page."""
    said = f"`python -m tools.determinism_study {' '.join(garments)}".rstrip() + f"`: `garmentcad drape GARMENT {' '.join(OPTIONS)}`, {os.cpu_count()} cores."
    table = ["| garment | threads | status | steps | state_sha256 |", "|---|---|---|---|---|"]
    found: dict[str, set[object]] = {garment: set() for garment in garments}
    for garment in garments:
        for threads in THREADS:
            row = report(garment, threads)
            if row["threads"] != threads:
                raise SystemExit(f"{garment}: {threads} threads asked for, {row['threads']} used")
            found[garment].add(row["state_sha256"])
            table.append(f"| {garment} | {threads} | {row['status']} | {row['steps']} | `{row['state_sha256']}` |")
            print(table[-1], flush=True)
    equal = "All runs of a garment end in the same bits."
    differ = [garment for garment in garments if len(found[garment]) > 1]
    line = f"NOT the same bits: {', '.join(differ)}." if differ else equal
    print(line)
    PAGE.write_text("\n".join(["# Same bits for any number of threads", "", said, "", line, "", *table]) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main(tuple(sys.argv[1:]) or GARMENTS)
