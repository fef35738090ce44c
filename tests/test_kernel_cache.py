"""Kernels on disk: a cache that is damaged or cannot be written costs time, and nothing else."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
CODE = "from garmentcad.fabric.cantilever import slid_ratio; print(slid_ratio(0.5))"


def printed(cache: Path) -> float:
    """What a kernel returns in a process whose kernels lie below `cache`, compiled there or not."""
    environment = {name: value for name, value in os.environ.items() if name != "NUMBA_CACHE_DIR"}
    environment |= {"XDG_CACHE_HOME": str(cache), "PYTHONPATH": str(ROOT)}
    return float(subprocess.run([sys.executable, "-c", CODE], env=environment, capture_output=True, text=True, check=True).stdout)


@pytest.mark.parametrize(
    "damage",
    [
        pytest.param(lambda path: path.write_bytes(b"") if path.suffix == ".nbi" else None, id="empty index"),
        pytest.param(lambda path: path.write_bytes(path.read_bytes()[:40]) if path.suffix == ".nbi" else None, id="torn index"),
        pytest.param(lambda path: path.write_bytes(path.read_bytes()[:-200]) if path.suffix == ".nbc" else None, id="torn kernel"),
    ],
)
def test_what_is_damaged_is_compiled_anew(damage: Callable[[Path], object], tmp_path: Path) -> None:
    whole = printed(tmp_path)
    files = [path for path in tmp_path.rglob("*") if path.suffix in (".nbi", ".nbc")]
    assert files
    for path in files:
        damage(path)
    assert printed(tmp_path) == whole
    assert printed(tmp_path) == whole
    assert all(path.stat().st_size > 100 for path in tmp_path.rglob("*.nbi"))


def test_where_nothing_can_be_kept_nothing_is_left_beside_the_sources(tmp_path: Path) -> None:
    """Numba would put kernels there, under a stamp that does not notice a changed callee."""
    (tmp_path / "file").write_text("")

    def kept() -> set[Path]:
        return {path for ending in ("nbi", "nbc") for path in (ROOT / "garmentcad").rglob(f"*.{ending}")}

    before = kept()
    assert printed(tmp_path / "file") == pytest.approx(2.1993, abs=1e-3)
    assert kept() == before
