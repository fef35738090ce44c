"""Garment against body in any plane: legs, layers, slopes, and the lines that users name."""

from __future__ import annotations

import math

import numpy as np
import pytest
import trimesh
from hand_made import cylinder_body, rectangles, tube
from scipy.special import ellipe

from garmentcad.analysis.body_line import limb_lines, parse_line
from garmentcad.analysis.plane_fit import loops_in_plane
from garmentcad.analysis.section import Plane, horizontal
from garmentcad.arrays import floats, indices
from garmentcad.cloth.cloth import Cloth
from garmentcad.errors import InputError
from garmentcad.io.mannequin_file import read_mannequin
from garmentcad.mannequin.mannequin import Mannequin

COLUMNS, PANELS, ROWS = 30, 2, 40
LEG_M, APART_M = 0.06, 0.10  # radius of a leg, distance of its axis from the middle


def legs() -> Mannequin:
    """Two upright cylinders of 120 sides."""
    parts = [trimesh.creation.cylinder(radius=LEG_M, height=1.0, sections=120) for _ in range(2)]
    vertices = [np.asarray(part.vertices)[:, [1, 2, 0]] + [side * APART_M, 0.5, 0.0] for part, side in zip(parts, (1.0, -1.0))]
    faces = [np.asarray(part.faces) + k * len(parts[0].vertices) for k, part in enumerate(parts)]
    of_part = np.repeat([0, 1], [len(part.faces) for part in parts])
    return Mannequin("legs", floats(np.concatenate(vertices)), indices(np.concatenate(faces)), {}, {}, {}, ("leg_left", "leg_right"), indices(of_part))


def around(cloth: Cloth, radius: float, x: float, bottom: float = 0.2) -> np.ndarray:
    return tube(cloth, COLUMNS, PANELS, lambda row, angle: np.full_like(angle, radius), lambda row: bottom + 0.015 * row) + np.array([x, 0.0, 0.0])


def polygon(radius: float, sides: int = COLUMNS * PANELS) -> float:
    return 2000.0 * sides * radius * math.sin(math.pi / sides)


def test_skirt_goes_around_both_legs() -> None:
    """The tape around two circles is 2 pi r + 4 a."""
    cloth = rectangles(COLUMNS, ROWS, 0.02, PANELS, sewn=True)
    loops = loops_in_plane(cloth, around(cloth, 0.2, 0.0), legs(), horizontal(0.45))
    assert [loop.parts for loop in loops] == [("leg_left", "leg_right")]
    assert loops[0].body_mm == pytest.approx(2000.0 * math.pi * LEG_M + 4000.0 * APART_M, abs=0.2)
    assert loops[0].draped_mm == pytest.approx(polygon(0.2))
    assert loops[0].pattern_mm == pytest.approx(COLUMNS * PANELS * 20.0)
    assert loops[0].ease_mm == pytest.approx(loops[0].draped_mm - loops[0].body_mm)


def test_tube_around_one_leg_leaves_the_other_out() -> None:
    cloth = rectangles(COLUMNS, ROWS, 0.01, PANELS, sewn=True)
    loops = loops_in_plane(cloth, around(cloth, 0.08, -APART_M), legs(), horizontal(0.45))
    assert [loop.parts for loop in loops] == [("leg_right",)]
    assert loops[0].body_mm == pytest.approx(2000.0 * math.pi * LEG_M, abs=0.2)
    assert loops_in_plane(cloth, around(cloth, 0.08, 0.6), legs(), horizontal(0.45)) == []
    assert loops_in_plane(cloth, around(cloth, 0.08, APART_M), legs(), horizontal(0.95)) == []  # above the garment


def test_section_askew_is_an_ellipse() -> None:
    """At an angle t to the level: half axes r and r / cos t, perimeter 4 a E(1 - b^2/a^2)."""
    slope = math.radians(20.0)
    plane = Plane(np.array([0.0, math.cos(slope), math.sin(slope)]), 0.5 * math.cos(slope))
    cloth = rectangles(COLUMNS, ROWS, 0.015, PANELS, sewn=True)
    loop = loops_in_plane(cloth, around(cloth, 0.15, 0.0), cylinder_body(0.12), plane)[0]
    for found, radius in ((loop.body_mm, 120.0), (loop.draped_mm, 150.0)):
        long = radius / math.cos(slope)
        assert found == pytest.approx(4.0 * long * ellipe(1.0 - (radius / long) ** 2), rel=0.001)


def test_limbs_are_measured_where_they_were_taped() -> None:
    """A tape through the planes of `limb_lines` reads the mannequin's own measurements."""
    body = read_mannequin("woman-88")
    lines = {line.name: line for line in limb_lines(body)}
    assert set(lines) == {"top_arm_left", "top_arm_right", "thigh_left", "thigh_right"}
    cloth = rectangles(COLUMNS, ROWS, 0.02, PANELS, sewn=True)
    for name, line in lines.items():
        # a tube along the limb, about its axis, wide enough for it
        axis = body.cylinders[str(line.part)].origin
        center = 0.5 * (axis + body.landmarks[f"elbow_{name[8:]}"]) if "arm" in name else axis + np.array([0.0, line.plane.offset, 0.0])
        radius = 0.06 if "arm" in name else 0.115
        flat = tube(cloth, COLUMNS, PANELS, lambda row, angle, radius=radius: np.full_like(angle, radius), lambda row: 0.002 * (row - 20))
        side = np.cross(line.plane.normal, [0.0, 0.0, 1.0])
        side /= np.linalg.norm(side)
        turned = flat @ np.stack([side, line.plane.normal, np.cross(side, line.plane.normal)]) + center
        loops = [loop for loop in loops_in_plane(cloth, turned, body, line.plane) if loop.parts == (line.part,)]
        assert len(loops) == 1
        assert loops[0].body_mm == pytest.approx(body.measurements_mm[name.rpartition("_")[0]], abs=0.2)


def test_lines_of_users() -> None:
    level = parse_line("high-hip=930")
    assert (level.name, level.plane.offset, level.plane.normal.tolist()) == ("high-hip", 0.93, [0.0, 1.0, 0.0])
    slope = parse_line("seat=0,900,100:0,2,0")
    assert (slope.name, slope.plane.offset, slope.plane.normal.tolist()) == ("seat", pytest.approx(0.9), [0.0, 1.0, 0.0])


@pytest.mark.parametrize("text", ["930", "=930", "a=", "a=x", "a=1,2", "a=1,2,3:0,0,0", "a=1,2,3:0,1", "a=nan", "a=1e9", "a=1:0,1,0", "a=1,2,3:"])
def test_lines_that_are_refused(text: str) -> None:
    with pytest.raises(InputError, match=r"HEIGHT in mm"):
        parse_line(text)
