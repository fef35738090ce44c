"""Pressing: after sewing and before the garment hangs, the folds are laid to their angles under the iron; a share of each angle stays.

While the iron is on, cloth goes over a fold to the angle that is imposed and is many times as stiff there as cloth alone, without weight and without
friction, its own included: heat and steam let fibres slip. Then the rest angle of each fold moves by its share of the way to the imposed one
(`State.fold_angles`) and stays there: nothing else changes it. Internal friction begins anew, from the shape that the iron left (both are estimates).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from garmentcad.arrays import floats
from garmentcad.cloth.cloth import Cloth
from garmentcad.cloth.state import State
from garmentcad.fabric.pressing import pressed_share
from garmentcad.simulation.course import CLOSING_DRAG, SPEED_CAP_M_S, Progress, advance_or_retreat
from garmentcad.simulation.job import Job
from garmentcad.solve.dynamics import Dynamics

IRON = 30.0  # times the bending stiffness of the cloth: what the iron does to it while it lies on a fold
LEAST_S, MOST_S = 0.3, 2.0
STILL_M_S = 0.02  # RMS speed at which the cloth lies as it is pressed


def under_iron(cloth: Cloth) -> Cloth:
    """The cloth while it is pressed."""
    hinges = cloth.hinges
    return replace(cloth, hinges=hinges._replace(factor=floats(np.where(hinges.fold >= 0, IRON, 1.0) * hinges.factor)))


def imposed_angles(job: Job) -> np.ndarray:
    """(F,) rad, to which the iron lays each fold of the cloth."""
    return np.radians([fold.angle_deg for panel in job.pattern.panels.values() for fold in panel.folds])


def laid_angles(job: Job) -> np.ndarray:
    """(F,) rad, of the folds while seams are sewn: pleats are laid before, other folds are flat."""
    laid = [fold.laid for panel in job.pattern.panels.values() for fold in panel.folds]
    return np.where(laid, imposed_angles(job), 0.0)


def shares(job: Job) -> np.ndarray:
    """(F,) share of the imposed angle that stays: what the spec says, or what the fibre of the panel's fabric lets stay."""
    found = []
    for panel in job.pattern.panels.values():
        fibre = job.fabrics[panel.fabric or job.pattern.fabric].sheet.fibre
        found += [pressed_share(fibre) if fold.pressed is None else fold.pressed for fold in panel.folds]
    return np.array(found)


def press(dynamics: Dynamics, state: State, job: Job, look: Callable[[Progress], None]) -> None:
    """Lay the folds, then set their rest angles. dynamics: of the cloth `under_iron`, with the imposed angles as rest angles, without weight and without
    internal friction."""
    dynamics.equalise, dynamics.drag, dynamics.speed_cap_m_s = True, CLOSING_DRAG, SPEED_CAP_M_S
    while True:
        rms, since = dynamics.measures(state)[2], state.time_s - state.run["phase_from_s"]
        look(Progress(state.phase, state.step, state.time_s, None, None, rms, None))
        if (since >= LEAST_S and rms < STILL_M_S) or since >= MOST_S or state.time_s >= job.max_time_s:
            break
        advance_or_retreat(dynamics, state)
    state.friction = dynamics.forces.drawn(state.positions, 0.0)
    state.fold_angles = state.fold_angles + shares(job) * (imposed_angles(job) - state.fold_angles)
