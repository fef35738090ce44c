"""Static equilibrium of a specimen between clamps, by Newton's method on the forces of garments.

    x = given + modes q,     modes^T (f(x) + load) = 0     [N]

q are the unknowns: coordinates of free particles, and those of clamps that may move. The tangent df/dx comes from central differences of the same force
kernels, many particles at a time: two particles that no force feels together are displaced at once (Curtis, Powell and Reid 1974).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from scipy.sparse import csc_array, csr_array, eye_array
from scipy.sparse.linalg import splu

from garmentcad.cloth.cloth import Cloth
from garmentcad.errors import GarmentError
from garmentcad.forces.arcs import cell_neighbours
from garmentcad.forces.assembly import ForceAssembly
from garmentcad.forces.force import NO_PARTICLE
from garmentcad.forces.rows import LatticeSlots

_DISPLACED = 1e-7  # of the lattice spacing, for the differences
_CONVERGED = 1e-9  # of the lattice spacing: the last correction. At 1e-6 links pulled at a sheer cloth with a tenth of what its bending does
_LONGEST = 0.5  # of the lattice spacing: no particle goes farther in one correction
_MOST_CORRECTIONS = 200
_MOST_LOOKS = 12  # along one correction
_LEFT = 0.5  # of the work that the forces do along a correction may be left at its end
_PIVOT = 0.1  # the tangent is symmetric but for kinks: pivots stay on its diagonal
_KEPT = 0.1  # a tangent serves again while each correction is smaller than this part of the one before
_ANCHOR = 1e-6  # of the stiffest unknown: the weakest springs, where forces push away from the next equilibrium
_LOOSENED = 0.1  # what a correction that served leaves of the springs


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
        self._stiffest = 0.0
        # the tangent as compressed rows: entries come coordinate by coordinate, `order` puts them in place
        rows = np.concatenate([3 * self._row + other for _ in axes for other in axes])
        columns = np.concatenate([3 * self._column + axis for axis in axes for _ in axes])
        self._order = np.lexsort((columns, rows))
        self._columns = columns[self._order]
        self._starts = np.searchsorted(rows[self._order], np.arange(3 * cloth.particle_count + 1))

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
        values = [change[group_of[self._column], k, self._row, other] for k in range(len(self._axes)) for other in self._axes]
        size = 3 * len(positions)
        return csr_array((np.concatenate(values)[self._order], self._columns, self._starts), shape=(size, size))

    def solve(self, given: np.ndarray, modes: csr_array, unknowns: np.ndarray, load: np.ndarray | float = 0.0) -> np.ndarray:
        """The unknowns (N,) in equilibrium, from a guess; given (P,3) m, modes (3P,N), load (N,) N on the unknowns. UnbalancedError where there is none.

        A correction goes as far as the forces do work along it. Forces have a potential while sliders stay where `keep` left them, so that this ends in a
        stable equilibrium, and sliders that hold and slip by turns cannot send it around in circles.
        """

        def residual(q: np.ndarray) -> np.ndarray:
            return np.asarray(modes.T @ self.forces(given + (modes @ q).reshape(-1, 3)).ravel() + load)

        # an old tangent serves a first correction that it finds short
        q, anchor, before = unknowns.copy(), 0.0, _LONGEST * self._spacing / _KEPT
        left = residual(q)
        fresh = self._factor is None or self._factor.shape[0] != len(q)
        if fresh:
            self._refresh(given, modes, q, anchor)
        for _ in range(_MOST_CORRECTIONS):
            step = self._factor.solve(left)
            size = float(np.abs(step).max(initial=0.0))
            if not fresh and not size < _KEPT * before:
                self._refresh(given, modes, q, anchor)
                fresh = True
                step = self._factor.solve(left)
                size = float(np.abs(step).max(initial=0.0))
            if size < _CONVERGED * self._spacing and anchor == 0.0:
                return q + step
            work = float(left @ step)
            if not (np.isfinite(size) and work > 0.0):
                anchor = max(10.0 * anchor, _ANCHOR * self._stiffest)
                if not (np.isfinite(anchor) and anchor < self._stiffest):
                    break
                self._refresh(given, modes, q, anchor)
                fresh, before = True, np.inf
                continue
            whole = min(1.0, _LONGEST * self._spacing / max(size, 1e-300))
            part, left = _along(residual, q, step, whole, work)
            q = q + part * step
            before, fresh = (size if part == 1.0 and anchor == 0.0 else 0.0), False
            anchor = _LOOSENED * anchor if _LOOSENED * anchor > _ANCHOR * self._stiffest else 0.0
        raise UnbalancedError(f"a specimen of {len(given)} particles finds no equilibrium: the last correction was {size:.2g} m")

    def _refresh(self, given: np.ndarray, modes: csr_array, q: np.ndarray, anchor: float) -> None:
        """Take minus the tangent of the residual anew, with springs of `anchor` N/m on every unknown, and factorise it."""
        stiffness = -(modes.T @ self.tangent(given + (modes @ q).reshape(-1, 3)) @ modes)
        self._stiffest = float(np.abs(stiffness.diagonal()).max())
        held = csc_array(stiffness + anchor * eye_array(len(q)))
        self._factor = splu(held, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=_PIVOT, options={"SymmetricMode": True})


def _along(residual: Callable[[np.ndarray], np.ndarray], q: np.ndarray, step: np.ndarray, whole: float, work: float) -> tuple[float, np.ndarray]:
    """How much of a step serves, at most `whole` of it, and the residual there. work: of the residual along the step where it begins, > 0."""
    low, at_low, high, at_high, part = 0.0, work, 0.0, 0.0, whole
    for _ in range(_MOST_LOOKS):
        left = residual(q + part * step)
        now = float(left @ step)
        if abs(now) <= _LEFT * work or (now > 0.0 and part == whole):
            break
        if now > 0.0:
            low, at_low = part, now
        else:
            high, at_high = part, now
        # between the two ends by the secant, and not too near to either
        part = low + (high - low) * min(max(at_low / (at_low - at_high), 0.1), 0.9)
    return part, left


def _felt(cloth: Cloth) -> csr_array:
    """(P,P) pattern: which particles the force on each depends on."""
    border, bends, count = cloth.border, cloth.bends, cloth.particle_count
    families = [cloth.links.ends, cloth.cells.corners, cloth.spans.corners, cloth.hinges.corners]
    families.append(np.column_stack([bends.center, bends.arm_a, bends.arm_b]))
    felt = csr_array((count, count))
    for corners in families:
        member = _incidence(corners, count)
        felt = felt + member.T @ member
    # corners of a cell and its neighbours feel each other
    neighbours = cell_neighbours(cloth, LatticeSlots(cloth))
    inside = neighbours[:, 0] != NO_PARTICLE
    corner, neighbour = _incidence(cloth.cells.corners[inside], count), _incidence(neighbours[inside], count)
    felt = felt + (corner + neighbour).T @ (corner + neighbour)
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
