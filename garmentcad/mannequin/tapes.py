"""Where the tape lies: the planes of the girths on a body."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from garmentcad.geometry.portable import norm
from garmentcad.mannequin.human import HumanModel, Shape
from garmentcad.mannequin.tape import Taped, tape
from garmentcad.units import MM_TO_M

_UP = np.array([0.0, 1.0, 0.0])
THIGH_BELOW_CROTCH = 0.02  # m
TOP_ARM_SHARE = 0.5  # of the upper arm, from the shoulder joint
GIRTHS = ("bust", "waist", "hip", "neck_base", "top_arm", "wrist", "thigh")


class Plane(NamedTuple):
    """origin (3,) m, unit normal (3,), faces (K,3), mirrored: the tape also goes around the right half."""

    origin: np.ndarray
    normal: np.ndarray
    faces: np.ndarray
    mirrored: bool


def arm_axes(joints: dict[str, np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """Unit directions of the upper arm and the forearm, away from the shoulder."""
    upper, lower = joints["elbow"] - joints["shoulder"], joints["wrist"] - joints["elbow"]
    return upper / norm(upper), lower / norm(lower)


def neck_plane(model: HumanModel, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Neck base: the plane through nape (C7) and front neck point that holds the x direction; its normal points up."""
    nape, front = points[model.landmarks["nape"]], points[model.landmarks["neck_front"]]
    normal = np.cross(front - nape, [1.0, 0.0, 0.0])
    normal /= norm(normal)
    return 0.5 * (nape + front), normal * np.sign(normal[1])


def plane_of(name: str, model: HumanModel, body: Shape, heights: dict[str, float]) -> Plane:
    """Plane of a girth of GIRTHS. heights: m, of bust, waist, hip and crotch. The torso alone is taped, never the arms."""
    points, joints = body
    if name in ("bust", "waist", "hip"):
        return Plane(heights[name] * _UP, _UP, model.part_faces("torso"), True)
    if name == "thigh":
        return Plane((heights["crotch"] - THIGH_BELOW_CROTCH) * _UP, _UP, model.part_faces("leg"), False)
    if name == "neck_base":
        origin, normal = neck_plane(model, points)
        return Plane(origin, normal, model.part_faces("torso", "head"), True)
    upper, lower = arm_axes(joints)
    if name == "top_arm":
        return Plane(joints["shoulder"] + TOP_ARM_SHARE * (joints["elbow"] - joints["shoulder"]), upper, model.part_faces("arm"), False)
    return Plane(joints["wrist"], lower, model.part_faces("arm"), False)


def taped(name: str, model: HumanModel, body: Shape, heights: dict[str, float]) -> Taped:
    """The girth `name` of GIRTHS on a body."""
    plane = plane_of(name, model, body, heights)
    return tape(body.points, plane.faces, plane.origin, plane.normal, plane.mirrored)


def girths_mm(model: HumanModel, body: Shape, heights: dict[str, float]) -> dict[str, float]:
    """All girths of GIRTHS in mm."""
    return {name: taped(name, model, body, heights).girth / MM_TO_M for name in GIRTHS}
