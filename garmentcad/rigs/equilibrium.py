"""Static equilibrium of a specimen between clamps, by Newton's method on the forces of garments.

    x = given + modes q,     modes^T (f(x) + load) = 0     [N]

q are the unknowns: coordinates of free particles, and those of clamps that may move. The tangent df/dx comes from central differences of the same force
kernels, many particles at a time: two particles that no force feels together are displaced at once (Curtis, Powell and Reid 1974).
"""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.sparse import csc_array, csr_array, eye_array
from scipy.sparse.linalg import splu

from garmentcad.cloth.cloth import Cloth
from garmentcad.errors import GarmentError
from garmentcad.forces.assembly import ForceAssembly

_DISPLACED = 1e-7  # of the lattice spacing, for the differences
_CONVERGED = 1e-6  # of the lattice spacing: the last correction
_BALANCED = 1e-6  # of the largest force on a particle, clamps included: what may be left where sliders hold and slip by turns
_LONGEST = 0.5  # of the lattice spacing: no particle goes farther in one correction
_MOST_CORRECTIONS = 200
_ANCHOR = 1e-8  # of the stiffest unknown: the weakest springs
_LOOSENED = 0.03  # what a correction that served leaves of the springs
_KEPT = 0.1  # a tangent serves again while each correction is smaller than this part of the one before


class UnbalancedError(GarmentError):
    """A specimen found no equilibrium; the message says in which state."""


class Equilibrium:
    """Finds where a cloth rests. axes: coordinates that may change (0, 1 for a specimen that stays flat).

    Internal friction: sliders stay where the last state that was kept left them while the next one is sought; `keep` moves them.
    """

    def __init__(self, cloth: Cloth, forces: ForceAssembly, axes: tuple[int, ...] = (0, 1, 2)) -> None:
        self._forces, self._axes, self._spacing = forces, axes, cloth.spacing
        felt = _felt(cloth)
        self._row, self._column = felt.tocoo().coords
        self._groups = _groups(felt)
        self._still = np.zeros((cloth.particle_count, 3))
        self._sliders = forces.slack()
        self._factor: Any = None
        self._stiffness = csr_array((0, 0))
        self._stiffest = self._first_anchor = 0.0

    def forces(self, positions: np.ndarray) -> np.ndarray:
        """Force (P,3) [N] of the cloth on each particle; where a clamp holds, minus the reaction."""
        out = np.empty_like(positions)
        self._forces.add_up(positions, self._still, out, {name: array.copy() for name, array in self._sliders.items()})
        return out

    def keep(self, positions: np.ndarray) -> np.ndarray:
        """The same force; from here on internal friction has been through this state."""
        out = np.empty_like(positions)
        self._forces.add_up(positions, self._still, out, self._sliders)
        return out

    def tangent(self, positions: np.ndarray) -> csr_array:
        """df/dx (3P,3P) [N/m] in the order particle, coordinate."""
        step = _DISPLACED * self._spacing
        group_of = np.empty(len(positions), dtype=np.int64)
        for number, group in enumerate(self._groups):
            group_of[group] = number
        change = np.empty((len(self._groups), len(self._axes), *positions.shape))
        moved = positions.copy()
        for number, group in enumerate(self._groups):
            for k, axis in enumerate(self._axes):
                moved[group, axis] = positions[group, axis] + step
                ahead = self.forces(moved)
                moved[group, axis] = positions[group, axis] - step
                change[number, k] = (ahead - self.forces(moved)) / (2.0 * step)
                moved[group, axis] = positions[group, axis]
        values, rows, columns = [], [], []
        for k, axis in enumerate(self._axes):
            for other in self._axes:
                values.append(change[group_of[self._column], k, self._row, other])
                rows.append(3 * self._row + other)
                columns.append(3 * self._column + axis)
        size = 3 * len(positions)
        return csr_array((np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))), shape=(size, size))

    def solve(self, given: np.ndarray, modes: csr_array, unknowns: np.ndarray, load: np.ndarray | float = 0.0) -> np.ndarray:
        """The unknowns (N,) in equilibrium, from a guess; given (P,3) m, modes (3P,N), load (N,) N on the unknowns. UnbalancedError where there is none."""
        largest_force = 0.0

        def residual(q: np.ndarray) -> np.ndarray:
            nonlocal largest_force
            forces = self.forces(given + (modes @ q).reshape(-1, 3))
            largest_force = float(np.abs(forces).max())
            return np.asarray(modes.T @ forces.ravel() + load)

        q, before, anchor, largest = unknowns.copy(), np.inf, self._first_anchor, 0.0
        left = residual(q)
        fresh = self._factor is None or self._factor.shape[0] != len(q) or anchor > 0.0
        if fresh:
            self._refresh(given, modes, q)
            self._factorise(anchor)
        for _ in range(_MOST_CORRECTIONS):
            step = self._factor.solve(left)
            size = float(np.abs(step).max(initial=0.0))
            if not fresh and not size < _KEPT * before:
                self._refresh(given, modes, q)
                self._factorise(anchor)
                step = self._factor.solve(left)
                size = float(np.abs(step).max(initial=0.0))
            if not np.isfinite(size):
                break
            part = min(1.0, _LONGEST * self._spacing / max(size, 1e-300))
            ahead = residual(q + part * step)
            # natural monotonicity (Deuflhard): the next correction by the same tangent must be smaller
            most = size if anchor > 0.0 else (1.0 - 0.25 * part) * size
            good = size < _CONVERGED * self._spacing or float(np.abs(self._factor.solve(ahead)).max()) <= most
            if not good:
                # springs to where the particles are: shorter corrections, along the forces where the tangent misleads
                if not fresh:
                    self._refresh(given, modes, q)
                anchor = max(10.0 * anchor, _ANCHOR * self._stiffest)
                self._factorise(anchor)
                before, fresh = np.inf, True
                continue
            q, left, before, fresh = q + part * step, ahead, size, False
            if float(np.abs(left).max(initial=0.0)) < _BALANCED * largest_force:
                self._first_anchor = max(largest, anchor)  # the next state will want about the same
                return q
            if anchor > 0.0:
                largest = max(largest, anchor)
                anchor, before = (_LOOSENED * anchor if anchor > _ANCHOR * self._stiffest else 0.0), 0.0
            elif part < 1.0:
                before = 0.0
            elif size < _CONVERGED * self._spacing:
                self._first_anchor = largest
                return q
        raise UnbalancedError(f"a specimen of {len(given)} particles finds no equilibrium: the last correction was {size:.2g} m")

    def _refresh(self, given: np.ndarray, modes: csr_array, q: np.ndarray) -> None:
        """Take minus the tangent of the residual anew."""
        self._stiffness = -(modes.T @ self.tangent(given + (modes @ q).reshape(-1, 3)) @ modes)
        self._stiffest = float(np.abs(self._stiffness.diagonal()).max())

    def _factorise(self, anchor: float) -> None:
        """With springs of `anchor` N/m on every unknown."""
        self._factor = splu(csc_array(self._stiffness + anchor * eye_array(self._stiffness.shape[0])))


