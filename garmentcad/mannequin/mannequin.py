"""A mannequin: closed body surface, measurements, landmarks and arrangement cylinders.

World frame: metres, y up, +z front, +x wearer's left.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from garmentcad.errors import MannequinError
from garmentcad.mannequin.rig import Rig

PART_NAMES = ("torso", "arm_left", "arm_right", "leg_left", "leg_right", "head")  # of a whole body
MIN_STATURE_M, MAX_STATURE_M = 0.5, 2.5  # of a body; less is a doll
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


def refuse_no_body(body: Mannequin) -> None:
    """MannequinError for a body that was made by hand and is none: no closed surface of finite points, or none of a body's height in metres."""
    vertices, faces = np.asarray(body.vertices), np.asarray(body.faces)
    if vertices.ndim != 2 or vertices.shape[1] != 3 or faces.ndim != 2 or faces.shape[1] != 3 or len(faces) == 0:
        raise MannequinError(f"vertices {vertices.shape} and faces {faces.shape} came; (V,3) and (F,3) are wanted", key="mannequin")
    if not np.isfinite(vertices).all():
        raise MannequinError("a vertex is not finite", key="mannequin")
    if faces.min() < 0 or faces.max() >= len(vertices):
        raise MannequinError(f"a face names vertex {faces.max() if faces.max() >= len(vertices) else faces.min()} of {len(vertices)}", key="mannequin")
    if np.asarray(body.face_part).shape != (len(faces),):
        raise MannequinError(f"face_part {np.asarray(body.face_part).shape} came; one part for each of {len(faces)} faces is wanted", key="mannequin")
    height = float(np.ptp(vertices[:, 1]))
    if not MIN_STATURE_M <= height <= MAX_STATURE_M:
        raise MannequinError(f"it is {height:.4g} m high; {MIN_STATURE_M:g} to {MAX_STATURE_M:g} m are allowed (metres, y up)", key="mannequin")
    sides = np.sort(faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1).astype(np.int64) @ [len(vertices), 1]
    if (np.unique(sides, return_counts=True)[1] != 2).any():
        raise MannequinError("its surface is not closed: an edge is not that of two faces", key="mannequin")
