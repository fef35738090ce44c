"""The legend of a map, drawn into the lower left corner of a picture."""

from __future__ import annotations

from typing import Any

import numpy as np

from garmentcad.export.color_map import PaintedMap

INK = (60, 55, 52)
TICKS = 4
WIDTH = 0.16  # of the picture's height: the room that a legend needs on the left


def draw_legend(picture: Any, painted_map: PaintedMap) -> None:
    """Draw a color bar with title, unit and numbers into a PIL image. The bar's ends stand for everything beyond them."""
    from PIL import Image, ImageDraw, ImageFont

    unit = picture.height / 64
    left, bottom = 1.6 * unit, picture.height - 1.6 * unit
    width, high = int(1.1 * unit), int(15 * unit)
    top = bottom - high
    bar = painted_map.colors_at(np.linspace(1.0, 0.0, high))
    pixels = np.repeat((255.0 * bar).astype(np.uint8)[:, None, :], width, axis=1)
    picture.paste(Image.fromarray(pixels), (int(left), int(top)))
    draw = ImageDraw.Draw(picture)
    draw.rectangle((int(left) - 1, int(top) - 1, int(left) + width, int(top) + high), outline=INK)
    font, title = ImageFont.load_default(1.25 * unit), ImageFont.load_default(1.35 * unit)
    for tick in range(TICKS + 1):
        value = painted_map.low + (painted_map.high - painted_map.low) * tick / TICKS
        y = bottom - high * tick / TICKS
        draw.line((left + width, y, left + width + 0.35 * unit, y), fill=INK)
        draw.text((left + width + 0.6 * unit, y), f"{value:.3g}", fill=INK, font=font, anchor="lm")
    lines = f"{painted_map.kind.title}\n{painted_map.kind.unit}"
    draw.multiline_text((left, top - 1.0 * unit), lines, fill=INK, font=title, anchor="ld", spacing=0.4 * unit)
