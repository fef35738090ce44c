"""Compiled kernels on disk and among each other: a cache that notices changed callees, and callees that stay apart from their callers.

Numba's disk cache looks only at the file that holds a function; `_ClosureLocator` stamps a function with its file and every garmentcad
file that this file imports, so that an edited callee recompiles its callers and nothing else.

Numba takes the code of a callee into every caller and optimises it there once more, level by level, so that a kernel five calls down is compiled six times.
`keep_apart` makes callers call it by its symbol instead.

While numba compiles, garbage is collected more seldom: it makes millions of objects that live until it is done, and to walk through them again and again
takes a tenth of the time.
"""

from __future__ import annotations

import atexit
import gc
import hashlib
import os
import pickle
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from functools import cache
from importlib import import_module
from pathlib import Path
from typing import Any

from numba import typeof
from numba.core import caching, event
from numba.core.codegen import CPUCodeLibrary
from numba.core.compiler import Compiler

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
def _scratch() -> Path:
    """A folder for the kernels of this process alone, for where none can be kept: numba would put them beside the sources, under a stamp that does not notice
    changed callees."""
    folder = tempfile.mkdtemp(prefix="garmentcad-")
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    return Path(folder)


@cache
def _kernel_folder(file: Path) -> Path:
    """Folder of the compiled kernels of a file as it stands, made; a scratch one where it cannot be written (a read-only home). Asked once a file: many have a
    dozen."""
    name = str(file.relative_to(_PACKAGE).with_suffix("")).replace(os.sep, ".")
    # One folder a stamp: numba would unpickle an old index before it looks at the stamp, and fail where a type in it is gone.
    home = cache_folder() / hashlib.sha256(str(_PACKAGE).encode()).hexdigest()[:12] / name
    folder = home / _closure_stamp(file)[:16]
    for stale in home.glob("*") if not folder.exists() else ():
        if stale != folder:
            shutil.rmtree(stale, ignore_errors=True)
    with suppress(OSError):
        folder.mkdir(parents=True, exist_ok=True)
    if not os.access(folder, os.W_OK):
        folder = _scratch() / name
        folder.mkdir(exist_ok=True)
    return folder


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
        # of other files numba's own locators decide
        return cls(py_func, py_file) if _resolved(py_file).is_relative_to(_PACKAGE) else None


@cache
def _resolved(path: str) -> Path:
    return Path(path).resolve()


caching.CacheImpl._locator_classes.insert(0, _ClosureLocator)


class _SeldomCollected(event.Listener):
    """Lets garbage lie from the beginning of a compilation to its end, those of its callees included: to collect none at all gains no more time and takes
    half as much memory again (1,100 MB for 720 while the kernels of a drape compile)."""

    def __init__(self) -> None:
        self._depth, self._before = 0, gc.get_threshold()

    def on_start(self, event: Any) -> None:
        if self._depth == 0:
            self._before = gc.get_threshold()
            gc.set_threshold(25_000, 10, 30)
        self._depth += 1

    def on_end(self, event: Any) -> None:
        self._depth -= 1
        if self._depth == 0:
            gc.set_threshold(*self._before)


event.register("numba:compile", _SeldomCollected())


@dataclass(frozen=True)
class _Callee:
    """A compiled kernel that others call by its symbol. Called, it makes sure that the symbol is there: numba does so before it loads a caller from disk."""

    module: str
    name: str
    arguments: tuple[Any, ...]

    def __call__(self) -> None:
        getattr(import_module(self.module), self.name).compile(self.arguments)


