"""Row kernels: the optimiser is told that their arrays do not overlap, which spares the checks at each call. What they compute is that of plain kernels."""

from __future__ import annotations

import re

import numpy as np
from numba.core.caching import NullCache

from garmentcad.arrays import kernel, row_kernel


def sums(a, b, c, out):  # type: ignore[no-untyped-def]
    for i in range(np.uint64(len(out))):
        out[i] = a[i] + b[i] * c[i]


def test_the_optimiser_need_not_check_whether_rows_overlap() -> None:
    rows = [np.random.default_rng(seed).standard_normal(37) for seed in range(3)]
    checks, results = [], []
    for decorate in (kernel, row_kernel):
        compiled, out = decorate(sums), np.zeros(37)
        compiled._cache = NullCache()  # what comes from disk cannot be looked into
        compiled(*rows, out)
        code = compiled.inspect_llvm(compiled.signatures[0])
        assert re.search(r"<\d+ x double>", code)
        checks.append(len(re.findall(r"^vector\.memcheck", code, re.MULTILINE)))
        results.append(out)
    assert checks[0] > checks[1] == 0
    np.testing.assert_array_equal(*results)
