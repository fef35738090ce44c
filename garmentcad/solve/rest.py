"""Is the garment at rest? What one step of true masses would do to it from zero velocity, contact and friction included (PHYSICS section 3)."""

from __future__ import annotations

from copy import deepcopy
from dataclasses import dataclass

import numpy as np

from garmentcad.cloth.cloth import Cloth
from garmentcad.cloth.state import State
from garmentcad.solve.dynamics import Dynamics
from garmentcad.units import GRAVITY_M_S2, MM_TO_M

RESIDUAL_G = 1e-3  # mass-weighted RMS
PATCH_RESIDUAL_G = 2e-3  # largest mean over a patch of 5 x 5 particles
PATCH_PARTICLES = 5


@dataclass(frozen=True)
class Residual:
    """Accelerations left, in units of g."""

    rms_g: float
    worst_patch_g: float
    patches_g: np.ndarray  # RMS in each patch

    @property
    def at_rest(self) -> bool:
        return self.rms_g < RESIDUAL_G and self.worst_patch_g < PATCH_RESIDUAL_G


def patches(cloth: Cloth) -> np.ndarray:
    """Patch number (P,) of each particle: squares of 5 x 5 lattice spacings on the panels."""
    tile = np.floor(cloth.vertex_uv_mm * MM_TO_M / (PATCH_PARTICLES * cloth.spacing)).astype(np.int64)
    key = np.column_stack([cloth.vertex_panel, tile])
    _, label = np.unique(key, axis=0, return_inverse=True)
    patch = np.zeros(cloth.particle_count, dtype=np.int64)
    patch[cloth.vertex_particle] = label.ravel()
    return patch


def mean_over(patch: np.ndarray, masses: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Mass-weighted mean of values (P,) in each patch; 0 where nothing has mass."""
    weight = np.bincount(patch, masses)
    return np.bincount(patch, masses * values) / np.where(weight > 0.0, weight, 1.0)


def residual(dynamics: Dynamics, state: State, patch: np.ndarray) -> Residual:
    """Residual of `state`, which is left as it is, for true masses.

    What contact does without any force (it pushes apart what stands below its gap) is no unrest; where forces hold against that push, and nothing moves, there
    is none either: of the two readings of a particle the smaller counts. Constraints count as the forces that they exert.
    """
    with dynamics.true_masses(state):
        trial = deepcopy(state)
        trial.velocities[:] = 0.0
        pushed = deepcopy(trial)
        pushed.contact["pair_impulse"][:] = 0.0
        dt = state.time_step_s
        with dynamics.loaded():
            dynamics.correct_velocities(trial)
        dynamics.contact.respond(pushed, dt)
    masses = np.where(dynamics.fixed, 0.0, dynamics.cloth.masses)
    beyond_push = trial.velocities - pushed.velocities
    still = (trial.velocities**2).sum(axis=1) < (beyond_push**2).sum(axis=1)
    acceleration = np.where(still[:, None], trial.velocities, beyond_push) / (dt * GRAVITY_M_S2)
    rms = float(np.sqrt((masses[:, None] * acceleration**2).sum() / masses.sum()))
    count = int(patch.max()) + 1
    weight = np.bincount(patch, masses, count)
    sums = np.column_stack([np.bincount(patch, masses * acceleration[:, axis], count) for axis in range(3)])
    whole = weight > 0.0
    means = np.linalg.norm(sums[whole] / weight[whole, None], axis=1)
    # Patches cut by the outline hold few particles; a mean over a few is no mean over 25. They count by their mass.
    share = np.minimum(1.0, weight[whole] / np.median(weight[whole]))
    return Residual(rms, float((means * share).max()), np.sqrt(mean_over(patch, masses, (acceleration**2).sum(axis=1))))
