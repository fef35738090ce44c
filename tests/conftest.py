"""What holds for every test."""

from __future__ import annotations

import os
from collections.abc import Iterator

# Before numpy and numba are loaded: tests run beside each other, and threads of linear algebra, which gain nothing in small cloths, or such that spin while
# they wait for each other, would take the other one's core.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
os.environ.setdefault("GOMP_SPINCOUNT", "0")

import numba
import pytest

# Two workers take files in this order: the longest first, so that neither is left with one at the end; and of the first two only one compiles the kernels
# of a drape, which the other finds on disk afterwards.
FIRST = ("test_run.py", "test_fuzz.py", "test_howto.py", "test_cli.py", "test_shipped_patterns.py", "test_importing.py", "test_contact_stress.py")


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    items.sort(key=lambda item: FIRST.index(item.path.name) if item.path.name in FIRST else len(FIRST))


@pytest.fixture(autouse=True)
def _one_thread() -> Iterator[None]:
    """Tests run beside each other: a second thread of one spins on the core of another, and small cloths gain nothing from it. A test that asks for more
    leaves none behind."""
    numba.set_num_threads(1)
    yield
    numba.set_num_threads(1)
