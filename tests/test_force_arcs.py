"""Shear of bent cells: angles on cylinders against theory, bending of limp cloth on the bias, and which cells have neighbours."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.optimize import brentq
from small_cloth import COLUMNS, ROWS, H, flat, materials, small_cloth
from test_force_fold import fold_at, strip

from garmentcad.fabric.material import without_friction
from garmentcad.forces.arcs import cell_neighbours
from garmentcad.forces.force import NO_PARTICLE
from garmentcad.forces.rows import LatticeSlots
from garmentcad.forces.shear import LawShear
from garmentcad.io.fabric_file import fabric_path, load_fabric
from garmentcad.rigs import bending
from garmentcad.rigs.kes import sheet_materials
from garmentcad.units import GF_CM2_CM_TO_N_M

CLOTH = small_cloth()
SLOTS = LatticeSlots(CLOTH)
INSIDE = cell_neighbours(CLOTH, SLOTS)[:, 0] != NO_PARTICLE
ANGLES = [10.0, 30.0, 45.0, -60.0]  # of the warp against the way round


def angles_on_a_cylinder(turn: float, round_: tuple[float, float], along: tuple[float, float], arcs: bool = True) -> np.ndarray:
    """Trellis angles (C,) of the small cloth on a cylinder of curvature turn/H. round_, along: the axis: of a unit of warp, of weft."""
    weft, warp = flat(CLOTH)[:, 0], flat(CLOTH)[:, 1]
    angle, axis = turn / H * (round_[0] * warp + round_[1] * weft), along[0] * warp + along[1] * weft
    law = LawShear(CLOTH.cells, cell_neighbours(CLOTH, SLOTS) if arcs else None, materials(), SLOTS)
    return law.strain(np.column_stack([H / turn * np.sin(angle), axis, H / turn * np.cos(angle)]))


def with_links_of_their_length(turn: float, c: float, s: float) -> tuple[tuple[float, float], tuple[float, float]]:
    """Warp and weft round and along a cylinder where the axis is as long as the cloth is wide and chords of links are H."""

    def rest(part: float) -> float:
        return math.sqrt(max(1.0 - (2.0 / turn * math.sin(0.5 * turn * part)) ** 2, 0.0))

    longer = brentq(lambda q: abs(c) * rest(q * s) + abs(s) * rest(q * c) - 1.0, 0.9, 1.1)
    return (longer * c, longer * s), (-math.copysign(rest(longer * c), s), math.copysign(rest(longer * s), c))


@pytest.mark.parametrize("degrees", ANGLES)
def test_yarns_that_lie_on_a_cylinder(degrees: float) -> None:
    """-(h k)^2 c s/6 is what chords see; arcs leave -(h k)^2 c s/24, by which warp and weft lean where links are chords."""
    c, s, turn = math.cos(math.radians(degrees)), math.sin(math.radians(degrees)), 0.05
    found = angles_on_a_cylinder(turn, (c, s), (-s, c)) / (turn * turn * c * s)
    np.testing.assert_allclose(found[~INSIDE], -1.0 / 6.0, rtol=5e-3)
    np.testing.assert_allclose(found[INSIDE], -1.0 / 24.0, rtol=2e-2)
    chords = angles_on_a_cylinder(turn, (c, s), (-s, c), arcs=False) / (turn * turn * c * s)
    np.testing.assert_allclose(chords, -1.0 / 6.0, rtol=5e-3)


@pytest.mark.parametrize("degrees", ANGLES)
def test_links_that_keep_their_lengths_on_a_cylinder(degrees: float) -> None:
    """Chords see -(h k)^2 c s/8 of shear where cloth is bent and nothing else, arcs none but for what falls with the fourth power of h k."""
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    left = []
    for turn in (0.1, 0.2, 0.4):
        found = angles_on_a_cylinder(turn, *with_links_of_their_length(turn, c, s)) / (c * s)
        np.testing.assert_allclose(found[~INSIDE], -turn * turn / 8.0, rtol=turn * turn)
        left.append(np.abs(found[INSIDE]).max())
    assert left[-1] < 0.03 * 0.4**4
    np.testing.assert_allclose([left[1] / left[0], left[2] / left[1]], 16.0, rtol=0.05)


@pytest.mark.parametrize(("grid_mm", "within"), [(10.0, 0.12), (5.0, 0.05)])
def test_limp_cloth_on_the_bias_bends_by_its_stiffness(monkeypatch: pytest.MonkeyPatch, grid_mm: float, within: float) -> None:
    """Faille to 0.6 /cm: moment over curvature is B. Chords made that 2.95 B on 10 mm and 1.12 B on 5."""
    monkeypatch.setattr(bending, "largest_curvature_per_cm", lambda grid_mm, angle_deg: 0.6)
    fabric = without_friction(sheet_materials(load_fabric(fabric_path("polyester-faille")).sheet))
    plate = 0.25 * float(fabric.bending[0].sum()) + float(fabric.twist[0])
    loop = bending.bending_test(fabric, 45.0, grid_mm, sides=1)
    assert loop.out.y[-1] / loop.out.x[-1] == pytest.approx(plate / GF_CM2_CM_TO_N_M, rel=within)


def test_cells_have_the_neighbours_that_links_lead_to() -> None:
    """A strip cut at any angle with a fold across it, by brute force: all eight, and at their places, or none."""
    cloth = strip(83.0, 71.0, 6.0, fold_at(20.0, 83.0, 71.0), grain_deg=12.0)
    linked = {frozenset(pair) for pair in cloth.links.ends.tolist()}
    place, at = cloth.vertex_place, {tuple(place): k for k, place in enumerate(cloth.vertex_place.tolist()) if place[0] >= 0}
    found = cell_neighbours(cloth, LatticeSlots(cloth))
    expected = set()
    for corners in cloth.cells.corners.tolist():
        (column, row), around = place[corners[0]], []
        for steps in ((0, 0, 0, -1), (1, 0, 1, -1), (0, 0, -1, 0), (1, 0, 2, 0), (0, 1, -1, 1), (1, 1, 2, 1), (0, 1, 0, 2), (1, 1, 1, 2)):
            near, far = (at.get((column + a, row + b)) for a, b in (steps[:2], steps[2:]))
            around.append(far if far is not None and frozenset((near, far)) in linked else NO_PARTICLE)
        expected.add((corners[0], tuple(around) if NO_PARTICLE not in around else (NO_PARTICLE,) * len(around)))
    assert {(corners[0], tuple(row)) for corners, row in zip(cloth.cells.corners.tolist(), found.tolist(), strict=True)} == expected
    assert 0.2 < np.mean(found[:, 0] == NO_PARTICLE) < 0.9
    rows = INSIDE.reshape(ROWS - 1, COLUMNS - 1)
    assert rows[1:-1, 1:-1].all()
    assert INSIDE.sum() == (ROWS - 3) * (COLUMNS - 3)
