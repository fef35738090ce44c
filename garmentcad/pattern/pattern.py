"""Pattern: a garment with every expression evaluated, mirror unfolded and darts cut in. Millimetres and degrees. Made by `draft`, read by all others."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TypeVar

import numpy as np

from garmentcad.geometry.curve import Curve
from garmentcad.geometry.portable import product


@dataclass(frozen=True)
class Edge:
    """One stretch of an outline between two named points. `piece` counts the parts into which darts cut an edge (0 for an uncut one).

    notches: arc-length fractions of this piece; dart: name of the dart whose leg this is, or None; image: whether unfolding the panel made it.
    """

    name: str
    start: str
    end: str
    curve: Curve
    piece: int = 0
    role: str | None = None
    seam_allowance_mm: float = 10.0
    notches: tuple[tuple[str, float], ...] = ()
    dart: str | None = None
    image: bool = False


@dataclass(frozen=True)
class Region:
    """Named area (polygon, panel mm) whose fabric differs: factors on KES values, or another fabric, or a fused interfacing. key: where the spec draws it, its
    mirror images too."""

    name: str
    polygon_mm: np.ndarray  # (N,2)
    factors: dict[str, float] = field(default_factory=dict)
    fabric: str | None = None
    interfacing: str | None = None
    key: str = ""


@dataclass(frozen=True)
class FoldLine:
    """A line along which a panel is folded when it is pressed.

    angle_deg: 0 is flat, 180 laid on itself, positive brings the right sides together. strength: factor on the bending stiffness over the fold.
    pressed: share of the angle that stays, 0 for a fold that is not pressed, None for the share of the fabric's fibre. laid: a fold of a pleat, a straight line
    across the whole panel, at which the panel is folded onto itself before it is sewn; the angle says which way.
    """

    name: str
    points_mm: np.ndarray  # (N,2) at least two different ones
    angle_deg: float
    strength: float = 1.0
    pressed: float | None = None
    laid: bool = False


@dataclass(frozen=True)
class Wrap:
    """Panel wrapped on an arrangement cylinder: the panel point `anchor_mm` goes to (angle, height); panel +x runs toward rising angle (to the right seen from
    outside), panel +y along `up`. The radii of the cylinder are enlarged by `offset_mm` and multiplied by `scale`; `turn_deg` turns the panel about its anchor
    first (counter-clockwise). flare_deg wraps on a cone that widens downward, or upward where it is negative, whose radius at the anchor's height is the mean
    radius of the enlarged cylinder: `flare` = half apex angle; then the panel's polar coordinates about `apex` of the cone become angle and slant height.
    spiral_mm, on a cylinder: what the radii grow by in one turn to the right, so that the ends of a collar or cuff begin over each other."""

    part: str
    anchor_mm: tuple[float, float]
    angle_deg: float
    height_mm: float
    offset_mm: float = 30.0
    scale: float = 1.0
    turn_deg: float = 0.0
    flare_deg: float = 0.0
    spiral_mm: float = 0.0


@dataclass(frozen=True)
class Transform:
    """Panel laid flat in space: x_world = R (u, v, 0) + t; rotation is extrinsic about x, then y, then z (degrees)."""

    translation_mm: tuple[float, float, float]
    rotation_deg: tuple[float, float, float]

    @property
    def matrix(self) -> np.ndarray:
        """R = Rz Ry Rx (3,3)."""
        (cx, cy, cz), (sx, sy, sz) = np.cos(np.deg2rad(self.rotation_deg)), np.sin(np.deg2rad(self.rotation_deg))
        about_x = np.array([[1.0, 0.0, 0.0], [0.0, cx, -sx], [0.0, sx, cx]])
        about_y = np.array([[cy, 0.0, sy], [0.0, 1.0, 0.0], [-sy, 0.0, cy]])
        about_z = np.array([[cz, -sz, 0.0], [sz, cz, 0.0], [0.0, 0.0, 1.0]])
        return product(product(about_z, about_y), about_x)


@dataclass(frozen=True)
class Panel:
    """A panel. `edges` is a closed counter-clockwise loop seen on the right side of the fabric; `holes` are clockwise loops. interfacing: fused to all of it
    that is in no region; regions name their own. mirrored_from: the panel whose left-right twin it was made as."""

    name: str
    edges: tuple[Edge, ...]
    grain_deg: float  # direction of the warp, counter-clockwise from panel +y
    placement: Wrap | Transform
    fabric: str | None = None
    interfacing: str | None = None
    layer: int = 0
    quantity: int = 1
    holes: tuple[tuple[Edge, ...], ...] = ()
    regions: tuple[Region, ...] = ()
    folds: tuple[FoldLine, ...] = ()
    internal_lines: dict[str, np.ndarray] = field(default_factory=dict)  # name -> (N,2) mm
    drill_holes: dict[str, tuple[float, float]] = field(default_factory=dict)
    points: dict[str, tuple[float, float]] = field(default_factory=dict)
    mirrored_from: str | None = None


@dataclass(frozen=True)
class EdgeUse:
    """One edge piece as a seam runs over it; `reverse` is True where the seam runs against the outline."""

    panel: str
    edge: int  # index into Panel.edges
    reverse: bool


@dataclass(frozen=True)
class Seam:
    """Side a is sewn to side b, the first point of a to the first of b. ease: length of a over length of b minus 1, as intended.
    closed: part of a zip that is closed, from the first points on; None for a seam. order: it is sewn when all seams of a lower order are closed. tack: of a
    pleat, the edge piece to whose start, along the outline, the last point of both sides is sewn. caught_in: the seam that sews the edges of side a already;
    side b is its third layer."""

    name: str
    a: tuple[EdgeUse, ...]
    b: tuple[EdgeUse, ...]
    ease: float = 0.0
    fold_angle_deg: float = 0.0
    bend_factor: float = 2.0
    strength_n_m: float | None = None
    closed: float | None = None
    order: int = 1
    tack: EdgeUse | None = None
    caught_in: str | None = None


@dataclass(frozen=True)
class PanelPoint:
    """A named point or drill hole of a panel."""

    panel: str
    name: str
    uv_mm: tuple[float, float]

    def __str__(self) -> str:
        return f"{self.panel}.{self.name}"


@dataclass(frozen=True)
class Pin:
    """A point of a panel that stays at `offset_mm` from a landmark of the mannequin, or from the origin of the world (landmark None)."""

    name: str
    at: PanelPoint
    landmark: str | None
    offset_mm: tuple[float, float, float]


@dataclass(frozen=True)
class Button:
    """A buttonhole that lies over a button. order: it is closed with the seams of that order, or with the first of its panels if these come later."""

    name: str
    button: PanelPoint
    buttonhole: PanelPoint
    order: int = 1


@dataclass(frozen=True)
class Band:
    """An elastic or a belt along lines: edge pieces of a panel as they follow one another, or two points of a panel and the straight line between them.

    ratio: rest length of an elastic over that of its lines, each part of which keeps its own tension; None for a belt, whose ring is `length_mm` long when
    nothing pulls and has one tension all around.
    """

    name: str
    lines: tuple[tuple[EdgeUse, ...] | tuple[PanelPoint, PanelPoint], ...]
    stiffness_n: float
    ratio: float | None = None
    length_mm: float | None = None


@dataclass(frozen=True)
class Pattern:
    """A drafted garment. `values` are the evaluated parameters; `measurements_mm` the body it was drafted for."""

    name: str
    panels: dict[str, Panel]
    seams: tuple[Seam, ...]
    fabric: str
    mannequin: str
    values: dict[str, float]
    measurements_mm: dict[str, float]
    pins: tuple[Pin, ...] = ()
    buttons: tuple[Button, ...] = ()
    bands: tuple[Band, ...] = ()


_Part = TypeVar("_Part", Panel, Region)


def parts_of(panel: Panel) -> tuple[Panel | Region, ...]:
    """What may have a fabric and an interfacing of its own: the panel, then its regions, of which the later ones lie on top."""
    return panel, *panel.regions


def key_of(part: Panel | Region, panel: Panel) -> str:
    """Key path of a panel, or of one of its regions."""
    return part.key if isinstance(part, Region) else f"panels.{panel.name}"


def named_fabrics(pattern: Pattern) -> dict[str, str]:
    """Every fabric and interfacing that panels and regions name beside the garment's own, with the key path of the first that does."""
    named: dict[str, str] = {}
    for panel in pattern.panels.values():
        for part in parts_of(panel):
            for kind, name in (("fabric", part.fabric), ("interfacing", part.interfacing)):
                if name is not None:
                    named.setdefault(name, f"{key_of(part, panel)}.{kind}")
    return named


