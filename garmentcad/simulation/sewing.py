"""Sewing: stitches close by dynamic constraints, without gravity and gently, order after order, and are then welded; pins and buttons close with the first
ones of their panels, or later where they say so, and stay, buttons on their shanks. A panel that none of the seams of its turn has reached is held still."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from garmentcad.cloth.cloth import Cloth
from garmentcad.cloth.state import State
from garmentcad.constraints.points import LEAST_SHARE, ConstraintPoints, PointRows, joined_rows, rows_where, stitch_rows
from garmentcad.simulation.course import (
    CAUGHT_M,
    CLOSED_DOUBLES_S,
    CLOSED_LATE_S,
    CLOSED_M,
    CLOSING_CAP_S,
    CLOSING_DOUBLES_S,
    CLOSING_DRAG,
    CLOSING_LATE_S,
    CLOSING_LEAST_M_S,
    CLOSING_PASS_S,
    CLOSING_PULL_N_M,
    CLOSING_PULL_OUT_S,
    CLOSING_RATE,
    SPEED_CAP_M_S,
    Progress,
    advance_or_retreat,
)  # fmt: skip
from garmentcad.simulation.mend import pulled_out
from garmentcad.solve.dynamics import Dynamics
from garmentcad.units import M_TO_MM

SEWING = "sewing"  # in State.run: how many times the panels were sewn before
# Cloth may be caught between seams that close around it: the tip of one leg of trousers lay under that of the other and held both inseams 4 mm open, in one
# start of five that differ by a jitter of 0.01 mm. What does not close is placed anew, with another one, so many times in all: then it is a matter of the
# pattern.
SEWINGS = 2
WIDEST_WELD_MM = 1.0  # a seam that was wider open when it was welded did not close
# Seams that something keeps apart may go apart, farther and farther while they are pulled harder: legs that were laid the wrong way around, whose inside seams
# would have closed through the other leg, from 81 mm to 536. Of 28 garments that can be sewn the widest gap of an order grew by 7 mm at most.
APART_M = 0.1
UNWELDABLE = 2.0  # lattice spacings: a seam that stays wider open is not welded, which would draw its ends through whatever keeps them apart
HELD_M = 1e-3  # gap of pins and buttons at which cloth is dressed; they go on to close afterwards
HOLDING_RATE = 1000.0  # 1/s, of pins once the seams are welded
_GAP, _WIDEST_AT, _SPEED, _REDUNDANT = "gap_mm.", "gap_at.", "gap_speed_m_s", "redundant."
_ORDER, _FROM = "sewing_order", "sewing_from_s"  # in State.run: the order that closes, and since when
_LEAST = "sewing_least_m"  # and how narrow its widest gap was


@dataclass(frozen=True)
class Welding:
    """The seams at the instant of welding. gap_mm: largest |C| by seam; speed_m_s: largest |C'| of a stitch; redundant: seams whose stitches repeat others;
    widest_at: by seam, which part of it lies before the stitch of that gap, 0 to 1 from where its sides begin.

    It travels in `State.run`, so that a run resumed after welding reports the same.
    """

    gap_mm: Mapping[str, float] = field(default_factory=dict)
    speed_m_s: float | None = None
    redundant: tuple[str, ...] = ()
    widest_at: Mapping[str, float] = field(default_factory=dict)

    @property
    def widest_mm(self) -> float:
        """The largest gap."""
        return max(self.gap_mm.values(), default=0.0)

    @property
    def open_seams(self) -> list[str]:
        """A sentence for each seam that did not close."""
        bar = f"at most {WIDEST_WELD_MM:g} mm is a closed seam"
        at = {name: f", widest after {100.0 * share:.0f} % of its length" for name, share in self.widest_at.items()}
        wide = {name: gap for name, gap in self.gap_mm.items() if gap > WIDEST_WELD_MM}
        return [f"seam '{name}' did not close: it stood {gap:.1f} mm open{at.get(name, '')} ({bar})" for name, gap in wide.items()]

    @property
    def conflicting(self) -> list[str]:
        """Redundant seams that did not close: rows that repeat others conflict only where they cannot all hold."""
        return [name for name in self.redundant if self.gap_mm.get(name, 0.0) > WIDEST_WELD_MM]

    def as_run(self) -> dict[str, float]:
        """Entries of `State.run`."""
        speed = {} if self.speed_m_s is None else {_SPEED: self.speed_m_s}
        seams = {f"{_GAP}{name}": gap for name, gap in self.gap_mm.items()} | {f"{_WIDEST_AT}{name}": at for name, at in self.widest_at.items()}
        return seams | speed | {f"{_REDUNDANT}{name}": 1.0 for name in self.redundant}

    @classmethod
    def of_run(cls, run: Mapping[str, float]) -> Welding:
        """What `as_run` put there."""
        gaps, ats = ({key.removeprefix(prefix): value for key, value in run.items() if key.startswith(prefix)} for prefix in (_GAP, _WIDEST_AT))
        return cls(gaps, run.get(_SPEED), tuple(key.removeprefix(_REDUNDANT) for key in run if key.startswith(_REDUNDANT)), ats)


def close_seams(
    dynamics: Dynamics,
    state: State,
    hardware: PointRows,
    look: Callable[[Progress], None],
    pull_n_m: float = CLOSING_PULL_N_M,
    until_s: float = math.inf,
    give_up_mm: float = math.inf,
) -> Welding:
    """Pull the stitches of `dynamics.cloth` (without gravity), and what pins and buttons hold, together until every gap is closed or the cap is reached:
    first those of the lowest order, which then hold while the next ones close. A panel whose first seam has not come yet is held where it was placed, and with
    it the pins and buttons on it: what closes before would knock it about. pull_n_m: largest force of a stitch, per length of seam. until_s: simulated time at
    which it ends in any case. give_up_mm: it ends with the first order of which a seam stays wider open than that."""
    cloth = dynamics.cloth
    turns = first_orders(cloth)
    order, held = cloth.seam_order[cloth.stitch_seam], row_orders(hardware, turns)
    began = state.run.get(_ORDER, 0.0)
    for now in [one for one in np.union1d(order, held).tolist() if one >= began] or [began]:
        if state.run.get(_ORDER) != now:
            state.run |= {_ORDER: float(now), _FROM: state.time_s}
            state.run.pop(_LEAST, None)
        dynamics.hold_still(turns > now)
        late = np.concatenate([order[order <= now], held[held <= now]]) < now
        welding = _close(dynamics, state, rows_where(hardware, held <= now), np.flatnonzero(order <= now), late, look, (pull_n_m * cloth.spacing, until_s))
        if state.time_s >= until_s:
            # Seams whose turn has not come stand open, too.
            later = as_they_stand(cloth, state.positions, order > now)
            return replace(welding, gap_mm={**welding.gap_mm, **later.gap_mm}, widest_at={**welding.widest_at, **later.widest_at})
        if welding.widest_mm > give_up_mm:
            return welding
    return welding


def as_they_stand(cloth: Cloth, positions: np.ndarray, chosen: np.ndarray | None = None) -> Welding:
    """How far the seams of a cloth stand open at positions (P,3) m, and where, of the chosen stitches (S,) bool, or of all."""
    rows = slice(None) if chosen is None else chosen
    a, b = (positions[cloth.stitches[rows, side]] for side in (0, 1))
    gap_mm, widest_at = _widest(cloth, cloth.stitch_seam[rows], np.linalg.norm(a - b, axis=1))
    return Welding(gap_mm, widest_at=widest_at)


def held_from_the_start(rows: PointRows, cloth: Cloth, panels: Collection[str]) -> PointRows:
    """Rows with the lowest order of the cloth's seams where all their particles lie on `panels`: what is worn already is done up while more is sewn."""
    worn = np.zeros(cloth.particle_count, dtype=bool)
    worn[cloth.vertex_particle[np.isin(np.array(cloth.panel_names)[cloth.vertex_panel], list(panels))]] = True
    bound = rows.particle < cloth.particle_count  # the rest are a body's nodes
    elsewhere = np.unique(rows.row[bound][~worn[rows.particle[bound]]])
    mine, order = np.isin(np.arange(len(rows.order)), elsewhere, invert=True), cloth.seam_order[cloth.stitch_seam]
    return replace(rows, order=np.where(mine, order.min(), rows.order)) if len(order) else rows


