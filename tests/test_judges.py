"""The judge of the order of an outfit sees what hangs outside what it should lie under."""

from __future__ import annotations

import numpy as np
from trimesh.creation import cylinder, icosphere

from tools.judges import uncovered


def test_points_outside_a_tube_are_told_from_those_in_it() -> None:
    body = icosphere(subdivisions=3, radius=0.1)
    skin = np.asarray(body.vertices), np.asarray(body.faces, dtype=np.int32)
    tube = cylinder(radius=0.15, height=0.4, sections=48)
    wall = tube.faces[np.abs(tube.face_normals[:, 2]) < 0.5]  # without its ends
    turn = np.linspace(0.0, 2.0 * np.pi, 25)[:-1] + 0.01
    ring = np.column_stack([np.cos(turn), np.sin(turn), 0.0 * turn])
    for radius, expected in ((0.12, False), (0.2, True)):
        found = uncovered(radius * ring, np.asarray(tube.vertices), np.asarray(wall), *skin)
        assert (found == expected).all()
    above = 0.12 * ring + [0.0, 0.0, 0.5]  # past the end of the tube there is nothing over it
    assert not uncovered(above, np.asarray(tube.vertices), np.asarray(wall), *skin).any()
