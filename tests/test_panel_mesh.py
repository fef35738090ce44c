"""The mesh of a panel against shapely: areas, distances, completeness, on rectangles, discs, darts, neckbands, tiny panels and random outlines."""

from __future__ import annotations

import math

import numpy as np
import pytest
import shapely
from drawn import GRAINS, disc, mesh, panel, rectangle
from hypothesis import given, settings
from hypothesis import strategies as st

from garmentcad.cloth.panel_mesh import PanelMesh, neighbors, to_grain, to_panel
from garmentcad.errors import LimitError
from garmentcad.geometry.triangle import signed_areas

NECKLINE = [(0, 0), (400, 0), (400, 300), (320, 300), (300, 220), (200, 190), (100, 220), (80, 300), (0, 300)]
SLIM_DART = [(0, 0), (300, 0), (300, 200), (150.6, 200), (150, 100.3), (149.4, 200), (0, 200)]


def check(made: PanelMesh) -> None:
    """Everything that must hold for any panel, with shapely as the judge."""
    polygon = made.contour.polygon
    cell_area = made.spacing**2
    quads = made.points[made.cells]
    if len(quads):
        assert quads[:, 1] - quads[:, 0] == pytest.approx(np.tile([made.spacing, 0.0], (len(quads), 1)), abs=1e-9)
        assert quads[:, 3] - quads[:, 0] == pytest.approx(np.tile([0.0, made.spacing], (len(quads), 1)), abs=1e-9)
        assert quads[:, 2] - quads[:, 1] == pytest.approx(np.tile([0.0, made.spacing], (len(quads), 1)), abs=1e-9)
    areas = signed_areas(made.points, made.triangles)
    assert areas.min() > 0.0
    assert areas.sum() + len(made.cells) * cell_area == pytest.approx(polygon.area, rel=1e-9)
    used = np.union1d(made.cells, made.triangles)
    assert np.array_equal(used, np.arange(len(made.points)))
    loops = [made.points[made.lattice_count :][a:b] for a, b in zip(made.contour.loop_start[:-1], made.contour.loop_start[1:])]
    turned = shapely.Polygon(loops[0], loops[1:])
    lattice = shapely.points(made.points[: made.lattice_count])
    assert shapely.contains(turned, lattice).all()
    if made.lattice_count:
        assert shapely.distance(turned.boundary, lattice).min() >= 0.499 * made.spacing
    assert shapely.covers(turned.buffer(1e-6), shapely.polygons(quads)).all()
    # A closed surface: every directed edge once; what has no partner is the contour.
    faces = [made.triangles[:, [k, (k + 1) % 3]] for k in range(3)] + [made.cells[:, [k, (k + 1) % 4]] for k in range(4)]
    edges = {(int(a), int(b)) for a, b in np.concatenate(faces)}
    assert len(edges) == 3 * len(made.triangles) + 4 * len(made.cells)
    assert {edge for edge in edges if edge[::-1] not in edges} == {(int(a), int(b)) for a, b in made.segments}


@pytest.mark.parametrize("grain", GRAINS)
@pytest.mark.parametrize(
    "points",
    [
        [(0, 0), (150, 0), (150, 50), (0, 50)],
        [(0, 0), (400, 0), (400, 30), (0, 30)],
        [(0, 0), (60, 0), (60, 8), (0, 8)],
        [(0, 0), (4, 0), (4, 8)],
        NECKLINE,
        SLIM_DART,
    ],
    ids=["strip", "neckband", "tape", "corner", "neckline", "slim dart"],
)
def test_panels_are_filled(points, grain: float) -> None:
    check(mesh(panel(points, grain), 10.0))


@pytest.mark.parametrize("grid", [20.0, 10.0, 5.0])
def test_discs_and_holes(grid: float) -> None:
    check(mesh(disc(150.0, 17.0), grid))
    holes = [[(40, 40), (40, 43), (43, 43)], [(60, 60), (60, 160), (160, 160), (160, 60)]]
    check(mesh(panel([(0, 0), (200, 0), (200, 200), (0, 200)], 30.0, holes=holes), grid))


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 10**6), st.integers(3, 25), st.floats(0.0, 0.9), st.sampled_from([7.0, 10.0, 23.0]), st.floats(-180, 180))
def test_random_outlines(seed: int, count: int, spread: float, grid: float, grain: float) -> None:
    random = np.random.default_rng(seed)
    angle = (np.arange(count) + 0.4 * random.uniform(-1, 1, count)) * 2 * math.pi / count
    radius = 120 * (1 - spread * random.uniform(size=count))
    check(mesh(panel(np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=1), grain), grid))


