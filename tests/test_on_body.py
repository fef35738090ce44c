"""What is read off a cloth at rest against closed forms: the hanging strip, the stretched band, the loose tube, the hanging skirt, sewn strips and gathers.

The stepper of every run brings them to rest; what is asserted comes from analysis and statics alone.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
import trimesh
from drawn import panel, pattern, rectangle
from elastic import linear
from hand_made import cylinder_body

from garmentcad.analysis.ease import garment_ease
from garmentcad.analysis.on_body import on_body
from garmentcad.analysis.plane_fit import loops_in_plane
from garmentcad.analysis.seam_tension import seam_lengths, seam_tension
from garmentcad.analysis.section import horizontal
from garmentcad.analysis.strain import strain_percentiles, yarn_strain
from garmentcad.analysis.tension import tension_summary
from garmentcad.arrays import floats, indices
from garmentcad.cloth.cloth import WARP, WEFT, Cloth
from garmentcad.cloth.lattice import build_cloth, rectangle_cloth
from garmentcad.cloth.state import State
from garmentcad.cloth.weld import weld
from garmentcad.contact.contact import Contact
from garmentcad.fabric.material import MaterialTable
from garmentcad.forces.assembly import ForceAssembly
from garmentcad.forces.gravity import ForceGravity
from garmentcad.forces.internal import internal_forces
from garmentcad.mannequin.mannequin import Mannequin
from garmentcad.pattern.pattern import EdgeUse, Seam
from garmentcad.solve.dynamics import Dynamics
from garmentcad.solve.strain_limit import strain_limit
from garmentcad.units import GRAVITY_M_S2

W = 0.2  # kg/m2
MU = 0.3


def fabric(stiffness_n_m: float, shear_n_m: float = 40.0) -> MaterialTable:
    """A linear law of Y = stiffness in both directions."""
    return linear(W, stiffness_n_m, limit=0.4, shear=shear_n_m, thickness=5e-4, friction=MU, bending=1e-6)


class Rest:
    """A cloth brought to rest; `loads` (P,) kg hang on it beside its own mass."""

    def __init__(
        self,
        cloth: Cloth,
        materials: MaterialTable,
        start: np.ndarray,
        seconds: float,
        drag: float,
        fixed: np.ndarray | None = None,
        body: Mannequin | None = None,
        loads: np.ndarray | None = None,
    ) -> None:
        self.cloth, self.materials = cloth, materials
        weights = cloth.masses if loads is None else cloth.masses + loads
        forces = ForceAssembly(internal_forces(cloth, materials), cloth.particle_count, [ForceGravity(weights)])
        contact = Contact(cloth, materials, None if body is None else (body.vertices, body.faces), itself=False)
        dynamics = Dynamics(cloth, forces, strain_limit(cloth, materials), contact, fixed)
        dynamics.drag, dynamics.equalise = drag, True
        state = State(start.copy(), np.zeros_like(start))
        dynamics.start(state)
        while state.time_s < seconds:
            dynamics.advance(state, 96)
        self.positions, self.forces = state.positions, dynamics.net_forces(state)


def sewn(drawn: list, seams: tuple[Seam, ...], grid_mm: float, materials: MaterialTable) -> tuple[Cloth, Cloth]:
    """The cloth before and after welding."""
    flat = build_cloth(pattern(*drawn, seams=seams), lambda _, at: np.zeros(len(at), int), materials, grid_mm)
    return flat, weld(flat)[0]


def by_particle(cloth: Cloth, of_vertex: np.ndarray) -> np.ndarray:
    """(P,...) from (V,...): sewn vertices have the same."""
    out = np.empty((cloth.particle_count, *of_vertex.shape[1:]))
    out[cloth.vertex_particle] = of_vertex
    return out


def tube(girth_mm: float, height_mm: float, grid_mm: float, materials: MaterialTable) -> Cloth:
    """A rectangle sewn to a tube, weft around."""
    closing = Seam("closing", (EdgeUse("front", 1, False),), (EdgeUse("front", 3, True),))
    return sewn([rectangle(girth_mm, height_mm)], (closing,), grid_mm, materials)[1]


def around(cloth: Cloth, girth_mm: float, radius_m: float, bottom_m: float, shift_m: float = 0.0) -> np.ndarray:
    u, v = cloth.vertex_uv_mm.T
    angle = 2.0 * math.pi * u / girth_mm
    return by_particle(cloth, np.column_stack([radius_m * np.sin(angle) + shift_m, bottom_m + 1e-3 * v, radius_m * np.cos(angle)]))


def test_hanging_strip_is_strained_by_what_hangs_below() -> None:
    """e = W g (L - y)/Y at y below the clamp: every link, and the mean over all elements at a height, within 2 % of the largest."""
    width, length, stiffness = 100.0, 400.0, 100.0
    materials = fabric(stiffness)
    cloth = rectangle_cloth(width, length, 20.0, 0.0, materials)
    start = np.column_stack([1e-3 * cloth.vertex_uv_mm, np.zeros(cloth.particle_count)])
    fixed = np.zeros(cloth.particle_count, dtype=bool)
    fixed[cloth.edge_vertices["rectangle.top"]] = True
    hung = Rest(cloth, materials, start, 1.0, 40.0, fixed)
    warp = yarn_strain(cloth, hung.positions, WARP)
    above_hem = (warp.share * start[warp.particles, 1]).sum(axis=1)
    expected = W * GRAVITY_M_S2 * above_hem / stiffness
    largest = W * GRAVITY_M_S2 * 1e-3 * length / stiffness
    links = int((cloth.links.direction == WARP).sum())
    assert warp.strain[:links] == pytest.approx(expected[:links], abs=0.02 * largest)
    band = np.floor(above_hem / 0.02).astype(int)
    means = np.bincount(band, warp.area * (warp.strain - expected)) / np.bincount(band, warp.area)
    assert np.abs(means).max() < 0.02 * largest
    assert strain_percentiles(warp)["p50"] == pytest.approx(50.0 * largest, rel=0.05)


def test_pressure_of_a_stretched_band_is_tension_over_radius() -> None:
    """A band of girth 2 pi r / 1.05 around a cylinder: T = 0.05 Y, p = T/r; friction carries its weight."""
    radius, strain, stiffness, height = 0.12, 0.05, 400.0, 100.0
    body = cylinder_body(radius)
    materials = fabric(stiffness)
    girth = 2000.0 * math.pi * radius / (1.0 + strain)
    cloth = tube(girth, height, 20.0, materials)
    band = Rest(cloth, materials, around(cloth, girth, radius + 2e-3, 1.0), 0.4, 20.0, body=body)
    worn = on_body(cloth, materials, body, band.positions, band.forces)
    gap = 0.6e-3 + 0.02**2 / (4.0 * radius)  # docs/contact.md
    tension = stiffness * ((1.0 + strain) * (radius + gap) / radius - 1.0)
    assert tension_summary(cloth, band.positions, materials, WEFT)["p50"] == pytest.approx(tension, rel=0.02)
    assert worn.pressure.in_contact.all()
    inside = cloth.vertex_particle[~cloth.vertex_on_contour]
    assert worn.pressure.summary()["mean_in_contact"] == pytest.approx(1e-3 * tension / radius, rel=0.03)
    assert np.median(worn.pressure.kpa[inside]) == pytest.approx(1e-3 * tension / radius, rel=0.03)
    assert worn.pressure.contact_area_m2() == pytest.approx(2.0 * math.pi * radius * 1e-3 * height, rel=0.03)
    weight = GRAVITY_M_S2 * float(cloth.masses.sum())
    support = worn.pressure.support_n(weight)
    assert support["friction"] == pytest.approx(weight, rel=0.01)
    assert support["normal"] == pytest.approx(0.0, abs=0.01 * weight)


def test_ease_of_a_loose_tube() -> None:
    """60 mm more than the cylinder, hung off its middle from a ring: the girth that was sewn, whatever shape it takes."""
    radius, ease = 0.12, 60.0
    body, materials = cylinder_body(radius), fabric(2000.0)
    girth = 2000.0 * math.pi * radius + ease
    cloth = tube(girth, 400.0, 20.0, materials)
    start = around(cloth, girth, 1e-3 * girth / (2.0 * math.pi), 0.8, shift_m=6e-3)
    hung = Rest(cloth, materials, start, 0.6, 5.0, start[:, 1] > 1.199, body)
    found = garment_ease(cloth, hung.positions, body)
    for line in ("waist", "hip"):
        here = found[line]
        assert here is not None
        assert here.draped_mm == pytest.approx(ease, abs=1.0)
        assert here.pattern_mm == pytest.approx(ease, abs=1.0)
        assert here.body_mm == pytest.approx(2000.0 * math.pi * radius)
    loop = loops_in_plane(cloth, hung.positions, body, horizontal(1.0))[0]
    assert (loop.parts, loop.ease_mm) == (("torso",), pytest.approx(ease, abs=1.0))
    assert loop.body_mm == pytest.approx(2000.0 * math.pi * radius, abs=0.5)


def ball(radius: float, height: float) -> Mannequin:
    mesh = trimesh.creation.icosphere(subdivisions=4, radius=radius)
    faces = indices(mesh.faces)
    return Mannequin("ball", floats(mesh.vertices + np.array([0.0, height, 0.0])), faces, {}, {}, {}, ("torso",), np.zeros(len(faces), dtype=np.int32))


def test_body_carries_the_weight_of_a_hanging_skirt() -> None:
    """Two flared panels sewn to a skirt that hangs on a ball: pressure and friction together carry its weight, friction within Coulomb's cone."""
    top, bottom, height = 300.0, 560.0, 260.0
    drawn = [panel([(-bottom / 2, 0), (bottom / 2, 0), (top / 2, height), (-top / 2, height)], name=name) for name in ("front", "back")]
    sides = (
        Seam("left", (EdgeUse("front", 1, False),), (EdgeUse("back", 3, True),)),
        Seam("right", (EdgeUse("back", 1, False),), (EdgeUse("front", 3, True),)),
    )
    materials = fabric(400.0)
    cloth = sewn(drawn, sides, 20.0, materials)[1]
    u, v = cloth.vertex_uv_mm.T
    half = 0.5 * (bottom + (top - bottom) * v / height)
    angle = math.pi * (0.5 * u / half + cloth.vertex_panel)
    radius = 2e-3 * half / math.pi
    body = ball(0.12, 1.0)
    start = by_particle(cloth, np.column_stack([radius * np.sin(angle), 0.87 + 0.9e-3 * v, radius * np.cos(angle)]))
    skirt = Rest(cloth, materials, start, 3.0, 6.0, body=body)
    worn = on_body(cloth, materials, body, skirt.positions, skirt.forces)
    weight = GRAVITY_M_S2 * float(cloth.masses.sum())
    support = worn.pressure.support_n(weight)
    assert support["normal"] + support["friction"] == pytest.approx(weight, rel=1e-3)
    assert np.linalg.norm(worn.pressure.friction_n, axis=1).sum() > 0.05 * weight  # it takes part, whichever way it points
    assert 0.05 < worn.pressure.in_contact.mean() < 0.8
    cone = np.linalg.norm(worn.pressure.friction_n, axis=1) - MU * np.linalg.norm(worn.pressure.normal_n, axis=1)
    assert cone.max() < 0.01 * weight


