"""Landmarks, arrangement cylinders and measurements of a finished half body."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import pairwise

import numpy as np

from garmentcad.geometry.portable import norm, product
from garmentcad.mannequin.cylinder import enclosing, mirrored, on_floor
from garmentcad.mannequin.human import HumanModel, Shape
from garmentcad.mannequin.mannequin import ArrangementCylinder
from garmentcad.mannequin.tape import cut
from garmentcad.mannequin.tapes import girths_mm, neck_plane
from garmentcad.units import M_TO_MM

_UP, _FRONT, _LEFT = np.array([0.0, 1.0, 0.0]), np.array([0.0, 0.0, 1.0]), np.array([1.0, 0.0, 0.0])
_MIRROR = np.array([-1.0, 1.0, 1.0])
TABLE = ("back_width", "chest_front")  # no landmarks for them on the body: the table's value is given


def landmarks(model: HumanModel, body: Shape, heights: Mapping[str, float]) -> dict[str, np.ndarray]:
    """Points on the body (elbow, wrist, knee, ankle: joint centres in it), m; heights: m, of waist and hip."""
    points, joints = body.points, body.joints
    left: dict[str, np.ndarray] = {name: points[model.landmarks[name]] for name in ("shoulder_point", "bust_point", "armpit")}
    left |= {name: joints[name] for name in ("elbow", "wrist", "knee", "ankle")}
    origin, normal = neck_plane(model, points)
    neck = cut(points, model.part_faces("torso", "head"), origin, normal).points
    left["neck_side"] = neck[np.argmax(neck[:, 0])]
    found = {name: points[model.landmarks[name]] for name in ("nape", "neck_front", "crotch")}
    for name in ("waist", "hip"):
        ring = cut(points, model.part_faces("torso"), heights[name] * _UP, _UP).points
        middle = ring[ring[:, 0] < 1e-6]
        found[f"{name}_front"], found[f"{name}_back"] = middle[np.argmax(middle[:, 2])], middle[np.argmin(middle[:, 2])]
        left[name] = ring[np.argmax(ring[:, 0])]
    for name, point in left.items():
        found[f"{name}_left"], found[f"{name}_right"] = point, point * _MIRROR
    return {name: np.array(point, dtype=float) for name, point in found.items()}


def cylinders(model: HumanModel, body: Shape, heights: Mapping[str, float]) -> dict[str, ArrangementCylinder]:
    """Elliptic cylinders that enclose their parts: torso (shoulder to hip), legs (crotch to ankle), arms (upper arm to wrist), neck."""
    points, joints = body.points, body.joints

    def part(*names: str) -> np.ndarray:
        return points[np.unique(model.part_faces(*names))]

    torso = part("torso")
    torso = torso[(torso[:, 1] > heights["hip"] - 0.02) & (torso[:, 1] < points[model.landmarks["shoulder_point"], 1])]
    torso = np.vstack([torso, torso * _MIRROR])
    leg = part("leg")
    leg = leg[leg[:, 1] > joints["ankle"][1]]
    shoulder, wrist = joints["shoulder"], joints["wrist"]
    up = (shoulder - wrist) / norm(shoulder - wrist)
    outward = _LEFT - product(_LEFT, up) * up
    outward /= norm(outward)
    arm = part("arm")
    along = product(arm - shoulder, up)
    arm = arm[(along < -0.05) & (along > -norm(shoulder - wrist))]
    base, axis = neck_plane(model, points)
    head = part("head")
    head = head[product(head - base, axis) < 0.05]
    found = {
        "torso": enclosing(torso, on_floor(torso), _UP, _FRONT),
        "arm_left": enclosing(arm, shoulder, up, outward),
        "leg_left": enclosing(leg, on_floor(leg), _UP, _FRONT),
        "neck": enclosing(np.vstack([head, head * _MIRROR]), base, axis, _FRONT - product(_FRONT, axis) * axis),
    }
    for name in ("arm", "leg"):
        found[f"{name}_right"] = mirrored(found[f"{name}_left"])
    return found


def measurements(model: HumanModel, body: Shape, sizes: Mapping[str, float], heights: dict[str, float], marks: Mapping[str, np.ndarray]) -> dict[str, float]:
    """All measurements of a mannequin in mm, taken on the body; those of TABLE are the table's values."""
    points = body.points

    def between(*names: str) -> float:
        return M_TO_MM * float(sum(norm(marks[b] - marks[a]) for a, b in pairwise(names)))

    found = girths_mm(model, body, heights)
    found["stature"] = M_TO_MM * float(points[:, 1].max() - points[:, 1].min())
    found["shoulder"] = between("neck_side_left", "shoulder_point_left")
    found["arm_length"] = between("shoulder_point_left", "elbow_left", "wrist_left")
    at = {name: M_TO_MM * heights[name] for name in ("waist", "hip", "knee")}
    at |= {name: M_TO_MM * float(marks[name][1]) for name in ("nape", "neck_front", "crotch")}
    at |= {"shoulder": M_TO_MM * float(marks["shoulder_point_left"][1]), "bust": M_TO_MM * heights["bust"]}
    found |= {f"{name}_height": height for name, height in at.items()}
    found["armscye_depth"] = at["nape"] - M_TO_MM * float(marks["armpit_left"][1])
    found["nape_to_waist"] = at["nape"] - at["waist"]
    found["waist_to_hip"] = at["waist"] - at["hip"]
    found["waist_to_knee"] = at["waist"] - at["knee"]
    found["waist_to_floor"] = at["waist"]
    found |= {name: float(sizes[name]) for name in TABLE}
    return found
