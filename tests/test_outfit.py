"""Outfits: what is worn over what, sewn one after the other and draped together; the order holds, and nothing crosses, says who is not the solver."""

from __future__ import annotations

import signal
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path
from typing import Any

import ipctk
import numpy as np
import pytest
from garment_band import BAND, band_spec

from garmentcad.check.examine import examine
from garmentcad.cloth.lattice import build_cloth
from garmentcad.cloth.weld import weld, weld_seams
from garmentcad.errors import CheckpointError, FileError, GarmentError, InputError, TangledError
from garmentcad.export.drape import drape, finish
from garmentcad.io.outfit_file import read_worn
from garmentcad.io.shipped import shipped_file
from garmentcad.pattern.outfit import OutfitSpec, below
from garmentcad.simulation import keeper, run
from garmentcad.simulation.checkpoint import load_state
from garmentcad.simulation.course import CLOSING_OVER_N_M, CLOSING_PULL_N_M, Progress
from garmentcad.simulation.job import Job, make_job
from garmentcad.simulation.materials import lay_out
from garmentcad.simulation.sewing import Welding, close_seams

OUTFIT = """\
schema: 1
units: mm
name: two-bands
mannequin: woman-88
garments:
  - {garment: band.yaml}
  - {garment: belt.yaml, fabric: denim}
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    band_spec(tmp_path)
    # 20 mm longer around than the band below it
    (tmp_path / "belt.yaml").write_text(BAND.replace("name: band", "name: belt").replace("waist / 2 + 10", "waist / 2 + 20"))
    (tmp_path / "outfit.yaml").write_text(OUTFIT)
    return tmp_path


def test_garments_of_an_outfit_keep_their_own_names(folder: Path) -> None:
    job = make_job(folder / "outfit.yaml", grid_mm=30.0)
    assert list(job.pattern.panels) == ["band-front", "band-back", "belt-front", "belt-back"]
    assert [seam.name for seam in job.pattern.seams] == ["band-side_left", "band-side_right", "belt-side_left", "belt-side_right"]
    sheets = {name: job.fabrics[one.fabric or ""].sheet.name for name, one in job.pattern.panels.items()}
    assert sheets == {"band-front": "wool-suiting", "band-back": "wool-suiting", "belt-front": "denim", "belt-back": "denim"}
    inner = below(job.pattern)
    assert list(inner.panels) == ["band-front", "band-back"]
    assert [seam.name for seam in inner.seams] == ["band-side_left", "band-side_right"]


def test_worn_over_each_other(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pulls: list[float] = []

    def close(*given: Any) -> Welding:
        pulls.append(given[4])
        return close_seams(*given)

    monkeypatch.setattr(run, "close_seams", close)
    result = drape(folder / "outfit.yaml", grid_mm=30.0)
    assert pulls == [CLOSING_PULL_N_M, CLOSING_OVER_N_M], "what is put on over something is closed by hand over it"
    assert (result.report["status"], result.report["self_intersections"]) == ("converged", 0)
    cloth, positions = result.cloth, result.state.positions
    mesh = ipctk.CollisionMesh(positions, ipctk.edges(cloth.particle_triangles), cloth.particle_triangles)
    assert not ipctk.has_intersections(mesh, positions)
    worn = [
        np.unique(cloth.vertex_particle[np.isin(cloth.vertex_panel, [k for k, panel in enumerate(cloth.panel_names) if panel.startswith(name)])])
        for name in ("band", "belt")
    ]
    of_triangles = [np.unique(cloth.triangle_layer[np.isin(cloth.particle_triangles, chosen).any(axis=1)]) for chosen in worn]
    assert [layers.tolist() for layers in of_triangles] == [[0], [1]]  # pictures color them apart
    # seen from the axis of the waist the belt lies behind the band, wherever both are
    band = positions[cloth.particle_triangles[np.isin(cloth.particle_triangles, worn[0]).all(axis=1)]]
    axis = positions[worn[0]].mean(axis=0)
    hits = [_hit(np.array([axis[0], place[1], axis[2]]), place, band) for place in positions[worn[1]]]
    behind = np.array([hit for hit in hits if hit < np.inf])
    assert len(behind) > 30
    assert (behind < 1.0).all()


def test_creases_of_what_is_worn_stay_while_more_is_put_on(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """They rest at their angle while the belt closes, and are not ironed a second time: 85 % of 150 degrees stay of wool, not 85 % of the rest as well."""
    points = "    points: {a: [0, 0], b: [waist / 2 + 10, 0], c: [waist / 2 + 10, height], d: [0, height]}\n"
    crease = "    internal_lines: {crease: [[waist / 4, 0], [waist / 4, height]]}\n    folds: [{name: crease, line: crease, angle: 150, pressed: 0.85}]\n"
    assert points in BAND
    (folder / "band.yaml").write_text(BAND.replace(points, points + crease, 1))
    rest: list[tuple[bool, list[float]]] = []
    make = run.make_dynamics

    def made(job: Any, cloth: Any, materials: Any, fold_angles: np.ndarray, *more: Any, **named: Any) -> Any:
        if len(job.worn) > 1:
            rest.append((named.get("dressing", False), np.degrees(fold_angles).tolist()))
        return make(job, cloth, materials, fold_angles, *more, **named)

    monkeypatch.setattr(run, "make_dynamics", made)
    outcome = run.run(make_job(folder / "outfit.yaml", grid_mm=30.0, max_time_s=3.0), lambda progress: None)
    assert [dressing for dressing, _ in rest] == [True, False]
    assert all(angles == pytest.approx([127.5, 127.5]) for _, angles in rest)
    assert np.degrees(outcome.state.fold_angles) == pytest.approx([127.5, 127.5])


def test_nothing_is_put_on_over_what_was_not_sewn(folder: Path) -> None:
    result = drape(folder / "outfit.yaml", grid_mm=30.0, max_time_s=0.02)
    report = result.report
    assert (report["status"], report["welds"], report["self_intersections"]) == ("max_time", 0, 0)
    assert max(report["strain_percent"][way]["max"] for way in ("warp", "weft")) < 5.0, "an open seam is not pulled shut on the way to the next garment"
    open_seams = [warning for warning in report["warnings"] if "did not close" in warning]
    assert any("'band-side_left'" in warning for warning in open_seams)
    assert len(open_seams) == len(set(open_seams))
    assert [warning for warning in report["warnings"] if "worn below" in warning] == [
        "what is worn below ended as max_time before its seams were closed; the outermost garment was only placed"
    ]


class Stopped(Exception):
    pass


def broken_off(job: Job, path: Path, killed: Iterator[bool]) -> None:
    """A run that is killed at one of its looks; the one before is in its checkpoint."""

    def look(progress: Progress) -> None:
        if next(killed):
            raise Stopped

    with pytest.raises(Stopped):
        run.run(job, look, path)


def test_an_outfit_goes_on_from_where_what_is_worn_below_was_broken_off(folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(keeper, "CHECKPOINT_EVERY_S", 0.0)
    job, path = make_job(folder / "outfit.yaml", grid_mm=30.0, max_time_s=3.0), tmp_path / "checkpoint.npz"
    looks: list[Progress] = []
    whole = run.run(job, looks.append)
    below = [first.step > second.step for first, second in pairwise(looks)].index(True) + 1
    assert [look.step for look in looks[below:]] == sorted(look.step for look in looks[below:]), "the band, then the belt over it"
    for seen in (below // 2, below, below + 5):
        broken_off(job, path, iter([False] * seen + [True]))
        again: list[Progress] = []
        outcome = run.run(job, again.append, path, resume=True)
        assert [(look.phase, look.step) for look in again] == [(look.phase, look.step) for look in looks[-len(again) :]]
        assert len(looks) - seen <= len(again) <= len(looks) - seen + 1, "while seams close, a run looks before its first steps, too"
        assert outcome.state.sha256() == whole.state.sha256()
        assert outcome.warnings == whole.warnings
    other = make_job(folder / "outfit.yaml", grid_mm=30.0, seed=1)
    with pytest.raises(CheckpointError, match=r"another run .seed: 0 there, 1 here"):
        run.run(other, lambda progress: None, path, resume=True)


def test_where_a_finer_lattice_was_begun_anew_what_is_worn_below_goes_on_there(folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The lattice of the job alone, though the checkpoint says nothing but what is worn below."""
    monkeypatch.setattr(keeper, "CHECKPOINT_EVERY_S", 0.0)
    monkeypatch.setattr(run, "grids_of", lambda job: (30.0,) if len(job.worn) > 1 else (job.grid_mm,))
    job, path = make_job(folder / "outfit.yaml", grid_mm=24.0, max_time_s=3.0), tmp_path / "checkpoint.npz"
    broken_off(run._worn_below(job, 24.0), path, iter([False, False, True]))
    assert run._saved(job, path) == ((24.0,), None)
    broken_off(run._worn_below(job, 30.0), path, iter([False, False, True]))
    assert run._saved(job, path) == ((30.0,), None)


