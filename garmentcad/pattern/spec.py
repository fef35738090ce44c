"""The garment spec: pydantic models that are the Python API and the shape of the YAML file (docs/spec.md).

Lengths are millimetres, angles degrees; wherever a number stands, an expression may stand. Unknown keys are refused.
"""

from __future__ import annotations

import re
from keyword import iskeyword
from numbers import Integral, Real
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BeforeValidator, Discriminator, Field, PrivateAttr, StrictBool, Tag, model_validator
from pydantic_core import PydanticCustomError

from garmentcad.pattern.expression import FUNCTIONS, check_grammar
from garmentcad.pattern.garment_test import GarmentTest
from garmentcad.pattern.model import Model
from garmentcad.schema_version import SchemaVersion

MAX_NUMBER = 1e9


def _number(value: Any) -> float | str:
    """A number, or an expression whose form is right (its names are looked up when the pattern is drafted)."""
    if isinstance(value, bool) or not isinstance(value, (Real, str)):
        raise PydanticCustomError("number", "a number or an expression is wanted")
    if not isinstance(value, str):
        if not -MAX_NUMBER <= value <= MAX_NUMBER:  # type: ignore[operator]  # also true for nan
            raise PydanticCustomError("large", "numbers are finite and at most 1e9 in size")
        return float(value)
    fault = check_grammar(value)
    if fault:
        raise PydanticCustomError("expression", "{fault}", {"fault": fault})
    return value


def _whole(value: Any) -> Any:
    if isinstance(value, bool) or not isinstance(value, Integral):
        raise PydanticCustomError("whole", "a whole number is wanted")
    return int(value)


def _pressed(value: Any) -> bool | float | str:
    """Pressed or not, or how much of the fold stays: all of it as the expression "1", because to Python the number is equal to true, the default."""
    if isinstance(value, bool):
        return value
    share = _number(value)
    return "1" if share == 1.0 else share


def _name(value: str) -> str:
    if not re.fullmatch(r"[A-Za-z][A-Za-z0-9_-]{0,63}", value):
        raise PydanticCustomError("name", "a name starts with a letter and has at most 64 letters, digits, _ and -")
    return value


def _variable(value: str) -> str:
    if not re.fullmatch(r"[A-Za-z][A-Za-z0-9_]{0,63}", value) or value in FUNCTIONS or iskeyword(value):
        raise PydanticCustomError(
            "variable", "a name used in expressions starts with a letter, has at most 64 letters, digits and _, and is not a function or a word of Python (in)"
        )
    return value


def _edge_point(value: str) -> str:
    if len(value.split(".")) != 3:
        raise PydanticCustomError("edge_point", "an end of a seam is written panel.edge.point")
    return value


def _panel_point(value: str) -> str:
    if len(value.split(".")) != 2:
        raise PydanticCustomError("panel_point", "a point is written panel.point, where the panel has a point or a drill hole of that name")
    return value


def _line_end(value: str) -> str:
    if len(value.split(".")) not in (2, 3):
        raise PydanticCustomError("line_end", "an end is written panel.edge.point, or panel.point for a straight line across the panel")
    return value


Number = Annotated[float | str, BeforeValidator(_number)]
Pressed = Annotated[bool | float | str, BeforeValidator(_pressed)]
Whole = Annotated[int, BeforeValidator(_whole)]
Name = Annotated[str, AfterValidator(_name)]
Variable = Annotated[str, AfterValidator(_variable)]
EdgePoint = Annotated[str, AfterValidator(_edge_point)]
PanelPointName = Annotated[str, AfterValidator(_panel_point)]
LineEnd = Annotated[str, AfterValidator(_line_end)]
PointSpec = tuple[Number, Number]
SpacePoint = tuple[Number, Number, Number]
LineSpec = tuple[LineEnd, LineEnd]
Run = tuple[EdgePoint, EdgePoint]


class ParameterSpec(Model):
    """A named number that a user may change. range: smallest and largest value."""

    value: Number
    range: tuple[Number, Number] | None = None
    unit: Literal["mm", "deg", "1"] = "mm"
    doc: str = ""


class ArcSpec(Model):
    """Circular arc: `center` and `direction`; or `radius`, the side of the chord on which it bulges (seen along the edge), and whether it is the large one."""

    center: PointSpec | None = None
    direction: Literal["clockwise", "counterclockwise"] | None = None
    radius: Number | None = None
    bulge: Literal["left", "right"] | None = None
    large: StrictBool = False

    @model_validator(mode="after")
    def _one_form(self) -> ArcSpec:
        by_center = self.center is not None and self.direction is not None and self.radius is None and self.bulge is None and not self.large
        by_radius = self.radius is not None and self.bulge is not None and self.center is None and self.direction is None
        if not by_center and not by_radius:
            raise PydanticCustomError("arc", "an arc has either center and direction, or radius and bulge (and large)")
        return self


class SplineSpec(Model):
    """Spline through the points; tangents are directions of travel, their length does not matter. An end without one has no curvature."""

    through: list[PointSpec] = Field(min_length=1)
    start_tangent: PointSpec | None = None
    end_tangent: PointSpec | None = None


