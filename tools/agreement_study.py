"""Drape mode against dynamics: the same rest from both, one piece of cloth for one, folds of a disc over a pedestal in the mean of ten lays.

`python -m tools.agreement_study` runs the cases that have no row in docs/studies/agreement.jsonl yet and writes agreement.md; with TEXT only those with TEXT in
their name.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Mapping
from dataclasses import replace
from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np
import trimesh
from scipy.signal import find_peaks
from shapely import make_valid, union_all
from shapely.geometry import Point, Polygon

from garmentcad import __version__
from garmentcad.arrays import floats, frozen, indices
from garmentcad.bench.cases import case_job
from garmentcad.bench.cloth_on_ball import NAME as W1
from garmentcad.io.atomic import write_atomic
from garmentcad.io.fabric_file import fabric_path, load_fabric
from garmentcad.mannequin.mannequin import Mannequin
from garmentcad.pattern.draft import draft
from garmentcad.pattern.parse import parse_spec
from garmentcad.pattern.spec import GarmentSpec
from garmentcad.simulation.course import AIR_DRAG, STEPS_PER_LOOK
from garmentcad.simulation.job import Job
from garmentcad.simulation.run import Outcome, run
from garmentcad.simulation.study import Row, StudyCase, run_study, study_table
from garmentcad.units import M_TO_MM, MM_TO_M

FOLDER = Path(__file__).resolve().parent.parent / "docs" / "studies"
FABRIC = "wool-suiting"
# After drape mode
RESTED, RESTED_GRID_MM, RESTED_S = (W1, "t-shirt", "straight-skirt", "flared-skirt"), 20.0, 2.0
MOST_RESTED_MM = 1.0
# The same lay in both modes
PIECE_GRID_MM, MAX_TIME_S = 10.0, 60.0
PIECES = ("swatch on a ball", "strip over a pedestal", "fold over a bar")
MOST_PIECE_MM = 2.0
SPREAD_LAYS = 3  # of the first piece, to tell what is the mode's and what the piece's own
# A disc over a pedestal
LAYS, DISC_MM, PEDESTAL_MM = 10, 240.0, 120.0
EDGE_MM = 5.0  # radius of the pedestal's edge and the plate's
LAY_MM = 4.0  # of the flat cloth above the body
WAVES = 12  # terms of the rim's Fourier series on which folds are counted
SHARE = 0.1  # of the range of radii, by which a fold stands out

MEANS = {"drape coefficient %": "coefficient_percent", "folds": "folds", "mean height of the rim mm": "rim_mm"}


def circle_spec(diameter_mm: float) -> GarmentSpec:
    """A disc, in four arcs."""
    radius = 0.5 * diameter_mm
    points = {"e": [radius, 0], "n": [0, radius], "w": [-radius, 0], "s": [0, -radius]}
    arc = {"center": [0, 0], "direction": "counterclockwise"}
    edges = [{"name": start + end, "from": start, "to": end, "arc": arc} for start, end in ("en", "nw", "ws", "se")]
    return _laid("disc", points, edges)


def rectangle_spec(name: str, width_mm: float, length_mm: float) -> GarmentSpec:
    """A rectangle, `length_mm` along the grain."""
    u, v = 0.5 * width_mm, 0.5 * length_mm
    points = {"a": [-u, -v], "b": [u, -v], "c": [u, v], "d": [-u, v]}
    return _laid(name, points, [{"name": start + end, "from": start, "to": end} for start, end in ("ab", "bc", "cd", "da")])


def _laid(name: str, points: dict[str, list[float]], edges: list[dict[str, Any]]) -> GarmentSpec:
    """One panel laid level, right side up, its middle LAY_MM above the top of the body; its grain runs to -z."""
    placement = {"transform": {"translation": [0, LAY_MM, 0], "rotation": [-90, 0, 0]}}
    panel = {"points": points, "edges": edges, "placement": placement}
    return parse_spec({"schema": 1, "units": "mm", "name": name, "fabric": FABRIC, "mannequin": "body", "panels": {"panel": panel}})


def _body(name: str, mesh: trimesh.Trimesh) -> Mannequin:
    """A mesh as a body, its highest point at y = 0."""
    vertices = np.asarray(mesh.vertices) - [0.0, mesh.bounds[1, 1], 0.0]
    faces = frozen(indices(mesh.faces))
    return Mannequin(name, frozen(floats(vertices)), faces, {}, {}, {}, (name,), frozen(indices(np.zeros(len(faces)))))


def pedestal(diameter_mm: float) -> Mannequin:
    """A round pedestal, 200 mm high, with a rounded edge."""
    radius, edge = 0.5 * diameter_mm * MM_TO_M, EDGE_MM * MM_TO_M
    corner = [(radius - edge + edge * math.sin(a), edge * math.cos(a) - edge) for a in np.linspace(0.0, 0.5 * math.pi, 7)]
    flat = [(r, 0.0) for r in np.linspace(0.0, radius - edge, 8)[:-1]]
    wall = [(radius, y) for y in np.linspace(-edge, -0.2, 20)[1:]]
    mesh = trimesh.creation.revolve(np.array([*flat, *corner, *wall, (0.0, -0.2)])[::-1], sections=96)
    return _body("pedestal", mesh.apply_transform(trimesh.transformations.rotation_matrix(-0.5 * math.pi, [1, 0, 0])))


def bar(radius_mm: float, length_mm: float) -> Mannequin:
    """A bar along z with round ends."""
    return _body("bar", trimesh.creation.capsule(height=length_mm * MM_TO_M, radius=radius_mm * MM_TO_M, count=[32, 96]))


def ball(radius_mm: float) -> Mannequin:
    return _body("ball", trimesh.creation.icosphere(subdivisions=5, radius=radius_mm * MM_TO_M))


def piece(name: str, mode: str) -> Job:
    """The job of a case of one small piece."""
    if name == PIECES[0]:
        return lay(rectangle_spec("swatch", 160.0, 160.0), ball(100.0), 0, mode)
    if name == PIECES[1]:
        return lay(rectangle_spec("strip", 30.0, 240.0), pedestal(PEDESTAL_MM), 0, mode)
    return lay(rectangle_spec("fold", 200.0, 100.0), bar(20.0, 200.0), 0, mode)


def lay(spec: GarmentSpec, body: Mannequin, seed: int, mode: str) -> Job:
    fabrics = {spec.fabric: load_fabric(fabric_path(FABRIC))}
    return Job(spec, draft(spec, body.measurements_mm), fabrics, body, PIECE_GRID_MM, seed, mode, MAX_TIME_S)  # type: ignore[arg-type]


def apart_mm(cloth_masses: np.ndarray, one: np.ndarray, other: np.ndarray) -> dict[str, float]:
    """Distance of two shapes (P,3) m, particle by particle: mass-weighted RMS, and the largest."""
    square = ((one - other) ** 2).sum(axis=1)
    return {"rms_mm": M_TO_MM * math.sqrt(float((cloth_masses * square).sum() / cloth_masses.sum())), "most_mm": M_TO_MM * math.sqrt(float(square.max()))}


def rested(case: StudyCase) -> Row:
    """Drape, then go on with the masses, tension and drag of dynamics, and measure how far that moves the cloth."""
    outcome = run(case_job(case.parameters["of"], RESTED_GRID_MM, FABRIC, 0), lambda progress: None)
    dynamics, state = outcome.dynamics, outcome.state
    dynamics.equalise, dynamics.drag, dynamics.speed_cap_m_s = False, AIR_DRAG, math.inf
    start, began = state.positions.copy(), state.time_s
    while state.time_s < began + RESTED_S:
        dynamics.advance(state, STEPS_PER_LOOK)
    speed = M_TO_MM * dynamics.measures(state)[2]
    return {"status": outcome.status, "rms_speed_mm_s": speed, **apart_mm(outcome.cloth.masses, start, state.positions)}


def both_modes(job: Job) -> tuple[Outcome, Outcome]:
    return run(replace(job, mode="drape"), lambda progress: None), run(replace(job, mode="dynamics"), lambda progress: None)


def _times(drape: Outcome, dynamics: Outcome) -> Row:
    return {
        "drape_status": drape.status, "dynamics_status": dynamics.status, "drape_s": drape.state.time_s, "dynamics_s": dynamics.state.time_s,
        "drape_wall_s": drape.wall_s["drape"], "dynamics_wall_s": dynamics.wall_s["drape"],
    }  # fmt: skip


def one_piece(case: StudyCase) -> Row:
    """The same lay in both modes, particle by particle."""
    drape, dynamics = both_modes(piece(case.parameters["of"], "drape"))
    return {**_times(drape, dynamics), **apart_mm(drape.cloth.masses, drape.state.positions, dynamics.state.positions)}


def spread(case: StudyCase) -> Row:
    """A few lays of a piece, alike but for their seeds, in both modes: how far the ends of one mode are apart, and those of one from those of the other."""
    ends: dict[str, list[np.ndarray]] = {"drape": [], "dynamics": []}
    energy: dict[str, list[float]] = {"drape": [], "dynamics": []}
    for seed in range(SPREAD_LAYS):
        for mode, outcome in zip(ends, both_modes(replace(piece(case.parameters["of"], "drape"), seed=seed))):
            ends[mode].append(outcome.state.positions)
            energy[mode].append(1e6 * sum(outcome.dynamics.forces.energy(outcome.state.positions, outcome.state.friction).values()))
            masses = outcome.cloth.masses
    within = {mode: [apart_mm(masses, one, other)["rms_mm"] for one, other in combinations(found, 2)] for mode, found in ends.items()}
    between = [apart_mm(masses, one, other)["rms_mm"] for one in ends["drape"] for other in ends["dynamics"]]
    return {f"{mode}_{bound.__name__}": bound(values) for mode, values in {**within, "between": between}.items() for bound in (min, max)} | {
        f"{mode}_energy": sum(values) / len(values) for mode, values in energy.items()
    }


def folded(outcome: Outcome) -> Row:
    """Shape of a disc on the pedestal. Drape coefficient: area of the cloth's shadow outside the pedestal over that of the flat ring; folds: maxima of the
    radius along the rim, smoothed; height of the rim over the pedestal's top."""
    corners = M_TO_MM * outcome.state.positions[outcome.cloth.particle_triangles][:, :, [0, 2]]
    shadow = union_all([make_valid(Polygon(triangle)) for triangle in corners]).difference(Point(0.0, 0.0).buffer(0.5 * PEDESTAL_MM, 256))
    ring = 0.25 * math.pi * (DISC_MM**2 - PEDESTAL_MM**2)
    loop = np.concatenate([vertices[:-1] for vertices in outcome.cloth.edge_vertices.values()])
    rim = M_TO_MM * outcome.state.positions[outcome.cloth.vertex_particle[loop]]
    return {"coefficient_percent": 100.0 * shadow.area / ring, "folds": folds_of(rim), "rim_mm": float(rim[:, 1].mean())}


