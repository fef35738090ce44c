"""The spec's models: documentation and models agree, and every fault names its key, what came and what is allowed."""

from __future__ import annotations

import copy
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from pydantic import ValidationError

import garmentcad.pattern.spec
from garmentcad.errors import SpecError
from garmentcad.io.yaml_file import parse_yaml
from garmentcad.pattern.model import Model
from garmentcad.pattern.parse import _WANTED, parse_spec
from garmentcad.pattern.spec import ArcSpec, Distance, EdgeSpec, GarmentSpec, MirroredPanelSpec, PanelSpec, PlacementSpec, WrapSpec

DOCS = Path(__file__).resolve().parent.parent / "docs" / "spec.md"


def documented() -> dict[str, Any]:
    match = re.search(r"```yaml\n(.*?)```", DOCS.read_text(encoding="utf-8"), re.DOTALL)
    assert match
    return parse_yaml(match[1], "docs/spec.md")


DATA = documented()


def test_the_documentation_is_a_spec() -> None:
    spec = parse_spec(DATA)
    front = spec.panels["front"]
    assert isinstance(front, PanelSpec)
    assert front.edges[1].arc == ArcSpec(center=(0.0, 0.0), direction="clockwise")
    assert front.notches[0].at == 0.5
    assert isinstance(spec.panels["sleeve_right"], MirroredPanelSpec)
    assert spec.seams[0].a == ("front.side.left", "front.side.hem_left")


def test_the_documentation_names_every_key() -> None:
    text = DOCS.read_text(encoding="utf-8")
    models = [GarmentSpec, PanelSpec, EdgeSpec, ArcSpec, WrapSpec, PlacementSpec, Distance, MirroredPanelSpec]
    for model in models:
        for name, field in model.model_fields.items():
            assert re.search(rf"\b{field.alias or name}\b", text), f"{model.__name__}.{name}"


def test_dump_comes_back() -> None:
    spec = parse_spec(DATA)
    assert parse_spec(spec.model_dump(mode="json", by_alias=True)) == spec
    assert parse_spec(spec.model_dump(mode="json", by_alias=True, exclude_defaults=True)) == spec
    assert spec != spec.model_copy(update={"name": "other"})


def test_models_are_the_python_api() -> None:
    edge = EdgeSpec(name="side", start="a", end="b", arc=ArcSpec(radius="r", bulge="left"))
    assert edge.model_dump(by_alias=True, exclude_defaults=True) == {"name": "side", "from": "a", "to": "b", "arc": {"radius": "r", "bulge": "left"}}
    with pytest.raises(ValidationError, match="unknown key"):
        EdgeSpec(name="side", start="a", ende="b")


def front(data: dict[str, Any]) -> dict[str, Any]:
    return data["panels"]["front"]


