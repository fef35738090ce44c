"""Gathers: along a seam that draws in much more cloth than it is long, the strip beside it rests as long as the seam.

What a gathering thread draws in lies in tucks between its stitches, finer than any lattice. Cloth that is squeezed flat to the length of the seam, as the
triangles on it were, resists by its tensile curve: the threads of a waist seam that gathers half as much cloth again carried 45 N/m where what hung from
them weighed 0.76. So a border triangle whose edge is sewn to a much shorter one has that one's length at rest. Folds begin beside it, where the lattice has
them.
"""

from __future__ import annotations

import numpy as np

from garmentcad.arrays import floats, frozen
from garmentcad.cloth.cloth import BorderTriangles

EASED = 1.15  # cloth over seam: up to here cloth is eased in, or its partner stretched onto it, and both resist
# Gathers fold as they are sewn, as finely as the lattice lets them, and folds of a coarse one stay on the fine one: of a ruffle gathered 1.6 to 1 and sewn at
# 20 mm three folds were left in a front, and ten where it was sewn at 10. Cloth over seam that gathers, and the spacing beyond which its folds are too few.
GATHERED, COARSEST_GATHERED_MM = 1.25, 12.5


def gathered(border: BorderTriangles, row: np.ndarray, corner: np.ndarray) -> BorderTriangles:
    """The triangles with the rest lengths of gathers. row, corner (H,2): triangles on either side of each stretch of sew line, and the corner of each that does
    not lie on it. Areas stay, and with them masses."""
    warp, weft = border.warp_gradient[row, corner], border.weft_gradient[row, corner]
    # The gradient of the far corner is square to the edge, and as long as edge / (2 area).
    steepness = np.hypot(warp, weft)
    length = 2.0 * border.area[row] * steepness
    ratio = length / length[:, ::-1]
    place = (3 * row + corner)[ratio > EASED]
    if len(place) == 0:
        return border
    # Of layers that are caught in one seam the shortest counts.
    most = np.zeros(3 * len(border.area))
    np.maximum.at(most, place, ratio[ratio > EASED])
    gradients = np.stack([border.warp_gradient, border.weft_gradient])
    for k in range(3):
        mine = np.flatnonzero(most.reshape(-1, 3)[:, k])
        edge = np.stack([border.weft_gradient[mine, k], -border.warp_gradient[mine, k]])
        along = edge / np.linalg.norm(edge, axis=0)
        # What is measured along the edge counts as so many times as long.
        gradients[:, mine] += (most[3 * mine + k] - 1.0)[:, None] * along[:, :, None] * np.einsum("an,ank->nk", along, gradients[:, mine])
    return border._replace(warp_gradient=frozen(floats(gradients[0])), weft_gradient=frozen(floats(gradients[1])))
