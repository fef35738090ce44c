"""What holds for every test."""

from __future__ import annotations

from collections.abc import Iterator

import numba
import pytest


@pytest.fixture(autouse=True)
def _one_thread() -> Iterator[None]:
    """Tests run beside each other: a second thread of one spins on the core of another, and small cloths gain nothing from it. A test that asks for more
    leaves none behind."""
    numba.set_num_threads(1)
    yield
    numba.set_num_threads(1)
