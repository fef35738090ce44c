"""Colors of pixels from what is nearest in them: light without direction and lamps, with the normal at the pixel."""

from __future__ import annotations

import math

from garmentcad.arrays import entry, kernel


@entry
@kernel
def shade(owner, points, triangles, normals, colors, looks, lamps, flat, background, pixels):  # type: ignore[no-untyped-def]
    """Fill pixels (H,W,3) uint8; `owner` has a whole number of samples for each pixel, each way, whose mean it gets.

    owner: triangle, len(triangles) + k for the flat color k, below 0 for the background. points: (N,3) as `raster.draw_triangles` takes them, with
    nearness 1/distance; normals: (N,3) toward the side that is seen; colors: (N,3), flat: (K,3) in 0..1; looks: (F,2) ambient and diffuse;
    lamps: (L,4) unit vector to the lamp and its strength; background: (H,3), one color a row.
    """
    height, width, _ = pixels.shape
    samples = owner.shape[0] // height
    scale = 255.0 / (samples * samples)
    for row in range(height):
        for column in range(width):
            red, green, blue = 0.0, 0.0, 0.0
            for i in range(row * samples, (row + 1) * samples):
                for j in range(column * samples, (column + 1) * samples):
                    k = owner[i, j]
                    if k < 0:
                        r, g, b, light = background[row, 0], background[row, 1], background[row, 2], 1.0
                    elif k >= len(triangles):
                        r, g, b, light = flat[k - len(triangles), 0], flat[k - len(triangles), 1], flat[k - len(triangles), 2], 1.0
                    else:
                        u, v, w = triangles[k, 0], triangles[k, 1], triangles[k, 2]
                        ux, uy, vx, vy = points[u, 0], points[u, 1], points[v, 0] - points[u, 0], points[v, 1] - points[u, 1]
                        wx, wy, x, y = points[w, 0] - ux, points[w, 1] - uy, j + 0.5 - ux, i + 0.5 - uy
                        # Shares on the screen, weighted with nearness, are shares on the triangle; what they are divided by cancels.
                        share_v, share_w = (x * wy - y * wx) * points[v, 2], (vx * y - vy * x) * points[w, 2]
                        share_u = (vx * wy - vy * wx - x * wy + y * wx - vx * y + vy * x) * points[u, 2]
                        total = share_u + share_v + share_w
                        share_u, share_v, share_w = share_u / total, share_v / total, share_w / total
                        nx = share_u * normals[u, 0] + share_v * normals[v, 0] + share_w * normals[w, 0]
                        ny = share_u * normals[u, 1] + share_v * normals[v, 1] + share_w * normals[w, 1]
                        nz = share_u * normals[u, 2] + share_v * normals[v, 2] + share_w * normals[w, 2]
                        size = math.sqrt(nx * nx + ny * ny + nz * nz)
                        lit = 0.0
                        for lamp in range(len(lamps)):
                            lit += lamps[lamp, 3] * max(0.0, nx * lamps[lamp, 0] + ny * lamps[lamp, 1] + nz * lamps[lamp, 2])
                        light = looks[k, 0] + (looks[k, 1] * lit / size if size > 0.0 else 0.0)
                        r = share_u * colors[u, 0] + share_v * colors[v, 0] + share_w * colors[w, 0]
                        g = share_u * colors[u, 1] + share_v * colors[v, 1] + share_w * colors[w, 1]
                        b = share_u * colors[u, 2] + share_v * colors[v, 2] + share_w * colors[w, 2]
                    red, green, blue = red + min(1.0, light * r), green + min(1.0, light * g), blue + min(1.0, light * b)
            pixels[row, column, 0], pixels[row, column, 1], pixels[row, column, 2] = scale * red + 0.5, scale * green + 0.5, scale * blue + 0.5
