"""Whole files or none."""

from __future__ import annotations

import os
import stat
import threading
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import BinaryIO

import pytest

from garmentcad.errors import FileError
from garmentcad.io.atomic import write_atomic


def test_writes_bytes_text_and_callbacks(tmp_path: Path) -> None:
    assert write_atomic(tmp_path / "a", b"\x00\x01").read_bytes() == b"\x00\x01"
    assert write_atomic(tmp_path / "b", "seam μ\n").read_bytes() == "seam μ\n".encode()
    assert write_atomic(tmp_path / "new" / "c", lambda file: file.write(b"xy") and None).read_bytes() == b"xy"
    assert sorted(path.name for path in tmp_path.rglob("*")) == ["a", "b", "c", "new"]


def test_a_failed_write_leaves_the_old_file_and_nothing_else(tmp_path: Path) -> None:
    path = write_atomic(tmp_path / "a", "old")

    def torn(file) -> None:
        file.write(b"half")
        raise RuntimeError("killed")

    with pytest.raises(RuntimeError, match="killed"):
        write_atomic(path, torn)
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]


def test_a_place_that_cannot_be_written_is_named(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(FileError, match=r"file/report\.json"):
        write_atomic(tmp_path / "file" / "report.json", "")
    (tmp_path / "folder").mkdir()
    with pytest.raises(FileError, match="folder"):
        write_atomic(tmp_path / "folder", "")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["file", "folder"]


def test_two_threads_may_write_the_same_file(tmp_path: Path) -> None:
    path, inside, go_on = tmp_path / "state.npz", threading.Event(), threading.Event()

    def slowly(file: BinaryIO) -> None:
        file.write(b"a" * 5)
        inside.set()
        go_on.wait()
        file.write(b"a" * 5)

    with ThreadPoolExecutor(1) as beside:
        written = beside.submit(write_atomic, path, slowly)
        inside.wait()
        write_atomic(path, b"b")
        now = path.read_bytes()
        go_on.set()
    assert (now, written.result()) == (b"b", path)
    assert path.read_bytes() == b"a" * 10
    assert [left.name for left in tmp_path.iterdir()] == ["state.npz"]


def test_links_stay_and_devices_are_refused(tmp_path: Path) -> None:
    """`--junit /dev/null`, written by root, would else put a file in the place of the device."""
    (tmp_path / "link").symlink_to(tmp_path / "target")
    assert write_atomic(tmp_path / "link", "new") == tmp_path / "link"
    assert (tmp_path / "link").is_symlink()
    assert (tmp_path / "target").read_text() == "new"
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "piped").symlink_to(tmp_path / "pipe")
    for name in ("pipe", "piped"):
        with pytest.raises(FileError, match=rf"{name}: is a device or a pipe"):
            write_atomic(tmp_path / name, "")
    assert stat.S_ISFIFO((tmp_path / "pipe").stat().st_mode)
    (tmp_path / "loop").symlink_to(tmp_path / "loop")
    with pytest.raises(FileError, match="loop"):
        write_atomic(tmp_path / "loop" / "file", "")
