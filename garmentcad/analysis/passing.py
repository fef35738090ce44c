"""What a garment has to pass when it is put on: girths of the body along its trunk and limbs, of the head and of the hands."""

from __future__ import annotations

import numpy as np

from garmentcad.errors import MannequinError
from garmentcad.mannequin.mannequin import Mannequin
from garmentcad.mannequin.tape import tape
from garmentcad.units import M_TO_MM

STEP_M = 0.02
_TILTS_DEG = (-30.0, -20.0, -10.0, 0.0, 10.0, 20.0, 30.0)  # of the head, forward and back, while it goes through an opening
_TOP = 0.4  # part of the height of head and neck in which the neck does not lie
_HEAD_M = 0.2  # least height of head and neck: those of the shipped bodies have 0.31 to 0.34, the stump of a dress form less than 0.1
HAND_PER_WRIST = 1.23  # hand without the thumb over wrist, for bodies without hands: 213.8 / 174.3 mm (men), 186.2 / 151.4 mm (women), ANSUR 1988


def girths_along(mannequin: Mannequin, part: str, axis: np.ndarray, low: float, high: float) -> tuple[np.ndarray, np.ndarray]:
    """Heights (N,) m along a unit axis, STEP_M apart from `low` to `high`, and the tape (N,) mm around one part of the body there (0 where it is not)."""
    faces = mannequin.faces[mannequin.face_part == mannequin.part_names.index(part)]
    levels = np.arange(low, high, STEP_M)
    return levels, np.array([_taped(mannequin.vertices, faces, level, axis) for level in levels])


def head_girth_mm(mannequin: Mannequin) -> float | None:
    """Girth of the opening through which the head just goes, tilted as suits it best; None where there is no head."""
    if "head" not in mannequin.part_names:
        return None
    points = mannequin.vertices[np.unique(mannequin.faces[mannequin.face_part == mannequin.part_names.index("head")])]
    if len(points) == 0 or np.ptp(points[:, 1]) < _HEAD_M:
        return None
    found = []
    for tilt in np.radians(_TILTS_DEG):
        axis = np.array([0.0, np.cos(tilt), np.sin(tilt)])
        along = points @ axis
        levels, girths = girths_along(mannequin, "head", axis, float(along.min()) + STEP_M, float(along.max()))
        below = levels < levels[-1] - _TOP * (levels[-1] - levels[0])
        neck = int(np.where(below & (girths > 0.0), girths, np.inf).argmin())
        found.append(float(girths[neck:].max()))
    return min(found)


def hand_girth_mm(mannequin: Mannequin, side: str) -> float | None:
    """Girth of a hand, taped across the forearm's line beyond the wrist; by HAND_PER_WRIST for a body that has none, None without a wrist."""
    elbow, wrist = mannequin.landmarks.get(f"elbow_{side}"), mannequin.landmarks.get(f"wrist_{side}")
    if elbow is None or wrist is None or f"arm_{side}" not in mannequin.part_names:
        return HAND_PER_WRIST * mannequin.measurements_mm["wrist"] if "wrist" in mannequin.measurements_mm else None
    axis = (wrist - elbow) / np.linalg.norm(wrist - elbow)
    along = mannequin.vertices[np.unique(mannequin.faces[mannequin.face_part == mannequin.part_names.index(f"arm_{side}")])] @ axis
    return float(girths_along(mannequin, f"arm_{side}", axis, float(wrist @ axis), float(along.max()))[1].max(initial=0.0))


def _taped(vertices: np.ndarray, faces: np.ndarray, level: float, axis: np.ndarray) -> float:
    try:
        return M_TO_MM * tape(vertices, faces, level * axis, axis).girth
    except MannequinError:
        return 0.0
