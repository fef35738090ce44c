"""What stands in a GarmentCode pattern file (`*_specification.json`), checked key by key. Lengths are in the file's own unit, angles in degrees.

The format as GarmentCode and its forerunner, the Garment Pattern Generator, write it (maria-korosteleva on GitHub); docs/garmentcode.md has its rules.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BaseModel, BeforeValidator, ConfigDict, Discriminator, Field, Tag, ValidationError
from pydantic_core import PydanticCustomError

from garmentcad.errors import SpecError
from garmentcad.io.json_file import read_json
from garmentcad.pattern.parse import shown, spec_errors

MAX_PANELS, MAX_EDGES, MAX_STITCHES = 200, 1000, 5000
MAX_NUMBER = 1e6


def _real(value: Any) -> float:
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise PydanticCustomError("number", "a number is wanted")
    if not abs(value) <= MAX_NUMBER:
        raise PydanticCustomError("large", "numbers are at most 1e6 in size")
    return float(value)


def _index(value: Any) -> int:
    if isinstance(value, bool) or not isinstance(value, int) or not 0 <= value < MAX_EDGES:
        raise PydanticCustomError("index", f"a whole number from 0 to {MAX_EDGES - 1} is wanted")
    return value


def _flag(value: Any) -> bool:
    if not isinstance(value, (bool, int, float)) or value not in (0, 1):
        raise PydanticCustomError("flag", "0 or 1 is wanted")
    return bool(value)


Real = Annotated[float, BeforeValidator(_real)]
Index = Annotated[int, BeforeValidator(_index)]
Flag = Annotated[bool, BeforeValidator(_flag)]
Pair = Annotated[list[Real], Field(min_length=2, max_length=2)]
Triple = Annotated[list[Real], Field(min_length=3, max_length=3)]


class FileModel(BaseModel):
    """Base of all parts. Keys that are not known are kept in `model_extra` and named by `unread`."""

    model_config = ConfigDict(extra="allow", frozen=True)


class QuadraticFile(FileModel):
    """One control point."""

    type: Literal["quadratic"]
    params: Annotated[list[Pair], Field(min_length=1, max_length=1)]


class CubicFile(FileModel):
    """Two control points, of the start and of the end."""

    type: Literal["cubic"]
    params: Annotated[list[Pair], Field(min_length=2, max_length=2)]


class CircleFile(FileModel):
    """[radius, whether the arc is the larger one, whether it bulges to the right of the chord]: an SVG arc with y up."""

    type: Literal["circle"]
    params: tuple[Real, Flag, Flag]


def _curve_form(value: Any) -> str | None:
    if isinstance(value, list):
        return "<pair>"
    kind = value.get("type") if isinstance(value, dict) else None
    return f"<{kind}>" if kind in ("quadratic", "cubic", "circle") else None


CurveFile = Annotated[
    Annotated[Pair, Tag("<pair>")]
    | Annotated[QuadraticFile, Tag("<quadratic>")]
    | Annotated[CubicFile, Tag("<cubic>")]
    | Annotated[CircleFile, Tag("<circle>")],
    Discriminator(_curve_form, custom_error_type="curve", custom_error_message="a pair, or a mapping with type quadratic, cubic or circle is wanted"),
]


class EdgeFile(FileModel):
    """An edge between two vertices of its panel; straight unless it has a curvature. A bare pair is an old quadratic."""

    endpoints: Annotated[list[Index], Field(min_length=2, max_length=2)]
    curvature: CurveFile | None = None
    label: str = ""


class PanelFile(FileModel):
    """A panel: vertices, the ordered loop of its edges, and where it is placed. The loop runs counter-clockwise seen on the right side of the fabric."""

    translation: Triple
    rotation: Triple
    vertices: Annotated[list[Pair], Field(min_length=2, max_length=MAX_EDGES)]
    edges: Annotated[list[EdgeFile], Field(min_length=1, max_length=MAX_EDGES)]
    label: str = ""


class StitchEnd(FileModel):
    """One edge of a stitch: name of its panel, and which edge of it."""

    panel: str
    edge: Index


def _stitch(value: Any) -> Any:
    if not isinstance(value, list) or len(value) not in (2, 3):
        raise PydanticCustomError("stitch", "a stitch is a list of two edges, and 'right_wrong' where it is one")
    if len(value) == 3 and value[2] != "right_wrong":
        raise PydanticCustomError("stitch", "the third element of a stitch is 'right_wrong'; nothing else is known")
    return {"a": value[0], "b": value[1], "right_wrong": len(value) == 3}


class StitchFile(BaseModel):
    """Two edges sewn together: the end of a meets the start of b, or start meets start where right_wrong."""

    a: StitchEnd
    b: StitchEnd
    right_wrong: bool


class PatternFile(FileModel):
    """Panels by name, and stitches; neither has an order that means anything."""

    panels: dict[str, PanelFile] = Field(min_length=1, max_length=MAX_PANELS)
    stitches: Annotated[list[Annotated[StitchFile, BeforeValidator(_stitch)]], Field(max_length=MAX_STITCHES)] = []
    panel_order: Any = None


class PropertiesFile(FileModel):
    """How to read the rest. Old files lack some of these keys."""

    curvature_coords: Literal["relative", "absolute"] = "relative"
    normalize_panel_translation: bool = False
    normalized_edge_loops: bool = False
    units_in_meter: Annotated[Real, Field(ge=1, le=1000)] | None = None
    original_units_in_meter: Any = None


class GarmentCodeFile(FileModel):
    """A whole file. `parameters` and `constraints` (how the panels came about) belong to templates of the old generator."""

    pattern: PatternFile
    properties: PropertiesFile
    parameters: Any = None
    parameter_order: Any = None
    constraints: Any = None
    constraint_order: Any = None


def read_garmentcode_file(path: str | Path) -> GarmentCodeFile:
    """The checked content of a file. FileError where it is no JSON, SpecError (file, key path, what came, what is allowed) for its content."""
    file = str(path)
    data = read_json(path)
    if not isinstance(data, dict):
        raise SpecError(f"a GarmentCode pattern is a mapping, came {shown(data)}", file=file)
    try:
        return GarmentCodeFile.model_validate(data)
    except ValidationError as fault:
        errors = [SpecError(error.message, file=file, key=_in_file(error.key)) for error in spec_errors(fault, file)]
        raise SpecError(errors[0].message, file=file, key=errors[0].key, others=errors[1:]) from None


def _in_file(key: str | None) -> str | None:
    """The key path as the file has it: a stitch is a list there, and `a` and `b` are names of ours."""
    return key and re.sub(r"^(pattern\.stitches\.\d+)\.([ab])(?=\.|$)", lambda found: f"{found[1]}.{'ab'.index(found[2])}", key)


def unread(part: BaseModel, key: str = "") -> Iterator[str]:
    """Key paths of everything that the file has and this program does not know."""
    for name in part.model_extra or {}:
        yield f"{key}{name}"
    for name in type(part).model_fields:
        yield from _unread_in(getattr(part, name), f"{key}{name}.")


def _unread_in(value: Any, key: str) -> Iterator[str]:
    if isinstance(value, BaseModel):
        yield from unread(value, key)
    elif isinstance(value, (list, dict)):
        for name, item in value.items() if isinstance(value, dict) else enumerate(value):
            yield from _unread_in(item, f"{key}{name}.")
