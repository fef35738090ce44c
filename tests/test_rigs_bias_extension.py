"""Bias extension against finite elements that share nothing with the lattice."""

from __future__ import annotations

import math

import numpy as np
import pytest
from elastic import linear
from scipy.sparse import coo_array
from scipy.sparse.linalg import spsolve

from garmentcad.rigs.bias_extension import LENGTH_MM, WIDTH_MM, bias_extension

YARNS, SHEAR = 2000.0, 20.0  # N/m, N/m per rad
SMALL_MM = 0.5


def finite_elements(across: int) -> tuple[float, float]:
    """Force [N/m] per width and shear angle [deg] in the middle at SMALL_MM: linear, bilinear squares, two yarn families at 45 degrees."""
    side = WIDTH_MM / across
    along = round(LENGTH_MM / side)
    c = math.sqrt(0.5)
    strains = np.array(
        [[c * c, c * c, c * c], [c * c, c * c, -c * c], [-2.0 * c * c, 2.0 * c * c, 0.0]]
    )  # along both yarns and between them, from (xx, yy, xy)
    elastic = strains.T @ np.diag([YARNS, YARNS, SHEAR]) @ strains
    stiffness, middle = np.zeros((8, 8)), np.zeros((3, 8))
    for x, y in [(a / math.sqrt(3.0), b / math.sqrt(3.0)) for a in (-1, 1) for b in (-1, 1)] + [(0.0, 0.0)]:
        slopes = np.array([[-(1 - y), 1 - y, 1 + y, -(1 + y)], [-(1 - x), -(1 + x), 1 + x, 1 - x]]) / (2.0 * side)
        b = np.zeros((3, 8))
        b[0, 0::2], b[1, 1::2], b[2, 0::2], b[2, 1::2] = slopes[0], slopes[1], slopes[1], slopes[0]
        if (x, y) == (0.0, 0.0):
            middle = strains[2] @ b
        else:
            stiffness += b.T @ elastic @ b * side * side / 4.0
    node = np.arange((across + 1) * (along + 1)).reshape(along + 1, across + 1)
    corners = np.stack([node[:-1, :-1], node[:-1, 1:], node[1:, 1:], node[1:, :-1]], axis=-1).reshape(-1, 4)
    freedoms = np.stack([2 * corners, 2 * corners + 1], axis=-1).reshape(-1, 8)
    rows, columns = np.repeat(freedoms, 8, axis=1).ravel(), np.tile(freedoms, (1, 8)).ravel()
    whole = coo_array((np.tile(stiffness.ravel(), len(corners)), (rows, columns))).tocsr()
    moved = np.zeros(2 * node.size)
    moved[2 * node[-1] + 1] = SMALL_MM
    held = np.concatenate([2 * node[[0, -1]].ravel(), 2 * node[[0, -1]].ravel() + 1])
    free = np.setdiff1d(np.arange(len(moved)), held)
    moved[free] = spsolve(whole[free][:, free], -(whole @ moved)[free])
    force = (whole @ moved)[2 * node[-1] + 1].sum() / WIDTH_MM  # per width, with lengths in mm throughout
    half = across // 4  # the square that the camera sees
    centre = freedoms.reshape(along, across, 8)[along // 2 - half : along // 2 + half, across // 2 - half : across // 2 + half].reshape(-1, 8)
    return float(force), math.degrees(abs(float((moved[centre] @ middle).mean())))


def test_force_and_angle_are_those_of_finite_elements() -> None:
    force, angle = finite_elements(40)
    pulled = bias_extension(linear(0.15, YARNS, 0.5, SHEAR, 5e-4, 0.3), 5.0, (SMALL_MM,))[0]
    assert pulled.force_n_m == pytest.approx(force, rel=0.03)
    assert pulled.seen_deg == pytest.approx(angle, rel=0.03)
