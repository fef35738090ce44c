"""A result folder can be drawn and exported again from its files alone."""

from __future__ import annotations

import json
from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hand_made import cylinder_body, rectangles, tube
from typer.testing import CliRunner

from garmentcad.cli.main import app
from garmentcad.cloth.state import State
from garmentcad.errors import FileError, InputError, TangledError
from garmentcad.export import movement, picture
from garmentcad.export.cloth_file import read_cloth, write_cloth
from garmentcad.export.drape import finish
from garmentcad.export.report import write_report
from garmentcad.export.result_folder import Result, clear_folder, make_folder, read_report, read_result_folder, write_result_folder
from garmentcad.export.side_by_side import Exhibit
from garmentcad.io.npz_file import read_npz
from garmentcad.simulation import run
from garmentcad.simulation.job import make_job
from garmentcad.simulation.movement import Movement


def result() -> Result:
    cloth = rectangles(10, 8, 0.02, 2, sewn=True)
    positions = tube(cloth, 10, 2, lambda row, angle: np.full_like(angle, 0.13), lambda row: 0.7 + 0.02 * row)
    state = State(positions, np.zeros_like(positions), time_s=1.5, step=300)
    maps = {"strain": np.linspace(0.0, 0.02, cloth.particle_count), "pressure": np.zeros(cloth.particle_count)}
    report = {"schema": 1, "garment": "tube", "fabric": "denim", "mannequin": "cylinder", "grid_mm": 20.0, "status": "converged"}
    return Result(report, cloth, state, maps, cylinder_body())


@pytest.fixture
def no_view(monkeypatch: pytest.MonkeyPatch) -> None:
    def missing(name: str):
        raise picture.ViewMissing("pip install garmentcad[view]")

    monkeypatch.setattr(picture, "_module", missing)


