"""From plain data to a GarmentSpec, or another of our models: each fault becomes a SpecError with its key path, what came and what is allowed."""

from __future__ import annotations

from typing import Any, TypeVar

from pydantic import ValidationError

from garmentcad.errors import SpecError
from garmentcad.pattern.model import Model
from garmentcad.pattern.spec import GarmentSpec

Made = TypeVar("Made", bound=Model)

# Keys of the spec whose values are points: of a panel, by name, and of the world.
_FLAT = {"center", "quadratic", "through", "start_tangent", "end_tangent", "polygon", "anchor"}
_FLAT_BY_NAME = {"points", "drill_holes", "internal_lines"}
_SOLID = {"translation", "rotation", "point", "offset"}

# What belongs to keys that have to be there, in our files and (panels, edges, translation) in those of GarmentCode.
_WANTED = {
    "panels": "a mapping of panels by their names",
    "points": "a mapping of points by their names, as {corner: [x, y]}",
    "edges": "a list of edges that go around the panel",
    "placement": "where the panel starts, as {wrap: {part: torso, angle: 0, height: waist_height}} or {transform: {translation: [x, y, z]}}",
    "translation": "[x, y, z]",
    "fabric": "a shipped fabric, or a file beside the spec",
    "mannequin": "a shipped mannequin, or a file beside the spec",
    "from": "the name of a point",
    "to": "the name of a point",
    "edge": "the name of an edge of the panel",
    "a": "[panel.edge.point, panel.edge.point], or a list of such runs",
    "b": "[panel.edge.point, panel.edge.point], or a list of such runs",
    "button": "a point or drill hole, as panel.point",
    "buttonhole": "a point or drill hole, as panel.point",
    "along": "a list of lines, as [panel.edge.point, panel.edge.point] or [panel.point, panel.point]",
    "intake": "what the dart takes out of the edge, mm",
    "ratio": "the rest length of the elastic over that of its lines",
    "stiffness": "N per unit of strain",
}


def parse_spec(data: Any, file: str | None = None) -> GarmentSpec:
    """GarmentSpec of plain data as read from YAML. SpecError with the first fault otherwise, naming how many there are."""
    spec = parse_model(GarmentSpec, data, file)
    spec._file = file
    return spec


def checked(spec: GarmentSpec) -> GarmentSpec:
    """A spec that a script made, read as `parse_spec` reads one: its models cannot be changed, but the lists and mappings in them can. SpecError likewise."""
    return parse_spec(spec.model_dump(by_alias=True, warnings=False), spec.file)


def parse_model(model: type[Made], data: Any, file: str | None = None) -> Made:
    """Plain data as one of our models. SpecError as `parse_spec`."""
    try:
        return model.model_validate(data)
    except ValidationError as fault:
        errors = spec_errors(fault, file, data)
        raise SpecError(errors[0].message, file=file, key=errors[0].key, others=errors[1:]) from None


def spec_errors(fault: ValidationError, file: str | None, data: Any = None) -> list[SpecError]:
    """One SpecError for each fault that pydantic found in data."""
    found = []
    errors = fault.errors(include_url=False)
    for error in errors:
        # Tags of unions (<drawn>) and the mark of a dict key ([key]) are pydantic's own, not the user's.
        path = [str(part) for part in error["loc"] if not str(part).startswith("<") and part != "[key]"]
        context = error.get("ctx", {})
        kind, message = error["type"], error["msg"]
        if kind == "unknown_key":
            path.append(context["key"])
            if " " in context["key"]:
                message += " (a text with a comma or colon inside braces needs quotes)"
        elif kind == "missing" and isinstance(error["loc"][-1], int):
            size = 1 + max(int(other["loc"][-1]) for other in errors if other["type"] == "missing" and other["loc"][:-1] == error["loc"][:-1])
            message = f"{size} entries are wanted{_form(error['loc'][:-1])}, came {shown(error['input'])}; this one is missing"
        elif kind == "missing":
            message = "this key is missing" + (f"; wanted is {_WANTED[path[-1]]}" if path[-1] in _WANTED else "")
        elif kind == "tuple_type":
            message = f"a list is wanted{_form(error['loc'])}, came {shown(error['input'])}"
        elif kind in ("model_type", "model_attributes_type", "dict_type"):
            message = f"a mapping is wanted, came {shown(error['input'])}"
        elif kind in ("too_short", "too_long"):
            bound, number = ("at least", context["min_length"]) if kind == "too_short" else ("at most", context["max_length"])
            message = f"{bound} {number} {'entry is' if number == 1 else 'entries are'} wanted, came {len(error['input'])}: {shown(error['input'])}"
        elif kind not in ("one_of", "arc"):
            message = f"{message[:1].lower()}{message[1:]}, came {shown(error['input'])}"
        found.append(SpecError(message, file=file, key=".".join(_named(path, data)) or None))
    return found


def _named(path: list[str], data: Any) -> list[str]:
    """The path with a seam's name for its number, where it has one that is not itself at fault."""
    if len(path) > 2 and path[0] == "seams" and path[2] != "name":
        seam = data["seams"][int(path[1])]
        if isinstance(seam, dict) and isinstance(seam.get("name"), str):
            return ["seams", seam["name"], *path[2:]]
    return path


def _form(place: tuple[int | str, ...]) -> str:
    """How a point is written, where one belongs in this place."""
    *_, above, key = ["", "", *(part for part in place if isinstance(part, str) and not part.startswith("<"))]
    if above in _FLAT_BY_NAME or key in _FLAT:
        return ", as [x, y]"
    return ", as [x, y, z]" if key in _SOLID else ""


def shown(value: Any) -> str:
    """A value as it is quoted in messages: short, on one line."""
    text = {None: "nothing", True: "true", False: "false"}.get(value, repr(value)) if value is None or isinstance(value, bool) else repr(value)
    return text if len(text) <= 80 else f"{text[:77]}..."
