"""One run: lay out, place, sew, weld, drape; with checkpoints from which it goes on in the same bits."""

from __future__ import annotations

import signal
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from types import FrameType

import numpy as np
from shapely.geometry import Polygon

from garmentcad.cloth.cloth import Cloth
from garmentcad.cloth.lattice import build_cloth
from garmentcad.cloth.state import State
from garmentcad.cloth.weld import weld
from garmentcad.contact.body import ContactBody
from garmentcad.contact.cloth import ContactCloth
from garmentcad.contact.contact import Contact
from garmentcad.errors import GarmentError, LimitError
from garmentcad.fabric.material import MaterialTable
from garmentcad.forces.assembly import ForceAssembly
from garmentcad.forces.drag import ForceDrag
from garmentcad.forces.force import BodyForce
from garmentcad.forces.gravity import ForceGravity
from garmentcad.forces.internal import internal_forces
from garmentcad.placement.place import place_vertices
from garmentcad.simulation.checkpoint import load_state, save_state
from garmentcad.simulation.course import CLOSING_DRAG, SOFTNESS, Course, Progress
from garmentcad.simulation.job import Job
from garmentcad.simulation.materials import lay_out
from garmentcad.simulation.sewing import Welding, close_seams, weld_state
from garmentcad.simulation.start import refuse_tangled
from garmentcad.solve.dynamics import DivergedError, Dynamics
from garmentcad.solve.strain_limit import StrainLimit

JITTER_M = 1e-5  # of the start, so that no fold is decided by round-off
MAX_PARTICLES = 1_000_000
CHECKPOINT_EVERY_S = 20.0


class Interrupted(GarmentError):
    """The user stopped the run; the checkpoint named in the message continues it."""


@dataclass
class Outcome:
    """A finished run. status: converged, max_time or diverged (contact is judged afterwards). wall_s: setup, drape; seconds: by kind of work."""

    job: Job
    cloth: Cloth
    materials: MaterialTable
    dynamics: Dynamics
    state: State
    status: str
    welding: Welding
    wall_s: dict[str, float]
    seconds: dict[str, float]
    warnings: list[str] = field(default_factory=list)


def check_size(job: Job) -> None:
    """LimitError where the lattice would be larger than the cap; the areas decide, before anything is allocated."""
    area_mm2 = sum(Polygon(np.vstack([edge.curve.polyline(1.0)[:-1] for edge in panel.edges])).area for panel in job.pattern.panels.values())
    count = int(area_mm2 / job.grid_mm**2)
    if count > MAX_PARTICLES:
        message = f"{area_mm2 * 1e-6:.2f} m2 at a grid of {job.grid_mm:g} mm are about {count} particles; at most {MAX_PARTICLES} are allowed"
        raise LimitError(message, key="--grid")


def run(job: Job, look: Callable[[Progress], None], checkpoint: Path | None = None, resume: bool = False) -> Outcome:
    """Drape. `look` is told of the progress about every 200 steps. checkpoint: file kept up to date; resume: go on from it.

    InputError for a job that cannot start, Interrupted (after saving) on Ctrl-C.
    """
    began = time.perf_counter()
    check_size(job)
    materials, material_of = lay_out(job)
    flat = build_cloth(job.pattern, material_of, materials, job.grid_mm)
    welded, particle_map = weld(flat)
    state = load_state(checkpoint, job.identity) if resume and checkpoint is not None else None
    seconds: dict[str, float] = {}
    with _stop_signal() as stopped:
        keep = _Keeper(job, checkpoint, look, stopped)
        if state is None or state.phase == "close":
            dynamics, *_ = _dynamics(job, flat, materials, sewing=True)
            if state is None:
                state = _placed_state(job, flat)
                dynamics.start(state)
            setup = time.perf_counter() - began
            keep.state = state
            try:
                welding = close_seams(dynamics, state, keep)
            except DivergedError as error:
                return Outcome(job, flat, materials, dynamics, state, "diverged", Welding(), {"setup": setup, "drape": time.perf_counter() - began - setup},
                               dynamics.seconds, [str(error)])  # fmt: skip
            seconds = dynamics.seconds
            state = weld_state(flat, welded, particle_map, state)
            state.phase = "fall"
            state.run |= {"phase_from_s": state.time_s} | welding.as_run()
            dynamics, drag, forces_at = _dynamics(job, welded, materials, sewing=False)
            dynamics.start(state)
        else:
            setup = time.perf_counter() - began
            dynamics, drag, forces_at = _dynamics(job, welded, materials, sewing=False)
        keep.state = state
        course = Course(dynamics, drag, forces_at, job.mode, job.max_time_s)
        warnings: list[str] = []
        try:
            status = course.run(state, keep)
        except DivergedError as error:
            status, warnings = "diverged", [str(error)]
    welding = Welding.of_run(state.run)
    if welding.open_seams:
        warnings += welding.open_seams
        status = "max_time" if status == "converged" else status
    factor = state.run.get("step_factor", 1.0)
    if factor < 1.0:
        warnings.append(f"motion ran away at the time step that the stiffness allows; the run went back and on with {factor:g} of it")
    seconds = {kind: seconds.get(kind, 0.0) + spent for kind, spent in dynamics.seconds.items()}
    wall = {"setup": setup, "drape": time.perf_counter() - began - setup}
    return Outcome(job, welded, materials, dynamics, state, status, welding, wall, seconds, warnings)


