"""Panels, patterns and materials drawn by hand for the tests of the cloth floor."""

from __future__ import annotations

import numpy as np

from garmentcad.cloth.contour import sample_contours
from garmentcad.cloth.panel_mesh import PanelMesh, mesh_panel
from garmentcad.fabric.material import MaterialTable
from garmentcad.geometry.curve import Arc, Line
from garmentcad.pattern.pattern import Edge, Panel, Pattern, Seam, Transform

FLAT = Transform((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
GRAINS = (0.0, 17.0, 30.0, 45.0)


def loop(points, notches=None, name: str = "e") -> tuple[Edge, ...]:
    """Straight edges e0, e1, ... through the points; notches by edge number."""
    corners = [(float(x), float(y)) for x, y in points]
    count = len(corners)
    return tuple(
        Edge(f"{name}{k}", f"p{k}", f"p{(k + 1) % count}", Line(corners[k], corners[(k + 1) % count]), notches=(notches or {}).get(k, ())) for k in range(count)
    )


def panel(points, grain_deg: float = 0.0, name: str = "front", holes=(), notches=None) -> Panel:
    return Panel(name, loop(points, notches), grain_deg, FLAT, holes=tuple(loop(hole, name=f"hole{k}_") for k, hole in enumerate(holes)))


def rectangle(width: float, height: float, grain_deg: float = 0.0, name: str = "front", notches=None) -> Panel:
    """Edges: 0 bottom, 1 right, 2 top, 3 left."""
    return panel([(0, 0), (width, 0), (width, height), (0, height)], grain_deg, name, notches=notches)


def disc(radius: float, grain_deg: float = 0.0) -> Panel:
    start = (radius, 0.0)
    return Panel("disc", (Edge("rim", "p", "p", Arc(start, start, (0.0, 0.0), False)),), grain_deg, FLAT)


def pattern(*panels: Panel, seams: tuple[Seam, ...] = ()) -> Pattern:
    return Pattern("drawn", {drawn.name: drawn for drawn in panels}, seams, "", "", {}, {})


def mesh(drawn: Panel, grid_mm: float, origin_mm: tuple[float, float] | None = None) -> PanelMesh:
    contours, _ = sample_contours(pattern(drawn), grid_mm)
    return mesh_panel(drawn.name, contours[drawn.name], drawn.grain_deg, grid_mm, origin_mm)


def materials(*areal_mass: float) -> MaterialTable:
    """One row for each areal mass; everything else is 1."""
    rows = len(areal_mass)
    pairs = {"tension_strain", "tension_force", "tension_exponent", "tension_slope", "strain_limit", "bending"}
    pairs |= {"tension_friction", "shear_friction", "bending_friction"}
    ones = {name: np.ones((rows, 2) if name in pairs else rows) for name in MaterialTable._fields}
    return MaterialTable(**(ones | {"areal_mass": np.array(areal_mass)}))
