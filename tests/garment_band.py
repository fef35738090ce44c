"""The smallest garment that stays on a body: a band around the waist, sewn of two panels. Drapes in a second at 30 mm."""

from __future__ import annotations

from pathlib import Path

BAND = """\
schema: 1
units: mm
name: band
fabric: wool-suiting
mannequin: woman-88
parameters:
  height: {value: 60, unit: mm}
panels:
  front:
    points: {a: [0, 0], b: [waist / 2 + 10, 0], c: [waist / 2 + 10, height], d: [0, height]}
    edges:
      - {name: hem, from: a, to: b, role: hem}
      - {name: right, from: b, to: c}
      - {name: top, from: c, to: d, role: waist}
      - {name: left, from: d, to: a}
    placement:
      wrap: {part: torso, anchor: [waist / 4 + 5, 0], angle: 0, height: waist_height - 45, scale: waist / hip, offset: 30}
  back:
    mirrored_from: front
    placement:
      wrap: {part: torso, anchor: [-waist / 4 - 5, 0], angle: 180, height: waist_height - 45, scale: waist / hip, offset: 30}
seams:
  - {name: side_left, a: [front.right.c, front.right.b], b: [back.right.c, back.right.b]}
  - {name: side_right, a: [front.left.d, front.left.a], b: [back.left.d, back.left.a]}
"""


def band_spec(folder: Path) -> Path:
    """The spec as a file in a folder."""
    path = folder / "band.yaml"
    path.write_text(BAND)
    return path
