"""Whether a run can go on from a State that was read from a file. Compiled kernels trust its arrays: an index out of range would end the process."""

from __future__ import annotations

import math

import numpy as np

from garmentcad.cloth.cloth import Cloth
from garmentcad.cloth.state import State
from garmentcad.contact.pairs import EDGE_EDGE, Pairs, make_pairs
from garmentcad.contact.planes import fresh_planes
from garmentcad.errors import CheckpointError
from garmentcad.simulation.sewing import SEWING, SEWINGS
from garmentcad.solve.dynamics import Dynamics

# Phases from which a run goes on, and the entries of State.run that each of them reads.
PHASES = {
    "close": (),
    "press": ("phase_from_s",),
    "fall": ("phase_from_s",),
    "settle": ("phase_from_s",),
    "watch": ("phase_from_s", "watch_from_s"),
    "rest": (),
}
_TOGETHER = (("sewing_order", "sewing_from_s"), ("eta_above", "eta_from_s"))


def refuse_course(state: State, levels: int) -> None:
    """CheckpointError where time, phase or bookkeeping is none of a run over so many lattices."""
    if state.phase not in PHASES:
        raise _unfit(f"phase '{state.phase[:40]}'; allowed are {', '.join(PHASES)}")
    wanted = PHASES[state.phase] + tuple(late for early, late in _TOGETHER if early in state.run)
    if missing := [name for name in wanted if name not in state.run]:
        raise _unfit(f"in the phase {state.phase} {', '.join(missing)} is missing")
    numbers = {"time_s": state.time_s, "time_step_s": state.time_step_s, **state.run, **state.work_j}
    if wild := [name for name, number in numbers.items() if not math.isfinite(number)]:
        raise _unfit(f"{', '.join(wild)} is not finite")
    if state.time_s < 0.0 or state.time_step_s <= 0.0:
        raise _unfit(f"a step of {state.time_step_s:g} s at {state.time_s:g} s")
    if state.run.get("level", 0.0) not in range(levels):
        raise _unfit(f"level {state.run['level']:g}; 0 to {levels - 1} is allowed")
    if state.run.get(SEWING, 0.0) not in range(SEWINGS):
        raise _unfit(f"{SEWING} {state.run[SEWING]:g}; 0 to {SEWINGS - 1} is allowed")
    if not 0.0 < state.run.get("step_factor", 1.0) <= 1.0:
        raise _unfit(f"step_factor {state.run['step_factor']:g}; more than 0 and at most 1 is allowed")
    if set(state.work_j) != set(State(state.positions, state.velocities).work_j):
        raise _unfit(f"work_j holds {', '.join(state.work_j) or 'nothing'}")


def refuse_shape(state: State, cloth: Cloth, folds: int) -> None:
    """CheckpointError where the motion is not that of `cloth` with so many fold lines, or not finite."""
    points = (cloth.particle_count, 3)
    for name, shape in (("positions", points), ("velocities", points), ("fold_angles", (folds,)), ("constraint_forces", state.constraint_speeds.shape)):
        array = getattr(state, name)
        if array.shape != shape:
            raise _unfit(f"{name} came as {array.shape}; {shape} is wanted")
    for name in ("positions", "velocities", "fold_angles", "constraint_speeds", "constraint_forces"):
        if not np.isfinite(getattr(state, name)).all():
            raise _unfit(f"{name} are not finite")


def refuse_memory(state: State, dynamics: Dynamics) -> None:
    """CheckpointError where internal friction, detection clock or candidates are not as `dynamics` keeps them. The motion must have been accepted."""
    for name, slack in dynamics.forces.slack().items():
        _refuse_unlike(f"friction.{name}", state.friction.get(name), slack)
        if not np.isfinite(state.friction[name]).all():
            raise _unfit(f"friction.{name} is not finite")
    kept, contact = state.contact, dynamics.contact
    if not kept:
        return  # it starts anew
    count, candidates = len(state.positions), len(kept.get("pair_nodes", ()))
    none = np.zeros((0, 4), np.int32)
    pairs = Pairs(*(np.empty((candidates, *array.shape[1:]), array.dtype) for array in make_pairs(none, none, np.zeros(1), np.zeros(1))))
    wanted = {f"planes_{name}": array for name, array in fresh_planes(state.positions, False)._asdict().items()}
    wanted |= {f"pair_{name}": array for name, array in pairs._asdict().items()}
    wanted |= {"pair_home": state.positions, "pair_covered": np.zeros(1), "pair_path": np.zeros(1), "body_pace": np.zeros(4)}
    wanted |= {"stiff_home": state.positions, "stiff_key": np.zeros(6), "stiff_wait": np.zeros(2), "stiff_touching": np.zeros(count, bool)}
    wanted |= {"light_home": state.positions, "stiff_held": state.positions, "stiff_weight": np.ones(count), "cuts_in_row": np.zeros(1)}
    for name, like in wanted.items():
        _refuse_unlike(f"contact.{name}", kept.get(name), like)
    if "settle_drag" in kept:
        _refuse_unlike("contact.settle_drag", kept["settle_drag"], np.zeros(count))
    if foreign := set(kept) - {*wanted, "settle_drag"}:
        raise _unfit(f"contact.{min(foreign)} is none of this version")
    for name, array in kept.items():
        if array.dtype == np.float64 and np.isnan(array).any():
            raise _unfit(f"contact.{name} is not a number everywhere")
    spans = {"pair_nodes": (0, contact.nodes - 1), "pair_kind": (0, EDGE_EDGE), "pair_outside": (-1, contact.outsides - 1), "planes_held": (0, 2)}
    for name, (low, high) in spans.items():
        if kept[name].min(initial=low) < low or kept[name].max(initial=low) > high:
            raise _unfit(f"contact.{name} holds {kept[name].min()} to {kept[name].max()}; {low} to {high} is allowed")


def _refuse_unlike(name: str, came: np.ndarray | None, like: np.ndarray) -> None:
    if came is None or (came.dtype, came.shape) != (like.dtype, like.shape) or not came.flags.c_contiguous:
        what = "is missing" if came is None else f"came as {came.dtype} {came.shape}"
        raise _unfit(f"{name} {what}; {like.dtype} {like.shape} is wanted")


def _unfit(what: str) -> CheckpointError:
    return CheckpointError(f"the checkpoint does not fit this run: {what}")
