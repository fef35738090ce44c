"""From a finished run to its record and measures: the judge's numbers, taken on the final state by code that the solver does not use."""

from __future__ import annotations

import platform
from importlib.metadata import version

import numba
import numpy as np
from scipy.spatial import cKDTree

from garmentcad import __version__
from garmentcad.analysis.intersection import crossing_triangle_pairs, crossing_triangle_pairs_between
from garmentcad.analysis.measures import Measures, measure
from garmentcad.analysis.penetration import penetration_mm, signed_distances, vertex_normals
from garmentcad.analysis.pressure import contact_pressure
from garmentcad.analysis.run_record import RunRecord, Status
from garmentcad.analysis.tributary import particle_areas
from garmentcad.fabric.sheet import is_calibrated
from garmentcad.placement.place import place_vertices
from garmentcad.simulation.run import Outcome
from garmentcad.solve.rest import patches, residual

LIBRARIES = ("numpy", "scipy", "numba", "trimesh", "shapely")
# Contact keeps at least this gap to the body; the sheet's half thickness where that is more.
LEAST_GAP_M = 1e-3


def record(outcome: Outcome) -> tuple[RunRecord, Measures]:
    """Judge and measure the final state of a run."""
    job, cloth, state, body = outcome.job, outcome.cloth, outcome.state, outcome.job.mannequin
    finite = bool(np.isfinite(state.positions).all())
    crossings = touching = depth = None
    status: Status = outcome.status  # type: ignore[assignment]
    if finite:
        triangles = cloth.particle_triangles
        crossings = len(crossing_triangle_pairs(state.positions, triangles))
        touching = len(crossing_triangle_pairs_between(state.positions, triangles, body.vertices, body.faces))
        distance = signed_distances(state.positions, body.vertices, body.faces)
        depth = penetration_mm(state.positions, triangles, body.vertices, body.faces, distance)
        if crossings or touching or depth > 0.0:
            status = "intersecting"
    elif status == "converged":
        status = "diverged"
    outcome.dynamics.set_inverse_masses(outcome.dynamics.true_inverse_masses)
    widest = max(outcome.welding.gap_mm.values(), default=None)
    kinetic, fastest, rms = outcome.dynamics.measures(state)
    left = residual(outcome.dynamics, state, patches(cloth)).rms_g if finite else None
    energy = outcome.dynamics.forces.energy(state.positions) if finite else {}
    findings = [f"{name}: {finding}" for name, completed in job.fabrics.items() for finding in completed.findings if finding.severity != "info"]
    made = RunRecord(
        garment=job.pattern.name,
        fabric=job.fabrics[job.pattern.fabric].sheet.name,
        mannequin=body.name,
        grid_mm=job.grid_mm,
        seed=job.seed,
        threads=numba.get_num_threads(),
        versions={"garmentcad": __version__, "python": platform.python_version(), **{name: version(name) for name in LIBRARIES}},
        spec_sha256=job.spec_sha256,
        state_sha256=state.sha256(),
        status=status,
        seams=len(job.pattern.seams),
        welds=len(cloth.vertex_particle) - cloth.particle_count,
        steps=state.step,
        time_step_s=state.time_step_s,
        simulated_time_s=state.time_s,
        wall_time_s={**outcome.wall_s, "total": sum(outcome.wall_s.values()), **outcome.seconds},
        rest={"max_speed_m_s": fastest, "rms_speed_m_s": rms, "kinetic_j_per_kg": kinetic / float(cloth.masses.sum()), "residual_g_rms": left},
        constraints={"max_gap_mm": widest, "max_speed_m_s": outcome.welding.speed_m_s, "conflicting": outcome.welding.conflicting},
        seam_gap_mm=widest,
        mannequin_penetration_mm=depth,
        self_intersections=crossings,
        mannequin_intersections=touching,
        energy_j={
            "stretch": _sum(energy, "stretch", "border"),
            "shear": energy.get("shear"),
            "bend": _sum(energy, "bend", "twist", "hinge", "span"),
            "gravity": energy.get("gravity"),
            "friction_work": state.work_j["friction"],
            "damping_work": None,  # drape mode changes masses and stiffness on the way: its damping is no energy of the cloth
        },
        uncalibrated=not all(is_calibrated(completed.sheet) for completed in job.fabrics.values()),
        warnings=(*outcome.warnings, *findings),
    )
    roles: dict[str, list[str]] = {}
    for panel in job.pattern.panels.values():
        for edge in panel.edges:
            key = f"{panel.name}.{edge.name}"  # once, where darts cut it into pieces
            if edge.role is not None and key not in roles.setdefault(edge.role, []):
                roles[edge.role].append(key)
    pressure = None
    if finite:
        # The body is smooth at the scale of its triangles: the normal at the nearest body vertex serves.
        nearest = cKDTree(body.vertices).query(state.positions)[1]
        normal = vertex_normals(body.vertices, body.faces)[nearest]
        gap = max(LEAST_GAP_M, 0.5 * float(outcome.materials.thickness.max()))
        pressure = contact_pressure(outcome.dynamics.net_forces(state), normal, distance, gap, particle_areas(cloth))
    folds = {f"{panel.name}.{fold.name}": fold.points_mm for panel in job.pattern.panels.values() for fold in panel.folds}
    return made, measure(cloth, state.positions, outcome.materials, body, roles, place_vertices(job.pattern, cloth, body), pressure, folds)


def _sum(energy: dict[str, float], *names: str) -> float | None:
    parts = [energy[name] for name in names if name in energy]
    return sum(parts) if parts else None
