"""The stepper: stretches of modified Euler steps (steps.py), with a time step from the stiffness of the moment and detection of contact where it is due."""

from __future__ import annotations

import math
import time
from collections.abc import Iterator
from contextlib import contextmanager
from copy import deepcopy
from typing import Any

import numpy as np

from garmentcad.arrays import CHUNKS, floats, indices, threads_apart
from garmentcad.cloth.cloth import Cloth
from garmentcad.cloth.state import State
from garmentcad.constraints.points import ConstraintPoints, apply_bonds, no_bonds
from garmentcad.contact.contact import SURGE, Contact, farthest, respond
from garmentcad.errors import GarmentError
from garmentcad.forces.assembly import ForceAssembly
from garmentcad.forces.button import ForceButton
from garmentcad.forces.force import NO_PARTICLE
from garmentcad.forces.internal import BINS, acting, law_arguments, lay_out_parts
from garmentcad.forces.lattice import lattice_block
from garmentcad.forces.time_step import SAFETY, SmallMotion
from garmentcad.kernel_cache import compile_beside
from garmentcad.solve.inertia import light_across, root_eased, turned
from garmentcad.solve.steps import CUT, DONE, LOOK, MOST_CUTS, RUNAWAY, TORN, TORN_LENGTH, Controls, advance_velocities, run_steps
from garmentcad.solve.stiff_parts import StiffParts, reaches, stages_for, step_of, stiff_particles
from garmentcad.solve.strain_limit import StrainLimit

# Steps between two looks at the stiffness; tangents change slowly at this scale.
STEPS_PER_ESTIMATE = 96
# Way, in lattice spacings, that no particle has exceeded since the last look at the stiffness: strains are what they were. Where motion is steady, folds roll
# on with the strains that they had.
_STILL, _STILL_STEADY = 5e-3, 2e-2
# Steady motion whose time step has changed by less than this is looked at half as often, at most so many steps apart.
_SAME, _LONGEST_WAIT = 0.02, 8.0 * STEPS_PER_ESTIMATE
# Light cloth turns with its normals as they are now before it would be moved along itself by this share more than its step allows for, and at least after so
# many steps. Damped as cloth is within itself, a step of SAFETY bears 0.16. Of 144 drapes of the wardrobe 123 never pass it; a fold that snaps came to 1.6,
# cloth without friction to 2.8.
_TURNED, _FEWEST_STEPS = 0.1, 12
# Other motion of true masses is looked at every time, but its frequency, which costs twenty times as much as its bound, is measured anew only where the bound
# has changed by more than this, or after that wait.
_ALIKE = 0.03
# No particle of a garment moves faster on purpose; a faster one is a sign of a diverging run.
RUNAWAY_M_S = 30.0
_NEVER_S = 1.0  # the step of what does not move
# Longer steps because little is stiff end where forces that contact holds would lead to this speed before it takes them, which would look like such a run.
_PRESSING_M_S = 0.25 * RUNAWAY_M_S


class DivergedError(GarmentError):
    """A particle became faster than any garment moves, or not a number, or a link far longer than any fabric lets it. The message names its place."""

    status = "diverged"

    def __init__(self, cloth: Cloth, particles: np.ndarray, cause: str, state: State) -> None:
        when = f"{state.time_s:.4f} s (step {state.step}, phase {state.phase}, time step {1e3 * state.time_step_s:.3g} ms)"
        super().__init__(f"motion ran away: {_places(cloth, particles)} {cause} at {when}")


class IntersectingError(GarmentError):
    """Contact could not part two pieces of cloth, or cloth and body. The message names their place on the pattern."""

    status = "intersecting"

    def __init__(self, cloth: Cloth, particles: np.ndarray, state: State) -> None:
        super().__init__(f"contact is stuck at {_places(cloth, particles)} ({MOST_CUTS} steps in a row were cut) at {state.time_s:.4f} s (step {state.step})")


