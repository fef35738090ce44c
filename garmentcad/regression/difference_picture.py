"""A picture for a test that failed: its baseline on the left, what came on the right, both colored by their distance from each other."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from garmentcad.analysis.surface_distance import SurfaceDistance
from garmentcad.export.color_map import painted
from garmentcad.export.legend import INK
from garmentcad.export.picture import pictures, write_picture
from garmentcad.export.result_folder import Result
from garmentcad.regression.baseline import Shape

VIEWS = ("front", "back")
HEIGHT_PX = 900
TITLES = ("baseline", "now")


def draw_difference(path: Path, result: Result, baseline: Shape, distance: SurfaceDistance) -> Path:
    """Draw front and back of both. distance: of the result from the baseline. Raises ViewMissing without the extra `view`."""
    both = np.concatenate([result.state.positions, baseline.positions])
    high = painted("apart", np.concatenate([distance.from_first, distance.from_second])).high
    sides = [
        pictures(VIEWS, positions, surface, result.mannequin, painted("apart", apart, high), both, HEIGHT_PX)
        for positions, surface, apart in (
            (baseline.positions, baseline, distance.from_second),
            (result.state.positions, result.cloth, distance.from_first),
        )
    ]
    return write_picture(path, _sheet([side[view] for view in VIEWS for side in sides]))


def _sheet(drawn: list[object]) -> object:
    """One image of all pictures, baseline and result side by side, a row a view."""
    from PIL import Image, ImageDraw, ImageFont

    images = [picture for picture in drawn if isinstance(picture, Image.Image)]
    width = max(image.width for image in images)
    sheet = Image.new("RGB", (2 * width, len(images) // 2 * HEIGHT_PX), images[0].getpixel((0, 0)))
    draw, font = ImageDraw.Draw(sheet), ImageFont.load_default(HEIGHT_PX / 36)
    for index, image in enumerate(images):
        row, column = divmod(index, 2)
        sheet.paste(image, (column * width, row * HEIGHT_PX))
        draw.text((column * width + HEIGHT_PX / 40, row * HEIGHT_PX + HEIGHT_PX / 40), TITLES[column], fill=INK, font=font)
    return sheet
