"""One run: lay out, place, sew, weld, press, drape; with checkpoints from which it goes on in the same bits."""

from __future__ import annotations

import time
from collections.abc import Callable, Collection
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path

import numpy as np

from garmentcad.analysis.clearance import clearing_moves, move_panels
from garmentcad.analysis.tension import panels_at_limit, panels_pulled
from garmentcad.cloth.cloth import Cloth
from garmentcad.cloth.gathers import EASED
from garmentcad.cloth.lattice import build_cloth
from garmentcad.cloth.state import State
from garmentcad.cloth.weld import weld, weld_seams
from garmentcad.constraints.points import PointRows
from garmentcad.errors import CheckpointError, GarmentError
from garmentcad.fabric.material import MaterialTable, without_friction
from garmentcad.forces.assembly import ForceAssembly
from garmentcad.geometry.intersection import crossing_triangle_pairs, crossing_triangle_pairs_between
from garmentcad.mannequin.mannequin import Mannequin
from garmentcad.pattern.outfit import below
from garmentcad.placement.outside import around_worn
from garmentcad.placement.place import place_vertices
from garmentcad.simulation.checkpoint import load_state
from garmentcad.simulation.course import CLOSING_OVER_N_M, CLOSING_PULL_N_M, STANDS, STRETCHED, TIGHT_N_M, TIGHT_SHARE, Course, Progress
from garmentcad.simulation.job import Job
from garmentcad.simulation.keeper import Keeper, stop_signal
from garmentcad.simulation.lattices import check_size, grids_of, is_small
from garmentcad.simulation.materials import lay_out
from garmentcad.simulation.mend import PRICKED, TOUCHING_M, off_body, parted, turned_out
from garmentcad.simulation.pressing import imposed_angles, laid_angles, press, under_iron
from garmentcad.simulation.refine import refined, refined_sliders
from garmentcad.simulation.resume import refuse_course, refuse_memory, refuse_shape
from garmentcad.simulation.sewing import (
    SEWING,
    SEWINGS,
    UNWELDABLE,
    WIDEST_WELD_MM,
    Welding,
    as_they_stand,
    close_seams,
    held_from_the_start,
    hold,
    weld_state,
)
from garmentcad.simulation.start import freed, refuse_tangled
from garmentcad.simulation.stepper import make_dynamics
from garmentcad.solve.dynamics import DivergedError, Dynamics, IntersectingError
from garmentcad.solve.hardware import hardware_rows, pin_rows, redundance_message, redundances
from garmentcad.units import M_TO_MM, MM_TO_M

JITTER_M = 1e-5  # of the start, so that no fold is decided by round-off
# Panels come a long way to their seams, and small folds that form on it are caught between seams that close around them. While they are sewn they bend
# like card; the bending that counts is there from the weld on. A T-shirt of GarmentCode closes to 0.14 mm so, and not within 10 mm without; the crotch seam of
# trousers to 0.05 mm, and not within 25.
CARD_BENDING = 30.0
UNREFINED = "unrefined"  # in State.run: the garment was sewn on the lattice of the job


@dataclass
class Outcome:
    """A finished run. status: converged, max_time, diverged or intersecting (contact is judged afterwards, too). flat: the cloth before welding.

    wall_s: setup, drape; seconds: by kind of work.
    """

    job: Job
    flat: Cloth
    cloth: Cloth
    materials: MaterialTable
    dynamics: Dynamics
    state: State
    status: str
    welding: Welding
    wall_s: dict[str, float]
    seconds: dict[str, float]
    warnings: list[str] = field(default_factory=list)


def run(
    job: Job,
    look: Callable[[Progress], None],
    checkpoint: Path | None = None,
    resume: bool = False,
    begin: Callable[[], None] = lambda: None,
    reserve: Callable[[], None] = lambda: None,
) -> Outcome:
    """Drape. `look` is told of the progress about every 200 steps. checkpoint: file kept up to date; resume: go on from it; begin: called once, when job,
    start and checkpoint are accepted, before anything but the checkpoint is written; reserve: called before anything at all is, more than once and sooner in
    an outfit, whose outermost garment can only be placed when what is worn below has been draped.

    InputError for a job that cannot start, Interrupted (after saving) on Ctrl-C.
    """
    with stop_signal() as stopped:
        return _drape(Keeper(job, checkpoint, look, stopped, begin, reserve), resume)


