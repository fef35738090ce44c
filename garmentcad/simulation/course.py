"""The course of a drape: close the seams without gravity, weld, fall, settle, watch. Each phase is a few numbers and a question that ends it."""

from __future__ import annotations

import math
from collections.abc import Callable
from copy import deepcopy
from dataclasses import dataclass, fields, replace

import numpy as np

from garmentcad.cloth.state import State
from garmentcad.forces.force import TENSION
from garmentcad.solve.dynamics import STEPS_PER_ESTIMATE, DivergedError, Dynamics
from garmentcad.solve.rest import PATCH_RESIDUAL_G, RESIDUAL_G, Residual, mean_over, patches, residual
from garmentcad.units import GRAVITY_M_S2

STEPS_PER_LOOK = 2 * STEPS_PER_ESTIMATE  # a phase begins with a fresh time step
CLOSED_M = 0.1e-3  # seams are welded below this gap
CAUGHT_M = 0.5e-3  # and where more than two layers meet, whose contact holds them a few tenths apart as long as they are not one
CLOSING_RATE = 14.0  # 1/s, of the dynamic constraints
# The floor of the closing speed. A row demands its speed both ways, so that it also holds back what would close faster: two ends in a crease of the body, where
# its walls turn the pull of the cloth aside, then stand still with all the force that closes them taken up. After a while the floor doubles with every tenth.
CLOSING_LEAST_M_S, CLOSING_LATE_S, CLOSING_DOUBLES_S = 0.05, 0.6, 0.1
# What is pulled as fast as cloth may go and still stands open is held apart by layers that lie between: where a collar folds over its seam, say. From then on
# the gap below which seams are welded doubles with every so many seconds, up to the widest that is a closed seam; and so does that of pins and buttons.
# The share of its gap that a stitch of three layers closes in a step does as well, so that it presses harder: 0.06 N of contact held a pleat 1.5 mm open.
CLOSED_LATE_S, CLOSED_DOUBLES_S = 1.0, 0.2
# What is open then is mostly held by the corner of its own seam, which was folded over on its way: both corners of an armpit lay on one side of each other and
# held a seam 4 mm open with no more than they weigh. From then on what is sewn to each other passes.
CLOSING_PASS_S = 2.0
# Or by the free corner of something else, the end of a cuff that stands out between it and its sleeve. From then on such corners are pulled out.
CLOSING_PULL_OUT_S = 3.0
CLOSING_PULL_N_M = 100.0  # per length of seam, at most: a fifth of what the tensile tester pulls
# A waistband that is closed over what is worn already has to press it into folds: 15 N on 38 mm, an estimate of what a hand does. With 4 N it stood 43 mm
# open over a tucked T-shirt when with 15 N it was at 5, and at 0.3 soon after.
CLOSING_OVER_N_M = 400.0
CLOSING_DRAG = 12.0  # 1/s
CLOSING_CAP_S = 4.0
FALL_DRAG = 3.0
FALL_S = 1.5
# Of it on coarse lattices; small folds form on the fine one, while tension is soft and they pass each other. Cloth that nothing is sewn to falls to the end on
# a coarse one, where its large folds snap into place at an eighth of the cost, and then on the finer one for what this leaves once more: W1 at 10 mm settled
# from six starts after 11,300 to 15,900 steps so; otherwise after up to 34,900.
COARSE_FALL_S = 1.0
# While seams close and cloth falls, tension is softened: the time step grows by the root of it, and the shape that counts is found afterwards at
# true stiffness.
SOFTNESS = 8.0
# Cloth that nothing is sewn to may be softer yet, so that folds pass each other until few and deep ones are left. A garment may not: what holds it up, bands
# and tight seams, would give way, and come back late.
LOOSE_SOFTNESS = 64.0
# The last part of the fall brings tension back little by little, because a sudden jump would turn the strain of soft cloth into speed.
STIFFEN_S = 0.3
# Soft cloth gives way where a garment is tight: its weight pulls it down over what is wider, and friction would keep it there when tension is back. Where more
# than this share of a panel is strained so far that its own stiffness would pull with so much, cloth slips on the body while tension comes back, and finds its
# place: trousers of GarmentCode go up by 56 mm, to 4 mm from where their draft has them. Panel by panel, and by all that carries tension: a waistband is a
# hundredth of a skirt, and on 20 mm has no links. Of the waistbands of the shipped garments 12 to 30 % are strained so, of other panels at most
# 2 %, as far as they were asked. No share of the strain limit: that is as far in a band cut double as in one that is not, which gives way more.
TIGHT_N_M, TIGHT_SHARE = 150.0, 0.05
STRETCHED = 0.03  # ease of a seam from which on its shorter side is tight because the draft stretches it
# No part of a garment that is being dressed goes faster than this; what a weld or a snap sets free would. At a step of 0.1 ms it is 1 % of 10 mm.
SPEED_CAP_M_S = 1.0
# Cloth that nothing is sewn to has no weld, and falls faster by itself: held at 1 m/s, discs on a pedestal came to rest with 1.5 folds and 3.5 points of drape
# coefficient less than in true motion, from 1.25 m/s on with 0.4 folds and 1.5 points less. Not much faster, or soft cloth folds over itself quicker than it
# parts (W1 at 20 mm with 5 m/s and less drag).
LOOSE_SPEED_CAP_M_S = 1.5
# Nor does a garment with buttons or bands go faster than this while it falls in dynamics, which is more than cloth falls by itself: a belt that is drawn
# together at once from half as long again pulls a million g at the ends of its segments, and threw a wrap skirt at 60 m/s.
THROWN_M_S = 5.0
# Where it is decided whether a garment is at rest no force is cut short that leads to less than this speed: no motion of cloth. A taut elastic may press a
# particle onto the body with a million g, which contact takes; that is no speed at which a run is taken to diverge.
UNCUT_M_S = 20.0
# Settling with fictitious masses: the drag falls with the time since, as beta/t. A drag that is critical for fast modes makes slow ones creep, and one for slow
# modes lets fast ones ring; under beta/t a mode of frequency w comes to rest from t = beta/(2 w) on as (w t)^(-beta/2), whatever w, and none has to be known.
SETTLE_DECAY = 5.0
# Its least: light cloth sways several times as fast as with all its mass. W1 came to rest from four starts after 12 % fewer steps than with 8; with 24 after
# more, because what is about to snap over creeps.
LIGHT_DRAG = 16.0
# What touches nothing resists less across the cloth (inertia.py) from the first look on at which the residual is below this: before, folds turn too fast.
CALM_G = 0.1
# Settling with true masses: the drag of a patch follows the frequency that it shows, acceleration over speed. Patch by patch, because a few particles that snap
# over must not hold back all others. At least critical for a mode of 4 rad/s, about the slowest of a skirt.
SETTLE_DRAG, SETTLE_SHARE, SETTLE_MOST = 8.0, 0.3, 200.0
# A watch begins when the residual is below this part of what it must not exceed at its end: slow modes that drag held down go on under less of it.
READY = 0.7
WATCH_DRAG = 1.0
# Air drag of true motion: flat cloth of W = 0.15 kg/m2 that moves broadside at v feels about 0.6 Cd v^2 N/m2 with Cd = 1.2, at 0.5 m/s as much as a rate of
# 2.4 /s. Linear, and alike in every direction: an estimate, not a measured law.
AIR_DRAG = 2.0
WATCH_S = 0.3
# Below this RMS speed a movement is not called growing: 1 mm/s for 0.3 s is a third of a millimetre.
STILL_M_S = 1e-3
STANDS_M_S = 1e-8  # RMS speed below which nothing moves: round-off of a settled garment
# What is out of balance gathers speed until drag takes as much: at the most drag, residual over drag. Where cloth moves with less than this part of that, it is
# held: a robe under a belt, 23 g out of balance, crept to a standstill for two simulated seconds.
HELD_SHARE = 3e-4
_SLIPS = "slips"  # in State.run: whether cloth slips while tension comes back
_CALM = "calm"  # in State.run: whether the residual has been below CALM_G
_TRULY = "truly"  # in State.run: whether cloth settles with true masses; from where a watch ended with a residual above its bar though nothing grew, or
# cloth of other masses stood still out of balance
_PLAIN = "plain"  # in State.run: whether a watch has been; the next one takes the steps that its stiffest part bears
FELL = "fell"  # in State.run: all of the garment is below the body
STANDS = "stands"  # in State.run: whether cloth stood still with true masses, out of balance
SMALLEST_STEP_FACTOR = 1.0 / 8.0  # of the time step that the stiffness allows, to which a run that diverges is taken back before it is given up


