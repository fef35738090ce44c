"""report.json: every promised key, valid JSON whatever comes in, and a table for people."""

from __future__ import annotations

import dataclasses
import io
import json
import math
from pathlib import Path

import numpy as np
import pytest
from hand_made import cylinder_body, materials, rectangles, tube
from rich.console import Console

from garmentcad.analysis.measures import Measures, measure
from garmentcad.analysis.on_body import OnBody
from garmentcad.analysis.pressure import contact_pressure
from garmentcad.analysis.run_record import RunRecord
from garmentcad.analysis.seam_tension import SeamTension
from garmentcad.analysis.tributary import draped_areas
from garmentcad.export.report import blank_report, build_report, report_json, report_table, write_report

# DESIGN section 5: "report.json holds at least".
PROMISED = [
    "schema", "garment", "fabric", "mannequin", "grid_mm", "seed", "mode", "threads", "versions", "spec_sha256", "fabric_sha256", "mannequin_sha256",
    "state_sha256", "status", "particles",
    "triangles", "panels", "seams", "welds", "steps", "time_step_s", "simulated_time_s", "wall_time_s.setup", "wall_time_s.drape",
    "wall_time_s.total", "rest.max_speed_m_s", "rest.rms_speed_m_s", "rest.kinetic_j_per_kg", "rest.residual_g_rms", "strain_percent.warp.p50",
    "strain_percent.warp.p99", "strain_percent.warp.max", "strain_percent.warp.min", "strain_percent.weft.p99", "trellis_deg.p99", "trellis_deg.max",
    "trellis_deg.over_8_percent", "strain_over_limit_percent", "constraints.max_gap_mm", "constraints.max_speed_m_s", "constraints.conflicting",
    "seam_gap_mm.max", "mannequin_penetration_mm.max", "self_intersections", "mannequin_intersections", "pattern_ease_mm.bust",
    "pattern_ease_mm.waist", "pattern_ease_mm.hip", "ease_mm.bust", "ease_mm.waist", "ease_mm.hip", "hem_height_mm", "hem.nodes", "pressure_kpa.max",
    "pressure_kpa.mean_in_contact", "energy_j.stretch", "energy_j.shear", "energy_j.bend", "energy_j.gravity", "energy_j.friction_work",
    "energy_j.damping_work", "uncalibrated", "warnings", "strain_percent.bias.max", "strain_of_limit_percent.weft.max", "tension_n_m.weft.p99",
    "body_girth_mm.waist", "ease_mm.top_arm_left", "ease_mm.thigh_right", "hem_uneven_mm", "pressure_kpa.p95", "friction_kpa.max", "support_n.weight",
    "support_n.normal", "support_n.friction", "contact_area_m2", "distance_mm.p50", "seam_tension",
    "energy_j.internal_friction_work",
]  # fmt: skip


def run_record() -> RunRecord:
    return RunRecord(
        garment="tube",
        fabric="cotton-shirting",
        mannequin="cylinder",
        grid_mm=15.0,
        seed=0,
        mode="drape",
        threads=2,
        versions={"numpy": "2", "garmentcad": "0.1.0"},
        spec_sha256="a" * 64,
        fabric_sha256="c" * 64,
        mannequin_sha256="d" * 64,
        state_sha256="b" * 64,
        status="converged",
        seams=2,
        welds=82,
        steps=12345,
        time_step_s=2e-4,
        simulated_time_s=2.469,
        wall_time_s={"total": 61.0, "drape": 50.0, "setup": 11.0},
        rest={"max_speed_m_s": 1e-3, "rms_speed_m_s": 1e-4, "kinetic_j_per_kg": 1e-8, "residual_g_rms": 8e-4},
        constraints={"max_gap_mm": 0.02, "max_speed_m_s": 1e-6, "conflicting": [], "gap_mm": {"button": 0.02}, "speed_m_s": {"button": 1e-6}},
        seam_gap_mm=0.28,
        mannequin_penetration_mm=0.0,
        self_intersections=0,
        mannequin_intersections=0,
        energy_j={"stretch": 0.1, "shear": 0.1, "bend": 0.1, "gravity": -1.0, "friction_work": 0.2}
        | {"internal_friction_work": -0.1, "damping_work": 0.3, "band": None, "air": 0.0},
        bands={"waist": {"tension_n": 12.0, "max_tension_n": 12.5, "length_mm": 700.0, "rest_length_mm": 560.0, "strain_percent": 25.0}},
        uncalibrated=True,
        warnings=("an estimate",),
    )


