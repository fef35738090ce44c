"""HumanModel: the arrays of mannequins/human.npz, and bodies as linear combinations of its targets (before standing, posing and taping)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

KINDS = {"woman": "female", "man": "male"}  # and the word for it in the names of human.npz
_LEVELS = ("min", "average", "max")


class Shape(NamedTuple):
    """A left half body."""

    points: np.ndarray  # (N,3) m
    joints: dict[str, np.ndarray]  # (3,) m: shoulder, elbow, wrist, hip, knee, ankle, neck, head; waist_level, hip_level: the height alone counts


@dataclass(frozen=True, eq=False)
class HumanModel:
    """The left half (x >= 0) of the bodies of one kind (woman or man), linear in its targets.

    The first `border` vertices lie in x = 0; the right half is the mirror image. Faces are counter-clockwise seen from outside. A target is a
    displacement of all vertices for weight 1; names: female-average-max ... (whole shapes by muscle and weight), cup, firmness, and one direction for
    each tape measure (bust-circ ...). Lengths in m, floor not yet at 0.
    """

    kind: str  # woman or man
    base: np.ndarray  # (N,3)
    faces: np.ndarray  # (M,3) int32
    border: int
    target_names: tuple[str, ...]
    targets: np.ndarray  # (T,N,3)
    joint_names: tuple[str, ...]
    joints: np.ndarray  # (J,3)
    joint_targets: np.ndarray  # (T,J,3)
    arm_weight: np.ndarray  # (N,) 0 torso .. 1 arm
    leg_weight: np.ndarray  # (N,) 0 torso .. 1 leg
    landmarks: dict[str, int]  # vertex of nape, neck_front, crotch, top, bust_point, shoulder_point, armpit
    part_names: tuple[str, ...]  # torso, arm, leg, head
    face_part: np.ndarray  # (M,) int32

    def shape(self, weights: np.ndarray) -> Shape:
        """The body for target weights (T,)."""
        points = self.base + np.einsum("t,tnk->nk", weights, self.targets)
        points[: self.border, 0] = 0.0
        joints = self.joints + np.einsum("t,tjk->jk", weights, self.joint_targets)
        return Shape(points, dict(zip(self.joint_names, joints)))

    def part_faces(self, *names: str) -> np.ndarray:
        """(K,3) faces of the parts."""
        chosen = np.array([name in names for name in self.part_names])
        return self.faces[chosen[self.face_part]]

    def mirrored_vertices(self) -> np.ndarray:
        """(N,) index of each left vertex's mirror image in the whole mesh (`whole`); border vertices are their own."""
        count = len(self.base)
        return np.r_[np.arange(self.border), count + np.arange(count - self.border)]

    def whole(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Vertices and faces (2M, left ones first) of the closed body."""
        vertices = np.vstack([points, points[self.border :] * [-1.0, 1.0, 1.0]])
        return vertices, np.vstack([self.faces, self.mirrored_vertices()[self.faces][:, ::-1]]).astype(np.int32)


def build_weights(muscle: float, weight: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Bilinear weights of the nine muscle x weight shapes for muscle and weight in 0..1, and their derivatives: three arrays (9,)."""
    value_m, slope_m = _hat(muscle)
    value_w, slope_w = _hat(weight)
    return np.outer(value_m, value_w).ravel(), np.outer(slope_m, value_w).ravel(), np.outer(value_m, slope_w).ravel()


def _hat(value: float) -> tuple[np.ndarray, np.ndarray]:
    """Piecewise linear weights at 0, 1/2, 1 and their slopes."""
    first = value < 0.5
    t = 2.0 * value - (0.0 if first else 1.0)
    values, slopes = [1.0 - t, t], [-2.0, 2.0]
    return np.array([*values, 0.0] if first else [0.0, *values]), np.array([*slopes, 0.0] if first else [0.0, *slopes])


def build_names(kind: str) -> list[str]:
    """Names of the nine muscle x weight shapes of a kind, in the order of `build_weights`."""
    return [f"{KINDS[kind]}-{muscle}-{weight}" for muscle in _LEVELS for weight in _LEVELS]
