"""Spec files: what is written comes back equal, and the reader asks for schema and units."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from garmentcad.check.examine import examine
from garmentcad.errors import FileError, SpecError
from garmentcad.io.mannequin_file import read_mannequin
from garmentcad.io.shipped import shipped_file, shipped_names
from garmentcad.io.spec_file import read_spec, write_spec
from garmentcad.io.yaml_file import read_yaml
from garmentcad.pattern.draft import draft
from garmentcad.pattern.parse import parse_spec
from garmentcad.pattern.spec import EdgeSpec, GarmentSpec, PanelSpec, PlacementSpec, TransformSpec
from garmentcad.simulation.job import make_job


def garment(description: str = "") -> GarmentSpec:
    """A square from Python."""
    edges = [EdgeSpec(name=f"e{k}", start="abcd"[k], end="bcda"[k]) for k in range(4)]
    points = {"a": (0, 0), "b": ("1e2", 0), "c": (100, 100), "d": (0.1, 100)}
    placement = PlacementSpec(transform=TransformSpec(translation=(0, 1000, 0)))
    panel = PanelSpec(points=points, edges=edges, placement=placement)
    return GarmentSpec(name="square", fabric="no", mannequin="woman-88", description=description, panels={"front": panel})


@pytest.mark.parametrize("name", shipped_names("patterns"))
def test_shipped_specs_come_back(name: str, tmp_path: Path) -> None:
    spec = read_spec(shipped_file("patterns", name))
    again = read_spec(write_spec(spec, tmp_path / "again.yaml"))
    assert again == spec
    assert again.file == str(tmp_path / "again.yaml")


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], deadline=None, max_examples=60)
@given(description=st.text(st.characters(codec="utf-8"), max_size=40))
def test_any_text_comes_back(description: str, tmp_path: Path) -> None:
    spec = garment(description)
    assert read_spec(write_spec(spec, tmp_path / "square.yaml")) == spec


ODD = ["no", "1e3", "12", ".5", "~", "", "null", "true", ".nan", "1:30", "0x10", "- a"]
ODD += ["a: b", "#", "'", "&a", "*a", "!x", "\ufeff", "\x85\u2028", "a\r\nb", "\tx "]


@pytest.mark.parametrize("text", ODD, ids=ascii)
def test_texts_that_look_like_something_else(text: str, tmp_path: Path) -> None:
    spec = garment(text)
    assert read_spec(write_spec(spec, tmp_path / "square.yaml")) == spec


def test_what_is_written(tmp_path: Path) -> None:
    path = write_spec(garment(), tmp_path / "square.yaml")
    data = read_yaml(path)
    assert list(data) == ["schema", "units", "name", "fabric", "mannequin", "panels"]
    assert data["fabric"] == "no"
    assert data["panels"]["front"]["edges"][0] == {"name": "e0", "from": "a", "to": "b"}
    assert data["panels"]["front"]["points"]["b"] == ["1e2", 0.0]
    with pytest.raises(FileError):
        write_spec(garment(), tmp_path / "square.yaml" / "below.yaml")


@pytest.mark.parametrize(("content", "key", "message"), [
    ("- 1\n", None, "a garment spec is a mapping, came [1]"), ("name: x\nunits: mm\n", "schema", "is missing"), ("name: x\nschema: 1\n", "units", "is missing"),
    ("schema: 1\nunits: mm\nnam: x\n", "nam", "did you mean 'name'"),
])  # fmt: skip
def test_refusals(content: str, key: str | None, message: str, tmp_path: Path) -> None:
    path = tmp_path / "bad.yaml"
    path.write_text(content)
    with pytest.raises(SpecError) as caught:
        read_spec(path)
    assert (caught.value.file, caught.value.key) == (str(path), key)
    assert message in caught.value.message


def test_a_fold_of_which_all_stays_is_not_one_that_is_merely_pressed(tmp_path: Path) -> None:
    """To Python 1 is equal to true, which is the default and not written."""
    spec = read_spec("pleated-skirt")
    whole = with_pleats(spec, 1)
    assert whole != spec
    write_spec(whole, tmp_path / "whole.yaml")
    again = read_spec(tmp_path / "whole.yaml")
    assert again == whole
    drafted = {fold.pressed for panel in draft(again, read_mannequin("woman-88").measurements_mm).panels.values() for fold in panel.folds}
    assert drafted == {1.0}
    assert with_pleats(spec, True) == spec


def with_pleats(spec: GarmentSpec, pressed: object) -> GarmentSpec:
    data = spec.model_dump(by_alias=True)
    for panel in data["panels"].values():
        for one in (*(panel.get("pleats") or ()), *(panel.get("folds") or ())):
            one["pressed"] = pressed
    return parse_spec(data)


def test_what_a_script_did_to_lists_and_mappings_of_a_spec_is_read_again(tmp_path: Path) -> None:
    spec = read_spec("straight-skirt")
    spec.seams.append("x")  # type: ignore[arg-type]
    for use in (make_job, lambda made: write_spec(made, tmp_path / "x.yaml")):
        with pytest.raises(SpecError, match=r"seams\.\d+: a mapping is wanted, came 'x'"):
            use(spec)
    (finding,) = examine(spec)
    assert finding.severity == "error"
    spec = read_spec("straight-skirt")
    spec.panels["front"].points["a"] = (1.0, 2.0, 3.0)  # type: ignore[assignment]
    with pytest.raises(SpecError, match=r"panels\.front\.points\.a: at most 2 entries are wanted"):
        make_job(spec)
    with pytest.raises(SpecError, match="fabric: "):
        make_job(read_spec("straight-skirt").model_copy(update={"fabric": None}))


def test_numbers_of_numpy_are_numbers() -> None:
    placed = TransformSpec(translation=(np.int64(1), np.float32(2.0), 3), rotation=(0, 0, 0))
    assert placed == TransformSpec(translation=(1, 2, 3), rotation=(0, 0, 0))