def first_orders(cloth: Cloth) -> np.ndarray:
    """Order (P,) of the first open seam of the panel of each particle; of the first of all where its panel has none."""
    panel_of = np.zeros(cloth.particle_count, dtype=np.int32)
    panel_of[cloth.vertex_particle] = cloth.vertex_panel
    order, orders = cloth.seam_order[cloth.stitch_seam], np.full(len(cloth.panel_names), np.inf)
    np.minimum.at(orders, panel_of[cloth.stitches], order[:, None])
    return np.where(np.isinf(orders), order.min() if len(order) else 0.0, orders)[panel_of]


def row_orders(rows: PointRows, turns: np.ndarray) -> np.ndarray:
    """Order (R,) from which each row acts: its own, or that of the last of its particles to be let go; turns (P,) when they are."""
    orders, bound = rows.order.copy(), rows.particle < len(turns)  # the rest are a body's nodes
    np.maximum.at(orders, rows.row[bound], turns[rows.particle[bound]])
    return orders


def _close(
    dynamics: Dynamics, state: State, hardware: PointRows, chosen: np.ndarray, late: np.ndarray, look: Callable[[Progress], None], most: tuple[float, float]
) -> Welding:
    """Close the `chosen` stitches. most: force of a stitch, N, and simulated time. late: (R,) bool of their rows and those of the hardware, which were closed
    before: they hold with all that closed them."""
    cloth, since, (pull, until_s) = dynamics.cloth, state.run[_FROM], most
    names = tuple(cloth.seam_names[k] for k in cloth.stitch_seam[chosen])
    nodes, sewn = dynamics.contact.nodes, len(names)
    rows = joined_rows(stitch_rows(cloth.stitches[chosen], names), hardware)
    dynamics.constraint = ConstraintPoints(rows, dynamics.inverse_masses, CLOSING_RATE, pull, CLOSING_LEAST_M_S, nodes)
    _make_room(state, rows)
    layered = cloth.seam_layered[cloth.stitch_seam[chosen]]
    caught = np.where(layered, CAUGHT_M, 0.0)
    between = np.concatenate([layered, np.zeros(len(hardware.targets), dtype=bool)])
    dynamics.equalise, dynamics.drag = True, CLOSING_DRAG
    dynamics.speed_cap_m_s = SPEED_CAP_M_S
    told = f"{state.phase} anew" if SEWING in state.run else state.phase
    while True:
        gaps, speeds = dynamics.constraint_errors(state)
        look(Progress(told, state.step, state.time_s, float(gaps.max(initial=0.0)) * 1e3, None, dynamics.measures(state)[2], None))
        leniency = closing_leniency(state.time_s - since)
        closed = bool(np.all(gaps[:sewn] < np.maximum(caught, leniency * CLOSED_M))) and gaps[sewn:].max(initial=0.0) < leniency * HELD_M
        widest = float(gaps[:sewn].max(initial=0.0))
        least = state.run[_LEAST] = min(state.run.get(_LEAST, widest), widest)
        if closed or widest > least + APART_M or state.time_s >= min(since + CLOSING_CAP_S, until_s):
            break
        dynamics.constraint.least_share = np.where(between, min(1.0, leniency * LEAST_SHARE), LEAST_SHARE)
        # By the clock alone, and for every look anew: so it is the same in a run that goes on from here.
        if state.time_s - since >= CLOSING_PULL_OUT_S:
            pulled = pulled_out(state.positions, cloth.particle_triangles, cloth.stitches[chosen], gaps[:sewn] >= CLOSED_M)
            if pulled is not state.positions:
                state.positions[:] = pulled
                dynamics.contact.start(state)  # it measures ways, and this was none
        if state.time_s - since >= CLOSING_PASS_S:
            dynamics.contact.let_pass(state, _ends(cloth, chosen[gaps[:sewn] >= CLOSED_M]))
        dynamics.constraint.least_speed = np.where(late, SPEED_CAP_M_S, least_closing_speed(state.time_s - since))
        advance_or_retreat(dynamics, state)
    if state.time_s - since >= CLOSING_PASS_S:
        dynamics.contact.let_pass(state, _ends(cloth, chosen[:0]))
    gap_mm, widest_at = _widest(cloth, cloth.stitch_seam[chosen], gaps[:sewn])
    redundant = tuple(name for name in dynamics.constraint.redundant if name in gap_mm)
    return Welding(gap_mm, float(speeds[:sewn].max(initial=0.0)), redundant, widest_at)


