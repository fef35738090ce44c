"""Cloth on still bodies, judged by libigl and ipctk; and that decoupled detection misses nothing."""

from __future__ import annotations

from copy import deepcopy
from dataclasses import replace

import igl
import numpy as np
import pytest
import trimesh
from loose_sheet import Sheet, correct, crosses_body, fabric, least_distance

from garmentcad.contact.body import CLEARANCE, ELEMENT_GAP, BodyElements
from garmentcad.contact.contact import Contact
from garmentcad.contact.planes import PUSH_SPEED
from garmentcad.contact.surface import build_surface, bulge, convex_curvature

DT = 1.5e-4


def ball(radius: float, subdivisions: int = 3) -> tuple[np.ndarray, np.ndarray]:
    mesh = trimesh.creation.icosphere(subdivisions=subdivisions, radius=radius)
    return np.asarray(mesh.vertices), np.asarray(mesh.faces)


def test_sheet_dropped_on_a_ball_ends_clean() -> None:
    vertices, faces = ball(0.045)
    sheet = Sheet(15)
    contact = Contact(sheet.cloth, fabric(), (vertices, faces))
    state = sheet.state(sheet.at(0.003, 0.055, 0.002))
    contact.start(state)
    triangles = sheet.cloth.particle_triangles
    for step in range(800):
        sheet.step(state, DT, contact)
        if step % 400 == 399:
            assert least_distance(state.positions, triangles, vertices, faces) > 0.0
            assert not crosses_body(state.positions, triangles, vertices, faces)
    assert state.positions[:, 1].min() < 0.01  # it hangs down around the ball
    gap = CLEARANCE + 0.01**2 / (4 * 0.045)
    closest = least_distance(state.positions, triangles[:0], vertices, faces)
    assert closest == pytest.approx(gap, abs=0.05e-3)  # not nearer, not held off
    assert state.work_j["friction"] < 0.0


def test_sheet_on_a_needle_and_on_a_sharp_edge() -> None:
    """The sharp features lie between particles, where these alone would let them through."""
    needle = trimesh.creation.cone(radius=0.012, height=0.05, sections=12)
    box = trimesh.creation.box(extents=(0.06, 0.06, 0.06))
    box.apply_transform(trimesh.transformations.rotation_matrix(np.pi / 4, [0, 0, 1]))
    for mesh, top in ((trimesh.Trimesh(needle.vertices[:, [1, 2, 0]], needle.faces), 0.05), (box, 0.0425)):
        vertices, faces = np.asarray(mesh.vertices), np.asarray(mesh.faces)
        sheet = Sheet(10)
        contact = Contact(sheet.cloth, fabric(), (vertices, faces), itself=False)
        state = sheet.state(sheet.at(0.0047, top + 0.004, 0.0033))
        contact.start(state)
        for step in range(500):
            sheet.step(state, DT, contact)
            if step % 100 == 99:
                assert not crosses_body(state.positions, sheet.cloth.particle_triangles, vertices, faces)
        assert state.positions[:, 1].min() < top - 0.01


def test_on_sharp_features_each_panel_has_its_own_friction() -> None:
    """Two sheets lie along the ridge of a box and slide there, held by its edge alone: each slows down by its own friction."""
    box = trimesh.creation.box(extents=(0.4, 0.06, 0.06))
    box.apply_transform(trimesh.transformations.rotation_matrix(np.pi / 4, [1, 0, 0]))
    top, own = 0.03 * np.sqrt(2.0), (0.1, 0.5)
    sheet = Sheet(4, panels=2)
    panel = sheet.cloth.vertex_panel[sheet.cloth.triangles[:, 0]]
    table = fabric()._replace(friction_body=np.array(own))
    contact = Contact(replace(sheet.cloth, triangle_material=panel), table, (np.asarray(box.vertices), np.asarray(box.faces)), itself=False)
    state = sheet.state(sheet.at(0.0, top + ELEMENT_GAP, 0.0047))
    contact.start(state)
    state.velocities[:] = [1.0, -1e-3, 0.0]
    correct(state, 1e-3, contact)
    for number, friction in enumerate(own):
        mine = sheet.cloth.vertex_panel[np.argsort(sheet.cloth.vertex_particle)] == number
        before, after = np.array([1.0, -1e-3, 0.0]), (sheet.cloth.masses[mine, None] * state.velocities[mine]).sum(axis=0) / sheet.cloth.masses[mine].sum()
        assert after[1] > -0.9e-3
        assert (before - after)[0] == pytest.approx(friction * (after - before)[1], rel=1e-3)


