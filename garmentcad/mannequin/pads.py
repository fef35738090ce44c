"""Shoulder pads: a smooth wedge on each shoulder that ends beyond the shoulder point."""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np

from garmentcad.errors import MannequinError
from garmentcad.geometry.portable import product
from garmentcad.mannequin.human import HumanModel, Shape
from garmentcad.units import MM_TO_M

RANGES_MM = {"thickness": (2.0, 40.0), "length": (40.0, 150.0), "width": (60.0, 220.0), "overhang": (0.0, 30.0)}
_END = 0.018  # m beyond the overhang within which the pad falls to the arm
_NEAR = 0.08  # m above and below the shoulder line: not the head, not the chest
_RIDGE = 0.012  # m to either side of the shoulder line


@dataclass(frozen=True)
class ShoulderPads:
    """mm. thickness at the shoulder point, from where the pad thins toward the neck over its length; width from front to back; overhang beyond the point."""

    thickness: float
    length: float = 110.0
    width: float = 150.0
    overhang: float = 10.0

    def __post_init__(self) -> None:
        for field in fields(self):
            value = getattr(self, field.name)
            low, high = RANGES_MM[field.name]
            if isinstance(value, bool) or not isinstance(value, int | float) or not low <= value <= high:
                raise MannequinError(f"{value!r} is refused; allowed: {low:g} to {high:g} mm", key=f"shoulder_pads.{field.name}")


def pad_shoulders(model: HumanModel, body: Shape, pads: ShoulderPads, neck_side: np.ndarray) -> tuple[Shape, np.ndarray]:
    """The half body with its pad, and the shoulder point at the pad's end (3,). neck_side: (3,) where the shoulder line begins."""
    points = body.points
    tip = points[model.landmarks["shoulder_point"]]
    line = tip - neck_side
    run = np.hypot(line[0], line[2])
    outward, slope = np.array([line[0], 0.0, line[2]]) / run, line[1] / run
    along = product(points - tip, outward)
    across = product(points - tip, np.cross(outward, [0.0, 1.0, 0.0]))
    upward = np.clip(_normals(points, model.faces)[:, 1] / 0.5, 0.0, 1.0)
    thickness, length, width, overhang = (MM_TO_M * value for value in (pads.thickness, pads.length, pads.width, pads.overhang))
    rows = np.flatnonzero((np.abs(across) < _RIDGE) & (upward > 0.3) & (along > -length) & (along < overhang + 2 * _END) & (points[:, 1] > tip[1] - 0.1))
    rows = rows[np.argsort(along[rows], kind="stable")]
    ridge = np.interp(along, along[rows], points[rows, 1])  # height of the body under the shoulder line
    fallen = np.where(along > 0.0, np.maximum(tip[1] + slope * along - ridge, 0.0), 0.0)
    wedge = np.clip(1.0 + along / length, 0.0, 1.0) * thickness + fallen
    end = _smooth(1.0 + (overhang - along) / _END)
    side = _smooth(1.5 * (1.0 - np.abs(across) / (0.5 * width)))
    near = np.abs(points[:, 1] - tip[1] - slope * along) < _NEAR
    lifted = points.copy()
    lifted[:, 1] += np.where(near, wedge * end * side * upward, 0.0)
    end_of_line = tip + overhang * outward
    return Shape(lifted, body.joints), end_of_line + np.array([0.0, overhang * slope + thickness, 0.0])


def _smooth(value: np.ndarray) -> np.ndarray:
    t = np.clip(value, 0.0, 1.0)
    return t * t * (3.0 - 2.0 * t)


def _normals(points: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """(N,3) unit normals of the vertices."""
    a, b, c = (points[faces[:, k]] for k in range(3))
    across = np.cross(b - a, c - a)
    total = np.zeros_like(points)
    for k in range(3):
        np.add.at(total, faces[:, k], across)
    return total / np.maximum(np.linalg.norm(total, axis=1, keepdims=True), 1e-30)