def folds_of(rim: np.ndarray) -> int:
    """Number of folds of a rim (N,3) mm, points at equal steps along it."""
    radius = np.hypot(rim[:, 0], rim[:, 2])
    series = np.fft.rfft(radius)[: WAVES + 1]
    smooth = np.fft.irfft(series, 1024)
    turned = np.roll(smooth, -int(np.argmin(smooth)))  # begins and ends at the lowest point: no top is cut
    return len(find_peaks(np.append(turned, turned[0]), prominence=SHARE * np.ptp(smooth))[0])


def one_lay(case: StudyCase) -> Row:
    job = lay(circle_spec(DISC_MM), pedestal(PEDESTAL_MM), case.parameters["lay"], "drape")
    drape, dynamics = both_modes(job)
    return {**_times(drape, dynamics), "drape": folded(drape), "dynamics": folded(dynamics)}


KINDS = {"rested": rested, "piece": one_piece, "spread": spread, "disc": one_lay}


def run_case(case: StudyCase) -> Mapping[str, Any]:
    """Figures of one case."""
    row = KINDS[case.parameters["kind"]](case)
    print(row, flush=True)
    return row


def cases() -> list[StudyCase]:
    """All cases."""

    def one(name: str, kind: str, **more: Any) -> StudyCase:
        return StudyCase(f"{kind}: {name}", "", FABRIC, "", __version__, {"kind": kind, **more})

    return [
        *(one(name, "rested", of=name, grid_mm=RESTED_GRID_MM) for name in RESTED),
        *(one(name, "piece", of=name, grid_mm=PIECE_GRID_MM) for name in PIECES),
        one(PIECES[0], "spread", of=PIECES[0], grid_mm=PIECE_GRID_MM, lays=SPREAD_LAYS),
        *(one(f"lay {lay}", "disc", lay=lay, grid_mm=PIECE_GRID_MM, disc_mm=DISC_MM, pedestal_mm=PEDESTAL_MM) for lay in range(LAYS)),
    ]