def _drape(keep: Keeper, resume: bool) -> Outcome:
    """Drape the job of `keep`; resume: go on from its checkpoint, which may be one of what is worn below."""
    job, grids, state = keep.job, grids_of(keep.job), None
    if resume and keep.path is not None:
        grids, state = _saved(job, keep.path)
    made = _Run(job, keep, state, resume and state is None)
    try:
        if state is not None:
            refuse_course(state, len(grids))
        return made.drape(grids)
    except CheckpointError as error:
        raise CheckpointError(error.message, file=str(keep.path)) from None
    except RefinementError as error:
        # Rare: folds lie so close that finer triangles cross, or cannot part. The full lattice from the start costs more, and crosses nothing.
        anew = _Run(job, keep, None)
        anew.began, anew.setup, anew.seconds = made.began, made.setup, made.seconds
        anew.warnings.append(str(error))
        return anew.drape((job.grid_mm,))


def _saved(job: Job, path: Path) -> tuple[tuple[float, ...], State | None]:
    """The lattices of the run that `path` goes on with, and its State; None where that is one of what is worn below. CheckpointError for another run."""
    try:
        state = load_state(path, job.identity)
    except CheckpointError:
        ways = (grids_of(job), (job.grid_mm,)) if len(job.worn) > 1 else ()
        for grids in ways:
            with suppress(CheckpointError):
                _saved(_worn_below(job, grids[0]), path)
                return grids, None
        raise
    return (job.grid_mm,) if UNREFINED in state.run else grids_of(job), state


def _worn_below(job: Job, grid_mm: float) -> Job:
    """What is worn under the outermost garment of an outfit, draped by itself."""
    return replace(job, pattern=below(job.pattern), worn=job.worn[:-1], grid_mm=grid_mm, poses=())


class RefinementError(GarmentError):
    """A finer lattice on the coarse one's shape would cross itself or the mannequin, or sticks there."""


class UnsewnError(GarmentError):
    """What is worn below ended before its seams were closed: nothing can be put on over that."""

    def __init__(self, below: Outcome) -> None:
        super().__init__(f"what is worn below ended as {below.status} before its seams were closed; the outermost garment was only placed")
        self.below = below


