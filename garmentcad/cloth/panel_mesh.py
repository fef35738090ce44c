"""The mesh of one panel at rest: lattice particles along the grain, full cells of four, and triangles in the strip between cells and contour. Millimetres.

A fold line is a contour with cloth on both sides: its points are particles, no cell reaches across, and triangles join along it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely

from garmentcad.arrays import indices
from garmentcad.cloth.contour import Contour
from garmentcad.errors import LimitError, SpecError
from garmentcad.geometry.portable import product
from garmentcad.geometry.triangle import signed_areas
from garmentcad.geometry.triangulate import TriangulationError, constrained_triangles

# Of the grid: how near to outline and folds lattice points may lie, and how short a yarn may be from one to the outline. A strip of cloth that yarns cross is
# as light as it is narrow, and as stiff; the time step of all cloth follows the narrowest. With yarns of half a grid a T-shirt goes in steps of 28 us at
# 10 mm, and without them in 38. Where few lattice points follow one another all of them are wanted, for bending.
_NEAREST = 0.5
_SHORTEST_YARN = 0.65
_FEW = 5
_NEAR = 1e-6  # of the grid: what a line that lies just so far from a straight edge may miss by round-off
PARTICLE_CAP = 1_000_000


@dataclass(frozen=True)
class PanelMesh:
    """Points are lattice points, row by row (a row runs along weft), then the contour points in their order.

    points (N,2): (weft, warp) in mm in the grain frame, which is the panel turned by -grain about the panel's origin; place (n,2) int32: lattice column and
    row of the n lattice points; cells (C,4) int32: corners 00, 10, 11, 01; triangles (T,3) int32, counter-clockwise; cell_parity (C,): column + row,
    for the checkerboard of diagonals.
    """

    spacing: float
    points: np.ndarray
    place: np.ndarray
    cells: np.ndarray
    cell_parity: np.ndarray
    triangles: np.ndarray
    contour: Contour

    @property
    def lattice_count(self) -> int:
        return len(self.place)

    @property
    def segments(self) -> np.ndarray:
        """(S,2) int32 contour segments in the numbering of `points`, the panel on the left."""
        return self.contour.segments + np.int32(self.lattice_count)

    @property
    def fold_segments(self) -> tuple[np.ndarray, np.ndarray]:
        """(F,2) int32 segments of folds, and the fold of each (F,)."""
        ends, fold = self.contour.fold_segments
        return ends + np.int32(self.lattice_count), fold

    @property
    def walls(self) -> np.ndarray:
        """(S+F,2) int32 those and the segments of folds."""
        return self.contour.walls + np.int32(self.lattice_count)


def to_grain(points: np.ndarray, grain_deg: float) -> np.ndarray:
    """(weft, warp) coordinates of panel points (N,2); warp is panel +y turned counter-clockwise by the grain angle."""
    c, s = math.cos(math.radians(grain_deg)), math.sin(math.radians(grain_deg))
    return product(points, [[c, -s], [s, c]])


def to_panel(points: np.ndarray, grain_deg: float) -> np.ndarray:
    """Panel coordinates of (weft, warp) points: the inverse of `to_grain`."""
    return to_grain(points, -grain_deg)


def mesh_panel(
    name: str, contour: Contour, grain_deg: float, grid_mm: float, origin_mm: tuple[float, float] | None = None, particle_cap: int = PARTICLE_CAP
) -> PanelMesh:
    """Mesh a panel. The lattice passes through `origin_mm` (panel coordinates), by default it is symmetric in the panel's box along the grain.

    Lattice points are kept inside the outline where they lie at least half a grid from it and from folds, and where yarns run from them to the outline over at
    least 0.65 of a grid, but for those of rows and columns of five points or fewer. A cell is full when its four corners are kept and no outline
    or fold runs through it. Raises LimitError above `particle_cap` particles, SpecError when the strip cannot be triangulated.
    """
    expected = contour.polygon.area / grid_mm**2 + len(contour.points_mm)
    if expected > particle_cap:
        raise LimitError(f"about {expected:,.0f} particles at a grid of {grid_mm:g} mm; at most {particle_cap:,} are allowed", key=f"panels.{name}")
    border = to_grain(contour.points_mm, grain_deg)
    lower, upper = border.min(axis=0), border.max(axis=0)
    origin = _centered_origin(lower, upper, grid_mm) if origin_mm is None else to_grain(np.array([origin_mm], dtype=float), grain_deg)[0]
    lattice, place = _lattice_points(contour, border, origin, grid_mm)
    corners = _kept_squares(place)
    corners = corners[~_cut_squares(lattice[corners], border, contour.walls)]
    points = np.concatenate([lattice, border])
    triangles = _strip(name, points, corners, contour, len(lattice), grid_mm)
    return PanelMesh(grid_mm, points, place, corners, place[corners[:, 0]].sum(axis=1), triangles, contour)


def _centered_origin(lower: np.ndarray, upper: np.ndarray, grid: float) -> np.ndarray:
    """The box's centre, or half a grid beside it: whichever puts the outermost lattice line nearer to one grid from the box, between 3/4 and 5/4.

    It is a grid for a box of whole grids, up to round-off. A box of up to 1.5 grids has its one line in the middle: beside it there would be none, and a strap
    would bend along its length for nothing.
    """
    half = 0.5 * (upper - lower) / grid
    gap = (half + 0.25 - _NEAR) % 1.0  # from 3/4 of a grid off the box, where a line may be, to the last one of a lattice through the centre
    return 0.5 * (lower + upper) + np.where((gap < 0.5) | (half < 0.75 + _NEAR), 0.0, 0.5 * grid)


def _lattice_points(contour: Contour, border: np.ndarray, origin: np.ndarray, grid: float) -> tuple[np.ndarray, np.ndarray]:
    first = np.ceil((border.min(axis=0) - origin) / grid).astype(int)
    last = np.floor((border.max(axis=0) - origin) / grid).astype(int)
    row, column = np.mgrid[first[1] : last[1] + 1, first[0] : last[0] + 1]
    place = np.stack([column.ravel(), row.ravel()], axis=1)
    points = origin + place * grid
    loops = [border[a:b] for a, b in zip(contour.loop_start[:-1], contour.loop_start[1:])]
    polygon = shapely.Polygon(loops[0], loops[1:])
    shapely.prepare(polygon)
    inside = shapely.contains_xy(polygon, points[:, 0], points[:, 1])
    points, place = points[inside], place[inside]
    walls, outline = (shapely.STRtree(shapely.linestrings(border[segments])) for segments in (contour.walls, contour.segments))
    far = ~_touching(walls, shapely.points(points), (_NEAREST - _NEAR) * grid)
    points, place = points[far], place[far]
    beside = np.flatnonzero(_touching(outline, shapely.points(points), _SHORTEST_YARN * grid))
    long_rows, keep = _runs(place)[beside] > _FEW, np.ones(len(points), dtype=bool)
    for axis in range(2):
        yarns = np.stack([points[beside], points[beside]], axis=1)
        yarns[:, :, axis] += (_SHORTEST_YARN - _NEAR) * grid * np.array([-1.0, 1.0])
        keep[beside[long_rows[:, axis] & _touching(outline, shapely.linestrings(yarns), 0.0)]] = False
    return points[keep], indices(place[keep].reshape(-1, 2))


def _touching(lines: shapely.STRtree, shapes: Any, distance: float) -> np.ndarray:
    """(n,) bool: which of n shapes come within a distance of the lines."""
    found = np.zeros(len(shapes), dtype=bool)
    found[lines.query(shapes, predicate="dwithin", distance=distance)[0]] = True
    return found


def _runs(place: np.ndarray) -> np.ndarray:
    """(n,2) how many lattice points follow one another along weft, and along warp, where each of place (n,2) is one of them."""
    found = np.zeros(place.shape, dtype=np.int64)
    for axis in range(2):
        order = np.lexsort((place[:, axis], place[:, 1 - axis]))
        step = np.diff(place[order], axis=0)
        run = np.cumsum(np.append(False, (step[:, axis] != 1) | (step[:, 1 - axis] != 0)))[: len(place)]
        found[order, axis] = np.bincount(run)[run]
    return found


def neighbors(place: np.ndarray, step: tuple[int, int]) -> np.ndarray:
    """Index (n,) of the lattice point one `step` (columns, rows) away from each, -1 where there is none."""
    if len(place) == 0:
        return np.empty(0, dtype=np.int64)
    low = place.min(axis=0) - 1
    size = place.max(axis=0) - low + 2
    table = np.full(size, -1)
    table[tuple((place - low).T)] = np.arange(len(place))
    return table[tuple((place - low + np.array(step)).T)]


def _kept_squares(place: np.ndarray) -> np.ndarray:
    """(C,4) squares whose four corners 00, 10, 11, 01 are kept."""
    squares = np.stack([np.arange(len(place)), *(neighbors(place, step) for step in ((1, 0), (1, 1), (0, 1)))], axis=1)
    return indices(squares[(squares >= 0).all(axis=1)])


def _cut_squares(squares: np.ndarray, border: np.ndarray, segments: np.ndarray) -> np.ndarray:
    """(C,) bool: whether a contour runs through a square (the tip of a narrow dart between four lattice points, a small hole)."""
    cut = np.zeros(len(squares), dtype=bool)
    tree = shapely.STRtree(shapely.linestrings(border[segments]))
    hit, _ = tree.query(shapely.box(*squares[:, 0].T, *squares[:, 2].T), predicate="intersects")
    cut[hit] = True
    return cut


def _strip(name: str, points: np.ndarray, cells: np.ndarray, contour: Contour, lattice_count: int, grid: float) -> np.ndarray:
    """Triangles between cells and contour: all contour points, and the lattice points that are not surrounded by cells."""
    rims = np.concatenate([cells[:, [k, (k + 1) % 4]] for k in range(4)])
    forward = rims[:, 0].astype(np.int64) * len(points) + rims[:, 1]
    backward = rims[:, 1].astype(np.int64) * len(points) + rims[:, 0]
    rims = rims[~np.isin(forward, backward)][:, ::-1]  # cells lie to the right of the strip's border
    border = np.concatenate([contour.segments + lattice_count, rims])
    surrounded = np.bincount(cells.ravel(), minlength=len(points)) == 4
    used = np.flatnonzero(~surrounded)
    renumber = np.cumsum(~surrounded) - 1
    key = f"panels.{name}"
    try:
        triangles = indices(used[constrained_triangles(points[used], renumber[border], renumber[contour.fold_segments[0] + lattice_count])])
    except TriangulationError as error:
        raise SpecError(f"the panel cannot be triangulated at a grid of {grid:g} mm ({error}); outline parts may lie too close together", key=key) from error
    areas = signed_areas(points, triangles)
    missing = contour.polygon.area - len(cells) * grid**2 - areas.sum()
    if areas.min() <= 0.0 or abs(missing) > 1e-9 * contour.polygon.area or not np.isin(used, triangles).all():
        u, v = contour.points_mm.mean(axis=0) if areas.min() > 0.0 else points[triangles[areas.argmin()]].mean(axis=0)
        raise SpecError(f"the panel cannot be triangulated at a grid of {grid:g} mm near ({u:.1f}, {v:.1f}) mm along weft and warp", key=key)
    return triangles
