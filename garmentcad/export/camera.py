"""Where the picture is taken from."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from garmentcad.arrays import floats
from garmentcad.errors import InputError

# Azimuth of the camera about the vertical, from the wearer's front toward the wearer's left, in degrees.
VIEWS = {"front": 0.0, "back": 180.0, "left": 90.0, "right": -90.0, "three-quarter": 35.0}
ELEVATION_DEG = 6.0
# A long lens: parallel lines stay nearly parallel, near folds still look nearer.
FIELD_OF_VIEW_DEG = 14.0
BODY_AROUND = 0.22  # of the garment's height is shown of the body above and below it
BODY_BESIDE_M = 0.10
MARGIN = 1.05


@dataclass(frozen=True)
class Camera:
    """position and focus: (3,) m; up is +y. width and height: the picture in pixels; view_angle_deg: vertical."""

    position: np.ndarray
    focus: np.ndarray
    view_angle_deg: float
    width: int
    height: int

    @property
    def toward(self) -> np.ndarray:
        """(3,) unit vector from the focus to the camera."""
        return (self.position - self.focus) / np.linalg.norm(self.position - self.focus)

    @property
    def right(self) -> np.ndarray:
        """(3,) unit vector to the right of the picture."""
        across = np.cross([0.0, 1.0, 0.0], self.toward)
        return across / np.linalg.norm(across)

    @property
    def up(self) -> np.ndarray:
        """(3,) unit vector to the top of the picture."""
        return np.cross(self.toward, self.right)

    def on_screen(self, points: np.ndarray, scale: int) -> np.ndarray:
        """(N,3): column and row of points (N,3) m in a picture `scale` times as large, and 1/distance along the view [1/m], below 0 behind the camera."""
        across, along, depth = ((points - self.position) @ np.stack([self.right, self.up, -self.toward]).T).T
        near = 1.0 / np.where(np.abs(depth) < 1e-6, -1e-6, depth)
        metre_px = 0.5 * scale * self.height / math.tan(math.radians(0.5 * self.view_angle_deg))
        column, row = 0.5 * scale * self.width + metre_px * across * near, 0.5 * scale * self.height - metre_px * along * near
        return floats(np.column_stack([column, row, near]))

    def metres_a_pixel(self) -> float:
        """Size of a pixel in the plane of the focus."""
        distance = float(np.linalg.norm(self.position - self.focus))
        return 2.0 * distance * math.tan(math.radians(0.5 * self.view_angle_deg)) / self.height


def frame(view: str, garment: np.ndarray, body: np.ndarray | None, height_px: int, left_px: int = 0) -> Camera:
    """Camera that shows all of the garment (P,3) and a part of the body (V,3) above and below it. Raises InputError for an unknown view.

    The picture is as wide as what is in it, between 0.6 and 1.3 times its height, plus `left_px` of room on the left (for a legend).
    """
    if view not in VIEWS:
        raise InputError(f"no such view: {view!r}; allowed: {', '.join(VIEWS)}", key="view")
    azimuth, elevation = math.radians(VIEWS[view]), math.radians(ELEVATION_DEG)
    toward = np.array([math.sin(azimuth) * math.cos(elevation), math.sin(elevation), math.cos(azimuth) * math.cos(elevation)])
    right = np.array([math.cos(azimuth), 0.0, -math.sin(azimuth)])
    up = np.cross(toward, right)
    points = garment
    if body is not None:
        low, high = garment[:, 1].min(), garment[:, 1].max()
        room = BODY_AROUND * max(high - low, 0.3)
        side = garment @ right
        near = (body[:, 1] > low - room) & (body[:, 1] < high + room)
        near &= (body @ right > side.min() - BODY_BESIDE_M) & (body @ right < side.max() + BODY_BESIDE_M)
        middle = garment.mean(axis=0)
        span = [[middle[0], y, middle[2]] for y in (max(low - room, body[:, 1].min()), min(high + room, body[:, 1].max()))]
        points = np.vstack([garment, body[near], span])
    across, along, depth = points @ right, points @ up, points @ toward
    center = [0.5 * (values.min() + values.max()) for values in (across, along, depth)]
    half_width, half_height = (MARGIN * 0.5 * max(np.ptp(values), 0.05) for values in (across, along))
    aspect = min(max(half_width / half_height, 0.6), 1.3)
    half_height = max(half_height, half_width / aspect)
    distance = half_height / math.tan(math.radians(0.5 * FIELD_OF_VIEW_DEG)) + 0.5 * float(np.ptp(depth))
    focus = center[0] * right + center[1] * up + center[2] * toward
    focus -= left_px * half_height / height_px * right
    width_px = round(aspect * height_px) + left_px
    return Camera(focus + distance * toward, focus, FIELD_OF_VIEW_DEG, width_px, height_px)
