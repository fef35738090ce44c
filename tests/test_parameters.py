"""Other values of a garment's parameters: in Python and on the command line."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from garmentcad.check.examine import examine
from garmentcad.cli.named import by_option, named_numbers, option_of
from garmentcad.cloth.state import State
from garmentcad.errors import CheckpointError, FileError, InputError, SpecError
from garmentcad.export.drape import drape
from garmentcad.io.fabric_file import read_fabric, write_fabric
from garmentcad.io.mannequin_file import read_mannequin
from garmentcad.io.shipped import shipped_file
from garmentcad.io.spec_file import read_spec, write_spec
from garmentcad.mannequin.mannequin import Mannequin
from garmentcad.pattern.draft import draft
from garmentcad.simulation.checkpoint import load_state, save_state
from garmentcad.simulation.job import make_job


def test_a_value_changes_the_draft_and_what_a_checkpoint_agrees_with() -> None:
    short, long = make_job("straight-skirt"), make_job("straight-skirt", values={"length": 700.0})
    drafted = draft(short.spec, short.mannequin.measurements_mm, {"length": 700.0})  # type: ignore[arg-type]
    lowest = [min(edge.curve.polyline(1.0)[:, 1].min() for edge in pattern.panels["front"].edges) for pattern in (short.pattern, long.pattern, drafted)]
    assert lowest[0] - lowest[1] == pytest.approx(700.0 - short.pattern.values["length"])
    assert lowest[1] == lowest[2]
    assert short.identity["spec"] != long.identity["spec"]


def test_a_checkpoint_of_another_fabric_is_refused_by_the_names_of_both(tmp_path: Path) -> None:
    """Not by the spec's own, in whose place the other one stands."""
    own, other = make_job("straight-skirt"), make_job("straight-skirt", fabric="denim")
    save_state(tmp_path / "c.npz", State(np.zeros((1, 3)), np.zeros((1, 3))), own.identity)
    with pytest.raises(CheckpointError, match=r"another run \(fabric: wool-suiting [0-9a-f]{64} there, denim [0-9a-f]{64} here\)"):
        load_state(tmp_path / "c.npz", other.identity)


def test_a_checkpoint_agrees_with_law_values_and_fibre_of_a_fabric() -> None:
    """Calibration is written into the same file, and a fold keeps what its fibre takes: a drape that went on with others would be none of either."""
    job = make_job("straight-skirt")
    sheet = job.fabrics["wool-suiting"].sheet
    assert sheet.law is not None
    sheets = sheet, sheet.model_copy(update={"law": None}), sheet.model_copy(update={"fibre": "cotton"})
    law = sheet.law.model_copy(update={"values": {key: 1.01 * value for key, value in sheet.law.values.items()}})
    stale = sheet.model_copy(update={"law": sheet.law.model_copy(update={"sheet_sha256": "0" * 64})})  # of other numbers: no drape reads it
    made = [make_job("straight-skirt", fabric=one).identity for one in (*sheets, sheet.model_copy(update={"law": law}), stale)]
    assert made[0] == job.identity
    assert len({one["fabric"] for one in made}) == 4
    assert made[4] == made[1]


def test_a_checkpoint_of_other_parameters_is_refused_without_hashes(tmp_path: Path) -> None:
    save_state(tmp_path / "c.npz", State(np.zeros((1, 3)), np.zeros((1, 3))), make_job("straight-skirt").identity)
    with pytest.raises(CheckpointError, match=r"another run \(grid_mm: 10 there, 20 here, spec: the garment, or a parameter that was set, is another one\)"):
        load_state(tmp_path / "c.npz", make_job("straight-skirt", grid_mm=20, values={"length": 700.0}).identity)


def test_a_checkpoint_agrees_with_where_the_body_has_its_landmarks_and_cylinders() -> None:
    job = make_job("straight-skirt")
    body = job.mannequin
    raised = {**body.landmarks, "nape": body.landmarks["nape"] + [0.0, 1e-3, 0.0]}
    wider = {**body.cylinders, "torso": replace(body.cylinders["torso"], radius_side=body.cylinders["torso"].radius_side + 1e-3)}
    bodies = body, replace(body, landmarks=raised), replace(body, cylinders=wider), replace(body, faces=np.roll(body.faces, 1, axis=0))
    assert len({replace(job, mannequin=one).identity["mannequin"] for one in bodies}) == 4
    assert replace(job, mannequin=replace(body)).identity == job.identity


