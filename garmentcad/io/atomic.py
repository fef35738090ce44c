"""Whole files or none: every writer of the program goes through `write_atomic`, so that a killed run never leaves half a file under its final name."""

from __future__ import annotations

import os
import stat
import threading
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import BinaryIO

from garmentcad.errors import FileError


def write_atomic(path: str | Path, content: bytes | str | Callable[[BinaryIO], None]) -> Path:
    """Write `content` to a temporary name in the same folder, fsync it, and rename it to `path`.

    content: bytes, text (stored as UTF-8), or a function that writes into the open binary file it is given. If the function raises, the file that
    stood at `path` stays as it was and nothing is left beside it; else the new one has the permissions of the old. A link stays one, to the new file.
    Missing folders are made. Raises FileError where the folder cannot be written and for a path that names no file.
    """
    named = path = Path(path)
    if not path.name:
        raise FileError("is a folder; a file is wanted", file=str(path))
    with suppress(OSError, RuntimeError):  # a link stays one; a loop of links is told as what cannot be written
        path = path.resolve() if path.is_symlink() else path
        if stat.S_IFMT(path.stat().st_mode) not in (stat.S_IFREG, stat.S_IFDIR):
            raise FileError("is a device or a pipe; a file is wanted", file=str(named))
    temporary = _temporary(path, f"{os.getpid()}-{threading.get_native_id()}")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with open(temporary, "wb") as file:
            with suppress(FileNotFoundError):
                os.fchmod(file.fileno(), stat.S_IMODE(path.stat().st_mode))
            if isinstance(content, str):
                file.write(content.encode("utf-8"))
            elif isinstance(content, bytes):
                file.write(content)
            else:
                content(file)
            file.flush()
            os.fsync(file.fileno())
        os.replace(temporary, path)
    except BaseException as error:
        with suppress(OSError):
            temporary.unlink(missing_ok=True)
        if isinstance(error, OSError):
            raise FileError(f"cannot write: {error.strerror or error}", file=str(named)) from error
        raise
    _sync_folder(path.parent)
    return named


def remove_unfinished(path: str | Path) -> None:
    """Remove what writers of `path` left under temporary names because they were killed. OSError where that cannot be done."""
    path = Path(path)
    for left in path.parent.glob(_temporary(path, "*").name):
        left.unlink(missing_ok=True)


def _temporary(path: Path, writer: str) -> Path:
    return path.with_name(f".{path.name}.{writer}.tmp")


def _sync_folder(folder: Path) -> None:
    """The rename itself reaches the disk only with the folder (POSIX); where folders cannot be opened there is nothing to do."""
    try:
        handle = os.open(folder, os.O_RDONLY)
    except OSError:
        return
    try:
        os.fsync(handle)
    finally:
        os.close(handle)
