"""Panels folded at their pleats before they are laid around the body.

Every laid fold is a straight line across the panel. Seen from the anchor of the placement (of a transform, the origin of the panel), what lies beyond a fold
is reflected over it, beginning with the farthest fold. Folds that are seen lie outermost, under folds on the surface of the placement, and what is between them
slopes, like shingles, so that layers touch only where they are folded.
"""

from __future__ import annotations

import numpy as np

from garmentcad.geometry.portable import product
from garmentcad.pattern.pattern import Panel, Wrap

LIFT_MM = 12.0  # of the folds that are seen over the under folds: an estimate, wide enough for contact between the layers of a pleat


def folded(panel: Panel, uv_mm: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Points (N,2) of a panel, mm, on the panel as it is folded at its pleats, and how far each lies outside the placement's surface (N,), mm."""
    folds = [fold for fold in panel.folds if fold.laid]
    if not folds:
        return uv_mm, np.zeros(len(uv_mm))
    start = np.array([fold.points_mm[0] for fold in folds])
    along = np.array([fold.points_mm[-1] for fold in folds]) - start
    across = np.stack([-along[:, 1], along[:, 0]], axis=1) / np.linalg.norm(along, axis=1)[:, None]
    anchor = panel.placement.anchor_mm if isinstance(panel.placement, Wrap) else (0.0, 0.0)
    home = ((np.asarray(anchor) - start) * across).sum(axis=1)
    beside = np.einsum("nfk,fk->nf", uv_mm[:, None] - start, across)
    beyond = beside * np.where(home < 0.0, -1.0, 1.0) < 0.0
    placed = uv_mm.copy()
    for k in np.argsort(-np.abs(home), kind="stable"):
        rows = beyond[:, k]
        placed[rows] -= 2.0 * product(placed[rows] - start[k], across[k])[:, None] * across[k]
    seen = np.array([fold.angle_deg < 0.0 for fold in folds])
    to_seen, to_under = (np.abs(beside[:, kind]).min(axis=1) for kind in (seen, ~seen))
    return placed, LIFT_MM * to_under / np.maximum(to_seen + to_under, 1e-9)
