"""The one door between Python and compiled kernels: types and the kernel decorators.

Types are cast once, here (`floats`, `indices`); kernels take C-contiguous float64 and int32 arrays and write into their last arguments.
"""

from __future__ import annotations

import os
import threading
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from functools import cache
from typing import Any, NoReturn

# Between the parallel regions of a step a waiting thread spins. One that sleeps costs about 100 us a region to wake, and may wake on the other thread's core
# (a step then takes as long as on one thread); on a busy machine spinning loses more, but there two threads lose anyway. Read when the first region starts.
os.environ.setdefault("GOMP_SPINCOUNT", "3000000")

import llvmlite.binding as llvm
import numpy as np
from numba import config, get_num_threads, njit, types
from numba.core.compiler import Compiler
from numba.core.registry import CPUDispatcher

from garmentcad.kernel_cache import KernelCache, LastingSymbol, is_lasting, keep_apart

# Loops over many arrays use wide instructions only where the compiler may check at run time that the arrays do not overlap; by default it gives up after a few.
for _option in ("-runtime-memory-check-threshold=4000", "-vectorize-memory-check-threshold=4000", "-memory-check-merge-threshold=4000"):
    llvm.set_option("garmentcad", _option)


def wide_features(host: llvm.FeatureMap) -> str | None:
    """What kernels are compiled for on a processor with these features; None where LLVM chooses well by itself.

    On Intel's processors it keeps to half of the widest registers, because the first that had them slowed down when they were used. With those that have FP16,
    from Sapphire Rapids on, a settling skirt takes a tenth less when all are used (on Emerald Rapids; forces a fifth). The bits are the same.
    """
    return f"{host.flatten()},-prefer-256-bit" if host.get("avx512fp16") else None


if config.CPU_FEATURES is None:  # type: ignore[attr-defined]
    config.CPU_FEATURES = wide_features(llvm.get_host_cpu_features())  # type: ignore[attr-defined]

# Strict floating point. Contraction to fused operations would be 9 % faster, but which products it fuses changes with what a kernel is compiled into, and a
# process that has just compiled calls other copies of a kernel than one that loads it: the same run would end in other bits.
_OPTIONS: dict[str, Any] = {"nogil": True, "error_model": "numpy"}
# Kernels do not count references to arrays: they keep none, and their callers hold all. Where they counted, a call with a tuple of fifteen arrays was thirty
# calls more, and sweeps of contact, which make dozens of such calls a visit, took three times as long. The name is numba's own; it has no other for it.
_COUNTED = "_nrt"
_INNER: dict[str, Any] = {**_OPTIONS, "no_cpython_wrapper": True, "no_cfunc_wrapper": True, _COUNTED: False}


class _Kernel(CPUDispatcher):
    """A kernel that its callers find compiled for any whole number. Numba would compile it for every literal, and for the 0 that a counter begins with."""

    def get_call_template(self, args: Any, kws: Any) -> Any:
        return super().get_call_template(tuple(map(_plain, args)), {name: _plain(kind) for name, kind in kws.items()})


def _plain(kind: Any) -> Any:
    kind = types.unliteral(kind)
    return types.int64 if kind == types.int32 else kind


class _Inner(_Kernel):
    """A kernel that other kernels call. Python may call it, too, as tests do: through a kernel that is compiled for that in each process."""

    def __call__(self, *arguments: Any) -> Any:
        return _door(self)(*arguments)


@cache
def _door(inner: _Inner) -> Any:
    return njit(**_OPTIONS)(lambda *arguments: inner(*arguments))


def _compiled(function: Any, apart: bool = False, **options: Any) -> Any:
    if apart:
        options["pipeline_class"] = LastingSymbol
    dispatcher = njit(**{**_INNER, **options})(function)
    if hasattr(dispatcher, "py_func"):  # NUMBA_DISABLE_JIT leaves the function as it is
        dispatcher.__class__ = _Inner
        if is_lasting(function):
            dispatcher._cache = KernelCache(function)
        if apart:
            keep_apart(dispatcher)
    return dispatcher


def entry(inner: Any) -> Any:
    """Of a kernel that Python calls as well. What Python needs for that is compiled with it; in kernels that take many arrays it takes as long as the rest."""
    if hasattr(inner, "py_func"):
        inner.__class__ = _Kernel
        inner.targetoptions["no_cpython_wrapper"] = False
    return inner


def kernel(function: Any) -> Any:
    """Compile a kernel that runs on one thread (also the way to write scalar laws that other kernels call). It makes no arrays and returns none; of all kinds
    only `making_kernel` and `parallel_kernel` make some."""
    return _compiled(function)


def long_kernel(function: Any) -> Any:
    """Compile a kernel that runs on one thread and stays apart from those that call it."""
    return _compiled(function, apart=True)


