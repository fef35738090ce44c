"""Garment tests as files: what is read, what is refused and how, and where references may lead."""

from __future__ import annotations

import copy
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import yaml
from garment_band import BAND, band_spec

from garmentcad.errors import FileError, InputError, SpecError
from garmentcad.io.garment_test_file import ENDING, distinct_names, find_garment_tests, read_garment_tests
from garmentcad.io.shipped import shipped_file, shipped_folder
from garmentcad.io.spec_file import read_spec, write_spec
from garmentcad.pattern.garment_test import Tolerance
from garmentcad.regression import pytest_plugin
from garmentcad.simulation.job import make_job

TEST: dict[str, Any] = {
    "schema": 1,
    "spec": "flared-skirt",
    "fabric": "denim",
    "grid_mm": 20,
    "report": {"status": "converged", "ease_mm.waist": [15, 25], "hem_height_mm": {"value": 612, "tol": 5}, "hem.nodes": [None, 12], "warnings": "*"},
    "baseline": ["hem_height_mm", "shape"],
}


def written(folder: Path, data: dict[str, Any], name: str = f"skirt{ENDING}") -> Path:
    path = folder / name
    path.write_text(yaml.safe_dump(data))
    return path


def test_a_file_of_its_own(tmp_path: Path) -> None:
    (case,) = read_garment_tests(written(tmp_path, TEST))
    assert (case.name, case.spec) == ("skirt", shipped_file("patterns", "flared-skirt"))
    assert case.test.report["ease_mm.waist"] == (15, 25)
    assert case.test.report["hem_height_mm"] == Tolerance(value=612, tol=5)
    assert case.test.report["hem.nodes"] == (None, 12)
    assert case.resolve(case.test.fabric, "fabrics") == str(shipped_file("fabrics", "denim"))
    assert case.resolve(case.test.mannequin, "mannequins") is None
    assert case.baseline_file == tmp_path / "skirt.baseline.json"


def test_tests_inside_a_spec(tmp_path: Path) -> None:
    path = tmp_path / "band.yaml"
    path.write_text(BAND + "tests:\n  loose: {grid_mm: 30, report: {ease_mm.waist: [0, 60], hem_height_mm: {value: 990, tol: 5}}}\n  plain: {}\n")
    first, second = read_garment_tests(path)
    assert (first.name, first.spec, first.test.grid_mm) == ("band.loose", path, 30)
    assert (second.name, second.test.report) == ("band.plain", {})
    spec = read_spec(path)
    assert read_spec(write_spec(spec, tmp_path / "again.yaml")) == spec
    # tests change no drape
    assert make_job(path).spec_sha256 == make_job(band_spec(tmp_path)).spec_sha256


def test_a_folder_stands_for_its_test_files_only(tmp_path: Path) -> None:
    (tmp_path / "deep").mkdir()
    paths = [written(tmp_path / "deep", TEST, f"b{ENDING}"), written(tmp_path, TEST, f"a{ENDING}")]
    written(tmp_path, TEST, "a.yaml")
    assert find_garment_tests(tmp_path) == sorted(paths)
    assert find_garment_tests(paths[0]) == [paths[0]]
    (tmp_path / "empty").mkdir()
    with pytest.raises(FileError, match="there is no"):
        find_garment_tests(tmp_path / "empty")
    assert pytest_plugin.ENDING == ENDING


def test_tests_of_one_name_are_told_apart_by_their_folders(tmp_path: Path) -> None:
    places = ["a/x", "b/x", "b/deep/y", "a/deep/y", "z"]
    for place in places:
        (tmp_path / place).parent.mkdir(parents=True, exist_ok=True)
    cases = [read_garment_tests(written(tmp_path, TEST, f"{place}{ENDING}"))[0] for place in places]
    assert distinct_names(cases) == ["a/x", "b/x", "b/deep/y", "a/deep/y", "z"]
    assert distinct_names(cases[1:3]) == ["x", "y"]
    assert distinct_names([cases[0], cases[0]]) == ["x", "x"]  # one test that was named twice
    twin = read_garment_tests(written(tmp_path, TEST, "z.yaml"))[0]
    with pytest.raises(SpecError, match=rf"z\.yaml: a test of z{ENDING} in the same folder is called 'z', too"):
        distinct_names([*cases, twin])


