"""Dynamic constraints on weighted points: stitches that close, pins, points on moving bodies.

A row is C = sum_k w_k x_k - target = 0 (three axes). Demanded is C'' = -ks C - kd C' with kd = 2 sqrt(ks) (critical damping), so that C decays as
(1 + r t) exp(-r t) with the closing rate r = sqrt(ks). The multipliers solve (J M^-1 J^T) lambda = -(J' v + J M^-1 f + ks C + kd C'); J is constant here,
so J' v = 0, the matrix is one scalar per pair of rows, and it falls into small blocks of rows that share particles. All rows are solved together.
Source: Witkin, Gleicher, Welch 1990 (dynamic constraints); Baumgarte 1972 (the decay).

The correction is applied to velocities after the forces: what the multipliers add over one step is M^-1 J^T A^-1 (wanted C' - J v).
C' is carried along as it was demanded, not as contact left it: a contact that stops one end would otherwise feed the force on the stopped end into the
other end, step by step. A multiplier is a force and has a cap, so that a seam that cannot close does not tear the cloth.

The last millimetres of an exponential decay are slow, and two ends that are pressed onto both flanks of a ridge of the body are driven apart faster than it
demands: they would stand still before they meet. So a closing speed has a floor, until the way left is less than ten steps of it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_matrix, csr_matrix, diags
from scipy.sparse.csgraph import connected_components

from garmentcad.errors import InputError


@dataclass(frozen=True)
class PointRows:
    """Rows of constraints. row, particle, weight: (K,) entries of J; targets (R,3) m; names (R,) what each row serves (a seam, a pin)."""

    row: np.ndarray
    particle: np.ndarray
    weight: np.ndarray
    targets: np.ndarray
    names: tuple[str, ...]


def stitch_rows(stitches: np.ndarray, names: tuple[str, ...]) -> PointRows:
    """Rows that bring the two particles of each stitch (S,2) together."""
    count = len(stitches)
    return PointRows(np.repeat(np.arange(count), 2), stitches.ravel(), np.tile([1.0, -1.0], count), np.zeros((count, 3)), names)


class ConstraintPoints:
    """All point constraints of a cloth, solved together at each step.

    rate: closing rate r [1/s]; ks = r^2, and ks dt^2 must stay below 0.1. cap: largest force of a row [N]. least_speed: floor of the closing speed [m/s].
    `redundant` names rows that repeat others (they are solved by least squares).
    """

    def __init__(self, rows: PointRows, inverse_masses: np.ndarray, rate: float, cap: float = np.inf, least_speed: float = 0.0) -> None:
        self.names, self.cap, self.least_speed = rows.names, cap, least_speed
        self.targets = rows.targets
        self.rate = rate
        self._jacobian: csr_matrix = coo_matrix((rows.weight, (rows.row, rows.particle)), shape=(len(rows.targets), len(inverse_masses))).tocsr()
        self.redundant: tuple[str, ...] = ()
        self.set_inverse_masses(inverse_masses)

    def set_inverse_masses(self, inverse_masses: np.ndarray) -> None:
        """Masses (P,) 1/kg changed: factor the blocks anew. InputError where a row holds only fixed particles away from their target."""
        self._spread: csr_matrix = (diags(inverse_masses) @ self._jacobian.T).tocsr()
        matrix = (self._jacobian @ self._spread).tocsr()
        if (matrix.diagonal() <= 0.0).any():
            raise InputError(f"constraint '{self.names[int(np.argmin(matrix.diagonal()))]}' acts on fixed particles only; at least one must be free to move")
        count, label = connected_components(matrix, directed=False)
        sizes = np.bincount(label, minlength=count)
        alone = np.flatnonzero(sizes[label] == 1)
        rows, columns, values = [alone], [alone], [1.0 / matrix.diagonal()[alone]]
        redundant: set[str] = set()
        order = np.argsort(label, kind="stable")
        for block in np.split(order, np.cumsum(sizes)[:-1]):
            if len(block) <= 1:  # none: a garment without seams is one empty block
                continue
            eigenvalues, vectors = np.linalg.eigh(matrix[block][:, block].toarray())
            sound = eigenvalues > 1e-9 * eigenvalues[-1]
            inverse = (vectors[:, sound] / eigenvalues[sound]) @ vectors[:, sound].T
            for null in vectors[:, ~sound].T:
                redundant |= {self.names[k] for k in block[np.abs(null) > 1e-6]}
            rows.append(np.repeat(block, len(block)))
            columns.append(np.tile(block, len(block)))
            values.append(inverse.ravel())
        size = len(self.targets)
        solved = coo_matrix((np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))), shape=(size, size)).tocsr()
        self._solved: csr_matrix = solved
        self.redundant = tuple(sorted(redundant))

    def gaps(self, positions: np.ndarray) -> np.ndarray:
        """C (R,3), m."""
        return self._jacobian @ positions - self.targets

    def speeds(self, velocities: np.ndarray) -> np.ndarray:
        """C' (R,3), m/s, for targets at rest."""
        return self._jacobian @ velocities

    def next_speeds(self, positions: np.ndarray, speeds: np.ndarray, time_step_s: float) -> np.ndarray:
        """Demanded C' (R,3) after this step, from the gaps and the demanded C' at its beginning."""
        gaps = self.gaps(positions)
        speeds = (1.0 - 2.0 * self.rate * time_step_s) * speeds - self.rate**2 * time_step_s * gaps
        if self.least_speed == 0.0:
            return speeds
        length = np.maximum(np.linalg.norm(gaps, axis=1), 1e-12)
        toward = -gaps / length[:, None]
        lacking = np.minimum(self.least_speed, 0.1 * length / time_step_s) - (speeds * toward).sum(axis=1)
        return speeds + np.maximum(lacking, 0.0)[:, None] * toward

    def correct(self, velocities: np.ndarray, wanted: np.ndarray, time_step_s: float) -> None:
        """Add to velocities (P,3), in place, what the constraint forces of this step add."""
        impulses = self._solved @ (wanted - self.speeds(velocities))
        sizes = np.sqrt((impulses**2).sum(axis=1))
        impulses *= np.minimum(1.0, self.cap * time_step_s / np.maximum(sizes, 1e-300))[:, None]
        velocities += self._spread @ impulses
