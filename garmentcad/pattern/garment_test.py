"""What a garment test says: how to drape, and what the report of that drape must hold (docs/howto/test-a-garment.md).

A report key is the dotted path of a value in report.json (`ease_mm.waist`; of names that have dots themselves, too: `fold_deg.front.crease`); `*` stands for
any one name in it. What is expected there is one of

    0, converged, true, null      exactly that; [] is a list without entries (warnings); "*" is any value that was measured
    [15, 25]                      a number in that range, ends included; null is an open end
    {value: 612, tol: 5}          a number that differs by at most tol
"""

from __future__ import annotations

import math
from typing import Annotated, Any

from pydantic import AfterValidator, BeforeValidator, Discriminator, Field, Tag
from pydantic_core import PydanticCustomError

from garmentcad.pattern.model import Model
from garmentcad.schema_version import SchemaVersion

SHAPE = "shape"  # among the keys of a baseline: the whole surface, not a value of the report
ANY = "*"
_KEY_LENGTH = 100


def _number(value: Any) -> float | int:
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not math.isfinite(value):
        raise PydanticCustomError("plain_number", "a finite number is wanted")
    return value


def _plain(value: Any) -> Any:
    return value if value is None or value == [] or isinstance(value, (bool, str)) else _number(value)


def _key(value: str) -> str:
    parts = value.split(".")
    if not value or len(value) > _KEY_LENGTH or not all(parts):
        raise PydanticCustomError("report_key", "a key of the report is written name or name.name")
    return value


def _ordered(value: tuple[float | None, float | None]) -> tuple[float | None, float | None]:
    low, high = value
    if (low is None and high is None) or (low is not None and high is not None and low > high):
        raise PydanticCustomError("range", "a range is [lowest, highest], one of which may be null")
    return value


Number = Annotated[float | int, BeforeValidator(_number)]
ReportKey = Annotated[str, AfterValidator(_key)]
Range = Annotated[tuple[Number | None, Number | None], AfterValidator(_ordered)]


class Tolerance(Model):
    """A number that differs from `value` by at most `tol`."""

    value: Number
    tol: Annotated[Number, Field(ge=0)]


def _form(value: Any) -> str:
    return "<tolerance>" if isinstance(value, (dict, Tolerance)) else "<range>" if isinstance(value, (list, tuple)) and value != [] else "<value>"


Plain = Annotated[Any, BeforeValidator(_plain)]
Expected = Annotated[Annotated[Tolerance, Tag("<tolerance>")] | Annotated[Range, Tag("<range>")] | Annotated[Plain, Tag("<value>")], Discriminator(_form)]


class GarmentTest(Model):
    """One drape and what is asserted of it. fabric, mannequin: in place of the spec's own.

    lays: how many starts are draped, the drafted one first; with several, a baseline is compared with their mean, which shows what one drape's scatter hides.
    report: what is expected, written by hand. baseline: keys whose values and tolerances were measured over lays, kept in a file beside the test.
    """

    fabric: str | None = None
    mannequin: str | None = None
    grid_mm: Number = 10.0
    seed: Annotated[int, Field(strict=True, ge=0)] = 0
    max_time_s: Number = 20.0
    lays: Annotated[int, Field(strict=True, ge=1, le=100)] = 1
    report: dict[ReportKey, Expected] = {}
    baseline: list[ReportKey] = []


class GarmentTestFile(GarmentTest):
    """A garment test in a file of its own. spec: a shipped garment or outfit, or a file in the folder of the test or below it."""

    schema_version: SchemaVersion = Field(default=1, alias="schema")
    spec: str