def test_ctrl_c_after_the_last_look_below_stops_the_outfit(folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    job, path = make_job(folder / "outfit.yaml", grid_mm=30.0, max_time_s=3.0), tmp_path / "checkpoint.npz"
    looks: list[Progress] = []
    measured = run.panels_at_limit

    def pressed(*given: Any) -> dict[str, float]:
        signal.raise_signal(signal.SIGINT)
        return measured(*given)

    monkeypatch.setattr(run, "panels_at_limit", pressed)
    with pytest.raises(keeper.Interrupted, match=r"--resume goes on from .*checkpoint"):
        run.run(job, looks.append, path)
    assert [look.phase for look in looks[-2:]] == ["rest", "close"], "it stops at the first look of the belt"
    assert load_state(path, job.identity).phase == "close"


def test_a_folder_that_cannot_be_written_is_told_before_anything_is_draped(folder: Path) -> None:
    job, looks = make_job(folder / "outfit.yaml", grid_mm=30.0), []
    (folder / "file").write_text("")
    with pytest.raises(FileError, match="cannot be the folder of a result"):
        finish(job, looks.append, folder / "file" / "result")
    assert looks == []


def test_an_older_result_stays_until_the_outermost_garment_is_accepted(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    job, result = make_job(folder / "outfit.yaml", grid_mm=30.0), folder / "result"
    result.mkdir()
    (result / "report.json").write_text("{}")
    looks: list[Progress] = []

    def refuse(*given: Any) -> None:
        if given[-1]:
            raise TangledError("a belt that crosses itself")

    monkeypatch.setattr(run, "refuse_tangled", refuse)
    with pytest.raises(TangledError):
        finish(job, looks.append, result)
    assert looks
    assert [(file.name, file.read_text()) for file in result.iterdir()] == [("report.json", "{}")]


def _hit(eye: np.ndarray, place: np.ndarray, triangles: np.ndarray) -> float:
    """Least part of the way from eye to place, and beyond, at which it goes through one of triangles (T,3,3); infinite where through none."""
    sides = np.stack([triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0], np.broadcast_to(eye - place, triangles[:, 0].shape)], axis=2)
    u, v, way = np.linalg.solve(sides, (eye - triangles[:, 0])[:, :, None])[:, :, 0].T
    return float(way[(u >= 0.0) & (v >= 0.0) & (u + v <= 1.0) & (way > 0.0)].min(initial=np.inf))


def test_some_seams_are_welded_before_others(folder: Path) -> None:
    """The same cloth in two goes as in one."""
    job = make_job(folder / "outfit.yaml", grid_mm=30.0)
    materials, material_of = lay_out(job)
    cloth = build_cloth(job.pattern, material_of, materials, 30.0)
    first, to_first = weld_seams(cloth, ["band-side_left", "band-side_right"])
    assert set(first.stitch_seam) == {2, 3}
    assert first.particle_count == cloth.particle_count - np.isin(cloth.stitch_seam, [0, 1]).sum()
    second, to_second = weld(first)
    at_once, particle = weld(cloth)
    assert (to_second[to_first] == particle).all()
    np.testing.assert_array_equal(second.particle_triangles, at_once.particle_triangles)
    np.testing.assert_allclose(second.masses, at_once.masses, rtol=1e-15)
    assert sorted(map(sorted, second.hinges.corners.tolist())) == sorted(map(sorted, at_once.hinges.corners.tolist()))


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (("{garment: belt.yaml, fabric: denim}", "{garment: band.yaml}"), "two garments are called 'band'"),
        (("{garment: belt.yaml, fabric: denim}", "{garment: bandit.yaml}"), r"outfit\.yaml: garments\.1\.garment: .*bandit\.yaml"),
        (("  - {garment: belt.yaml, fabric: denim}\n", ""), "at least 2 entries are wanted, came 1"),
        (("  - {garment: belt.yaml", "  - {garment: band.yaml}\n" * 5 + "  - {garment: belt.yaml"), "at most 6 entries are wanted, came 7"),
        (("fabric: denim", "fabrik: denim"), "did you mean"),
        (("fabric: denim", "values: {length: true}"), r"garments\.1\.values\.length"),
        (("fabric: denim", 'values: {length: "5"}'), r"garments\.1\.values\.length"),
        (("garment: belt.yaml", "garment: ../belt.yaml"), "refused"),
    ],
)
def test_faults_are_named(folder: Path, change: tuple[str, str], said: str) -> None:
    (folder / "outfit.yaml").write_text(OUTFIT.replace(*change))
    with pytest.raises(GarmentError, match=said):
        make_job(folder / "outfit.yaml")


