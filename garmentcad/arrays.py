"""The one door between Python and compiled kernels: types, the kernel decorators, and the cache that notices changed callees.

Types are cast once, here (`floats`, `indices`); kernels take C-contiguous float64 and int32 arrays and write into their last arguments.
Numba's disk cache looks only at the file that holds a function; `_ClosureLocator` stamps a function with its file and every garmentcad
file that this file imports, so that an edited callee recompiles its callers and nothing else.
"""

from __future__ import annotations

import hashlib
import os
import re
import shutil
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from functools import cache
from pathlib import Path
from typing import Any

# Between the parallel regions of a step a waiting thread spins. One that sleeps costs about 100 us a region to wake, and may wake on the other thread's core
# (a step then takes as long as on one thread); on a busy machine spinning loses more, but there two threads lose anyway. Read when the first region starts.
os.environ.setdefault("GOMP_SPINCOUNT", "3000000")

import llvmlite.binding as llvm
import numpy as np
from numba import get_num_threads, njit
from numba.core import caching

# Loops over many arrays use wide instructions only where the compiler may check at run time that the arrays do not overlap; by default it gives up after a few.
for _option in ("-runtime-memory-check-threshold=4000", "-vectorize-memory-check-threshold=4000", "-memory-check-merge-threshold=4000"):
    llvm.set_option("garmentcad", _option)

_PACKAGE = Path(__file__).resolve().parent
_IMPORT = re.compile(r"^\s*from\s+(garmentcad[\w.]*)\s+import\s+\(?([^()\n#]*(?:\([^)]*\))?)|^\s*import\s+(garmentcad[\w.]*)", re.MULTILINE)


def _module_file(module: str) -> Path | None:
    path = _PACKAGE.parent.joinpath(*module.split("."))
    for candidate in (path.with_suffix(".py"), path / "__init__.py"):
        if candidate.is_file():
            return candidate
    return None


@cache
def _imports(file: Path) -> tuple[Path, ...]:
    found = []
    for base, names, plain in _IMPORT.findall(file.read_text(encoding="utf-8")):
        modules = [plain] if plain else [base, *(f"{base}.{name.split()[0]}" for name in names.split(",") if name.strip())]
        found += [path for path in map(_module_file, modules) if path is not None]
    return tuple(found)


@cache
def _closure_stamp(file: Path) -> str:
    seen: set[Path] = set()
    todo = [file, Path(__file__).resolve()]
    while todo:
        path = todo.pop()
        if path not in seen:
            seen.add(path)
            todo += _imports(path)
    digest = hashlib.sha256()
    for path in sorted(seen):
        digest.update(str(path.relative_to(_PACKAGE)).encode() + path.read_bytes())
    return digest.hexdigest()


def cache_folder() -> Path:
    """Folder of the compiled kernels: $NUMBA_CACHE_DIR, or garmentcad/ in the user's cache folder."""
    chosen = os.environ.get("NUMBA_CACHE_DIR")
    base = os.environ.get("XDG_CACHE_HOME") or os.path.join(os.path.expanduser("~"), ".cache")
    return Path(chosen) if chosen else Path(base) / "garmentcad" / "kernels"


@cache
def _kernel_folder(file: Path) -> Path | None:
    """Folder of the compiled kernels of a file as it stands, made; None where it cannot be written (a read-only home). Asked once a file: many have a dozen."""
    name = str(file.relative_to(_PACKAGE).with_suffix("")).replace(os.sep, ".")
    # One folder a stamp: numba would unpickle an old index before it looks at the stamp, and fail where a type in it is gone.
    home = cache_folder() / hashlib.sha256(str(_PACKAGE).encode()).hexdigest()[:12] / name
    folder = home / _closure_stamp(file)[:16]
    for stale in home.glob("*") if not folder.exists() else ():
        if stale != folder:
            shutil.rmtree(stale, ignore_errors=True)
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError:
        return None
    return folder if os.access(folder, os.W_OK) else None


class _ClosureLocator(caching._CacheLocator):
    """Numba cache locator for the files of this package; its stamp covers all garmentcad files that a kernel file can call."""

    def __init__(self, py_func: Any, py_file: str) -> None:
        self._file = _resolved(py_file)
        self._folder = _kernel_folder(self._file)
        self._line = py_func.__code__.co_firstlineno

    def get_cache_path(self) -> str:
        return str(self._folder)

    def get_source_stamp(self) -> str:
        return _closure_stamp(self._file)

    def get_disambiguator(self) -> str:
        return str(self._line)

    @classmethod
    def from_function(cls, py_func: Any, py_file: str) -> _ClosureLocator | None:
        file = _resolved(py_file)
        if not file.is_relative_to(_PACKAGE) or _kernel_folder(file) is None:
            return None  # numba's own locators decide
        return cls(py_func, py_file)


