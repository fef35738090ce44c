"""Lines on the body where a garment is measured: those of the limbs, and any that the user names."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from garmentcad.analysis.section import Plane, horizontal
from garmentcad.errors import InputError
from garmentcad.mannequin.mannequin import Mannequin
from garmentcad.mannequin.tapes import THIGH_BELOW_CROTCH, TOP_ARM_SHARE
from garmentcad.units import MM_TO_M

SIDES = ("left", "right")
LIMB_LINES = tuple(f"{name}_{side}" for name in ("top_arm", "thigh") for side in SIDES)
_ALLOWED = "allowed is NAME=HEIGHT in mm above the floor, or NAME=x,y,z:nx,ny,nz with a point in mm and the plane's normal"


@dataclass(frozen=True)
class BodyLine:
    """A named plane; part: the body part that the garment's loop must go around, alone, or None for any."""

    name: str
    plane: Plane
    part: str | None = None


def limb_lines(mannequin: Mannequin) -> list[BodyLine]:
    """Lines of LIMB_LINES that the mannequin has marks for: midway between shoulder joint and elbow, square to the upper arm, and 20 mm below the crotch."""
    found = []
    for side in SIDES:
        elbow, arm = mannequin.landmarks.get(f"elbow_{side}"), mannequin.cylinders.get(f"arm_{side}")
        if elbow is not None and arm is not None:
            along = (elbow - arm.origin) / np.linalg.norm(elbow - arm.origin)
            middle = arm.origin + TOP_ARM_SHARE * (elbow - arm.origin)
            found.append(BodyLine(f"top_arm_{side}", Plane(along, float(middle @ along)), f"arm_{side}"))
        if "crotch_height" in mannequin.measurements_mm and f"leg_{side}" in mannequin.part_names:
            height = MM_TO_M * mannequin.measurements_mm["crotch_height"] - THIGH_BELOW_CROTCH
            found.append(BodyLine(f"thigh_{side}", horizontal(height), f"leg_{side}"))
    return found


def parse_line(text: str) -> BodyLine:
    """`high-hip=930` (a level) or `seat=0,930,0:0,1,-0.2` (a point and a normal). InputError for anything else."""
    name, equals, place = text.partition("=")
    point, colon, normal = place.partition(":")
    numbers = [_numbers(part) for part in (point, normal)[: 2 if colon else 1]]
    if not name.strip() or not equals or [len(row) for row in numbers] not in ([1], [3, 3]):
        raise InputError(f"{text[:100]!r} is no line; {_ALLOWED}", key="lines")
    if len(numbers) == 1:
        return BodyLine(name.strip(), horizontal(MM_TO_M * numbers[0][0]))
    across, length = np.array(numbers[1]), float(np.linalg.norm(numbers[1]))
    if length == 0.0:
        raise InputError(f"{text[:100]!r} has a normal without length; {_ALLOWED}", key="lines")
    return BodyLine(name.strip(), Plane(across / length, MM_TO_M * float(np.array(numbers[0]) @ across) / length))


def _numbers(text: str) -> list[float]:
    """Finite numbers between commas; [] where there is anything else."""
    try:
        numbers = [float(word) for word in text.split(",")]
    except ValueError:
        return []
    return numbers if all(math.isfinite(number) and abs(number) < 1e6 for number in numbers) else []
