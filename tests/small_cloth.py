"""A small cloth with every kind of element, made by hand, for the tests of forces: 5 x 6 lattice particles, a border strip on the right side, two materials."""

from __future__ import annotations

import numpy as np

from garmentcad.arrays import floats, frozen, indices, rows_by_key
from garmentcad.cloth.cloth import WARP, WEFT, BendLines, BorderTriangles, Cells, Cloth, ContourSpans, Hinges, Links
from garmentcad.fabric.law_shear import stick_way
from garmentcad.fabric.law_tension import initial_slope
from garmentcad.fabric.material import MaterialTable

H = 0.01
COLUMNS, ROWS = 5, 6


def materials(friction: float = 0.0) -> MaterialTable:
    """A curved tensile law in two directions, and one that is linear in the warp and softens in the weft. friction: share of usual internal friction."""
    strain = floats([[0.04, 0.09], [0.10, 0.06]])
    force = floats([[490.33, 490.33], [200.0, 49.033]])
    exponent = floats([[2.5, 1.2], [0.0, -1.5]])
    slope = floats(initial_slope(strain, force, exponent))
    two = floats([0.5, 0.5])
    shear, bending = floats([45.0, 80.0]), floats([[1.2e-5, 0.7e-5], [3e-5, 2e-5]])
    hold = friction * floats([[0.4, 0.9], [0.8, 1.4]])
    return MaterialTable(
        areal_mass=floats([0.15, 0.20]),
        tension_strain=strain,
        tension_force=force,
        tension_exponent=exponent,
        tension_slope=slope,
        tension_friction=friction * floats([[0.2, 0.25], [0.15, 0.3]]),
        strain_limit=1.2 * strain,
        shear=shear,
        shear_friction=hold,
        shear_way=floats([stick_way(*row, stiffness) for row, stiffness in zip(hold, shear)]),
        bending=bending,
        bending_friction=friction * 25.0 * bending,
        twist=floats([0.6e-5, 1e-5]),
        twist_friction=friction * floats([2e-4, 1e-4]),
        thickness=1e-3 * two,
        friction_body=two,
        friction_cloth=two,
    )