@pytest.mark.parametrize("slant_deg", [0.0, 30.0])
def test_seam_carries_what_hangs_on_it(slant_deg: float) -> None:
    """A strip of 100 mm with a seam at an angle t across it, 3 N at its lower end: with T = (3 N + what hangs below) / 0.1 m it bears T cos^2 t across and
    T sin t cos t along."""
    width, load, materials = 100.0, 3.0, fabric(2000.0, 400.0)
    tangent = math.tan(math.radians(slant_deg))
    upper = panel([(0, 0), (width, width * tangent), (width, 240), (0, 240)], name="upper")
    lower = panel([(0, -180), (width, -180), (width, width * tangent), (0, 0)], name="lower")
    panels, seams = [upper, lower], (Seam("seam", (EdgeUse("upper", 0, False),), (EdgeUse("lower", 2, True),)),)
    flat, cloth = sewn(panels, seams, 20.0, materials)
    at = np.column_stack([1e-3 * flat.vertex_uv_mm, np.zeros(len(flat.vertex_uv_mm))])
    held, loads = np.zeros(cloth.particle_count, dtype=bool), np.zeros(cloth.particle_count)
    held[cloth.vertex_particle[cloth.edge_vertices["upper.e2"]]] = True
    end = cloth.vertex_particle[cloth.edge_vertices["lower.e0"]]
    share = np.ones(len(end))
    share[[0, -1]] = 0.5
    loads[end] = load / GRAVITY_M_S2 * share / share.sum()
    hung = Rest(cloth, materials, by_particle(cloth, at), 1.0, 30.0, held, loads=loads)
    apart = ForceAssembly(internal_forces(flat, materials), flat.particle_count, [ForceGravity(flat.masses)])
    where, forces = hung.positions[cloth.vertex_particle], np.empty_like(at)
    apart.add_up(where, np.zeros_like(where), forces)
    cosine, sine = math.cos(math.radians(slant_deg)), math.sin(math.radians(slant_deg))
    found = seam_tension(flat, where, forces, seam_lengths(pattern(*panels, seams=seams)))["seam"]
    assert found is not None
    below = W * GRAVITY_M_S2 * 1e-6 * width * (180.0 + 0.5 * width * tangent)
    pull = (load + below) / (1e-3 * width)
    assert found.length_mm == pytest.approx(width / cosine)
    assert found.mean_n_m == pytest.approx(pull * cosine**2, rel=0.02)
    assert found.along_n_m == pytest.approx(pull * sine * cosine, abs=0.02 * pull)
    assert found.max_n_m == pytest.approx(pull * cosine**2, rel=0.2)


