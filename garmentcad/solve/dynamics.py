"""The stepper: one modified Euler step with every velocity correction between forces and positions, and a time step from the stiffness of the moment.

    v += dt f/m     constraints     strain limiting     contact (last word)     x += dt v
"""

from __future__ import annotations

import math
import time
from collections.abc import Sequence

import numpy as np

from garmentcad.cloth.cloth import Cloth
from garmentcad.cloth.state import State
from garmentcad.constraints.points import ConstraintPoints
from garmentcad.contact.contact import Contact
from garmentcad.errors import GarmentError
from garmentcad.forces.assembly import ForceAssembly
from garmentcad.forces.time_step import SAFETY
from garmentcad.solve.integrate import advance_positions, advance_velocities, motion_measures
from garmentcad.solve.strain_limit import StrainLimit

# Steps between two looks at the stiffness; tangents change slowly at this scale.
STEPS_PER_ESTIMATE = 96
# No particle of a garment moves faster on purpose; a faster one is a sign of a diverging run.
RUNAWAY_M_S = 30.0


class DivergedError(GarmentError):
    """A particle became faster than any garment moves, or not a number. The message names its place on the pattern."""

    def __init__(self, cloth: Cloth, particle: int, speed: float, state: State) -> None:
        vertex = int(np.argmax(cloth.vertex_particle == particle))
        u, v = cloth.vertex_uv_mm[vertex]
        place = f"panel '{cloth.panel_names[cloth.vertex_panel[vertex]]}' at ({u:.0f}, {v:.0f}) mm"
        when = f"{state.time_s:.4f} s (step {state.step}, phase {state.phase}, time step {1e3 * state.time_step_s:.3g} ms)"
        super().__init__(f"motion ran away: {place} reached {speed:.3g} m/s at {when}; the limit is {RUNAWAY_M_S:g} m/s")


