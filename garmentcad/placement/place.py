"""Placement: every panel of a pattern laid around the mannequin by its mapping rule."""

from __future__ import annotations

import numpy as np

from garmentcad.cloth.cloth import Cloth
from garmentcad.errors import SpecError
from garmentcad.mannequin.mannequin import ArrangementCylinder, Mannequin
from garmentcad.pattern.pattern import Pattern, Transform, Wrap
from garmentcad.placement.pleats import folded
from garmentcad.placement.wrap import transform_points, wrap_points
from garmentcad.units import M_TO_MM

LEAST_RADIUS_MM = 5.0  # of what a panel is wrapped on: it would go round many times, in a table of ever more angles


def place_vertices(pattern: Pattern, cloth: Cloth, mannequin: Mannequin) -> np.ndarray:
    """World positions (V,3) in m of all cloth vertices, not yet sewn. SpecError as `cylinder_of`."""
    positions = np.empty((len(cloth.vertex_uv_mm), 3))
    for index, name in enumerate(cloth.panel_names):
        panel = pattern.panels[name]
        rule, chosen = panel.placement, cloth.vertex_panel == index
        uv_mm, lift_mm = folded(panel, cloth.vertex_uv_mm[chosen])
        if isinstance(rule, Transform):
            positions[chosen] = transform_points(uv_mm, rule, lift_mm)
            continue
        positions[chosen] = wrap_points(uv_mm, rule, cylinder_of(name, rule, mannequin), lift_mm)
    return positions


def cylinder_of(panel: str, rule: Wrap, mannequin: Mannequin) -> ArrangementCylinder:
    """What a panel is wrapped on. SpecError for a part that the mannequin lacks, or an offset to near its axis."""
    if rule.part not in mannequin.cylinders:
        message = f"mannequin {mannequin.name} has no part '{rule.part}'; allowed: {', '.join(mannequin.cylinders)}"
        raise SpecError(message, key=f"panels.{panel}.placement.wrap.part")
    around = mannequin.cylinders[rule.part]
    radii = M_TO_MM * around.radius_ref, M_TO_MM * around.radius_side
    radius = min(radii) if rule.flare_deg == 0.0 else 0.5 * sum(radii)
    if (radius + rule.offset_mm) * rule.scale < LEAST_RADIUS_MM:
        least = LEAST_RADIUS_MM / rule.scale - radius
        message = f"an offset of {rule.offset_mm:g} mm leaves next to nothing of the cylinder around '{rule.part}'; allowed is {least:.1f} mm or more"
        raise SpecError(message, key=f"panels.{panel}.placement.wrap.offset")
    return around