class _Run:
    """The levels of one run, from the coarsest lattice, which is placed and sewn, to that of the job."""

    def __init__(self, job: Job, keep: Keeper, state: State | None, resume_below: bool = False) -> None:
        self.began = time.perf_counter()
        self.job, self.keep, self.state, self._resume_below = job, keep, state, resume_below
        self.materials, self._material_of = lay_out(job)
        check_size(job, self.materials)
        self.seconds: dict[str, float] = {}
        self.warnings = [] if state is None else list(state.said)
        self.setup = 0.0
        self._placed: np.ndarray | None = None
        self._worn_angles: dict[str, float] = {}  # by PANEL.FOLD, rad, of the folds of what is worn already
        self._untried = state is not None  # read from a file, and not yet found to fit

    def drape(self, grids: tuple[float, ...]) -> Outcome:
        """Sew on the first grid, then settle on each; the outcome is that of the last one."""
        level = 0 if self.state is None else int(self.state.run.get("level", 0.0))
        before: tuple[Cloth, ForceAssembly] | None = None
        while True:
            flat = build_cloth(self.job.pattern, self._material_of, self.materials, grids[level], particle_cap=self.job.max_particles)
            # What is worn under the outermost garment of an outfit has been sewn when that is put on.
            inner = below(self.job.pattern) if len(self.job.worn) > 1 else None
            start = flat if inner is None else weld_seams(flat, [seam.name for seam in inner.seams])[0]
            cloth, particle_map = weld(start)
            hardware = self._hardware(cloth)
            if self.state is not None and self._untried:
                refuse_shape(self.state, start if self.state.phase == "close" else cloth, len(flat.fold_names))
            if self.state is None or self.state.phase == "close":
                try:
                    failed = self._sew(flat, start, cloth, particle_map)
                except UnsewnError as error:
                    self.warnings.append(str(error))
                    failed = self._unsewn(flat, error.below)
                if failed is not None:
                    return failed
            assert self.state is not None
            if self.state.phase == "press":
                failed = self._press(flat, cloth, hardware)
                if failed is not None:
                    return failed
            dynamics, soften_all = make_dynamics(self.job, cloth, self.materials, self.state.fold_angles)
            if before is not None:
                self.state = _refined_state(before, self.state, dynamics, level, self.job.mannequin)
            hold(dynamics, self.state, pin_rows(hardware))
            self._begin(dynamics)
            last = level == len(grids) - 1
            loose = not self.job.pattern.seams
            buttoned, banded = bool(self.job.pattern.buttons), bool(self.job.pattern.bands)
            tight = partial(self._is_tight, cloth)
            small = loose and is_small(self.job)
            course = Course(dynamics, soften_all, self.job.mode, self.job.max_time_s, loose, last, buttoned, buttoned or banded, tight, small)
            try:
                status = course.run(self.state, self.keep)
            except (DivergedError, IntersectingError) as error:
                told = f"on the lattice of {grids[level]:g} mm: {error}"
                if level > 0 and isinstance(error, IntersectingError):
                    raise RefinementError(f"{told}; draped anew there") from None
                self.warnings.append(told)
                status, last = error.status, True
            if last:
                # What ended while tension was soft is judged as the cloth that it is.
                soften_all(1.0)
                dynamics.softness = 1.0
                return self._outcome(flat, cloth, dynamics, status)
            self._add_up(dynamics.seconds)
            before, level = (cloth, dynamics.forces), level + 1

    def _is_tight(self, cloth: Cloth, positions: np.ndarray) -> bool:
        # A neckband is tight wherever it lies: a knit top that slipped for its sake rode up by 17 mm, and lay in wrinkles around the waist.
        # What cloth is gathered onto is not stretched by it.
        pulled = [seam for seam in self.job.pattern.seams if STRETCHED < abs(seam.ease) <= EASED - 1.0]
        by_draft = {use.panel for seam in pulled for use in (seam.a if seam.ease < 0.0 else seam.b)}
        return not panels_pulled(cloth, positions, self.materials, TIGHT_N_M, TIGHT_SHARE).keys() <= by_draft

    def _hardware(self, cloth: Cloth) -> PointRows:
        return hardware_rows(self.job.pattern, cloth, self.materials, self.job.mannequin)

    def _begin(self, dynamics: Dynamics) -> None:
        """Start a phase, or go on in it."""
        assert self.state is not None
        if self._untried:
            refuse_memory(self.state, dynamics)
            self._untried = False
        if not self.state.contact:
            dynamics.start(self.state)
        if not self.setup:
            self.setup = time.perf_counter() - self.began
            self.keep.begin()
        self.keep.state = self.state

    def _add_up(self, seconds: dict[str, float]) -> None:
        self.seconds = {kind: self.seconds.get(kind, 0.0) + spent for kind, spent in seconds.items()}

    def _sew(self, flat: Cloth, start: Cloth, welded: Cloth, particle_map: np.ndarray) -> Outcome | None:
        """Close and weld the seams that are open at the start; an outcome only where that failed."""
        if self.state is None:
            self.state = self._placed_state(flat, start, 0)
        worn = below(self.job.pattern).panels if len(self.job.worn) > 1 else {}
        angles = np.where(_folds_of(flat, worn), self.state.fold_angles, laid_angles(self.job))
        dynamics, _ = make_dynamics(self.job, start, self._for_sewing(), angles, dressing=True)
        self._begin(dynamics)
        sewing = int(self.state.run.get(SEWING, 0.0)) + 1
        pull = CLOSING_OVER_N_M if len(self.job.worn) > 1 else CLOSING_PULL_N_M
        unweldable = UNWELDABLE * M_TO_MM * start.spacing
        failed: DivergedError | IntersectingError | None = None
        welding = Welding()
        try:
            hardware = held_from_the_start(self._hardware(start), start, worn)
            give_up = WIDEST_WELD_MM if sewing < SEWINGS else unweldable
            welding = close_seams(dynamics, self.state, hardware, self.keep, pull, self.job.max_time_s, give_up)
        except (DivergedError, IntersectingError) as error:
            failed = error
        self._add_up(dynamics.seconds)
        out_of_time = self.state.time_s >= self.job.max_time_s
        if (failed is not None or welding.open_seams) and sewing < SEWINGS and not out_of_time:
            self.state = self._placed_state(flat, start, sewing)
            return self._sew(flat, start, welded, particle_map)
        if failed is not None:
            self.warnings.append(str(failed))
            if np.isfinite(self.state.positions).all():
                self.state.run |= as_they_stand(start, self.state.positions).as_run()
            return self._broken_off(flat, start, failed.status)
        if welding.open_seams and (out_of_time or welding.widest_mm > unweldable):
            self.state.run |= welding.as_run()
            if not out_of_time:
                why = "something lies between their panels, or a panel is laid the wrong way around"
                self.warnings.append(f"seams that stand open by more than {unweldable:g} mm are not welded, and the run ended there: {why}")
            return self._broken_off(flat, start, "max_time")
        self.state = weld_state(start, welded, particle_map, self.state)
        del dynamics  # what follows needs much memory for a while
        # Corners that passed through each other to close may lie through each other; what closes a gap of up to a millimetre at once can be pricked on the
        # way. Both would hang there.
        body = self.job.mannequin
        turned = turned_out(self.state.positions, welded.particle_triangles)
        self.state.positions = off_body(turned, welded.particle_triangles, body.vertices, body.faces, welded.spacing, PRICKED * welded.spacing)
        self.state.phase = "fall" if _folds_of(flat, worn).all() else "press"  # what is worn has been pressed
        self.state.run |= {"phase_from_s": self.state.time_s} | welding.as_run()
        self.keep.state = None  # until the next phase begins: the state before need not take memory while the next stepper is made
        return None

    def _placed_state(self, flat: Cloth, start: Cloth, sewing: int) -> State:
        """The panels of `flat` where they begin, for `start`, the same cloth with what is worn already sewn."""
        if self._placed is None:
            worn = self._worn(flat)
            self._placed = _placed(self.job, flat, start, worn, self.warnings)
            refuse_tangled(start, self._placed, self.job.mannequin, worn)
            self._placed = freed(start, self._placed, self.job.mannequin)
            self.warnings = list(dict.fromkeys(self.warnings))  # a resumed run that places anew has said the same before
        jitter = np.random.default_rng([self.job.seed, sewing]).standard_normal(self._placed.shape)
        positions = self._placed + JITTER_M * jitter
        angles = np.array([self._worn_angles.get(name, 0.0) for name in flat.fold_names])
        state = State(positions, np.zeros_like(positions), phase="close", fold_angles=angles, said=tuple(self.warnings))
        if sewing > 0:
            state.run[SEWING] = float(sewing)
        if flat.spacing == MM_TO_M * self.job.grid_mm:
            state.run[UNREFINED] = 1.0
        return state

    def _worn(self, flat: Cloth) -> dict[str, np.ndarray]:
        """Where what is worn under the outermost garment of an outfit hangs: panel -> (V,3) m of its vertices. It is draped first, on this lattice.
        UnsewnError where that ends before it is sewn: where a seam is open, one place would stand for two."""
        if len(self.job.worn) < 2:
            return {}
        outcome = _drape(self.keep.below(_worn_below(self.job, M_TO_MM * flat.spacing)), self._resume_below)
        self.warnings += outcome.warnings
        self._add_up(outcome.seconds)
        if outcome.state.phase == "close":
            raise UnsewnError(outcome)
        if outcome.status != "converged":
            self.warnings.append(f"what is worn below ended as {outcome.status} before the outermost garment was put on")
        finite = np.isfinite(outcome.state.positions).all()
        crossing = len(crossing_triangle_pairs(outcome.state.positions, outcome.cloth.particle_triangles)) if finite else 0
        if crossing:
            self.warnings.append(f"what is worn below crossed itself in {crossing} pairs of triangles when the outermost garment was put on")
        self._worn_angles = dict(zip(outcome.flat.fold_names, outcome.state.fold_angles.tolist(), strict=True))
        return _hung(outcome)

    def _unsewn(self, flat: Cloth, below: Outcome) -> Outcome:
        """The outcome of an outfit of which what is worn below was not sewn: that as it ended, and the outermost garment where it would begin."""
        positions = _placed(self.job, flat, flat, _hung(below), self.warnings)
        angles = np.zeros(len(flat.fold_names))
        self.state = State(positions, np.zeros_like(positions), below.state.time_s, below.state.step, phase="close", fold_angles=angles)
        dynamics, _ = make_dynamics(self.job, flat, self.materials, angles)
        hold(dynamics, self.state, pin_rows(self._hardware(flat)))
        self._begin(dynamics)
        return self._outcome(flat, flat, dynamics, below.status)

    def _for_sewing(self) -> MaterialTable:
        """The materials while seams close: like card, but where something is worn already, whose folds would spring open."""
        if len(self.job.worn) > 1:
            return self.materials
        return self.materials._replace(bending=CARD_BENDING * self.materials.bending, twist=CARD_BENDING * self.materials.twist)

    def _press(self, flat: Cloth, cloth: Cloth, hardware: PointRows) -> Outcome | None:
        """Lay the folds and set them; an outcome only where that failed."""
        assert self.state is not None
        iron = under_iron(cloth)
        dynamics, _ = make_dynamics(self.job, iron, without_friction(self.materials), imposed_angles(self.job), dressing=True)
        hold(dynamics, self.state, hardware)
        self._begin(dynamics)
        try:
            press(dynamics, self.state, self.job, self.keep)
        except (DivergedError, IntersectingError) as error:
            self.warnings.append(f"while it was pressed: {error}")
            return self._broken_off(flat, cloth, error.status)
        finally:
            self._add_up(dynamics.seconds)
        # Contact starts anew: what it remembers belongs to other masses and another stiffness.
        self.state.contact, self.state.phase = {}, "fall"
        self.state.run |= {"phase_from_s": self.state.time_s}
        return None

    def _broken_off(self, flat: Cloth, cloth: Cloth, status: str) -> Outcome:
        """The outcome of a run that ended while it was sewn or pressed: judged as the cloth that it is, by no law of sewing or of the iron."""
        assert self.state is not None
        dynamics, _ = make_dynamics(self.job, cloth, self.materials, self.state.fold_angles)
        hold(dynamics, self.state, pin_rows(self._hardware(cloth)))
        if np.isfinite(self.state.positions).all():
            self.state.contact = {}
            dynamics.start(self.state)
        return self._outcome(flat, cloth, dynamics, status)

    def _outcome(self, flat: Cloth, cloth: Cloth, dynamics: Dynamics, status: str) -> Outcome:
        assert self.state is not None
        self._add_up(dynamics.seconds)
        welding = Welding.of_run(self.state.run)
        if welding.open_seams:
            self.warnings += welding.open_seams
            status = "max_time" if status == "converged" else status
        self.warnings += [redundance_message(found) for found in redundances(self._hardware(cloth), cloth, self.job.mannequin)]
        for name, share in panels_at_limit(cloth, self.state.positions, self.materials).items():
            self.warnings.append(f"panel '{name}' is too tight: {100.0 * share:.0f} % of its warp and weft is stretched to the limit of the fabric (1.5 Fm)")
        if SEWING in self.state.run:
            self.warnings.append("seams did not close the first time: the panels were placed once more, a hundredth of a millimetre aside")
        if STANDS in self.state.run:
            self.warnings.append("the garment stands still out of balance: forces are left that nothing answers, as where links are at the limit of the fabric")
        factor = self.state.run.get("step_factor", 1.0)
        if factor < 1.0:
            self.warnings.append(f"motion ran away at the time step that the stiffness allows; the run went back and on with {factor:g} of it")
        wall = {"setup": self.setup, "drape": time.perf_counter() - self.began - self.setup}
        return Outcome(self.job, flat, cloth, self.materials, dynamics, self.state, status, welding, wall, self.seconds, self.warnings)