def small_cloth() -> Cloth:
    lattice = np.arange(COLUMNS * ROWS).reshape(ROWS, COLUMNS)
    contour = COLUMNS * ROWS + np.arange(ROWS + 1)
    u, w = np.meshgrid(np.arange(COLUMNS) * H, np.arange(ROWS) * H)
    contour_w = (np.arange(ROWS + 1) - 0.3) * H
    uv = np.vstack([np.column_stack([u.ravel(), w.ravel()]), np.column_stack([np.full(ROWS + 1, (COLUMNS - 0.3) * H), contour_w])])
    rng = np.random.default_rng(3)

    def material(count: int) -> np.ndarray:
        return indices(rng.integers(0, 2, count))

    ends = np.vstack([np.column_stack([lattice[:, :-1].ravel(), lattice[:, 1:].ravel()]), np.column_stack([lattice[:-1].ravel(), lattice[1:].ravel()])])
    direction = np.repeat([WEFT, WARP], [ROWS * (COLUMNS - 1), (ROWS - 1) * COLUMNS])
    links = Links(indices(ends), np.full(len(ends), H), rng.uniform(0.5, 1.0, len(ends)) * H, indices(direction), material(len(ends)))

    corners = np.stack([lattice[:-1, :-1], lattice[:-1, 1:], lattice[1:, 1:], lattice[1:, :-1]], axis=-1).reshape(-1, 4)
    area = np.full(len(corners), H * H)
    cells = Cells(indices(corners), np.full(len(corners), H), area, 1.2 * area, material(len(corners)))

    side = lattice[:, -1]
    strip = np.vstack([np.column_stack([side, contour[:-1], contour[1:]]), np.column_stack([side[:-1], contour[1:-1], side[1:]])])
    a, b, c = (uv[strip[:, k]] for k in range(3))
    double = (b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]
    weft_gradient = np.stack([b - c, c - a, a - b], axis=1)[:, :, 1] / double[:, None]
    warp_gradient = np.stack([c - b, a - c, b - a], axis=1)[:, :, 0] / double[:, None]
    vertices, patch = np.unique(strip, return_inverse=True)
    patch = patch.reshape(strip.shape)
    patch_start, entries = rows_by_key(patch.ravel(), len(vertices))
    border = BorderTriangles(
        indices(strip), floats(0.5 * double), floats(warp_gradient), floats(weft_gradient), indices(patch),
        patch_start, indices(entries // 3), material(len(strip)), material(len(vertices)),
    )  # fmt: skip

    # (centre, arm a, arm b, weight a, weight b, length a, length b, width, direction)
    lines: list[tuple] = []
    for row in range(ROWS):
        for column in range(COLUMNS):
            center = lattice[row, column]
            if 0 < row < ROWS - 1:
                below, above = lattice[row - 1, column], lattice[row + 1, column]
                lines.append((center, (below, below), (above, above), 0.0, 0.0, H, H, H, WARP))
            if 0 < column < COLUMNS - 1:
                left, right = lattice[row, column - 1], lattice[row, column + 1]
                lines.append((center, (left, left), (right, right), 0.0, 0.0, H, H, H, WEFT))
        left, chord = (lattice[row, -2],) * 2, (contour[row], contour[row + 1])
        arms = (left, chord, 0.0, 0.3, H, 0.7 * H) if row % 2 else (chord, left, 0.3, 0.0, 0.7 * H, H)
        lines.append((side[row], *arms, 1.2 * H, WEFT))
    center_, arm_a, arm_b, weight_a, weight_b, length_a, length_b, width, line_direction = zip(*lines)
    bends = BendLines(
        indices(center_), indices(arm_a), floats(weight_a), indices(arm_b), floats(weight_b),
        floats(length_a), floats(length_b), floats(width), indices(line_direction), material(len(lines)),
    )  # fmt: skip

    # hinges over the warp links between two rows of cells: wing a on the left, wing b on the right of an edge that runs up
    edges = [(lattice[r, c], lattice[r + 1, c], lattice[r, c - 1], lattice[r + 1, c + 1]) for r in range(ROWS - 1) for c in range(1, COLUMNS - 1)]
    count = len(edges)
    hinges = Hinges(
        indices(edges), np.full(count, H), np.ones(count), rng.uniform(-0.5, 0.5, count), np.full(count, 2.0),
        indices(np.column_stack([material(count), material(count)])), rng.uniform(0.0, 1.0, (count, 2)), np.full(count, -1, dtype=np.int32),
    )  # fmt: skip

    rows = np.column_stack([contour[k : len(contour) - 3 + k] for k in range(4)])
    count = len(rows)
    spans = ContourSpans(indices(rows), np.tile([-1.0, 3.0, -3.0, 1.0], (count, 1)), np.full(count, H), rng.uniform(0.0, 1.0, count), material(count))

    masses = np.zeros(len(uv))
    np.add.at(masses, corners, 0.15 * H * H / 4)
    np.add.at(masses, strip, 0.15 * (0.5 * double / 3)[:, None])
    quads = np.vstack([corners[:, [0, 1, 2]], corners[:, [0, 2, 3]]])
    everyone = indices(np.arange(len(uv)))
    return Cloth(
        spacing=H,
        panel_names=("swatch",),
        vertex_uv_mm=frozen(floats(1000.0 * uv)),
        vertex_panel=frozen(np.zeros(len(uv), dtype=np.int32)),
        vertex_particle=frozen(everyone),
        vertex_on_contour=everyone >= COLUMNS * ROWS,
        vertex_place=indices(np.vstack([np.stack(np.meshgrid(np.arange(COLUMNS), np.arange(ROWS)), axis=-1).reshape(-1, 2), np.full((ROWS + 1, 2), -1)])),
        masses=frozen(floats(masses)),
        links=links,
        cells=cells,
        border=border,
        bends=bends,
        spans=spans,
        hinges=hinges,
        triangles=frozen(indices(np.vstack([quads, strip]))),
        triangle_material=np.zeros(2 * len(corners) + len(strip), dtype=np.int32),
        stitches=np.zeros((0, 2), dtype=np.int32),
        stitch_seam=np.zeros(0, dtype=np.int32),
        seam_names=(),
        edge_vertices={},
    )


def flat(cloth: Cloth) -> np.ndarray:
    """Rest positions: weft to x, warp to y, right side to +z."""
    return np.column_stack([cloth.vertex_uv_mm / 1000.0, np.zeros(len(cloth.vertex_uv_mm))])


def rotation(seed: int) -> np.ndarray:
    """A random rotation matrix."""
    q, _ = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))
    return q * np.linalg.det(q)


def deformed(cloth: Cloth, kind: str, seed: int = 0) -> np.ndarray:
    """Randomly rotated positions: "wavy" (small strain), "stretched" (beyond em), "squeezed" (repel), "sheared", "folded" (sharp folds),
    "crumpled" (turning angles of about a radian from cell to cell, every way)."""
    rng = np.random.default_rng(seed)
    x = flat(cloth)
    if kind == "stretched":
        x = x * [1.15, 1.12, 1.0]
    elif kind == "squeezed":
        x = x * [0.85, 0.9, 1.0]
    elif kind == "sheared":
        x[:, 0] += 0.6 * x[:, 1]
    elif kind == "folded":
        # a ridge across the cloth whose flanks nearly meet: turning angles of about 160 degrees
        away = x[:, 0] - 0.02
        x[:, 0], x[:, 2] = 0.02 + 0.17 * np.abs(away), 0.98 * away
    elif kind == "crumpled":
        x[:, 2] += rng.normal(scale=0.3 * H, size=len(x))
    x[:, 2] += 0.002 * np.sin(300.0 * x[:, 0] + 200.0 * x[:, 1])
    return floats((x + rng.normal(scale=0.02 * H, size=x.shape)) @ rotation(seed).T + rng.normal(size=3))


KINDS = ("wavy", "stretched", "squeezed", "sheared", "folded", "crumpled")
