"""Dependent constraints are named, all of them and no others; against ranks by numpy."""

from __future__ import annotations

import numpy as np
import pytest

from garmentcad.constraints.conflict import dependences
from garmentcad.constraints.points import PointRows

NO_BODY = np.zeros((0, 3))


def rows(matrix: np.ndarray, targets: np.ndarray, shank: float = 0.0) -> PointRows:
    row, column = np.nonzero(matrix)
    count = len(matrix)
    return PointRows(row, column, matrix[row, column], targets, tuple("abcdefgh"[:count]), np.full(count, shank), np.zeros(count))


def test_minimal_sets_are_found_by_rank() -> None:
    """Of random rows, some of them combinations of others: a set named is dependent, and is not once any one of it is left out."""
    rng = np.random.default_rng(0)
    matrix = np.zeros((8, 12))
    for k in range(5):
        matrix[k, rng.choice(12, 3, replace=False)] = rng.uniform(0.2, 1.0, 3)
    share = np.array([[0.5, -1.0, 0, 0, 0], [0, 0, 2.0, 1.0, -0.3], [0, 0, 0, 0, 1.0]])
    matrix[5:] = share @ matrix[:5]
    points = rng.standard_normal((12, 3))
    targets = matrix @ points
    targets[6] += [0.0, 0.03, 0.0]
    found = dependences(rows(matrix, targets), 12, NO_BODY)
    assert sorted(dependence.names for dependence in found) == [("a", "b", "f"), ("c", "d", "e", "g"), ("e", "h")]
    for dependence in found:
        chosen = matrix[["abcdefgh".index(name) for name in dependence.names]]
        assert np.linalg.matrix_rank(chosen) == len(chosen) - 1
        assert all(np.linalg.matrix_rank(np.delete(chosen, k, axis=0)) == len(chosen) - 1 for k in range(len(chosen)))
    off = {dependence.names: dependence.off_m for dependence in found if dependence.conflicting}
    assert off.keys() == {("c", "d", "e", "g")}
    assert abs(off["c", "d", "e", "g"] - 0.03) < 1e-9


def test_rows_on_a_body_depend_by_where_it_stands() -> None:
    """Two pins of one particle to two nodes of a body agree where these are one point."""
    made = rows(np.array([[1.0, -1.0, 0.0], [1.0, 0.0, -1.0]]), np.zeros((2, 3)))
    body = np.array([[0.1, 0.2, 0.3], [0.1, 0.2, 0.3]])
    assert [found.conflicting for found in dependences(made, 1, body)] == [False]
    assert [found.off_m for found in dependences(made, 1, body + np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 0.05]]))] == [pytest.approx(0.05)]


def test_independent_rows_and_no_rows() -> None:
    assert dependences(rows(np.eye(3), np.zeros((3, 3))), 3, NO_BODY) == []
    assert dependences(rows(np.zeros((0, 3)), np.zeros((0, 3))), 3, NO_BODY) == []


def test_a_row_that_ties_a_point_to_itself_depends_on_nothing_else() -> None:
    """A button whose two points a seam has made one: the first row, or after another."""
    tie = PointRows(np.array([0, 0]), np.array([0, 0]), np.array([1.0, -1.0]), np.zeros((1, 3)), ("a",), np.zeros(1), np.zeros(1))
    assert [(found.names, found.off_m) for found in dependences(tie, 1, NO_BODY)] == [(("a",), 0.0)]
    both = PointRows(np.array([0, 1, 1]), np.zeros(3, np.int64), np.array([1.0, 1.0, -1.0]), np.zeros((2, 3)), ("a", "b"), np.zeros(2), np.zeros(2))
    assert [(found.names, found.off_m) for found in dependences(both, 1, NO_BODY)] == [(("b",), 0.0)]


def test_a_shank_is_no_conflict() -> None:
    """Both ends of a button are pinned: 1 mm apart they can hold, 3 mm apart not."""
    matrix = np.array([[1.0, 0.0], [0.0, 1.0], [1.0, -1.0]])
    for apart, conflicting in ((0.001, False), (0.003, True)):
        made = rows(matrix, np.array([[apart, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]]))
        made.shank[2] = 0.002
        assert [found.conflicting for found in dependences(made, 2, NO_BODY)] == [conflicting]
