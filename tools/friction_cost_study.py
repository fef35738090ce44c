"""What internal friction costs: wall time of a simulated second of `dynamics` with the friction of the sheet and without (2HG = 2HG5 = 2HB = 0, RT = 100).

`python -m tools.friction_cost_study` drapes each garment to rest, pushes it sideways, and lets it swing from there with either cloth in turn; it writes
docs/studies/friction-cost.md. Medians over the turns; one process, one thread is best.
"""

from __future__ import annotations

import copy
import os
import statistics
import time
from typing import NamedTuple

import numba

from garmentcad.arrays import floats
from garmentcad.cloth.state import State
from garmentcad.fabric.material import MaterialTable, without_friction
from garmentcad.io.atomic import write_atomic
from garmentcad.simulation.job import make_job
from garmentcad.simulation.run import Outcome, run
from garmentcad.simulation.stepper import make_dynamics
from tools.study import FOLDER

GARMENTS = (("t-shirt", "wool-suiting"), ("t-shirt", "interlock-knit"), ("flared-skirt", "cotton-shirting"), ("straight-skirt", "denim"))
GRID_MM = 20.0
PUSH_M_S = floats([0.3, 0.0, 0.0])
SWING_S, BLOCK = 0.1, 48  # simulated seconds of a turn; steps at a time
TURNS = 7
MOST = 25.0  # percent
COMMAND = "python -m tools.friction_cost_study"


class Turn(NamedTuple):
    """us a step, time step [us], wall seconds of a simulated one."""

    step_us: float
    time_step_us: float
    wall_s: float


def turn(outcome: Outcome, materials: MaterialTable) -> Turn:
    """One swing of the cloth of these `materials` from the pushed state."""
    dynamics, _ = make_dynamics(outcome.job, outcome.cloth, materials, outcome.state.fold_angles)
    dynamics.measured = True  # as in a movement
    state: State = copy.deepcopy(outcome.state)
    state.velocities[:] = PUSH_M_S
    state.contact, state.phase = {}, "dynamics"
    if not materials.bending_friction.any():
        state.friction = dynamics.forces.slack()
    dynamics.start(state)
    dynamics.advance(state, BLOCK)
    from_step, from_s, began = state.step, state.time_s, time.perf_counter()
    while state.time_s < from_s + SWING_S:
        dynamics.advance(state, BLOCK)
    wall, steps, simulated = time.perf_counter() - began, state.step - from_step, state.time_s - from_s
    return Turn(1e6 * wall / steps, 1e6 * simulated / steps, wall / simulated)


def measured(garment: str, fabric: str) -> tuple[int, Turn, Turn]:
    """Particles; medians with friction and without."""
    outcome = run(make_job(garment, fabric, grid_mm=GRID_MM), lambda progress: None)
    cloths = (outcome.materials, without_friction(outcome.materials))
    turns = [[turn(outcome, materials) for materials in cloths] for _ in range(TURNS + 1)][1:]  # the first warms up
    held, free = (Turn(*(statistics.median(column) for column in zip(*(pair[k] for pair in turns), strict=True))) for k in range(2))
    return outcome.cloth.particle_count, held, free


def main() -> None:
    """Run the study and write its page."""
    head = "| garment, fabric | particles | us a step, friction and none | time step us, friction and none | wall s a simulated s, friction and none | more % |"
    table, more = [head, "|---|---|---|---|---|---|"], []
    load = os.getloadavg()[0]
    for garment, fabric in GARMENTS:
        count, held, free = measured(garment, fabric)
        more.append(100.0 * (held.wall_s / free.wall_s - 1.0))
        pairs = (f"{a:.{places}f}, {b:.{places}f}" for a, b, places in zip(held, free, (0, 1, 1), strict=True))
        table.append(f"| {garment}, {fabric} | {count} | {' | '.join(pairs)} | {more[-1]:+.0f} |")
        print(table[-1], flush=True)
    said = (
        f"`{COMMAND}`: garments at rest on {GRID_MM:g} mm, pushed sideways by {PUSH_M_S[0]:g} m/s, {SWING_S:g} s of true motion with the friction of the sheet "
        f"and without in turn, medians of {TURNS} turns, {numba.get_num_threads()} thread(s), load {load:.1f} before. At most {MOST:g} % more is wanted."
    )
    why = (
        "The kernels are the same: they carry sliders with or without friction. What friction costs is the time step, since cloth that sticks is stiffer, "
        "shear above all. Short steps are cheaper, because cloth moves less in each and contact is detected less often."
    )
    write_atomic(FOLDER / "friction-cost.md", "\n".join(["# What internal friction costs", "", said, "", *table, "", why, ""]))


if __name__ == "__main__":
    main()
