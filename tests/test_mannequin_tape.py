"""The tape against closed forms and finite differences."""

import numpy as np
import pytest
import trimesh

from garmentcad.errors import MannequinError
from garmentcad.mannequin.tape import cut, tape


def test_girth_of_a_box_and_a_tilted_cylinder():
    box = trimesh.creation.box([2, 1, 3])
    assert tape(box.vertices, box.faces, np.array([0, 0.1, 0]), np.array([0.0, 1, 0])).girth == pytest.approx(10)
    pipe = trimesh.creation.cylinder(radius=0.1, height=1, sections=400)  # along z
    normal = np.array([0, np.sin(0.5), np.cos(0.5)])
    a, b = 0.1 / np.cos(0.5), 0.1
    ellipse = np.pi * (3 * (a + b) - np.sqrt((3 * a + b) * (a + 3 * b)))  # Ramanujan
    assert tape(pipe.vertices, pipe.faces, np.zeros(3), normal).girth == pytest.approx(ellipse, rel=1e-4)


def test_tape_bridges_hollows():
    two = trimesh.util.concatenate([trimesh.creation.box([1, 1, 1]), trimesh.creation.box([1, 1, 1]).apply_translation([3, 0, 0])])
    assert tape(two.vertices, two.faces, np.zeros(3), np.array([0.0, 1, 0])).girth == pytest.approx(10)


def test_mirrored_half_equals_the_whole():
    ball = trimesh.creation.icosphere(subdivisions=4, radius=0.5)
    half = ball.faces[ball.triangles_center[:, 0] > 0]
    whole = tape(ball.vertices, ball.faces, np.array([0, 0.1, 0]), np.array([0.0, 1, 0])).girth
    assert tape(ball.vertices, half, np.array([0, 0.1, 0]), np.array([0.0, 1, 0]), mirrored=True).girth == pytest.approx(whole, rel=1e-3)


@pytest.mark.parametrize("mirrored", [False, True])
def test_gradient_is_the_derivative(mirrored):
    random = np.random.default_rng(1)
    ball = trimesh.creation.icosphere(subdivisions=2, radius=0.5)
    points = ball.vertices * [1, 1, 0.6]
    origin, normal = np.array([0, 0.07, 0]), np.array([0.0, 1, 0])
    faces = ball.faces[ball.triangles_center[:, 0] > 0] if mirrored else ball.faces
    direction = random.normal(size=points.shape) * [1, 0, 1]  # in the plane: the crossings stay
    result = tape(points, faces, origin, normal, mirrored)
    low, high, share, _ = result.section
    slope = ((1 - share)[:, None] * direction[low] + share[:, None] * direction[high]) * result.gradient
    step = 1e-6
    ahead, behind = (tape(points + sign * step * direction, faces, origin, normal, mirrored).girth for sign in (1, -1))
    assert slope.sum() == pytest.approx((ahead - behind) / (2 * step), rel=1e-6)


def test_section_points_lie_in_the_plane_and_misses_are_refused():
    ball = trimesh.creation.icosphere(subdivisions=3)
    normal = np.array([0.6, 0.8, 0])
    section = cut(ball.vertices, ball.faces, np.array([0.1, 0, 0]), normal)
    np.testing.assert_allclose((section.points - [0.1, 0, 0]) @ normal, 0, atol=1e-12)
    with pytest.raises(MannequinError, match="does not meet"):
        tape(ball.vertices, ball.faces, np.array([0, 5, 0]), np.array([0.0, 1, 0]))
