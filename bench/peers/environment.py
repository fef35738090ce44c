"""An environment of its own for each peer, beside its script: its packages never meet ours."""

from __future__ import annotations

import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

FOLDER = Path(__file__).resolve().parent


class PeerError(Exception):
    """A peer could not be installed or run; the message is the last thing that it said."""


@dataclass(frozen=True)
class Peer:
    """A program to compare with. script: in this folder; packages: as pip takes them."""

    name: str
    script: str
    packages: tuple[str, ...]


BLENDER = Peer("blender", "peer_blender.py", ("bpy", "numpy"))
NEWTON = Peer("newton", "peer_newton.py", ("newton", "warp-lang", "numpy"))


def environment(peer: Peer, python: str) -> Path:
    """The interpreter of the peer's environment, which is made with `python` where it is not there yet."""
    home = FOLDER / f".venv-{peer.name}"
    inside, done = home / "bin" / "python", home / ".installed"
    if not done.exists():
        ask([python, "-m", "venv", "--clear", str(home)])
        ask([str(inside), "-m", "pip", "install", "--quiet", "--disable-pip-version-check", *peer.packages])
        done.touch()
    return inside


def ask(command: list[str], allowed: tuple[int, ...] = (0,)) -> str:
    """Standard output of a command; PeerError where its exit code is not among those allowed."""
    try:
        run = subprocess.run(command, capture_output=True, text=True, check=False)
    except OSError as fault:
        raise PeerError(f"{command[0]}: {fault.strerror}") from None
    if run.returncode not in allowed:
        said = (run.stderr.strip() or run.stdout.strip() or f"exit code {run.returncode}").splitlines()[-1]
        print(run.stderr, file=sys.stderr)
        raise PeerError(said)
    return run.stdout