@cache
def _resolved(path: str) -> Path:
    return Path(path).resolve()


caching.CacheImpl._locator_classes.insert(0, _ClosureLocator)

# Strict floating point. Contraction to fused operations would be 9 % faster, but which products it fuses changes with what a kernel is compiled into, and a
# process that has just compiled calls other copies of a kernel than one that loads it: the same run would end in other bits.
_OPTIONS: dict[str, Any] = {"cache": True, "nogil": True, "error_model": "numpy"}


def kernel(function: Any) -> Any:
    """Compile a kernel that runs on one thread (also the way to write scalar laws that other kernels call)."""
    return njit(**_OPTIONS)(function)


def inlined_kernel(function: Any) -> Any:
    """Compile a kernel that becomes part of every kernel that calls it, however long it is: wide loops may call no others."""
    return njit(forceinline=True, **_OPTIONS)(function)


def inlined(function: Any) -> Any:
    """A kernel that becomes part of those that call it: one compilation less. For what only deals out calls."""
    return njit(inline="always", **_OPTIONS)(function)


def parallel_kernel(function: Any) -> Any:
    """Compile a kernel with `prange`. Gather only: each iteration writes its own outputs; no reductions."""
    return njit(parallel=True, **_OPTIONS)(function)


# Work is dealt out in this many parts whatever the number of threads. A part is a call of its own: inside a compiled prange body, arrays of a named
# tuple cost 40 ns at each turn, and direct writes to them are lost (seen with numba 0.68). Rows are read as tuples: a view of an array counts its
# references, and two threads that count on the same line are no faster than one.
CHUNKS = 64


@kernel
def chunk_range(chunk, count):  # type: ignore[no-untyped-def]
    """First and last + 1 of the items 0..count-1 in a part."""
    return chunk * count // CHUNKS, (chunk + 1) * count // CHUNKS


@contextmanager
def threads_apart() -> Iterator[None]:
    """Keeps the calling thread on one processor and all others of this process off it, where the kernels use every processor that the process may use.

    The system else leaves two threads that wait for each other on one processor for seconds at a time, and a run takes twice as long now and then.
    """
    can = hasattr(os, "sched_setaffinity")
    allowed = os.sched_getaffinity(0) if can else set()
    if len(allowed) < 2 or get_num_threads() < len(allowed):
        yield
        return
    mine = threading.get_native_id()
    first = min(allowed)
    others = [int(name) for name in os.listdir("/proc/self/task") if int(name) != mine]

    def place(thread: int, processors: set[int]) -> None:
        with suppress(OSError):  # a thread that has ended
            os.sched_setaffinity(thread, processors)

    place(mine, {first})
    for other in others:
        place(other, allowed - {first})
    try:
        yield
    finally:
        for thread in (mine, *others):
            place(thread, allowed)


def floats(values: Any) -> np.ndarray:
    """C-contiguous float64 array of `values`."""
    return np.ascontiguousarray(values, dtype=np.float64)


def indices(values: Any) -> np.ndarray:
    """C-contiguous int32 array of `values`."""
    return np.ascontiguousarray(values, dtype=np.int32)


def frozen(array: np.ndarray) -> np.ndarray:
    """The same array, read-only."""
    array.setflags(write=False)
    return array


def rows_by_key(keys: np.ndarray, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Compressed rows: for each key 0..count-1 the positions in `keys` (K,) where it stands, in rising order.

    Returns starts (count+1,) and items (K,) int32: row k is items[starts[k]:starts[k+1]].
    """
    items = np.argsort(keys, kind="stable")
    starts = np.zeros(count + 1, dtype=np.int64)
    np.cumsum(np.bincount(keys, minlength=count), out=starts[1:])
    return indices(starts), indices(items)


def unique_pairs(pairs: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The different rows (U,2) int32 of pairs (K,2) of indices, each rising in itself, in rising order; and the row (K,) of each pair.

    One number stands for a pair: numpy sorts those ten times as fast as rows.
    """
    low, high = np.minimum(pairs[:, 0], pairs[:, 1]).astype(np.int64), np.maximum(pairs[:, 0], pairs[:, 1])
    width = int(high.max(initial=0)) + 1
    keys, row = np.unique(low * width + high, return_inverse=True)
    return indices(np.column_stack([keys // width, keys % width])), row
