"""Standing: a blended shape is scaled to its stature and its heights are moved to where the measurements want them."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from scipy.interpolate import PchipInterpolator

from garmentcad.mannequin.human import HumanModel, Shape
from garmentcad.mannequin.sizes import base_sizes
from garmentcad.units import MM_TO_M

_BUST_SHARE = {"woman": 0.40, "man": 0.46}  # bust line above the waist as a share of nape to waist (an estimate)
_BUST_SAG = {"woman": 0.05, "man": 0.0}  # mm that the bust line sinks for each mm of bust above the base size, as on the data's heavier bodies
_BUST_TO_ARMPIT = {"woman": 0.107, "man": 0.06}  # least share of nape to waist between them: less would crush the back
_ARMPIT_ROOM = 8.0  # mm, the tape of the armscye depth lies below the armpit


def wanted_heights(kind: str, sizes: Mapping[str, float]) -> dict[str, float]:
    """Heights above the floor in m of the levels that standing fixes, from the floor up."""
    waist, nape = sizes["waist_to_floor"], sizes["waist_to_floor"] + sizes["nape_to_waist"]
    sag = _BUST_SAG[kind] * max(sizes["bust"] - base_sizes(kind)["bust"], 0.0)
    bust = waist + _BUST_SHARE[kind] * sizes["nape_to_waist"] - sag
    heights = {
        "knee": waist - sizes["waist_to_knee"],
        "crotch": waist - sizes["body_rise"],
        "hip": waist - sizes["waist_to_hip"],
        "waist": waist,
        "bust": bust,
        "armpit": max(nape - sizes["armscye_depth"] + _ARMPIT_ROOM, bust + _BUST_TO_ARMPIT[kind] * sizes["nape_to_waist"]),
        "nape": nape,
        "stature": sizes["stature"],
    }
    return {name: MM_TO_M * height for name, height in heights.items()}


def stand(model: HumanModel, shape: Shape, sizes: Mapping[str, float]) -> tuple[Shape, float]:
    """The shape scaled to its stature with its levels at `wanted_heights`, and the scale factor.

    Between the levels heights follow a monotone cubic. The arms only follow their shoulder joint, so that they keep their form.
    """
    points, joints = shape.points, shape.joints
    floor = points[:, 1].min()
    top = points[model.landmarks["top"], 1]
    scale = MM_TO_M * sizes["stature"] / (top - floor)
    points = scale * (points - [0.0, floor, 0.0])
    joints = {name: scale * (joint - [0.0, floor, 0.0]) for name, joint in joints.items()}
    wanted = wanted_heights(model.kind, sizes)
    found = {
        "knee": joints["knee"][1],
        "crotch": points[model.landmarks["crotch"], 1],
        "hip": joints["hip_level"][1],
        "waist": joints["waist_level"][1],
        "bust": points[model.landmarks["bust_point"], 1],
        "armpit": points[model.landmarks["armpit"], 1],
        "nape": points[model.landmarks["nape"], 1],
        "stature": points[model.landmarks["top"], 1],
    }
    ankle = joints["ankle"][1] * 1.4  # below, the foot keeps its height
    move = PchipInterpolator([0.0, ankle, *found.values()], [0.0, ankle, *wanted.values()])
    shift = move(joints["shoulder"][1]) - joints["shoulder"][1]
    moved = points.copy()
    moved[:, 1] += (1.0 - model.arm_weight) * (move(points[:, 1]) - points[:, 1]) + model.arm_weight * shift
    arm = ("shoulder", "elbow", "wrist")
    moved_joints = {name: np.array([joint[0], joint[1] + shift if name in arm else float(move(joint[1])), joint[2]]) for name, joint in joints.items()}
    return Shape(moved, moved_joints), scale