def _felt(cloth: Cloth) -> csr_array:
    """(P,P) pattern: which particles the force on each depends on."""
    border, bends, count = cloth.border, cloth.bends, cloth.particle_count
    families = [cloth.links.ends, cloth.cells.corners, cloth.spans.corners, cloth.hinges.corners]
    families.append(np.column_stack([bends.center, bends.arm_a, bends.arm_b]))
    felt = csr_array((count, count))
    for corners in families:
        member = _incidence(corners, count)
        felt = felt + member.T @ member
    # triangles that share a patch feel each other's corners
    member, of_patch = _incidence(border.corners, count), _incidence(border.patch, len(border.patch_material))
    felt = felt + member.T @ (of_patch @ of_patch.T) @ member
    felt.data[:] = 1.0
    return csr_array(felt)


def _incidence(corners: np.ndarray, count: int) -> csr_array:
    """(N,count): 1 where an element has a corner."""
    rows = np.repeat(np.arange(len(corners)), corners.shape[1])
    return csr_array((np.ones(corners.size), (rows, corners.ravel())), shape=(len(corners), count))


def _groups(felt: csr_array) -> list[np.ndarray]:
    """Particles dealt out into groups of which no two act on the same particle; each goes into the first group that takes it."""
    together = csr_array(felt.T @ felt)
    group = np.full(together.shape[0], -1)
    for particle in range(len(group)):
        taken = np.unique(group[together.indices[together.indptr[particle] : together.indptr[particle + 1]]])
        taken = taken[taken >= 0]
        free = np.flatnonzero(taken != np.arange(len(taken)))
        group[particle] = free[0] if len(free) else len(taken)
    return [np.flatnonzero(group == number) for number in range(group.max(initial=-1) + 1)]
