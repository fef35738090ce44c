"""From a coarse lattice to a finer one: affine shapes are kept exactly, seams stay closed, links keep their lengths on a cylinder."""

from __future__ import annotations

import numpy as np
import pytest

from garmentcad.cloth.cloth import Cloth
from garmentcad.cloth.lattice import build_cloth
from garmentcad.cloth.weld import weld
from garmentcad.simulation.job import make_job
from garmentcad.simulation.materials import lay_out
from garmentcad.simulation.refine import refined
from garmentcad.units import MM_TO_M

JOB = make_job("flared-skirt", grid_mm=20.0)
MATERIALS, OF = lay_out(JOB)
COARSE, FINE = (build_cloth(JOB.pattern, OF, MATERIALS, grid) for grid in (20.0, 10.0))  # vertices are particles


def test_an_affine_shape_is_kept() -> None:
    """Also outside the coarse chords, and whatever map each panel has."""
    rng = np.random.default_rng(0)
    maps, shifts = rng.normal(size=(len(COARSE.panel_names), 2, 3)), rng.normal(size=(len(COARSE.panel_names), 3))

    def mapped(cloth: Cloth) -> np.ndarray:
        return np.einsum("nk,nkx->nx", cloth.vertex_uv_mm * MM_TO_M, maps[cloth.vertex_panel]) + shifts[cloth.vertex_panel]

    np.testing.assert_allclose(refined(COARSE, mapped(COARSE), FINE), mapped(FINE), atol=1e-12)


def test_welded_vertices_share_one_place() -> None:
    welded, particle_map = weld(FINE)
    rng = np.random.default_rng(1)
    positions = rng.normal(size=(COARSE.particle_count, 3))
    apart = refined(COARSE, positions, FINE)
    together = refined(COARSE, positions, welded)
    seam = np.bincount(particle_map) > 1
    assert seam.sum() > 50
    for particle in np.flatnonzero(seam):
        np.testing.assert_allclose(together[particle], apart[particle_map == particle].mean(axis=0), atol=1e-12)


def test_links_keep_their_lengths_on_a_cylinder() -> None:
    """A coarse lattice that is isometric on chords gives a fine one whose links lie on these chords: nothing is stretched."""
    radius = 0.05
    uv = COARSE.vertex_uv_mm * MM_TO_M
    angle = uv[:, 0] / radius
    turn = COARSE.spacing / radius
    stretch = 0.5 * turn / np.sin(0.5 * turn)  # a chord of this cylinder is as long as the spacing
    places = np.column_stack([stretch * radius * np.sin(angle), uv[:, 1], stretch * radius * np.cos(angle)])
    found = refined(COARSE, places, FINE)
    ends = FINE.links.ends
    strain = np.linalg.norm(found[ends[:, 1]] - found[ends[:, 0]], axis=1) / FINE.links.rest_length - 1.0
    assert np.median(np.abs(strain)) < 1e-6
    assert np.percentile(strain, 99) == pytest.approx(0.0, abs=2e-3)