def test_no_particle_comes_nearer_than_its_gap_between_looks() -> None:
    """Planes serve until a particle has gone its allowance; the true distance, by libigl, tells whether one was missed."""
    vertices, faces = ball(0.045)
    sheet = Sheet(12)
    contact = Contact(sheet.cloth, fabric(), (vertices, faces), itself=False)
    state = sheet.state(sheet.at(0.003, 0.052, 0.002), np.tile([0.6, -0.5, 0.1], (13 * 13, 1)))
    contact.start(state)
    looked, touched = 0, 0
    before = igl.signed_distance(state.positions, vertices, faces)[0]
    for _ in range(400):
        sheet.pull(state, DT)
        home, free = state.contact["planes_home"].copy(), state.velocities.copy()
        state.positions += correct(state, DT, contact) * DT * state.velocities
        looked += int((state.contact["planes_home"] != home).any(axis=1).sum())
        touched += int((np.abs(free - state.velocities).max(axis=1) > 0).sum())
        after = igl.signed_distance(state.positions, vertices, faces)[0]
        assert (after > np.minimum(before, 1.1e-3) - 2e-6).all()
        before = after
    assert touched > 2000
    assert looked < 0.12 * 400 * 13 * 13  # one look in eight steps or more, at 0.8 m/s


def test_what_presses_on_a_face_looks_anew_only_where_it_goes() -> None:
    """At 8 m/s a step is 1.2 mm long, more than any look covers at rest: into the face nothing goes there, along it all do."""
    box = trimesh.creation.box(extents=(0.4, 0.06, 0.4))
    sheet = Sheet(6)
    contact = Contact(sheet.cloth, fabric(), (np.asarray(box.vertices), np.asarray(box.faces)), itself=False)
    state = sheet.state(sheet.at(0.003, 0.03 + CLEARANCE, 0.002))
    contact.start(state)
    correct(state, DT, contact)
    home = state.contact["planes_home"].copy()
    state.positions[:, 0] += 1e-5  # so that a look would be seen
    state.velocities[:] = [0.0, -8.0, 0.0]
    correct(state, DT, contact)
    assert (state.velocities[:, 1] >= 0.0).all()  # it is held, and pushed to its gap
    assert (state.velocities[:, 1] <= PUSH_SPEED).all()
    assert np.array_equal(state.contact["planes_home"], home)
    state.velocities[:] = [8.0, 0.0, 0.0]
    correct(state, DT, contact)
    assert (state.contact["planes_home"] != home).any(axis=1).all()


def test_a_copied_state_goes_on_with_the_same_bits() -> None:
    vertices, faces = ball(0.045)
    sheet = Sheet(10)
    contact = Contact(sheet.cloth, fabric(), (vertices, faces), itself=False)
    state = sheet.state(sheet.at(0.003, 0.048, 0.002))
    contact.start(state)
    for _ in range(150):
        sheet.step(state, DT, contact)
    resumed, again = deepcopy(state), Contact(sheet.cloth, fabric(), (vertices, faces), itself=False)
    for _ in range(150):
        sheet.step(state, DT, contact)
        sheet.step(resumed, DT, again)
    assert resumed.sha256() == state.sha256()
    assert resumed.work_j == state.work_j


