"""From a coarse lattice to a finer one: affine shapes are kept exactly, seams stay closed, links keep their lengths on a cylinder."""

from __future__ import annotations

import numpy as np
import pytest

from garmentcad.cloth.cloth import Cloth
from garmentcad.cloth.lattice import build_cloth
from garmentcad.cloth.state import State
from garmentcad.cloth.weld import weld
from garmentcad.forces.assembly import ForceAssembly
from garmentcad.forces.force import CURVES, NO_PARTICLE
from garmentcad.forces.internal import internal_forces
from garmentcad.simulation.job import make_job
from garmentcad.simulation.materials import lay_out
from garmentcad.simulation.refine import refined, refined_sliders
from garmentcad.units import MM_TO_M

JOB = make_job("flared-skirt", grid_mm=20.0)
MATERIALS, OF = lay_out(JOB)
COARSE, FINE = (build_cloth(JOB.pattern, OF, MATERIALS, grid) for grid in (20.0, 10.0))  # vertices are particles


def waves(cloth: Cloth) -> np.ndarray:
    """A particle for each vertex, on a wavy sheet."""
    return np.column_stack([cloth.vertex_uv_mm * MM_TO_M, np.sin(cloth.vertex_uv_mm[:, 0] / 40.0) / 50.0])


def test_an_affine_shape_is_kept() -> None:
    """Also outside the coarse chords, and whatever map each panel has."""
    rng = np.random.default_rng(0)
    maps, shifts = rng.normal(size=(len(COARSE.panel_names), 2, 3)), rng.normal(size=(len(COARSE.panel_names), 3))

    def mapped(cloth: Cloth) -> np.ndarray:
        return np.einsum("nk,nkx->nx", cloth.vertex_uv_mm * MM_TO_M, maps[cloth.vertex_panel]) + shifts[cloth.vertex_panel]

    np.testing.assert_allclose(refined(COARSE, mapped(COARSE), FINE), mapped(FINE), atol=1e-12)


def test_internal_friction_is_carried_as_moment_and_stress() -> None:
    """Stick springs drawn alike in every element of a curve are drawn as far on the fine lattice, whatever its strains are; and where they differ from panel to
    panel, panel by panel."""
    coarse, fine = (ForceAssembly(internal_forces(cloth, MATERIALS), cloth.particle_count) for cloth in (COARSE, FINE))
    panels = len(COARSE.panel_names)
    share = np.random.default_rng(4).uniform(-0.9, 0.9, (panels, len(CURVES)))
    here, there = waves(COARSE), waves(FINE)
    state = State(here, np.zeros_like(here), friction=coarse.slack())
    for force in coarse.forces:
        gauge = force.gauge(here)
        drawn = share[COARSE.vertex_panel[gauge.particle.astype(np.int64)], gauge.curve.astype(np.int64)]
        state.friction[force.name][:] = np.where(gauge.particle != NO_PARTICLE, gauge.strain - drawn * gauge.way, state.friction[force.name])
    found = refined_sliders(COARSE, coarse, state, FINE, fine, there)
    for force in fine.forces:
        gauge = force.gauge(there)
        used = (gauge.particle != NO_PARTICLE) & (gauge.way > 0.0)
        drawn = (gauge.strain - found[force.name])[used] / gauge.way[used]
        expected = share[FINE.vertex_panel[gauge.particle[used].astype(np.int64)], gauge.curve[used].astype(np.int64)]
        np.testing.assert_allclose(drawn, expected, atol=1e-9)


def test_on_the_same_lattice_every_element_finds_itself() -> None:
    """Each stick spring drawn otherwise: found by corners instead of middles, a cell took its friction from a triangle at its corner."""
    forces = ForceAssembly(internal_forces(COARSE, MATERIALS), COARSE.particle_count)
    here = waves(COARSE)
    rng, state = np.random.default_rng(5), State(here, np.zeros_like(here), friction=forces.slack())
    for force in forces.forces:
        gauge = force.gauge(here)
        drawn = gauge.strain - rng.uniform(-0.9, 0.9, gauge.way.shape) * gauge.way
        state.friction[force.name][:] = np.where(gauge.particle != NO_PARTICLE, drawn, state.friction[force.name])
    found = refined_sliders(COARSE, forces, state, COARSE, forces, here)
    for force in forces.forces:
        np.testing.assert_allclose(found[force.name], state.friction[force.name], atol=1e-12)


@pytest.mark.parametrize("garment", ["t-shirt", "trousers"])
def test_friction_of_a_sewn_garment_goes_over(garment: str) -> None:
    """Also of triangles all of whose corners are sewn (their places were no numbers); on the same lattice nearly every element finds itself."""
    materials, of = lay_out(job := make_job(garment, grid_mm=20.0))
    coarse, fine = (weld(build_cloth(job.pattern, of, materials, grid))[0] for grid in (20.0, 10.0))
    before, after = (ForceAssembly(internal_forces(cloth, materials), cloth.particle_count) for cloth in (coarse, fine))
    here, there = (np.random.default_rng(6).normal(size=(cloth.particle_count, 3)) for cloth in (coarse, fine))
    rng, state = np.random.default_rng(5), State(here, np.zeros_like(here), friction=before.slack())
    for force in before.forces:
        gauge = force.gauge(here)
        drawn = gauge.strain - rng.uniform(-0.9, 0.9, gauge.way.shape) * gauge.way
        state.friction[force.name][:] = np.where(gauge.particle != NO_PARTICLE, drawn, state.friction[force.name])
    for force in after.forces:
        assert np.isfinite(refined_sliders(coarse, before, state, fine, after, there)[force.name]).all()
    found = refined_sliders(coarse, before, state, coarse, before, here)
    elsewhere = count = 0
    for force in before.forces:
        used = force.gauge(here).way > 0.0
        elsewhere += int((np.abs(found[force.name] - state.friction[force.name])[used] > 1e-9).sum())
        count += int(used.sum())
    assert elsewhere < 1e-3 * count


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
