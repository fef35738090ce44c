"""Cloths and bodies made by hand, so that the tests of results need neither lattice nor simulation."""

from __future__ import annotations

import math

import numpy as np
import trimesh

from garmentcad.arrays import floats, frozen, indices, rows_by_key
from garmentcad.cloth.cloth import WARP, WEFT, BendLines, BorderTriangles, Cells, Cloth, ContourSpans, Hinges, Links
from garmentcad.fabric.material import MaterialTable
from garmentcad.mannequin.mannequin import ArrangementCylinder, Mannequin


def materials() -> MaterialTable:
    """Two rows: a curved tensile law with limit 5 % / 8 %, a linear one. Values that no result reads are zero."""
    zero = {name: np.zeros((2, 2)) for name in MaterialTable._fields}
    given = {
        "tension_strain": floats([[0.04, 0.06], [0.1, 0.1]]),
        "tension_force": floats([[490.33, 490.33], [490.33, 490.33]]),
        "tension_exponent": floats([[2.0, 1.0], [0.0, 0.0]]),
        "strain_limit": floats([[0.05, 0.08], [0.15, 0.15]]),
    }
    return MaterialTable(**(zero | given))


def rectangles(columns: int, rows: int, spacing_m: float, panels: int, sewn: bool, border: bool = False) -> Cloth:
    """`panels` equal rectangles of columns x rows cells, side by side; `sewn` welds each panel's right side to the next one's left, all around.

    border=True gives the cloth border triangles in place of links and cells.
    Vertex (panel, row, column) has the index ((panel * (rows+1)) + row) * (columns+1) + column.
    """
    column, row = np.meshgrid(np.arange(columns + 1), np.arange(rows + 1))
    one = np.stack([column.ravel(), row.ravel()], axis=1) * spacing_m * 1000.0
    per_panel = len(one)
    vertex = np.arange(panels * per_panel).reshape(panels, rows + 1, columns + 1)
    particle = np.empty_like(vertex)
    if sewn:
        ring = np.arange((rows + 1) * panels * columns).reshape(rows + 1, panels * columns)
        for panel in range(panels):
            particle[panel] = np.take(ring, np.arange(panel * columns, (panel + 1) * columns + 1) % (panels * columns), axis=1)
    else:
        particle[:] = vertex
    quads = np.stack([vertex[:, :-1, :-1], vertex[:, :-1, 1:], vertex[:, 1:, 1:], vertex[:, 1:, :-1]], axis=-1).reshape(-1, 4)
    triangles = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
    to_particle = particle.ravel()
    count = int(to_particle.max()) + 1
    area = spacing_m**2
    links: dict[str, list] = {"ends": [], "width": [], "direction": []}
    for panel in range(panels):
        for a, b, direction in ((vertex[panel, :, :-1], vertex[panel, :, 1:], WEFT), (vertex[panel, :-1, :], vertex[panel, 1:, :], WARP)):
            links["ends"].append(to_particle[np.stack([a.ravel(), b.ravel()], axis=1)])
            outer = np.zeros(a.shape, dtype=bool)
            if direction == WEFT:
                outer[[0, -1], :] = True
            else:
                outer[:, [0, -1]] = True
            links["width"].append(np.where(outer.ravel(), 0.5 * spacing_m, spacing_m))
            links["direction"].append(np.full(a.size, direction))
    ends = np.concatenate(links["ends"])
    cells = to_particle[quads]
    strip = to_particle[triangles]
    if border:
        ends, cells = ends[:0], cells[:0]
    else:
        strip = strip[:0]
    uv = np.tile(one, (panels, 1))
    u, w = (uv[triangles[: len(strip)]][..., axis] / 1000.0 for axis in (0, 1))
    double = 2.0 * 0.5 * area
    weft_gradient = np.stack([w[:, 1] - w[:, 2], w[:, 2] - w[:, 0], w[:, 0] - w[:, 1]], axis=1) / double
    warp_gradient = np.stack([u[:, 2] - u[:, 1], u[:, 0] - u[:, 2], u[:, 1] - u[:, 0]], axis=1) / double
    patch = triangles[: len(strip)]
    patch_start, patch_items = rows_by_key(patch.ravel(), len(uv))
    masses = 0.12 * np.bincount(to_particle[triangles].ravel(), minlength=count) * area / 6.0
    names = ("front", "back", "left", "right")[:panels] if panels <= 4 else tuple(f"panel {index}" for index in range(panels))
    edges = {}
    for panel, name in enumerate(names):
        edges[f"{name}.hem"] = indices(vertex[panel, 0, :])
        edges[f"{name}.waist"] = indices(vertex[panel, -1, ::-1])
    on_contour = np.zeros_like(vertex, dtype=bool)
    on_contour[:, [0, -1], :] = True
    on_contour[:, :, [0, -1]] = True
    empty = np.zeros(0)
    none = np.zeros(0, dtype=np.int32)
    return Cloth(
        spacing=spacing_m,
        panel_names=names,
        vertex_uv_mm=frozen(floats(uv)),
        vertex_panel=frozen(indices(np.repeat(np.arange(panels), per_panel))),
        vertex_particle=frozen(indices(to_particle)),
        vertex_on_contour=on_contour.ravel(),
        vertex_place=np.full((len(uv), 2), -1, dtype=np.int32),
        masses=frozen(floats(masses)),
        links=Links(
            indices(ends),
            np.full(len(ends), spacing_m),
            floats(np.concatenate(links["width"])[: len(ends)]),
            indices(np.concatenate(links["direction"])[: len(ends)]),
            np.zeros(len(ends), dtype=np.int32),
        ),
        cells=Cells(indices(cells), np.full(len(cells), spacing_m), np.full(len(cells), area), np.full(len(cells), area), np.zeros(len(cells), dtype=np.int32)),
        border=BorderTriangles(
            indices(strip),
            np.full(len(strip), 0.5 * area),
            floats(warp_gradient),
            floats(weft_gradient),
            indices(patch),
            patch_start,
            indices(patch_items // 3),
            np.zeros(len(strip), dtype=np.int32),
            np.zeros(len(uv), dtype=np.int32),
        ),
        bends=BendLines(none, none.reshape(0, 2), empty, none.reshape(0, 2), empty, empty, empty, empty, none, none),
        spans=ContourSpans(none.reshape(0, 4), empty.reshape(0, 4), empty, empty, none),
        hinges=Hinges(none.reshape(0, 4), empty, empty, empty, empty, none.reshape(0, 2), empty.reshape(0, 2), none),
        triangles=frozen(indices(triangles)),
        triangle_material=np.zeros(len(triangles), dtype=np.int32),
        stitches=none.reshape(0, 2),
        stitch_seam=none,
        seam_names=tuple(f"side {index}" for index in range(panels)) if sewn else (),
        edge_vertices=edges,
    )


def flat(cloth: Cloth) -> np.ndarray:
    """Positions of an unsewn cloth as drawn: panel x, y to world x, y."""
    return np.column_stack([cloth.vertex_uv_mm / 1000.0, np.zeros(len(cloth.vertex_uv_mm))])


def tube(cloth: Cloth, columns: int, panels: int, radius_of_row, height_of_row) -> np.ndarray:
    """Positions of a sewn cloth around the y axis; row 0 is the first row of the panels. Angle 0 (+z) at the left side of the first panel, right side out."""
    around = columns * panels
    rows = cloth.particle_count // around
    positions = np.empty((rows, around, 3))
    for row in range(rows):
        angle = 2.0 * math.pi * np.arange(around) / around
        radius = np.asarray(radius_of_row(row, angle))
        positions[row] = np.stack([radius * np.sin(angle), np.full(around, height_of_row(row)), radius * np.cos(angle)], axis=1)
    return positions.reshape(-1, 3)


def cylinder_body(radius_m: float = 0.12, height_m: float = 1.6) -> Mannequin:
    """A closed round cylinder on the floor as a body, its girths taped as 2 pi r."""
    mesh = trimesh.creation.cylinder(radius=radius_m, height=height_m, sections=96)
    vertices = np.asarray(mesh.vertices)[:, [1, 2, 0]] + [0.0, 0.5 * height_m, 0.0]
    girth = 2000.0 * math.pi * radius_m
    measurements = {"bust": girth, "waist": girth, "hip": girth, "bust_height": 1300.0, "waist_height": 1100.0, "hip_height": 900.0}
    up, ref = np.array([0.0, 1.0, 0.0]), np.array([0.0, 0.0, 1.0])
    torso = ArrangementCylinder(np.zeros(3), up, ref, radius_m, radius_m)
    faces = indices(mesh.faces)
    return Mannequin("cylinder", floats(vertices), faces, measurements, {}, {"torso": torso}, ("torso",), np.zeros(len(faces), dtype=np.int32))
