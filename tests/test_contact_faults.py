"""The judge of contact says where on the pattern cloth crosses itself or the body: places against hand-made scenes whose lines of crossing are known."""

from __future__ import annotations

import re

import numpy as np
from hand_made import cylinder_body, flat, rectangles

from garmentcad.analysis.contact_faults import LISTED, contact_faults

CELL_MM = 20.0
PLACE = re.compile(r"'([\w ]+)' at \((-?\d+), (-?\d+)\) mm")


def places(sentence: str) -> list[tuple[str, float, float]]:
    return [(panel, float(x), float(y)) for panel, x, y in PLACE.findall(sentence)]


def test_two_panels_that_cross_are_named_where_they_do() -> None:
    cloth = rectangles(10, 8, 0.02, 2, sewn=False)
    positions, back = flat(cloth) + np.array([0.0, 0.5, 0.3]), cloth.vertex_panel == 1
    positions[back, 2] += 0.1
    assert not contact_faults(cloth, positions, cylinder_body())
    # The back lies level, through the front along its line y = 71, from x = 43 to its side at 200; that is the back's own line y = 50, x = 0 to 157.
    u, v = cloth.vertex_uv_mm[back].T / 1000.0
    positions[back] = np.stack([0.043 + u, np.full_like(u, 0.571), 0.25 + v], axis=1)
    faults = contact_faults(cloth, positions, cylinder_body())
    assert faults
    assert (faults.mannequin_intersections, faults.mannequin_penetration_mm) == (0, 0.0)
    (sentence,) = faults.said
    assert sentence.startswith(f"the cloth crosses itself in {faults.self_intersections} pairs of triangles: {faults.self_intersections} of 'front' at")
    (front, x, y), (behind, back_x, back_y) = places(sentence)
    assert (front, behind) == ("front", "back")
    assert abs(x - 121.5) < CELL_MM
    assert abs(y - 71.0) < CELL_MM
    assert abs(back_x - 78.5) < CELL_MM
    assert abs(back_y - 50.0) < CELL_MM


def test_panels_with_most_crossings_come_first_and_the_rest_is_counted() -> None:
    """Six strips behind each other, through which the seventh passes; half as far through the first two, which stand to one side."""
    cloth = rectangles(4, 2, 0.02, 7, sewn=False)
    positions = flat(cloth) + np.array([0.0, 0.5, 0.3])
    for panel in range(6):
        positions[cloth.vertex_panel == panel] += [0.0, 0.0, 0.012 * panel]
    last = cloth.vertex_panel == 6
    positions[cloth.vertex_panel < 2] -= [0.047, 0.0, 0.0]
    u, v = cloth.vertex_uv_mm[last].T / 1000.0
    positions[last] = np.stack([0.013 + v, np.full_like(u, 0.5171), 0.295 + u], axis=1)
    faults = contact_faults(cloth, positions, cylinder_body())
    told = places(faults.said[0])
    assert [panel for panel, _, _ in told[::2]] == ["panel 2", "panel 3", "panel 4", "panel 5"]
    assert len(told) == 2 * LISTED
    counts = [int(count) for count in re.findall(r"(\d+) of '", faults.said[0])]
    assert counts == sorted(counts, reverse=True)
    elsewhere = int(re.search(r"(\d+) elsewhere", faults.said[0]).group(1))  # type: ignore[union-attr]
    assert sum(counts) + elsewhere == faults.self_intersections


def test_a_panel_in_the_body_is_named_with_part_place_and_depth() -> None:
    cloth, body = rectangles(10, 8, 0.02, 1, sewn=False), cylinder_body()
    # Flat, 1.5 mm inside the round body where it is deepest, x = 70 of the panel; it leaves it 19 mm to either side.
    positions = flat(cloth) + np.array([-0.07, 0.5, 0.1185])
    faults = contact_faults(cloth, positions, body)
    assert faults.mannequin_intersections > 0
    assert 1.08 < faults.mannequin_penetration_mm < 1.5  # at the particles 10 mm beside, and in the middle
    crosses, lies = faults.said
    assert crosses.startswith(f"the cloth crosses the body (torso) in {faults.mannequin_intersections} pairs of triangles: ")
    assert lies.startswith(f"the cloth lies up to {faults.mannequin_penetration_mm:.3g} mm inside the body: deepest particle in 'front' at (")
    (_, x, _), (_, deepest_x, _) = places(crosses)[0], places(lies)[0]
    assert abs(x - 70.0) < 19.0 + CELL_MM
    assert abs(deepest_x - 70.0) < CELL_MM
    moved = body.vertices - [0.0, 0.0, 0.01]
    assert not contact_faults(cloth, positions, body, moved), "the body is where it has moved to"