class EdgeSpec(Model):
    """An edge from one named point to another: a line unless one of arc, quadratic, cubic, spline is given. allowance: seam allowance, mm."""

    name: Name
    start: Name = Field(alias="from")
    end: Name = Field(alias="to")
    arc: ArcSpec | None = None
    quadratic: PointSpec | None = None
    cubic: tuple[PointSpec, PointSpec] | None = None
    spline: SplineSpec | None = None
    role: Literal["hem", "waist", "neck", "armhole", "cuff"] | None = None
    allowance: Number = 10.0

    @model_validator(mode="after")
    def _one_shape(self) -> EdgeSpec:
        if any(getattr(self, name) is not None for name in ("arc", "quadratic", "cubic", "spline")):
            self._exactly_one("arc", "quadratic", "cubic", "spline")
        return self


class Distance(Model):
    """A place on an edge: `mm` along it, from one of its two points."""

    mm: Number
    start: Name = Field(alias="from")


def _place_form(value: Any) -> str:
    return "<distance>" if isinstance(value, (dict, Distance)) else "<fraction>"


Place = Annotated[Annotated[Number, Tag("<fraction>")] | Annotated[Distance, Tag("<distance>")], Discriminator(_place_form)]


class NotchSpec(Model):
    """A mark on an edge. at: fraction of its length from `from` to `to`, or a distance. Notches of one name on both sides of a seam meet."""

    edge: Name
    at: Place
    name: Name


class DartSpec(Model):
    """A dart cut into an edge. at: middle of its mouth; intake: length of edge it takes in; length: from the mouth's chord square to the apex."""

    name: Name
    edge: Name
    at: Place
    intake: Number
    length: Number


class BandSpec(Model):
    """All of a panel within `width` of an edge."""

    edge: Name
    width: Number


class RegionSpec(Model):
    """A named area, by polygon or by band, with factors on KES values, a fabric of its own, a fused interfacing."""

    name: Name
    polygon: list[PointSpec] | None = Field(default=None, min_length=3)
    band: BandSpec | None = None
    factors: dict[str, Number] = {}
    fabric: str | None = None
    interfacing: str | None = None

    @model_validator(mode="after")
    def _one_area(self) -> RegionSpec:
        self._exactly_one("polygon", "band")
        return self


class FoldSpec(Model):
    """The panel folds along an internal line. angle: degrees it is pressed to, positive brings the right sides together; strength: factor on the bending
    stiffness over the fold; pressed: yes (as much stays as the fabric's fibre lets stay), no, or the share of the angle that stays."""

    name: Name
    line: Name
    angle: Number
    strength: Number = 1.0
    pressed: Pressed = True


class PleatsSpec(Model):
    """Knife pleats, folded from a straight edge square into the panel and caught in the seam of that edge.

    at: where the first shows its fold; depth: from there on to where it turns back, so that it takes up twice as much of the edge; count of them, every so many
    mm of the edge. With `from` the other end of the edge they are laid the other way.
    """

    name: Name
    edge: Name
    at: Distance
    depth: Number
    count: Number = 1
    every: Number | None = None
    angle: Number = 170.0
    strength: Number = 1.0
    pressed: Pressed = True


class WrapSpec(Model):
    """Panel wrapped on a body part's arrangement cylinder (see `garmentcad.pattern.pattern.Wrap`)."""

    part: Literal["torso", "neck", "arm_left", "arm_right", "leg_left", "leg_right"]
    anchor: PointSpec = (0.0, 0.0)
    angle: Number
    height: Number
    offset: Number = 30.0
    scale: Number = 1.0
    turn: Number = 0.0
    flare: Number = 0.0
    spiral: Number = 0.0


class TransformSpec(Model):
    """Panel laid flat in space: translation in mm, rotation in degrees about x, then y, then z."""

    translation: tuple[Number, Number, Number]
    rotation: tuple[Number, Number, Number] = (0.0, 0.0, 0.0)


class PlacementSpec(Model):
    """Where a panel sits before sewing: exactly one of the two rules."""

    wrap: WrapSpec | None = None
    transform: TransformSpec | None = None

    @model_validator(mode="after")
    def _one_rule(self) -> PlacementSpec:
        self._exactly_one("wrap", "transform")
        return self


class PanelSpec(Model):
    """A panel as drawn, on the right side of the fabric, x to the right and y up."""

    points: dict[Name, PointSpec]
    edges: list[EdgeSpec] = Field(min_length=1)
    grain: Number = 0.0
    mirror: Name | None = None
    quantity: Whole = Field(default=1, ge=1, le=100)
    notches: list[NotchSpec] = []
    darts: list[DartSpec] = []
    internal_lines: dict[Name, list[PointSpec]] = {}
    folds: list[FoldSpec] = []
    pleats: list[PleatsSpec] = []
    drill_holes: dict[Name, PointSpec] = {}
    cutouts: list[list[EdgeSpec]] = []
    regions: list[RegionSpec] = []
    interfacing: str | None = None
    fabric: str | None = None
    layer: Whole = Field(default=0, ge=0, le=20)
    placement: PlacementSpec


