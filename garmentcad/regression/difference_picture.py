"""A picture for a test that failed: its baseline on the left, what came on the right, both colored by their distance from each other."""

from __future__ import annotations

from pathlib import Path

from garmentcad.analysis.surface_distance import SurfaceDistance
from garmentcad.export.color_map import painted_alike
from garmentcad.export.picture import write_picture
from garmentcad.export.result_folder import Result
from garmentcad.export.side_by_side import Exhibit, draw_side_by_side
from garmentcad.regression.baseline import Shape

VIEWS = ("front", "back")
HEIGHT_PX = 900


def draw_difference(path: Path, result: Result, baseline: Shape, distance: SurfaceDistance) -> Path:
    """Draw front and back of both. distance: of the result from the baseline. Raises ViewMissing without the extra `view`."""
    now, before = painted_alike("apart", distance.from_first_mm, distance.from_second_mm)
    exhibits = (
        Exhibit("baseline", baseline.positions, baseline, result.mannequin, before),
        Exhibit("now", result.state.positions, result.cloth, result.mannequin, now),
    )
    return write_picture(path, draw_side_by_side(exhibits, VIEWS, HEIGHT_PX))
