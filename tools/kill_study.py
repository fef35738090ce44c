"""Kills a run without warning at random times, resumes it, and compares the end with that of a run that was left alone.

`python -m tools.kill_study` writes docs/studies/recovery.md.
"""

from __future__ import annotations

import json
import random
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

PAGE = Path(__file__).resolve().parent.parent / "docs" / "studies" / "recovery.md"
RUN = ("drape", "t-shirt", "--fabric", "wool-suiting", "--grid", "20", "--json", "--quiet")
KILLS = 20


def command(folder: Path, *more: str) -> list[str]:
    return [sys.executable, "-m", "garmentcad", *RUN, "-o", str(folder), *more]


def finished(folder: Path, *more: str) -> dict[str, object]:
    """Report of a run that is left alone."""
    done = subprocess.run(command(folder, *more), capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise SystemExit(f"exit {done.returncode}: {done.stderr}")
    return dict(json.loads(done.stdout))


def main() -> None:
    """Run the study and write its page."""
    rng = random.Random(0)
    with tempfile.TemporaryDirectory() as name:
        base = Path(name)
        finished(base / "warm")
        began = time.perf_counter()
        whole = finished(base / "whole")
        length = time.perf_counter() - began
        rows = []
        for number in range(KILLS):
            folder, wait = base / str(number), rng.uniform(0.0, length)
            process = subprocess.Popen(command(folder), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            time.sleep(wait)
            process.send_signal(signal.SIGKILL)
            process.wait()
            done, found = (folder / "report.json").exists(), (folder / "checkpoint.npz").exists()
            resumed = json.loads((folder / "report.json").read_text()) if done else finished(folder, *(["--resume"] if found else []))
            state = "was done" if done else ("resumed" if found else "had not begun")
            rows.append((wait, state, resumed["state_sha256"] == whole["state_sha256"]))
            print(*rows[-1], flush=True)
    equal = sum(row[2] for row in rows)
    said = f"`python -m tools.kill_study`: `garmentcad {' '.join(RUN)}`, {length:.1f} s, killed (SIGKILL) at {KILLS} random times."
    lines = ["# Kills and resumed runs", "", said, ""]
    lines += [f"{equal} of {KILLS} end in the bits of the run that was left alone.", "", "| killed after, s | then | same bits |", "|---|---|---|"]
    lines += [f"| {wait:.2f} | {state} | {'yes' if same else 'NO'} |" for wait, state, same in rows]
    PAGE.write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
