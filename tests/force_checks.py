"""What every force must satisfy, as functions of one force and one state."""

from __future__ import annotations

import numpy as np

from garmentcad.forces.assembly import ForceAssembly
from garmentcad.forces.force import NO_PARTICLE, Force


def particle_forces(force: Force, positions: np.ndarray, velocities: np.ndarray | None = None) -> np.ndarray:
    """Force on each particle (P,3), summed in Python."""
    corner_forces = np.full((len(force.corners), 3), np.nan)
    force.write_forces(positions, np.zeros_like(positions) if velocities is None else velocities, corner_forces)
    used = force.corners != NO_PARTICLE
    total = np.zeros_like(positions)
    np.add.at(total, force.corners[used], corner_forces[used])
    return total


def corner_scale(force: Force, positions: np.ndarray) -> float:
    """Largest force on one corner: the scale against which sums must vanish."""
    corner_forces = np.zeros((len(force.corners), 3))
    force.write_forces(positions, np.zeros_like(positions), corner_forces)
    return float(np.abs(corner_forces).max())


def gradient_error(force: Force, positions: np.ndarray, step: float = 1e-6) -> float:
    """Largest difference between the force and minus the central difference (fourth order) of the energy, over the largest force."""
    expected = np.zeros_like(positions)
    for index in np.ndindex(*positions.shape):
        values = []
        for k in (-2, -1, 1, 2):
            moved = positions.copy()
            moved[index] += k * step
            values.append(force.energy(moved))
        expected[index] = -(values[0] - 8 * values[1] + 8 * values[2] - values[3]) / (12 * step)
    found = particle_forces(force, positions)
    return float(np.abs(found - expected).max() / np.abs(expected).max())


def balance_error(force: Force, positions: np.ndarray) -> tuple[float, float]:
    """Net force over the largest corner force, and net torque over that times the extent, at places near the origin."""
    centred = positions - positions.mean(axis=0)
    total = particle_forces(force, centred)
    scale = corner_scale(force, centred)
    torque = np.cross(centred, total).sum(axis=0)
    return float(np.abs(total.sum(axis=0)).max() / scale), float(np.abs(torque).max() / (scale * np.abs(centred).max()))


def stiffness_over_bound(force: Force, positions: np.ndarray, masses: np.ndarray, step: float = 1e-7) -> float:
    """Largest eigenvalue of M^-1 K, K the central difference of the forces, over the bound max(row sum/m)."""
    root = np.repeat(1.0 / np.sqrt(masses), 3)
    found = np.linalg.eigvalsh(_tangent_of(force, positions, step) * root[:, None] * root[None, :]).max()
    return float(found / np.max(_row_bounds(force, positions) / masses))


def row_sums_over_bounds(force: Force, positions: np.ndarray) -> np.ndarray:
    """(P,) sum over j of |K_ij|, K the central difference of the forces, over the bound of each particle; 0 where nothing acts."""
    count = len(positions)
    blocks = _tangent_of(force, positions).reshape(count, 3, count, 3).transpose(0, 2, 1, 3)
    sums, bounds = np.linalg.norm(blocks, ord=2, axis=(2, 3)).sum(axis=1), _row_bounds(force, positions)
    noise = 1e-7 * bounds.max()
    return np.where(sums > noise, sums / np.maximum(bounds, noise), 0.0)


def _tangent_of(force: Force, positions: np.ndarray, step: float = 1e-7) -> np.ndarray:
    size = positions.size
    hessian = np.empty((size, size))
    for column, index in enumerate(np.ndindex(*positions.shape)):
        pair = []
        for k in (1, -1):
            moved = positions.copy()
            moved[index] += k * step
            pair.append(particle_forces(force, moved).ravel())
        hessian[:, column] = -(pair[0] - pair[1]) / (2 * step)
    return 0.5 * (hessian + hessian.T)


def _row_bounds(force: Force, positions: np.ndarray) -> np.ndarray:
    corner_stiffness = np.zeros(len(force.corners))
    force.write_stiffness(positions, corner_stiffness)
    used = force.corners != NO_PARTICLE
    return np.bincount(force.corners[used], weights=corner_stiffness[used], minlength=len(positions))


def march(assembly: ForceAssembly, masses: np.ndarray, positions: np.ndarray, velocities: np.ndarray, step: float, count: int) -> None:
    """Modified Euler in place. Stops early where a particle leaves by more than 1 m."""
    out, per_mass, start = np.empty_like(positions), step / masses[:, None], positions.copy()
    for done in range(count):
        assembly.add_up(positions, velocities, out)
        out *= per_mass
        velocities += out
        np.multiply(velocities, step, out=out)
        positions += out
        if done % 100 == 0 and not np.abs(positions - start).max() < 1.0:
            break


def tangent_by_differences(forces: ForceAssembly, positions: np.ndarray) -> np.ndarray:
    """-dF/dx (3 P,3 P) [N/m] of cloth at rest at these positions (P,3) [m], by central differences; symmetric."""
    still, nudge = np.zeros_like(positions), 1e-7
    tangent = np.empty((positions.size, positions.size))
    for k in range(positions.size):
        sides = []
        for sign in (1.0, -1.0):
            moved, total = positions.copy(), np.empty_like(positions)
            moved.reshape(-1)[k] += sign * nudge
            forces.add_up(moved, still, total)
            sides.append(total.ravel())
        tangent[:, k] = (sides[1] - sides[0]) / (2.0 * nudge)
    return 0.5 * (tangent + tangent.T)
