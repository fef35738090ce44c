"""Mapping rules that lay flat panel points in space without stretching them: on an elliptic cylinder, on a cone, or flat."""

from __future__ import annotations

import numpy as np

from garmentcad.geometry.angle import arctan2
from garmentcad.geometry.portable import product
from garmentcad.mannequin.mannequin import ArrangementCylinder
from garmentcad.pattern.pattern import Transform, Wrap
from garmentcad.units import MM_TO_M

_TURN_STEPS = 7200  # parameter steps of one turn of the ellipse; the arc-length table is then good to 1e-7 of the girth


def wrap_points(uv_mm: np.ndarray, wrap: Wrap, cylinder: ArrangementCylinder, lift_mm: np.ndarray | float = 0.0) -> np.ndarray:
    """Points (N,2) of a panel in mm to world points (N,3) in m, by the rule `wrap` on `cylinder` (see `Wrap`). lift_mm (N,): how much farther out."""
    turn = np.deg2rad(wrap.turn_deg)
    rotation = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    local = product(uv_mm - np.asarray(wrap.anchor_mm), rotation.T) * MM_TO_M
    radius_ref = (cylinder.radius_ref + wrap.offset_mm * MM_TO_M) * wrap.scale
    radius_side = (cylinder.radius_side + wrap.offset_mm * MM_TO_M) * wrap.scale
    height, lift = wrap.height_mm * MM_TO_M, np.asarray(lift_mm) * MM_TO_M
    if wrap.flare_deg != 0.0:
        angle, along, radius = _on_cone(local, np.deg2rad(wrap.angle_deg), height, 0.5 * (radius_ref + radius_side), np.deg2rad(wrap.flare_deg))
        ref_part, side_part = (radius + lift) * np.cos(angle), (radius + lift) * np.sin(angle)
    else:
        start, growth = np.deg2rad(wrap.angle_deg), wrap.spiral_mm * MM_TO_M / (2.0 * np.pi)
        angle = _angle_at_arc_length(local[:, 0], start, radius_ref, radius_side, growth)
        along = height + local[:, 1]
        grown = growth * (angle - start) + lift
        ref_part, side_part = (radius_ref + grown) * np.cos(angle), (radius_side + grown) * np.sin(angle)
    side = np.cross(cylinder.up, cylinder.ref)
    return cylinder.origin + along[:, None] * cylinder.up + ref_part[:, None] * cylinder.ref + side_part[:, None] * side


def _on_cone(local: np.ndarray, angle: float, height: float, radius: float, half_angle: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Angle, height and radius on a cone of `half_angle` that widens downward (upward where it is negative) and has `radius` at the anchor (local origin)."""
    slant = radius / np.sin(half_angle)  # from the anchor up to the apex; negative where that lies below
    from_apex = local - np.array([0.0, slant])
    distance = np.sign(half_angle) * np.hypot(from_apex[:, 0], from_apex[:, 1])
    bearing = arctan2(np.sign(half_angle) * from_apex[:, 0], -np.sign(half_angle) * from_apex[:, 1])
    return angle + bearing / np.sin(half_angle), height + (slant - distance) * np.cos(half_angle), distance * np.sin(half_angle)


def _angle_at_arc_length(arc: np.ndarray, start: float, radius_ref: float, radius_side: float, growth: float) -> np.ndarray:
    """Ellipse parameter reached after walking `arc` (N,) m from parameter `start` [rad] on an ellipse whose radii grow by `growth` m per rad from there."""
    turns = int(np.ceil((np.abs(arc).max(initial=0.0)) / (2.0 * np.pi * min(radius_ref, radius_side)))) + 1
    parameter = np.linspace(start - turns * 2.0 * np.pi, start + turns * 2.0 * np.pi, 2 * turns * _TURN_STEPS + 1)
    middle = 0.5 * (parameter[1:] + parameter[:-1])
    grown = growth * (middle - start)
    pace = np.hypot(
        growth * np.cos(middle) - (radius_ref + grown) * np.sin(middle),
        growth * np.sin(middle) + (radius_side + grown) * np.cos(middle),
    )
    walked = np.concatenate([[0.0], np.cumsum(pace * np.diff(parameter))])
    return np.interp(arc, walked - walked[turns * _TURN_STEPS], parameter)


def transform_points(uv_mm: np.ndarray, transform: Transform, lift_mm: np.ndarray | float = 0.0) -> np.ndarray:
    """Points (N,2) of a panel in mm to world points (N,3) in m: x = Rz Ry Rx (u, v, lift) + t."""
    flat = np.column_stack([uv_mm, np.broadcast_to(lift_mm, len(uv_mm))])
    return (product(flat, transform.matrix.T) + np.asarray(transform.translation_mm)) * MM_TO_M