def test_a_name_that_is_no_parameter_and_a_value_out_of_range_are_refused() -> None:
    with pytest.raises(SpecError, match="no parameter is called 'lenght'; did you mean 'length'"):
        make_job("straight-skirt", values={"lenght": 700.0})
    worked_out = next(iter(read_spec("straight-skirt").values))
    with pytest.raises(SpecError, match=f"values.{worked_out}: '{worked_out}' is worked out from parameters"):
        make_job("straight-skirt", values={worked_out: 1.0})
    (finding,) = examine("straight-skirt", values={"length": 7000.0})
    assert (finding.severity, finding.key) == ("error", "parameters.length.value")
    with pytest.raises(InputError, match="for each garment"):
        make_job("tucked-in", values={"length": 700.0})


def test_a_mode_that_is_none_is_refused() -> None:
    with pytest.raises(InputError, match="mode: mode 'drapee'; drape or dynamics is allowed"):
        make_job("straight-skirt", mode="drapee")  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"seed": 1.5}, "seed: seed 1.5; a whole number from 0 to"),
        ({"seed": "1"}, "seed: seed '1'"),
        ({"seed": True}, "seed: seed true"),
        ({"seed": 1 << 63}, "seed: seed 9223372036854775808; a whole number from 0 to 2.63 - 1"),
        ({"grid_mm": "20"}, "grid_mm: a number of mm is wanted, came '20'"),
        ({"grid_mm": None}, "grid_mm: .*came nothing"),
        ({"grid_mm": 10**400}, "grid_mm: a number of mm"),
        ({"max_time_s": "3"}, "max_time_s: a number of simulated seconds is wanted, came '3'"),
        ({"values": {"length": None}}, "values.length: a number is wanted, came nothing"),
        ({"values": {1: 2}}, "values: a mapping of parameter names"),
        ({"values": [1]}, "values: a mapping of parameter names"),
        ({"fabric": 3}, "fabric: a name, a file or a KesSheet is wanted, came 3"),
        ({"mannequin": {}}, "mannequin: a name, a file or a Mannequin is wanted"),
        ({"pose": 1.0}, "pose: a name or a file is wanted"),
        ({"spec": None}, "spec: a garment is a shipped name, a file or a GarmentSpec, came nothing"),
        ({"spec": {"schema": 1}}, "spec: a garment is"),
    ],
)
def test_arguments_of_another_kind_are_refused(given: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        make_job(**{"spec": "straight-skirt"} | given)


def test_a_pose_that_is_too_fast_is_refused_before_anything_is_draped(tmp_path: Path) -> None:
    (tmp_path / "fast.yaml").write_text("schema: 1\nframes:\n  - {time: 0.1, ahead: 1500}\n")
    with pytest.raises(InputError, match=r"pose: the body goes 16\.4\d m/s between 0\.0125 and 0\.025 s; at most 10 m/s"):
        make_job("straight-skirt", pose=tmp_path / "fast.yaml")


def spoiled(body: Mannequin, what: str) -> Mannequin:
    vertices, faces = body.vertices.copy(), body.faces.copy()
    if what == "nan":
        vertices[100] = np.nan
    if what == "mm":
        vertices *= 1000.0
    if what == "names":
        faces[7, 1] = len(vertices)
    if what == "open":
        return replace(body, faces=faces[:-1000], face_part=body.face_part[:-1000])
    return replace(body, vertices=vertices, faces=faces, face_part=body.face_part[1:] if what == "parts" else body.face_part)


@pytest.mark.parametrize(
    ("what", "message"),
    [
        ("nan", "a vertex is not finite"),
        ("mm", r"it is 16\d\d m high; 0\.5 to 2\.5 m are allowed"),
        ("names", "a face names vertex"),
        ("open", "its surface is not closed"),
        ("parts", r"face_part \(20465,\) came; one part for each of 20466 faces is wanted"),
    ],
)
def test_a_body_made_by_hand_that_is_none_is_refused(what: str, message: str) -> None:
    body = spoiled(read_mannequin("woman-88"), what)
    with pytest.raises(InputError, match=f"mannequin: {message}"):
        make_job("straight-skirt", mannequin=body)
    (finding,) = examine("straight-skirt", body)
    assert (finding.severity, finding.key) == ("error", "mannequin")


def test_another_body_of_the_same_surface_is_another_run() -> None:
    """Its pattern is drafted by other measurements."""
    body = read_mannequin("woman-88")
    other = replace(body, measurements_mm=body.measurements_mm | {"hip": body.measurements_mm["hip"] + 4.0})
    one, two = (make_job("straight-skirt", mannequin=worn).identity for worn in (body, other))
    assert {key for key in one if one[key] != two[key]} == {"mannequin"}


def test_an_empty_folder_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """It would be the working folder, from which a drape takes away older results."""
    monkeypatch.chdir(tmp_path)
    Path("front.png").write_text("mine")
    with pytest.raises(InputError, match="folder: an empty text came"):
        drape("straight-skirt", folder="")
    assert Path("front.png").read_text() == "mine"
    with pytest.raises(InputError, match="folder: a name or a file is wanted, came 5"):
        drape("straight-skirt", folder=5)  # type: ignore[arg-type]


def test_a_sheet_and_a_body_are_examined_as_their_names_are() -> None:
    """A knit top in denim does not pass the head: the same findings for names and for what they stand for. A sheet that cannot be completed is one."""
    sheet, body = read_fabric("denim"), read_mannequin("man-116")
    named = examine("knit-top", "man-116", fabric="denim")
    assert [str(finding) for finding in named]
    assert examine("knit-top", body, fabric=sheet) == named
    (finding,) = examine("knit-top", body, fabric=sheet.model_copy(update={"W": None, "law": None}))
    assert (finding.severity, finding.key) == ("error", "fabric")


@pytest.mark.parametrize(
    ("given", "key", "says"),
    [
        ({"spec": 42}, "spec", "came 42"),
        ({"spec": None}, "spec", "a garment is a shipped name, a file or a GarmentSpec, came nothing"),
        ({"mannequin": 42}, "mannequin", "came 42"),
        ({"fabric": 42}, "fabric", "a name, a file or a KesSheet is wanted, came 42"),
        ({"values": 42}, "values", "came 42"),
        ({"values": {"length": "x"}}, "values.length", "came 'x'"),
        ({"grid_mm": "x"}, "grid_mm", "came 'x'"),
    ],
)
def test_the_doctor_finds_arguments_of_another_kind(given: dict[str, Any], key: str, says: str) -> None:
    (finding,) = examine(**{"spec": "straight-skirt"} | given)
    assert (finding.severity, finding.key) == ("error", key)
    assert says in finding.message


@pytest.mark.parametrize(
    ("call", "says"),
    [
        (lambda: read_spec(None), "spec: a name or a file is wanted, came nothing"),  # type: ignore[arg-type]
        (lambda: read_fabric(42), "fabric: a name or a file is wanted, came 42"),  # type: ignore[arg-type]
        (lambda: write_spec("x", "y"), "spec: a GarmentSpec is wanted, came 'x'"),  # type: ignore[arg-type]
        (lambda: write_spec(read_spec("straight-skirt"), 42), "path: a name or a file is wanted, came 42"),  # type: ignore[arg-type]
        (lambda: write_spec(read_spec("straight-skirt"), ""), "is a folder; a file is wanted"),
        (lambda: write_spec(read_spec("straight-skirt"), "x.txt"), r"x\.txt: cannot write '\.txt'; allowed are \.yaml, \.yml"),
        (lambda: write_fabric(read_fabric("denim"), "d.csv"), r"d\.csv: cannot write '\.csv'; allowed are \.yaml, \.yml"),
        (lambda: write_fabric("denim.yaml", read_fabric("denim")), "sheet: a KesSheet is wanted, came 'denim.yaml'"),  # type: ignore[arg-type]
        (lambda: write_fabric(read_fabric("denim"), 42), "path: a name or a file is wanted, came 42"),  # type: ignore[arg-type]
        (lambda: read_mannequin(None), "mannequin: a name or a file is wanted, came nothing"),  # type: ignore[arg-type]
        (lambda: draft("straight-skirt", {}), "spec: a GarmentSpec is wanted, as read_spec reads it, came 'straight-skirt'"),  # type: ignore[arg-type]
        (lambda: draft(read_spec("straight-skirt"), None), "measurements_mm: a mapping of names to numbers is wanted, came nothing"),  # type: ignore[arg-type]
        (lambda: draft(read_spec("straight-skirt"), {}, 5), "values: a mapping of names to numbers is wanted, came 5"),  # type: ignore[arg-type]
    ],
)
def test_what_is_no_spec_sheet_or_file_is_neither_read_nor_written(call: Callable[[], object], says: str) -> None:
    with pytest.raises(InputError, match=says):
        call()


def test_a_fabric_may_be_a_path() -> None:
    by_file = make_job("straight-skirt", fabric=shipped_file("fabrics", "denim"), grid_mm=np.float32(30.0), seed=np.int64(2))  # type: ignore[arg-type]
    assert by_file.identity == make_job("straight-skirt", "denim", grid_mm=30.0, seed=2).identity


@pytest.mark.parametrize(
    ("old", "new", "key"),
    [
        ("mannequin: woman-88", "mannequin: woman-89", "mannequin"),
        ("fabric: wool-suiting", "fabric: tweed", "fabric"),
        ("    points:\n", "    fabric: tweed\n    points:\n", "panels.front.fabric"),
    ],
)
def test_what_a_spec_names_and_is_not_there_is_refused_with_file_and_key(tmp_path: Path, old: str, new: str, key: str) -> None:
    path, text = tmp_path / "mine.yaml", shipped_file("patterns", "straight-skirt").read_text()
    assert old in text
    path.write_text(text.replace(old, new, 1))
    with pytest.raises(FileError, match=rf"mine\.yaml: {key}: no shipped file"):
        make_job(path)


@pytest.mark.parametrize(
    ("words", "message"), [(["a"], "NAME=NUMBER"), (["a=x"], "NAME=NUMBER"), (["a=nan"], "NAME=NUMBER"), (["a=1", "a=2"], "twice"), (["=2"], "NAME")]
)
def test_words_that_are_no_named_numbers(words: list[str], message: str) -> None:
    with pytest.raises(InputError, match=message):
        named_numbers(words, "--set")
    assert named_numbers(["a=1", "b=-2.5"], "--set") == {"a": 1.0, "b": -2.5}


def test_every_fault_of_a_file_is_a_finding(tmp_path: Path) -> None:
    """And the exception, where one is raised, names the first and counts the rest."""
    path = tmp_path / "two.yaml"
    text = shipped_file("patterns", "straight-skirt").read_text().replace("role: hem", "role: hm", 1).replace("mannequin: woman-88", "mannequin: 88", 1)
    path.write_text(text)
    assert [finding.key for finding in examine(str(path)) if finding.code == "refused"] == ["mannequin", "panels.front.edges.1.role"]
    with pytest.raises(SpecError, match=r"and 1 more fault\)"):
        read_spec(path)


def test_a_garment_is_read_by_its_name() -> None:
    assert read_spec("straight-skirt") == read_spec(shipped_file("patterns", "straight-skirt"))
    with pytest.raises(FileError, match="did you mean 'straight-skirt'"):
        read_spec("strait-skirt")


@pytest.mark.parametrize(
    ("key", "file", "told"),
    [
        ("grid_mm", None, "--grid"),
        ("values.length", None, "--set length"),
        ("mannequin", None, "--mannequin"),
        ("mannequin", "a.yaml", "mannequin"),
        ("panels.front", None, "panels.front"),
        (None, None, None),
    ],
)
def test_the_command_line_tells_an_argument_by_its_option(key: str | None, file: str | None, told: str | None) -> None:
    """The library names arguments; a key of a file is that of the file."""
    assert option_of(key, file) == told
    assert by_option(InputError("m", file=file, key=key)).key == told
