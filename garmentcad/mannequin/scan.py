"""A scanned body as a mannequin. Landmarks are estimated from proportions of the stature and snapped to the surface; girths are taped on it."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import pairwise
from typing import Any

import numpy as np

from garmentcad.arrays import floats, frozen, indices
from garmentcad.errors import MannequinError
from garmentcad.geometry.portable import norm, product
from garmentcad.mannequin.cylinder import enclosing, on_floor
from garmentcad.mannequin.mannequin import PART_NAMES, ArrangementCylinder, Mannequin
from garmentcad.mannequin.tape import cut, tape
from garmentcad.units import M_TO_MM, MM_TO_M

_UP, _FRONT = np.array([0.0, 1.0, 0.0]), np.array([0.0, 0.0, 1.0])
# Heights as shares of the stature (the shipped bodies' proportions; estimates for any other body).
_SHARES = {"knee": 0.272, "crotch": 0.453, "hip": 0.494, "waist": 0.617, "bust": 0.720, "armpit": 0.742, "shoulder": 0.818, "neck_front": 0.833, "nape": 0.863}
_REACH = 0.18
# A body that stands askew has arms that are nowhere: 20 degrees leave room for one hand that is held farther forward. Turned by 5 degrees `woman-88` keeps
# all its girths, by 8 its bust takes in part of an arm (72 mm more), which is said. Toes lie 0.05 to 0.06 of the stature farther from the ankle than heels do
# on the shipped bodies; less than the share here is no sign of toes at the back.
_ASKEW_DEG, _SAID_DEG, _TOES = 20.0, 6.0, 0.03
# Level of the neck and share of a head, in percent of the stature: the shipped bodies have their necks at 85 to 87, are 1.3 to 2.1 times as wide above it, and
# at 90 measure 0.24 to 0.27 of the stature around. Cut at the chin or below, they are narrowest on top and measure more than 0.5 of what is left there.
_LEVELS, _NECK, _HEAD = range(80, 100), 93, 90
_WIDER, _NO_HEAD = 1.10, 0.45
_SHOULDER_X, _ARMPIT_X, _NECK_X = 0.108, 0.100, 0.060
_BACK_WIDTH, _CHEST_FRONT = 0.39, 0.37  # of the bust


def mannequin_of_scan(
    vertices: np.ndarray, faces: np.ndarray, *, name: str, heights_mm: Mapping[Any, float] | None = None, notes: tuple[str, ...] = ()
) -> Mannequin:
    """The mannequin of a closed scan: vertices (V,3) m, y up, facing +z, arms away from the body, legs apart; it is moved to the floor and to x = 0.

    `estimated` names what rests on proportions: all landmarks but waist and hip, all heights and lengths, and of the girths, which are taped in those planes,
    those that change fast from plane to plane: neck base (17 % too low on shipped women, whose necks begin lower), upper arm and wrist.
    heights_mm: of body lines above the floor, in place of those by proportion; notes: what was done to the surface, and what else is to be said of it.
    MannequinError when a plane misses the body (not a standing body with two legs and two arms), its head is missing, or hands or toes tell that it faces
    elsewhere.
    """
    points = vertices - [0.0, vertices[:, 1].min(), 0.0]
    stature = float(points[:, 1].max())
    given = {} if heights_mm is None else {level: MM_TO_M * height for level, height in heights_mm.items()}
    heights = {level: share * stature for level, share in _SHARES.items()} | given
    if [*heights.values()] != sorted(heights.values()):
        said = ", ".join(f"{level} {M_TO_MM * height:.0f}{'' if level in given else ' by proportion'}" for level, height in heights.items())
        raise MannequinError(f"heights of body lines rise in this order: {said} mm do not", key="heights")
    ring = cut(points, faces, heights["waist"] * _UP, _UP).points
    if len(ring) < 3:
        raise MannequinError("there is no body at waist height")
    trunk = ring[np.abs(ring[:, 0] - np.median(ring[:, 0])) < 0.15 * stature]
    points = points - [0.5 * (trunk[:, 0].min() + trunk[:, 0].max()), 0.0, 0.5 * (trunk[:, 2].min() + trunk[:, 2].max())]
    knees = cut(points, faces, heights["knee"] * _UP, _UP).points
    if len(knees) == 0 or np.abs(knees[:, 0]).min() < 0.003:
        raise MannequinError("the legs are not apart at knee height; a body that stands with its legs apart is wanted (y up, facing +z)")
    if min(points[:, 0].max(), -points[:, 0].min()) < _REACH * stature:
        raise MannequinError("the arms are not away from the body (the hands must reach out 0.18 of the stature to both sides)")
    notes = (*notes, *_facing(points, stature), *_headed(points, faces, stature))
    marks = _landmarks(points, faces, heights, stature)
    notes = (*notes, *_raised(marks))
    part = _parts(points, faces, marks)
    counts = np.bincount(part, minlength=len(PART_NAMES))
    if (counts < 3).any():
        raise MannequinError(f"no {PART_NAMES[int(counts.argmin())]} is found where a standing body has it (y up, facing +z, arms away from the body)")
    measured = _measurements(points, faces, part, marks, heights, stature)
    girths = ["bust", "waist", "hip", "thigh", "stature", *(["neck_base"] if {"nape", "neck_front"} <= given.keys() else [])]
    return Mannequin(
        name=name,
        vertices=frozen(floats(points)),
        faces=frozen(indices(faces)),
        measurements_mm=measured,
        landmarks=marks,
        cylinders=_cylinders(points, faces, part, marks, heights),
        part_names=PART_NAMES,
        face_part=frozen(indices(part)),
        notes=notes,
        estimated=tuple(key for key in measured if key not in girths and key.removesuffix("_height") not in given)
        + tuple(key for key in marks if not key.startswith(("waist", "hip"))),
    )


def _facing(points: np.ndarray, stature: float) -> tuple[str, ...]:
    """MannequinError for a body of points (V,3) m that is turned about the vertical, by its hands and its feet, and what to say of one that is turned a
    little; stature: m."""
    left, right = points[points[:, 0].argmax()], points[points[:, 0].argmin()]
    askew = float(np.degrees(np.arctan2(right[2] - left[2], left[0] - right[0])))
    if abs(askew) > _ASKEW_DEG:
        raise MannequinError(f"from hand to hand it stands askew by {abs(askew):.0f} degrees; turn it to face +z, its left hand toward +x")
    soles, ankles = (points[(points[:, 1] >= low * stature) & (points[:, 1] <= high * stature)] for low, high in ((0.0, 0.03), (0.045, 0.07)))
    if len(soles) > 0 and len(ankles) > 0:
        ankle = 0.5 * (ankles[:, 2].min() + ankles[:, 2].max())
        if (ankle - soles[:, 2].min()) - (soles[:, 2].max() - ankle) > _TOES * stature:
            raise MannequinError("its toes point to -z; turn it to face +z, its left hand toward +x")
    return (f"from hand to hand it stands askew by {abs(askew):.0f} degrees: girths may take in part of an arm",) if abs(askew) > _SAID_DEG else ()


def _headed(points: np.ndarray, faces: np.ndarray, stature: float) -> tuple[str, ...]:
    """MannequinError for a body without its head, by girths of level sections near its top, and what to say where hair may hide the neck or the crown is
    missing; stature: m."""
    girths = {level: tape(points, faces, 0.01 * level * stature * _UP, _UP).girth for level in _LEVELS}
    neck = min((level for level in _LEVELS if level <= _NECK), key=lambda level: girths[level])
    if max(girth for level, girth in girths.items() if level >= neck) >= _WIDER * girths[neck]:
        above = M_TO_MM * (1.0 - 0.01 * neck) * stature
        return (f"its head rises only {above:.0f} mm above its neck; where its crown is missing, heights by proportion lie too low",) if neck > _HEAD else ()
    if girths[_HEAD] > _NO_HEAD * stature:
        raise MannequinError(
            f"its head is missing: at {_HEAD} % of its height it measures {M_TO_MM * girths[_HEAD]:.0f} mm around, as shoulders do, and there is no neck below "
            "something wider; the scan of a whole body is wanted, with its head"
        )
    return ("no neck is seen below the head, as where hair lies over it: landmarks and girth of the neck may be off",)


def _nearest(points: np.ndarray, place: list[float]) -> np.ndarray:
    return points[np.linalg.norm(points - place, axis=1).argmin()]


def _landmarks(points: np.ndarray, faces: np.ndarray, heights: dict[str, float], stature: float) -> dict[str, np.ndarray]:
    def level(height: float, reach: float) -> np.ndarray:
        ring = cut(points, faces, height * _UP, _UP).points
        ring = ring[np.abs(ring[:, 0]) < reach * stature]
        if len(ring) < 3:
            raise MannequinError(f"there is no body at {height:.2f} m above the floor")
        return ring

    marks: dict[str, np.ndarray] = {}
    for name in ("waist", "hip"):
        ring = level(heights[name], 0.14)
        middle = ring[np.abs(ring[:, 0]) < 0.03 * stature]
        if len(middle) == 0:
            raise MannequinError(f"there is no body in the middle at {heights[name]:.2f} m above the floor")
        marks |= {f"{name}_front": middle[middle[:, 2].argmax()], f"{name}_back": middle[middle[:, 2].argmin()]}
        marks |= {f"{name}_left": ring[ring[:, 0].argmax()], f"{name}_right": ring[ring[:, 0].argmin()]}
    for name, facing in (("nape", -1.0), ("neck_front", 1.0)):
        ring = level(heights[name], 0.02)
        marks[name] = ring[(facing * ring[:, 2]).argmax()]
    marks["crotch"] = np.array([0.0, heights["crotch"], 0.5 * (marks["hip_front"][2] + marks["hip_back"][2])])
    depth = 0.5 * (marks["nape"][2] + marks["neck_front"][2])
    neck_height = 0.5 * (marks["nape"][1] + marks["neck_front"][1])
    for side, sign in (("left", 1.0), ("right", -1.0)):
        half = points[sign * points[:, 0] > 0]
        if len(half) < 3:
            raise MannequinError(f"there is no body on the {side} side")
        marks[f"neck_side_{side}"] = _nearest(half, [sign * 0.6 * _NECK_X * stature, neck_height, depth])
        shoulder = marks[f"shoulder_point_{side}"] = _nearest(half, [sign * _SHOULDER_X * stature, heights["shoulder"], depth])
        marks[f"armpit_{side}"] = np.array([sign * _ARMPIT_X * stature, heights["armpit"], shoulder[2]])
        band = half[(np.abs(half[:, 1] - heights["bust"]) < 0.012 * stature) & (np.abs(np.abs(half[:, 0]) - 0.05 * stature) < 0.02 * stature)]
        marks[f"bust_point_{side}"] = band[band[:, 2].argmax()] if len(band) else _nearest(half, [sign * 0.05 * stature, heights["bust"], 0.2])
        tip = half[np.abs(half[:, 0]).argmax()]
        start = shoulder - [0.0, 0.03 * stature, 0.0]
        marks[f"elbow_{side}"], marks[f"wrist_{side}"] = start + 0.43 * (tip - start), start + 0.77 * (tip - start)
        for name, height in (("knee", heights["knee"]), ("ankle", 0.045 * stature)):
            ring = cut(points, faces, height * _UP, _UP).points
            ring = ring[sign * ring[:, 0] > 0]
            if len(ring) < 3:
                raise MannequinError(f"there is no {side} leg at {height:.2f} m above the floor")
            marks[f"{name}_{side}"] = 0.5 * (ring.min(0) + ring.max(0))
    return marks


def _neck_normal(marks: dict[str, np.ndarray]) -> np.ndarray:
    normal = np.cross(marks["neck_front"] - marks["nape"], [1.0, 0.0, 0.0])
    normal /= norm(normal)
    return normal * np.sign(normal[1])


def _raised(marks: dict[str, np.ndarray]) -> tuple[str, ...]:
    """What to say of arms that `_parts`, whose planes lean with hanging ones, tells wrongly."""
    said = []
    for side in ("left", "right"):
        wrist, armpit, shoulder = (float(marks[f"{name}_{side}"][1]) for name in ("wrist", "armpit", "shoulder_point"))
        if not wrist < armpit < shoulder:
            came = f"wrist at {wrist:.2f} m, armpit at {armpit:.2f}, shoulder at {shoulder:.2f}"
            said.append(f"its {side} arm is raised ({came}): a part of it counts as trunk, and its girths are too small; arms that hang are wanted")
    return tuple(said)


def _parts(points: np.ndarray, faces: np.ndarray, marks: dict[str, np.ndarray]) -> np.ndarray:
    """Arms beyond the planes through shoulder point and armpit, legs below the crotch, head above the neck base plane."""
    centre = points[faces].mean(1)
    part = np.zeros(len(faces), np.int32)
    part[product(centre - marks["nape"], _neck_normal(marks)) > 0] = PART_NAMES.index("head")
    part[centre[:, 1] < marks["crotch"][1]] = np.where(centre[:, 0] > 0, PART_NAMES.index("leg_left"), PART_NAMES.index("leg_right"))[
        centre[:, 1] < marks["crotch"][1]
    ]
    for side, sign in (("left", 1.0), ("right", -1.0)):
        tip, pit, wrist = (sign * marks[f"{name}_{side}"][0] for name in ("shoulder_point", "armpit", "wrist"))
        heights = [marks[f"{name}_{side}"][1] for name in ("wrist", "armpit", "shoulder_point")]
        limit = np.interp(centre[:, 1], heights, [0.6 * wrist + 0.4 * pit, pit, tip])
        part[(sign * centre[:, 0] > limit) & (centre[:, 1] < marks[f"shoulder_point_{side}"][1] + 0.05)] = PART_NAMES.index(f"arm_{side}")
    return part


def _measurements(
    points: np.ndarray, faces: np.ndarray, part: np.ndarray, marks: dict[str, np.ndarray], heights: dict[str, float], stature: float
) -> dict[str, float]:
    def of(*names: str) -> np.ndarray:
        return faces[np.isin(part, [PART_NAMES.index(name) for name in names])]

    def girth(chosen: np.ndarray, origin: np.ndarray, normal: np.ndarray) -> float:
        return M_TO_MM * tape(points, chosen, origin, normal / norm(normal)).girth

    def between(*names: str) -> float:
        return M_TO_MM * float(sum(norm(marks[b] - marks[a]) for a, b in pairwise(names)))

    found = {name: girth(of("torso"), heights[name] * _UP, _UP) for name in ("bust", "waist", "hip")}
    found["thigh"] = girth(of("leg_left"), (heights["crotch"] - 0.02) * _UP, _UP)
    found["neck_base"] = girth(of("torso", "head"), marks["nape"], _neck_normal(marks))
    forearm = marks["wrist_left"] - marks["elbow_left"]
    upper = 0.5 * (marks["shoulder_point_left"] + marks["elbow_left"])
    found["top_arm"] = girth(of("arm_left"), upper, marks["elbow_left"] - marks["shoulder_point_left"])
    found["wrist"] = girth(of("arm_left"), marks["wrist_left"], forearm)
    found["stature"] = M_TO_MM * stature
    found["back_width"], found["chest_front"] = _BACK_WIDTH * found["bust"], _CHEST_FRONT * found["bust"]
    found["shoulder"] = between("neck_side_left", "shoulder_point_left")
    found["arm_length"] = between("shoulder_point_left", "elbow_left", "wrist_left")
    for name in ("knee", "crotch", "hip", "waist", "bust", "shoulder", "neck_front", "nape"):
        found[f"{name}_height"] = M_TO_MM * heights[name]
    found["armscye_depth"] = M_TO_MM * (heights["nape"] - heights["armpit"])
    for name, low, high in (("nape_to_waist", "waist", "nape"), ("waist_to_hip", "hip", "waist"), ("waist_to_knee", "knee", "waist")):
        found[name] = M_TO_MM * (heights[high] - heights[low])
    found["waist_to_floor"] = M_TO_MM * heights["waist"]
    return found


def _cylinders(
    points: np.ndarray, faces: np.ndarray, part: np.ndarray, marks: dict[str, np.ndarray], heights: dict[str, float]
) -> dict[str, ArrangementCylinder]:
    def of(name: str) -> np.ndarray:
        return points[np.unique(faces[part == PART_NAMES.index(name)])]

    torso = of("torso")
    torso = torso[(torso[:, 1] > heights["hip"] - 0.02) & (torso[:, 1] < heights["shoulder"])]
    axis = _neck_normal(marks)
    base = 0.5 * (marks["nape"] + marks["neck_front"])
    head = of("head")
    found = {
        "torso": enclosing(torso, on_floor(torso), _UP, _FRONT),
        "neck": enclosing(head[product(head - base, axis) < 0.05], base, axis, _FRONT - product(_FRONT, axis) * axis),
    }
    for side, sign in (("left", 1.0), ("right", -1.0)):
        leg = of(f"leg_{side}")
        leg = leg[leg[:, 1] > marks[f"ankle_{side}"][1]]
        found[f"leg_{side}"] = enclosing(leg, on_floor(leg), _UP, _FRONT)
        shoulder = marks[f"shoulder_point_{side}"] - [0.0, 0.03 * marks["nape"][1], 0.0]
        up = shoulder - marks[f"wrist_{side}"]
        length = norm(up)
        up = up / length
        outward = sign * np.array([1.0, 0.0, 0.0])
        arm = of(f"arm_{side}")
        along = product(arm - shoulder, up)
        found[f"arm_{side}"] = enclosing(arm[(along < -0.05) & (along > -length)], shoulder, up, outward - product(outward, up) * up)
    return found