@dataclass(frozen=True)
class Progress:
    """One look at a running drape. phase: of the state, or `refine` where a coarser lattice is done and a finer one follows. eta_s: simulated seconds until
    rest, from the trend of the residual; None where there is none, and before it settles."""

    phase: str
    step: int
    time_s: float
    gap_mm: float | None
    residual_g: float | None
    rms_speed_m_s: float
    eta_s: float | None


def advance_or_retreat(dynamics: Dynamics, state: State, steps: int = STEPS_PER_LOOK) -> bool:
    """Some steps; where motion runs away, back to the state before them (False): the next ones are half as long.

    DivergedError where they are as short as they may become: what diverges then is not a matter of the step.
    """
    good = deepcopy(replace(state, contact={}))  # what contact remembers is most of a state, and is found anew in the rare case
    dynamics.step_factor = state.run.get("step_factor", 1.0)
    try:
        dynamics.advance(state, steps)
    except DivergedError:
        if dynamics.step_factor <= SMALLEST_STEP_FACTOR:
            raise
        for part in fields(State):
            setattr(state, part.name, getattr(good, part.name))
        state.run["step_factor"] = 0.5 * dynamics.step_factor
        dynamics.start(state)
        return False
    return True


class Course:
    """Runs the phases after sewing on welded cloth, and looks every STEPS_PER_LOOK steps. All that decides lies in `state`: a resumed run decides alike.

    soften(softness): divides tension of its forces by another softness. max_time_s: cap on simulated time.
    loose: whether nothing is sewn, so that cloth falls softer and faster in mode 'drape'. last: whether this is the lattice of the job; on a coarser one the
    course is over when most of the fall is, of loose cloth all of it. buttoned: whether the garment has buttons; tied: buttons, belts or elastics.
    tight(positions): whether the garment is so at positions (P,3) m that it has to find its place. small: whether it falls in either mode as in 'dynamics'.
    mode: 'drape' (equalised masses, damping of fall and settle) or 'dynamics' (true masses, light damping).
    """

    def __init__(
        self,
        dynamics: Dynamics,
        soften: Callable[[float], None],
        mode: str,
        max_time_s: float,
        loose: bool = False,
        last: bool = True,
        buttoned: bool = False,
        tied: bool = False,
        tight: Callable[[np.ndarray], bool] = lambda positions: False,
        small: bool = False,
    ) -> None:
        self.dynamics, self.soften, self.mode, self.max_time_s, self.is_last = dynamics, soften, mode, max_time_s, last
        self._softness, self._cap = (LOOSE_SOFTNESS, LOOSE_SPEED_CAP_M_S) if loose else (SOFTNESS, SPEED_CAP_M_S)
        self._small = small
        self._coarse_fall_s = FALL_S if loose else COARSE_FALL_S
        self._buttoned, self._tied, self._tight = buttoned, tied, tight
        self._patch = patches(dynamics.cloth)
        self.last: Residual | None = None

    def run(self, state: State, look: Callable[[Progress], None]) -> str:
        """Advance until rest, standstill, the cap, or until all of it has fallen past the body. Returns 'converged' or 'max_time'; DivergedError where smaller
        steps do not help. `look` may raise to interrupt (a checkpoint of `state` is then whole)."""
        while state.phase != "rest":
            if self._is_off(state):
                state.run[FELL] = 1.0
            self.set_phase(state)  # of a run that ends at once, too: its residual is measured
            if state.time_s >= self.max_time_s or STANDS in state.run or FELL in state.run:
                return "max_time"
            if not advance_or_retreat(self.dynamics, state):
                continue
            if state.phase == "watch":
                self._watch(state)
            self._decide(state, look)
        return "converged"

    def set_phase(self, state: State) -> None:
        """Forces, masses and damping of the phase in which the state is."""
        dynamics, true_motion = self.dynamics, self._in_true_motion(state)
        dynamics.steady = state.phase != "fall"
        # While soft cloth falls in drape mode its tension comes back within a stretch of steps; the bound of the frequency covers that.
        dynamics.measured = dynamics.steady or true_motion
        # The shares of contact and of a pin or button that it holds against depend on inertia: what is to be at rest with true masses settles with them. So
        # does what rang in a watch, because the change of masses set it off.
        truly = dynamics.constraint is not None or self._buttoned or _TRULY in state.run
        dynamics.equalise = not true_motion and (state.phase == "fall" or (state.phase == "settle" and not truly))
        # What is held may tremble in longer steps than its own, by a ten-thousandth of a millimetre: nothing for motion, but too much for rest.
        dynamics.staged = state.phase in ("fall", "watch") and _PLAIN not in state.run
        dynamics.lighten = state.phase == "settle" and _CALM in state.run
        # What decides on rest cuts no force short: so cut, the tension of an elastic held folds that gave way in true motion, by 40 mm.
        if state.phase == "watch" or _TRULY in state.run:
            dynamics.speed_cap_m_s = UNCUT_M_S
        elif true_motion:
            dynamics.speed_cap_m_s = THROWN_M_S if self._tied and state.phase == "fall" else math.inf
        else:
            dynamics.speed_cap_m_s = self._cap
        softness = 1.0
        if not true_motion and state.phase == "fall":
            left = max(0.0, FALL_S - (state.time_s - state.run["phase_from_s"]))
            softness = float(self._softness ** min(1.0, left / STIFFEN_S))
            if left < STIFFEN_S and _SLIPS not in state.run:
                state.run[_SLIPS] = float(self._tight(state.positions))
        dynamics.contact.let_slip(state.phase == "fall" and state.run.get(_SLIPS, 0.0) > 0.0)
        if softness != dynamics.softness:
            self.soften(softness)
            dynamics.softness = softness
        settling = state.contact.get("settle_drag", SETTLE_MOST if dynamics.equalise else SETTLE_DRAG)
        drags: dict[str, float | np.ndarray] = {"fall": FALL_DRAG, "settle": settling, "watch": WATCH_DRAG}
        dynamics.drag = AIR_DRAG if true_motion else drags[state.phase]

    def _in_true_motion(self, state: State) -> bool:
        """Whether cloth moves as it does by itself, with its own masses and tension."""
        return self.mode == "dynamics" or (self._small and state.phase == "fall")

    def _is_off(self, state: State) -> bool:
        body = self.dynamics.contact.positions[self.dynamics.contact.count :]
        return len(body) > 0 and bool(state.positions[:, 1].max() < body[:, 1].min())

    def _watch(self, state: State) -> None:
        """Largest RMS speed in each third of the watch, as far as it ended in the last stretch."""
        third = min(2, int(3.0 * (state.time_s - state.run["watch_from_s"]) / WATCH_S))
        key = f"watch_rms_{third}"
        state.run[key] = max(state.run.get(key, 0.0), math.sqrt(self.dynamics.mean_square_speed))

    def _decide(self, state: State, look: Callable[[Progress], None]) -> None:
        _, _, rms = self.dynamics.measures(state)
        left: Residual | None = None
        if state.phase == "fall":
            fallen = state.time_s - state.run["phase_from_s"]
            if not self.is_last and fallen >= self._coarse_fall_s:
                state.run["phase_from_s"] += self._coarse_fall_s - COARSE_FALL_S
                state.run.pop(_SLIPS, None)
                state.phase = "rest"
            elif fallen >= FALL_S:
                if not self._in_true_motion(state):
                    # From here on the cloth is loaded as if it had not been soft: the strain of that, and its way back, leave no trace in its friction.
                    self.dynamics.forces.slacken(state.friction, state.positions, TENSION)
                self._enter(state, "settle")
        elif state.phase == "settle":
            left = self.last = residual(self.dynamics, state, self._patch)
            if left.rms_g < CALM_G:
                state.run[_CALM] = 1.0
            self._follow(state, left)
            if left.rms_g < READY * RESIDUAL_G and left.worst_patch_g < READY * PATCH_RESIDUAL_G:
                if self.dynamics.equalise:
                    # Speeds of fictitious masses mean nothing to the true ones: light cloth would ring with up to 64 times its energy.
                    state.velocities[:] = 0.0
                self._enter(state, "watch")
                state.run["watch_from_s"] = state.time_s
            elif rms < max(STANDS_M_S, HELD_SHARE * GRAVITY_M_S2 * left.rms_g / SETTLE_MOST):
                # What other masses than the true ones stand still with may yet move with these. What does not is no nearer to rest at any later time.
                state.run[_TRULY if self.dynamics.equalise else STANDS] = 1.0
        elif state.phase == "watch" and state.time_s - state.run["watch_from_s"] >= WATCH_S:
            left = self.last = residual(self.dynamics, state, self._patch)
            grew = state.run["watch_rms_2"] > max(STILL_M_S, state.run.get("watch_rms_1", 0.0))
            if not left.at_rest and not grew:
                state.run[_TRULY] = 1.0
            state.run[_PLAIN] = 1.0  # where another one follows
            self._enter(state, "rest" if left.at_rest and not grew else "settle")
        told = "refine" if state.phase == "rest" and not self.is_last else state.phase
        look(Progress(told, state.step, state.time_s, None, None if left is None else left.rms_g, rms, self._eta(state, left)))

    def _follow(self, state: State, left: Residual) -> None:
        """Set the drag of the settling, from its time; with true masses that of each patch, from how it moves."""
        if self.dynamics.equalise:
            drag = np.full(len(left.patches_g), max(LIGHT_DRAG, SETTLE_DECAY / max(state.time_s - state.run["phase_from_s"], 1e-9)))
        else:
            speeds = np.sqrt(mean_over(self._patch, self.dynamics.cloth.masses, (state.velocities**2).sum(axis=1)))
            drag = SETTLE_SHARE * GRAVITY_M_S2 * left.patches_g / np.maximum(speeds, 1e-9)
        state.contact["settle_drag"] = np.clip(drag, SETTLE_DRAG, SETTLE_MOST)[self._patch]

    def _eta(self, state: State, left: Residual | None) -> float | None:
        """The watch, and before it what is left of settling: from how fast the residual has come down to what lets the watch begin. At most up to the cap."""
        most = max(0.0, self.max_time_s - state.time_s)
        if state.phase == "watch":
            return min(max(0.0, state.run["watch_from_s"] + WATCH_S - state.time_s), most)
        if state.phase != "settle" or left is None:
            return None
        above = math.log(max(left.rms_g / RESIDUAL_G, left.worst_patch_g / PATCH_RESIDUAL_G, 1e-12) / READY)
        if "eta_above" not in state.run:
            state.run["eta_above"], state.run["eta_from_s"] = above, state.time_s
            return None
        fallen = state.run["eta_above"] - above
        return min(max(0.0, above * (state.time_s - state.run["eta_from_s"]) / fallen) + WATCH_S, most) if fallen > 0.0 else None

    def _enter(self, state: State, phase: str) -> None:
        state.phase = phase
        state.run = {key: value for key, value in state.run.items() if not key.startswith(("watch_", "eta_"))}
        state.run["phase_from_s"] = state.time_s
