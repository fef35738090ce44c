"""A pattern as a GarmentCode file: what `garmentcad import` reads back to the same geometry, and what GarmentCode's own tools open.

The format sews one whole edge to one whole edge: edges are cut where the other side of their seam has a corner or a notch of the same name.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from garmentcad.cloth.seam_match import match_seam
from garmentcad.errors import SpecError
from garmentcad.geometry.curve import Arc, Cubic, Curve, Point, Quadratic, Spline, as_point
from garmentcad.io.atomic import write_atomic
from garmentcad.io.garmentcode_import import FABRIC, MANNEQUIN, SLEEVE_GRAIN_DEG
from garmentcad.mannequin.mannequin import Mannequin
from garmentcad.pattern.pattern import Edge, EdgeUse, Panel, Pattern, Seam, Transform
from garmentcad.placement.place import cylinder_of
from garmentcad.placement.wrap import wrap_points
from garmentcad.units import M_TO_MM

_MM_TO_CM = 0.1
_LABELS = {"neck": "collar", "waist": "lower_interface"}  # other roles are labels as they are
_SAMPLE_MM = 5.0  # of outlines, for the plane that comes nearest to a wrapped panel


def write_garmentcode(path: str | Path, pattern: Pattern, mannequin: Mannequin) -> list[str]:
    """Write the file; returns a sentence for each thing that the format cannot say. SpecError for cutouts and seams that cannot be matched, FileError where
    the file cannot be written."""
    content, notes = garmentcode_of(pattern, mannequin)
    write_atomic(path, json.dumps(content, indent=2, allow_nan=False) + "\n")
    return notes


def garmentcode_of(pattern: Pattern, mannequin: Mannequin) -> tuple[dict[str, Any], list[str]]:
    """Content of the file, and what it leaves out."""
    for panel in pattern.panels.values():
        if panel.holes:
            raise SpecError("GarmentCode files have no cutouts; draw the hole as part of the outline", key=f"panels.{panel.name}.cutouts")
    simple = _cut(pattern, {(panel.name, k): _own_cuts(edge.curve) for panel in pattern.panels.values() for k, edge in enumerate(panel.edges)})
    matched = _cut(simple, _seam_cuts(simple))
    stitches = [stitch for seam in matched.seams if seam.closed is None for stitch in _stitches(seam)]
    panels = {name: _panel(panel, mannequin) for name, panel in sorted(matched.panels.items())}
    lost = list(_agree_on_labels(panels, stitches))
    content = {
        "pattern": {"panels": panels, "stitches": stitches, "panel_order": sorted(panels)},
        "parameters": {},
        "parameter_order": [],
        "properties": {"curvature_coords": "relative", "normalize_panel_translation": False, "normalized_edge_loops": True, "units_in_meter": 100},
    }
    return content, [*_left_out(pattern), *lost, *_named_elsewhere(pattern, mannequin)]


def _named_elsewhere(pattern: Pattern, mannequin: Mannequin) -> Iterator[str]:
    """What goes with a pattern and does not come back when the file is imported."""
    for kind, name, assumed in (("fabric", pattern.fabric, FABRIC), ("mannequin", mannequin.name, MANNEQUIN)):
        if name != assumed:
            yield f"{kind} {name}: left out; the format has no place for it, and `garmentcad import` assumes {assumed}"
    if pattern.values:
        yield "parameters and values: left out; the panels are drawn with what they are now"


def _left_out(pattern: Pattern) -> Iterator[str]:
    for panel in pattern.panels.values():
        parts = {
            "regions": panel.regions, "internal lines": panel.internal_lines, "folds and their angles": any(not fold.laid for fold in panel.folds),
            "pleats and their angles": any(fold.laid for fold in panel.folds), "notches": any(edge.notches for edge in panel.edges),
            "seam allowances": any(edge.seam_allowance_mm != Edge.seam_allowance_mm for edge in panel.edges),
            "drill holes": panel.drill_holes, "its own fabric": panel.fabric, "its interfacing": panel.interfacing, "its layer": panel.layer,
            f"its quantity of {panel.quantity}": panel.quantity > 1,
            f"its grain of {panel.grain_deg + 0.0:g} degrees": panel.grain_deg != (SLEEVE_GRAIN_DEG if _is_sleeve(panel) else 0.0),
        }  # fmt: skip
        named = [name for name, there in parts.items() if there]
        if named:
            yield f"panel {panel.name}: {', '.join(named)} left out; the format has no place for them"
        if not isinstance(panel.placement, Transform):
            yield f"panel {panel.name}: placed flat, in the plane that comes nearest to the wrapped panel"
    hardware = [f"pin {pin.name}" for pin in pattern.pins] + [f"button {button.name}" for button in pattern.buttons]
    hardware += [f"zip {seam.name}" for seam in pattern.seams if seam.closed is not None] + [f"band {band.name}" for band in pattern.bands]
    for part in hardware:
        yield f"{part}: left out; the format has no place for it"
    for seam in pattern.seams:
        parts = {
            "fold angle": seam.fold_angle_deg, "strength": seam.strength_n_m is not None, f"order {seam.order}": seam.order != Seam.order,
            "bend factor": seam.bend_factor != Seam.bend_factor,
        }  # fmt: skip
        named = [name for name, there in parts.items() if there]
        if named and seam.closed is None and seam.tack is None:  # zips and pleats are named above
            yield f"seam {seam.name}: {', '.join(named)} left out; the format has no place for them"


def _own_cuts(curve: Curve) -> np.ndarray:
    """Arc-length fractions at which a curve is cut for its own sake: knots of splines, because the format has cubics alone, and the middle of closed curves."""
    knots: list[float] = curve.breaks[1:-1].tolist() if isinstance(curve, Spline) else []
    cuts = [curve.part(0.0, t, curve.start, as_point(curve.evaluate(np.array([t]))[0])).length / curve.length for t in knots]
    return np.array([0.5] if curve.start == curve.end and not cuts else cuts)


def _seam_cuts(pattern: Pattern) -> dict[tuple[str, int], np.ndarray]:
    """Fractions at which edges are cut so that the two sides of every seam have pieces that meet one to one."""
    cuts: dict[tuple[str, int], np.ndarray] = {}
    for seam in pattern.seams:
        if seam.caught_in is not None:
            raise SpecError(f"side b is caught in seam {seam.caught_in} as a third layer; GarmentCode's stitches join two", key=f"seams.{seam.name}.caught_in")
        match = match_seam(seam, pattern.panels, math.inf)  # samples at marks alone
        for use, fractions in (*zip(seam.a, match.fractions_a), *zip(seam.b, match.fractions_b)):
            if (use.panel, use.edge) in cuts:
                edge = pattern.panels[use.panel].edges[use.edge].name
                raise SpecError(f"edge {use.panel}.{edge} is sewn twice; an edge belongs to one seam", key=f"seams.{seam.name}")
            cuts[use.panel, use.edge] = fractions[1:-1]
    return cuts


def _cut(pattern: Pattern, cuts: dict[tuple[str, int], np.ndarray]) -> Pattern:
    """The pattern with edges cut at arc-length fractions, and its seams over the pieces."""
    first: dict[tuple[str, int], int] = {}
    count: dict[tuple[str, int], int] = {}
    panels = {}
    for name, panel in pattern.panels.items():
        edges: list[Edge] = []
        for k, edge in enumerate(panel.edges):
            pieces = _pieces(edge, cuts.get((name, k), np.empty(0)))
            first[name, k], count[name, k] = len(edges), len(pieces)
            edges += pieces
        panels[name] = replace(panel, edges=tuple(edges))

    def uses(side: tuple[EdgeUse, ...]) -> tuple[EdgeUse, ...]:
        found = []
        for use in side:
            pieces = [EdgeUse(use.panel, first[use.panel, use.edge] + k, use.reverse) for k in range(count[use.panel, use.edge])]
            found += pieces[::-1] if use.reverse else pieces
        return tuple(found)

    seams = tuple(replace(seam, a=uses(seam.a), b=uses(seam.b)) for seam in pattern.seams)
    return replace(pattern, panels=panels, seams=seams)


def _pieces(edge: Edge, fractions: np.ndarray) -> list[Edge]:
    bounds = [0.0, *fractions.tolist(), 1.0]
    pieces = []
    for k, curve in enumerate(edge.curve.split(fractions) if len(fractions) else [edge.curve]):
        a, b = bounds[k], bounds[k + 1]
        # A notch on a cut stands on the piece before it.
        notches = tuple((name, (at - a) / (b - a)) for name, at in edge.notches if (a < at <= b) or (k == 0 and at == a))
        pieces.append(replace(edge, curve=curve, notches=notches))
    return pieces


def _stitches(seam: Seam) -> list[list[Any]]:
    """Pieces of side a and of side b that meet, in order. The end of one meets the start of the other, but where the seam runs along both outlines alike."""
    if len(seam.a) != len(seam.b):
        raise AssertionError(f"{seam.name}: {len(seam.a)} and {len(seam.b)} pieces")
    return [
        [{"panel": a.panel, "edge": a.edge}, {"panel": b.panel, "edge": b.edge}, *(["right_wrong"] if a.reverse == b.reverse else [])]
        for a, b in zip(seam.a, seam.b)
    ]


def _panel(panel: Panel, mannequin: Mannequin) -> dict[str, Any]:
    transform = panel.placement if isinstance(panel.placement, Transform) else _nearest_plane(panel, mannequin)
    count = len(panel.edges)
    edges = []
    for k, edge in enumerate(panel.edges):
        row: dict[str, Any] = {"endpoints": [k, (k + 1) % count]}
        if edge.role is not None:
            row["label"] = _LABELS.get(edge.role, edge.role)
        curvature = _curvature(edge.curve, f"panels.{panel.name}.edges.{edge.name}")
        edges.append(row if curvature is None else row | {"curvature": curvature})
    return {
        "translation": [_cm(value) for value in transform.translation_mm],
        "rotation": [float(angle) for angle in transform.rotation_deg],
        "vertices": [[_cm(value) for value in edge.curve.start] for edge in panel.edges],
        "edges": edges,
        "label": "arm" if _is_sleeve(panel) else "leg" if _part(panel).startswith("leg") else "body",
    }


def _part(panel: Panel) -> str:
    return "" if isinstance(panel.placement, Transform) else panel.placement.part


def _is_sleeve(panel: Panel) -> bool:
    return _part(panel).startswith("arm") or any(edge.role == "cuff" for edge in panel.edges)


def _curvature(curve: Curve, key: str) -> dict[str, Any] | None:
    if isinstance(curve, Arc):
        return {"type": "circle", "params": [_cm(curve.radius), int(abs(curve.sweep) > math.pi), int(not curve.clockwise)]}
    if curve.start == curve.end:
        raise SpecError(f"the curve ends where it begins, at ({curve.start[0]:g}, {curve.start[1]:g}) mm; GarmentCode tells curves by their chords", key=key)
    if isinstance(curve, Quadratic):
        return {"type": "quadratic", "params": [_relative(curve, curve.control)]}
    if isinstance(curve, Spline):  # a piece between two knots
        tangents = curve.evaluate(np.array([0.0, 1.0]), 1) / 3.0
        curve = Cubic(curve.start, curve.end, _plus(curve.start, tangents[0]), _plus(curve.end, -tangents[1]))
    return {"type": "cubic", "params": [_relative(curve, curve.control_a), _relative(curve, curve.control_b)]} if isinstance(curve, Cubic) else None


def _plus(point: Point, step: np.ndarray) -> Point:
    return point[0] + float(step[0]), point[1] + float(step[1])


def _relative(curve: Curve, control: Point) -> list[float]:
    """A control point along the chord and to its left, over the chord's length."""
    dx, dy = curve.end[0] - curve.start[0], curve.end[1] - curve.start[1]
    x, y = control[0] - curve.start[0], control[1] - curve.start[1]
    squared = dx * dx + dy * dy
    return [(x * dx + y * dy) / squared, (dx * y - dy * x) / squared]


