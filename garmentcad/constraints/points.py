"""Dynamic constraints on weighted points: stitches that close, pins, buttons, points on moving bodies.

A row is C = sum_k w_k x_k - target = 0 (three axes). Demanded is C'' = -ks C - kd C' with kd = 2 sqrt(ks) (critical damping), so that C decays as
(1 + r t) exp(-r t) with the closing rate r = sqrt(ks). The multipliers solve (J M^-1 J^T) lambda = -(J' v + J M^-1 f + ks C + kd C'); J is constant here,
so J' v = 0, the matrix is one scalar per pair of rows, and it falls into small blocks of rows that share particles. All rows are solved together.
Source: Witkin, Gleicher, Welch 1990 (dynamic constraints); Baumgarte 1972 (the decay).

The correction is applied to velocities after the forces: what the multipliers add over one step is M^-1 J^T A^-1 (wanted C' - J v).
C' is carried along as it was demanded, not as contact left it: a contact that stops one end would otherwise feed the force on the stopped end into the
other end, step by step. A multiplier is a force and has a cap, so that a seam that cannot close does not tear the cloth.

A row may have a shank: points that are joined by a thread. Within its length C is 0, and the row holds them as they are; beyond it
C = (1 - shank/|d|) d with d = sum_k w_k x_k - target.

The last millimetres of an exponential decay are slow, and two ends that are pressed onto both flanks of a ridge of the body are driven apart faster than it
demands: they would stand still before they meet. So a closing speed has a floor, until the way left is less than ten steps of it; of fewer steps where layers
that stand apart hold the row open, which then pulls harder.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.sparse import coo_matrix, csr_matrix, diags
from scipy.sparse.csgraph import connected_components

from garmentcad.arrays import floats, indices, kernel, long_kernel, making_kernel
from garmentcad.errors import InputError
from garmentcad.geometry.closest import dot
from garmentcad.geometry.eigen import eigen

LEAST_SHARE = 0.1  # of its way, that the floor of the closing speed closes in a step at most
_FASTEST = math.sqrt(0.1)  # of rate times step, so that ks dt^2 < 0.1


@dataclass(frozen=True)
class PointRows:
    """Rows of constraints. row, particle, weight: (K,) entries of J; targets (R,3) m; names (R,) what each row serves (a seam, a pin).

    The nodes of a body are numbered after the particles: an entry there ties a row to the body wherever that moves. shank: (R,) m, within which C is 0.
    order: (R,) of the seams with which a row closes, at the earliest.
    """

    row: np.ndarray
    particle: np.ndarray
    weight: np.ndarray
    targets: np.ndarray
    names: tuple[str, ...]
    shank: np.ndarray
    order: np.ndarray

    @classmethod
    def plain(cls, row: np.ndarray, particle: np.ndarray, weight: np.ndarray, targets: np.ndarray, names: tuple[str, ...]) -> PointRows:
        """Rows whose targets stand still."""
        return cls(row, particle, weight, targets, names, np.zeros(len(targets)), np.zeros(len(targets)))


def joined_rows(first: PointRows, second: PointRows) -> PointRows:
    """The rows of both, those of the first in front."""
    return PointRows(
        np.concatenate([first.row, second.row + len(first.targets)]),
        np.concatenate([first.particle, second.particle]),
        np.concatenate([first.weight, second.weight]),
        np.concatenate([first.targets, second.targets]),
        first.names + second.names,
        np.concatenate([first.shank, second.shank]),
        np.concatenate([first.order, second.order]),
    )


def rows_where(rows: PointRows, kept: np.ndarray) -> PointRows:
    """Those of the rows that `kept` (R,) bool names."""
    entries, number = kept[rows.row], np.cumsum(kept) - 1
    names = tuple(rows.names[k] for k in np.flatnonzero(kept))
    return PointRows(number[rows.row[entries]], rows.particle[entries], rows.weight[entries], rows.targets[kept], names, rows.shank[kept], rows.order[kept])


def stitch_rows(stitches: np.ndarray, names: tuple[str, ...]) -> PointRows:
    """Rows that bring the two particles of each stitch (S,2) together."""
    count = len(stitches)
    return PointRows.plain(np.repeat(np.arange(count), 2), stitches.ravel(), np.tile([1.0, -1.0], count), np.zeros((count, 3)), names)


class Rows(NamedTuple):
    """A sparse matrix by rows."""

    starts: np.ndarray  # (R+1,) int32
    columns: np.ndarray  # (K,) int32
    values: np.ndarray  # (K,)


class Bonds(NamedTuple):
    """What kernels need of constraints: J, A^-1 and M^-1 J^T, targets, and the demanded speeds, which change."""

    jacobian: Rows
    solved: Rows
    spread: Rows
    targets: np.ndarray  # (R,3) m
    wanted: np.ndarray  # (R,3) m/s
    forces: np.ndarray  # (R,3) N, multipliers
    shanks: np.ndarray  # (R,) m
    least: np.ndarray  # (R,) m/s, floor of the closing speed
    least_share: np.ndarray  # (R,) of the way left, that this floor closes in a step at most
    numbers: np.ndarray  # (3,) rate 1/s, largest force N, 1 where the forces stay as they are


@kernel
def _row_times(rows, r, vectors):  # type: ignore[no-untyped-def]
    x = y = z = 0.0
    for j in range(rows.starts[r], rows.starts[r + 1]):
        c, value = rows.columns[j], rows.values[j]
        x, y, z = x + value * vectors[c, 0], y + value * vectors[c, 1], z + value * vectors[c, 2]
    return x, y, z


@kernel
def demand_speeds(bonds, positions, time_step):  # type: ignore[no-untyped-def]
    """Demanded C' after this step, in place, from the gaps and the demanded C' at its beginning."""
    rate = min(bonds.numbers[0], _FASTEST / time_step)
    for r in range(len(bonds.targets)):
        least_speed = bonds.least[r]
        x, y, z = _row_times(bonds.jacobian, r, positions)
        away = x - bonds.targets[r, 0], y - bonds.targets[r, 1], z - bonds.targets[r, 2]
        share = max(0.0, 1.0 - bonds.shanks[r] / max(math.sqrt(dot(away, away)), 1e-12)) if bonds.shanks[r] > 0.0 else 1.0
        length = along = 0.0
        for axis in range(3):
            difference = share * away[axis]
            bonds.wanted[r, axis] = (1.0 - 2.0 * rate * time_step) * bonds.wanted[r, axis] - rate**2 * time_step * difference
            length += difference * difference
            along -= difference * bonds.wanted[r, axis]
        length = max(math.sqrt(length), 1e-12)
        lacking = min(least_speed, bonds.least_share[r] * length / time_step) - along / length
        if least_speed > 0.0 and lacking > 0.0:
            # Straight on: what is added along the gap would turn with it, and two ends circled each other at 3 m/s, 1.3 mm apart.
            for axis in range(3):
                bonds.wanted[r, axis] = -(along / length + lacking) * share * away[axis] / length


@making_kernel
def correct_speeds(bonds, time_step, velocities):  # type: ignore[no-untyped-def]
    """Add to velocities, in place, what the constraint forces of this step add."""
    count, largest = len(bonds.targets), bonds.numbers[1] * time_step
    lacking = np.empty((count, 3))
    for r in range(count):
        speed = _row_times(bonds.jacobian, r, velocities)
        for axis in range(3):
            lacking[r, axis] = bonds.wanted[r, axis] - speed[axis]
    for r in range(count):
        impulse = _row_times(bonds.solved, r, lacking)
        size = math.sqrt(impulse[0] ** 2 + impulse[1] ** 2 + impulse[2] ** 2)
        share = largest / size if size > largest else 1.0
        for axis in range(3):
            bonds.forces[r, axis] = share * impulse[axis] / time_step
    push(bonds, time_step, velocities)


@kernel
def push(bonds, time_step, velocities):  # type: ignore[no-untyped-def]
    """Add to velocities, in place, what the constraint forces do in a step."""
    for p in range(len(bonds.spread.starts) - 1):
        if bonds.spread.starts[p + 1] > bonds.spread.starts[p]:
            change = _row_times(bonds.spread, p, bonds.forces)
            for axis in range(3):
                velocities[p, axis] += time_step * change[axis]


@long_kernel
def apply_bonds(bonds, positions, time_step, velocities):  # type: ignore[no-untyped-def]
    """The constraints of a step, after its forces."""
    if bonds.numbers[2] > 0.0:
        push(bonds, time_step, velocities)
    else:
        demand_speeds(bonds, positions, time_step)
        correct_speeds(bonds, time_step, velocities)


def _rows(matrix: csr_matrix) -> Rows:
    return Rows(indices(matrix.indptr), indices(matrix.indices), floats(matrix.data))


def no_bonds() -> Bonds:
    """No constraint at all."""
    empty = Rows(np.zeros(1, np.int32), np.zeros(0, np.int32), np.zeros(0))
    none = np.zeros((0, 3))
    return Bonds(empty, empty, empty, none, none, none, np.zeros(0), np.zeros(0), np.zeros(0), np.zeros(3))


class ConstraintPoints:
    """All point constraints of a cloth, solved together at each step.

    rate: closing rate r [1/s]; ks = r^2, and steps so long that ks dt^2 would exceed 0.1 take a lower one. cap: largest force of a row [N].
    least_speed: floor of the closing speed [m/s], one or (R,); least_share: of the way left, that the floor closes in a step at most, alike. nodes: number of
    particles and nodes of a body, as many as the positions have that it is given; default: the particles alone.
    `loaded`: the multipliers stay what they were. Where contact holds against a constraint, what each of them carries depends on the inertia of the moment;
    whether forces balance does not.
    `redundant` names rows that repeat others (they are solved by least squares).
    """

    def __init__(
        self, rows: PointRows, inverse_masses: np.ndarray, rate: float, cap: float = np.inf, least_speed: float | np.ndarray = 0.0, nodes: int | None = None
    ) -> None:
        self.names, self.cap, self.least_speed = rows.names, cap, least_speed
        self.targets, self.rate = rows.targets, rate
        self.least_share: float | np.ndarray = LEAST_SHARE
        self._shanks = rows.shank
        count = len(inverse_masses) if nodes is None else nodes
        self._jacobian: csr_matrix = coo_matrix((rows.weight, (rows.row, rows.particle)), shape=(len(rows.targets), count)).tocsr()
        self.loaded = False
        self.redundant: tuple[str, ...] = ()
        self.set_inverse_masses(inverse_masses)

    def set_inverse_masses(self, inverse_masses: np.ndarray) -> None:
        """Masses (P,) 1/kg changed: factor the blocks anew. InputError where a row holds only fixed particles away from their target."""
        mobility = np.zeros(self._jacobian.shape[1])  # a body goes its own way
        mobility[: len(inverse_masses)] = inverse_masses
        spread: csr_matrix = (diags(mobility) @ self._jacobian.T).tocsr()
        matrix = (self._jacobian @ spread).tocsr()
        self._spread: csr_matrix = spread[: len(inverse_masses)]
        if (matrix.diagonal() <= 0.0).any():
            raise InputError(f"constraint '{self.names[int(np.argmin(matrix.diagonal()))]}' acts on fixed particles only; at least one must be free to move")
        count, label = connected_components(matrix, directed=False)
        sizes = np.bincount(label, minlength=count)
        alone = np.flatnonzero(sizes[label] == 1)
        rows, columns, values = [alone], [alone], [1.0 / matrix.diagonal()[alone]]
        redundant: set[str] = set()
        order = np.argsort(label, kind="stable")
        first = np.cumsum(sizes) - sizes
        entry, place = matrix.tocoo(), np.empty(len(order), dtype=np.int64)
        place[order] = np.arange(len(order)) - first[label[order]]  # of a row in its block
        for size in np.unique(sizes[sizes > 1]):
            blocks = np.flatnonzero(sizes == size)
            members = order[first[blocks, None] + np.arange(size)]
            mine = sizes[label[entry.row]] == size
            row, column = entry.row[mine], entry.col[mine]
            block = np.zeros((len(blocks), size, size))
            block[np.searchsorted(blocks, label[row]), place[row], place[column]] = entry.data[mine]
            eigenvalues, vectors = eigen(block)
            sound = eigenvalues > 1e-9 * eigenvalues.max(axis=1, keepdims=True)
            inverse = np.einsum("bik,bjk->bij", vectors * np.divide(1.0, eigenvalues, out=np.zeros_like(eigenvalues), where=sound)[:, None], vectors)
            repeated = ((np.abs(vectors) > 1e-6) & ~sound[:, None]).any(axis=2)
            redundant |= {self.names[k] for k in members[repeated]}
            rows.append(np.repeat(members, size, axis=1).ravel())
            columns.append(np.tile(members, size).ravel())
            values.append(inverse.ravel())
        size = len(self.targets)
        solved = coo_matrix((np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))), shape=(size, size)).tocsr()
        self._solved: csr_matrix = solved
        self.redundant = tuple(sorted(redundant))

    def gaps(self, positions: np.ndarray) -> np.ndarray:
        """C (R,3), m; positions: of all nodes, as in `speeds`."""
        away = self._jacobian @ positions - self.targets
        return away * (1.0 - self._shanks / np.maximum(np.linalg.norm(away, axis=1), np.maximum(self._shanks, 1e-12)))[:, None]

    def speeds(self, velocities: np.ndarray) -> np.ndarray:
        """C' (R,3), m/s, for targets at rest."""
        return self._jacobian @ velocities

    def pulls(self, forces: np.ndarray) -> np.ndarray:
        """What multipliers (R,3) N do to the particles (P,3), N."""
        return np.asarray(self._jacobian[:, : self._spread.shape[0]].T @ forces)

    def bonds(self, wanted: np.ndarray, forces: np.ndarray) -> Bonds:
        """The constraints as `apply_bonds` needs them; wanted, forces (R,3): the demanded C' and the multipliers, which it changes in place."""
        return Bonds(
            _rows(self._jacobian), _rows(self._solved), _rows(self._spread), floats(self.targets), wanted, forces, floats(self._shanks),
            np.full(len(wanted), self.least_speed, dtype=np.float64),
            np.full(len(wanted), self.least_share, dtype=np.float64),
            floats([self.rate, self.cap, float(self.loaded)]),
        )  # fmt: skip
