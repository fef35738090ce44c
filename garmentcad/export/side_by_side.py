"""Garments beside each other in one picture: from one place, at one scale, each under its title."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from garmentcad.export import legend
from garmentcad.export.camera import frame
from garmentcad.export.color_map import PaintedMap
from garmentcad.export.picture import HEIGHT_PX, draw_pictures
from garmentcad.export.seam_lines import SewnTriangles
from garmentcad.mannequin.mannequin import Mannequin


@dataclass(frozen=True)
class Exhibit:
    """A garment to be shown beside others. positions: (P,3) m."""

    title: str
    positions: np.ndarray
    cloth: SewnTriangles
    mannequin: Mannequin | None
    painted_map: PaintedMap | None


def draw_side_by_side(exhibits: Sequence[Exhibit], views: Sequence[str] = ("front",), height_px: int = HEIGHT_PX) -> Any:
    """A PIL image: a row a view, each `height_px` high, a column a garment. Raises ViewMissing without the extra `view`, InputError for an unknown view."""
    garments = np.concatenate([exhibit.positions for exhibit in exhibits])
    bodies = [exhibit.mannequin.vertices for exhibit in exhibits if exhibit.mannequin is not None]
    body = np.concatenate(bodies) if bodies else None
    cameras = [frame(view, garments, body, height_px, round(legend.WIDTH * height_px)) for view in views]
    columns = [draw_pictures(exhibit.positions, exhibit.cloth, exhibit.mannequin, exhibit.painted_map, cameras) for exhibit in exhibits]
    from PIL import Image, ImageDraw, ImageFont  # the pictures are there, so it is installed

    width, unit = max(camera.width for camera in cameras), height_px / 64
    sheet = Image.new("RGB", (width * len(exhibits), height_px * len(views)), columns[0][0].getpixel((0, 0)))
    draw, font = ImageDraw.Draw(sheet), ImageFont.load_default(1.4 * unit)
    for column, (exhibit, pictures) in enumerate(zip(exhibits, columns)):
        for row, picture in enumerate(pictures):
            sheet.paste(picture, (column * width, row * height_px))
            draw.text((column * width + 1.6 * unit, row * height_px + 1.2 * unit), exhibit.title, fill=legend.INK, font=font)
    return sheet
