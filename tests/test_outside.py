"""What is put on over others begins outside them: sections of the placed panels against polygons, by shapely."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import shapely
from garment_band import BAND, band_spec

from garmentcad.cloth.cloth import Cloth
from garmentcad.cloth.lattice import build_cloth
from garmentcad.mannequin.mannequin import ArrangementCylinder
from garmentcad.pattern.pattern import Wrap
from garmentcad.placement.outside import CLEAR_M, around_worn, outside
from garmentcad.placement.place import place_vertices
from garmentcad.simulation.job import Job, make_job
from garmentcad.simulation.materials import lay_out


@pytest.fixture
def outfit(tmp_path: Path) -> tuple[Job, Cloth]:
    band_spec(tmp_path)
    # the back on the cylinder's own ellipses, the front on others
    belt = BAND.replace("name: band", "name: belt").replace("scale: waist / hip, offset: 30", "scale: 0.9, offset: 80", 1).replace("scale: waist / hip, ", "")
    (tmp_path / "belt.yaml").write_text(belt)
    garments = "schema: 1\nunits: mm\nname: both\nmannequin: woman-88\ngarments: [{garment: band.yaml}, {garment: belt.yaml}]\n"
    (tmp_path / "both.yaml").write_text(garments)
    job = make_job(tmp_path / "both.yaml", grid_mm=30.0)
    materials, material_of = lay_out(job)
    return job, build_cloth(job.pattern, material_of, materials, 30.0)


def ellipse(cylinder: ArrangementCylinder, farther_m: float, scale: float = 1.0) -> np.ndarray:
    """(360,2) m, seen along the axis."""
    turn = np.radians(np.arange(360))
    return scale * np.column_stack([(cylinder.radius_ref + farther_m) * np.cos(turn), (cylinder.radius_side + farther_m) * np.sin(turn)])


def seen_along(cylinder: ArrangementCylinder, points: np.ndarray) -> np.ndarray:
    away = points - cylinder.origin
    return np.column_stack([away @ cylinder.ref, away @ np.cross(cylinder.up, cylinder.ref)])


@pytest.mark.parametrize("farther", [-0.05, 0.0, 0.03, 0.4])
def test_points_on_a_wider_ellipse_are_so_much_outside(farther: float) -> None:
    up, ref = np.array([0.6, 0.8, 0.0]), np.array([0.8, -0.6, 0.0])
    cylinder = ArrangementCylinder(np.array([0.1, 1.2, 0.3]), up, ref, 0.14, 0.23)
    flat = ellipse(cylinder, farther)
    points = cylinder.origin + 0.7 * up + flat[:, :1] * ref + flat[:, 1:] * np.cross(up, ref)
    np.testing.assert_allclose(outside(cylinder, points), farther, atol=1e-10)


WORN = ("band-front", "band-back")


def hung(job: Job, cloth: Cloth, placed: np.ndarray, height_m: float, farther_m: float) -> np.ndarray:
    """The vertices (V,3), with the band as a hoop around the torso."""
    cylinder, moved = job.mannequin.cylinders["torso"], placed.copy()
    mine = np.isin(np.array(cloth.panel_names)[cloth.vertex_panel], WORN)
    ref, side = seen_along(cylinder, placed[mine]).T
    turn = np.arctan2(side / cylinder.radius_side, ref / cylinder.radius_ref)[:, None]
    flat = (cylinder.radius_ref + farther_m) * np.cos(turn) * cylinder.ref
    flat = flat + (cylinder.radius_side + farther_m) * np.sin(turn) * np.cross(cylinder.up, cylinder.ref)
    moved[mine] = cylinder.origin + height_m * cylinder.up + flat
    return moved


def test_the_outer_garment_begins_just_outside_what_hangs_at_its_height(outfit: tuple[Job, Cloth]) -> None:
    job, cloth = outfit
    placed = place_vertices(job.pattern, cloth, job.mannequin)
    names = np.array(cloth.panel_names)[cloth.vertex_panel]
    cylinder = job.mannequin.cylinders["torso"]
    made = around_worn(job.pattern, cloth, hung(job, cloth, placed, placed[names == "belt-back", 1].mean(), 0.06), job.mannequin, WORN)
    moved = place_vertices(made, cloth, job.mannequin)
    section = seen_along(cylinder, moved[names == "belt-back"])
    clear = shapely.Polygon(ellipse(cylinder, 0.06 + CLEAR_M - 1e-4)), shapely.Polygon(ellipse(cylinder, 0.06 + CLEAR_M + 1e-3))
    assert not shapely.contains_xy(clear[0], *section.T).any()
    assert shapely.contains_xy(clear[1], *section.T).any(), "no farther out than it must"
    assert (moved[names == "band-front"] == placed[names == "band-front"]).all()
    # front and back keep their order: both radii of both have grown alike
    rules = [[one.panels[f"belt-{side}"].placement for one in (job.pattern, made)] for side in ("front", "back")]
    grown = [after.scale * (after.offset_mm - before.offset_mm) for before, after in rules if isinstance(before, Wrap) and isinstance(after, Wrap)]
    assert grown[0] == pytest.approx(grown[1])
    assert grown[0] > 10.0


def test_it_begins_as_drafted_where_nothing_is_in_its_way(outfit: tuple[Job, Cloth]) -> None:
    job, cloth = outfit
    placed = place_vertices(job.pattern, cloth, job.mannequin)
    height = placed[np.array(cloth.panel_names)[cloth.vertex_panel] == "belt-back", 1].min()
    for down, out in ((0.02, 0.2), (-0.03, -0.05)):
        assert around_worn(job.pattern, cloth, hung(job, cloth, placed, height - down, out), job.mannequin, WORN) == job.pattern
    # on another part of the body
    panels = dict(job.pattern.panels)
    for name in WORN:
        rule = panels[name].placement
        assert isinstance(rule, Wrap)
        panels[name] = replace(panels[name], placement=replace(rule, part="neck"))
    elsewhere = replace(job.pattern, panels=panels)
    assert around_worn(elsewhere, cloth, hung(job, cloth, placed, height + 0.03, 0.2), job.mannequin, WORN) == elsewhere


def test_cloth_between_vertices_that_lie_above_and_below_counts(outfit: tuple[Job, Cloth]) -> None:
    job, cloth = outfit
    placed = place_vertices(job.pattern, cloth, job.mannequin)
    names = np.array(cloth.panel_names)[cloth.vertex_panel]
    belt, lowest = placed[names == "belt-back", 1], np.isin(names, WORN) & (placed[:, 1] < placed[np.isin(names, WORN), 1].min() + 0.01)
    for below, changed in ((-0.1, True), (0.1, False)):
        hoop = hung(job, cloth, placed, belt.mean() + 0.1, 0.06)
        hoop[lowest, 1] = belt.mean() + below
        assert (around_worn(job.pattern, cloth, hoop, job.mannequin, WORN) != job.pattern) == changed