def test_one_fabric_for_all_is_refused(folder: Path) -> None:
    with pytest.raises(InputError, match="a fabric for each garment"):
        make_job(folder / "outfit.yaml", "denim")


@pytest.mark.parametrize("name", ["over-the-skirt", "tucked-in", "under-the-shirt"])
def test_shipped_outfits_read(name: str) -> None:
    read = read_worn(name)
    assert isinstance(read, tuple)
    assert read == read_worn(shipped_file("outfits", name))
    assert isinstance(read[0], OutfitSpec)


def test_a_misspelt_name_is_looked_for_among_garments_and_outfits() -> None:
    with pytest.raises(GarmentError, match=r"no shipped garment or outfit is called 'tuckd-in'; did you mean 'tucked-in'\?.*straight-skirt"):
        make_job("tuckd-in")


def test_the_doctor_looks_at_every_garment(folder: Path) -> None:
    assert [finding for finding in examine(folder / "outfit.yaml", grid_mm=10.0) if finding.severity == "error"] == []
    (folder / "belt.yaml").write_text((folder / "belt.yaml").read_text().replace("front.right.c, front.right.b", "front.right.b, front.right.c"))
    found = [finding for finding in examine(folder / "outfit.yaml", grid_mm=10.0) if finding.severity == "error"]
    assert {finding.file for finding in found} == {str(folder / "belt.yaml")}
    assert "seam-twisted" in {finding.code for finding in found}
    (refused,) = examine(folder / "outfit.yaml", fabric="denim")
    assert (refused.code, refused.key) == ("refused", "fabric")


