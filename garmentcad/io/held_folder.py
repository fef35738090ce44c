"""One writer a folder: two drapes into one folder would mix their files."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from garmentcad.errors import FileError

try:
    import fcntl
except ImportError:  # no POSIX: folders are not held there
    fcntl = None  # type: ignore[assignment]


@contextmanager
def held_folder(folder: Path) -> Iterator[None]:
    """For as long as this lasts no other `held_folder` gets the existing `folder`, in this process or in another one: FileError. A process that is killed
    lets go; no file is made for it. Folders that cannot be opened or locked are not held."""
    try:
        handle = os.open(folder, os.O_RDONLY)
    except OSError:
        yield
        return
    try:
        try:
            if fcntl is not None:
                fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise FileError("another drape is writing into this folder", file=str(folder)) from None
        except OSError:
            pass
        yield
    finally:
        os.close(handle)
