"""Poses of a rigged mannequin: arms, hips and knees turn about their joints, feet stay level as far as the ankles turn, and the whole body stands on the floor,
turns and walks.

A vertex turns by its weight times the angle of the joint, so that shoulder, seat and knee stay smooth. Parts must stay 8 mm apart, and no fold may cross
itself (`gap.py`).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import NamedTuple

import numpy as np

from garmentcad.errors import MannequinError
from garmentcad.mannequin.gap import check_apart, check_uncrossed, facings
from garmentcad.mannequin.mannequin import Mannequin
from garmentcad.mannequin.rig import Rig
from garmentcad.units import MM_TO_M

RANGES = {"arm": (15.0, 60.0), "hip": (-30.0, 70.0), "knee": (0.0, 90.0), "turn": (-360.0, 360.0), "ahead": (-2000.0, 2000.0)}
# Between sampled frames, at most: the cubics between them then keep a limb as thick as it is (turned by 80 degrees from frame to frame a trunk was drawn in
# to two thirds). And so many at least from one key frame to the next: two know nothing of how gently they are to begin.
_FRAME_S, _FRAME_DEG, _FEWEST = 0.1, 15.0, 8
_STEEPEST = 1.5  # rate of an angle half-way between key frames, over its mean
_KNEE, _ANKLE = 0.100, 0.040  # m above and below the joint over which the leg bends
_FOOT_DEG = 35.0  # most that the foot turns against the lower leg to stay level


@dataclass(frozen=True)
class Pose:
    """Angles in degrees. arm: of the arms from the vertical, None as the mannequin was made; hip: thigh forward; knee: bent; turn: the body about the vertical,
    counter-clockwise from above; ahead_mm: the way that it has gone to where it faces at the start."""

    arm_left: float | None = None
    arm_right: float | None = None
    hip_left: float = 0.0
    hip_right: float = 0.0
    knee_left: float = 0.0
    knee_right: float = 0.0
    turn: float = 0.0
    ahead_mm: float = 0.0

    def __post_init__(self) -> None:
        for field in fields(self):
            value = getattr(self, field.name)
            low, high = RANGES[field.name.partition("_")[0]]
            if value is not None and not low <= value <= high:
                raise MannequinError(f"{value:g} came; {allowed(field.name)}", key=field.name)


def allowed(name: str) -> str:
    """What a field of a pose may be, for messages."""
    low, high = RANGES[name.partition("_")[0]]
    return f"a number from {low:g} to {high:g} {'mm' if name == 'ahead_mm' else 'degrees'} is allowed"


class KeyFrame(NamedTuple):
    """A pose that is reached time_s after the start."""

    time_s: float
    pose: Pose


def posed(body: Mannequin, pose: Pose) -> np.ndarray:
    """Vertices (V,3) m of the body in a pose that `motion` has found allowed. MannequinError for a body without a rig (scans, dress forms)."""
    rig = _rig(body)
    points = np.vstack([body.vertices, [rig.joints["ankle"] * [sign, 1.0, 1.0] for sign in (1.0, -1.0)]])
    arm, height = np.r_[rig.arm, 0.0, 0.0], points[:, 1].copy()
    side = np.sign(points[:, 0])
    bent = {"knee": _below(height, rig.joints["knee"][1], _KNEE), "ankle": _below(height, rig.joints["ankle"][1], _ANKLE)}
    bent["ankle"][-2:] = 0.0
    for column, sign, hip, knee, lifted in ((0, 1.0, pose.hip_left, pose.knee_left, pose.arm_left), (1, -1.0, pose.hip_right, pose.knee_right, pose.arm_right)):
        leg = np.r_[rig.leg[:, column], [1.0, 0.0] if column == 0 else [0.0, 1.0]]
        for name, angle, weight in (
            ("ankle", np.clip(hip - knee, -_FOOT_DEG, _FOOT_DEG), leg * bent["ankle"]),
            ("knee", knee, leg * bent["knee"]),
            ("hip", -hip, leg),
        ):
            points = _turned(points, rig.joints[name], 0, np.radians(angle) * weight)
        if lifted is not None:
            shoulder = rig.joints["shoulder"] * [sign, 1.0, 1.0]
            points = _turned(points, shoulder, 2, sign * np.radians(lifted - rig.arm_angle_deg) * arm * (side == sign))
    ankles = points[-2:].mean(axis=0)
    points = points[:-2] - [0.0, points[:-2, 1].min(), ankles[2] - rig.joints["ankle"][2]]
    points = _turned(points, np.zeros(3), 1, np.full(len(points), np.radians(pose.turn)))
    return points + np.array([0.0, 0.0, MM_TO_M * pose.ahead_mm])


def motion(body: Mannequin, frames: Sequence[KeyFrame]) -> tuple[np.ndarray, np.ndarray]:
    """times (K,) s and vertices (K,V,3) m of the way from the body's own pose through key frames; angles go gently from one to the next and rest in each.

    MannequinError, with the time, where parts would come nearer to each other than 8 mm, or the frames are not in order.
    """
    rig = _rig(body)
    before = KeyFrame(0.0, Pose(rig.arm_angle_deg, rig.arm_angle_deg))
    pairs = facings(body)
    times, vertices = [0.0], [body.vertices]
    for number, frame in enumerate(frames):
        span = frame.time_s - before.time_s
        if span <= 0.0:
            raise MannequinError(f"{frame.time_s:g} s is not after {before.time_s:g} s", key=f"frames.{number}.time")
        steps = max(_FEWEST, math.ceil(span / _FRAME_S), math.ceil(_STEEPEST * _turned_by(before.pose, frame.pose) / _FRAME_DEG))
        for step in range(1, steps + 1):
            share = step / steps
            time = before.time_s + share * span
            points = posed(body, _between(before.pose, frame.pose, share * share * (3.0 - 2.0 * share)))
            try:
                check_apart(pairs, points, f"frames.{number}")
                check_uncrossed(body, points, f"frames.{number}")
            except MannequinError as fault:
                raise MannequinError(f"after {time:.2f} s {fault.message}", key=fault.key) from None
            times.append(time)
            vertices.append(points)
        before = KeyFrame(frame.time_s, _between(before.pose, frame.pose, 1.0))
    return np.array(times), np.array(vertices)


def _rig(body: Mannequin) -> Rig:
    if body.rig is None:
        raise MannequinError(f"{body.name} cannot be posed: scans and dress forms have no joints", key="pose")
    return body.rig


def _between(one: Pose, other: Pose, share: float) -> Pose:
    values = {}
    for field in fields(Pose):
        a, b = getattr(one, field.name), getattr(other, field.name)
        values[field.name] = a if b is None else (1.0 - share) * a + share * b
    return Pose(**values)


def _turned_by(one: Pose, other: Pose) -> float:
    """Degrees of the joint that turns most."""
    return max(abs(getattr(_between(one, other, 1.0), field.name) - getattr(one, field.name)) for field in fields(Pose) if field.name != "ahead_mm")


def _below(height: np.ndarray, level: float, room: float) -> np.ndarray:
    """0 above the level, 1 below it, smooth over +- room."""
    t = np.clip((level + room - height) / (2.0 * room), 0.0, 1.0)
    return t * t * (3.0 - 2.0 * t)


def _turned(points: np.ndarray, pivot: np.ndarray, axis: int, angles: np.ndarray) -> np.ndarray:
    """Points (N,3) turned about a coordinate axis through pivot by angles (N,) in rad, right-handed."""
    a, b = (axis + 1) % 3, (axis + 2) % 3
    offset, cosine, sine = points - pivot, np.cos(angles), np.sin(angles)
    turned = points.copy()
    turned[:, a] = pivot[a] + cosine * offset[:, a] - sine * offset[:, b]
    turned[:, b] = pivot[b] + sine * offset[:, a] + cosine * offset[:, b]
    return turned
