"""Posing: the arms turn about the shoulder joints, the legs lean to a stance. Horizontal sections of the legs keep their form (a shear)."""

from __future__ import annotations

from typing import Any

import numpy as np

from garmentcad.errors import MannequinError
from garmentcad.geometry.angle import arctan2
from garmentcad.geometry.portable import norm, product
from garmentcad.mannequin.human import HumanModel, Shape

ARM_ANGLE_DEG = 45.0
MIN_ARM_ANGLE_DEG, MAX_ARM_ANGLE_DEG = 25.0, 60.0
HALF_GAP = 0.006  # m, least distance of a leg to the middle plane, THIGH_JOINT below the crotch and lower
THIGH_JOINT = 0.055  # m
_ANKLE_HALF_WIDTH = 0.095  # m, ankle joint to the middle plane, where the thighs leave room


def pose_arms(model: HumanModel, body: Shape, angle_deg: float) -> Shape:
    """The body with its arms (shoulder joint to wrist joint, seen from the front) at angle_deg from the vertical.

    A vertex turns by its arm weight times the angle, so that shoulder and armpit stay smooth. MannequinError for angles outside 25 to 60 degrees.
    """
    if not MIN_ARM_ANGLE_DEG <= angle_deg <= MAX_ARM_ANGLE_DEG:
        raise MannequinError(f"an arm angle of {angle_deg:g} degrees is refused; allowed: {MIN_ARM_ANGLE_DEG:g} to {MAX_ARM_ANGLE_DEG:g}", key="arm_angle")
    shoulder, wrist = body.joints["shoulder"], body.joints["wrist"]
    turn = np.radians(angle_deg) - arctan2(wrist[0] - shoulder[0], shoulder[1] - wrist[1])
    points = _turned(body.points, shoulder, turn * model.arm_weight)
    joints = dict(body.joints)
    for name in ("elbow", "wrist"):
        joints[name] = _turned(joints[name][None], shoulder, np.array([turn]))[0]
    return Shape(points, joints)


def stretch_arms(model: HumanModel, body: Shape, length: float) -> Shape:
    """The arms stretched along themselves from the shoulder joint, so that shoulder point to elbow to wrist is `length` m."""
    points, joints = body.points, body.joints
    shoulder, tip = joints["shoulder"], points[model.landmarks["shoulder_point"]]
    along = joints["wrist"] - shoulder
    along = along / norm(along)

    def stretched(place: np.ndarray, more: float) -> np.ndarray:
        return place + more * product(place - shoulder, along)[..., None] * along

    def reach(more: float) -> float:
        elbow, wrist = stretched(joints["elbow"], more), stretched(joints["wrist"], more)
        return norm(elbow - tip) + norm(wrist - elbow)

    more = 0.0
    for _ in range(4):  # nearly linear
        more += (length - reach(more)) / (reach(1.0) - reach(0.0))
    weight = np.clip(2.0 * model.arm_weight - 1.0, 0.0, 1.0)[:, None]  # the shoulder point does not move
    moved = points + weight * (stretched(points, more) - points)
    return Shape(moved, joints | {name: stretched(joints[name], more) for name in ("elbow", "wrist")})


def _turned(points: np.ndarray, pivot: np.ndarray, angles: np.ndarray) -> np.ndarray:
    """Points turned about the z axis through pivot, counter-clockwise seen from the front."""
    offset = points - pivot
    cosine, sine = np.cos(angles), np.sin(angles)
    turned = points.copy()
    turned[:, 0] = pivot[0] + cosine * offset[:, 0] - sine * offset[:, 1]
    turned[:, 1] = pivot[1] + sine * offset[:, 0] + cosine * offset[:, 1]
    return turned


def pose_legs(model: HumanModel, body: Shape) -> Shape:
    """The left leg moved sideways, more toward the foot, so that the ankles stand together as near as the thighs allow (HALF_GAP)."""
    points, joints = body.points, body.joints
    crotch = points[model.landmarks["crotch"], 1]
    leg = np.unique(model.part_faces("leg"))
    low = leg[points[leg, 1] < crotch - THIGH_JOINT]
    room = ((points[low, 0] - HALF_GAP) / _lean(crotch - points[low, 1])).min()
    lean = min(room, (joints["ankle"][0] - _ANKLE_HALF_WIDTH) / _lean(crotch - joints["ankle"][1]))
    moved = points.copy()
    moved[leg, 0] -= lean * _lean(crotch - points[leg, 1])
    legs = ("knee", "ankle")
    joints = {name: joint - [lean * _lean(crotch - joint[1]), 0, 0] if name in legs else joint for name, joint in joints.items()}
    return Shape(moved, joints)


def _lean(depth: Any) -> Any:
    """Sideways move for lean 1 at depths (m, a number or an array) below the crotch: starts smoothly, then grows with the depth."""
    depth = np.maximum(np.asarray(depth, dtype=float), 0.0)
    return depth * depth / (depth + 0.10)