FAULTS: list[tuple[Callable[[dict[str, Any]], Any], str, str]] = [
    (lambda d: d.update(repport={}), "repport", "did you mean 'report'"),
    (lambda d: d.pop("schema"), "schema", "`schema: 1`"),
    (lambda d: d.update(schema=2), "schema", "came 2"),
    (lambda d: d.update(schema=True), "schema", "came 'true'"),
    (lambda d: d.pop("spec"), "spec", "is missing"),
    (lambda d: d.update(spec="flared-skrit"), "spec", "did you mean 'flared-skirt'"),
    (lambda d: d.update(spec="../x.yaml"), "spec", "is refused"),
    (lambda d: d.update(seed=True), "seed", "came true"),
    (lambda d: d.update(seed=-1), "seed", "came -1"),
    (lambda d: d.update(grid_mm="fine"), "grid_mm", "a finite number is wanted, came 'fine'"),
    (lambda d: d["report"].update({"ease_mm.waist": [25, 15]}), "report.ease_mm.waist", "lowest, highest"),
    (lambda d: d["report"].update({"ease_mm.waist": [None, None]}), "report.ease_mm.waist", "one of which may be null"),
    (lambda d: d["report"].update({"ease_mm.waist": [1, 2, 3]}), "report.ease_mm.waist", "at most 2 entries are wanted, came 3"),
    (lambda d: d["report"].update({"ease_mm.waist": ["1", 2]}), "report.ease_mm.waist.0", "came '1'"),
    (lambda d: d["report"].update({"hem_height_mm": {"value": 612, "tolerance": 5}}), "report.hem_height_mm.tolerance", "Allowed: tol, value"),
    (lambda d: d["report"].update({"hem_height_mm": {"value": 612, "tol": -5}}), "report.hem_height_mm.tol", "came -5"),
    (lambda d: d["report"].update({"a..b": 5}), "report.a..b", "name.name"),
    (lambda d: d.update(baseline=["hem", 5]), "baseline.1", "came 5"),
    (lambda d: d.update(report=[1]), "report", "came [1]"),
]


@pytest.mark.parametrize(("change", "key", "message"), FAULTS, ids=[f"{fault[1]} {fault[2]}" for fault in FAULTS])
def test_faults(change: Callable[[dict[str, Any]], Any], key: str, message: str, tmp_path: Path) -> None:
    data = copy.deepcopy(TEST)
    change(data)
    path = written(tmp_path, data)
    with pytest.raises(InputError) as caught:
        read_garment_tests(path)
    assert (caught.value.file, caught.value.key) == (str(path), key)
    assert message in caught.value.message


def test_what_is_no_garment_test(tmp_path: Path) -> None:
    for text, message in (("- 1\n", "is a mapping"), ("schema: 1\nx: &a 1\n", "anchor"), ("", "empty"), (BAND, "no tests")):
        path = tmp_path / "x.yaml"
        path.write_text(text)
        with pytest.raises(InputError, match=message):
            read_garment_tests(path)
    path.write_text(BAND + "tests: {worn: {report: {x: [1]}}}\n")
    with pytest.raises(SpecError) as caught:
        read_garment_tests(path)
    assert caught.value.key == "tests.worn.report.x.1"


@pytest.mark.parametrize("name", [ENDING, f"..{ENDING}"])
def test_a_file_name_that_is_no_name_of_a_test(name: str, tmp_path: Path) -> None:
    """Results of a test go into a folder of its name."""
    (tmp_path / name).write_text("schema: 1\nspec: flared-skirt\nreport: {self_intersections: 0}\n")
    with pytest.raises(SpecError, match="is no name"):
        read_garment_tests(tmp_path / name)


def test_references_stay_in_the_folder(tmp_path: Path) -> None:
    (tmp_path / "in").mkdir()
    band_spec(tmp_path)
    (case,) = read_garment_tests(written(tmp_path / "in", TEST | {"fabric": "../denim.yaml"}))
    with pytest.raises(FileError, match="is refused") as caught:
        case.resolve(case.test.fabric, "fabrics")
    assert caught.value.key == "fabric"
    with pytest.raises(FileError, match="is refused"):
        read_garment_tests(written(tmp_path / "in", TEST | {"spec": "../band.yaml"}))


def test_every_shipped_garment_has_a_test() -> None:
    folder = shipped_folder("patterns") / "tests"
    cases = [case for file in find_garment_tests(folder) for case in read_garment_tests(file)]
    garments = {path.resolve() for path in shipped_folder("patterns").glob("*.yaml")}
    assert {case.spec.resolve() for case in cases} == garments
    for case in cases:
        assert case.test.baseline, case.name
        assert case.baseline_file.exists(), case.name


def test_a_shipped_outfit_is_tested_by_its_name_and_holds_no_tests_itself(tmp_path: Path) -> None:
    path = tmp_path / f"worn{ENDING}"
    path.write_text("schema: 1\nspec: under-the-shirt\ngrid_mm: 30\n")
    (case,) = read_garment_tests(path)
    assert case.spec == shipped_file("outfits", "under-the-shirt")
    assert len(make_job(case.spec, grid_mm=30.0).worn) > 1
    with pytest.raises(SpecError, match="is an outfit, which holds no tests"):
        read_garment_tests(shipped_file("outfits", "under-the-shirt"))
