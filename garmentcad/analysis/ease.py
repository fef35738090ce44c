"""Ease: girth of the garment minus girth of the body, as drafted and as draped.

At each height that the mannequin gives (bust, waist, hip) the garment is cut level. Of the closed loops that go around the torso axis the shortest counts,
which is the layer next to the body: a fold that hangs over it, a second layer, or a sleeve (which does not go around the axis) does not change the figure.
Its length in space is the draped girth; the same line on the flat pattern, segment by segment, is the pattern girth, the one that a pattern maker drafted.
Around a limb the loop that goes around that limb alone counts, in the plane in which the limb was taped.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from garmentcad.analysis.body_line import LIMB_LINES, limb_lines
from garmentcad.analysis.plane_fit import loops_in_plane
from garmentcad.analysis.section import Chain, cut, horizontal
from garmentcad.cloth.cloth import Cloth
from garmentcad.mannequin.mannequin import Mannequin
from garmentcad.units import M_TO_MM, MM_TO_M

GIRTHS = ("bust", "waist", "hip")
EASE_LINES = (*GIRTHS, *LIMB_LINES)
# A waistband ends at the waist: where the plane at the height itself finds no whole loop, the nearest of these levels that does is taken, and named.
# A step is far below a band's height, so that the level lies within the band's top and not where it has already widened.
LEVEL_STEP_MM = 1.0
LEVEL_REACH_MM = 25.0


@dataclass(frozen=True)
class Girth:
    """A loop around the torso. draped_mm: its length in space; pattern_mm: on the flat pattern; level_mm: height above the floor at which it was cut."""

    draped_mm: float
    pattern_mm: float
    level_mm: float


@dataclass(frozen=True)
class Ease:
    """Ease at one girth of the body, mm, that girth, and the level at which the garment was cut (None where the plane is not level)."""

    body_mm: float
    draped_mm: float
    pattern_mm: float
    level_mm: float | None


def girth_at(cloth: Cloth, positions: np.ndarray, axis: np.ndarray, height_mm: float) -> Girth | None:
    """Girth of the innermost closed loop around the vertical line through `axis` (3,) m at a height above the floor; None where there is none."""
    plane = horizontal(height_mm * MM_TO_M)
    loops = [chain for chain in cut(positions, cloth.particle_triangles, plane) if chain.winds_around(axis, plane)]
    if not loops:
        return None
    inner = min(loops, key=Chain.length)
    return Girth(M_TO_MM * inner.length(), inner.length_on(cloth.vertex_uv_mm[cloth.triangles]), height_mm)


def girth_near(cloth: Cloth, positions: np.ndarray, axis: np.ndarray, height_mm: float) -> Girth | None:
    """`girth_at` the height, or at the nearest level within 25 mm (1 mm steps, lower first) where the garment closes around the body."""
    for step in range(int(LEVEL_REACH_MM / LEVEL_STEP_MM) + 1):
        for sign in (-1.0, 1.0)[: 1 if step == 0 else 2]:
            girth = girth_at(cloth, positions, axis, height_mm + sign * step * LEVEL_STEP_MM)
            if girth is not None:
                return girth
    return None


def garment_ease(cloth: Cloth, positions: np.ndarray, mannequin: Mannequin) -> dict[str, Ease | None]:
    """Ease at those of EASE_LINES that the mannequin has (a ball has none); None where the garment does not reach, and at a girth where it goes around arms,
    too, as a poncho does: a tape around the trunk says nothing about that. positions: (P,3) m."""
    found: dict[str, Ease | None] = {}
    for name in GIRTHS:
        if name not in mannequin.measurements_mm:
            continue
        axis = mannequin.cylinders["torso"].origin
        girth = girth_near(cloth, positions, axis, mannequin.measurements_mm[f"{name}_height"])
        body = mannequin.measurements_mm[name]
        if girth is None or _holds_arms(cloth, positions, mannequin, girth):
            found[name] = None
        else:
            found[name] = Ease(body, girth.draped_mm - body, girth.pattern_mm - body, girth.level_mm)
    for line in limb_lines(mannequin):
        loops = [loop for loop in loops_in_plane(cloth, positions, mannequin, line.plane) if loop.parts == (line.part,)]
        level = M_TO_MM * line.plane.offset if line.plane.normal[1] == 1.0 else None
        found[line.name] = Ease(loops[0].body_mm, loops[0].ease_mm, loops[0].pattern_ease_mm, level) if loops else None
    return found


def _holds_arms(cloth: Cloth, positions: np.ndarray, mannequin: Mannequin, girth: Girth) -> bool:
    """Whether the loop of a girth, found again in its plane by its length, goes around an arm as well."""
    loops = loops_in_plane(cloth, positions, mannequin, horizontal(girth.level_mm * MM_TO_M))
    return any(loop.draped_mm == girth.draped_mm and any(part.startswith("arm") for part in loop.parts) for loop in loops)
