"""From a pattern to a cloth: contours, meshes and elements of all panels joined into one `Cloth`. Millimetres end here."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from typing import Any, NamedTuple, TypeAlias, TypeVar

import numpy as np
from scipy.spatial import cKDTree

from garmentcad.arrays import floats, frozen, indices, unique_pairs
from garmentcad.cloth.bend_lines import bend_lines
from garmentcad.cloth.border import border_triangles
from garmentcad.cloth.cloth import WARP, WEFT, BendLines, BorderTriangles, Cells, Cloth, ContourSpans, Hinges, Links
from garmentcad.cloth.contour import Contour, sample_contours
from garmentcad.cloth.contour_spans import contour_spans
from garmentcad.cloth.hinges import fold_hinges
from garmentcad.cloth.panel_mesh import PARTICLE_CAP, PanelMesh, mesh_panel, to_panel
from garmentcad.errors import InputError, LimitError, SpecError
from garmentcad.fabric.material import MaterialTable
from garmentcad.geometry.curve import Line
from garmentcad.geometry.triangle import corner_shares, signed_areas
from garmentcad.pattern.pattern import Edge, Panel, Pattern, Transform
from garmentcad.units import MM_TO_M

GRID_MM = (2.0, 50.0)  # spacings that a drape may have
MaterialOf: TypeAlias = Callable[[Panel, np.ndarray], Any]
"""Rows (N,) of the material table at the points (N,2), panel mm, of a panel."""

_Elements = TypeVar("_Elements", bound=tuple)


class _Part(NamedTuple):
    """One panel's share of the cloth, particles in the panel's own numbering."""

    uv_mm: np.ndarray
    masses: np.ndarray
    links: Links
    cells: Cells
    border: BorderTriangles
    bends: BendLines
    spans: ContourSpans
    triangles: np.ndarray
    triangle_material: np.ndarray
    hinges: Hinges


def check_grid(grid_mm: float) -> None:
    """InputError for a lattice spacing that no drape takes."""
    if not GRID_MM[0] <= grid_mm <= GRID_MM[1]:
        raise InputError(f"grid of {grid_mm:g} mm; {GRID_MM[0]:g} to {GRID_MM[1]:g} mm is allowed", key="grid_mm")


def build_cloth(
    pattern: Pattern,
    material_of: MaterialOf,
    materials: MaterialTable,
    grid_mm: float = 10.0,
    *,
    origin_mm: tuple[float, float] | None = None,
    particle_cap: int = PARTICLE_CAP,
) -> Cloth:
    """The cloth of a pattern at a lattice spacing of `grid_mm`, stitched but not welded.

    material_of(panel, points (N,2) mm) gives the material row at each point; it is asked at the centre of every element. Panels follow in the pattern's
    order; in each, lattice particles come row by row (a row runs along weft), then the contour from the first edge on. `origin_mm` (panel
    coordinates) shifts the lattice; by default it lies symmetrically in the panel's box along the grain. Raises InputError for a grid that is not a
    positive length, LimitError above `particle_cap` particles, SpecError for panels and seams that cannot be meshed, with the place.
    """
    if not (np.isfinite(grid_mm) and grid_mm > 0.0):
        raise InputError(f"a grid of {grid_mm} mm came; it must be a positive length", key="grid_mm")
    grid_mm = float(grid_mm)
    if not pattern.panels:
        raise SpecError("the pattern has no panels", key="panels")
    length = sum(edge.curve.length for panel in pattern.panels.values() for loop in (panel.edges, *panel.holes) for edge in loop)
    if length / grid_mm > particle_cap:
        raise LimitError(f"outlines of {length:,.0f} mm need more than {particle_cap:,} particles at a grid of {grid_mm:g} mm", key="grid_mm")
    contours, stitches = sample_contours(pattern, grid_mm)
    meshes, room = [], particle_cap
    for name, panel in pattern.panels.items():
        meshes.append(mesh_panel(name, contours[name], panel.grain_deg, grid_mm, origin_mm, room))
        room -= len(meshes[-1].points)
    parts = [_part(panel, mesh, material_of, materials) for panel, mesh in zip(pattern.panels.values(), meshes)]
    sizes = np.array([len(mesh.points) for mesh in meshes])
    first = np.concatenate([[0], np.cumsum(sizes)])
    contour_first = first[:-1] + np.array([mesh.lattice_count for mesh in meshes])
    pairs = [np.stack([contour_first[rows[:, 0]] + rows[:, 1], contour_first[rows[:, 2]] + rows[:, 3]], axis=1) for rows in stitches]
    on_contour = np.arange(first[-1]) >= np.repeat(contour_first, sizes)
    holding = {seam.caught_in for seam in pattern.seams}
    return Cloth(
        spacing=grid_mm * MM_TO_M,
        panel_names=tuple(pattern.panels),
        vertex_uv_mm=frozen(floats(np.concatenate([part.uv_mm for part in parts]))),
        vertex_panel=frozen(indices(np.repeat(np.arange(len(parts)), sizes))),
        vertex_particle=frozen(indices(np.arange(first[-1]))),
        vertex_on_contour=frozen(on_contour),
        vertex_place=frozen(indices(np.concatenate([_places(mesh) for mesh in meshes]))),
        masses=frozen(floats(np.concatenate([part.masses for part in parts]))),
        links=_join([part.links for part in parts], first, ("ends",)),
        cells=_join([part.cells for part in parts], first, ("corners",)),
        border=_join_border([part.border for part in parts], first),
        bends=_join([part.bends for part in parts], first, ("center", "arm_a", "arm_b")),
        spans=_join([part.spans for part in parts], first, ("corners",)),
        hinges=_join_hinges(pattern, parts, first),
        triangles=frozen(indices(np.concatenate([part.triangles + start for part, start in zip(parts, first)]))),
        triangle_material=frozen(indices(np.concatenate([part.triangle_material for part in parts]))),
        stitches=frozen(indices(np.concatenate(pairs) if pairs else np.empty((0, 2)))),
        stitch_seam=frozen(indices(np.repeat(np.arange(len(pairs)), [len(rows) for rows in pairs]))),
        seam_names=tuple(seam.name for seam in pattern.seams),
        edge_vertices=_edge_vertices(pattern, contours, contour_first),
        seam_fold=frozen(floats(np.radians([seam.fold_angle_deg for seam in pattern.seams]))),
        seam_bend_factor=frozen(floats([seam.bend_factor for seam in pattern.seams])),
        seam_order=frozen(indices([seam.order for seam in pattern.seams])),
        seam_layered=frozen(np.array([seam.tack is not None or seam.caught_in is not None or seam.name in holding for seam in pattern.seams], dtype=bool)),
        fold_names=tuple(f"{name}.{fold.name}" for name, panel in pattern.panels.items() for fold in panel.folds),
        panel_layer=frozen(indices([panel.layer for panel in pattern.panels.values()])),
    )


def panel_cloth(panel: Panel, materials: MaterialTable, material: int = 0, grid_mm: float = 10.0, *, origin_mm: tuple[float, float] | None = None) -> Cloth:
    """The cloth of a single panel in one material: specimens for testers and tests."""
    pattern = Pattern(panel.name, {panel.name: panel}, (), "", "", {}, {})
    return build_cloth(pattern, lambda _, points: np.full(len(points), material), materials, grid_mm, origin_mm=origin_mm)


def rectangle_cloth(
    width_mm: float,
    height_mm: float,
    grid_mm: float,
    grain_deg: float,
    materials: MaterialTable,
    material: int = 0,
    *,
    origin_mm: tuple[float, float] | None = None,
) -> Cloth:
    """A rectangle from (0, 0) to (width, height): one panel `rectangle` with the edges bottom, right, top and left."""
    if not (np.isfinite([width_mm, height_mm]).all() and min(width_mm, height_mm) > 0.0):
        raise InputError(f"a rectangle of {width_mm} x {height_mm} mm came; both must be positive lengths")
    corners = [(0.0, 0.0), (float(width_mm), 0.0), (float(width_mm), float(height_mm)), (0.0, float(height_mm))]
    names = ("bottom", "right", "top", "left")
    edges = tuple(Edge(name, f"p{k}", f"p{(k + 1) % 4}", Line(corners[k], corners[(k + 1) % 4])) for k, name in enumerate(names))
    panel = Panel("rectangle", edges, grain_deg, Transform((0.0, 0.0, 0.0), (0.0, 0.0, 0.0)))
    return panel_cloth(panel, materials, material, grid_mm, origin_mm=origin_mm)


def _part(panel: Panel, mesh: PanelMesh, material_of: MaterialOf, materials: MaterialTable) -> _Part:
    uv = to_panel(mesh.points, panel.grain_deg)
    uv[mesh.lattice_count :] = mesh.contour.points_mm  # outline points keep their bits

    def rows_at(points: np.ndarray) -> np.ndarray:
        rows = indices(material_of(panel, points))
        allowed = len(materials.areal_mass)
        if rows.shape != (len(points),) or (len(rows) and not 0 <= rows.min() <= rows.max() < allowed):
            raise InputError(f"material_of must give one row of 0..{allowed - 1} for each of {len(points)} points", key=f"panels.{panel.name}")
        return rows

    area = (mesh.spacing * MM_TO_M) ** 2
    cell_material = rows_at(uv[mesh.cells].mean(axis=1))
    strip_material = rows_at(uv[mesh.triangles].mean(axis=1))
    strip_area = signed_areas(mesh.points, mesh.triangles) * MM_TO_M**2
    count = len(mesh.points)
    corner_mass = np.repeat(0.25 * area * materials.areal_mass[cell_material], 4)
    strip_mass = (strip_area * materials.areal_mass[strip_material])[:, None] * corner_shares(mesh.points[mesh.triangles])
    corners = np.concatenate([mesh.cells.ravel(), mesh.triangles.ravel()])
    masses = np.bincount(corners, weights=np.concatenate([corner_mass, strip_mass.ravel()]), minlength=count)
    cells = Cells(
        corners=mesh.cells,
        spacing=np.full(len(mesh.cells), mesh.spacing * MM_TO_M),
        shear_area=np.full(len(mesh.cells), area),
        twist_area=_twist_areas(mesh, area, strip_area),
        material=cell_material,
    )
    bends = bend_lines(mesh)
    links, spans, border = _links(mesh), contour_spans(mesh, strip_material), border_triangles(mesh, strip_material)
    triangles, source = _contact_triangles(mesh)
    return _Part(
        uv,
        masses,
        links._replace(material=rows_at(uv[links.ends].mean(axis=1))),
        cells,
        border,
        bends._replace(material=rows_at(uv[bends.center])),
        spans,
        triangles,
        np.concatenate([cell_material[source], strip_material]),
        fold_hinges(border, *mesh.fold_segments, np.array([fold.strength for fold in panel.folds])),
    )


def _places(mesh: PanelMesh) -> np.ndarray:
    """(N,2) column and row of the lattice points from 0, -1 for the contour."""
    place = mesh.place - (mesh.place.min(axis=0) if mesh.lattice_count else 0)
    return np.concatenate([place, np.full((len(mesh.points) - mesh.lattice_count, 2), -1)])


def _links(mesh: PanelMesh) -> Links:
    """Sides of full cells, along weft first, material row 0."""
    parts = []
    for number, sides in ((WEFT, ((0, 1), (3, 2))), (WARP, ((0, 3), (1, 2)))):
        ends, link = unique_pairs(np.concatenate([mesh.cells[:, side] for side in sides]))
        parts.append((ends, 0.5 * np.bincount(link) * mesh.spacing * MM_TO_M, np.full(len(ends), number)))
    ends, width, direction = (np.concatenate(column) for column in zip(*parts))
    rest = np.full(len(ends), mesh.spacing * MM_TO_M)
    return Links(indices(ends), rest, floats(width), indices(direction), np.zeros(len(ends), dtype=np.int32))


def _twist_areas(mesh: PanelMesh, area: float, strip_area: np.ndarray) -> np.ndarray:
    """Area of each cell and of the border triangles that are nearest to it."""
    if len(mesh.cells) == 0:
        return np.empty(0)
    centers = mesh.points[mesh.cells].mean(axis=1)
    _, nearest = cKDTree(centers).query(mesh.points[mesh.triangles].mean(axis=1))
    return area + np.bincount(nearest, weights=strip_area, minlength=len(centers))


def _contact_triangles(mesh: PanelMesh) -> tuple[np.ndarray, np.ndarray]:
    """Two triangles for each cell, the diagonals as on a checkerboard, then the border triangles; and the cell of each of the former."""
    even, odd = mesh.cells[:, [0, 1, 2, 0, 2, 3]], mesh.cells[:, [0, 1, 3, 1, 2, 3]]
    halves = np.where((mesh.cell_parity % 2 == 0)[:, None], even, odd).reshape(-1, 3)
    return np.concatenate([halves, mesh.triangles]), np.repeat(np.arange(len(mesh.cells)), 2)


def _join(parts: list[_Elements], first: np.ndarray, numbered: tuple[str, ...]) -> _Elements:
    """One family of elements from the panels' families; fields named in `numbered` hold particles and are shifted by each panel's first."""
    kind = type(parts[0])
    fields = []
    for name in kind._fields:  # type: ignore[attr-defined]
        columns = [getattr(part, name) + (np.int32(start) if name in numbered else np.int32(0)) for part, start in zip(parts, first)]
        column = np.concatenate(columns)
        fields.append(frozen(indices(column) if column.dtype.kind == "i" else floats(column)))
    return kind(*fields)


def _join_border(parts: list[BorderTriangles], first: np.ndarray) -> BorderTriangles:
    triangle_first = np.cumsum([0, *(len(part.area) for part in parts)])
    patch_first = np.cumsum([0, *(len(part.patch_material) for part in parts)])
    shifted = [
        part._replace(
            patch=part.patch + np.int32(patch_start),
            patch_triangle=part.patch_triangle + np.int32(triangle_start),
            patch_start=(part.patch_start + np.int32(3 * triangle_start))[0 if number == 0 else 1 :],
        )
        for number, (part, triangle_start, patch_start) in enumerate(zip(parts, triangle_first, patch_first))
    ]
    return _join(shifted, first, ("corners",))


def _join_hinges(pattern: Pattern, parts: list[_Part], first: np.ndarray) -> Hinges:
    counts = [len(panel.folds) for panel in pattern.panels.values()]
    shifted = [part.hinges._replace(fold=part.hinges.fold + np.int32(before)) for part, before in zip(parts, np.cumsum([0, *counts]))]
    return _join(shifted, first, ("corners",))


def _edge_vertices(pattern: Pattern, contours: dict[str, Contour], contour_first: np.ndarray) -> dict[str, np.ndarray]:
    """Vertices along each edge; the pieces into which darts cut an edge follow one another."""
    found: dict[str, np.ndarray] = {}
    for (name, panel), start in zip(pattern.panels.items(), contour_first):
        edges = [edge for loop in (panel.edges, *panel.holes) for edge in loop]
        pieces = sorted(((edge.name, edge.piece, number) for number, edge in enumerate(edges)))
        for last, piece in pairwise(pieces):
            if last[:2] == piece[:2]:
                raise SpecError(f"two edges are named {piece[0]!r}", key=f"panels.{name}.edges")
        for edge_name, _, number in pieces:
            vertices = contours[name].edge_points[number] + start
            before = found.get(f"{name}.{edge_name}", vertices[:0])
            if len(before) and before[-1] == vertices[0]:
                vertices = vertices[1:]
            found[f"{name}.{edge_name}"] = np.concatenate([before, vertices])
    return {key: frozen(indices(vertices)) for key, vertices in found.items()}