class KernelCache(caching.FunctionCache):
    """Numba's disk cache, for kernels that may call others by their symbols. What cannot be read, after a power loss, say, is compiled anew, and what cannot be
    written is not kept."""

    def _load_overload(self, sig: Any, target_context: Any) -> Any:
        with self._emptied_where_damaged():
            found = super()._load_overload(sig, target_context)
            if found is not None:
                found.library._reload_init.update(found.reload_init)
            return found
        return None

    def save_overload(self, sig: Any, data: Any) -> None:
        with suppress(OSError), self._emptied_where_damaged():
            super().save_overload(sig, data)

    def has(self, sig: Any, target_context: Any) -> bool:
        """Whether the kernel lies on disk for this signature."""
        target_context.refresh()
        with self._emptied_where_damaged():
            return self._index_key(sig, target_context.codegen()) in self._cache_file._load_index()
        return False

    @contextmanager
    def _emptied_where_damaged(self) -> Iterator[None]:
        try:
            yield
        except OSError:
            raise
        except Exception:  # a pickle that is torn raises what it likes
            with suppress(OSError):
                self._cache_file.flush()


def _link(library: Any, other: Any) -> None:
    """What numba does where compiled code calls other compiled code, which it takes in and optimises anew; a callee that stays apart is called where it is."""
    callee = getattr(other, "callee", None)
    if callee is None:
        _take_in(library, other)
    else:
        library._reload_init.add(callee)


_take_in = CPUCodeLibrary.add_linking_library
CPUCodeLibrary.add_linking_library = _link  # type: ignore[assignment, method-assign]


class LastingSymbol(Compiler):
    """Compiles as usual, but under a symbol that is the same in every process. Numba counts what it compiles, and the count is part of its symbols: one process
    could then not call what another compiled beside it."""

    def _compile_bytecode(self) -> Any:
        identity = self.state.func_id
        if is_lasting(identity.func):
            name = f"{identity.modname}.{identity.func_qualname}"
            identity.unique_id = int.from_bytes(hashlib.sha256(name.encode()).digest()[:7])
            identity.unique_name = f"{identity.func_qualname}${identity.unique_id}"
        return super()._compile_bytecode()


def is_lasting(function: Any) -> bool:
    """Whether another process finds this kernel by its module and name. What a function makes at each call it does not."""
    return "<locals>" not in function.__qualname__


def keep_apart(dispatcher: Any) -> None:
    """Let those that call this kernel, compiled by `LastingSymbol`, not take it in."""
    add = dispatcher.add_overload

    def add_apart(result: Any) -> None:
        function = dispatcher.py_func
        result.library.callee = _Callee(function.__module__, function.__name__, tuple(result.signature.args))
        add(result)

    dispatcher.add_overload = add_apart


def compile_beside(*wanted: tuple[Any, tuple[Any, ...]]) -> None:
    """Let another process compile kernels into the cache on disk, each for arguments like these, one after the other, where that has them not yet and there is
    a second processor for it.

    Nobody waits: a caller that is compiled meanwhile takes a kernel from disk if it is there by then.
    """
    processors = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    if processors < 2 or not sys.executable:
        return
    missing = []
    for dispatcher, arguments in wanted:
        signature = tuple(typeof(argument) for argument in arguments)
        kept = getattr(dispatcher, "_cache", None)  # in a scratch folder no other process would find it
        if isinstance(kept, KernelCache) and Path(kept.cache_path).is_relative_to(cache_folder()) and not _is_compiled(dispatcher, signature):
            missing.append((dispatcher.py_func.__module__, dispatcher.py_func.__name__, signature))
    if not missing:
        return
    paths = os.pathsep.join([str(_PACKAGE.parent), *filter(None, [os.environ.get("PYTHONPATH")])])
    command = [sys.executable, "-c", "import garmentcad.kernel_cache as kernel_cache; kernel_cache._compile_sent()"]
    quiet = subprocess.DEVNULL
    beside = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=quiet, stderr=quiet, env=os.environ | {"PYTHONPATH": paths})
    assert beside.stdin is not None
    with suppress(OSError), beside.stdin as pipe:
        pipe.write(pickle.dumps(missing))
    atexit.register(beside.kill)


def _is_compiled(dispatcher: Any, signature: tuple[Any, ...]) -> bool:
    return signature in dispatcher.overloads or dispatcher._cache.has(signature, dispatcher.targetctx)


def _compile_sent() -> None:
    for module, name, signature in pickle.load(sys.stdin.buffer):
        getattr(import_module(module), name).compile(signature)
