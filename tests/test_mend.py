"""What a change of the lattice leaves crossing is mended, judged by ipctk, and nothing else moves."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh
from loose_sheet import Sheet, crosses

from garmentcad.contact.pairs import Pairs, make_pairs
from garmentcad.simulation.mend import off_body, parted, pulled_out, turned_out


def test_what_a_sharp_body_pricks_is_moved_off_it_and_nothing_else_moves() -> None:
    """A cone whose tip stands 1.3 mm out of a flat cloth: it crosses before, not afterwards, and only the particles about the tip have moved."""
    cone = trimesh.creation.cone(radius=0.05, height=0.05, sections=16)
    x, y = np.meshgrid(np.arange(-5, 6), np.arange(-5, 6), indexing="ij")
    flat = np.column_stack([0.01 * x.ravel() + 0.004, 0.01 * y.ravel() + 0.003, np.full(x.size, 0.0487)])
    corner = np.arange(x.size).reshape(x.shape)[:-1, :-1].ravel()
    triangles = np.vstack([np.column_stack([corner, corner + 11, corner + 12]), np.column_stack([corner, corner + 12, corner + 1])])
    both = np.vstack([triangles, cone.faces + len(flat)])
    assert crosses(np.vstack([flat, cone.vertices]), both)
    moved = off_body(flat, triangles, np.array(cone.vertices), np.array(cone.faces), 0.01, 0.004)
    assert not crosses(np.vstack([moved, cone.vertices]), both)
    way = np.linalg.norm(moved - flat, axis=1)
    assert way.max() < 0.005
    far = np.linalg.norm(flat[:, :2], axis=1) > 0.02
    assert (way[far] == 0.0).all()


@pytest.mark.parametrize("number", [0, 5, 35, 12])
def test_a_corner_that_lies_through_its_cloth_is_turned_out_and_nothing_else_moves(number: int) -> None:
    """A corner, or a vertex of an edge, of a wavy sheet of 10 mm is put through the cells beside it."""
    sheet, rng = Sheet(5), np.random.default_rng(number)
    triangles, home = sheet.cloth.particle_triangles, sheet.positions[number]
    inward = sheet.positions.mean(axis=0) - home
    inward /= np.linalg.norm(inward)
    tried = 0
    while tried < 20:
        caught = sheet.positions + rng.uniform(-2e-3, 2e-3, sheet.positions.shape)
        caught[number] += 12e-3 * inward + rng.uniform(-6e-3, 6e-3, 3)
        if not crosses(caught, triangles):
            continue
        tried += 1
        turned = turned_out(caught, triangles)
        assert not crosses(turned, triangles)
        way = np.linalg.norm(turned - caught, axis=1)
        assert way.max() < 0.02
        assert (way[np.linalg.norm(sheet.positions - home, axis=1) > 0.035] == 0.0).all()


def test_cloth_that_crosses_nothing_stays_in_the_same_bits() -> None:
    sheet = Sheet(5)
    assert turned_out(sheet.positions, sheet.cloth.particle_triangles).tobytes() == sheet.positions.tobytes()


# Two sides of a pleat under its band, mm, refined from 20 to 10 mm: on 20 mm both are sewn to one point beside their fold, so that they lie on each other here.
PLEAT_TOP_MM = """
-8.2 17.9 1.2, 1.8 18 1.4, -14.8 6.9 1.2, -6 6.6 0.5, 3.8 7 1.8, 13.7 7.3 2.8, -8.4 -13.1 2.5, 1.6 -13.1 3.2, 11.6 -12.9 3.9, 6.3 -14.2 -0.4, 2.2 -14.2 -1,
12.3 -14 -1.3, -18.5 -2.9 2.2, -8.3 -3.3 1.4, 1.7 -3.1 2.3, 11.6 -2.8 3.3, 16.2 -4.1 -0.1, 6.1 -4.3 -0.3, 1.9 -4.4 -0.3, 12.1 -4.2 -0.7, 13.8 5.8 -0.1,
3.9 6 0.2, -5.9 -3.9 -0.1, -5.9 -14.4 -0.7"""
PLEAT_TOP = """
0 2 3, 0 3 1, 1 3 4, 6 7 13, 7 14 13, 7 8 15, 7 15 14, 9 17 16, 10 11 19, 10 19 18, 9 23 17, 10 18 23, 12 13 2, 13 14 3, 13 3 2, 14 15 4, 14 4 3, 15 5 4,
16 17 20, 17 21 20, 17 22 21, 17 23 22, 18 19 21, 18 21 3, 18 3 22, 18 22 23, 19 20 21, 3 21 22"""


def test_the_top_of_a_pleat_is_turned_out() -> None:
    """Eight turns left two pairs of its triangles, and the pleated skirt was draped anew on 10 mm for them."""
    positions = 1e-3 * np.array([row.split() for row in PLEAT_TOP_MM.split(",")], dtype=float)
    triangles = np.array([row.split() for row in PLEAT_TOP.split(",")], dtype=int)
    assert crosses(positions, triangles)
    turned = turned_out(positions, triangles)
    assert not crosses(turned, triangles)
    assert np.linalg.norm(turned - positions, axis=1).max() < 0.01


# Shell and lining of a skirt where they are sewn together along its zip and its waist, refined from 20 to 10 mm: 0, 1 and 2 are on the seams, 3 of the shell,
# 4 of the lining. The edges 0-3 and 1-2 meet.
ZIP_TOP_MM = np.array([[0.0, 0.0, 0.0], [0.0, -10.0, 0.0], [10.0, 0.0, 0.0], [8.5, -7.5, 0.0], [11.0, -7.5, 0.2]])
ZIP_TOP = np.array([[3, 0, 2], [3, 1, 0], [0, 2, 1], [4, 1, 2]])


@pytest.mark.parametrize("outside", [1.0, -1.0])
@pytest.mark.parametrize("edges", [[0, 3, 1, 2], [0, 3, 2, 1]])
def test_edges_that_meet_are_parted_to_the_side_on_which_nothing_crosses(outside: float, edges: list[int]) -> None:
    """Contact can move nothing that has no room to lose: the lined skirt ended at its first steps on 10 mm. The shell goes where the lining is not."""
    positions = 1e-3 * ZIP_TOP_MM * [1.0, 1.0, outside]
    apart = parted(positions, ZIP_TOP, _edge_pair(edges))
    assert not crosses(apart, ZIP_TOP)
    assert np.linalg.norm(apart - positions, axis=1).max() < 0.1e-3
    assert (apart[4] == positions[4]).all()
    # where the edges pass each other, 0-3 lies on the other side of 1-2 than the lining
    along = np.cross(apart[3] - apart[0], apart[2] - apart[1])
    height = (apart[0] - apart[1]) @ (along / np.linalg.norm(along)) * np.sign(along[2])
    assert 0.04e-3 < -outside * height < 0.06e-3


def test_edges_that_meet_between_layers_on_both_sides_stay() -> None:
    """A second lining on the other side of the shell: to either one the shell would go through cloth."""
    positions = 1e-3 * np.vstack([ZIP_TOP_MM, [11.0, -7.5, -0.2]])
    triangles = np.vstack([ZIP_TOP, [5, 1, 2]])
    assert parted(positions, triangles, _edge_pair([0, 3, 1, 2])).tobytes() == positions.tobytes()


def _edge_pair(nodes: list[int]) -> Pairs:
    return make_pairs(np.zeros((0, 4), dtype=np.int32), np.array([nodes], dtype=np.int32), np.full(6, 1e-3), np.zeros(6))


# Two flat sheets that lie 0.2 mm from each other along the y axis, 3 mm at one stitch; and the cells of each.
COLUMN, ROW = (axis.ravel() for axis in np.meshgrid(np.arange(5), np.arange(5), indexing="ij"))
LEFT_MM = np.column_stack([-40.1 + 10.0 * COLUMN, 10.0 * ROW - 20.0, np.zeros(25)])
LEFT_MM[22, 0] = -1.5
LOW = np.arange(20).reshape(4, 5)[:, :-1].ravel()
CELLS = np.vstack([np.column_stack([LOW, LOW + 5, LOW + 6]), np.column_stack([LOW, LOW + 6, LOW + 1])])
STITCHES = np.column_stack([np.arange(20, 25), np.arange(45, 50)])
OPEN = np.arange(5) == 2


def in_the_slit(heights_mm: list[float]) -> tuple[np.ndarray, np.ndarray]:
    """Positions and triangles of both sheets and of an upright strip in the slit between them, 8 mm wide, that ends in a corner."""
    strip = np.array([[0.05 * k, 4.0 * (-1) ** k if k < len(heights_mm) - 1 else 0.0, z] for k, z in enumerate(heights_mm)])
    last = 50 + np.arange(len(heights_mm) - 2)
    triangles = np.vstack([CELLS, CELLS + 25, np.column_stack([last, last + 1, last + 2])])
    return 1e-3 * np.vstack([LEFT_MM, LEFT_MM * [-1.0, 1.0, 1.0], strip]), triangles


def cross_when_sewn(positions: np.ndarray, triangles: np.ndarray) -> bool:
    closed, one = positions.copy(), np.arange(len(positions))
    closed[STITCHES[:, 0]] = positions[STITCHES].mean(axis=1)
    one[STITCHES[:, 1]] = STITCHES[:, 0]
    return crosses(closed, one[triangles])


def test_a_corner_that_stands_in_a_slit_is_pulled_out_of_it() -> None:
    """By as much as it stands out of it, and what the slit will be sewn to with it: the slit stays as wide as it is."""
    positions, triangles = in_the_slit([-25.0, -15.0, -10.0, 2.0])
    assert not crosses(positions, triangles)
    assert cross_when_sewn(positions, triangles)
    pulled = pulled_out(positions, triangles, STITCHES, OPEN)
    assert not cross_when_sewn(pulled, triangles)
    way = np.linalg.norm(pulled - positions, axis=1)
    assert pulled[-1, 2] < pulled[22, 2]
    assert way.max() < 0.015
    assert (way[np.hypot(positions[:, 0], positions[:, 1]) > 0.015] == 0.0).all()
    gaps = [np.linalg.norm(places[STITCHES[:, 0]] - places[STITCHES[:, 1]], axis=1) for places in (pulled, positions)]
    np.testing.assert_allclose(*gaps, atol=1e-15)


def test_what_hangs_on_both_sides_of_a_slit_stays_in_the_same_bits() -> None:
    positions, triangles = in_the_slit([float(z) for z in range(-150, 151, 15)])
    assert cross_when_sewn(positions, triangles)
    assert pulled_out(positions, triangles, STITCHES, OPEN).tobytes() == positions.tobytes()


def test_what_crosses_elsewhere_is_left_to_others() -> None:
    positions, triangles = in_the_slit([-25.0, -15.0, -10.0, 2.0])
    assert pulled_out(positions, triangles, STITCHES, np.arange(5) == 0).tobytes() == positions.tobytes()
