"""Parts of the body that a garment goes around, and their girths."""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from garmentcad.analysis.passing import STEP_M, girths_along, hand_girth_mm, head_girth_mm
from garmentcad.analysis.section import Chain, Plane, cut
from garmentcad.mannequin.mannequin import Mannequin
from garmentcad.units import MM_TO_M

# Pressure at which clothing begins to hurt: 60 to 100 gf/cm2, Denton 1972 (Fit, stretch and comfort, Shirley Institute).
HURTS_PA = 5.9e3
_ABOVE_ANKLE_M, _NECK_M, _BELOW_NECK_M = 0.02, 0.10, 0.15  # below the neck lies a neckline


class BodyPart(NamedTuple):
    """A part of the body that rings go around, the neck with the head. levels (N,) m along `axis`, taped girths (N,) mm there; passed (N,) mm: what a ring at
    each level has to pass; by: what that is; top (3,) m: its highest point; middles (N,3) m: of the
    body where a plane at each level cuts the part, of its axis where none does."""

    name: str
    origin: np.ndarray
    axis: np.ndarray
    levels: np.ndarray
    girths: np.ndarray
    passed: np.ndarray
    by: str
    top: np.ndarray
    middles: np.ndarray

    @property
    def said(self) -> str:
        """Its name in messages."""
        name, _, side = self.name.partition("_")
        return f"{side} {name}" if side else {"torso": "trunk"}.get(name, name)

    def girths_near(self, level: float, reach: float) -> np.ndarray:
        """Girths, mm, at most `reach` m away from a level along the part; none where the part is not."""
        return self.girths[(np.abs(self.levels - level) <= reach) & (self.girths > 0.0)]


@lru_cache(maxsize=4)  # many garments are checked on one body, which is taped at some 300 levels
def body_parts(body: Mannequin) -> tuple[BodyPart, ...]:
    """Trunk, neck, arms and legs of a body, as far as it has them."""
    found = []
    for name in ("torso", "neck", "arm_left", "arm_right", "leg_left", "leg_right"):
        where = "head" if name == "neck" else name
        if name not in body.cylinders or where not in body.part_names:
            continue
        cylinder = body.cylinders[name]
        faces = body.faces[body.face_part == body.part_names.index(where)]
        points = body.vertices[np.unique(faces)]
        if len(points) == 0:
            continue
        along = (points - cylinder.origin) @ cylinder.up
        low, high = float(along.min()), float(along.max())
        if name == "neck":
            low, high = low - _BELOW_NECK_M, min(high, _NECK_M)
        elif name.startswith("leg") and f"ankle_{name[4:]}" in body.landmarks:
            low = float((body.landmarks[f"ankle_{name[4:]}"] - cylinder.origin) @ cylinder.up) + _ABOVE_ANKLE_M
        levels, girths = girths_along(body, where, cylinder.up, low + float(cylinder.origin @ cylinder.up), high + float(cylinder.origin @ cylinder.up))
        from_below = np.maximum.accumulate(girths)
        # Raised arms narrow the shoulders: from above the bust is the least that has to pass.
        low_enough = levels <= MM_TO_M * body.measurements_mm.get("bust_height", np.inf) + 0.5 * STEP_M
        from_above = np.maximum.accumulate(np.where(low_enough, girths, 0.0)[::-1])[::-1]
        passed, by = from_below, "leg"
        if name == "torso":
            passed, by = np.minimum(from_below, from_above), "hip or the bust"
        elif name == "neck":
            passed, by = np.full(len(levels), head_girth_mm(body) or 0.0), "head"
        elif name.startswith("arm"):
            passed, by = np.maximum(from_below, hand_girth_mm(body, name[4:]) or 0.0), "hand or the arm"
        middles = np.array([_middle(body.vertices, faces, Plane(cylinder.up, level), cylinder.origin) for level in levels.tolist()]).reshape(-1, 3)
        found.append(BodyPart(name, cylinder.origin, cylinder.up, levels, girths, passed, by, points[np.argmax(points[:, 1])], middles))
    return tuple(found)


def _middle(vertices: np.ndarray, faces: np.ndarray, plane: Plane, origin: np.ndarray) -> np.ndarray:
    sections = cut(vertices, faces, plane)
    if not sections:
        return np.asarray(origin + (plane.offset - origin @ plane.normal) * plane.normal)
    points = max(sections, key=Chain.length).points
    steps = np.linalg.norm(np.roll(points, -1, axis=0) - points, axis=1)
    return np.asarray(np.average(points, axis=0, weights=steps + np.roll(steps, 1)))
