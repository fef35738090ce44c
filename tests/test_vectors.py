"""Rows of vectors against plain arithmetic, number by number."""

from __future__ import annotations

import math

import numpy as np

from garmentcad.geometry.vectors import dots, lengths, picked

A, B = np.random.default_rng(1).standard_normal((2, 500, 3))


def test_products_and_lengths_are_those_of_each_row() -> None:
    for a, b, product, length in zip(A.tolist(), B.tolist(), dots(A, B), lengths(A)):
        assert product == (a[0] * b[0] + a[1] * b[1]) + a[2] * b[2]
        assert length == math.sqrt((a[0] * a[0] + a[1] * a[1]) + a[2] * a[2])


def test_picked_points_stand_column_by_column() -> None:
    rows = np.random.default_rng(2).integers(0, len(A), (40, 4)).astype(np.int32)
    found = picked(A, rows)
    assert len(found) == 4
    for k, points in enumerate(found):
        assert points.tolist() == [A[row].tolist() for row in rows[:, k]]
    assert [points.shape for points in picked(A, rows[:0])] == [(0, 3)] * 4
