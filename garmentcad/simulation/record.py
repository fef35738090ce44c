"""From a finished run to its record and measures: the judge's numbers, taken on the final state by code that the solver does not use."""

from __future__ import annotations

import hashlib
import platform
from dataclasses import replace
from importlib.metadata import version

import numba
import numpy as np

from garmentcad import __version__
from garmentcad.analysis.contact_faults import contact_faults
from garmentcad.analysis.folds import fold_lines
from garmentcad.analysis.measures import Measures, measure
from garmentcad.analysis.on_body import on_body
from garmentcad.analysis.run_record import BAND_KEYS, RunRecord, Status
from garmentcad.analysis.seam_tension import SeamTension, seam_lengths, seam_tension
from garmentcad.cloth.state import State
from garmentcad.fabric.sheet import is_calibrated
from garmentcad.forces.assembly import ForceAssembly
from garmentcad.forces.band import ForceBand
from garmentcad.forces.button import ForceButton
from garmentcad.forces.gravity import ForceGravity
from garmentcad.forces.internal import internal_forces
from garmentcad.mannequin.mannequin import Mannequin
from garmentcad.pattern.pattern import Pattern, edge_roles
from garmentcad.placement.place import place_vertices
from garmentcad.simulation.course import FELL
from garmentcad.simulation.job import Job
from garmentcad.simulation.run import Outcome
from garmentcad.solve.dynamics import DivergedError
from garmentcad.solve.rest import patches, residual
from garmentcad.units import M_TO_MM, MM_TO_M

FALLEN_MM = 500.0
WIDEST_BUTTON_MM = 0.5  # a hole that stands farther from its shank pulls with 10 N, or lies on the wrong side
WIDEST_PIN_MM = 1.0  # beyond what contact keeps one from that is put onto the body
LIBRARIES = ("numpy", "scipy", "numba", "trimesh", "shapely")