def _places(cloth: Cloth, particles: np.ndarray) -> str:
    """Where particles lie on the pattern."""
    vertices = [int(np.argmax(cloth.vertex_particle == particle)) for particle in particles]
    places = [f"panel '{cloth.panel_names[cloth.vertex_panel[v]]}' at ({cloth.vertex_uv_mm[v, 0]:.0f}, {cloth.vertex_uv_mm[v, 1]:.0f}) mm" for v in vertices]
    return " and ".join(dict.fromkeys(places))


class Dynamics:
    """Moves one cloth. Set `constraint`, `equalise`, `drag` and `speed_cap_m_s` between stretches; `seconds` sums wall time by kind of work,
    `cut_steps` counts the steps that contact had to cut.

    forces: those of `internal_forces` and weight. drag: rate c [1/s], one or (P,), relative to air at rest, in proportion to the mass that resists.
    equalise: drape mode; masses of particles whose own stable step is shorter than the median's are raised until it is not (the shape at rest does not depend
    on them). lighten: besides, what touches nothing resists less across the cloth (inertia.py), as `across` (P,3) says. speed_cap_m_s: forces make no particle
    faster, but press it on the body where it lies there. The time step rests on tangents that are a few steps old, and tension stiffens with strain: what a
    weld or a snap sets free must not run ahead of them. measured: tangents change little in a stretch, so the time step comes from the highest frequency
    itself and not from its bound. staged: with true masses, what is much stiffer than the rest does not shorten it (stiff_parts.py). steady: besides, tangents
    hardly change in many, so that looks at them may wait. step_factor: multiplies the time step, for a run that diverged at the step that its stiffness allows.
    softness: by which tension in `forces` is divided, so that a change of it is noticed. fixed: (P,) bool,
    particles that do not move.
    """

    def __init__(self, cloth: Cloth, forces: ForceAssembly, limit: StrainLimit, contact: Contact, fixed: np.ndarray | None = None) -> None:
        self.cloth, self.forces, self.limit, self.contact = cloth, forces, limit, contact
        self.equalise = self.measured = self.steady = self.lighten = False
        self.staged = True
        self.drag: float | np.ndarray = 0.0
        self._drag = np.zeros(cloth.particle_count)
        self.across = np.zeros((cloth.particle_count, 3))
        self._limp: np.ndarray | None = None  # how many times as stiff each particle is in all as across the cloth, where it is to be light
        self.speed_cap_m_s = math.inf
        self.step_factor = self.softness = 1.0
        self.constraint: ConstraintPoints | None = None
        self.seconds = {"steps": 0.0, "detection": 0.0, "stiffness": 0.0}
        self.mean_square_speed = 0.0
        self._parts = lay_out_parts(forces.forces)
        self._deal, self._no_deal = (self._parts.deal(np.full(len(self._parts.kind), chosen)) for chosen in (True, False))
        self._expect_stiff(np.zeros(cloth.particle_count, dtype=bool), 1)
        self._stiffness = np.zeros(cloth.particle_count)
        self._clock, self._out = np.zeros(6), np.zeros((CHUNKS, 2))
        self._masses = floats(cloth.masses)
        # Shanks are damped far more than cloth, and no frequency shows it: whether longer steps bear that is not known.
        self._on_shanks = np.zeros(cloth.particle_count, dtype=bool)
        for force in forces.forces:
            if isinstance(force, ForceButton):
                self._on_shanks[force.corners[force.corners != NO_PARTICLE]] = True
        self.cut_steps = 0
        self.hold_still(np.zeros(cloth.particle_count, dtype=bool) if fixed is None else fixed)
        if not getattr(run_steps, "overloads", True):
            self._compile_beside()

    def hold_still(self, fixed: np.ndarray) -> None:
        """From now on the particles `fixed` (P,) bool do not move, and no others are kept from it."""
        self.fixed = fixed
        self._estimated_at: np.ndarray | None = None
        self.true_inverse_masses = np.where(fixed, 0.0, 1.0 / self.cloth.masses)
        self.set_inverse_masses(self.true_inverse_masses)

    def set_inverse_masses(self, inverse_masses: np.ndarray) -> None:
        """Inertia (P,) 1/kg of the next steps, for motion and for what shares impulses between particles."""
        self.inverse_masses = inverse_masses
        self.contact.set_inverse_masses(inverse_masses)
        if self.constraint is not None:
            self.constraint.set_inverse_masses(inverse_masses)

    def start(self, state: State) -> None:
        """Prepare a fresh state: sliders that it does not bring are those of cloth that was never strained; contact allocates and detects."""
        state.friction = self.forces.slack() | state.friction
        self.contact.start(state)
        self.estimate_time_step(state)

    def _compile_beside(self) -> None:
        """Let another process begin with the longest of what `run_steps` calls, in the order in which this one will ask for it: there is much to do before."""
        contact, sums = self.contact, self.forces.sums(self._masses)
        lattice: Any = self.forces.forces[0]  # `lay_out_parts` has seen that it is
        blocks, coefficients, setting, rooms = lattice.arguments
        rules, places = contact.arguments(contact.blank()), (contact.positions, contact.velocities)
        inertia = (self._drag, contact.inverse_masses, self.across)
        compile_beside(
            (lattice_block, (0, blocks, (coefficients, lattice.slack()), setting, *places, rooms, sums.corner_forces)),
            (respond, (rules, (*places, contact.inverse_masses, 0.0), 0.0, 0.0, 0.0)),
            (advance_velocities, (sums, (0.0, 0.0), inertia, rules[4], rules[3].friction, rules[6].pressed, *places, self._out)),
            (apply_bonds, (no_bonds(), contact.positions, 0.0, contact.velocities)),
        )

    def estimate_time_step(self, state: State) -> None:
        """Largest stable step for the tangents, and in drape mode the masses for the median particle's step; where nothing has moved, those of before."""
        began = time.perf_counter()
        key = np.array([self.equalise, self.lighten, self.measured, self.staged, self.step_factor, self.softness], dtype=np.float64)
        home = state.contact.get("stiff_home")
        known = home is not None and np.array_equal(key, state.contact["stiff_key"])
        if known and home is not self._estimated_at:
            self._estimate_at_home(state)  # a resumed run, or other particles held: what was estimated there is not known here
            self._lighten(state.contact["light_home"])
        fresh = home is None or not known or self._moved_on(state, home)
        if home is None:
            state.contact |= {"stiff_held": np.zeros_like(state.positions), "stiff_weight": np.ones(len(state.positions)), "cuts_in_row": np.zeros(1)}
        if fresh:
            before = state.time_step_s
            state.contact |= {"stiff_home": state.positions.copy(), "stiff_key": key, "stiff_touching": self.contact.touching(state)}
            state.contact["light_home"] = state.contact["stiff_home"]
            self._estimate_at_home(state)
            same = known and abs(state.time_step_s - before) < _SAME * before
            wait = min(2.0 * float(state.contact["stiff_wait"][0]), _LONGEST_WAIT) if same else float(STEPS_PER_ESTIMATE)
            state.contact["stiff_wait"] = np.array([wait, state.step + wait])
        self.seconds["stiffness"] += time.perf_counter() - began

    def _estimate_at_home(self, state: State) -> None:
        """Set time step and masses by the tangents where they were last looked at, `stiff_home` of the state."""
        self._estimated_at = state.contact["stiff_home"]
        self.forces.stiffness(self._estimated_at, self._stiffness)
        self._choose_step(state, self.equalise, self.measured)

    def _moved_on(self, state: State, home: np.ndarray) -> bool:
        """Whether the tangents at `home` may be others than those of now."""
        waits = state.step < state.contact["stiff_wait"][1]
        if self.steady and waits:
            return False
        if not farthest(state.positions, home) > (_STILL_STEADY if self.steady else _STILL) * self.cloth.spacing:
            return False
        if self.steady or self.equalise or not self.measured or not waits:
            return True
        here = np.empty_like(self._stiffness)
        self.forces.stiffness(state.positions, here)
        now = self._least_of(self._own_steps(here))
        return any(abs(step - before) > _ALIKE * before for step, before in zip(now, self._least, strict=True))

    def _own_steps(self, stiffness: np.ndarray) -> np.ndarray:
        """The step that the bound `stiffness` (P,) of each particle allows it, s; infinite for what does not move."""
        own, moving = np.full(len(stiffness), np.inf), ~self.fixed & (stiffness > 0.0)
        own[moving] = 2.0 * SAFETY * np.sqrt(self.cloth.masses[moving] / stiffness[moving])
        return own

    def _least_of(self, own: np.ndarray) -> tuple[float, float]:
        """The shortest of these steps (P,), s, of what was stiff when the frequency was measured, and of the rest."""
        return float(own[self._was_stiff].min(initial=_NEVER_S)), float(own[~self._was_stiff].min(initial=_NEVER_S))

    def _choose_step(self, state: State, equalise: bool, measured: bool) -> None:
        own = self._own_steps(self._stiffness)
        moving = np.isfinite(own)
        smallest = float(own.min(initial=np.inf))
        if not np.isfinite(smallest):
            smallest = 1e-3
        self.across[:], self._limp = 0.0, None
        if equalise and self.lighten:
            home, across = state.contact["stiff_home"], np.empty_like(self._stiffness)
            self.forces.stiffness_across(home, across)
            self._limp = np.where(self.fixed | state.contact["stiff_touching"], 0.0, self._stiffness / np.maximum(across, 1e-30))
            self._lighten(home)
        wanted, inverse_masses = smallest, self.true_inverse_masses
        if equalise and moving.any():
            wanted = float(np.median(own[moving]))
            inverse_masses = self.true_inverse_masses / np.maximum(1.0, (wanted / own) ** 2)
        stiff, stages = stiff_particles(own, moving) & ~self._on_shanks, 1
        self._was_stiff = stiff
        self._least = self._least_of(own)
        if measured:
            about = SmallMotion(self.forces, state.contact["stiff_home"])
            step = self._measured_step(about, inverse_masses, wanted)
            # The bound is one of cloth that resists alike in all directions. Where it is lighter across, its frequency may lie above.
            wanted = step if self.across.any() else max(wanted, step)
            if stiff.any() and self.staged and not equalise:
                work = float(self._parts.work[self._parts.around(stiff)].sum() / self._parts.work.sum())
                rest_s = self._measured_step(about, np.where(stiff, 0.0, inverse_masses), wanted)
                rest_s = min(rest_s, self._pressing_step(about.forces))
                stages = stages_for(wanted, rest_s, work)
                wanted = step_of(stages, wanted, rest_s)
        self._expect_stiff(stiff, stages)
        state.contact["stiff_weight"][~stiff] = 1.0
        self._set_step(state, self.step_factor * wanted, inverse_masses)

    def _lighten(self, positions: np.ndarray) -> None:
        """Let cloth that is to be light be so across itself as it lies there (P,3)."""
        if self._limp is not None:
            self.across[:] = light_across(self.cloth.particle_triangles, positions, self._limp)

    def _follow_turns(self, state: State, steps: int) -> int:
        """For how many of the next steps light cloth may keep the normals that it has, which are those of now where it would not for so many."""
        if self._limp is None or self._turned(state, steps) <= _TURNED:
            return steps
        state.contact["light_home"] = state.positions.copy()
        self._lighten(state.positions)
        while steps > _FEWEST_STEPS and self._turned(state, steps) > _TURNED:
            steps //= 2
        return steps

    def _turned(self, state: State, steps: int) -> float:
        """How far light cloth will have turned after so many steps with the velocities of now (inertia.py)."""
        return turned(self.cloth.particle_triangles, state.positions + steps * state.time_step_s * state.velocities, self.across)

    def _measured_step(self, about: SmallMotion, inverse_masses: np.ndarray, otherwise: float) -> float:
        """The step that the highest frequency allows to what moves, s; otherwise: where nothing does."""
        masses = np.sqrt(inverse_masses)[:, None]
        light = bool(self.across.any())
        frequency = about.highest_frequency(lambda vectors: masses * (root_eased(vectors, self.across) if light else vectors))
        return 2.0 * SAFETY / frequency if frequency > 0.0 else otherwise

    def _pressing_step(self, forces: np.ndarray) -> float:
        """The step in which none of these forces (P,3) N, which may be held by contact, leads to a speed that looks like a run that diverges, s."""
        fastest = float((np.linalg.norm(forces, axis=1) * self.true_inverse_masses).max())
        return _PRESSING_M_S / max(fastest, 1e-9)

    def _expect_stiff(self, particles: np.ndarray, stages: int) -> None:
        """From now on the forces on the particles (P,) bool are taken in so many stages."""
        deal = self._parts.deal(self._parts.around(particles)) if stages > 1 else self._no_deal
        chosen = indices(np.flatnonzero(particles))
        self._stiff = deal, chosen, np.array(reaches(stages)), np.zeros((2, len(chosen), 3))

    def _set_step(self, state: State, time_step_s: float, inverse_masses: np.ndarray) -> None:
        self.set_inverse_masses(inverse_masses)
        before, state.time_step_s = state.time_step_s, time_step_s
        if before > 0.0 and "pair_impulse" in state.contact:
            # What is remembered is a force: the next step starts from its impulse.
            state.contact["pair_impulse"] *= state.time_step_s / before

    @contextmanager
    def true_masses(self, state: State) -> Iterator[None]:
        """For as long as this lasts: true masses, and the time step that they allow, or that of a motion that has them already."""
        self.estimate_time_step(state)
        if not self.equalise:
            yield
            return
        own, across, limp = (state.time_step_s, self.inverse_masses), self.across.copy(), self._limp
        self._choose_step(state, False, False)
        try:
            yield
        finally:
            self._set_step(state, *own)
            self.across[:], self._limp = across, limp

    @contextmanager
    def loaded(self) -> Iterator[None]:
        """For as long as this lasts, constraints go on with the forces of their last step."""
        if self.constraint is not None:
            self.constraint.loaded = True
        try:
            yield
        finally:
            if self.constraint is not None:
                self.constraint.loaded = False

    def advance(self, state: State, steps: int) -> None:
        """Many steps. DivergedError where motion runs away, IntersectingError where contact cannot part what it holds."""
        self.mean_square_speed = 0.0
        self._check(state)
        end = state.step + steps
        while state.step < end:
            self.estimate_time_step(state)
            count = self._follow_turns(state, min(STEPS_PER_ESTIMATE, end - state.step))
            self.contact.place(state, count * state.time_step_s)
            with threads_apart():
                self._stretch(state, count)

    def correct_velocities(self, state: State) -> None:
        """The velocity half of a step of `state.time_step_s`: forces, constraints, strain limiting, contact."""
        self.contact.place(state, state.time_step_s)
        self._stretch(state, 1, hold=True)

    def _stretch(self, state: State, steps: int, hold: bool = False) -> None:
        contact, count, dt = self.contact, self.cloth.particle_count, state.time_step_s
        self._drag[:] = self.drag
        controls = Controls(dt, self._drag, self.across, self.speed_cap_m_s, RUNAWAY_M_S, SURGE, contact.covered, self._out)
        lost = np.zeros(BINS)
        forces = law_arguments(self._parts.first, self.forces.forces), acting(self._deal, state.friction, lost)
        sums = self.forces.sums(self._masses)
        # Forces that only lead to those of the step do not move its sliders.
        deal, particles, reach, home = self._stiff
        ahead = acting(deal, deepcopy(state.friction) if len(reach) else state.friction, np.zeros(BINS))
        stiff = StiffParts(ahead, particles, reach, home, state.contact["stiff_held"], state.contact["stiff_weight"])
        bonds = no_bonds()
        if self.constraint is not None:
            bonds = self.constraint.bonds(state.constraint_speeds, state.constraint_forces)
        contact.load(state)
        motion = (contact.positions, contact.velocities, contact.inverse_masses)
        left, resumed, began, in_row = steps, False, state.time_s, state.contact["cuts_in_row"]
        while left > 0:
            t0 = time.perf_counter()
            clock = (state.contact["pair_home"], state.contact["pair_covered"])
            touch = (contact.arguments(state), motion, clock, (contact.leg, state.time_s - began))
            code = run_steps((left, resumed, hold), controls, forces, stiff, sums, bonds, self.limit, touch, self._clock)
            done = int(self._clock[0])
            state.positions[:], state.velocities[:] = contact.positions[:count], contact.velocities[:count]
            state.step += done
            state.time_s += (done - (1.0 - self._clock[4])) * dt
            state.work_j["friction"] += float(self._clock[1])
            state.work_j["internal_friction"] -= float(lost.sum())
            lost[:] = 0.0
            self.mean_square_speed = max(self.mean_square_speed, float(self._clock[2]))
            left -= done
            t1 = time.perf_counter()
            self.seconds["steps"] += t1 - t0
            if code == RUNAWAY:
                raise self._runaway(state)
            if code == TORN:
                ends = self.cloth.links.ends[int(self._clock[3])]
                raise DivergedError(self.cloth, ends, f"came apart: a link is over {TORN_LENGTH:g} times as long as its strain limit allows", state)
            resumed = code == LOOK
            if code == LOOK:
                contact.detect(state, float(self._clock[5]) * dt)
                self.seconds["detection"] += time.perf_counter() - t1
            if code == DONE and hold:
                return
            if code == CUT:
                self.cut_steps += 1
                in_row[0] = 1.0 if done > 1 else in_row[0] + 1.0
                if in_row[0] == MOST_CUTS:
                    raise IntersectingError(self.cloth, self._stuck(state, int(self._clock[3])), state)
            elif done > 0:
                in_row[0] = 0.0

    def _stuck(self, state: State, pair: int) -> np.ndarray:
        """Particles of the pair that cut a step; the fastest one where only its speed did (-1)."""
        return self.contact.nodes_of(state, pair) if pair >= 0 else np.array([np.argmax((state.velocities**2).sum(axis=1))])

    def _check(self, state: State) -> None:
        if not (state.velocities**2).sum(axis=1).max(initial=0.0) < RUNAWAY_M_S**2:
            raise self._runaway(state)

    def _runaway(self, state: State) -> DivergedError:
        squares = np.nan_to_num((state.velocities**2).sum(axis=1), nan=np.inf)
        worst = int(np.argmax(squares))
        return DivergedError(self.cloth, np.array([worst]), f"reached {math.sqrt(squares[worst]):.3g} m/s, the limit is {RUNAWAY_M_S:g} m/s,", state)

    def net_forces(self, state: State) -> np.ndarray:
        """Forces of the laws and weight (P,3), N, at zero velocity, and of the constraints, as they were in the last step; contact left out."""
        total = np.zeros_like(state.velocities)
        self.forces.add_up(state.positions, np.zeros_like(state.velocities), total, deepcopy(state.friction))
        return total if self.constraint is None else total + self.constraint.pulls(state.constraint_forces)

    def constraint_errors(self, state: State) -> tuple[np.ndarray, np.ndarray]:
        """|C| m and |C'| m/s (R,) of each row of the constraints; nothing where there are none."""
        if self.constraint is None:
            return np.zeros(0), np.zeros(0)
        self.contact.load(state)
        gaps, speeds = self.constraint.gaps(self.contact.positions), self.constraint.speeds(self.contact.velocities)
        return np.linalg.norm(gaps, axis=1), np.linalg.norm(speeds, axis=1)

    def measures(self, state: State) -> tuple[float, float, float]:
        """Kinetic energy J, largest speed m/s, RMS speed m/s (mass-weighted)."""
        squares = (state.velocities**2).sum(axis=1)
        energy = 0.5 * float((self.cloth.masses * squares).sum())
        return energy, math.sqrt(squares.max(initial=0.0)), math.sqrt(2.0 * energy / float(self.cloth.masses.sum()))
