"""Cloth: everything about a garment that does not change while it moves, in SI units, as arrays.

A *vertex* is a point of one panel (it has a place on the pattern); a *particle* moves. Before welding they are the same; welding maps several
vertices to one particle. Elements name particles; what they need of the pattern (rest lengths, widths, gradients) they carry themselves, so that
a particle shared by two panels is no special case.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

WARP, WEFT = 0, 1


class Links(NamedTuple):
    """Pairs of lattice neighbours along warp or weft; they carry tension and repel."""

    ends: np.ndarray  # (L,2) int32 particles
    rest_length: np.ndarray  # (L,) m
    width: np.ndarray  # (L,) m, h/2 for each full cell beside the link
    direction: np.ndarray  # (L,) int32 WARP or WEFT
    material: np.ndarray  # (L,) int32 row of the material table


class Cells(NamedTuple):
    """Full lattice cells; corners 00, 10, 11, 01 (first digit steps along weft, second along warp). They carry shear and twist."""

    corners: np.ndarray  # (C,4) int32
    spacing: np.ndarray  # (C,) m, lattice spacing h
    shear_area: np.ndarray  # (C,) m2, the cell itself
    twist_area: np.ndarray  # (C,) m2, the cell and the strip area nearest to it
    material: np.ndarray  # (C,) int32


class BorderTriangles(NamedTuple):
    """Triangles of the strip between full cells and contour. Warp vector = sum_k warp_gradient[k] x[k] (unit length at rest), weft vector alike.

    Warp and weft strain are averaged over a patch, the triangles around a lattice vertex or two neighbouring contour vertices:
    e_p = sum(A e)/sum(A), energy sum_p A_p f(e_p), A_p = sum(A)/3.
    A patch belongs to one panel and is not merged by welding.
    """

    corners: np.ndarray  # (T,3) int32 particles
    area: np.ndarray  # (T,) m2
    warp_gradient: np.ndarray  # (T,3) 1/m
    weft_gradient: np.ndarray  # (T,3) 1/m
    patch: np.ndarray  # (T,3) int32, the patch of each corner
    patch_start: np.ndarray  # (K+1,) int32, compressed rows: triangles of each patch
    patch_triangle: np.ndarray  # (3T,) int32
    material: np.ndarray  # (T,) int32 of the triangle (shear)
    patch_material: np.ndarray  # (K,) int32 (tension)


class BendLines(NamedTuple):
    """Lines of three points along warp or weft: arm a, centre, arm b. An arm ends at a particle or at a point on a contour chord:
    x_a = (1 - weight) x[arm[0]] + weight x[arm[1]] (arm[0] == arm[1] and weight 0 for a particle)."""

    center: np.ndarray  # (B,) int32
    arm_a: np.ndarray  # (B,2) int32
    weight_a: np.ndarray  # (B,)
    arm_b: np.ndarray  # (B,2) int32
    weight_b: np.ndarray  # (B,)
    length_a: np.ndarray  # (B,) m at rest
    length_b: np.ndarray  # (B,) m at rest
    width: np.ndarray  # (B,) m
    direction: np.ndarray  # (B,) int32 direction of the line
    material: np.ndarray  # (B,) int32


class ContourSpans(NamedTuple):
    """Four points that follow one another along a contour, with the coefficients of their third difference (see cloth/contour_spans.py)."""

    corners: np.ndarray  # (N,4) int32
    coefficients: np.ndarray  # (N,4)
    length: np.ndarray  # (N,) m, mean distance of the points
    along_warp: np.ndarray  # (N,) cosine between the contour and warp
    material: np.ndarray  # (N,) int32


class Hinges(NamedTuple):
    """Hinges over fold lines and welded sew lines. Corners: the two ends of the edge, then the wing of side a, the wing of side b.

    E = factor * B_n * (angle - rest_angle)^2 * length^2 / (2 (A_a + A_b)), B_n the mean over both sides of the bending stiffness across the edge,
    from material and `across_warp` (cosine between the edge's normal in the panel and the warp of that side).
    """

    corners: np.ndarray  # (H,4) int32
    length: np.ndarray  # (H,) m
    length2_over_area: np.ndarray  # (H,) length^2 / (A_a + A_b), no unit
    rest_angle: np.ndarray  # (H,) rad, 0 is flat, positive folds toward the right side of the fabric; of a fold what `State` says counts
    factor: np.ndarray  # (H,) bend factor of the seam (layers of allowance), strength of the fold
    material: np.ndarray  # (H,2) int32
    across_warp: np.ndarray  # (H,2)
    fold: np.ndarray  # (H,) int32 number of the fold, -1 over a seam


@dataclass(frozen=True)
class Cloth:
    """Rest state of a garment, or of any cloth. All arrays are read-only.

    Directions: rest coordinates are (weft, warp) in the panel's grain frame for elements, panel millimetres for `vertex_uv_mm`.
    Triangles are counter-clockwise on the pattern, so that normals point to the right side (outside) of the fabric.
    """

    spacing: float  # m, lattice spacing asked for
    panel_names: tuple[str, ...]
    vertex_uv_mm: np.ndarray  # (V,2) on the panel as drawn
    vertex_panel: np.ndarray  # (V,) int32
    vertex_particle: np.ndarray  # (V,) int32
    vertex_on_contour: np.ndarray  # (V,) bool
    vertex_place: np.ndarray  # (V,2) int32 lattice column (along weft) and row (along warp) on the panel, from 0; -1 for contour vertices
    masses: np.ndarray  # (P,) kg
    links: Links
    cells: Cells
    border: BorderTriangles
    bends: BendLines
    spans: ContourSpans
    hinges: Hinges
    triangles: np.ndarray  # (F,3) int32 VERTICES (not particles): what contact, judge and exporters use
    triangle_material: np.ndarray  # (F,) int32
    stitches: np.ndarray  # (S,2) int32 particles still to be welded (empty after welding)
    stitch_seam: np.ndarray  # (S,) int32
    seam_names: tuple[str, ...]
    edge_vertices: dict[str, np.ndarray]  # "panel.edge" -> vertices along the edge in outline order, both ends included
    seam_fold: np.ndarray = field(default_factory=lambda: np.zeros(0))  # (seams,) rad, rest angle of the hinges that welding makes
    seam_bend_factor: np.ndarray = field(default_factory=lambda: np.zeros(0))  # (seams,)
    seam_order: np.ndarray = field(default_factory=lambda: np.zeros(0, dtype=np.int32))  # (seams,) int32, the lowest is sewn first
    seam_layered: np.ndarray = field(default_factory=lambda: np.zeros(0, dtype=bool))  # (seams,) bool, whether more than two layers meet in it
    fold_names: tuple[str, ...] = ()  # "panel.fold"
    panel_layer: np.ndarray = field(default_factory=lambda: np.zeros(0, dtype=np.int32))  # (panels,) int32 from the body outward; none: all 0

    @property
    def particle_triangles(self) -> np.ndarray:
        """(F,3) int32 triangles in particle indices."""
        return self.vertex_particle[self.triangles]

    @property
    def triangle_layer(self) -> np.ndarray:
        """(F,) int32 the layer of the panel of each triangle."""
        return self.panel_layer[self.vertex_panel[self.triangles[:, 0]]] if len(self.panel_layer) else np.zeros(len(self.triangles), dtype=np.int32)

    @property
    def particle_count(self) -> int:
        return len(self.masses)