def _ends(cloth: Cloth, stitches: np.ndarray) -> np.ndarray:
    """(P,) bool: the particles of some stitches."""
    ends = np.zeros(cloth.particle_count, dtype=bool)
    ends[cloth.stitches[stitches]] = True
    return ends


def _widest(cloth: Cloth, seams: np.ndarray, gaps: np.ndarray) -> tuple[dict[str, float], dict[str, float]]:
    """Of each of the seams (N,) the widest of the gaps (N,) m of its stitches, which lie in their order, mm; and which part of them lies before that one."""
    gap_mm, widest_at = {}, {}
    for seam in dict.fromkeys(seams.tolist()):
        name, own = cloth.seam_names[seam], gaps[seams == seam]
        gap_mm[name], widest_at[name] = M_TO_MM * float(own.max()), float(own.argmax()) / max(1, len(own) - 1)
    return gap_mm, widest_at


def hold(dynamics: Dynamics, state: State, hardware: PointRows) -> None:
    """Rows that hold welded cloth."""
    _make_room(state, hardware)
    if len(hardware.targets):
        dynamics.constraint = ConstraintPoints(hardware, dynamics.inverse_masses, HOLDING_RATE, nodes=dynamics.contact.nodes)


def _make_room(state: State, rows: PointRows) -> None:
    if len(state.constraint_speeds) != len(rows.targets):
        state.constraint_speeds, state.constraint_forces = np.zeros_like(rows.targets), np.zeros_like(rows.targets)