@pytest.mark.parametrize(
    ("change", "places"),
    [
        (("fabric: denim", "fabric: denom"), {"garments.1.fabric": "did you mean 'denim'"}),
        (("garment: band.yaml", "garment: band.yaml, fabric: lost.yaml"), {"garments.0.fabric": "does not exist"}),
        (("garment: band.yaml", "garment: band.yaml, values: {hight: 50}"), {"garments.0.values": "no parameter is called 'hight'; did you mean 'height'"}),
        (("garment: band.yaml", "garment: band.yaml, values: {height: 5000}"), {"garments.0.values.height": "came 5000"}),
        (("garment: belt.yaml", "garment: band.yaml"), {"garments": "two garments are called 'band'"}),
        (("mannequin: woman-88", "mannequin: woman-89"), {"mannequin": "did you mean 'woman-88'"}),
    ],
)
def test_the_doctor_names_the_place_in_the_outfit(folder: Path, change: tuple[str, str], places: dict[str, str]) -> None:
    (folder / "band.yaml").write_text(BAND.replace("{value: 60, unit: mm}", "{value: 60, range: [20, 100], unit: mm}"))
    (folder / "outfit.yaml").write_text(OUTFIT.replace(*change))
    errors = [finding for finding in examine(folder / "outfit.yaml", grid_mm=30.0) if finding.severity == "error"]
    assert {(finding.code, finding.file, finding.key) for finding in errors} == {("refused", str(folder / "outfit.yaml"), key) for key in places}
    assert all(places[str(finding.key)] in finding.message for finding in errors)


def test_a_drape_names_the_place_of_a_misspelt_parameter(folder: Path) -> None:
    (folder / "outfit.yaml").write_text(OUTFIT.replace("garment: band.yaml", "garment: band.yaml, values: {hight: 50}"))
    with pytest.raises(GarmentError, match="did you mean 'height'") as caught:
        make_job(folder / "outfit.yaml")
    assert (caught.value.file, caught.value.key) == (str(folder / "outfit.yaml"), "garments.0.values")


def test_the_doctor_takes_the_fabric_of_the_outfit(folder: Path) -> None:
    (folder / "outfit.yaml").write_text(OUTFIT.replace("band.yaml", "knit-top, fabric: cotton-shirting"))
    alone = examine("knit-top", fabric="cotton-shirting", grid_mm=20.0)
    assert [finding.code for finding in alone].count("closure-missing") == 2
    assert [finding for finding in examine(folder / "outfit.yaml", grid_mm=20.0) if finding.file == alone[0].file] == alone


def test_the_doctor_says_where_an_unknown_mannequin_is_named(folder: Path) -> None:
    (folder / "band.yaml").write_text((folder / "band.yaml").read_text().replace("woman-88", "nobody"))
    (own,), (other,) = examine(folder / "band.yaml"), examine("t-shirt", mannequin="nobody")
    assert (own.code, own.file, own.key) == ("refused", str(folder / "band.yaml"), "mannequin")
    assert (other.code, other.file, other.key) == ("refused", None, "mannequin")
