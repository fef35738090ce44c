"""The command line as a script sees it: exit codes, one JSON object, bad input refused at once without a traceback."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import numba
import pytest
from command import garmentcad, garmentcad_here
from test_bad_input import CASES, Case, place

from garmentcad.errors import InputError
from garmentcad.io.mannequin_file import read_mannequin


def test_help_and_version_answer() -> None:
    assert "drape" in garmentcad("--help").stdout
    assert garmentcad("--version").stdout.strip() == "0.1.0"


def test_lists_name_what_is_shipped(tmp_path: Path) -> None:
    assert "cotton-shirting" in garmentcad("fabric", "list", folder=tmp_path).stdout
    assert "woman-88" in garmentcad("mannequin", "list", folder=tmp_path).stdout


def test_json_prints_one_object_and_nothing_else(tmp_path: Path) -> None:
    for arguments in (("check", "flared-skirt", "--json"), ("fabric", "show", "denim", "--json"), ("mannequin", "show", "man-100", "--json")):
        run = garmentcad(*arguments, folder=tmp_path)
        assert run.returncode == 0, run.stderr
        assert isinstance(json.loads(run.stdout), dict)


def test_a_mannequin_shows_the_cylinders_that_panels_are_wrapped_on(tmp_path: Path) -> None:
    lines = garmentcad("mannequin", "show", "woman-88", folder=tmp_path).stdout.splitlines()
    torso = read_mannequin("woman-88").cylinders["torso"]
    front, side = 1000.0 * torso.radius_ref, 1000.0 * torso.radius_side
    assert [line.split()[2:] for line in lines if line.startswith("cylinder torso")] == [f"{front:.1f} mm radius at the angle 0, {side:.1f} mm at 90".split()]
    nape = 1000.0 * read_mannequin("woman-88").landmarks["nape"]
    assert [line.split()[2:] for line in lines if line.startswith("landmark nape")] == [[*(f"{value:.1f}" for value in nape), "mm"]]
    page = (Path(__file__).parents[1] / "docs" / "spec.md").read_text(encoding="utf-8")
    assert f"of the torso {front:.0f} mm in front and {side:.0f} mm at the sides" in page  # the example there


def test_body_of_measurements_is_made_and_read_again(tmp_path: Path) -> None:
    run = garmentcad("mannequin", "make", "woman", "bust=860", "waist=690", "hip=950", "--pad", "12", "-o", "anna.yaml", folder=tmp_path)
    assert run.returncode == 0, run.stderr
    assert run.stdout == "anna.yaml\n"
    shown = json.loads(garmentcad_here("mannequin", "show", "anna.yaml", "--json", folder=tmp_path).stdout)
    assert shown["measurements_mm"]["waist"] == pytest.approx(690, abs=0.1)
    assert garmentcad_here("mannequin", "make", "woman-88", "--pose", "squat", "-o", "squat.obj", folder=tmp_path).returncode == 0
    assert (tmp_path / "squat.obj").read_text().startswith("# garmentcad")


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("mannequin", "make", "woman", "bust=wide"), "bust=wide"),
        (("mannequin", "make", "woman", "bust=860", "-o", "body.fbx"), ".yaml, .obj, .png"),
        (("mannequin", "make", "woman-88", "waist=700", "-o", "body.obj"), "woman or man"),
        (("mannequin", "make", "womn"), "'womn' is no kind of body, no shipped mannequin and no file; did you mean 'woman'? Allowed: garmentcode-mean, man, "),
        (("mannequin", "make", "nobody", "-o", "body.obj"), "'nobody' is no kind of body, no shipped mannequin and no file. Allowed: garmentcode-mean, man, "),
        (("mannequin", "make", "nobody.obj", "-o", "body.obj"), "nobody.obj"),
        (("drape", "flared-skrit"), "did you mean"),
        (("drape", "flared-skirt", "--grid", "0.5"), "--grid: grid of 0.5 mm; 2 to 50 mm"),
        (("drape", "flared-skirt", "--max-time", "nan"), "--max-time"),
        (("drape", "flared-skirt", "--max-particles", "0"), "--max-particles: 0 particles; a positive whole number"),
        (("drape", "flared-skirt", "--max-particles", "50"), "at most 50 particles are allowed"),
        (("drape", "flared-skirt", "--seed", "-1"), "--seed"),
        (("drape", "tucked-in", "--set", "length=1"), "--set: an outfit has values"),
        (("drape", "flared-skirt", "--fabric", "no-such.yaml"), "no-such.yaml"),
        (("drape", "flared-skirt", "--mannequin", "woman-89"), "woman-88"),
        (("drape", "flared-skirt", "--resume", "-o", "nowhere"), "no checkpoint"),
        (("render", "nowhere", "-o", "x.png"), "report.json"),
        (("export", "nowhere", "-o", "x.stl"), ".obj"),
        (("fit", "nowhere"), "report.json"),
        (("fit", "nowhere", "--line", "hip"), "HEIGHT in mm"),
        (("export", "nowhere", "-o", "x.obj", "--mannequin", "woman-88"), "--mannequin: a draped garment stays on its mannequin"),
        (("export", "nowhere", "-o", "x.obj", "--set", "length=500"), "--set: a draped garment has its parameters"),
        (("compare", "nowhere", "elsewhere", "--view", "back"), "--view: back is said of a picture"),
        (("compare", "nowhere", "elsewhere", "--map", "strain", "-o", "x.csv"), "--map: strain is said of a picture"),
        (("test", "nowhere", "--lays", "5"), "--lays: lays are those of a baseline"),
        (("test", "nowhere", "--remake", "--junit", "x.xml"), "--remake --junit: baselines are written beside their tests"),
        (("test", "nowhere", "--remake", "-o", "x"), "--remake --out: baselines are written beside their tests"),
        (("compare", "nowhere", "elsewhere"), "report.json"),
        (("fabric", "show", "tweed"), "wool-tropical"),
        (("fabric", "fit", "no-such.csv", "-o", "x.yaml"), "no-such.csv"),
        (("fabric", "fit", "no-such.csv", "-o", "x.csv"), "allowed are .yaml, .yml"),
        (("fabric", "fit", "no-such.csv", "-o", ".yaml"), ".yaml: --out: a name is wanted before the ending .yaml"),
    ],
)
def test_bad_arguments_are_refused(arguments: tuple[str, ...], says: str, tmp_path: Path) -> None:
    run = garmentcad_here(*arguments, folder=tmp_path)
    assert run.returncode == 2, run.stderr
    assert says in run.stderr


@pytest.mark.parametrize(
    "arguments",
    [
        ("drape", "flared-skirt", "-o", ""),
        ("drape", "flared-skirt", "--out="),
        ("drape", ""),
        ("render", "nowhere", "--out", ""),
        ("export", "flared-skirt", "-o", ""),
        ("test", "nowhere", "--junit", ""),
        ("import", "nowhere.json", "-o", ""),
        ("compare", "nowhere", "elsewhere", "-o", ""),
        ("fit", "nowhere", "-o", ""),
        ("fabric", "test", "denim", "-o", ""),
        ("fabric", "fit", "x.csv", "-o", ""),
        ("mannequin", "make", "woman", "-o", ""),
    ],
)
def test_an_empty_path_is_refused_and_deletes_nothing(arguments: tuple[str, ...], tmp_path: Path) -> None:
    (tmp_path / "front.png").write_bytes(b"of another drape")
    run = garmentcad_here(*arguments, folder=tmp_path)
    assert run.returncode == 2, run.stderr
    where = "" if arguments[-1] == "" and not arguments[-2].startswith("-") else f"{arguments[-1].rstrip('=') or arguments[-2]}: "
    assert run.stderr.startswith(f"garmentcad: {where}an empty text came; a name, a file or a folder is wanted")
    assert [path.name for path in tmp_path.iterdir()] == ["front.png"]


def test_fast_values_become_a_sheet_that_can_be_shown(tmp_path: Path) -> None:
    (tmp_path / "fast.csv").write_text("property;unit;warp;weft;value\nW;g/m2;;;168\nE20;%;1.9;1.9;\nE100;%;4.6;5.9;\nEB5;%;;;4.7\nC;mm;15;14.5;\n")
    run = garmentcad("fabric", "fit", "fast.csv", "-o", "wool.yaml", "--json", folder=tmp_path)
    assert run.returncode == 0, run.stderr
    answer = json.loads(run.stdout)
    rows = {row["key"]: row for row in answer["fitted"]}
    assert rows["G.mean"]["low"] < rows["G.mean"]["value"] < rows["G.mean"]["high"]
    assert "2HB.warp" in answer["assumed"]
    assert "bounds" in garmentcad_here("fabric", "fit", "fast.csv", "-o", "wool.yaml", folder=tmp_path).stdout
    shown = json.loads(garmentcad_here("fabric", "show", "wool.yaml", "--json", folder=tmp_path).stdout)
    assert {row["key"]: row["value"] for row in shown["rows"]}["B.warp"] == pytest.approx(rows["B.warp"]["value"], rel=1e-4)


SPECS = [case for case in CASES if case.kind == "spec"]


@pytest.mark.parametrize("case", SPECS[:: max(1, len(SPECS) // 8)], ids=lambda case: case.name)
def test_bad_specs_are_refused(case: Case, tmp_path: Path) -> None:
    path = place(case, tmp_path)
    run = garmentcad_here("drape", str(path), "-o", "out", folder=tmp_path)
    assert run.returncode == 2, run.stderr
    assert path.name in run.stderr


def test_a_process_that_refuses_ends_with_2_and_no_traceback(tmp_path: Path) -> None:
    for arguments in (("drape", "flared-skrit"), ("drape", "flared-skirt", "--grid", "0.5"), ("drape", str(place(SPECS[0], tmp_path))), ("fit", "nowhere")):
        run = garmentcad(*arguments, folder=tmp_path)
        assert run.returncode == 2, run.stderr
        assert run.stderr.startswith("garmentcad: ")
        assert "Traceback" not in run.stderr


@pytest.mark.parametrize("resume", [False, True])
def test_a_drape_says_whose_checkpoint_it_replaces(resume: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def stopped(*given: object) -> None:
        raise InputError("stopped")

    monkeypatch.setattr("garmentcad.export.drape.finish", stopped)
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "checkpoint.npz").write_bytes(b"of a run that was killed")
    run = garmentcad_here("drape", "straight-skirt", "-o", "out", *(["--resume"] if resume else []), folder=tmp_path)
    assert ("begins anew in its place" in run.stderr) is not resume


def test_what_a_laboratory_puts_in_brackets_is_shown(tmp_path: Path) -> None:
    (tmp_path / "mine.yaml").write_text('schema: 1\nname: "our [/b] cloth"\nsource: "KES [gf/cm] of mill [A]"\nW: 16\n')
    run = garmentcad_here("fabric", "show", "mine.yaml", folder=tmp_path)
    assert run.returncode == 0, run.stderr
    assert "our [/b] cloth" in run.stdout
    assert "KES [gf/cm]" in run.stdout
    assert "[A]" in run.stdout


def test_a_fit_without_weight_is_held_against_itself(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text("property;warp\nLT;0.6\nWT;20\nEMT;5\n")
    run = garmentcad_here("fabric", "fit", "a.csv", "-o", "a.yaml", folder=tmp_path)
    assert run.returncode == 2
    assert "at most 3 % is allowed" in run.stderr
    assert not (tmp_path / "a.yaml").exists()


def test_a_passport_that_cannot_be_written_is_refused_before_anything_is_measured(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("garmentcad.rigs.passport.make_passport", lambda *_: pytest.fail("the testers ran"))
    (tmp_path / "taken").write_text("a file")
    run = garmentcad_here("fabric", "test", "denim", "-o", "taken", folder=tmp_path)
    assert run.returncode == 2
    assert "taken: cannot be the folder of a result" in run.stderr


def test_more_threads_than_numba_may_have_are_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(numba.config, "NUMBA_NUM_THREADS", 2)
    run = garmentcad_here("drape", "straight-skirt", "--grid", "40", "--threads", "3", folder=tmp_path)
    assert run.returncode == 2
    assert "--threads: 3 came; 2 threads are allowed" in run.stderr


def test_output_that_cannot_show_a_character_shows_its_number(tmp_path: Path) -> None:
    environment = os.environ | {"PYTHONIOENCODING": "ascii"}
    (tmp_path / "gr\u00fcn.yaml").write_text("a: [\n")
    command = [sys.executable, "-m", "garmentcad", "check", "gr\u00fcn.yaml"]
    run = subprocess.run(command, capture_output=True, text=True, cwd=tmp_path, env=environment, check=False)
    assert (run.returncode, "Traceback" in run.stderr) == (2, False)
    assert r"gr\xfcn.yaml" in run.stdout + run.stderr


def test_a_file_that_may_not_be_looked_for_is_refused(tmp_path: Path) -> None:
    run = garmentcad_here("check", f"{'x' * 300}.yaml", folder=tmp_path)
    assert run.returncode == 2
    assert "too long" in run.stderr + run.stdout


def test_what_was_noticed_of_a_file_of_a_fabric_is_printed(tmp_path: Path) -> None:
    """What belongs to no value of the sheet stands below the table."""
    (tmp_path / "lab.csv").write_text("name;W;B warp;Drape %\na;12;0.1;80\n")
    said = "warning: line 1, column 'Drape %': not understood; its 1 values are not used"
    assert said in garmentcad_here("fabric", "show", "lab.csv", folder=tmp_path).stdout.splitlines()
    assert json.loads(garmentcad_here("fabric", "show", "lab.csv", "--json", folder=tmp_path).stdout)["findings"] == [said]