class MirroredPanelSpec(Model):
    """The mirror image (x to -x) of another drawn panel; names stay, what is not given is taken from it."""

    mirrored_from: Name
    quantity: Whole | None = Field(default=None, ge=1, le=100)
    fabric: str | None = None
    layer: Whole | None = Field(default=None, ge=0, le=20)
    placement: PlacementSpec


def _panel_form(value: Any) -> str:
    mirrored = "mirrored_from" in value if isinstance(value, dict) else isinstance(value, MirroredPanelSpec)
    return "<mirrored>" if mirrored else "<drawn>"


AnyPanel = Annotated[Annotated[PanelSpec, Tag("<drawn>")] | Annotated[MirroredPanelSpec, Tag("<mirrored>")], Discriminator(_panel_form)]


def _side_form(value: Any) -> str:
    return "<run>" if isinstance(value, (list, tuple)) and all(isinstance(item, str) for item in value) else "<runs>"


Side = Annotated[Annotated[Run, Tag("<run>")] | Annotated[list[Run], Field(min_length=1), Tag("<runs>")], Discriminator(_side_form)]


class SeamSpec(Model):
    """Side a sewn to side b; the first point of a meets the first of b. A side is one run [first, last] or a list of runs.

    ease: length of a over length of b minus 1, as intended; fold_angle: degrees at rest, 0 is flat; strength: N/m; order: when it is sewn, 1 is first.
    caught_in: the seam that sews the edges of side a already; side b, such as that of a lining, is caught in it as a third layer.
    """

    name: Name
    a: Side
    b: Side
    ease: Number = 0.0
    fold_angle: Number = 0.0
    bend_factor: Number = 2.0
    strength: Number | None = None
    order: Whole = Field(default=1, ge=1, le=9)
    caught_in: Name | None = None


class PinSpec(Model):
    """A point of a panel that stays at a point of the world (mm), as on a hook, or at a landmark of the mannequin, `offset` mm from it."""

    name: Name
    at: PanelPointName
    point: SpacePoint | None = None
    landmark: Name | None = None
    offset: SpacePoint = (0.0, 0.0, 0.0)

    @model_validator(mode="after")
    def _one_target(self) -> PinSpec:
        self._exactly_one("point", "landmark")
        return self


class ButtonSpec(Model):
    """A button, and the buttonhole that lies over it: outside, on the right side of the button's panel. order: of the seams with which it closes, from 1."""

    name: Name
    button: PanelPointName
    buttonhole: PanelPointName
    order: Whole = Field(default=1, ge=1, le=9)


class TapesSpec(Model):
    """The two edges that a zip joins, as the sides of a seam; the slider starts at the first points."""

    a: Side
    b: Side


class ZipSpec(Model):
    """A zip. closed: part of its length, from the first points on, that is closed."""

    name: Name
    zip: TapesSpec
    closed: Number = 1.0
    bend_factor: Number = 4.0


def _closure_form(value: Any) -> str:
    zipped = "zip" in value if isinstance(value, dict) else isinstance(value, ZipSpec)
    return "<zip>" if zipped else "<button>"


Closure = Annotated[Annotated[ButtonSpec, Tag("<button>")] | Annotated[ZipSpec, Tag("<zip>")], Discriminator(_closure_form)]


class ElasticSpec(Model):
    """An elastic sewn on along lines. ratio: its rest length over theirs on the panel; stiffness: N per unit of its strain."""

    name: Name
    along: list[LineSpec] = Field(min_length=1)
    ratio: Number
    stiffness: Number


class BeltSpec(Model):
    """A belt that is closed into a ring over lines, along which it slides. length: of the ring when nothing pulls, mm; stiffness: N per unit of its strain."""

    name: Name
    along: list[LineSpec] = Field(min_length=1)
    length: Number
    stiffness: Number


class GarmentSpec(Model):
    """One garment."""

    schema_version: SchemaVersion = Field(default=1, alias="schema")
    units: Literal["mm"] = "mm"
    name: Name
    description: str = ""
    fabric: str
    mannequin: str
    parameters: dict[Variable, ParameterSpec] = {}
    values: dict[Variable, Number] = {}
    panels: dict[Name, AnyPanel] = Field(min_length=1, max_length=200)
    seams: list[SeamSpec] = []
    closures: list[Closure] = Field(default=[], max_length=100)
    pins: list[PinSpec] = Field(default=[], max_length=100)
    elastics: list[ElasticSpec] = Field(default=[], max_length=100)
    belts: list[BeltSpec] = Field(default=[], max_length=100)
    tests: dict[Name, GarmentTest] = {}

    _file: str | None = PrivateAttr(default=None)  # where it was read from: for messages and references, no part of the garment

    @property
    def file(self) -> str | None:
        """Path of the file it was read from, as the user wrote it."""
        return self._file

    def __eq__(self, other: object) -> bool:
        return isinstance(other, GarmentSpec) and all(getattr(self, name) == getattr(other, name) for name in type(self).model_fields)

    __hash__ = None  # type: ignore[assignment]
