"""Which constraints repeat others, and which contradict them: row by row, each as a combination of those before it.

A row that is no combination of earlier ones can always be met. One that is, r = sum c_i r_i, holds by itself where its target is sum c_i t_i (redundant), and
never where it is not (conflicting). The rows with c_i != 0 are the ones it repeats or contradicts: a minimal set, because the earlier rows are independent.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import solve_triangular
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from garmentcad.constraints.points import PointRows

_DEPENDENT = 1e-6  # of a row's length that no combination of others reaches
_COUNTS = 1e-6  # a smaller share of a row in another is round-off
_MET_M = 1e-4  # constraints that are off by less do not contradict each other


@dataclass(frozen=True)
class Dependence:
    """A constraint that depends on others. names: of all of them, in the order of the rows, or its own alone where it ties a point to that point;
    off_m: by how much they cannot all be met, 0 where they can."""

    names: tuple[str, ...]
    off_m: float

    @property
    def conflicting(self) -> bool:
        return self.off_m > 0.0


def dependences(rows: PointRows, count: int, body: np.ndarray) -> list[Dependence]:
    """Dependences among rows on `count` particles; body: (V,3) m, where the nodes of the body are."""
    size = len(rows.targets)
    if size == 0:
        return []
    free = rows.particle < count
    matrix = coo_matrix((rows.weight[free], (rows.row[free], rows.particle[free])), shape=(size, count)).tocsr()
    targets = rows.targets.copy()
    np.subtract.at(targets, rows.row[~free], rows.weight[~free, None] * body[rows.particle[~free] - count])
    found = []
    _, label = connected_components(matrix @ matrix.T, directed=False)
    for block in (np.flatnonzero(label == number) for number in range(label.max() + 1)):
        part = matrix[block]
        found += _within(part[:, np.unique(part.indices)].toarray(), targets[block], rows.shank[block], [rows.names[k] for k in block])
    return found


def _within(matrix: np.ndarray, targets: np.ndarray, shank: np.ndarray, names: list[str]) -> list[Dependence]:
    found = []
    basis, triangle = np.zeros_like(matrix), np.zeros((len(matrix), len(matrix)))  # rows of `sound` = triangle^T basis
    sound: list[int] = []
    for k, row in enumerate(matrix):
        rank = len(sound)
        share, left = np.zeros(rank), row
        for _ in range(2):  # once more, against round-off
            step = basis[:rank] @ left
            share, left = share + step, left - step @ basis[:rank]
        length = float(np.linalg.norm(left))
        if length > _DEPENDENT * float(np.linalg.norm(row)):
            basis[rank], triangle[:rank, rank], triangle[rank, rank] = left / length, share, length
            sound.append(k)
            continue
        share = solve_triangular(triangle[:rank, :rank], share)
        used = np.abs(share) > _COUNTS
        others = np.array(sound, dtype=np.int64)[used]  # none where a row has no particles of its own left
        # a shank may point anywhere
        slack = float(shank[k] + np.abs(share[used]) @ shank[others])
        off = float(np.linalg.norm(targets[k] - share[used] @ targets[others])) - slack
        chosen = tuple(dict.fromkeys(names[n] for n in sorted([*others.tolist(), k])))
        found.append(Dependence(chosen, off if off > _MET_M else 0.0))
    return found
