"""Exact girths: smooth displacement fields, one factor for each tape, iterated until the tape reads what it should.

A section is scaled about a point in its own plane by a factor that depends on the height (or the place along the arm) alone, so its hull scales with it;
between the tapes the factors follow monotone cubics, and they fade to 1 beyond them.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from scipy.interpolate import PchipInterpolator

from garmentcad.geometry.portable import norm, product
from garmentcad.mannequin.human import HumanModel, Shape
from garmentcad.mannequin.tapes import GIRTHS, THIGH_BELOW_CROTCH, TOP_ARM_SHARE, arm_axes, girths_mm, neck_plane

_ROUNDS = 12
_CLOSE = 1e-6  # relative


def correct_girths(model: HumanModel, body: Shape, sizes: Mapping[str, float], heights: dict[str, float]) -> Shape:
    """The body with the girths of GIRTHS as in sizes (mm). heights: m, of knee, crotch, hip, waist, bust and nape.

    The fit has brought the girths near; the factors stay near 1. What cannot be reached to 1e-6 stays as it is (the caller measures).
    """
    factors = dict.fromkeys(GIRTHS, 1.0)
    moved = body
    for _ in range(_ROUNDS):
        girths = girths_mm(model, moved, heights)
        errors = {name: sizes[name] / girths[name] for name in GIRTHS}
        if max(abs(error - 1.0) for error in errors.values()) < _CLOSE:
            break
        factors = {name: factors[name] * errors[name] for name in GIRTHS}
        moved = _displaced(model, body, factors, heights)
    return moved


def _displaced(model: HumanModel, body: Shape, factors: dict[str, float], heights: dict[str, float]) -> Shape:
    points = body.points + _neck(model, body, factors["neck_base"])
    points = points + _torso(model, Shape(points, body.joints), factors, heights)
    points = points + _leg(points, body.joints, factors["thigh"], heights)
    points = points + _arm(model, Shape(points, body.joints), factors)
    points[: model.border, 0] = 0.0
    return Shape(points, body.joints)


def _smooth(value: np.ndarray) -> np.ndarray:
    t = np.clip(value, 0.0, 1.0)
    return t * t * (3.0 - 2.0 * t)


def _factor(at: np.ndarray, places: list[float], values: list[float]) -> np.ndarray:
    """Monotone cubic through (place, value), constant beyond the ends; minus 1."""
    order = np.argsort(places, kind="stable")
    curve = PchipInterpolator(np.array(places)[order], np.array(values)[order])
    return curve(np.clip(at, min(places), max(places))) - 1.0


def _torso(model: HumanModel, body: Shape, factors: dict[str, float], heights: dict[str, float]) -> np.ndarray:
    """Horizontal scaling about the middle of the torso, the arms carried along without change."""
    points = body.points
    places = [heights["crotch"] - 0.08, heights["hip"], heights["waist"], heights["bust"], heights["nape"] - 0.05]
    values = [1.0, factors["hip"], factors["waist"], factors["bust"], 1.0]
    middle = points[: model.border]
    levels = [heights[name] for name in ("hip", "waist", "bust")]
    near = [middle[np.abs(middle[:, 1] - level) < 0.02, 2] for level in levels]
    depth = np.interp(points[:, 1], levels, [0.5 * (rim.min() + rim.max()) for rim in near])
    grow = _factor(points[:, 1], places, values)
    move = np.zeros_like(points)
    move[:, 0], move[:, 2] = grow * points[:, 0], grow * (points[:, 2] - depth)
    # the shoulder joint does not move, so that the arm's tapes stay in place
    return (1.0 - model.arm_weight)[:, None] * move


def _leg(points: np.ndarray, joints: dict[str, np.ndarray], factor: float, heights: dict[str, float]) -> np.ndarray:
    """Horizontal scaling about the axis from hip to knee; x = 0 stays."""
    tape = heights["crotch"] - THIGH_BELOW_CROTCH
    grow = _factor(points[:, 1], [heights["knee"] + 0.05, tape, heights["hip"]], [1.0, factor, 1.0])
    share = np.clip((joints["hip"][1] - points[:, 1]) / (joints["hip"][1] - joints["knee"][1]), 0.0, 1.0)[:, None]
    axis = (1 - share) * joints["hip"] + share * joints["knee"]
    below = points[:, 1] < heights["hip"]
    move = np.zeros_like(points)
    move[:, 0] = np.where(below, grow * (points[:, 0] - axis[:, 0]), 0.0) * _smooth(points[:, 0] / 0.03)
    move[:, 2] = np.where(below, grow * (points[:, 2] - axis[:, 2]), 0.0)
    return move


def _arm(model: HumanModel, body: Shape, factors: dict[str, float]) -> np.ndarray:
    """Scaling across the upper arm and across the forearm."""
    points, joints = body.points, body.joints
    upper, lower = arm_axes(joints)
    upper_length, lower_length = (norm(joints[b] - joints[a]) for a, b in (("shoulder", "elbow"), ("elbow", "wrist")))
    from_shoulder, from_wrist = points - joints["shoulder"], points - joints["wrist"]
    along_upper, along_lower = product(from_shoulder, upper), product(from_wrist, lower)
    grow_upper = _factor(along_upper, [0.0, TOP_ARM_SHARE * upper_length, upper_length], [1.0, factors["top_arm"], 1.0])
    grow_lower = _factor(along_lower, [-lower_length, 0.0, 0.10], [1.0, factors["wrist"], 1.0])
    across_upper = from_shoulder - along_upper[:, None] * upper
    across_lower = from_wrist - along_lower[:, None] * lower
    weight = _smooth(4.0 * model.arm_weight - 2.0)
    return weight[:, None] * (grow_upper[:, None] * across_upper + grow_lower[:, None] * across_lower)


def _neck(model: HumanModel, body: Shape, factor: float) -> np.ndarray:
    """Scaling across the neck near its base plane; it fades out toward the shoulders and the head."""
    points = body.points
    origin, normal = neck_plane(model, points)
    offset = points - origin
    above = product(offset, normal)
    across = offset - above[:, None] * normal
    fade = _smooth(1.0 - np.abs(above) / 0.09) * _smooth((0.16 - np.abs(across[:, 0])) / 0.08) * (1.0 - model.arm_weight)
    return ((factor - 1.0) * fade)[:, None] * across
