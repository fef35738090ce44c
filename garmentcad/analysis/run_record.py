"""What a run knows about itself when it ends; the report joins it with what is measured on the final state."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Mode = Literal["drape", "dynamics"]
Status = Literal["converged", "max_time", "diverged", "intersecting"]
BAND_KEYS = ("tension_n", "max_tension_n", "length_mm", "rest_length_mm", "strain_percent")


@dataclass(frozen=True)
class RunRecord:
    """The part of report.json that the simulation fills. Names and units are those of the report; nested dicts hold at least the keys named here.

    status: `intersecting` includes penetration of the mannequin. wall_time_s: setup, drape, total. rest: max_speed_m_s, rms_speed_m_s, kinetic_j_per_kg,
    residual_g_rms. constraints: max_gap_mm, max_speed_m_s (seams at the instant of welding, pins and buttons at the end), conflicting (list of names), gap_mm
    and speed_m_s of each pin and button. bands: `BAND_KEYS` of each elastic and belt. seam_gap_mm: largest gap at the instant of welding.
    mannequin_penetration_mm: deepest point, 0 if none. self_intersections, mannequin_intersections: triangle pairs. energy_j: stretch, shear, bend, gravity,
    friction_work, internal_friction_work, damping_work. uncalibrated: the fabric's law values are the sheet's own. None stands for what was not measured.
    """

    garment: str
    fabric: str
    mannequin: str
    grid_mm: float
    seed: int
    mode: Mode
    threads: int
    versions: dict[str, str]
    spec_sha256: str
    fabric_sha256: str
    mannequin_sha256: str
    state_sha256: str
    status: Status
    seams: int
    welds: int
    steps: int
    time_step_s: float
    simulated_time_s: float
    wall_time_s: dict[str, float]
    rest: dict[str, float | None]
    constraints: dict[str, object]
    seam_gap_mm: float | None
    mannequin_penetration_mm: float | None
    self_intersections: int | None
    mannequin_intersections: int | None
    energy_j: dict[str, float | None]
    bands: dict[str, dict[str, float]]
    uncalibrated: bool
    warnings: tuple[str, ...] = ()
