"""Triangles and lines on a grid of pixels: what is nearest in each of them. Kernels on one thread, so that every machine draws the same picture."""

from __future__ import annotations

import math

import numpy as np

from garmentcad.arrays import entry, kernel

NOTHING = -1


def blank(height: int, width: int) -> tuple[np.ndarray, np.ndarray]:
    """Empty pixels: nearness (height,width) of what is drawn, the larger the nearer, and its owner, NOTHING so far."""
    return np.full((height, width), -np.inf, dtype=np.float32), np.full((height, width), NOTHING, dtype=np.int32)


@entry
@kernel
def draw_triangles(points, triangles, first, nearness, owner):  # type: ignore[no-untyped-def]
    """Draw triangles (F,3) over points (N,3): column, row in pixels (centers at halves) and nearness, both sides. Triangle k owns its pixels as first + k."""
    height, width = nearness.shape
    for k in range(len(triangles)):
        a, b, c = triangles[k, 0], triangles[k, 1], triangles[k, 2]
        ax, ay, az = points[a, 0], points[a, 1], points[a, 2]
        bx, by, bz = points[b, 0] - ax, points[b, 1] - ay, points[b, 2] - az
        cx, cy, cz = points[c, 0] - ax, points[c, 1] - ay, points[c, 2] - az
        area = bx * cy - by * cx
        if area == 0.0:
            continue
        left, right = math.ceil(ax + min(0.0, bx, cx) - 0.5), math.floor(ax + max(0.0, bx, cx) - 0.5)
        top, bottom = math.ceil(ay + min(0.0, by, cy) - 0.5), math.floor(ay + max(0.0, by, cy) - 0.5)
        for row in range(max(top, 0), min(bottom, height - 1) + 1):
            y = row + 0.5 - ay
            for column in range(max(left, 0), min(right, width - 1) + 1):
                x = column + 0.5 - ax
                share_b, share_c = (x * cy - y * cx) / area, (bx * y - by * x) / area
                if share_b < 0.0 or share_c < 0.0 or share_b + share_c > 1.0:
                    continue
                near = az + share_b * bz + share_c * cz
                if near > nearness[row, column]:
                    nearness[row, column], owner[row, column] = near, first + k


@entry
@kernel
def draw_lines(points, lines, radius_px, radius_m, mine, nearness, owner):  # type: ignore[no-untyped-def]
    """Draw round rods from point to point (S,2), all owned by `mine`, over points as `draw_triangles` takes them, with nearness 1/distance [1/m]."""
    height, width = nearness.shape
    for k in range(len(lines)):
        a, b = lines[k, 0], lines[k, 1]
        ax, ay, az = points[a, 0], points[a, 1], points[a, 2]
        bx, by, bz = points[b, 0] - ax, points[b, 1] - ay, points[b, 2] - az
        long2 = bx * bx + by * by
        left, right = math.ceil(ax + min(0.0, bx) - radius_px - 0.5), math.floor(ax + max(0.0, bx) + radius_px - 0.5)
        top, bottom = math.ceil(ay + min(0.0, by) - radius_px - 0.5), math.floor(ay + max(0.0, by) + radius_px - 0.5)
        for row in range(max(top, 0), min(bottom, height - 1) + 1):
            y = row + 0.5 - ay
            for column in range(max(left, 0), min(right, width - 1) + 1):
                x = column + 0.5 - ax
                along = min(1.0, max(0.0, (x * bx + y * by) / long2)) if long2 > 0.0 else 0.0
                off2 = ((x - along * bx) ** 2 + (y - along * by) ** 2) / (radius_px * radius_px)
                if off2 > 1.0:
                    continue
                near = az + along * bz
                near += near * near * radius_m * math.sqrt(1.0 - off2)  # the front of the rod
                if near > nearness[row, column]:
                    nearness[row, column], owner[row, column] = near, mine