class _Disjoint(Compiler):
    """Compiles as usual, and tells the optimiser that arguments do not overlap: numba knows the flag, but has no option for it."""

    def __init__(self, typing: Any, target: Any, library: Any, arguments: Any, result: Any, flags: Any, local_types: Any) -> None:
        flags.noalias = True
        super().__init__(typing, target, library, arguments, result, flags, local_types)


def making_kernel(function: Any) -> Any:
    """Compile a kernel as `long_kernel`, that makes arrays: what it makes, and with it all that it is given, is counted."""
    return _compiled(function, apart=True, **{_COUNTED: True})


def row_kernel(function: Any) -> Any:
    """Compile a kernel of wide loops. What it writes through one array argument it must not read or write through another; rows of one argument may be mixed.
    So the compiler need not check at run time, at every call, that some thirty rows do not overlap; to compile such checks takes half of its time."""
    return _compiled(function, pipeline_class=_Disjoint)


def inlined_kernel(function: Any) -> Any:
    """Compile a kernel that becomes part of every kernel that calls it, however long it is: wide loops may call no others."""
    return _compiled(function, forceinline=True)


def inlined(function: Any) -> Any:
    """A kernel that becomes part of those that call it: one compilation less. For what only deals out calls."""
    return _compiled(function, inline="always")


def parallel_kernel(function: Any) -> Any:
    """Compile a kernel with `prange`, apart from those that call it. Gather only: each iteration writes its own outputs; no reductions."""
    return _compiled(function, apart=True, parallel=True, **{_COUNTED: True})


# Work is dealt out in this many parts whatever the number of threads. A part is a call of its own: inside a compiled prange body, arrays of a named
# tuple cost 40 ns at each turn, and direct writes to them are lost (seen with numba 0.68). Rows are read as tuples: where references
# are counted (`making_kernel`) a view of an array counts its own, and two threads that count on the same line are no faster than one.
CHUNKS = 64


@kernel
def chunk_range(chunk, count):  # type: ignore[no-untyped-def]
    """First and last + 1 of the items 0..count-1 in a part."""
    return chunk * count // CHUNKS, (chunk + 1) * count // CHUNKS


_APART = threading.Lock()


@contextmanager
def threads_apart() -> Iterator[None]:
    """Keeps the calling thread on one processor and all others of this process off it, where the kernels use every processor that the process may use.
    Threads that their owner keeps to fewer processors stay there. Of several runs in threads of one process, one is kept apart: what each puts back
    would else be what another had set.

    The system else leaves two threads that wait for each other on one processor for seconds at a time, and a run takes twice as long now and then.
    """
    can = hasattr(os, "sched_setaffinity")
    allowed = os.sched_getaffinity(0) if can else set()
    if len(allowed) < 2 or get_num_threads() < len(allowed) or not _APART.acquire(blocking=False):
        yield
        return
    mine, first = threading.get_native_id(), min(allowed)
    here = _threads()
    owned = {thread for thread, processors in here.items() if processors != allowed}
    _place(here.keys() - owned - {mine}, allowed - {first})
    _place({mine}, {first})
    try:
        yield
    finally:
        # Threads that began in the meantime, too: a thread begins where the one is that starts it.
        _place(_threads().keys() - owned, allowed)
        _APART.release()


def _threads() -> dict[int, set[int]]:
    """The processors of each thread of this process."""
    found = {}
    for name in os.listdir("/proc/self/task"):
        with suppress(OSError):  # a thread that has ended
            found[int(name)] = os.sched_getaffinity(int(name))
    return found


def _place(threads: Iterable[int], processors: set[int]) -> None:
    for thread in threads:
        with suppress(OSError):
            os.sched_setaffinity(thread, processors)


def floats(values: Any) -> np.ndarray:
    """C-contiguous float64 array of `values`."""
    return np.ascontiguousarray(values, dtype=np.float64)


def indices(values: Any) -> np.ndarray:
    """C-contiguous int32 array of `values`."""
    return np.ascontiguousarray(values, dtype=np.int32)


def compact(values: np.ndarray) -> np.ndarray:
    """The same values (N,...), read-only where all rows are equal: they share the memory of one then."""
    return np.broadcast_to(values[0].copy(), values.shape) if len(values) > 1 and (values == values[0]).all() else values


def frozen(array: np.ndarray) -> np.ndarray:
    """The same array, read-only."""
    array.setflags(write=False)
    return array


class FrozenDict(dict[Any, Any]):
    """A mapping that many hold and nobody changes for the others; it can be copied and pickled, and `dict(it)` is one that may be changed."""

    def _refuse(self, *_: Any, **__: Any) -> NoReturn:
        raise TypeError("this mapping is shared and read-only; dict(...) of it may be changed")

    __setitem__ = __delitem__ = __ior__ = clear = pop = popitem = setdefault = update = _refuse

    def __reduce__(self) -> Any:
        return FrozenDict, (dict(self),)


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
