"""Where points of a panel lie on its triangles, against every triangle of the panel."""

from __future__ import annotations

import numpy as np
from drawn import panel
from elastic import linear

from garmentcad.cloth.lattice import panel_cloth
from garmentcad.cloth.locate import anchors, located


def test_a_long_triangle_holds_a_point_beside_many_small_ones() -> None:
    """One side is drawn in steps of 0.2 mm: the middles of hundreds of small triangles lie nearer than that of the one that holds the point."""
    steps = [(200.0 - 0.2 * k, 60.0 + 0.3 * (k % 2)) for k in range(1001)]
    cloth = panel_cloth(panel([(0.0, 0.0), (200.0, 0.0), *steps]), linear(0.15, 2000.0, 0.1, 50.0, 0.3e-3, 0.3), 0, 25.0)
    points = np.column_stack([np.linspace(5.0, 195.0, 381), np.tile([58.0, 56.0, 50.0], 127)])
    place = located(cloth, 0, points)
    corners = cloth.vertex_uv_mm[place.vertices]
    assert np.abs(np.einsum("nk,nkx->nx", place.weights, corners) - points).max() < 1e-9
    assert place.weights.min() > -1e-9, "each lies inside its triangle"
    assert anchors(cloth, "front", points).weights.min() >= 0.0
