"""Regions of a panel: polygons, and bands along an edge."""

from __future__ import annotations

import numpy as np
import shapely

from garmentcad.arrays import frozen
from garmentcad.errors import SpecError
from garmentcad.geometry.polygon import loop_points, signed_area
from garmentcad.pattern.darts import find_edge
from garmentcad.pattern.pattern import Edge, Region
from garmentcad.pattern.scope import Scope
from garmentcad.pattern.spec import Number, PanelSpec, RegionSpec

MOST_FACTOR = 1e4
_TOLERANCE_MM = 0.05


def draft_regions(spec: PanelSpec, edges: list[Edge], scope: Scope, key: str) -> tuple[Region, ...]:
    """Regions of a panel with a counter-clockwise outline. The panel's interfacing is theirs too, unless they name an interfacing or a fabric of their own."""
    outline = loop_points([edge.curve for edge in edges], _TOLERANCE_MM)
    regions = []
    names = [region.name for region in spec.regions]
    for k, region in enumerate(spec.regions):
        where = f"{key}.regions.{k}"
        if names.index(region.name) < k:
            raise SpecError(f"a second region is called {region.name!r}; names differ within a panel", key=f"{where}.name")
        factors = {name: _factor(factor, scope, f"{where}.factors.{name}") for name, factor in region.factors.items()}
        interfacing = region.interfacing if region.interfacing is not None or region.fabric is not None else spec.interfacing
        for polygon in _areas(region, edges, outline, scope, where):
            regions.append(Region(region.name, frozen(polygon), factors, region.fabric, interfacing, where))
    return tuple(regions)


def _factor(expression: Number, scope: Scope, key: str) -> float:
    value = scope.number(expression, key)
    if not 0.0 < value <= MOST_FACTOR:
        raise SpecError(f"came {value:g}; a factor above 0, up to {MOST_FACTOR:g}, is allowed", key=key)
    return value


def _without_holes(part: shapely.Geometry) -> list[shapely.Polygon]:
    """A polygon cut through its holes until there are none, in pieces that overlap by a hair: what lies on a cut lies in one of them. Nothing of a line."""
    if not isinstance(part, shapely.Polygon):
        return []
    if not part.interiors:
        return [part]
    left, low, right, high = part.bounds
    cut = shapely.Polygon(part.interiors[0]).centroid.x
    halves = (shapely.box(left, low, cut + _TOLERANCE_MM, high), shapely.box(cut - _TOLERANCE_MM, low, right, high))
    return [piece for half in halves for found in shapely.get_parts(part.intersection(half)) for piece in _without_holes(found)]


def _areas(region: RegionSpec, edges: list[Edge], outline: np.ndarray, scope: Scope, key: str) -> list[np.ndarray]:
    if region.polygon is not None:
        polygon = np.array([scope.point(pair, f"{key}.polygon.{k}") for k, pair in enumerate(region.polygon)])
        area = signed_area(polygon)
        if area == 0.0:
            raise SpecError("the polygon of the region encloses no area", key=f"{key}.polygon")
        if not shapely.is_valid(shapely.Polygon(polygon)):
            raise SpecError("the polygon of the region crosses or touches itself; one that goes once around its area is wanted", key=f"{key}.polygon")
        return [polygon if area > 0.0 else polygon[::-1].copy()]
    assert region.band is not None  # the model allows no third form
    find_edge(edges, region.band.edge, f"{key}.band.edge")
    width = scope.positive(region.band.width, f"{key}.band.width")
    lines = [edge.curve.polyline(_TOLERANCE_MM) for edge in edges if edge.name == region.band.edge]
    band = shapely.MultiLineString(lines).buffer(width, quad_segs=16).intersection(shapely.make_valid(shapely.Polygon(outline)))
    # Area within `width` of the edge; where the outline is narrow it can fall apart.
    parts = [piece for part in shapely.get_parts(band) for piece in _without_holes(part) if piece.area > 1.0]
    return [np.array(shapely.geometry.polygon.orient(part).exterior.coords)[:-1] for part in parts]