def record(outcome: Outcome) -> tuple[RunRecord, Measures]:
    """Judge and measure the final state of a run."""
    identity = outcome.job.identity
    job, cloth, state, body = outcome.job, outcome.cloth, outcome.state, outcome.job.mannequin
    finite = bool(np.isfinite(state.positions).all())
    faults = worn = seams = None
    status: Status = outcome.status  # type: ignore[assignment]
    if finite:
        worn = on_body(cloth, outcome.materials, body, state.positions, outcome.dynamics.net_forces(state))
        faults = contact_faults(cloth, state.positions, body, distances=worn.distance_m)
        if faults:
            status = "intersecting"
    elif status == "converged":
        status = "diverged"
    outcome.dynamics.set_inverse_masses(outcome.dynamics.true_inverse_masses)
    widest = max(outcome.welding.gap_mm.values(), default=None)
    held = _held(outcome) if finite else {}
    kinetic, fastest, rms = outcome.dynamics.measures(state)
    left = _residual_g(outcome) if finite else None
    energy = outcome.dynamics.forces.energy(state.positions, state.friction) if finite else {}
    if finite:
        seams = _seams(outcome)
    fallen = _fallen(state, body) if finite else []
    coarse = cloth.spacing != MM_TO_M * job.grid_mm
    grid_mm = round(M_TO_MM * cloth.spacing, 6) if coarse else job.grid_mm
    early = [f"it ended on the lattice of {grid_mm:g} mm, before the one of {job.grid_mm:g} mm that was asked for"] if coarse else []
    crossed = () if faults is None else faults.said
    notes = [f"mannequin {body.name}: {note}" for note in body.notes]
    made = RunRecord(
        garment=job.pattern.name,
        fabric=job.fabrics[job.pattern.fabric].sheet.name,
        mannequin=body.name,
        grid_mm=grid_mm,
        seed=job.seed,
        mode=job.mode,
        threads=numba.get_num_threads(),
        versions=versions(),
        spec_sha256=identity["spec"],
        fabric_sha256=hashlib.sha256(identity["fabric"].encode()).hexdigest(),
        mannequin_sha256=identity["mannequin"],
        state_sha256=state.sha256(),
        status=status,
        seams=len(job.pattern.seams),
        welds=len(cloth.vertex_particle) - cloth.particle_count,
        steps=state.step,
        time_step_s=state.time_step_s,
        simulated_time_s=state.time_s,
        wall_time_s={**outcome.wall_s, "total": sum(outcome.wall_s.values()), **outcome.seconds},
        rest={"max_speed_m_s": fastest, "rms_speed_m_s": rms, "kinetic_j_per_kg": kinetic / float(cloth.masses.sum()), "residual_g_rms": left},
        constraints={
            "max_gap_mm": max([*outcome.welding.gap_mm.values(), *(gap for gap, _ in held.values())], default=None),
            "max_speed_m_s": max([*filter(None, [outcome.welding.speed_m_s]), *(speed for _, speed in held.values())], default=outcome.welding.speed_m_s),
            "conflicting": outcome.welding.conflicting,
            "gap_mm": {name: gap for name, (gap, _) in held.items()},
            "speed_m_s": {name: speed for name, (_, speed) in held.items()},
        },
        seam_gap_mm=widest,
        mannequin_penetration_mm=None if faults is None else faults.mannequin_penetration_mm,
        self_intersections=None if faults is None else faults.self_intersections,
        mannequin_intersections=None if faults is None else faults.mannequin_intersections,
        energy_j={
            "stretch": _sum(energy, "stretch", "border"),
            "shear": energy.get("shear"),
            "bend": _sum(energy, "bend", "twist", "hinge", "span"),
            "band": _sum(energy, "band", "button"),
            "gravity": energy.get("gravity"),
            "friction_work": state.work_j["friction"],
            "internal_friction_work": state.work_j["internal_friction"],
            "damping_work": None,  # drape mode changes masses and stiffness on the way: its damping is no energy of the cloth
        },
        bands=_bands(outcome) if finite else {},
        uncalibrated=not all(is_calibrated(completed.sheet) for completed in job.fabrics.values()),
        warnings=(*outcome.warnings, *early, *crossed, *_undone(job.pattern, held), *_torn(job.pattern, seams or {}), *fallen, *notes, *_of_sheets(job)),
    )
    roles = edge_roles(job.pattern)
    placed = place_vertices(job.pattern, cloth, body)
    return made, measure(cloth, state.positions, outcome.materials, body, roles, placed, worn, seams, fold_lines(job.pattern))


def versions() -> dict[str, str]:
    """What a drape is made with: this program, Python and the libraries whose arithmetic it uses."""
    return {"garmentcad": __version__, "python": platform.python_version(), **{name: version(name) for name in LIBRARIES}}


def _residual_g(outcome: Outcome) -> float | None:
    """RMS residual, g; None where a step from the final state runs away, as where a seam was torn at."""
    try:
        return residual(outcome.dynamics, outcome.state, patches(outcome.cloth)).rms_g
    except DivergedError:
        return None


def _held(outcome: Outcome) -> dict[str, tuple[float, float]]:
    """|C| in mm and |C'| in m/s of each pin and button, as it is at the end; of a button that is done up, how
    far its hole is from the shank."""
    pattern, constraint = outcome.job.pattern, outcome.dynamics.constraint
    names = {pin.name for pin in pattern.pins} | {button.name for button in pattern.buttons}
    gaps, speeds = outcome.dynamics.constraint_errors(outcome.state)
    held = {} if constraint is None else {name: (M_TO_MM * gap, speed) for name, gap, speed in zip(constraint.names, gaps, speeds) if name in names}
    for force in outcome.dynamics.forces.forces:
        if isinstance(force, ForceButton):
            beside, speeds = force.gaps(outcome.state.positions), force.speeds(outcome.state.positions, outcome.state.velocities)
            held |= {button.name: (M_TO_MM * float(gap), float(speed)) for button, gap, speed in zip(pattern.buttons, beside, speeds, strict=True)}
    return held


