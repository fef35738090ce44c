"""The door for sets of arrays (.npz): how large they say they are is looked at before anything is read."""

from __future__ import annotations

import zipfile
import zlib
from pathlib import Path

import numpy as np

from garmentcad.errors import FileError

MOST_BYTES = 2**31  # unpacked; a garment of 250,000 particles takes a tenth
# RuntimeError: packed with a password, or in a way that is not known
_FAULTS = (OSError, ValueError, EOFError, KeyError, AttributeError, MemoryError, RuntimeError, zipfile.BadZipFile, zipfile.LargeZipFile, zlib.error)


def read_npz(path: str | Path, most_bytes: int = MOST_BYTES) -> dict[str, np.ndarray]:
    """All arrays of an .npz file, at most `most_bytes` unpacked. FileError where it cannot be read, or holds more; pickled objects are refused."""
    try:
        with zipfile.ZipFile(path) as packed:
            claimed = sum(entry.file_size for entry in packed.infolist())
        if claimed > most_bytes:
            raise FileError(f"its arrays take {claimed} bytes; at most {most_bytes} are read", file=str(path))
        with np.load(path, allow_pickle=False) as file:
            return {name: file[name] for name in file.files}
    except FileNotFoundError as error:
        raise FileError("no such file", file=str(path)) from error
    except _FAULTS as error:
        raise FileError(f"cannot be read as a set of arrays ({type(error).__name__}: {error})", file=str(path)) from error
