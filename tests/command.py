"""The command line, run as a script runs it and run within the test: the second saves the two seconds that a process takes to load the program."""

from __future__ import annotations

import contextlib
import io
import subprocess
import sys
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
