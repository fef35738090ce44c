"""Functions and products that have the same bits on every processor: their values, and whole runs with the processor's wide registers and without."""

from __future__ import annotations

import json
import math
import os
import subprocess
import sys

import numpy as np
import pytest
from numpy._core._multiarray_umath import __cpu_dispatch__

from garmentcad.geometry.eigen import eigen
from garmentcad.geometry.portable import expm1, norm, product

RNG = np.random.default_rng(3)

# While they are sewn, with curved edges, darts and sleeves, on bodies of two kinds.
RUNS = """
import json
from numpy._core._multiarray_umath import __cpu_dispatch__, __cpu_features__
from garmentcad.simulation.job import make_job
from garmentcad.simulation.run import run
ends = {"used": [name for name in __cpu_dispatch__ if __cpu_features__[name]]}
for garment, body in (("straight-skirt", "woman-104"), ("t-shirt", "man-92")):
    outcome = run(make_job(garment, mannequin=body, grid_mm=40.0, max_time_s=0.2), lambda progress: None)
    ends[garment] = outcome.state.step, outcome.state.sha256()
print(json.dumps(ends))
"""


def test_runs_end_in_the_same_bits_where_numpy_and_its_linear_algebra_find_an_older_processor() -> None:
    older = {"OPENBLAS_CORETYPE": "Prescott", "NPY_DISABLE_CPU_FEATURES": " ".join(__cpu_dispatch__)}
    both = [subprocess.Popen([sys.executable, "-c", RUNS], env=os.environ | more, stdout=subprocess.PIPE, text=True) for more in ({}, older)]
    printed = [json.loads(process.communicate()[0]) for process in both]
    assert [run.pop("used") for run in printed][1] == []  # or the second were the first once more
    assert all(step >= 384 for step, _ in printed[0].values())
    assert printed[0] == printed[1]


def test_products_are_those_of_matrices() -> None:
    points, matrix, vector = RNG.normal(size=(5, 7, 3)), RNG.normal(size=(3, 4)), RNG.normal(size=3)
    assert np.allclose(product(points, matrix), points @ matrix, rtol=0, atol=1e-14)
    assert np.allclose(product(points, vector), points @ vector, rtol=0, atol=1e-14)
    assert float(product(vector, vector)) == pytest.approx(norm(vector) ** 2, rel=1e-15)
    assert norm(vector) == pytest.approx(math.dist(vector, (0, 0, 0)), rel=1e-15)


def test_exponentials_are_those_of_the_c_library() -> None:
    x = RNG.normal(size=40)
    assert expm1(x).tolist() == [math.expm1(a) for a in x]


@pytest.mark.parametrize("size", [1, 2, 3, 4, 9])
def test_eigenvalues_and_vectors_of_symmetric_matrices(size: int) -> None:
    root = RNG.normal(size=(20, size, size))
    root[::2, -1] = root[::2, 0]  # half of them are singular, as blocks of constraints are that repeat each other
    matrices = root @ root.transpose(0, 2, 1)
    matrices[3] = 0.0
    upper = np.triu_indices(size, 1)
    given = matrices.copy()
    given[:, upper[0], upper[1]] = np.nan  # the lower triangles count
    values, vectors = eigen(given)
    assert np.allclose(np.sort(values, axis=1), np.linalg.eigvalsh(matrices), rtol=0, atol=1e-13 * np.abs(matrices).max())
    assert np.allclose(vectors.transpose(0, 2, 1) @ vectors, np.eye(size), rtol=0, atol=1e-14)
    assert np.allclose(matrices @ vectors, vectors * values[:, None], rtol=0, atol=1e-13 * np.abs(matrices).max())