def test_hollow_corner_holds_from_both_sides() -> None:
    """A particle pressed into a groove of 70 degrees: after the response it approaches neither wall faster than its room allows."""
    half = np.radians(35)
    profile = np.array([[0, 0], [np.sin(half), np.cos(half)], [1.2, 0.9], [1.2, -0.5], [-1.2, -0.5], [-1.2, 0.9], [-np.sin(half), np.cos(half)]]) * 0.1
    front, back = (np.column_stack([profile, np.full(7, z)]) for z in (0.2, -0.2))
    cap = np.array([[0, 2, 1], [0, 3, 2], [0, 4, 3], [0, 5, 4], [0, 6, 5]])
    sides = np.array([[[k, k + 7, (k + 1) % 7], [(k + 1) % 7, k + 7, (k + 1) % 7 + 7]] for k in range(7)]).reshape(-1, 3)
    faces = np.concatenate([cap, cap[:, ::-1] + 7, sides])
    mesh = trimesh.Trimesh(np.concatenate([front, back]), faces, process=False)
    if mesh.volume < 0:
        mesh.invert()
    assert mesh.is_watertight
    sheet = Sheet(1)
    vertices, faces = np.asarray(mesh.vertices), np.asarray(mesh.faces)
    contact = Contact(sheet.cloth, fabric(friction=0.0), (vertices, faces), itself=False)
    walls = np.array([[np.cos(half), -np.sin(half), 0], [-np.cos(half), -np.sin(half), 0]]) * -1
    for start, velocity in (((0.0, 0.0022), (0.3, -2.0)), ((1e-4, 0.0025), (-0.1, -1.0)), ((-3e-4, 0.0024), (2.0, -0.5))):
        state = sheet.state(np.tile([*start, 0.0], (4, 1)) + 0.05 * np.eye(4)[:, :3] * [0, 0, 1], np.tile([*velocity, 0.0], (4, 1)))
        contact.start(state)
        contact.detect(state, 2.1e-3)  # they go 2 mm in the step
        contact.respond(state, 1e-3)
        room = (state.positions[0] @ walls.T) - 1e-3
        assert (state.velocities[0] @ walls.T >= -np.maximum(room, 0) / 1e-3 - 1e-9).all()
        assert np.isfinite(state.velocities).all()


def test_what_came_below_an_edge_or_a_vertex_of_a_body_is_pushed_outward() -> None:
    """A micrometre, and less than its own size from the next edge that says otherwise: a body has an outside, whatever side a pair remembers."""
    tip = trimesh.creation.cone(radius=0.012, height=0.05, sections=4)
    box = trimesh.creation.box(extents=(0.06, 0.06, 0.06))
    box.apply_transform(trimesh.transformations.rotation_matrix(np.pi / 4, [0, 0, 1]))
    for vertices, faces, top in ((tip.vertices[:, [1, 2, 0]], tip.faces, 0.05), (box.vertices, box.faces, 0.06 / np.sqrt(2.0))):
        sheet = Sheet(1)
        contact = Contact(sheet.cloth, fabric(friction=0.0), (np.asarray(vertices), np.asarray(faces)), itself=False)
        for shift in ((0.0, 0.0), (1e-3, 0.5e-3), (-0.7e-3, 0.2e-3)):
            state = sheet.state(sheet.at(shift[0], top - 1e-6, shift[1]))
            contact.start(state)
            correct(state, 1e-4, contact)
            assert state.velocities[:, 1].max() > 0.0
            assert state.velocities[:, 1].min() >= 0.0


def test_pushed_out_gently_and_never_braked() -> None:
    vertices, faces = ball(0.1, 4)
    sheet = Sheet(1)
    contact = Contact(sheet.cloth, fabric(friction=0.0), (vertices, faces), itself=False)
    outward = vertices[40] / 0.1
    for depth, speed, expected in ((20e-3, -1.0, 0.25), (3e-3, -1.0, 0.25), (0.2e-3, -1.0, 0.04), (3e-3, 2.0, 2.0)):
        positions = np.tile(outward * (0.101 - depth), (4, 1))
        state = sheet.state(positions, np.tile(outward * speed, (4, 1)))
        contact.start(state)
        correct(state, 1e-4, contact)
        np.testing.assert_allclose(state.velocities @ outward, expected, rtol=0.05)