def _dynamics(job: Job, cloth: Cloth, materials: MaterialTable, sewing: bool) -> tuple[Dynamics, ForceDrag, Callable[[float], ForceAssembly]]:
    """The stepper, its drag, and its forces at a softness. While sewing there is neither weight nor friction: seams slide to where they close."""
    drag = ForceDrag(cloth.masses, CLOSING_DRAG)
    body_forces: list[BodyForce] = [drag] if sewing else [ForceGravity(cloth.masses), drag]

    def forces_at(softness: float) -> ForceAssembly:
        softer = materials._replace(tension_force=materials.tension_force / softness, tension_slope=materials.tension_slope / softness)
        return ForceAssembly(internal_forces(cloth, softer), cloth.particle_count, body_forces)

    touch = materials
    if sewing:
        touch = materials._replace(friction_body=0.0 * materials.friction_body, friction_cloth=0.0 * materials.friction_cloth)
    contacts: list[Contact] = [ContactCloth(cloth, touch), ContactBody(job.mannequin.vertices, job.mannequin.faces, cloth, touch)]
    forces = forces_at(SOFTNESS if sewing and job.mode == "drape" else 1.0)
    return Dynamics(cloth, forces, StrainLimit(cloth, materials), contacts), drag, forces_at


def _placed_state(job: Job, cloth: Cloth) -> State:
    positions = place_vertices(job.pattern, cloth, job.mannequin)
    refuse_tangled(cloth, positions, job.mannequin)
    positions = positions + JITTER_M * np.random.default_rng(job.seed).standard_normal(positions.shape)
    return State(positions, np.zeros_like(positions), phase="close")


class _Keeper:
    """Passes progress on, keeps the checkpoint fresh, and stops the run where the user asked for it: between two looks, where the State is whole."""

    def __init__(self, job: Job, path: Path | None, look: Callable[[Progress], None], stopped: list[int]) -> None:
        self._job, self._path, self._look, self._stopped = job, path, look, stopped
        self._saved = time.perf_counter()
        self.state: State | None = None

    def __call__(self, progress: Progress) -> None:
        self._look(progress)
        due = time.perf_counter() - self._saved > CHECKPOINT_EVERY_S
        if self._path is not None and self.state is not None and (due or self._stopped):
            save_state(self._path, self.state, self._job.identity)
            self._saved = time.perf_counter()
        if self._stopped:
            raise Interrupted(f"stopped at step {progress.step}" + (f"; --resume goes on from {self._path}" if self._path is not None else ""))


@contextmanager
def _stop_signal() -> Iterator[list[int]]:
    """Ctrl-C sets a flag instead of tearing a step apart; a second one stops at once. Outside the main thread signals are left alone."""
    stopped: list[int] = []

    def note(number: int, frame: FrameType | None) -> None:
        if stopped:
            raise KeyboardInterrupt
        stopped.append(number)

    try:
        before = signal.signal(signal.SIGINT, note)
    except ValueError:
        yield stopped
        return
    try:
        yield stopped
    finally:
        signal.signal(signal.SIGINT, before)
