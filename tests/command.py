"""The command line, run as a script runs it and run within the test: the second saves the two seconds that a process takes to load the program. And code on
several numbers of threads."""

from __future__ import annotations

import contextlib
import io
import os
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from unittest import mock

from garmentcad.cli.main import run

Run = subprocess.CompletedProcess[str]


def garmentcad(*arguments: str, folder: Path | None = None, timeout_s: float = 120.0) -> Run:
    """A command in a process of its own, in the folder."""
    return subprocess.run([sys.executable, "-m", "garmentcad", *arguments], capture_output=True, text=True, cwd=folder, timeout=timeout_s, check=False)


def garmentcad_here(*arguments: str, folder: Path) -> Run:
    """The same command by the program's entry point in this process. What the command line does not catch is raised here."""
    out, err, code = io.StringIO(), io.StringIO(), 0
    with contextlib.chdir(folder), mock.patch.object(sys, "argv", ["garmentcad", *arguments]), contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        try:
            run()
        except SystemExit as end:
            code = end.code if isinstance(end.code, int) else 0 if end.code is None else 1
    return subprocess.CompletedProcess(arguments, code, out.getvalue(), err.getvalue())


def printed_on_threads(code: str, counts: Sequence[int] = (1, 2, 4)) -> list[str]:
    """What the code prints on each number of threads: in one process, which has as many as the most of them, as `garmentcad drape --threads` does it."""
    folder = Path(__file__).resolve().parent
    environment = os.environ | {"NUMBA_NUM_THREADS": str(max(counts)), "PYTHONPATH": os.pathsep.join([str(folder), str(folder.parent)])}
    lines = [
        "import numba",
        f"for count in {tuple(counts)}:",
        "    numba.set_num_threads(count)",
        f"    exec({code!r}, {{}})",
        "    assert numba.get_num_threads() == count",
        r"    print(end='\0')",
    ]
    printed = subprocess.run([sys.executable, "-c", "\n".join(lines)], env=environment, capture_output=True, text=True, check=True).stdout.split("\0")
    assert len(printed) == len(counts) + 1
    return printed[:-1]