def test_round_trip_with_pictures(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("PIL.Image")
    monkeypatch.setattr(picture, "OVERSAMPLING", 1)  # a quarter of the pixels
    given = result()
    written = write_result_folder(tmp_path / "out", given, {"spec": "x"})
    names = {"report.json", "garment.obj", "garment.glb", "mannequin.obj", "state.npz", "cloth.npz", "maps.npz", "front.png", "back.png"}
    assert {path.name for path in written.files} == names == {path.name for path in (tmp_path / "out").iterdir()}
    assert written.files[-1].name == "report.json"
    assert written.notes == ()
    again = read_result_folder(tmp_path / "out")
    assert again.report == given.report
    assert again.state.sha256() == given.state.sha256()
    assert (again.maps["strain"] == given.maps["strain"]).all()
    assert again.mannequin is not None
    assert len(again.mannequin.faces) == len(given.mannequin.faces)
    picture.render_picture(tmp_path / "again.png", again.state.positions, again.cloth, again.mannequin, height_px=200)


def test_cloth_keeps_every_bit(tmp_path: Path) -> None:
    cloth = result().cloth
    again = read_cloth(write_cloth(tmp_path / "cloth.npz", cloth))
    assert again.panel_names == cloth.panel_names
    assert again.seam_names == cloth.seam_names
    assert again.spacing == cloth.spacing
    assert set(again.edge_vertices) == set(cloth.edge_vertices)
    for name, array in cloth.links._asdict().items():
        assert (getattr(again.links, name) == array).all()
        assert getattr(again.links, name).dtype == array.dtype
    assert (again.vertex_uv_mm == cloth.vertex_uv_mm).all()
    assert (again.edge_vertices["front.hem"] == cloth.edge_vertices["front.hem"]).all()
    loose = rectangles(2, 2, 0.01, 1, sewn=False)
    assert read_cloth(write_cloth(tmp_path / "loose.npz", loose)).seam_names == ()


@pytest.mark.usefixtures("no_view")
def test_without_the_extra_a_note_says_so_and_old_pictures_go(tmp_path: Path) -> None:
    (tmp_path / "front.png").write_bytes(b"of an older run")
    written = write_result_folder(tmp_path, result(), {})
    assert not (tmp_path / "front.png").exists()
    assert "garmentcad[view]" in written.notes[0]
    assert (tmp_path / "report.json").exists()


@pytest.mark.usefixtures("no_view")
def test_a_diverged_state_leaves_report_and_state(tmp_path: Path) -> None:
    broken = result()
    broken.state.positions[3] = np.nan
    written = write_result_folder(tmp_path, broken, {})
    assert not (tmp_path / "garment.obj").exists()
    assert "not finite" in written.notes[0]


def test_a_movement_that_diverges_is_judged_up_to_there(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    drawn: list[Exhibit] = []
    monkeypatch.setattr(movement, "edge_roles", lambda pattern: {"waist": ["front.waist"]})
    monkeypatch.setattr(movement, "draw_side_by_side", lambda exhibits, *_: drawn.extend(exhibits))
    monkeypatch.setattr(movement, "write_picture", lambda path, picture: path)
    given, body = result(), cylinder_body()
    frames = np.stack([given.state.positions, given.state.positions - [0.0, 0.01, 0.0], given.state.positions])
    frames[2, 5] = np.nan
    moved = Movement(np.array([0.0, 0.05, 0.1]), frames, np.stack([body.vertices] * 3), given.state, "diverged", "too fast", 2.5)
    report = movement.movement_report(moved, given.cloth, body, None)  # type: ignore[arg-type]
    assert (report["status"], report["seconds"], report["self_intersections"], report["waist_slip_mm"]) == ("diverged", 0.1, 0, 10.0)
    last = {"time_s": 0.1, "self_intersections": None, "mannequin_intersections": None, "mannequin_penetration_mm": None, "waist_slip_mm": None}
    assert report["frames"][2] == last
    assert (report["warning"], report["wall_time_s"]) == ("too fast", 2.5)
    movement.write_movement(tmp_path, moved, given.cloth, body)
    assert [exhibit.title for exhibit in drawn] == ["0.00 s", "0.05 s"]


def test_a_movement_that_crosses_the_body_says_when_and_where(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(movement, "edge_roles", lambda pattern: {})
    given, body = result(), cylinder_body()
    frames = np.stack([given.state.positions] * 4)
    frames[1:3, :, [0, 2]] *= [[[0.119 / 0.13]], [[0.118 / 0.13]]]  # the body's radius is 0.12
    moved = Movement(0.05 * np.arange(4), frames, np.stack([body.vertices] * 4), given.state, "moved", None, 2.5)
    report = movement.movement_report(moved, given.cloth, body, None)  # type: ignore[arg-type]
    assert report["status"] == "intersecting"
    assert report["warning"].startswith("after 0.05 s of the movement the cloth ")
    assert "'front' at (" in report["warning"]
    assert report["mannequin_penetration_mm"] == report["frames"][2]["mannequin_penetration_mm"] > 1.0
    broken = replace(moved, status="diverged", warning="after 0.15 s of the movement: motion ran away")
    told = movement.movement_report(broken, given.cloth, body, None)  # type: ignore[arg-type]
    assert (told["status"], told["warning"]) == ("diverged", f"{report['warning']}; {broken.warning}")


@pytest.mark.usefixtures("no_view")
def test_a_killed_writer_leaves_no_report(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    write_result_folder(tmp_path, result(), {})

    def killed(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr("garmentcad.export.result_folder.write_garment_glb", killed)
    with pytest.raises(KeyboardInterrupt):
        write_result_folder(tmp_path, result(), {})
    assert not (tmp_path / "report.json").exists()
    with pytest.raises(InputError, match=r"report\.json.*not the folder of a finished drape"):
        read_result_folder(tmp_path)


@pytest.mark.usefixtures("no_view")
def test_a_folder_that_is_used_again_is_that_of_no_earlier_drape(tmp_path: Path) -> None:
    write_result_folder(tmp_path, result(), {})
    (tmp_path / "movement").mkdir()
    (tmp_path / "movement" / "frames.npz").write_bytes(b"x")
    (tmp_path / "mine.txt").write_text("kept")
    (tmp_path / ".mine.txt.12.tmp").write_text("kept")
    left = [tmp_path / name for name in (".report.json.4711.tmp", ".state.npz.4711.tmp", ".checkpoint.npz.12.tmp", "movement/.frames.npz.4711.tmp")]
    for path in left:
        path.write_bytes(b"half")
    clear_folder(tmp_path, movement=False)
    assert not any(path.exists() for path in left)
    assert (tmp_path / ".mine.txt.12.tmp").exists()
    assert (tmp_path / "movement" / "frames.npz").exists()
    clear_folder(tmp_path, movement=True)
    assert {path.name for path in tmp_path.rglob("*") if path.is_file()} == {"mine.txt", ".mine.txt.12.tmp", "cloth.npz", "maps.npz", "state.npz"}
    with pytest.raises(InputError, match=r"cannot be the folder of a result"):
        clear_folder(tmp_path / "mine.txt", movement=True)


def test_a_folder_that_takes_no_files_is_refused() -> None:
    """Nobody makes files in /proc, the superuser neither; where there is none, it cannot be made."""
    with pytest.raises(InputError, match=r"/proc: cannot be the folder of a result"):
        make_folder(Path("/proc"))


@pytest.mark.parametrize("resume", [True, False])
def test_a_drape_that_is_refused_leaves_the_older_result(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, resume: bool) -> None:
    """No checkpoint to resume from; panels that cross."""

    def tangled(*_):
        raise TangledError("panels start crossing each other")

    monkeypatch.setattr(run, "refuse_tangled", tangled)
    for name in ("report.json", "garment.obj"):
        (tmp_path / name).write_text("older")
    with pytest.raises(InputError, match="no checkpoint" if resume else "crossing"):
        finish(make_job("straight-skirt", grid_mm=30.0), lambda progress: None, tmp_path, resume)
    assert {path.name: path.read_text() for path in tmp_path.iterdir()} == {"report.json": "older", "garment.obj": "older"}


def test_a_drape_that_has_begun_is_no_longer_the_older_result(tmp_path: Path) -> None:
    def stop(_):
        raise KeyboardInterrupt

    (tmp_path / "report.json").write_text("older")
    with pytest.raises(KeyboardInterrupt):
        finish(make_job("straight-skirt", grid_mm=30.0), stop, tmp_path)
    assert not (tmp_path / "report.json").exists()


def test_packed_arrays_with_a_wrong_byte_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "torn.npz"
    np.savez_compressed(path, a=np.arange(1000.0))
    whole = path.read_bytes()
    for at in range(40, len(whole) - 100, 23):
        path.write_bytes(whole[:at] + bytes([whole[at] ^ 0xFF]) + whole[at + 1 :])
        with suppress(InputError):
            read_npz(path)


def test_arrays_that_say_they_are_too_large_are_not_read(tmp_path: Path) -> None:
    """Ten million zeros pack into a few kilobytes."""
    path = tmp_path / "zeros.npz"
    np.savez_compressed(path, a=np.zeros(10_000_000))
    assert path.stat().st_size < 100_000
    with pytest.raises(InputError, match="80000128 bytes; at most 1000000"):
        read_npz(path, 1_000_000)
    assert read_npz(path)["a"].shape == (10_000_000,)


@pytest.mark.usefixtures("no_view")
@pytest.mark.parametrize("name", ["report.json", "cloth.npz", "state.npz", "maps.npz", "mannequin.obj"])
@pytest.mark.parametrize("damage", ["cut", "empty", "noise"])
def test_torn_files_are_refused_by_name(tmp_path: Path, name: str, damage: str) -> None:
    write_result_folder(tmp_path, result(), {})
    path = tmp_path / name
    content = path.read_bytes()
    path.write_bytes({"cut": content[: len(content) // 2], "empty": b"", "noise": bytes(range(256))}[damage])
    with pytest.raises(InputError, match=name.replace(".", r"\.")):
        read_result_folder(tmp_path)


@pytest.mark.usefixtures("no_view")
def test_files_of_different_runs_are_refused(tmp_path: Path) -> None:
    write_result_folder(tmp_path, result(), {})
    write_cloth(tmp_path / "cloth.npz", rectangles(3, 3, 0.01, 1, sewn=False))
    with pytest.raises(InputError, match="16 particles"):
        read_result_folder(tmp_path)
    (tmp_path / "report.json").write_text(json.dumps([1]))
    with pytest.raises(InputError, match="not a report"):
        read_result_folder(tmp_path)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('"schema": 1', '"schema": 99', "schema: 99 came; this version reads 1"),
        ('"garment": "tube"', '"garment": null', "garment: a text is wanted, came nothing"),
        ('"fabric": "denim"', '"fabric": 3', "fabric: a text is wanted, came 3"),
        ('"mannequin": "cylinder"', '"mannequin": null', "mannequin: a text is wanted, came nothing"),
        ('"grid_mm": 20.0', '"grid_mm": 0', "grid_mm: a number of mm is wanted, came 0"),
        ('"grid_mm": 20.0', '"grid_mm": true', "grid_mm: a number of mm is wanted, came true"),
        ('"status": "converged"', '"state": "converged"', "status: a text is wanted"),
        ('"grid_mm": 20.0', '"grid_mm": "20"', "grid_mm: a number of mm is wanted, came '20'"),
        ('"grid_mm": 20.0', '"grid_mm": null', "grid_mm: a number of mm"),
        ('"grid_mm": 20.0', '"grid_mm": NaN', "NaN is not allowed"),
        ('"grid_mm": 20.0', '"grid_mm": 1e999', "1e999 is not allowed"),
        ('"grid_mm": 20.0', f'"grid_mm": {"9" * 400}', "a whole number of 400 digits"),
        ('"grid_mm": 20.0', '"grid_mm": 20.0, "versions": []', r"versions: a mapping is wanted, came \[\]"),
        ('"grid_mm": 20.0', '"grid_mm": 20.0, "ease_mm": null', "ease_mm: a mapping is wanted, came nothing"),
        ('"grid_mm": 20.0', '"grid_mm": 20.0, "seam_tension": [1]', "seam_tension: a mapping is wanted"),
        ('"grid_mm": 20.0', f'"grid_mm": {"[" * 100_000}', "nested deeper than"),
    ],
)
def test_a_report_that_is_none_is_refused(tmp_path: Path, old: str, new: str, message: str) -> None:
    path = write_report(tmp_path / "report.json", result().report)
    path.write_text(path.read_text().replace(old, new))
    with pytest.raises(FileError, match=rf"report\.json.*{message}"):
        read_report(tmp_path)


@pytest.mark.parametrize(
    ("name", "change", "message"),
    [
        ("triangles", lambda array: array.astype(float), "triangles came as float64"),
        ("triangles", lambda array: array[:, :2], r"triangles came as int32 \(320, 2\)"),
        ("triangles", lambda array: array + 1000, "triangles points outside 0..197"),
        ("triangles", lambda array: np.where(array == 197, array + 1, array), "triangles points outside 0..197"),
        ("panel_layer", lambda array: np.zeros(3, int), r"panel_layer \(panels,\) are wanted"),
        ("vertex_panel", lambda array: np.full_like(array, 2), "vertex_panel points outside 0..1"),
        ("stitch_seam", lambda array: np.array([9]), "stitch_seam points outside"),
        ("hinges.corners", lambda array: np.full((1, 4), 10**6), "hinges.corners points outside"),
        ("triangle_material", lambda array: array[:-1], "triangle_material has 319 rows for 320 triangles"),
        ("masses", lambda array: array[:, None], r"masses \(P,\)"),
        ("vertex_particle", lambda array: array[:-1], "vertex_particle has 197 rows for 198 vertices"),
        ("vertex_uv_mm", lambda array: array.astype(str), "vertex_uv_mm came as <U"),
        ("masses", lambda array: np.full_like(array, np.nan), "masses is not finite"),
        ("stitches", lambda array: np.full((1, 2), 10**6), "stitches points outside"),
        ("links.ends", lambda array: array - 1, "links.ends points outside"),
        ("edge_vertices.front.hem", lambda array: array + 10**6, "edge_vertices.front.hem points outside"),
        ("panel_names", lambda array: np.arange(2), "panel_names came as int64"),
    ],
)
def test_a_cloth_that_is_none_is_refused(tmp_path: Path, name: str, change: Callable[[np.ndarray], np.ndarray], message: str) -> None:
    path = write_cloth(tmp_path / "cloth.npz", result().cloth)
    with np.load(path) as file:
        arrays = dict(file)
    np.savez(path, **arrays | {name: change(arrays[name])})
    with pytest.raises(FileError, match=rf"cloth\.npz.*{message}"):
        read_cloth(path)


@pytest.mark.usefixtures("no_view")
@pytest.mark.parametrize("values", [np.full(180, np.nan), np.full(180, "x"), np.zeros(180, int)])
def test_a_map_of_no_numbers_is_refused(tmp_path: Path, values: np.ndarray) -> None:
    write_result_folder(tmp_path, result(), {})
    np.savez(tmp_path / "maps.npz", strain=values)
    with pytest.raises(FileError, match=r"maps\.npz: strain came as .*; finite numbers are wanted"):
        read_result_folder(tmp_path)


@pytest.mark.usefixtures("no_view")
def test_a_map_of_another_cloth_is_refused(tmp_path: Path) -> None:
    write_result_folder(tmp_path, result(), {})
    np.savez(tmp_path / "maps.npz", strain=np.zeros(179))
    with pytest.raises(FileError, match=r"maps\.npz: strain has shape \(179,\) where cloth\.npz has 180 particles"):
        read_result_folder(tmp_path)


def test_a_file_in_place_of_the_folder_is_refused(tmp_path: Path) -> None:
    path = write_report(tmp_path / "report.json", result().report)
    with pytest.raises(FileError, match=r"report\.json: is a file; the folder of a finished drape is wanted"):
        read_report(path)


@pytest.mark.usefixtures("no_view")
@pytest.mark.parametrize("command", [("render", "x.png"), ("export", "x.png"), ("export", "x.obj"), ("export", "x.glb")])
def test_what_diverged_has_no_shape_to_draw(tmp_path: Path, command: tuple[str, str]) -> None:
    broken = result()
    broken.state.positions[3] = np.nan
    broken.report["status"] = "diverged"
    write_result_folder(tmp_path / "out", broken, {})
    made = tmp_path / command[1]
    said = CliRunner().invoke(app, [command[0], str(tmp_path / "out"), "-o", str(made)])
    assert isinstance(said.exception, FileError)  # `main.run` makes it exit code 2
    assert "state.npz: positions are not finite: this run ended as diverged" in str(said.exception)
    assert not made.exists()


@pytest.mark.usefixtures("no_view")
def test_files_of_two_drapes_in_one_folder_are_refused(tmp_path: Path) -> None:
    given = result()
    report = given.report | {"state_sha256": given.state.sha256()}
    write_result_folder(tmp_path, Result(report, given.cloth, given.state, given.maps, given.mannequin), {})
    assert read_result_folder(tmp_path).report == report
    write_report(tmp_path / "report.json", report | {"state_sha256": 64 * "0"})
    with pytest.raises(FileError, match=r"state\.npz: is the end of another drape than report\.json tells of"):
        read_result_folder(tmp_path)
    (tmp_path / "state.npz").unlink()
    with pytest.raises(FileError, match=r"state\.npz: no such file: the folder of this drape is not whole"):
        read_result_folder(tmp_path)


@pytest.mark.parametrize(
    ("changed", "says"),
    [
        ({"hem_height_mm": "x"}, "hem_height_mm: a number or null is wanted, came 'x'"),
        ({"ease_mm": {"hip": "85"}}, r"ease_mm\.hip: a number or null is wanted, came '85'"),
        ({"mass_kg": True}, "mass_kg: a number or null is wanted, came true"),
        ({"seam_tension": {"side": {"max_n_m": [1.0]}}}, r"seam_tension\.side\.max_n_m: a number or null is wanted"),
    ],
)
def test_a_report_with_values_of_another_kind_is_refused(changed: dict[str, object], says: str, tmp_path: Path) -> None:
    whole = result().report | {
        "warnings": ["seam"],
        "uncalibrated": True,
        "versions": {"numpy": "2"},
        "constraints": {"conflicting": ["side"], "max_gap_mm": None},
    }
    write_report(tmp_path / "report.json", whole)
    assert read_report(tmp_path) == whole
    write_report(tmp_path / "report.json", whole | changed)
    with pytest.raises(FileError, match=says):
        read_report(tmp_path)