def fabric_apart(pattern: Pattern) -> Pattern:
    """The pattern with a name of the garment's fabric that no panel or region gives to its own fabric or interfacing: those stay when it is exchanged."""
    name, taken = pattern.fabric, named_fabrics(pattern)
    while name in taken:
        name += "*"
    return replace(pattern, fabric=name)


def with_fabrics(pattern: Pattern, names: dict[str, str]) -> Pattern:
    """The pattern with every fabric and interfacing under another name."""

    def renamed(part: _Part) -> _Part:
        return replace(part, fabric=part.fabric and names[part.fabric], interfacing=part.interfacing and names[part.interfacing])

    panels = {name: replace(renamed(panel), regions=tuple(renamed(region) for region in panel.regions)) for name, panel in pattern.panels.items()}
    return replace(pattern, panels=panels, fabric=names[pattern.fabric])


def edge_roles(pattern: Pattern) -> dict[str, list[str]]:
    """Keys PANEL.EDGE of the edges of each role; an edge that darts cut into pieces counts once."""
    roles: dict[str, list[str]] = {}
    for panel in pattern.panels.values():
        for edge in panel.edges:
            key = f"{panel.name}.{edge.name}"
            if edge.role is not None and key not in roles.setdefault(edge.role, []):
                roles[edge.role].append(key)
    return roles