def _refined_state(before: tuple[Cloth, ForceAssembly], state: State, dynamics: Dynamics, level: int, mannequin: Mannequin) -> State:
    """The garment of a coarse lattice, of this cloth and these forces before, on that of `dynamics`, in the same motion and under the same internal friction.
    RefinementError where it would cross or touch itself, or cross the mannequin."""
    coarse, fine = before[0], dynamics.cloth
    both = refined(coarse, np.hstack([state.positions, state.velocities]), fine)
    positions, velocities = np.ascontiguousarray(both[:, :3]), np.ascontiguousarray(both[:, 3:])
    positions = turned_out(positions, fine.particle_triangles)
    positions = off_body(positions, fine.particle_triangles, mannequin.vertices, mannequin.faces, fine.spacing, PRICKED * fine.spacing)
    crossings = len(crossing_triangle_pairs(positions, fine.particle_triangles))
    touching = dynamics.contact.near_itself(positions, TOUCHING_M)
    if len(touching.nodes) and not crossings:
        positions = parted(positions, fine.particle_triangles, touching)
        crossings = len(dynamics.contact.near_itself(positions, TOUCHING_M).nodes)
    crossings += len(crossing_triangle_pairs_between(positions, fine.particle_triangles, mannequin.vertices, mannequin.faces))
    if crossings:
        raise RefinementError(f"the drape on {1e3 * coarse.spacing:g} mm crosses itself in {crossings} places on {1e3 * fine.spacing:g} mm: draped anew there")
    kept = {key: value for key, value in state.run.items() if key != "step_factor"}
    friction = refined_sliders(*before, state, fine, dynamics.forces, positions)
    run = kept | {"level": float(level)}
    made = State(positions, velocities, state.time_s, state.step, phase="fall", friction=friction, run=run, fold_angles=state.fold_angles, said=state.said)
    made.work_j, made.constraint_speeds, made.constraint_forces = dict(state.work_j), state.constraint_speeds, state.constraint_forces
    return made


