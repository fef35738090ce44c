"""Sum of all forces per particle: element forces write their corners, then one gather adds them up in a fixed order."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numba import prange

from garmentcad.arrays import CHUNKS, entry, indices, parallel_kernel, rows_by_key
from garmentcad.forces.force import NO_PARTICLE, BodyForce, Force


@entry
@parallel_kernel
def gather(starts, slots, corner_forces, out):  # type: ignore[no-untyped-def]
    """out[i] = sum of corner_forces[slots[starts[i]:starts[i+1]]], in that order."""
    for i in prange(len(starts) - 1):
        x = y = z = 0.0
        for j in range(starts[i], starts[i + 1]):
            k = slots[j]
            x += corner_forces[k, 0]
            y += corner_forces[k, 1]
            z += corner_forces[k, 2]
        out[i, 0], out[i, 1], out[i, 2] = x, y, z


class Sums(NamedTuple):
    """How corner forces add up to forces on particles, for compiled steps."""

    starts: np.ndarray  # (P+1,) int32
    slots: np.ndarray  # (K,) int32
    mixed: np.ndarray  # (M,) int32, rising: particles whose force is not just the row of corner_forces with their number
    first_mixed: np.ndarray  # (CHUNKS+1,) int32, where those of each part of the particles begin among them
    corner_forces: np.ndarray  # (K,3) N
    weight: np.ndarray  # (P,) N, downward
    masses: np.ndarray  # (P,) kg, true


class ForceAssembly:
    """All forces on `particle_count` particles. Two forces of one name are refused (ValueError): results are reported by name."""

    def __init__(self, forces: Sequence[Force], particle_count: int, body_forces: Sequence[BodyForce] = ()) -> None:
        self.forces, self.body_forces = tuple(forces), tuple(body_forces)
        self._all: tuple[Force | BodyForce, ...] = (*self.forces, *self.body_forces)
        names = [force.name for force in self._all]
        if len(set(names)) < len(names):
            raise ValueError(f"two forces of one name among {names}: give each its own")
        bounds = np.cumsum([0, *(len(force.corners) for force in self.forces)])
        self._parts = [slice(a, b) for a, b in itertools.pairwise(bounds)]
        corners = np.concatenate([np.empty(0, np.int32), *(force.corners for force in self.forces)])
        used = np.flatnonzero(corners != NO_PARTICLE)
        self._starts, rows = rows_by_key(corners[used], particle_count)
        self._slots = indices(used[rows])
        alone = np.flatnonzero(np.diff(self._starts) == 1)
        self._mixed = indices(np.setdiff1d(np.arange(particle_count), alone[self._slots[self._starts[alone]] == alone]))
        self._first_mixed = indices(np.searchsorted(self._mixed, [particle_count * chunk // CHUNKS for chunk in range(CHUNKS + 1)]))
        self._particles, self._used = corners[used], indices(used)
        self._corner_forces = np.zeros((len(corners), 3))
        self._views = [self._corner_forces[part] for part in self._parts]
        self._corner_stiffness = np.zeros(len(corners))

    def slack(self) -> dict[str, np.ndarray]:
        """Sliders of cloth that was never strained, by name of force."""
        return {force.name: force.slack() for force in self.forces}

    def drawn(self, positions: np.ndarray, share: float) -> dict[str, np.ndarray]:
        """Sliders that hold, by name of force; see `Force.drawn`."""
        return {force.name: force.drawn(positions, share) for force in self.forces}

    def slacken(self, sliders: dict[str, np.ndarray], positions: np.ndarray, curves: Sequence[int]) -> None:
        """Set the sliders of `curves`, numbers in CURVES, in place to those of cloth that was never strained; positions (P,3) [m]."""
        for force in self.forces:
            chosen = np.isin(force.gauge(positions).curve, curves)
            sliders[force.name][chosen] = force.slack()[chosen]

    def add_up(self, positions: np.ndarray, velocities: np.ndarray, out: np.ndarray, sliders: dict[str, np.ndarray] | None = None) -> None:
        """Total force on each particle [N] into out (P,3), from positions [m] and velocities [m/s], both (P,3). sliders: moved in place; None: `slack`."""
        held = self.slack() if sliders is None else sliders
        for force, view in zip(self.forces, self._views):
            force.write_forces(positions, velocities, view, held[force.name])
        gather(self._starts, self._slots, self._corner_forces, out)
        for body_force in self.body_forces:
            body_force.add_forces(positions, velocities, out)

    def sums(self, masses: np.ndarray) -> Sums:
        """What compiled steps need of it; masses (P,) [kg]. The body forces are taken at rest: weight. ValueError for one that does not act along y."""
        load, rest = np.zeros((len(masses), 3)), np.zeros((len(masses), 3))
        for force in self.body_forces:
            force.add_forces(rest, rest, load)
            if load[:, [0, 2]].any():
                raise ValueError(f"{force.name} acts across the vertical; of forces on single particles the stepper takes weight alone, along y")
        return Sums(self._starts, self._slots, self._mixed, self._first_mixed, self._corner_forces, -load[:, 1], masses)

    def energy(self, positions: np.ndarray, sliders: dict[str, np.ndarray] | None = None) -> dict[str, float]:
        """Stored energy [J] by law; a law that acts in several forces is added up."""
        held = self.slack() if sliders is None else sliders
        parts = [force.energies(positions, held[force.name]) for force in self.forces] + [force.energies(positions) for force in self.body_forces]
        total: dict[str, float] = {}
        for part in parts:
            for law, energy in part.items():
                total[law] = total.get(law, 0.0) + energy
        return total

    def stiffness(self, positions: np.ndarray, out: np.ndarray) -> None:
        """Row sum bound of the tangent [N/m] at each particle into out (P,); see `time_step`."""
        for force, part in zip(self.forces, self._parts):
            force.write_stiffness(positions, self._corner_stiffness[part])
        out[:] = np.bincount(self._particles, weights=self._corner_stiffness[self._used], minlength=len(out))

    def stiffness_across(self, positions: np.ndarray, out: np.ndarray) -> None:
        """As `stiffness`, of what acts across the cloth alone: bending, and the pull of bands. That of taut cloth is not in it."""
        self._corner_stiffness[:] = 0.0
        for force, part in zip(self.forces, self._parts):
            force.write_stiffness_across(positions, self._corner_stiffness[part])
        out[:] = np.bincount(self._particles, weights=self._corner_stiffness[self._used], minlength=len(out))
