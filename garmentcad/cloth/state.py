"""State: everything of a simulation that changes. A checkpoint is one State; a run resumed from it ends in the same bits."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, field

import numpy as np


@dataclass
class State:
    """positions, velocities: (P,3) m, m/s. friction: sliders of internal friction by name of force (empty before the first step).

    fold_angles: (F,) rad, to which each fold line of the cloth goes back when nothing else bends it; pressing moves them.
    constraint_speeds: (R,3) m/s, what the constraints demand of their gaps at this moment; constraint_forces: (R,3) N, their multipliers in the last step.
    contact: arrays of the detection clock and the candidate lists, by contact name; owned by the contacts, kept here so that a resumed run needs no
    extra detection. work_j: work done so far by the friction of contact and by internal friction. phase, run: bookkeeping of the run (names in
    simulation/). said: warnings of how the panels came to where they began; a resumed run reports the same.
    """

    positions: np.ndarray
    velocities: np.ndarray
    time_s: float = 0.0
    step: int = 0
    time_step_s: float = 0.0
    phase: str = "start"
    constraint_speeds: np.ndarray = field(default_factory=lambda: np.zeros((0, 3)))
    friction: dict[str, np.ndarray] = field(default_factory=dict)
    contact: dict[str, np.ndarray] = field(default_factory=dict)
    run: dict[str, float] = field(default_factory=dict)
    work_j: dict[str, float] = field(default_factory=lambda: {"friction": 0.0, "internal_friction": 0.0})
    constraint_forces: np.ndarray = field(default_factory=lambda: np.zeros((0, 3)))
    fold_angles: np.ndarray = field(default_factory=lambda: np.zeros(0))
    said: tuple[str, ...] = ()

    def sha256(self) -> str:
        """Hash of the bits of positions, velocities, folds and internal friction."""
        digest = hashlib.sha256()
        for array in (self.positions, self.velocities, self.fold_angles, *(self.friction[key] for key in sorted(self.friction))):
            digest.update(np.ascontiguousarray(array, dtype="<f8").tobytes())
        return digest.hexdigest()