def tube_measures(broken: bool = False) -> Measures:
    """A tube of 900 mm girth, 630 to 1230 mm high, around a cylinder of 120 mm radius; weft is stretched from 900 mm to the circle of 150 mm."""
    cloth = rectangles(30, 40, 0.015, 2, sewn=True)
    positions = tube(cloth, 30, 2, lambda row, angle: np.full_like(angle, 0.15), lambda row: 0.63 + 0.015 * row)
    if broken:
        positions[7] = np.nan
    normal = positions * [1.0, 0.0, 1.0] / 0.15
    distance = np.full(len(positions), 1e-3)
    pressure = contact_pressure(-0.2 * normal, normal, distance, 1e-3, draped_areas(cloth, positions))
    seams = {"side 0": SeamTension(600.0, 12.0, 20.0, 3.0), "side 1": None}
    return measure(cloth, positions, materials(), cylinder_body(), {"hem": ["front.hem", "back.hem"]}, on_body=OnBody(distance, pressure), seams=seams)


def value(report: dict, path: str):
    for name in path.split("."):
        report = report[name]
    return report


def test_every_promised_key_and_the_figures_of_a_tube() -> None:
    report = build_report(run_record(), tube_measures())
    for path in PROMISED:
        value(report, path)
    chord = 2.0 * 60 * 0.15 * math.sin(math.pi / 60)
    assert report["ease_mm"]["hip"] == pytest.approx(1000.0 * chord - 240.0 * math.pi, abs=1e-5)
    assert report["pattern_ease_mm"]["hip"] == pytest.approx(900.0 - 240.0 * math.pi, abs=1e-5)
    assert report["ease_mm"]["bust"] is None
    assert report["strain_percent"]["weft"]["p50"] == pytest.approx(100.0 * (chord / 0.9 - 1.0), rel=1e-6)
    assert report["strain_percent"]["warp"]["max"] == pytest.approx(0.0, abs=1e-6)
    assert report["strain_over_limit_percent"] == 0.0  # 4.7 % along weft, the limit is 8 %
    assert report["hem_height_mm"] == pytest.approx(630.0)
    assert report["pressure_kpa"]["max"] == pytest.approx(0.2 / 1000.0 / (0.015 * chord / 60 / 2.0), rel=1e-6)  # rim: half a cell, as draped
    assert report["distance_mm"] == {"p5": 1.0, "p50": 1.0, "p95": 1.0, "max": 1.0}
    assert report["support_n"]["weight"] == pytest.approx(9.81 * report["mass_kg"])
    assert report["seam_tension"] == {"side 0": {"length_mm": 600.0, "mean_n_m": 12.0, "max_n_m": 20.0, "along_n_m": 3.0}, "side 1": None}
    assert report["tension_n_m"]["warp"]["max"] == pytest.approx(0.0, abs=1e-6)
    assert (report["particles"], report["triangles"], report["panels"]) == (41 * 60, 4800, 2)


def test_json_is_valid_and_ordered(tmp_path: Path) -> None:
    report = build_report(run_record(), tube_measures())
    text = write_report(tmp_path / "report.json", report).read_text()
    assert json.loads(text) == report
    assert text == report_json(build_report(run_record(), tube_measures()))
    shuffled = dataclasses.replace(run_record(), versions={"garmentcad": "0.1.0", "numpy": "2"}, wall_time_s={"drape": 50.0, "setup": 11.0, "total": 61.0})
    assert report_json(build_report(shuffled, tube_measures())) == text
    assert list(report)[:4] == ["schema", "garment", "fabric", "mannequin"]
    assert list(report["energy_j"])[-1] == "air"