def test_a_seam_is_as_long_as_on_the_pattern() -> None:
    """Of eased sides the mean, of gathered ones the shorter; of a zip the part that is closed; of a dart its legs, up to the apex that has no stitch."""
    leg = math.hypot(80.0, 12.0)
    darted = panel([(0, 0), (200, 0), (200, 150), (112, 150), (100, 70), (88, 150), (0, 150)], name="darted")
    drawn = [darted, rectangle(100.0, 60.0, name="short"), rectangle(104.0, 60.0, name="eased"), rectangle(300.0, 60.0, name="long")]
    bottom, top = 0, 2
    seams = (
        Seam("dart", (EdgeUse("darted", 3, True),), (EdgeUse("darted", 4, False),)),
        Seam("eased", (EdgeUse("short", bottom, False),), (EdgeUse("eased", top, True),)),
        Seam("gathered", (EdgeUse("short", top, False),), (EdgeUse("long", bottom, True),)),
        Seam("zip", (EdgeUse("short", 1, False),), (EdgeUse("eased", 3, True),), closed=0.6),
    )
    assert seam_lengths(pattern(*drawn, seams=seams)) == pytest.approx({"dart": leg, "eased": 102.0, "gathered": 100.0, "zip": 36.0})


def test_gathers_do_not_push_their_seam_apart() -> None:
    """A valance of 300 mm that is gathered into 200 mm hangs in folds, and its seam carries what it weighs. (Squeezed to the length of the seam cloth pushed
    with 500 N/m / 3, and the threads carried 15 times as much.)"""
    width, long, deep, materials = 200.0, 300.0, 150.0, fabric(500.0)
    panels = [rectangle(width, 40.0, name="rail"), rectangle(long, deep, name="valance")]
    seams = (Seam("seam", (EdgeUse("rail", 0, False),), (EdgeUse("valance", 2, True),)),)
    flat, cloth = sewn(panels, seams, 10.0, materials)
    of_valance = flat.vertex_panel == 1
    x, y = (flat.vertex_uv_mm * np.where(of_valance[:, None], [width / long, 1.0], 1.0) - np.where(of_valance[:, None], [0.0, deep], 0.0)).T
    # four waves, whose slope takes up the length, from 40 mm below the seam on
    fold = np.where(of_valance, 17.0 * np.sin(8.0 * math.pi * x / width) * np.minimum(1.0, -y / 40.0), 0.0)
    held = np.zeros(cloth.particle_count, dtype=bool)
    held[cloth.vertex_particle[cloth.edge_vertices["rail.e2"]]] = True
    hung = Rest(cloth, materials, by_particle(cloth, 1e-3 * np.column_stack([x, y, fold])), 1.5, 30.0, held)
    gathered = replace(flat, border=cloth.border._replace(corners=flat.border.corners))
    where, forces = hung.positions[cloth.vertex_particle], np.empty((len(flat.vertex_uv_mm), 3))
    ForceAssembly(internal_forces(gathered, materials), flat.particle_count, [ForceGravity(flat.masses)]).add_up(where, np.zeros_like(where), forces)
    found = seam_tension(gathered, where, forces, seam_lengths(pattern(*panels, seams=seams)))["seam"]
    assert found is not None
    weight = W * GRAVITY_M_S2 * 1e-6 * long * deep
    assert found.length_mm == pytest.approx(width)
    assert found.mean_n_m == pytest.approx(weight / (1e-3 * width), rel=0.05)
