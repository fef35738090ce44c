"""Dress forms and shoulder pads, by independent judges."""

import functools

import numpy as np
import pytest
import trimesh

from garmentcad.analysis.passing import head_girth_mm
from garmentcad.errors import MannequinError
from garmentcad.io.mannequin_file import read_human
from garmentcad.mannequin.make import make_mannequin
from garmentcad.mannequin.motion import Pose, posed
from garmentcad.mannequin.pads import ShoulderPads
from tools.body_study import asymmetry_mm, closed, crosses_itself, girth_mm

BODIES = [("woman", 880), ("woman", 1160), ("man", 1000)]


@functools.lru_cache
def made(kind, bust, form=False, pads=None):
    return make_mannequin(read_human(kind), {"bust": bust}, name=f"{kind}-{bust}", form=form, pads=pads)


def taped(body, name):
    torso = body.faces[body.face_part == body.part_names.index("torso")]
    return girth_mm(body.vertices, torso, [0, body.measurements_mm[f"{name}_height"] / 1000, 0], [0, 1, 0])


@pytest.mark.parametrize(("kind", "bust"), BODIES)
@pytest.mark.parametrize("pads", [None, ShoulderPads(20, overhang=15)])
def test_form_is_a_closed_torso_with_the_girths_of_the_body(kind, bust, pads):
    form, body = made(kind, bust, True, pads), made(kind, bust)
    assert closed(form.vertices, form.faces)
    assert not crosses_itself(form.vertices, form.faces)
    assert asymmetry_mm(form.vertices, form.faces) < 0.1
    assert {form.part_names[part] for part in np.unique(form.face_part)} == {"torso", "head", "leg_left", "leg_right"}
    for name in ("bust", "waist", "hip"):
        assert taped(form, name) == pytest.approx(body.measurements_mm[name], abs=0.5)
    assert form.vertices[:, 1].max() < body.landmarks["nape"][1] + 0.06
    assert head_girth_mm(form) is None
    assert head_girth_mm(body) is not None
    assert np.abs(form.vertices[:, 0]).max() < 1.25 * max(body.landmarks["shoulder_point_left"][0], body.landmarks["hip_left"][0])
    assert {"elbow_left", "wrist_right"}.isdisjoint(form.landmarks)
    assert {"top_arm", "arm_length"} <= set(form.estimated)
    with pytest.raises(MannequinError, match="cannot be posed"):
        posed(form, Pose(arm_left=30))


@pytest.mark.parametrize(("kind", "bust"), BODIES)
def test_pads_are_as_thick_and_long_as_asked_for(kind, bust):
    pads = ShoulderPads(18, length=100, width=140, overhang=12)
    padded, bare = made(kind, bust, False, pads), made(kind, bust)
    assert closed(padded.vertices, padded.faces)
    assert not crosses_itself(padded.vertices, padded.faces)
    tip, neck = bare.landmarks["shoulder_point_left"], bare.landmarks["neck_side_left"]
    lift = padded.vertices - bare.vertices
    assert lift[:, 1].min() >= 0
    np.testing.assert_array_equal(lift[:, [0, 2]], 0)
    outward = (tip - neck) * [1, 0, 1] / np.linalg.norm((tip - neck) * [1, 0, 1])

    def above(body, along):
        """Height of the surface over a place of the shoulder line: a section by trimesh."""
        mesh = trimesh.Trimesh(body.vertices, body.faces, process=False)
        across = np.cross(outward, [0, 1, 0])
        lines = trimesh.intersections.mesh_plane(mesh, across, tip + 0.0007 * across)  # beside the vertex
        places = (lines - tip) @ outward - along
        crossed = places[:, 0] * places[:, 1] < 0
        share = places[crossed, 0] / (places[crossed, 0] - places[crossed, 1])
        return ((1 - share) * lines[crossed, 0, 1] + share * lines[crossed, 1, 1]).max()

    assert 1000 * (above(padded, -0.001) - above(bare, -0.001)) == pytest.approx(18, abs=1)
    assert 1000 * (above(padded, -0.05) - above(bare, -0.05)) == pytest.approx(9, abs=1)  # half-way in, half as thick
    touched = lift[:, 1] > 1e-6
    along = (bare.vertices - tip) @ outward
    left = touched & (bare.vertices[:, 0] > 0)
    assert -0.1 <= along[left].min() < -0.08
    assert 0.012 < along[left].max() < 0.032
    assert np.ptp(bare.vertices[left, 2]) == pytest.approx(0.14, abs=0.02)
    slope = (tip - neck)[1] / np.linalg.norm((tip - neck)[[0, 2]])
    np.testing.assert_allclose(padded.landmarks["shoulder_point_left"], tip + 0.012 * outward + [0, 0.012 * slope + 0.018, 0], atol=1e-9)


def test_pads_that_no_tailor_makes_are_refused():
    for values in ({"thickness": 0}, {"thickness": 90}, {"thickness": 10, "overhang": -5}, {"thickness": float("nan")}, {"thickness": "thick"}):
        with pytest.raises(MannequinError, match="mm"):
            ShoulderPads(**values)
