"""From a GarmentCode file to a garment spec: panels as drawn on the right side of the fabric, seams by the points that meet, flat placements.

Nothing is decided by distance: which sides meet, and which way round, stands in the file. The spec does not depend on the order of panels and stitches there.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from garmentcad.errors import InputError, SpecError, did_you_mean
from garmentcad.geometry.curve import Point
from garmentcad.geometry.portable import product
from garmentcad.io.garmentcode_body import body_file_of
from garmentcad.io.garmentcode_file import CircleFile, GarmentCodeFile, PanelFile, StitchEnd, read_garmentcode_file, unread
from garmentcad.pattern.draft import draft
from garmentcad.pattern.outline import draft_loop, is_counter_clockwise
from garmentcad.pattern.parse import parse_spec
from garmentcad.pattern.pattern import Pattern, Transform
from garmentcad.pattern.runs import side_length
from garmentcad.pattern.scope import MAX_COORDINATE_MM, Scope
from garmentcad.pattern.spec import EdgeSpec, GarmentSpec

FABRIC = "cotton-shirting"  # the format names none
MANNEQUIN = "garmentcode-mean"
CENTIMETRES = 100.0  # units in a metre, where a file does not say
# The format has no grainline. Panels stand upright, but sleeves lie along x: there the warp runs along the arm, as a sleeve is cut.
SLEEVE_GRAIN_DEG = 90.0
MOST_GATHERED = 10.0
GATHERED = 1.1  # the longer side over the shorter one; up to here it is ordinary ease

_JOIN_MM = 0.01
_EASE_MM = 0.5  # sides that differ by less are meant to be equal
_ROUNDED = 0.99  # an arc whose radius is a little too short for its chord is a half circle, as in SVG
_ROLES = {"collar": "neck", "armhole": "armhole", "interface": "waist", "neck": "neck", "waist": "waist", "hem": "hem", "cuff": "cuff"}


@dataclass(frozen=True)
class Imported:
    """spec: the garment; notes: what was assumed, renamed, or left out, a sentence each."""

    spec: GarmentSpec
    notes: tuple[str, ...]


def import_garmentcode(path: str | Path) -> Imported:
    """The garment in a GarmentCode file. FileError for a file that is no JSON, SpecError (file, key path, what came, what is allowed) for its content."""
    file = str(path)
    content = read_garmentcode_file(path)
    try:
        return _imported(content, Path(path))
    except InputError as fault:
        raise type(fault)(fault.message, file=file, key=fault.key) from None


def _imported(content: GarmentCodeFile, path: Path) -> Imported:
    names = _spec_names(content)
    body = body_file_of(path)
    notes = [*_file_notes(content, body), *(f"panel {old[:80]!r} is called {new!r} here" for old, new in names.items() if old != new)]
    panels: dict[str, Any] = {}
    for old, name in names.items():
        panels[name] = _Reader(content, old).panel()
        notes += _panel_notes(content.pattern.panels[old], old, panels[name])
    seams, stitches = _seams(content, names)
    data: dict[str, Any] = {
        "name": _spec_name(path.stem.removesuffix("_specification"), set()), "description": f"From the GarmentCode file {path.name}.",
        "fabric": FABRIC, "mannequin": MANNEQUIN if body is None else body.name, "panels": panels, "seams": seams,
    }  # fmt: skip
    try:
        notes += _set_eases(draft(parse_spec(data), {}), seams, stitches)
    except InputError as fault:
        raise type(fault)(fault.message, key=f"pattern.{fault.key}") from None
    return Imported(parse_spec(data, str(path)), tuple(notes))


def _file_notes(content: GarmentCodeFile, body: Path | None) -> Iterator[str]:
    yield f"fabric {FABRIC} is assumed; the format names none"
    if body is None:
        yield f"mannequin {MANNEQUIN} is assumed; there are no body measurements beside the file"
    yield "grain is assumed to run along y of the panels, and along the arm in sleeves; the format has none"
    for key in unread(content):
        yield f"{key[:200]} is not known here and was left out"
    if content.parameters:
        yield "parameters were left out; the panels of the file have their values applied"
    if content.properties.units_in_meter is None:
        yield "properties.units_in_meter is missing: centimetres are assumed"
    curves = [edge.curvature for panel in content.pattern.panels.values() for edge in panel.edges]
    if "curvature_coords" not in content.properties.model_fields_set and any(curve is not None and not isinstance(curve, CircleFile) for curve in curves):
        yield "properties.curvature_coords is missing: control points are taken relative to their chords"
    if not content.properties.normalized_edge_loops:
        yield "properties.normalized_edge_loops is missing or false (an old file): loops are taken as they run"


def _panel_notes(panel: PanelFile, old: str, made: dict[str, Any]) -> Iterator[str]:
    used = {index for edge in panel.edges for index in edge.endpoints}
    for index in sorted(set(range(len(panel.vertices))) - used):
        yield f"vertex {index} of panel {old[:80]!r} belongs to no edge and was left out"
    for k, edge in enumerate(panel.edges):
        if edge.label and _role_of(edge.label) is None:
            yield f"the label {edge.label[:80]!r} of edge {k} of panel {old[:80]!r} means nothing here and was left out"
    assumed = [f"edge {k} is a {edge['role']}" for k, edge in enumerate(made["edges"]) if "role" in edge and _role_of(panel.edges[k].label) is None]
    if assumed:
        yield f"panel {old[:80]!r}: it is assumed that {', '.join(assumed)}, for it is not sewn"


def _spec_names(content: GarmentCodeFile) -> dict[str, str]:
    """Names in the spec by names in the file, sorted."""
    names: dict[str, str] = {}
    for old in sorted(content.pattern.panels):
        names[old] = _spec_name(old, set(names.values()))
    return names


def _spec_name(text: str, taken: set[str]) -> str:
    """A name that a spec allows and that is not taken."""
    plain = re.sub(r"[^A-Za-z0-9_-]", "_", text)
    plain = (plain if re.match(r"[A-Za-z]", plain) else f"p_{plain}")[:64]
    name, count = plain, 1
    while name in taken:
        count += 1
        name = f"{plain[: 63 - len(str(count))]}_{count}"
    return name


def _role_of(label: str) -> str | None:
    """Role of an edge by the last word of its label (left_collar, right_armhole, lower_interface)."""
    return _ROLES.get(label.rpartition("_")[2])


def _rounded(value: float) -> float:
    """Without the last digits, which only scaling made, and without a negative zero."""
    return float(f"{value:.12g}") + 0.0


class _Reader:
    """One panel of the file as plain data of a spec. Edge k of the file is edge ek, its first point pk."""

    def __init__(self, content: GarmentCodeFile, old: str) -> None:
        self._panel, self._key = content.pattern.panels[old], f"pattern.panels.{old}"
        self._scale = 1000.0 / (content.properties.units_in_meter or CENTIMETRES)
        self._absolute = content.properties.curvature_coords == "absolute"
        vertices = np.array(self._panel.vertices) * self._scale
        for k, place in enumerate(self._panel.vertices):
            self._check_size(place, f"vertices.{k}")
        self._check_size(self._panel.translation, "translation")
        self._check_loop(vertices)
        # The forerunner of GarmentCode moves the panel's origin to the mean of its vertices, where the file asks for it.
        self._origin = vertices.mean(axis=0) if content.properties.normalize_panel_translation else np.zeros(2)
        self._ends = vertices[[edge.endpoints for edge in self._panel.edges]]
        sewn = {(end.panel, end.edge) for stitch in content.pattern.stitches for end in (stitch.a, stitch.b)}
        self._free = {k for k in range(len(self._panel.edges)) if (old, k) not in sewn}

    def _check_size(self, numbers: Sequence[float], key: str) -> None:
        for place, number in enumerate(numbers):
            if abs(length := self._scale * number) > MAX_COORDINATE_MM:
                message = f"{number:g} is {length:.0f} mm where a metre has {1000.0 / self._scale:g} units (properties.units_in_meter)"
                allowed = f"allowed is {-MAX_COORDINATE_MM:.0f} to {MAX_COORDINATE_MM:.0f} mm"
                raise SpecError(f"{message}; {allowed}", key=f"{self._key}.{key}.{place}")

    def _check_loop(self, vertices: np.ndarray) -> None:
        edges = self._panel.edges
        for k, edge in enumerate(edges):
            for end in (0, 1):
                if edge.endpoints[end] >= len(vertices):
                    message = f"there is no vertex {edge.endpoints[end]}; the panel has {len(vertices)}, counted from 0"
                    raise SpecError(message, key=f"{self._key}.edges.{k}.endpoints.{end}")
        for k, edge in enumerate(edges):
            after = edges[(k + 1) % len(edges)]
            gap = math.dist(vertices[edge.endpoints[1]], vertices[after.endpoints[0]])
            if gap > _JOIN_MM:
                message = f"the edge ends at vertex {edge.endpoints[1]} and the next one starts at vertex {after.endpoints[0]}, {gap:.1f} mm away"
                raise SpecError(f"{message}; the edges of a panel are a closed loop, in order", key=f"{self._key}.edges.{k}.endpoints")

    def panel(self) -> dict[str, Any]:
        """The panel on the right side of the fabric, whose outline runs counter-clockwise there, and where it is placed.

        A clockwise loop is seen from the wrong side: x is mirrored, and the panel turned about its y axis, so that it stays where it is.
        """
        drawn = self._drawn(1.0)
        loop = draft_loop([EdgeSpec.model_validate(edge) for edge in drawn["edges"]], drawn["points"], Scope({}), f"{self._key}.edges")
        mirrored = not is_counter_clockwise(loop, f"{self._key}.edges")
        placement = self._placement(mirrored)
        if mirrored:
            drawn = self._drawn(-1.0)
        for k in range(len(self._ends)):
            role = _role_of(self._panel.edges[k].label) or (self._free_role(k) if k in self._free else None)
            if role is not None:
                drawn["edges"][k]["role"] = role
        grain = {"grain": SLEEVE_GRAIN_DEG} if self._panel.label == "arm" else {}
        transform = {"translation": list(placement.translation_mm), "rotation": list(placement.rotation_deg)}
        return {**drawn, **grain, "placement": {"transform": transform}}

    def _drawn(self, side: float) -> dict[str, Any]:
        """Points and edges; side: 1 as in the file, -1 with x mirrored."""

        def point(place: np.ndarray) -> Point:
            x, y = place - self._origin
            return _rounded(side * x), _rounded(y)

        count = len(self._ends)
        points = {f"p{k}": point(self._ends[k, 0]) for k in range(count)}
        edges = [{"name": f"e{k}", "from": f"p{k}", "to": f"p{(k + 1) % count}", **self._shape(k, side, point)} for k in range(count)]
        return {"points": points, "edges": edges}

    def _shape(self, k: int, side: float, point: Any) -> dict[str, Any]:
        curve = self._panel.edges[k].curvature
        start, end = self._ends[k]
        if curve is None:
            return {}
        if isinstance(curve, CircleFile):
            radius, large, right = curve.params
            return {"arc": {"radius": self._radius(k, radius), "bulge": "right" if right == (side > 0.0) else "left", "large": large}}
        along = end - start
        across = np.array([-along[1], along[0]])
        pairs = [curve] if isinstance(curve, list) else curve.params
        controls = [np.array(pair) * self._scale if self._absolute else start + pair[0] * along + pair[1] * across for pair in pairs]
        return {"quadratic": point(controls[0])} if len(controls) == 1 else {"cubic": [point(control) for control in controls]}

    def _radius(self, k: int, radius: float) -> float:
        """Radius in mm."""
        start, end = self._ends[k]
        half = math.dist(start, end) / 2
        wanted = radius * self._scale
        if half == 0.0 or wanted < _ROUNDED * half:
            message = f"a radius of {wanted:.3f} mm cannot span a chord of {2 * half:.3f} mm; it must be at least half of a chord that is not 0"
            raise SpecError(message, key=f"{self._key}.edges.{k}.curvature.params.0")
        # Rounding of the points must not make the chord too long for a half circle.
        return _rounded(max(wanted, half * (1.0 + 1e-11)))

    def _placement(self, mirrored: bool) -> Transform:
        x, y, z = (self._scale * value for value in self._panel.translation)
        about_x, about_y, about_z = self._panel.rotation
        if mirrored:  # R turned by half a turn about the panel's own y axis: Rz Ry(b) Rx(a) Ry(180) = Rz Ry(b + 180) Rx(-a)
            about_x, about_y = -about_x, about_y + 180.0
        moved = (_rounded(x + self._origin[0]), _rounded(y + self._origin[1]), _rounded(z))
        return Transform(moved, tuple(_rounded(_turn(angle)) for angle in (about_x, about_y, about_z)))  # type: ignore[arg-type]

    def _free_role(self, k: int) -> str | None:
        """Role of an edge that is not sewn: the cuff of a sleeve; a hem where it lies in the lower half of its panel as worn."""
        if self._panel.label == "arm":
            return "cuff"
        up = self._placement(False).matrix[1, :2]
        heights = product(self._ends, up)
        return "hem" if heights[k].mean() < 0.5 * (heights.min() + heights.max()) else None


def _turn(degrees: float) -> float:
    """The same angle above -180 and at most 180."""
    return -((180.0 - degrees) % 360.0 - 180.0)


def _seams(content: GarmentCodeFile, names: dict[str, str]) -> tuple[list[dict[str, Any]], list[int]]:
    """One seam for each stitch, sorted, its sides sorted too, named by panels and edges; and the place of its stitch in the file."""
    rows = []
    for k, stitch in enumerate(content.pattern.stitches):
        for end, place in ((stitch.a, 0), (stitch.b, 1)):
            _check_end(end, content, f"pattern.stitches.{k}.{place}")
        (panel_a, edge_a), (panel_b, edge_b) = sorted((names[end.panel], end.edge) for end in (stitch.a, stitch.b))
        rows.append((panel_a, edge_a, panel_b, edge_b, stitch.right_wrong, k))
    rows.sort()
    counts = {names[old]: len(panel.edges) for old, panel in content.pattern.panels.items()}
    seams: list[dict[str, Any]] = []
    taken: set[str] = set()
    for panel_a, edge_a, panel_b, edge_b, right_wrong, _ in rows:
        name = _spec_name(f"{panel_a}-{edge_a}-{panel_b}-{edge_b}", taken)
        taken.add(name)
        side_a, side_b = (
            [f"{panel}.e{edge}.p{edge}", f"{panel}.e{edge}.p{(edge + 1) % counts[panel]}"] for panel, edge in ((panel_a, edge_a), (panel_b, edge_b))
        )
        # The end of one edge meets the start of the other: right sides of the fabric together. The other way round a right side lies on a wrong one.
        seams.append({"name": name, "a": side_a, "b": side_b if right_wrong else side_b[::-1]})
    return seams, [row[-1] for row in rows]


def _check_end(end: StitchEnd, content: GarmentCodeFile, key: str) -> None:
    panel = content.pattern.panels.get(end.panel)
    if panel is None:
        raise SpecError(f"no panel is called {end.panel[:80]!r}{did_you_mean(end.panel, content.pattern.panels)}", key=f"{key}.panel")
    if end.edge >= len(panel.edges):
        raise SpecError(f"there is no edge {end.edge}; the panel has {len(panel.edges)}, counted from 0", key=f"{key}.edge")


def _set_eases(pattern: Pattern, seams: list[dict[str, Any]], stitches: list[int]) -> Iterator[str]:
    """Write the seam ease that the file means, which is the one that its lengths have, into the seams. Yields a note for each gather."""
    for data, seam, stitch in zip(seams, pattern.seams, stitches, strict=True):
        a, b = side_length(pattern, seam.a), side_length(pattern, seam.b)
        if abs(a - b) <= _EASE_MM:
            continue
        if max(a, b) > MOST_GATHERED * min(a, b):
            message = f"the edges of seam {data['name']} are {a:.1f} and {b:.1f} mm long; gathers of up to {MOST_GATHERED:g} to 1 are sewn"
            raise SpecError(message, key=f"stitches.{stitch}")
        data["ease"] = round(a / b - 1.0, 6)
        if max(a, b) > GATHERED * min(a, b):
            yield f"seam {data['name']} gathers: {max(a, b):.1f} mm to {min(a, b):.1f} mm"
