"""Points that lie inside a body: in which of its parts, and what brings them out."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from garmentcad.mannequin.mannequin import Mannequin
from garmentcad.mannequin.pose import MAX_ARM_ANGLE_DEG
from garmentcad.units import M_TO_MM

SHALLOW_M = 0.010  # shallower points are moved out before the start


def place_inside(points: np.ndarray, mannequin: Mannequin) -> str:
    """Parts of the body and heights of points (N,3) m inside it."""
    heights = M_TO_MM * points[:, 1]
    return f"in {' and '.join(_parts(points, mannequin))}, {heights.min():.0f} to {heights.max():.0f} mm above the floor"


def remedy_inside(points: np.ndarray, mannequin: Mannequin) -> str:
    """What brings points (N,3) m out of the parts that they lie in. No offset brings a skirt past forearms that are held out beside it."""
    arms = [part.startswith("arm_") for part in _parts(points, mannequin)]
    wider = "enlarge the offset or the scale of the placement, or move the panel"
    beside = (
        "wrap a sleeve wider (offset, scale); lay what lies beside the arms nearer to the body (smaller offset, scale or flare), higher or lower, "
        f"or take a body whose arms stand farther out (arm_angle of a mannequin file, up to {MAX_ARM_ANGLE_DEG:g} degrees)"
    )
    return "; ".join([wider] * (not all(arms)) + [beside] * any(arms))


def _parts(points: np.ndarray, mannequin: Mannequin) -> list[str]:
    """Parts of the faces whose middles are nearest to points (N,3), as the body names them."""
    nearest = cKDTree(mannequin.vertices[mannequin.faces].mean(axis=1)).query(points)[1]
    return [mannequin.part_names[part] for part in np.unique(mannequin.face_part[nearest])]