class Dynamics:
    """Moves one cloth. Set `constraint`, `equalise` and `speed_cap_m_s` between steps; `seconds` sums wall time by kind of work.

    equalise: drape mode; masses of particles whose own stable step is shorter than the median's are raised until it is not (the shape at rest does not depend
    on them). speed_cap_m_s: forces make no particle faster than this. The time step rests on tangents that are a few steps old, and tension stiffens with
    strain: what a weld or a snap sets free must not run ahead of them. step_factor: multiplies the time step, for a run
    that diverged at the step that its stiffness allows. fixed: (P,) bool, particles that do not move.
    """

    def __init__(self, cloth: Cloth, forces: ForceAssembly, limit: StrainLimit | None, contacts: Sequence[Contact], fixed: np.ndarray | None = None) -> None:
        self.cloth, self.forces, self.limit, self.contacts = cloth, forces, limit, tuple(contacts)
        self.fixed = np.zeros(cloth.particle_count, dtype=bool) if fixed is None else fixed
        self.equalise = False
        self.speed_cap_m_s = math.inf
        self.step_factor = 1.0
        self.constraint: ConstraintPoints | None = None
        self.seconds = {"forces": 0.0, "constraints": 0.0, "detection": 0.0, "response": 0.0}
        self._force = np.zeros((cloth.particle_count, 3))
        self._stiffness = np.zeros(cloth.particle_count)
        self._measures = np.zeros(3)
        self.true_inverse_masses = np.where(self.fixed, 0.0, 1.0 / cloth.masses)
        self.set_inverse_masses(self.true_inverse_masses)

    def set_inverse_masses(self, inverse_masses: np.ndarray) -> None:
        """Inertia (P,) 1/kg of the next steps, for motion and for what shares impulses between particles."""
        self.inverse_masses = inverse_masses
        self.forces.set_inertia(np.divide(1.0, inverse_masses, out=self.cloth.masses.copy(), where=inverse_masses > 0.0))
        for contact in self.contacts:
            contact.set_inverse_masses(inverse_masses)
        if self.constraint is not None:
            self.constraint.set_inverse_masses(inverse_masses)

    def start(self, state: State) -> None:
        """Prepare a fresh state: contacts allocate and detect."""
        for contact in self.contacts:
            contact.start(state)
        self.estimate_time_step(state)

    def estimate_time_step(self, state: State) -> None:
        """Largest stable step for the tangents of the moment, and in drape mode the masses that allow the median particle's step."""
        self.forces.stiffness(state.positions, self._stiffness)
        free = ~self.fixed
        own = np.full(len(self._stiffness), np.inf)
        moving = free & (self._stiffness > 0.0)
        own[moving] = 2.0 * SAFETY * np.sqrt(self.cloth.masses[moving] / self._stiffness[moving])
        smallest = float(own.min(initial=np.inf))
        if not np.isfinite(smallest):
            smallest = 1e-3
        if self.equalise:
            wanted = float(np.median(own[moving]))
            self.set_inverse_masses(self.true_inverse_masses / np.maximum(1.0, (wanted / own) ** 2))
        else:
            wanted = smallest
            self.set_inverse_masses(self.true_inverse_masses)
        state.time_step_s = self.step_factor * wanted

    def step(self, state: State) -> None:
        """One step. DivergedError where motion runs away."""
        if state.step % STEPS_PER_ESTIMATE == 0:
            self.estimate_time_step(state)
            self.check(state)
        dt = state.time_step_s
        self.correct_velocities(state, dt)
        advance_positions(state.velocities, dt, state.positions)
        state.step += 1
        state.time_s += dt

    def correct_velocities(self, state: State, dt: float) -> None:
        """The velocity half of a step: forces, constraints, strain limiting, contact."""
        clock = time.perf_counter
        t0 = clock()
        self.forces.add_up(state.positions, state.velocities, self._force)
        advance_velocities(self._force, self.inverse_masses, dt, self.speed_cap_m_s, state.velocities)
        t2 = clock()
        if self.constraint is not None:
            state.constraint_speeds = self.constraint.next_speeds(state.positions, state.constraint_speeds, dt)
            self.constraint.correct(state.velocities, state.constraint_speeds, dt)
        if self.limit is not None:
            self.limit.limit(state.positions, state.velocities, self.inverse_masses, dt)
        t3 = clock()
        self.seconds["forces"] += t2 - t0
        self.seconds["constraints"] += t3 - t2
        if self.contacts:
            motion_measures(state.velocities, self.cloth.masses, self._measures)
            reserve = min(float(self._measures[1]), RUNAWAY_M_S) * dt
            for contact in self.contacts:
                t4 = clock()
                contact.detect(state, reserve)
                t5 = clock()
                contact.respond(state, dt)
                self.seconds["detection"] += t5 - t4
                self.seconds["response"] += clock() - t5

    def net_forces(self, state: State) -> np.ndarray:
        """Forces of the laws and gravity (P,3), N, at zero velocity; contact and constraints left out."""
        total = np.zeros_like(state.velocities)
        self.forces.add_up(state.positions, np.zeros_like(state.velocities), total)
        return total

    def check(self, state: State) -> None:
        """DivergedError where a particle is faster than any garment moves, or not a number."""
        motion_measures(state.velocities, self.cloth.masses, self._measures)
        speed = float(self._measures[1])
        if not speed < RUNAWAY_M_S:
            squares = np.nan_to_num((state.velocities**2).sum(axis=1), nan=np.inf)
            raise DivergedError(self.cloth, int(np.argmax(squares)), speed, state)

    def measures(self, state: State) -> tuple[float, float, float]:
        """Kinetic energy J, largest speed m/s, RMS speed m/s (mass-weighted)."""
        motion_measures(state.velocities, self.cloth.masses, self._measures)
        return float(self._measures[0]), float(self._measures[1]), float(np.sqrt(self._measures[2]))
