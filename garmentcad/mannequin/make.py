"""From measurements to a mannequin: fit the shape, stand it, pose it, make the girths exact, mark it."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from garmentcad.arrays import floats, frozen, indices
from garmentcad.errors import MannequinError
from garmentcad.mannequin.correct import correct_girths
from garmentcad.mannequin.form import dress_form
from garmentcad.mannequin.gap import check_apart, facings
from garmentcad.mannequin.grade import standing_body
from garmentcad.mannequin.human import HumanModel
from garmentcad.mannequin.mannequin import PART_NAMES, Mannequin
from garmentcad.mannequin.marks import TABLE, cylinders, landmarks, measurements
from garmentcad.mannequin.pads import ShoulderPads, pad_shoulders
from garmentcad.mannequin.pose import ARM_ANGLE_DEG, pose_arms, pose_legs, stretch_arms
from garmentcad.mannequin.rig import rig_of
from garmentcad.mannequin.sizes import full_sizes
from garmentcad.mannequin.stand import wanted_heights
from garmentcad.mannequin.tapes import GIRTHS
from garmentcad.units import MM_TO_M

_REACHED_MM = 2.0
_SAID_MM = 10.0  # a measurement that is not exact and differs by more from what was given is said


def make_mannequin(
    model: HumanModel,
    given: Mapping[str, float],
    *,
    name: str,
    arm_angle_deg: float = ARM_ANGLE_DEG,
    pads: ShoulderPads | None = None,
    form: bool = False,
) -> Mannequin:
    """The mannequin of the model's kind for measurements in mm (names of sizes.GIVEN; bust is a must, the others have rules).

    Bust, waist, hip, top arm, wrist, thigh and neck base are exact by tape (convex hull of the section, torso without arms), the heights of waist,
    hip, knee, crotch, nape and the stature too; `notes` names others that were given and come out otherwise. arm_angle_deg: arms from the
    vertical, 25 to 60. form: a dress form, without head and arms. MannequinError for measurements that are refused.
    """
    sizes = full_sizes(model.kind, given)
    heights = wanted_heights(model.kind, sizes)
    body = standing_body(model, sizes)
    body = stretch_arms(model, pose_arms(model, body, arm_angle_deg), MM_TO_M * sizes["arm_length"])
    body = pose_legs(model, correct_girths(model, body, sizes, heights))
    marks = landmarks(model, body, heights)
    if pads is not None:
        body, tip = pad_shoulders(model, body, pads, marks["neck_side_left"])
        marks |= {"shoulder_point_left": tip, "shoulder_point_right": tip * [-1.0, 1.0, 1.0]}
    vertices, faces = model.whole(body.points)
    left = np.array([PART_NAMES.index(part if part in PART_NAMES else f"{part}_left") for part in model.part_names])[model.face_part]
    right = np.array([PART_NAMES.index(part if part in PART_NAMES else f"{part}_right") for part in model.part_names])[model.face_part]
    measured = measurements(model, body, sizes, heights, marks)
    made = Mannequin(
        name=name,
        vertices=frozen(floats(vertices)),
        faces=frozen(indices(faces)),
        measurements_mm=measured,
        landmarks=marks,
        cylinders=cylinders(model, body, heights),
        part_names=PART_NAMES,
        face_part=frozen(indices(np.r_[left, right])),
        rig=rig_of(model, body, arm_angle_deg),
        estimated=TABLE,
        notes=_unmet(measured, given),
    )
    _check_reached(made, sizes)
    check_apart(facings(made), made.vertices, "arm_angle")
    return dress_form(made) if form else made


def _check_reached(made: Mannequin, sizes: Mapping[str, float]) -> None:
    for girth in (*GIRTHS, "stature"):
        found = made.measurements_mm[girth]
        if abs(found - sizes[girth]) > _REACHED_MM:
            raise MannequinError(f"{sizes[girth]:g} mm cannot be reached with the other measurements: {found:.0f} mm comes out", key=f"measurements.{girth}")


def _unmet(measured: Mapping[str, float], given: Mapping[str, float]) -> tuple[str, ...]:
    """What is to be said of measurements that were given and that this body does not have, mm."""
    differ = [name for name, value in given.items() if name in measured and abs(measured[name] - value) > _SAID_MM]
    return tuple(f"{name} comes out at {measured[name]:.0f} mm where {given[name]:g} mm were given" for name in differ)
