"""How long a first drape waits for its kernels: the same drape in a fresh cache of kernels and once more, and what each kernel's compilation took.

`python -m tools.cold_start_study` writes docs/studies/cold-start.md. On a quiet machine; times of other programs count.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parent.parent
PAGE = ROOT / "docs" / "studies" / "cold-start.md"
GARMENT, GRID_MM = "flared-skirt", "20"
SHOWN = 15


def drape_and_count(folder: str) -> None:
    """In a process of its own: drape, and print the seconds that each kernel's own compilation took, in this process, and those to the first step."""
    from numba.core import event

    class Listener(event.Listener):
        def __init__(self) -> None:
            self.open: list[list[float]] = []
            self.own: Counter[str] = Counter()

        def on_start(self, event: Any) -> None:
            self.open.append([time.perf_counter(), 0.0])

        def on_end(self, event: Any) -> None:
            began, inner = self.open.pop()
            spent = time.perf_counter() - began
            function = event.data["dispatcher"].py_func
            self.own[f"{function.__module__.removeprefix('garmentcad.')}.{function.__name__}"] += spent - inner
            if self.open:
                self.open[-1][1] += spent

    began = time.perf_counter()
    listener = Listener()
    event.register("numba:compile", listener)
    from garmentcad.export.drape import finish
    from garmentcad.simulation.job import make_job

    first: list[float] = []

    def look(progress: Any) -> None:
        if not first:
            first.append(time.perf_counter() - began)

    finish(make_job(GARMENT, grid_mm=float(GRID_MM)), look, Path(folder))
    print(json.dumps({"wall_s": time.perf_counter() - began, "first_look_s": first[0], "kernels": dict(listener.own)}))


def run(cache: str, folder: str) -> dict[str, Any]:
    command = [sys.executable, "-c", f"from tools.cold_start_study import drape_and_count; drape_and_count({folder!r})"]
    done = subprocess.run(command, cwd=ROOT, env=os.environ | {"NUMBA_CACHE_DIR": cache}, capture_output=True, text=True, check=True)
    return dict(json.loads(done.stdout.splitlines()[-1]))


def help_s() -> float:
    began = time.perf_counter()
    subprocess.run([sys.executable, "-m", "garmentcad", "--help"], cwd=ROOT, capture_output=True, check=True)
    return time.perf_counter() - began


def main() -> None:
    with tempfile.TemporaryDirectory() as folder:
        cache, out = str(Path(folder) / "kernels"), str(Path(folder) / "out")
        cold, warm = run(cache, out), run(cache, out)
    shares = sorted(cold["kernels"].items(), key=lambda pair: -pair[1])
    total = sum(cold["kernels"].values())
    rows = [f"| `{name}` | {spent:.1f} | {100.0 * spent / total:.0f} |" for name, spent in shares[:SHOWN]]
    rest = sum(spent for _, spent in shares[SHOWN:])
    PAGE.write_text(
        "# The first drape\n\n"
        f"{GARMENT} at {GRID_MM} mm, to its result folder, in a fresh cache of kernels and once more; another process compiles the\n"
        "lattice and the response to contact meanwhile. Made by `python -m tools.cold_start_study`.\n\n"
        f"* cold {cold['wall_s']:.0f} s, warm {warm['wall_s']:.0f} s: {cold['wall_s'] - warm['wall_s']:.0f} s more\n"
        f"* warm, from the start of the program to the end of its first look (some 200 steps): {warm['first_look_s']:.1f} s\n"
        f"* `garmentcad --help`: {min(help_s() for _ in range(3)):.2f} s\n\n"
        f"What the process that drapes compiled itself, {total:.0f} s in all, without what its callees took:\n\n"
        "| kernel | s | % |\n|---|---|---|\n" + "\n".join(rows) + f"\n| {len(shares) - SHOWN} others | {rest:.1f} | {100.0 * rest / total:.0f} |\n"
    )
    print(PAGE.read_text())


if __name__ == "__main__":
    main()
