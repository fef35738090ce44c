"""The legend of a map, drawn into the lower left corner of a picture: color bar, title, unit, numbers, and a scale of lengths."""

from __future__ import annotations

from typing import Any

import numpy as np

from garmentcad.export.color_map import PaintedMap

INK = (60, 55, 52)
PAPER = (247, 246, 243, 215)  # under the legend, so that it can be read in front of an arm
WIDTH = 0.16  # of the picture's height: the room that a legend needs on the left
SCALES_MM = (1000, 500, 200, 100, 50, 20, 10, 5, 2, 1)
SCALE_ROOM = 0.115  # of the picture's height: the longest scale


def draw_legend(picture: Any, painted_map: PaintedMap, metres_a_pixel: float) -> None:
    """Draw the legend into a PIL image. The bar's ends stand for everything beyond them. metres_a_pixel: of the picture, for the scale."""
    from PIL import Image, ImageDraw, ImageFont

    unit = picture.height / 64
    font, title = ImageFont.load_default(1.25 * unit), ImageFont.load_default(1.35 * unit)
    left, bottom = 1.6 * unit, picture.height - 5.2 * unit
    width, high = int(1.1 * unit), int(15 * unit)
    top = bottom - high
    lines = f"{painted_map.kind.title}\n{painted_map.kind.unit}"
    paper = Image.new("RGBA", (round(WIDTH * picture.height), round(picture.height - top + 1.2 * unit + (len(lines.split("\n")) + 0.5) * 1.9 * unit)), PAPER)
    picture.paste(paper, (0, picture.height - paper.height), paper)
    bar = painted_map.colors_at(np.linspace(1.0, 0.0, high))
    pixels = np.repeat((255.0 * bar).astype(np.uint8)[:, None, :], width, axis=1)
    picture.paste(Image.fromarray(pixels), (int(left), int(top)))
    draw = ImageDraw.Draw(picture)
    draw.rectangle((int(left) - 1, int(top) - 1, int(left) + width, int(top) + high), outline=INK)
    for value in ticks(painted_map.low, painted_map.high):
        y = bottom - high * (value - painted_map.low) / (painted_map.high - painted_map.low)
        draw.line((left + width, y, left + width + 0.35 * unit, y), fill=INK)
        draw.text((left + width + 0.6 * unit, y), f"{value:.3g}", fill=INK, font=font, anchor="lm")
    draw.multiline_text((left, top - 1.0 * unit), lines, fill=INK, font=title, anchor="ld", spacing=0.4 * unit)
    _draw_scale(draw, font, left, picture.height - 1.6 * unit, metres_a_pixel, SCALE_ROOM * picture.height)


def _draw_scale(draw: Any, font: Any, left: float, y: float, metres_a_pixel: float, room: float) -> None:
    """A line as long as a round number of millimetres is in the plane of the garment's middle."""
    length_mm = next((mm for mm in SCALES_MM if 1e-3 * mm <= room * metres_a_pixel), SCALES_MM[-1])
    right = left + 1e-3 * length_mm / metres_a_pixel
    end = 0.35 * font.size
    draw.line((left, y, right, y), fill=INK, width=max(1, round(0.12 * font.size)))
    for x in (left, right):
        draw.line((x, y - end, x, y + end), fill=INK)
    draw.text((0.5 * (left + right), y - 0.4 * font.size), f"{length_mm} mm", fill=INK, font=font, anchor="md")


def ticks(low: float, high: float) -> list[float]:
    """Round numbers from low to high, 4 to 7 of them where the ends are round themselves."""
    span = (high - low) / 3.0
    power = 10.0 ** np.floor(np.log10(span))
    steps = [round_step * power for round_step in (5.0, 2.5, 2.0, 1.0) if round_step * power <= span * (1.0 + 1e-9)]
    step = next((step for step in steps if abs(high / step - round(high / step)) < 1e-9), steps[0])
    return [float(step * k) for k in range(int(np.ceil(low / step - 1e-9)), int(np.floor(high / step + 1e-9)) + 1)]