def _cm(value: float) -> float:
    return float(f"{value * _MM_TO_CM:.12g}")


def _nearest_plane(panel: Panel, mannequin: Mannequin) -> Transform:
    """The rigid motion that lays the flat panel nearest to where its rule wraps it, by least squares over its outline (Kabsch 1976)."""
    assert not isinstance(panel.placement, Transform)
    around = cylinder_of(panel.name, panel.placement, mannequin)
    rows = [edge.curve.points_at(np.linspace(0.0, 1.0, math.ceil(edge.curve.length / _SAMPLE_MM) + 1)[:-1]) for edge in panel.edges]
    flat = np.concatenate(rows)
    wrapped = M_TO_MM * wrap_points(flat, panel.placement, around)
    flat = np.column_stack([flat, np.zeros(len(flat))])
    middle, target = flat.mean(axis=0), wrapped.mean(axis=0)
    u, _, vt = np.linalg.svd((flat - middle).T @ (wrapped - target))
    rotation = vt.T @ np.diag([1.0, 1.0, np.sign(np.linalg.det(vt.T @ u.T))]) @ u.T
    moved = target - rotation @ middle
    angles = _angles(rotation)
    return Transform((float(moved[0]), float(moved[1]), float(moved[2])), angles)


def _angles(rotation: np.ndarray) -> tuple[float, float, float]:
    """Degrees about x, then y, then z, of R = Rz Ry Rx."""
    about_y = math.asin(min(1.0, max(-1.0, -float(rotation[2, 0]))))
    if abs(rotation[2, 0]) < 1.0 - 1e-12:
        about_x, about_z = math.atan2(rotation[2, 1], rotation[2, 2]), math.atan2(rotation[1, 0], rotation[0, 0])
    else:  # about x and z then turn about one axis
        about_x, about_z = math.atan2(-rotation[1, 2], rotation[1, 1]), 0.0
    return math.degrees(about_x), math.degrees(about_y), math.degrees(about_z)


def _agree_on_labels(panels: dict[str, Any], stitches: list[list[Any]]) -> Iterator[str]:
    """GarmentCode refuses a stitch between edges of two labels: the second edge loses its own. Yields a note for each."""
    for a, b, *_ in stitches:
        first, second = (panels[end["panel"]]["edges"][end["edge"]] for end in (a, b))
        if "label" in first and "label" in second and first["label"] != second["label"]:
            yield f"panel {b['panel']}: the label {second.pop('label')} of edge {b['edge']} left out; it is sewn to an edge with the label {first['label']}"
