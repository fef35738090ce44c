"""The rig of a mannequin: joints, and how much each vertex follows each limb."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from garmentcad.arrays import floats, frozen
from garmentcad.mannequin.human import HumanModel, Shape
from garmentcad.mannequin.smooth import averaging

_LEG_SMOOTHING = 60  # times half-way to the mean of the neighbours: the seat belongs to both legs


class Rig(NamedTuple):
    """joints: (3,) m of the left half (shoulder, hip, knee, ankle; the right ones are their mirror images); arm: (V,) and leg: (V,2, left and right), 0 for
    a vertex that does not follow the limb, 1 for one that does; arm_angle_deg: of the arms as they are, from the vertical."""

    joints: dict[str, np.ndarray]
    arm: np.ndarray
    leg: np.ndarray
    arm_angle_deg: float


def rig_of(model: HumanModel, body: Shape, arm_angle_deg: float) -> Rig:
    """The rig of a finished half body, for the vertices of `HumanModel.whole`."""
    whole = model.whole(body.points)
    arm, leg = (np.r_[weight, weight[model.border :]] for weight in (model.arm_weight, model.leg_weight))
    side = np.sign(whole[0][:, 0])
    average = averaging(whole[1], len(whole[0]))
    legs = []
    for sign in (1.0, -1.0):
        weight = leg * 0.5 * (1.0 + sign * side)
        for _ in range(_LEG_SMOOTHING):
            weight = 0.5 * (weight + average @ weight)
        legs.append(weight)
    joints = {name: body.joints[name] for name in ("shoulder", "hip", "knee", "ankle")}
    return Rig(joints, frozen(floats(arm)), frozen(floats(np.column_stack(legs))), arm_angle_deg)
