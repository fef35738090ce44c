"""A mannequin: closed body surface, measurements, landmarks and arrangement cylinders.

World frame: metres, y up, +z front, +x wearer's left.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from garmentcad.mannequin.rig import Rig

PART_NAMES = ("torso", "arm_left", "arm_right", "leg_left", "leg_right", "head")  # of a whole body
SHOULDER_RISE = 0.94  # horizontal share of the shoulder seam (cosine of its slope)


@dataclass(frozen=True)
class ArrangementCylinder:
    """Elliptic cylinder around a body part, on which panels are wrapped.

    A point at angle t [rad] and height s [m] is  origin + s up + radius_ref cos(t) ref + radius_side sin(t) (up x ref).
    torso and legs: `up` is +y, origin on the floor (heights are heights above the floor), ref = +z (angle 0 is the front, 90 degrees the wearer's left).
    arms: `up` points from wrist to shoulder, origin at the shoulder joint (heights are negative toward the wrist), ref points outward, away from the torso.
    """

    origin: np.ndarray  # (3,) m
    up: np.ndarray  # (3,) unit
    ref: np.ndarray  # (3,) unit, perpendicular to up
    radius_ref: float  # m
    radius_side: float  # m


@dataclass(frozen=True, eq=False)
class Mannequin:
    """A body, equal to itself alone. `faces` are counter-clockwise seen from outside; the surface is closed.

    measurements_mm: girths, lengths and `*_height` (above the floor) under the names of docs/spec.md; landmarks: points on or in the body, m;
    cylinders: torso, neck, arm_left, arm_right, leg_left, leg_right; face_part: index into part_names for each face (the torso alone is taped).
    """

    name: str
    vertices: np.ndarray  # (V,3) m
    faces: np.ndarray  # (F,3) int32
    measurements_mm: dict[str, float]
    landmarks: dict[str, np.ndarray]
    cylinders: dict[str, ArrangementCylinder]
    part_names: tuple[str, ...]
    face_part: np.ndarray  # (F,) int32
    rig: Rig | None = None  # of bodies that can be posed
    estimated: tuple[str, ...] = ()  # measurements and landmarks that were not found on this body but taken from a table or from proportions
    notes: tuple[str, ...] = ()  # measurements that were given and that it does not have; what was done to a scan's surface