def test_held_particles_are_left_alone() -> None:
    vertices, faces = ball(0.1)
    sheet = Sheet(3)
    inverse = 1.0 / sheet.cloth.masses
    inverse[5] = 0.0
    given = Contact(sheet.cloth, fabric(), (vertices, faces), False, inverse)
    told = Contact(sheet.cloth, fabric(), (vertices, faces), itself=False)
    told.set_inverse_masses(inverse)
    for contact in (given, told):
        state = sheet.state(sheet.at(0, 0.1012, 0), np.tile([0, -3.0, 0], (16, 1)))
        contact.start(state)
        correct(state, 1e-3, contact)
        assert state.velocities[5, 1] == -3.0
        assert state.velocities[6, 1] > -1.5


def test_curvature_of_a_ball_a_cylinder_and_a_box_face() -> None:
    vertices, faces = ball(0.08, 4)
    np.testing.assert_allclose(convex_curvature(build_surface(vertices, faces)), 1 / 0.08, rtol=0.05)
    box = trimesh.creation.box(extents=(1, 1, 1))
    for _ in range(4):
        box = box.subdivide()
    curvature = convex_curvature(build_surface(np.asarray(box.vertices), np.asarray(box.faces)))
    inner = (np.abs(box.vertices) < 0.25).sum(axis=1) == 2
    assert inner.sum() > 200
    np.testing.assert_allclose(curvature[inner], 0.0, atol=1e-12)
    assert curvature.max() > 4.0  # its edges
    hollow = convex_curvature(build_surface(vertices, faces[:, ::-1]))
    np.testing.assert_allclose(hollow, 0.0, atol=1e-9)


def test_bulge_of_a_ball_a_box_and_a_needle() -> None:
    """How far the surface drops at a distance: r^2/(2 R) on a ball; r sin of the slope from an edge, a corner or a tip, however long the sides are."""
    vertices, faces = ball(0.08, 4)
    found = bulge(build_surface(vertices, faces), 0.007)
    np.testing.assert_allclose(found, 0.007**2 / (2 * 0.08), rtol=0.07)  # normals at vertices of a polyhedron lean a little
    assert found.min() > 0.007**2 / (2 * 0.08) * (1 - 1e-9)  # never less
    box = trimesh.creation.box(extents=(1, 1, 1))
    corners = bulge(build_surface(np.asarray(box.vertices), np.asarray(box.faces)), 0.007)
    assert (corners > 0.5 * 0.007).all()
    needle = trimesh.creation.cone(radius=0.012, height=0.05, sections=12)
    tip = bulge(build_surface(np.asarray(needle.vertices), np.asarray(needle.faces)), 0.007)[np.argmax(needle.vertices[:, 2])]
    assert tip == pytest.approx(0.007 * 0.05 / np.hypot(0.05, 0.012), rel=1e-3)


@pytest.mark.parametrize("radius", [0.06, 0.15, 0.6])
def test_the_longest_side_clears_every_vertex_that_is_not_looked_at(radius: float) -> None:
    """A side longer than the lattice's diagonal lies with its middle over a vertex, its ends at their gap above the ball: sqrt((R + g)^2 - (L/2)^2) - R."""
    ball, spacing, longest = trimesh.creation.icosphere(subdivisions=4, radius=radius), 0.02, 0.033
    body = BodyElements(np.asarray(ball.vertices), np.asarray(ball.faces), spacing, longest)
    gap = np.maximum(np.minimum(body.rise, body.largest_gap), 1e-3)
    clear = np.sqrt((radius + gap) ** 2 - (0.5 * longest) ** 2) - radius
    looked_at = np.zeros(len(gap), dtype=bool)
    looked_at[body._points.nodes[:, 0]] = True
    assert (clear[~looked_at] > ELEMENT_GAP).all()
    assert looked_at.all() == (radius < 0.3)