def _placed(job: Job, cloth: Cloth, start: Cloth, worn: dict[str, np.ndarray], warnings: list[str]) -> np.ndarray:
    """Where the particles (P,3) m of `start` begin: the panels of `cloth` placed, with what is `worn` already (panel -> (V,3) m of its vertices) sewn."""
    positions = _with_worn(place_vertices(job.pattern, cloth, job.mannequin), cloth, worn)
    if worn:
        pattern = around_worn(job.pattern, cloth, positions, job.mannequin, worn)
        positions = _with_worn(place_vertices(pattern, cloth, job.mannequin), cloth, worn)
    moves = clearing_moves(job.pattern, cloth, positions, job.mannequin, worn)
    warnings += [str(move) for move in moves]
    positions = move_panels(cloth, positions, moves)
    placed = np.empty((start.particle_count, 3))
    placed[start.vertex_particle] = positions
    return placed


def _hung(outcome: Outcome) -> dict[str, np.ndarray]:
    """Where the vertices (V,3) m of each panel ended."""
    ends = outcome.state.positions[outcome.cloth.vertex_particle]
    return {name: ends[outcome.cloth.vertex_panel == number] for number, name in enumerate(outcome.cloth.panel_names)}


def _folds_of(flat: Cloth, panels: Collection[str]) -> np.ndarray:
    """(F,) bool: which folds lie on `panels`."""
    return np.array([name.split(".")[0] in panels for name in flat.fold_names], dtype=bool)


def _with_worn(positions: np.ndarray, cloth: Cloth, worn: dict[str, np.ndarray]) -> np.ndarray:
    """Positions (V,3), in place, with what is worn where it hangs."""
    for panel, hung in worn.items():
        positions[cloth.vertex_panel == cloth.panel_names.index(panel)] = hung
    return positions