def page(rows: tuple[Row, ...]) -> str:
    """The study's page."""
    kinds = {kind: [row for row in rows if row["kind"] == kind] for kind in KINDS}
    command, both = "python -m tools.agreement_study", {"drape": "drape_status", "dynamics": "dynamics_status", "drape s": "drape_s:.2f"}
    both |= {"dynamics s": "dynamics_s:.2f", "drape wall s": "drape_wall_s:.1f", "dynamics wall s": "dynamics_wall_s:.1f"}
    moved = {"RMS mm": "rms_mm:.3f", "most mm": "most_mm:.2f"}
    good = {kind: sum(row["rms_mm"] < most for row in kinds[kind]) for kind, most in (("rested", MOST_RESTED_MM), ("piece", MOST_PIECE_MM))}
    lines = ["# Drape mode and dynamics", "", f"Fabric {FABRIC}, but for W1.", "", "## From the end of drape mode on", ""]
    lines += [f"{RESTED_S:g} simulated seconds of dynamics at {RESTED_GRID_MM:g} mm."]
    lines += [f"{good['rested']} of {len(kinds['rested'])} move by less than {MOST_RESTED_MM:g} mm (RMS).", ""]
    lines += [study_table(kinds["rested"], {"case": "of", "drape": "status", **moved, "RMS speed at the end mm/s": "rms_speed_mm_s:.2f"}, command)]
    lines += ["## One lay in both modes", ""]
    lines += [f"At {PIECE_GRID_MM:g} mm; {good['piece']} of {len(kinds['piece'])} agree within {MOST_PIECE_MM:g} mm (RMS).", ""]
    lines += [study_table(kinds["piece"], {"case": "of", **both, **moved}, command)]
    lines += [*_spread(kinds["spread"])]
    lines += ["## Folds of a disc", "", f"A disc of {DISC_MM:g} mm on a pedestal of {PEDESTAL_MM:g} mm, at {PIECE_GRID_MM:g} mm.", ""]
    lines += _means(kinds["disc"])
    each = {f"{mode} {name}": f"{mode}.{key}:.3g" for name, key in MEANS.items() for mode in ("drape", "dynamics")}
    lines += [study_table(kinds["disc"], {"lay": "lay", **both, **each}, command)]
    return "\n".join(lines)