def _undone(pattern: Pattern, held: dict[str, tuple[float, float]]) -> list[str]:
    """A sentence for each button and pin that is not where it holds."""
    buttons, pins = ({one.name: held.get(one.name, (0.0, 0.0))[0] for one in kind} for kind in (pattern.buttons, pattern.pins))
    bar = f"at most {WIDEST_BUTTON_MM:g} mm is a button that holds"
    found = [f"button '{name}' is not done up: its hole is {gap:.1f} mm from the shank ({bar})" for name, gap in buttons.items() if gap > WIDEST_BUTTON_MM]
    bar = f"at most {WIDEST_PIN_MM:g} mm is a pin that holds"
    return found + [f"pin '{name}' does not hold: its point is {gap:.1f} mm from its place ({bar})" for name, gap in pins.items() if gap > WIDEST_PIN_MM]


def _fallen(state: State, body: Mannequin) -> list[str]:
    """A sentence for a garment that nothing holds up."""
    if FELL in state.run:
        return ["the garment fell off: all of it is below the body, and the run ended there"]
    below = M_TO_MM * float(body.vertices[:, 1].min() - state.positions[:, 1].min())
    return [f"the garment fell off: it hangs down to {below:.0f} mm below the floor"] if below > FALLEN_MM else []


def _of_sheets(job: Job) -> list[str]:
    """What was noticed in the sheets, by the names that they give themselves: a pattern may know them by others (a fabric that is replaced, a file)."""
    sheets = job.fabrics.values()
    told = (f"{completed.sheet.name}: {finding.said}" for completed in sheets for finding in completed.findings if finding.severity != "info")
    return list(dict.fromkeys(told))  # one sheet may serve two garments


def _torn(pattern: Pattern, seams: dict[str, SeamTension | None]) -> list[str]:
    """A sentence for each seam that is pulled more than the strength that its spec gives it."""
    found = []
    for seam in pattern.seams:
        tension = seams.get(seam.name)
        if tension is not None and seam.strength_n_m is not None and tension.max_n_m > seam.strength_n_m:
            found.append(f"seam '{seam.name}' is pulled by up to {tension.max_n_m:.3g} N/m; it holds {seam.strength_n_m:.3g} N/m")
    return found


def _bands(outcome: Outcome) -> dict[str, dict[str, float]]:
    """Tension and length of each elastic and belt."""
    force = next((force for force in outcome.dynamics.forces.forces if isinstance(force, ForceBand)), None)
    if force is None:
        return {}
    segments, lengths, tensions = force.segments, force.lengths(outcome.state.positions), force.tensions(outcome.state.positions)
    found = {}
    for number, band in enumerate(outcome.job.pattern.bands):
        mine = segments.band == number
        length, rest = float(lengths[mine].sum()), float(segments.rest[mine].sum())
        mean, most = np.average(tensions[mine], weights=lengths[mine]), tensions[mine].max()
        values = (float(mean), float(most), M_TO_MM * length, M_TO_MM * rest, 100.0 * (length / rest - 1.0))
        found[band.name] = dict(zip(BAND_KEYS, values, strict=True))
    return found


def _seams(outcome: Outcome) -> dict[str, SeamTension | None]:
    """Seam tensions: what each panel's own elements do to its vertices, every vertex where its particle is."""
    # unsewn, but with the rest lengths of its gathers
    flat = replace(outcome.flat, border=outcome.cloth.border._replace(corners=outcome.flat.border.corners))
    positions = outcome.state.positions[outcome.cloth.vertex_particle]
    apart = ForceAssembly(internal_forces(flat, outcome.materials, fold_angles=outcome.state.fold_angles), flat.particle_count, [ForceGravity(flat.masses)])
    forces = np.zeros_like(positions)
    # Welding leaves the elements and their order as they are, and adds hinges: what holds by internal friction is that of the sewn garment.
    sliders = {name: outcome.state.friction[name].copy() if slack.size else slack for name, slack in apart.slack().items()}
    apart.add_up(positions, np.zeros_like(positions), forces, sliders)
    return seam_tension(flat, positions, forces, seam_lengths(outcome.job.pattern))


def _sum(energy: dict[str, float], *names: str) -> float | None:
    parts = [energy[name] for name in names if name in energy]
    return sum(parts) if parts else None