def least_closing_speed(time_s: float) -> float:
    """Floor of the closing speed, m/s, after `time_s` of sewing."""
    return float(min(CLOSING_LEAST_M_S * 2.0 ** max(0.0, (time_s - CLOSING_LATE_S) / CLOSING_DOUBLES_S), SPEED_CAP_M_S))


def closing_leniency(time_s: float) -> float:
    """How many times wider than at the beginning a gap may be, after `time_s` of sewing, to count as closed."""
    return float(min(2.0 ** max(0.0, (time_s - CLOSED_LATE_S) / CLOSED_DOUBLES_S), 1e-3 * WIDEST_WELD_MM / CLOSED_M))


def weld_state(cloth: Cloth, welded: Cloth, particle_map: np.ndarray, state: State) -> State:
    """State of `welded`: mass-weighted mean positions and velocities of the particles that became one (momentum is kept). Sliders stay with their elements; the
    hinges that welding made begin unfolded."""
    positions, velocities = np.zeros((welded.particle_count, 3)), np.zeros((welded.particle_count, 3))
    for axis in range(3):
        positions[:, axis] = np.bincount(particle_map, cloth.masses * state.positions[:, axis], welded.particle_count) / welded.masses
        velocities[:, axis] = np.bincount(particle_map, cloth.masses * state.velocities[:, axis], welded.particle_count) / welded.masses
    hinges = np.zeros(len(welded.hinges.factor))
    old = state.friction.get("hinge", hinges[:0])
    hinges[: len(old)] = old
    friction = state.friction | {"hinge": hinges}
    welded_state = State(positions, velocities, state.time_s, state.step, state.time_step_s, friction=friction, fold_angles=state.fold_angles)
    held = slice(len(cloth.stitches), None)  # what is not sewn is held on
    welded_state.constraint_speeds, welded_state.constraint_forces = state.constraint_speeds[held].copy(), state.constraint_forces[held].copy()
    welded_state.run, welded_state.work_j, welded_state.said = dict(state.run), dict(state.work_j), state.said
    return welded_state