def _spread(rows: list[Row]) -> list[str]:
    if not rows:
        return []
    lines = [f"The {rows[0]['of']} lies in ridges that friction holds where they came to rest. Of {rows[0]['lays']} lays, alike but for their seeds:", ""]
    lines += ["| ends compared | least, RMS mm | most, RMS mm | mean energy uJ |", "|---|---|---|---|"]
    for name, energy in (("drape", "drape_energy"), ("dynamics", "dynamics_energy"), ("between", None)):
        mean = f"{rows[0][energy]:.0f}" if energy else ""
        words = {"between": "one of each mode"}.get(name, f"two of {name}")
        lines.append(f"| {words} | {rows[0][name + '_min']:.2f} | {rows[0][name + '_max']:.2f} | {mean} |")
    return [*lines, ""]


def _means(rows: list[Row]) -> list[str]:
    if not rows:
        return []
    lines = ["| mean over lays | drape | dynamics | difference | standard deviation of the differences |", "|---|---|---|---|---|"]
    for name, key in MEANS.items():
        one, other = (np.array([row[mode][key] for row in rows], dtype=float) for mode in ("drape", "dynamics"))
        lines.append(f"| {name} | {one.mean():.2f} | {other.mean():.2f} | {(one - other).mean():+.2f} | {(one - other).std():.2f} |")
    return [*lines, ""]


def main(only: str | None) -> None:
    """Run the study and write its page."""
    study = run_study("agreement", cases(), run_case, FOLDER, only=only, say=lambda message: print(message, flush=True))
    write_atomic(FOLDER / "agreement.md", page(study.rows))


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else None)