def test_a_diverged_run_is_still_valid_json() -> None:
    record = dataclasses.replace(run_record(), status="diverged", time_step_s=math.nan, rest=dict.fromkeys(run_record().rest, math.nan), seam_gap_mm=math.inf)
    report = build_report(record, tube_measures(broken=True))
    text = report_json(report)
    assert "NaN" not in text
    assert "Infinity" not in text
    assert report["rest"]["residual_g_rms"] is None
    assert report["strain_percent"]["warp"]["p99"] is None
    for path in PROMISED:
        value(report, path)
    Console(file=io.StringIO()).print(report_table(report))


def test_what_was_not_measured_has_no_unit() -> None:
    """A garment without seams, in the air."""
    record = dataclasses.replace(run_record(), seam_gap_mm=None)
    report = build_report(record, tube_measures())
    report["pressure_kpa"] |= {"max": None}
    console = Console(width=120, record=True, file=io.StringIO())
    console.print(report_table(report))
    rows = {line.split("│")[1].strip(): line.split("│")[2].strip() for line in console.export_text().splitlines() if line.count("│") > 2}
    assert rows["seam gap at welding"] == "not measured"
    assert rows["pressure"].startswith("max not measured, mean in contact ")
    assert rows["pressure"].endswith(" kPa")


@pytest.mark.parametrize(("drop", "says"), [(12.04, "12.0 mm below where it was placed"), (-30.4, "30.4 mm above where it was placed")])
def test_a_waist_that_rode_up_lies_above_its_place(drop: float, says: str) -> None:
    report = build_report(run_record(), tube_measures()) | {"waist_drop_mm": drop}
    console = Console(width=120, record=True, file=io.StringIO())
    console.print(report_table(report))
    (waist,) = (line.split("│")[2].strip() for line in console.export_text().splitlines() if line.split("│")[1:2] and line.split("│")[1].strip() == "waist")
    assert waist == says


def test_a_record_without_a_promised_key_is_a_fault() -> None:
    with pytest.raises(ValueError, match=r"rest lacks residual_g_rms"):
        build_report(dataclasses.replace(run_record(), rest={"max_speed_m_s": 0.0, "rms_speed_m_s": 0.0, "kinetic_j_per_kg": 0.0}), tube_measures())


def test_table_for_people() -> None:
    console = Console(width=120, record=True, file=io.StringIO())
    console.print(report_table(build_report(run_record(), tube_measures())))
    text = console.export_text()
    figures = ("converged", "2460 particles", "+188.1 mm draped, +146.0 mm on the pattern", "630 mm")
    for expected in (*figures, "0 in the cloth", "an estimate", "uncalibrated"):
        assert expected in text


def test_a_blank_report_has_the_keys_of_every_report() -> None:
    def keys(node: dict, path: str = "") -> set[str]:
        return {item for key, value in node.items() for item in ({f"{path}{key}"} | (keys(value, f"{path}{key}.") if isinstance(value, dict) else set()))}

    own = ("seam_tension.", "constraints.gap_mm.", "constraints.speed_m_s.", "bands.")  # called what the garment calls them
    made = keys(build_report(run_record(), tube_measures()))
    extra = {"versions.numpy", "versions.garmentcad", "energy_j.air"}  # what one run adds
    assert keys(blank_report()) == {key for key in made - extra if not key.startswith(own)}
    json.dumps(blank_report(), allow_nan=False)


def test_the_docs_name_every_key() -> None:
    page = (Path(__file__).resolve().parent.parent / "docs" / "results.md").read_text(encoding="utf-8")
    assert [key for key in blank_report() if f"`{key}`" not in page and f"`{key}." not in page] == []
