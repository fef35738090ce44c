"""Long kernels stay apart from those that call them: also when both come from disk, and when the one on disk is not the one that was called."""

import gc
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from numba import int64, njit
from numba.core import event
from numba.core.errors import TypingError

from garmentcad.arrays import kernel, long_kernel

CALLEE = """
from garmentcad.arrays import entry, kernel, long_kernel

@entry
@kernel
def other(x):
    return x - 1.0

@long_kernel
def twice(x):
    return 2.0 * x
"""
CALLER = """
from callee import twice
from garmentcad.arrays import entry, kernel

@kernel
def between(x):
    return twice(x) + 1.0

@entry
@kernel
def above(x):
    return between(x) + 10.0
"""
# `other` compiled first is one more that numba has counted when it compiles `twice`.
RUN = """
import sys
import callee, caller
if sys.argv[1] != "alone":
    getattr(callee, sys.argv[1])(1.0)
print(caller.above(3.0), sum(caller.above.stats.cache_hits.values()))
"""

BESIDE = """
import os
import time
os.sched_getaffinity = lambda process: {0, 1}  # as on a machine with two processors
os.cpu_count = lambda: 2
import callee
from garmentcad.kernel_cache import compile_beside
from numba import float64
kernels = callee.twice, callee.other
def on_disk():
    return [kernel._cache.has((float64,), kernel.targetctx) for kernel in kernels]
before = on_disk()
compile_beside(*((kernel, (1.0,)) for kernel in kernels))
tries = 0
while not all(on_disk()) and tries < 3000:
    tries += 1
    time.sleep(0.1)
print(any(before), *(kernel(3.0) for kernel in kernels), *(sum(kernel.stats.cache_hits.values()) for kernel in kernels))
"""


def run(folder: Path, how: str, script: str = RUN) -> list[str]:
    paths = f"{folder}{os.pathsep}{Path(__file__).resolve().parents[1]}"
    environment = os.environ | {"NUMBA_CACHE_DIR": str(folder / "cache"), "PYTHONPATH": paths}
    done = subprocess.run([sys.executable, "-c", script, how], env=environment, capture_output=True, text=True, check=True)
    return done.stdout.split()


def test_callers_on_disk_find_the_kernels_that_they_call(tmp_path):
    (tmp_path / "callee.py").write_text(CALLEE)
    (tmp_path / "caller.py").write_text(CALLER)
    assert run(tmp_path, "alone") == ["17.0", "0"]
    assert run(tmp_path, "alone") == ["17.0", "1"]
    # a caller compiled anew takes in one that comes from disk, and with it whom that calls
    for file in tmp_path.glob("cache/**/caller.above*"):
        file.unlink()
    assert run(tmp_path, "alone") == ["17.0", "0"]
    assert run(tmp_path, "alone") == ["17.0", "1"]
    # a callee compiled anew, by a process that had compiled something else before, is the one that callers on disk call
    for file in tmp_path.glob("cache/**/callee.twice*"):
        file.unlink()
    assert run(tmp_path, "other") == ["17.0", "1"]
    # and the other way round: this process compiles it for itself, and takes a caller from disk that one with another count has compiled
    for file in tmp_path.glob("cache/**/callee.twice*"):
        file.unlink()
    assert run(tmp_path, "twice") == ["17.0", "1"]


def test_another_process_compiles_a_kernel_into_the_cache(tmp_path):
    (tmp_path / "callee.py").write_text(CALLEE)
    assert run(tmp_path, "alone", BESIDE) == ["False", "6.0", "2.0", "1", "1"]


def test_a_caller_does_not_hold_its_long_callee():
    @long_kernel
    def long(x):
        return 3.0 * x

    @kernel
    def short(x):
        return x + 1.0

    @kernel
    def caller(x):
        return long(short(x))

    assert caller(1.0) == 6.0
    (code,) = caller.inspect_llvm().values()
    (symbol,) = (result.fndesc.llvm_func_name for result in long.overloads.values())
    assert any(line.startswith("declare") and symbol in line for line in code.splitlines())
    assert "fmul" not in code  # the callee's product


def test_one_compilation_serves_all_whole_numbers_that_kernels_pass():
    @kernel
    def doubled(n):
        return 2 * n

    @kernel
    def caller(numbers, count):
        found = 0  # begins as a literal, goes on as a number
        for k in range(count):
            found += doubled(found) + doubled(numbers[k])
        return found + doubled(7) + doubled(n=1)

    numbers, expected = np.arange(5, dtype=np.int32), 0
    for number in range(5):
        expected += 2 * expected + 2 * number
    assert caller(numbers, 5) == expected + 16
    assert list(doubled.overloads) == [(int64,)]


def test_garbage_is_collected_seldom_while_numba_compiles_and_as_before_then():
    before, meanwhile = gc.get_threshold(), []

    class Watch(event.Listener):
        def on_start(self, event):
            meanwhile.append(gc.get_threshold())

        def on_end(self, event):
            meanwhile.append(gc.get_threshold())

    @njit
    def inner(x):
        return x + 1.0

    @njit
    def outer(x):
        return inner(x)

    @njit
    def broken(x):
        return inner(x).nothing

    with event.install_listener("numba:compile", Watch()):
        outer(1.0)
        with pytest.raises(TypingError):
            broken(1)
    # the last end of each is heard when all is as before: of outer, and of broken, whose callee is compiled for whole numbers
    assert [threshold[0] > 10 * before[0] for threshold in meanwhile] == [True, True, True, False, True, True, True, False]
    assert gc.get_threshold() == before
