"""The door to the kernels leaves the process of its caller as it was."""

from __future__ import annotations

import os
import subprocess
import sys
import threading

import llvmlite.binding as llvm
import pytest

from garmentcad import arrays
from garmentcad.arrays import threads_apart, wide_features

ALL = {0, 1, 2, 3}


@pytest.fixture
def processors(monkeypatch: pytest.MonkeyPatch) -> dict[int, set[int]]:
    """Those of each thread, as on a machine with four and as many threads of kernels."""
    placed: dict[int, set[int]] = {}

    def get(thread: int) -> set[int]:
        return set(placed.get(thread or threading.get_native_id(), ALL))

    monkeypatch.setattr(os, "sched_getaffinity", get, raising=False)
    monkeypatch.setattr(os, "sched_setaffinity", lambda thread, chosen: placed.update({thread: set(chosen)}), raising=False)
    monkeypatch.setattr(os, "listdir", lambda folder: [str(thread.native_id) for thread in threading.enumerate()])
    monkeypatch.setattr(arrays, "get_num_threads", lambda: 4)
    return placed


class Waiting(threading.Thread):
    """A thread that does nothing until it is let go."""

    def __init__(self) -> None:
        super().__init__()
        self.free = threading.Event()
        self.start()

    def run(self) -> None:
        self.free.wait()

    def end(self) -> None:
        self.free.set()
        self.join()


def test_threads_go_back_to_where_their_owner_has_them(processors: dict[int, set[int]]) -> None:
    pinned, other, mine = Waiting(), Waiting(), threading.get_native_id()
    processors[pinned.native_id or 0] = {2}
    with threads_apart():
        assert (processors[mine], processors[other.native_id or 0], processors[pinned.native_id or 0]) == ({0}, {1, 2, 3}, {2})
        late = Waiting()
        processors[late.native_id or 0] = {0}  # as the thread that started it
    assert [processors[thread] for thread in (mine, other.native_id or 0, late.native_id or 0)] == [ALL, ALL, ALL]
    assert processors[pinned.native_id or 0] == {2}
    for thread in (pinned, other, late):
        thread.end()


def test_runs_in_two_threads_leave_no_processor_unused(processors: dict[int, set[int]]) -> None:
    go, entered, leave, mine = threading.Event(), threading.Event(), threading.Event(), threading.get_native_id()

    def second() -> None:
        go.wait()
        with threads_apart():
            entered.set()
            leave.wait()

    beside = threading.Thread(target=second)
    beside.start()
    with threads_apart():
        go.set()
        entered.wait()
    leave.set()
    beside.join()
    assert (processors[mine], processors[beside.native_id or 0]) == (ALL, ALL)
    with threads_apart():
        assert processors[mine] == {0}, "the next run is kept apart again"


def compiled_for(cpu: str, features: str) -> str:
    """Assembly of a loop c = a + b over doubles for an x86 processor that need not be this one."""
    pointers, body = "ptr noalias %a, ptr noalias %b, ptr noalias %c", ""
    for name in "abc":
        body += f"%p{name} = getelementptr double, ptr %{name}, i64 %i\n"
    body += "%x = load double, ptr %pa\n%y = load double, ptr %pb\n%z = fadd double %x, %y\nstore double %z, ptr %pc\n"
    code = f"define void @add({pointers}) {{\nstart:\nbr label %loop\nloop:\n%i = phi i64 [0, %start], [%j, %loop]\n{body}"
    code += "%j = add i64 %i, 1\n%done = icmp eq i64 %j, 4096\nbr i1 %done, label %end, label %loop\nend:\nret void\n}"
    llvm.initialize_all_targets()
    llvm.initialize_all_asmprinters()
    machine = llvm.Target.from_triple("x86_64-unknown-linux-gnu").create_target_machine(cpu=cpu, features=features, opt=3)
    module = llvm.parse_assembly(code)
    passes = llvm.create_pass_builder(machine, llvm.create_pipeline_tuning_options(speed_level=3))
    passes.getModulePassManager().run(module, passes)
    return str(machine.emit_assembly(module))


def test_the_widest_registers_are_used_where_they_do_not_slow_down() -> None:
    host = llvm.FeatureMap({"avx512f": True, "avx512fp16": True})
    assert "zmm" not in compiled_for("sapphirerapids", host.flatten())
    assert "zmm" in compiled_for("sapphirerapids", wide_features(host) or "")
    assert wide_features(llvm.FeatureMap({"avx512f": True, "avx512fp16": False})) is None


def test_what_a_user_names_of_the_processor_stays() -> None:
    """Kernels for any processor, as someone wants who compares bits: an empty list of features is one, too."""
    told = "import garmentcad.arrays; from numba import config; print(repr(config.CPU_FEATURES))"
    done = subprocess.run([sys.executable, "-c", told], env=os.environ | {"NUMBA_CPU_FEATURES": ""}, capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "''"
