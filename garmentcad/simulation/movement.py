"""Movement: the body goes through key frames, and the garment that hung on it at rest follows, in true dynamics."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from copy import deepcopy
from dataclasses import dataclass

import numpy as np

from garmentcad.cloth.state import State
from garmentcad.contact.path import BodyPath
from garmentcad.mannequin.motion import KeyFrame, motion
from garmentcad.simulation.course import AIR_DRAG, Progress, advance_or_retreat
from garmentcad.simulation.run import Outcome
from garmentcad.simulation.sewing import hold
from garmentcad.simulation.stepper import make_dynamics
from garmentcad.solve.dynamics import STEPS_PER_ESTIMATE, DivergedError, IntersectingError
from garmentcad.solve.hardware import hardware_rows, pin_rows

FRAMES_PER_S = 20.0
HOLD_S = 0.5  # after the last key frame: the garment swings out


@dataclass
class Movement:
    """What became of a movement. times_s (K,) from its beginning; positions (K,P,3) m of the particles and body (K,V,3) m of the body's vertices at them.

    status: 'moved' to the end, or 'diverged', 'intersecting' or 'fell', off the body, where it broke off; warning: why. state: the last one.
    wall_s: what it took.
    """

    times_s: np.ndarray
    positions: np.ndarray
    body: np.ndarray
    state: State
    status: str
    warning: str | None
    wall_s: float


def move(outcome: Outcome, frames: Sequence[KeyFrame], look: Callable[[Progress], None]) -> Movement:
    """Follow key frames from the state at rest of `outcome`, which stays as it is: true masses, air drag, no help of drape mode.
    Where motion runs away steps become shorter, as while the garment was draped, and from there on they are as short as that took.

    MannequinError for a body that cannot be posed, or a pose that is refused.
    """
    started = time.perf_counter()
    times, vertices = motion(outcome.job.mannequin, frames)
    state = deepcopy(outcome.state)
    began = state.time_s
    # Contact starts anew: a body that moves carries other planes than one that stands.
    state.contact, state.phase, state.velocities[:] = {}, "move", 0.0
    path = BodyPath(began + times, vertices)
    dynamics, _ = make_dynamics(outcome.job, outcome.cloth, outcome.materials, state.fold_angles, path=path)
    hold(dynamics, state, pin_rows(hardware_rows(outcome.job.pattern, outcome.cloth, outcome.materials, outcome.job.mannequin)))
    dynamics.drag, dynamics.measured = AIR_DRAG, True
    dynamics.start(state)
    kept: list[tuple[float, np.ndarray, np.ndarray]] = []
    status, warning = "moved", None
    end = float(times[-1]) + HOLD_S
    try:
        while True:
            now = state.time_s - began
            if now >= len(kept) / FRAMES_PER_S or now >= end:
                kept.append((now, state.positions.copy(), path.at(state.time_s)))
                look(Progress("move", state.step, now, None, None, dynamics.measures(state)[2], None))
                if state.positions[:, 1].max() < kept[-1][2][:, 1].min():
                    status, warning = "fell", f"after {now:.2f} s of the movement the garment fell off: all of it is below the body"
                    break
            if now >= end:
                break
            dynamics.estimate_time_step(state)
            left = min(len(kept) / FRAMES_PER_S, end) - now
            advance_or_retreat(dynamics, state, max(1, min(STEPS_PER_ESTIMATE, int(np.ceil(left / state.time_step_s)))))
    except (DivergedError, IntersectingError) as error:
        status, warning = error.status, f"after {state.time_s - began:.2f} s of the movement: {error}"
        kept.append((state.time_s - began, state.positions.copy(), path.at(state.time_s)))
    moments, positions, bodies = zip(*kept, strict=True)
    return Movement(np.array(moments), np.array(positions), np.array(bodies), state, status, warning, time.perf_counter() - started)
