"""What is laid a little inside the body begins outside it, judged by ipctk and igl, and is sewn from there."""

from __future__ import annotations

import itertools
from typing import Any

import igl
import numpy as np
import pytest
from loose_sheet import crosses

from garmentcad.cloth.lattice import build_cloth
from garmentcad.pattern.parse import parse_spec
from garmentcad.placement.place import place_vertices
from garmentcad.simulation.job import make_job
from garmentcad.simulation.materials import lay_out
from garmentcad.simulation.run import run
from garmentcad.simulation.start import freed

# Half widths at top, bust, waist and below it, as shares of the girths there; the angle at which the panel is wrapped; by how much the ends of its upper edge
# lie lower. The scale of 0.88 lays them between the arms, but 3 mm deep in the bust, and 6 mm in the upper arms.
PANELS = {
    "front": (0.105, 0.105, 0.1, 0.105, 0, 0, 0), "side_front": (0.0775, 0.085, 0.0775, 0.0775, 60, 0, 15),
    "side_back": (0.0675, 0.0625, 0.07, 0.0675, 124, 15, 30), "back": (0.0525, 0.05, 0.0525, 0.0525, 158, 30, 35),
}  # fmt: skip


def bodice() -> dict[str, Any]:
    """A strapless bodice of seven panels with princess seams, as wide as the bust; bands along them are 30 times as stiff as its cloth."""
    values = {"low": "waist + (hip - waist) / 2 + 25", "over": "bust_height - waist_height"}
    panels: dict[str, Any] = {}
    for name, (top, bust, waist, low, angle, drop_left, drop_right) in PANELS.items():
        points = {
            f"{side}{end}": [f"{sign}{share} * {girth}", height]
            for side, sign, drop in (("l", "-", drop_left), ("r", "", drop_right))
            for end, share, girth, height in (("t", top, "(bust - 25)", f"over + 50 - {drop}"), ("b", low, "low", -70))
        }
        through = {sign: [[f"{sign}{bust} * bust", "over"], [f"{sign}{waist} * (waist + 5)", 0]] for sign in ("", "-")}
        edges: list[dict[str, Any]] = [
            {"name": "right", "from": "rt", "to": "rb", "spline": {"through": through[""]}},
            {"name": "hem", "from": "rb", "to": "lb"},
            {"name": "left", "from": "lb", "to": "lt", "spline": {"through": through["-"][::-1]}},
            {"name": "top", "from": "lt", "to": "rt"},
        ]
        wrap = {"part": "torso", "anchor": [0, 0], "angle": angle, "height": "waist_height - 12", "offset": 12, "scale": 0.88}
        bones = [{"name": side, "band": {"edge": side, "width": 12}, "factors": {"B": 30, "2HB": 30}} for side in ("left", "right")]
        panels[name] = {"points": points, "edges": edges, "regions": bones, "placement": {"wrap": wrap}}
        if angle:
            panels[f"{name}_m"] = {"mirrored_from": name, "placement": {"wrap": {**wrap, "angle": -angle}}}
    seams, ends = [], {"right": ("rt", "rb"), "left": ("lt", "lb")}
    for mirror in ("", "_m"):
        ring = ["front", *(f"{name}{mirror}" for name in PANELS if name != "front")]
        for a, b in itertools.pairwise(ring):
            side = "left" if a == "front" and mirror else "right"
            seams.append({"name": f"{a}_{b}", "a": [f"{a}.{side}.{end}" for end in ends[side]], "b": [f"{b}.left.{end}" for end in ends["left"]]})
    seams.append({"name": "center", "a": ["back.right.rt", "back.right.rb"], "b": ["back_m.right.rt", "back_m.right.rb"]})
    return {"schema": 1, "units": "mm", "name": "bodice", "fabric": "cotton-broad", "mannequin": "woman-88", "values": values, "panels": panels,
            "seams": seams}  # fmt: skip


def test_what_lies_a_little_inside_the_body_begins_outside_it_and_the_rest_stays() -> None:
    job = make_job(parse_spec(bodice()), grid_mm=20.0)
    materials, material_of = lay_out(job)
    cloth, body = build_cloth(job.pattern, material_of, materials, 20.0), job.mannequin
    placed = np.empty((cloth.particle_count, 3))
    placed[cloth.vertex_particle] = place_vertices(job.pattern, cloth, body)
    both = np.vstack([cloth.particle_triangles, body.faces + len(placed)])
    assert igl.signed_distance(placed, body.vertices, body.faces)[0].min() == pytest.approx(-6e-3, abs=0.5e-3)
    assert crosses(np.vstack([placed, body.vertices]), both)
    begins = freed(cloth, placed, body)
    assert igl.signed_distance(begins, body.vertices, body.faces)[0].min() > 0.0
    assert not crosses(np.vstack([begins, body.vertices]), both)
    way = np.linalg.norm(begins - placed, axis=1)
    assert way.max() < 8e-3
    distance = np.abs(igl.signed_distance(placed, body.vertices, body.faces)[0])
    assert (way[distance > 0.02 * np.sqrt(2.0)] == 0.0).all()  # no corner of a triangle of 20 mm that crosses the body is farther from it


def test_a_bodice_that_lies_a_little_inside_the_body_is_sewn_at_once() -> None:
    """Left to contact, points pushed out of the bust were torn from their neighbours: the bust seams stood 20 mm and more open after two sewings."""
    outcome = run(make_job(parse_spec(bodice()), grid_mm=20.0), lambda progress: None)
    assert outcome.status == "converged"
    assert outcome.warnings == []
    assert not crosses(outcome.state.positions, outcome.cloth.particle_triangles)