def test_a_hole_between_four_particles_opens_the_cell() -> None:
    # Every corner of the small hole is more than half a grid from the four lattice points around it.
    holed = panel([(0, 0), (100, 0), (100, 100), (0, 100)], holes=[[(54, 54), (54, 56), (56, 56), (56, 54)]])
    made = mesh(holed, 10.0, origin_mm=(0.0, 0.0))
    check(made)
    assert made.lattice_count == 81
    assert len(made.cells) == 63


def test_frames() -> None:
    warp = np.array([[-math.sin(math.radians(30)), math.cos(math.radians(30))]])  # +y turned counter-clockwise
    assert to_grain(warp, 30.0) == pytest.approx(np.array([[0.0, 1.0]]), abs=1e-15)
    points = np.random.default_rng(0).normal(size=(5, 2))
    assert to_panel(to_grain(points, 73.0), 73.0) == pytest.approx(points, abs=1e-15)


@pytest.mark.parametrize("width", [150.0, 153.0, 155.0, 158.0])
def test_symmetric_panels_have_symmetric_lattices(width: float) -> None:
    made = mesh(rectangle(width, 80.0), 10.0)
    lattice = made.points[: made.lattice_count]
    mirrored = np.stack([width - lattice[:, 0], lattice[:, 1]], axis=1)
    assert {tuple(point) for point in mirrored.round(6)} == {tuple(point) for point in lattice.round(6)}
    gap = lattice[:, 0].min()
    assert 7.5 <= gap <= 12.5


@pytest.mark.parametrize(
    "shape",
    [disc(187.0, 17.0), panel(NECKLINE, 3.0), rectangle(300.0, 35.0), rectangle(300.0, 51.0), rectangle(300.0, 61.0)],
    ids=["disc", "neckline, turned", "three rows", "five rows", "six rows"],
)
@pytest.mark.parametrize("origin", [(0.0, 0.0), (3.0, 5.4), (7.9, 1.2)])
def test_lattice_points_and_yarns_keep_off_the_outline(shape, origin: tuple[float, float]) -> None:
    """Point by point, with shapely: half a grid off, and yarns of 0.65 of a grid where more than five points follow one another."""
    grid = 10.0
    made = mesh(shape, grid, origin_mm=origin)
    outline = shapely.Polygon(to_grain(made.contour.points_mm, shape.grain_deg))
    start = to_grain(np.array([origin]), shape.grain_deg)[0]
    far = {
        (i, j): start + grid * np.array([i, j])
        for i in range(-60, 60)
        for j in range(-60, 60)
        if outline.contains(point := shapely.Point(start + grid * np.array([i, j]))) and outline.exterior.distance(point) >= 0.4999 * grid
    }

    def run(i: int, j: int, di: int, dj: int) -> int:
        return 1 + sum(next(k for k in range(1, 200) if (i + s * k * di, j + s * k * dj) not in far) - 1 for s in (-1, 1))

    wanted = set()
    for (i, j), place in far.items():
        yarns = [(6.499 * np.array(way), run(i, j, *way)) for way in ((1, 0), (0, 1))]
        short = [count for yarn, count in yarns if shapely.LineString([place - yarn, place + yarn]).intersects(outline.exterior)]
        if all(count <= 5 for count in short):
            wanted.add(tuple(place.round(6) + 0.0))
    assert {tuple(point) for point in made.points[: made.lattice_count].round(6) + 0.0} == wanted


def test_round_off_of_a_width_does_not_leave_a_sliver() -> None:
    for width in (740.0 - 1e-7, 740.0, 740.0 + 1e-7, 370.0 + 1e-7):
        made = mesh(rectangle(width, 38.0), 20.0 if width > 400.0 else 10.0)
        lattice = made.points[: made.lattice_count]
        assert lattice[:, 0].min() == pytest.approx(made.spacing, abs=1e-6)


def test_rows_run_along_weft_and_neighbors_are_found() -> None:
    made = mesh(rectangle(150.0, 80.0, 30.0), 10.0)
    order = np.lexsort((made.place[:, 0], made.place[:, 1]))
    assert np.array_equal(order, np.arange(made.lattice_count))
    right = neighbors(made.place, (1, 0))
    for k in range(made.lattice_count):
        expected = np.flatnonzero((made.place == made.place[k] + [1, 0]).all(axis=1))
        assert right[k] == (expected[0] if len(expected) else -1)


def test_origin_and_cap() -> None:
    made = mesh(rectangle(150.0, 80.0), 10.0, origin_mm=(3.0, 4.0))
    assert made.points[: made.lattice_count] % 10.0 == pytest.approx(np.tile([3.0, 4.0], (made.lattice_count, 1)))
    with pytest.raises(LimitError, match=r"panels\.front: about 1,0\d\d,\d\d\d,\d\d\d particles at a grid of 0.1 mm; at most 1,000,000"):
        mesh(rectangle(5000.0, 2000.0), 0.1)
