"""What the stepper knows of a contact."""

from __future__ import annotations

from typing import Protocol

import numpy as np

from garmentcad.cloth.state import State


class Contact(Protocol):
    """Keeps distances. In a step: detect, forces, constraints, strain limiting, then `respond` of the cloth and last that of the body."""

    name: str

    def start(self, state: State) -> None:
        """Allocate the detection clock and the candidate lists in `state.contact`, under keys that begin with the name. Everything that a later
        step reads lies there, so that a copied or reloaded State goes on with the same bits."""

    def set_inverse_masses(self, inverse_masses: np.ndarray) -> None:
        """Inertia (P,) 1/kg that shares impulses between particles from now on; 0 for a particle that contact must not move."""

    def detect(self, state: State, reserve_m: float) -> bool:
        """Look for candidates again where the way travelled since the last look plus `reserve_m` exceeds what that look covers.

        reserve_m: upper bound of the way that any particle goes in the coming step. True if anything was looked for again.
        """

    def respond(self, state: State, time_step_s: float) -> None:
        """Correct `state.velocities` in place, so that positions + time_step_s * velocities keep their distances; add the work that friction
        does on the cloth (it is negative) to `state.work_j["friction"]`."""
