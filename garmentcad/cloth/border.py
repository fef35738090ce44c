"""Border triangles: the strip between full cells and contour as elements, with the patches that average their warp and weft strain."""

from __future__ import annotations

import itertools

import numpy as np

from garmentcad.arrays import floats, indices, rows_by_key
from garmentcad.cloth.cloth import BorderTriangles
from garmentcad.cloth.panel_mesh import PanelMesh
from garmentcad.geometry.triangle import shape_gradients, signed_areas
from garmentcad.units import MM_TO_M

_WEFT_AXIS, _WARP_AXIS = 0, 1  # columns of (weft, warp) coordinates


def border_triangles(mesh: PanelMesh, material: np.ndarray) -> BorderTriangles:
    """Border triangles of one panel, corners and patches in the panel's own numbering.

    material (T,) int32: row of each triangle. A patch is made for every lattice point that is a corner and for every two neighbours on
    the contour; its material is the one with the largest area in it.
    """
    area = signed_areas(mesh.points, mesh.triangles) * MM_TO_M**2
    gradients = shape_gradients(mesh.points, mesh.triangles) / MM_TO_M
    owners, patch = np.unique(_patch_owner(mesh)[mesh.triangles], return_inverse=True)
    patch = patch.reshape(-1, 3)
    start, item = rows_by_key(patch.ravel(), len(owners))
    rows = int(material.max(initial=0)) + 1
    share = np.bincount((patch * rows + material[:, None]).ravel(), weights=np.repeat(area, 3), minlength=len(owners) * rows)
    return BorderTriangles(
        corners=indices(mesh.triangles),
        area=floats(area),
        warp_gradient=floats(gradients[..., _WARP_AXIS]),
        weft_gradient=floats(gradients[..., _WEFT_AXIS]),
        patch=indices(patch),
        patch_start=start,
        patch_triangle=indices(item // 3),
        material=indices(material),
        patch_material=indices(share.reshape(-1, rows).argmax(axis=1)),
    )


def _patch_owner(mesh: PanelMesh) -> np.ndarray:
    """(N,) point whose patch each point uses: its own on the lattice; on the contour two neighbours of a loop, or of a fold, share one.

    A patch takes two freedoms (warp and weft strain) and a point brings two: a patch for each point leaves a strip of stiff yarns none to shear with.
    """
    owner = np.arange(len(mesh.points))
    starts = mesh.contour.loop_start
    for start, stop in itertools.pairwise(starts):
        place = np.arange(stop - start)
        owner[mesh.lattice_count + start : mesh.lattice_count + stop] = mesh.lattice_count + start + place - place % 2
    for _, chain in mesh.contour.chains:
        inner = chain[chain >= starts[-1]] + mesh.lattice_count
        owner[inner] = np.repeat(inner[::2], 2)[: len(inner)]
    return owner
