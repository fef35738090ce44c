"""From measurements to a mannequin: fit the shape, stand it, pose it, make the girths exact, mark it."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from garmentcad.arrays import floats, frozen, indices
from garmentcad.mannequin.correct import correct_girths
from garmentcad.mannequin.grade import standing_body
from garmentcad.mannequin.human import HumanModel
from garmentcad.mannequin.mannequin import Mannequin
from garmentcad.mannequin.marks import TABLE, cylinders, landmarks, measurements
from garmentcad.mannequin.pose import ARM_ANGLE_DEG, check_apart, pose_arms, pose_legs, stretch_arms
from garmentcad.mannequin.sizes import full_sizes
from garmentcad.mannequin.stand import wanted_heights
from garmentcad.units import MM_TO_M

PART_NAMES = ("torso", "arm_left", "arm_right", "leg_left", "leg_right", "head")


def make_mannequin(model: HumanModel, given: Mapping[str, float], *, name: str, arm_angle_deg: float = ARM_ANGLE_DEG) -> Mannequin:
    """The mannequin of the model's kind for measurements in mm (names of sizes.GIVEN; bust is a must, the others have rules).

    Bust, waist, hip, top arm, wrist, thigh and neck base are exact by tape (convex hull of the section, torso without arms), the heights of waist,
    hip, knee, crotch, nape and the stature too. arm_angle_deg: arms from the vertical, 25 to 60. MannequinError for measurements that are refused.
    """
    sizes = full_sizes(model.kind, given)
    heights = wanted_heights(model.kind, sizes)
    body = standing_body(model, sizes)
    body = stretch_arms(model, pose_arms(model, body, arm_angle_deg), MM_TO_M * sizes["arm_length"])
    body = pose_legs(model, correct_girths(model, body, sizes, heights))
    check_apart(model, body)
    marks = landmarks(model, body, heights)
    vertices, faces = model.whole(body.points)
    left = np.array([PART_NAMES.index(part if part in PART_NAMES else f"{part}_left") for part in model.part_names])[model.face_part]
    right = np.array([PART_NAMES.index(part if part in PART_NAMES else f"{part}_right") for part in model.part_names])[model.face_part]
    return Mannequin(
        name=name,
        vertices=frozen(floats(vertices)),
        faces=frozen(indices(faces)),
        measurements_mm=measurements(model, body, sizes, heights, marks),
        landmarks=marks,
        cylinders=cylinders(model, body, heights),
        part_names=PART_NAMES,
        face_part=frozen(indices(np.r_[left, right])),
        estimated=TABLE,
    )
