"""Sewing: stitches close by dynamic constraints, without gravity and gently, and are then welded."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from garmentcad.cloth.cloth import Cloth
from garmentcad.cloth.state import State
from garmentcad.constraints.points import ConstraintPoints, stitch_rows
from garmentcad.simulation.course import CLOSED_M, CLOSING_CAP_S, CLOSING_PULL_N_M, CLOSING_RATE, SPEED_CAP_M_S, STEPS_PER_LOOK, Progress
from garmentcad.solve.dynamics import Dynamics


def close_seams(dynamics: Dynamics, state: State, look: Callable[[Progress], None]) -> dict[str, float]:
    """Pull the stitches of `dynamics.cloth` (without gravity) together until every gap is below CLOSED_M or the cap is reached. Returns the largest gap in mm
    of each seam."""
    cloth = dynamics.cloth
    names = tuple(cloth.seam_names[k] for k in cloth.stitch_seam)
    dynamics.constraint = ConstraintPoints(stitch_rows(cloth.stitches, names), dynamics.inverse_masses, CLOSING_RATE, CLOSING_PULL_N_M * cloth.spacing)
    if len(state.constraint_speeds) == 0:
        state.constraint_speeds = np.zeros((len(cloth.stitches), 3))
    dynamics.equalise = True
    dynamics.set_friction(0.0)  # seams slide to where they close
    dynamics.speed_cap_m_s = SPEED_CAP_M_S
    while True:
        gaps = np.linalg.norm(dynamics.constraint.gaps(state.positions), axis=1)
        look(Progress(state.phase, state.step, state.time_s, float(gaps.max(initial=0.0)) * 1e3, None, dynamics.measures(state)[2], None))
        if gaps.max(initial=0.0) < CLOSED_M or state.time_s >= CLOSING_CAP_S:
            break
        for _ in range(STEPS_PER_LOOK):
            dynamics.step(state)
    worst: dict[str, float] = {}
    for name, gap in zip(names, gaps, strict=True):
        worst[name] = max(worst.get(name, 0.0), float(gap) * 1e3)
    return worst


def weld_state(cloth: Cloth, welded: Cloth, particle_map: np.ndarray, state: State) -> State:
    """State of `welded`: mass-weighted mean positions and velocities of the particles that became one (momentum is kept)."""
    positions, velocities = np.zeros((welded.particle_count, 3)), np.zeros((welded.particle_count, 3))
    for axis in range(3):
        positions[:, axis] = np.bincount(particle_map, cloth.masses * state.positions[:, axis], welded.particle_count) / welded.masses
        velocities[:, axis] = np.bincount(particle_map, cloth.masses * state.velocities[:, axis], welded.particle_count) / welded.masses
    return State(positions, velocities, state.time_s, state.step, state.time_step_s, run=dict(state.run), work_j=dict(state.work_j))
