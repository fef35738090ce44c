"""Hinges between border triangles: over the segments of fold lines, and over the sew lines that welding makes."""

from __future__ import annotations

import numpy as np

from garmentcad.arrays import floats, indices
from garmentcad.cloth.cloth import BorderTriangles, Hinges

_FLAT, _SEAM = 0.0, -1


def fold_hinges(border: BorderTriangles, ends: np.ndarray, fold: np.ndarray, strength: np.ndarray) -> Hinges:
    """Hinges over the segments `ends` (F,2) of folds, which are numbered by `fold` (F,) and as strong as `strength` says of each number."""
    count = int(border.corners.max(initial=0)) + 1
    tail, head = border.corners.astype(np.int64).T.ravel(), np.roll(border.corners, -1, axis=1).astype(np.int64).T.ravel()
    key, wanted = tail * count + head, ends.astype(np.int64) @ np.array([[count, 1], [1, count]])
    order = np.argsort(key, kind="stable")
    side = order[np.searchsorted(key[order], wanted)]  # the triangle to the left of the segment, and that to its right, which runs along it backward
    row, place = side % len(border.corners), side // len(border.corners)
    return made_hinges(border, ends, row, (place + 2) % 3, np.full(len(ends), _FLAT), strength[fold], fold)


def made_hinges(
    border: BorderTriangles, ends: np.ndarray, row: np.ndarray, corner: np.ndarray, rest_angle: np.ndarray, factor: np.ndarray, fold: np.ndarray | None = None
) -> Hinges:
    """Hinges over edges `ends` (H,2); row, corner (H,2): the border triangles on either side, side a first, and the corner of each that is its wing."""
    areas = border.area[row]
    warp, weft = border.warp_gradient[row, corner], border.weft_gradient[row, corner]
    steepness = np.hypot(warp, weft)  # the wing's gradient is square to the edge, and as long as edge / (2 area)
    lengths = 2.0 * areas * steepness
    return Hinges(
        corners=indices(np.concatenate([ends, border.corners[row, corner]], axis=1)),
        length=floats(lengths.mean(axis=1)),
        length2_over_area=floats(lengths.mean(axis=1) ** 2 / areas.sum(axis=1)),
        rest_angle=floats(rest_angle),
        factor=floats(factor),
        material=indices(border.material[row]),
        across_warp=floats(warp / steepness),
        fold=indices(np.full(len(ends), _SEAM) if fold is None else fold),
    )
