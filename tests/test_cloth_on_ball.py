"""Workload W1 is what docs/bench.md says, down to the values that the kernels read, and comes to rest."""

from __future__ import annotations

import numpy as np
import pytest

from garmentcad.bench import cases, cloth_on_ball
from garmentcad.bench.cases import case_job, case_names, run_case
from garmentcad.cloth.lattice import build_cloth
from garmentcad.errors import InputError
from garmentcad.fabric.law_tension import loading
from garmentcad.placement.place import place_vertices
from garmentcad.simulation.materials import lay_out
from garmentcad.simulation.record import record

GRID_MM = 50.0


def test_laws_are_linear_in_the_stated_stiffnesses() -> None:
    materials, _ = lay_out(cloth_on_ball.cloth_on_ball(GRID_MM))
    for way in (0, 1):
        law = (materials.tension_strain[0, way], materials.tension_force[0, way], materials.tension_exponent[0, way], materials.tension_slope[0, way])
        for strain in (-0.05, 1e-4, 0.01, 0.2, 0.3):
            assert loading(strain, *law) == pytest.approx((2000.0 * strain, 2000.0), rel=1e-9)
    assert materials.shear[0] == pytest.approx(50.0, rel=1e-12)
    assert materials.bending[0] == pytest.approx([1e-5, 1e-5], rel=1e-12)
    for name in ("tension_friction", "shear_friction", "bending_friction", "twist_friction"):
        assert not getattr(materials, name).any()
    assert 4.0 * materials.twist[0] == pytest.approx(2.0e-5, rel=1e-12)  # bends alike in every direction
    assert (materials.thickness[0], materials.friction_body[0]) == pytest.approx((0.003, 0.3))


def test_cloth_weighs_its_area_and_lies_level_above_the_ball() -> None:
    job = cloth_on_ball.cloth_on_ball(GRID_MM)
    materials, material_of = lay_out(job)
    cloth = build_cloth(job.pattern, material_of, materials, job.grid_mm)
    assert cloth.particle_count == 21 * 21
    assert cloth.masses.sum() == pytest.approx(1.0 * 0.15, rel=1e-12)
    positions = place_vertices(job.pattern, cloth, job.mannequin)
    top = job.mannequin.vertices[:, 1].max()
    assert np.allclose(positions[:, 1] - top, 0.0035, atol=1e-12)  # the ball is drawn 1.5 mm larger
    assert np.allclose(positions[:, [0, 2]].min(axis=0), -0.5)
    assert np.allclose(positions[:, [0, 2]].max(axis=0), 0.5)
    assert cloth_on_ball.mean_height_mm(positions) == pytest.approx(255.0)


def test_ball_is_round_and_closed() -> None:
    body = cloth_on_ball.ball()
    assert np.linalg.norm(body.vertices - [0.0, 1.0, 0.0], axis=1) == pytest.approx(np.full(len(body.vertices), 0.2515), rel=1e-12)
    edges = np.sort(np.vstack([body.faces[:, [0, 1]], body.faces[:, [1, 2]], body.faces[:, [2, 0]]]), axis=1)
    assert (np.unique(edges, axis=0, return_counts=True)[1] == 2).all()
    corners = body.vertices[body.faces] - [0.0, 1.0, 0.0]
    assert (np.einsum("fk,fk->f", np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), corners.mean(axis=1)) > 0.0).all()


def test_case_without_seams_comes_to_rest_clean(monkeypatch: pytest.MonkeyPatch) -> None:
    measured = []
    monkeypatch.setattr(cases, "record", lambda outcome: measured.append(record(outcome)) or measured[-1])
    row = run_case(case_job(cloth_on_ball.NAME, GRID_MM, "denim", 0), lambda progress: None)
    assert (row["status"], row["self_intersections"], row["penetration_mm"]) == ("converged", 0, 0.0)
    strains = {way: values["p99"] for way, values in measured[0][1].strain_percent.items()}
    assert row["strain_p99_percent"] == max(strains["warp"], strains["weft"]) < strains["bias"]
    assert row["us_per_step"] == pytest.approx(1e6 * row["drape_wall_s"] / row["steps"])
    assert 0.5 < sum(row["share"].values()) <= 1.0
    # a coarse lattice is stiff against folds and stands off the ball a little more than the 7 to 10 mm of a fine one
    assert 5.0 < row["mean_height_mm"] < 25.0


def test_garments_are_cases_and_others_are_refused() -> None:
    assert set(case_names()) >= {"cloth-on-ball", "flared-skirt", "straight-skirt", "t-shirt"}
    job = case_job("t-shirt", 20.0, "denim", 3)
    assert (job.pattern.name, job.fabrics[job.pattern.fabric].sheet.name, job.grid_mm, job.seed) == ("t-shirt", "denim", 20.0, 3)
    own = case_job("knit-top", 20.0, None, 0)
    assert own.fabrics[own.pattern.fabric].sheet.name == own.spec.fabric == "interlock-knit"
    with pytest.raises(InputError, match="cloth-on-ball"):
        case_job("cloth-on-bal", 10.0, "denim", 0)
    with pytest.raises(InputError, match="2 to 50 mm"):
        case_job("cloth-on-ball", 1.0, "denim", 0)