FAULTS: list[tuple[Callable[[dict[str, Any]], Any], str, str]] = [
    (lambda d: d.update(pannels={}), "pannels", "did you mean 'panels'"),
    (lambda d: front(d).update(grian=1), "panels.front.grian", "did you mean 'grain'"),
    (lambda d: front(d)["edges"][0].update({"form": "left"}), "panels.front.edges.0.form", "did you mean 'from'"),
    (lambda d: d["parameters"]["length"].update({"all round": None}), "parameters.length.all round", "needs quotes"),
    (lambda d: d.pop("fabric"), "fabric", "is missing"),
    (lambda d: d.update(name=12), "name", "valid string, came 12"),
    (lambda d: d.update(schema=2), "schema", "should be 1, came 2"),
    (lambda d: d.update(units="cm"), "units", "should be 'mm', came 'cm'"),
    (lambda d: d.update(panels=[]), "panels", "a mapping is wanted, came []"),
    (lambda d: d.update(panels={}), "panels", "at least 1 entry is wanted, came 0"),
    (lambda d: d["panels"].update(x=3), "panels.x", "a mapping is wanted, came 3"),
    (lambda d: d["panels"].update({"a b": front(d)}), "panels.a b", "starts with a letter"),
    (lambda d: d["panels"].update({"a.b": front(d)}), "panels.a.b", "starts with a letter"),
    (lambda d: front(d)["points"].update(left=[1]), "panels.front.points.left.1", "2 entries are wanted, as [x, y], came [1]; this one is missing"),
    (lambda d: front(d)["points"].update(offset="1, 5"), "panels.front.points.offset", "a list is wanted, as [x, y], came '1, 5'"),
    (
        lambda d: front(d).update(placement={"transform": {"translation": [0]}}),
        "panels.front.placement.transform.translation.1",
        "3 entries are wanted, as [x, y, z], came [0]; this one is missing",
    ),
    (
        lambda d: front(d).update(placement={"transform": {"translation": "0 1 2"}}),
        "panels.front.placement.transform.translation",
        "a list is wanted, as [x, y, z], came '0 1 2'",
    ),
    (lambda d: front(d)["points"].update(left=[1, 2, 3]), "panels.front.points.left", "at most 2"),
    (lambda d: front(d)["points"].update(left="here"), "panels.front.points.left", "came 'here'"),
    (lambda d: front(d)["points"].update(left=["a +", 1]), "panels.front.points.left.0", "came 'a +'"),
    (lambda d: front(d)["points"].update(left=[True, 1]), "panels.front.points.left.0", "a number or an expression is wanted, came true"),
    (lambda d: front(d)["points"].update(left=[1, None]), "panels.front.points.left.1", "a number or an expression is wanted, came nothing"),
    (lambda d: front(d)["points"].update(left=[float("nan"), 1]), "panels.front.points.left.0", "finite"),
    (lambda d: front(d)["points"].update(left=[10**400, 1]), "panels.front.points.left.0", "finite"),
    (lambda d: front(d)["edges"][0].update(arc={"center": [0, 0]}), "panels.front.edges.0.arc", "either center and direction"),
    (lambda d: front(d)["edges"][0].update(arc={"radius": 9, "bulge": "up"}), "panels.front.edges.0.arc.bulge", "'left' or 'right', came 'up'"),
    (lambda d: front(d)["edges"][1].update(quadratic=[0, 1]), "panels.front.edges.1", "spline is wanted, came arc, quadratic"),
    (lambda d: front(d)["edges"][0].update(spline={"through": []}), "panels.front.edges.0.spline.through", "at least 1 entry is wanted, came 0"),
    (lambda d: front(d)["edges"][0].update(role="him"), "panels.front.edges.0.role", "came 'him'"),
    (lambda d: front(d).update(edges=[]), "panels.front.edges", "at least 1 entry is wanted, came 0"),
    (lambda d: front(d)["notches"][0].update(at={"mm": 3}), "panels.front.notches.0.at.from", "is missing"),
    (lambda d: front(d)["notches"][0].update(at=[3]), "panels.front.notches.0.at", "came [3]"),
    (lambda d: front(d)["darts"][0].pop("length"), "panels.front.darts.0.length", "is missing"),
    (lambda d: front(d).update(quantity=0), "panels.front.quantity", "greater than or equal to 1, came 0"),
    (lambda d: front(d).update(layer="1"), "panels.front.layer", "a whole number is wanted, came '1'"),
    (lambda d: front(d).update(layer=True), "panels.front.layer", "a whole number is wanted, came true"),
    (lambda d: front(d).update(placement={}), "panels.front.placement", "exactly one of wrap, transform is wanted, came none"),
    (lambda d: front(d)["placement"]["wrap"].update(part="torsa"), "panels.front.placement.wrap.part", "came 'torsa'"),
    (lambda d: front(d)["regions"][0].update(band={"edge": "hem", "width": 3}), "panels.front.regions.0", "exactly one of polygon, band is wanted"),
    (lambda d: d["panels"].update(x={"mirrored_from": "front"}), "panels.x.placement", "is missing; wanted is where the panel starts, as {wrap: {"),
    (lambda d: d.pop("panels"), "panels", "this key is missing; wanted is a mapping of panels"),
    (lambda d: d["seams"][0].update(a=["front.side", "front.side.left"]), "seams.side_left.a.0", "panel.edge.point, came 'front.side'"),
    (lambda d: d["seams"][0].update(a=["front.side.left"]), "seams.side_left.a.1", "is missing"),
    (lambda d: d["seams"][0].update(b=3), "seams.side_left.b", "valid list, came 3"),
    (lambda d: d["seams"][0].update(b=[["front.side.left", "front.side.hem_left"], ["x", "y.y.y"]]), "seams.side_left.b.1.0", "came 'x'"),
    (lambda d: d["seams"][0].update(name="a b"), "seams.0.name", "a name starts with a letter"),
    (lambda d: d["seams"][0].pop("name"), "seams.0.name", "is missing"),
    (lambda d: d.update(closures=[{"name": "fly", "zip": 1}]), "closures.0.zip", "a mapping is wanted, came 1"),
    (lambda d: d.update(tests={"x": 1}), "tests.x", "a mapping is wanted, came 1"),
    (lambda d: d.update(tests={"x": {"spec": "y"}}), "tests.x.spec", "unknown key"),
    (lambda d: d.update(tests={"x y": {}}), "tests.x y", "a name starts with a letter"),
    (lambda d: d["parameters"].update({"sqrt": {"value": 1}}), "parameters.sqrt", "not a function"),
    (lambda d: d["parameters"].update({"in": {"value": 1}}), "parameters.in", "or a word of Python"),
    (lambda d: d["values"].update({"a-b": 1}), "values.a-b", "used in expressions"),
]


def test_keys_whose_content_is_named_have_to_be_there_somewhere() -> None:
    made = [model for model in vars(garmentcad.pattern.spec).values() if isinstance(model, type) and issubclass(model, Model)]
    required = {field.alias or name for model in made for name, field in model.model_fields.items() if field.is_required()}
    assert required >= set(_WANTED)


@pytest.mark.parametrize(("change", "key", "message"), FAULTS, ids=[fault[1] for fault in FAULTS])
def test_faults(change: Callable[[dict[str, Any]], Any], key: str, message: str) -> None:
    data = copy.deepcopy(DATA)
    change(data)
    with pytest.raises(SpecError) as caught:
        parse_spec(data, "g.yaml")
    assert (caught.value.file, caught.value.key) == ("g.yaml", key)
    assert message in caught.value.message
    assert str(caught.value).startswith(f"g.yaml: {key}: ")


def test_many_faults_are_counted() -> None:
    data = copy.deepcopy(DATA)
    data["name"], data["units"] = 1, "cm"
    with pytest.raises(SpecError, match="and 1 more fault"):
        parse_spec(data)
    with pytest.raises(SpecError, match=r"a mapping is wanted, came \[1\]"):
        parse_spec([1])
