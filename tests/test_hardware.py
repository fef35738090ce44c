"""Pins, buttons, zips, elastics and belts, from spec to rest."""

from __future__ import annotations

import copy
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numba
import numpy as np
import pytest
import trimesh

import garmentcad.simulation.movement as moving
from garmentcad.arrays import floats, indices
from garmentcad.check.hardware import check_hardware
from garmentcad.cloth.lattice import build_cloth, rectangle_cloth
from garmentcad.cloth.state import State
from garmentcad.cloth.weld import weld
from garmentcad.constraints.points import ConstraintPoints, PointRows
from garmentcad.contact.contact import Contact
from garmentcad.contact.path import BodyPath
from garmentcad.errors import SpecError
from garmentcad.forces.assembly import ForceAssembly
from garmentcad.forces.internal import internal_forces
from garmentcad.io.fabric_file import load_fabric
from garmentcad.io.shipped import resolve_reference
from garmentcad.mannequin.mannequin import ArrangementCylinder, Mannequin
from garmentcad.pattern.draft import draft
from garmentcad.pattern.outfit import below, put_on
from garmentcad.pattern.parse import parse_spec
from garmentcad.placement.place import place_vertices
from garmentcad.simulation import keeper, lattices
from garmentcad.simulation.checkpoint import load_state
from garmentcad.simulation.job import Job
from garmentcad.simulation.materials import lay_out
from garmentcad.simulation.record import record
from garmentcad.simulation.run import Outcome, run
from garmentcad.simulation.sewing import held_from_the_start
from garmentcad.solve.dynamics import Dynamics
from garmentcad.solve.hardware import button_shanks, hardware_rows, redundances
from garmentcad.solve.strain_limit import strain_limit

RADIUS, HEIGHT = 0.12, 0.6


def cylinder() -> Mannequin:
    """A round body with its axis along y, in rings of 40 mm."""
    rings = np.linspace(0.0, HEIGHT, 16)
    line = np.vstack([[0.0, 0.0], np.column_stack([np.full(16, RADIUS), rings]), [0.0, HEIGHT]])
    mesh = trimesh.creation.revolve(line, sections=96)
    vertices, up, ref = np.asarray(mesh.vertices)[:, [1, 2, 0]], np.array([0.0, 1.0, 0.0]), np.array([0.0, 0.0, 1.0])
    faces = indices(mesh.faces)
    girth = 2000.0 * math.pi * RADIUS
    sizes = {"bust": girth, "waist": girth, "hip": girth, "bust_height": 500.0, "waist_height": 400.0, "hip_height": 300.0}
    marks = {"front": np.array([0.0, 0.4, RADIUS]), "inside": np.array([0.0, 0.4, 0.0])}
    torso = ArrangementCylinder(np.zeros(3), up, ref, RADIUS, RADIUS)
    return Mannequin("cylinder", floats(vertices), faces, sizes, marks, {"torso": torso}, ("torso",), np.zeros(len(faces), dtype=np.int32))


BODY = cylinder()
# Two halves of a tube; seams at centre back, and at centre front where the spec says so.
TUBE: dict[str, Any] = {
    "name": "tube", "fabric": "wool-suiting", "mannequin": "cylinder",
    "values": {"half": "waist / 2 + 2", "lap": 0.0},
    "panels": {
        "left": {
            "points": {
                "back_low": ["-half", 0], "front_low": ["lap", 0], "front_top": ["lap", 120], "back_top": ["-half", 120],
                "belt_back": ["-half", 60], "belt_front": ["lap", 60],
            },
            "edges": [
                {"name": "hem", "from": "back_low", "to": "front_low", "role": "hem"}, {"name": "front", "from": "front_low", "to": "front_top"},
                {"name": "top", "from": "front_top", "to": "back_top", "role": "waist"}, {"name": "back", "from": "back_top", "to": "back_low"},
            ],
            "drill_holes": {"low": [0, 30], "high": [0, 90], "centre": ["-half / 2", 60]},
            "placement": {"wrap": {"part": "torso", "anchor": ["-half / 2", 0], "angle": 270, "height": 250, "offset": 12}},
        },
        "right": {"mirrored_from": "left", "placement": {"wrap": {"part": "torso", "anchor": ["half / 2", 0], "angle": 90, "height": 250, "offset": 12}}},
    },
    "seams": [{"name": "back", "a": ["left.back.back_top", "left.back.back_low"], "b": ["right.back.back_top", "right.back.back_low"]}],
}  # fmt: skip
FRONT = {"name": "front", "a": ["left.front.front_top", "left.front.front_low"], "b": ["right.front.front_top", "right.front.front_low"]}
PEGS = [{"name": "peg_left", "at": "left.back_top", "point": [0, 370, -135]}, {"name": "peg_front", "at": "left.front_top", "point": [0, 370, 135]}]


def job(change: Callable[[dict[str, Any]], Any] = lambda data: None, grid_mm: float = 20.0, max_time_s: float = 12.0) -> Job:
    data = copy.deepcopy(TUBE)
    change(data)
    spec = parse_spec(data)
    pattern = draft(spec, BODY.measurements_mm)
    fabric = load_fabric(resolve_reference(pattern.fabric, "fabrics", Path()))
    return Job(spec, pattern, {pattern.fabric: fabric}, BODY, grid_mm, max_time_s=max_time_s)


def closed(**more: Any) -> Callable[[dict[str, Any]], Any]:
    """The tube sewn in front too, and more keys of the spec."""
    return lambda data: data.update(seams=[*data["seams"], FRONT], **more)


def draped(made: Job) -> Outcome:
    return run(made, lambda progress: None)


RING = [["right.belt_front", "right.belt_back"], ["left.belt_back", "left.belt_front"]]  # 758 mm


@pytest.mark.parametrize(
    ("more", "key", "message"),
    [
        ({"pins": [{"name": "p", "at": "left.lowe", "point": [0, 0, 0]}]}, "pins.0.at", "no point and no drill hole 'lowe'; did you mean 'low'?"),
        ({"pins": [{"name": "p", "at": "lift.low", "point": [0, 0, 0]}]}, "pins.0.at", "no panel is called 'lift'; did you mean 'left'?"),
        ({"pins": [{"name": "p", "at": "left.low"}]}, "pins.0", "exactly one of point, landmark is wanted"),
        ({"pins": [{"name": "p", "at": "left", "point": [0, 0, 0]}]}, "pins.0.at", "written panel.point"),
        ({"pins": [{"name": "p", "at": "left.low", "point": [0, 0, 0], "offset": [0, 0, 1]}]}, "pins.0.offset", "belongs to a landmark"),
        ({"pins": [{"name": "back", "at": "left.low", "point": [0, 0, 0]}]}, "pins.0.name", "the name 'back' is given twice"),
        ({"closures": [{"name": "b", "button": "left.low", "buttonhole": "left.low"}]}, "closures.0", "are the same point"),
        ({"closures": [{"name": "b", "button": "left.low"}]}, "closures.0.buttonhole", "missing"),
        ({"closures": [{"name": "z", "zip": {"a": FRONT["a"], "b": FRONT["b"]}, "closed": 2}]}, "closures.0.closed", "allowed is 0 to 1"),
        ({"closures": [3]}, "closures.0", "a mapping is wanted"),
        ({"elastics": [{"name": "e", "along": [["left.low", "left.top.back_top"]], "ratio": 0.8, "stiffness": 9}]}, "elastics.0.along.0", "both"),
        ({"elastics": [{"name": "e", "along": [["left.low", "right.low"]], "ratio": 0.8, "stiffness": 9}]}, "elastics.0.along.0", "points of one panel"),
        ({"elastics": [{"name": "e", "along": [*RING, RING[0][::-1]], "ratio": 1, "stiffness": 9}]}, f"elastics.0.along.{len(RING)}", "is given twice"),
        ({"elastics": [{"name": "e", "along": [], "ratio": 0.8, "stiffness": 9}]}, "elastics.0.along", "at least 1"),
        ({"belts": [{"name": "b", "along": [["left.low", "left.high"]], "length": 0, "stiffness": 9}]}, "belts.0.length", "larger than 0"),
    ],
)  # fmt: skip
def test_what_is_wrong_is_refused_by_its_place(more: dict[str, Any], key: str, message: str) -> None:
    with pytest.raises(SpecError, match=r".*") as caught:
        job(lambda data: data.update(more))
    assert caught.value.key == key
    assert message in caught.value.message


@pytest.mark.parametrize(
    ("more", "codes"),
    [
        ({"pins": [{"name": "p", "at": "left.centre", "point": [-140, 310, 0]}]}, []),
        ({"pins": [{"name": "p", "at": "left.centre", "landmark": "inside"}]}, []),
        ({"pins": [{"name": "p", "at": "left.centre", "point": [0, 31, 0]}]}, [("error", "pin-inside-body", "pins.p.point")]),
        ({"pins": [{"name": "p", "at": "left.centre", "point": [-115, 310, 0]}]}, [("warning", "pin-inside-body", "pins.p.point")]),
        ({"pins": [{"name": "p", "at": "left.centre", "point": [-140, 3100, 0]}]}, [("warning", "pin-far", "pins.p.point")]),
        ({"pins": [{"name": "p", "at": "left.centre", "landmark": "inside", "offset": [0, 900, 0]}]}, [("warning", "pin-far", "pins.p.landmark")]),
        *(  # the ends of the upper edge, at z -131 and 131 as laid, drawn backward and forward
            (
                {"pins": [{"name": f"{name}_pin", "at": f"left.{name}_top", "point": [-30, 380, z]} for name, z in (("back", -way), ("front", way))]},
                [("warning", "pins-crossed", "pins.front_pin")] if way < 0 else [],
            )
            for way in (150, -150)
        ),
        *(
            ({"belts": [{"name": "b", "along": RING, "length": length, "stiffness": 9}]}, [("warning", "belt-length", "belts.b.length")] if wrong else [])
            for length, wrong in (
                (1, True),
                ("waist / 10", True),
                (245, True),
                (260, False),
                ("waist / 2", False),
                ("waist", False),
                (2200, False),
                (2300, True),
                ("10 * waist", True),
            )
        ),
        ({"belts": [{"name": "b", "along": [["left.low", "left.high"]], "length": "waist", "stiffness": 9}]}, []),  # 60 mm of it on the cloth
        ({"elastics": [{"name": "e", "along": RING, "ratio": 0.5, "stiffness": 9}]}, []),
        ({"elastics": [{"name": "e", "along": RING, "ratio": 1, "stiffness": 9}]}, []),
        ({"elastics": [{"name": "e", "along": RING, "ratio": 1.2, "stiffness": 9}]}, [("warning", "elastic-slack", "elastics.e.ratio")]),
        # Drawn out from half its length it pulls its stiffness; 5.9 kPa on 100 mm of a round body of radius 120 mm are 70.8 N.
        ({"elastics": [{"name": "e", "along": RING, "ratio": 0.5, "stiffness": 70}]}, []),
        ({"elastics": [{"name": "e", "along": RING, "ratio": 0.5, "stiffness": 72}]}, [("warning", "elastic-strong", "elastics.e.stiffness")]),
        # Gathered from twice the girth it is drawn out to the girth, here its own length at rest, and no farther.
        ({"values": {"half": "waist", "lap": 0.0}, "elastics": [{"name": "e", "along": RING, "ratio": 0.5, "stiffness": 72}]}, []),
    ],
)
def test_what_is_in_other_units_is_found(more: dict[str, Any], codes: list[tuple[str, str, str]]) -> None:
    made = job(lambda data: data.update(more))
    materials, material_of = lay_out(made)
    cloth = build_cloth(made.pattern, material_of, materials, made.grid_mm)
    found = check_hardware(made.pattern, cloth, place_vertices(made.pattern, cloth, BODY), materials, BODY, "tube.yaml")
    assert [(finding.severity, finding.code, finding.key) for finding in found] == codes


def rows_of(made: Job) -> tuple[PointRows, Any]:
    materials, material_of = lay_out(made)
    cloth, _ = weld(build_cloth(made.pattern, material_of, materials, made.grid_mm))
    return hardware_rows(made.pattern, cloth, materials, made.mannequin), cloth


def test_conflicting_pins_are_refused_with_both_names() -> None:
    """Two hooks for one point; for two points that a seam makes one; two hooks farther apart than the cloth between them is long; an unknown landmark."""
    hook = {"name": "hook", "at": "left.back_top", "point": [0, 370, -135]}
    other = {"name": "nail", "at": "right.back_top", "point": [0, 390, -135]}
    for second in ({**other, "at": "left.back_top"}, other):
        with pytest.raises(SpecError, match=r"constraints 'hook' and 'nail' contradict each other.*20\.0 mm"):
            rows_of(job(closed(pins=[hook, second])))
    away = {"name": "far", "at": "left.front_top", "point": [0, 370, 900]}
    with pytest.raises(SpecError, match=r"pins 'hook' and 'far' contradict each other: they are 1035 mm apart, and the cloth between them reaches 4\d\d mm"):
        rows_of(job(closed(pins=[hook, away])))
    with pytest.raises(SpecError, match="no landmark 'frond'; did you mean 'front'"):
        rows_of(job(closed(pins=[{"name": "p", "at": "left.front_top", "landmark": "frond"}])))
    pins = [hook, {**other, "at": "right.front_low", "point": [50, 370, -135]}]
    with pytest.raises(SpecError, match="'hook', 'nail' and 'button' contradict each other"):
        rows_of(job(lambda data: data.update(pins=pins, closures=[{"name": "button", "button": "left.back_top", "buttonhole": "right.front_low"}])))


def test_redundant_pins_are_named_and_solved() -> None:
    twin = {"name": "twin", "at": "right.front_top", "point": [0, 370, 135]}
    made = job(closed(pins=[*PEGS, twin], values={"half": "waist / 2 + 30", "lap": 0.0}), grid_mm=30.0)
    rows, cloth = rows_of(made)
    assert [found.names for found in redundances(rows, cloth, BODY)] == [("peg_front", "twin")]
    outcome = draped(made)
    assert outcome.status == "converged"
    told, _ = record(outcome)
    assert max(told.constraints["gap_mm"].values()) < 1e-6  # type: ignore[attr-defined]
    assert any("'peg_front' and 'twin' hold the same points" in warning for warning in told.warnings)


@pytest.mark.parametrize(
    ("wrap", "inside"),
    [
        ({"offset": 22}, None),
        ({"offset": 4}, 8),
        ({"offset": 4, "angle": 180}, None),  # a quarter of a turn away nothing is known, though the hole lies deeper seen from the button
        ({"offset": 4, "height": 100}, 8),  # 150 mm below its button
        ({"offset": 22, "height": 100}, None),
        ({"angle": 110, "height": 100}, None),  # on one round layer with it, 46 mm to the side as well
        ({"offset": 4, "height": -100}, None),  # 350 mm below it
    ],
)
def test_a_buttonhole_inside_its_button(wrap: dict[str, float], inside: float | None) -> None:
    """The button's panel starts 12 mm outside the cylinder; both drill holes lie on the middle of the front."""

    def button(data: dict[str, Any]) -> None:
        data["panels"]["right"]["placement"]["wrap"] |= wrap
        data["values"]["lap"] = 30.0
        data["closures"] = [{"name": "low", "button": "left.low", "buttonhole": "right.low"}]

    made = job(button)
    materials, material_of = lay_out(made)
    flat = build_cloth(made.pattern, material_of, materials, made.grid_mm)
    found = list(check_hardware(made.pattern, flat, place_vertices(made.pattern, flat, BODY), materials, BODY, "tube.yaml"))
    assert [(finding.severity, finding.code, finding.key) for finding in found] == [("warning", "button-inside", "closures.low")] * (inside is not None)
    assert all(f"right.low starts {inside} mm inside its button left.low" in finding.message for finding in found)


def test_a_button_on_a_sewn_corner_holds_nothing_and_is_told() -> None:
    made = job(lambda data: data.update(closures=[{"name": "button", "button": "left.back_top", "buttonhole": "right.back_top"}]), grid_mm=30.0)
    materials, material_of = lay_out(made)
    flat = build_cloth(made.pattern, material_of, materials, 30.0)
    (finding,) = check_hardware(made.pattern, flat, place_vertices(made.pattern, flat, BODY), materials, BODY)
    assert (finding.severity, finding.code, finding.remedy) == ("warning", "redundant-constraints", "Leave it out, or move one of its points.")
    assert finding.message == "button and buttonhole of 'button' are one point once the seams are closed: it holds nothing"


def test_hardware_that_a_run_would_refuse_is_an_error_of_the_check() -> None:
    made = job(lambda data: data.update(pins=[{"name": "p", "at": "left.low", "landmark": "frond"}]), grid_mm=30.0)
    materials, material_of = lay_out(made)
    flat = build_cloth(made.pattern, material_of, materials, 30.0)
    (finding,) = check_hardware(made.pattern, flat, place_vertices(made.pattern, flat, BODY), materials, BODY, "tube.yaml")
    assert (finding.severity, finding.file) == ("error", "tube.yaml")
    assert "no landmark 'frond'; did you mean 'front'" in finding.message


def test_a_pin_to_a_landmark_stands_clear_of_the_body() -> None:
    """A landmark inside the body, and one on it, hold the cloth at the gap that contact keeps; an offset beyond it holds as it is."""
    for mark, offset, distance in (("front", 0.0, None), ("inside", 0.0, None), ("front", 20.0, 0.020)):
        made = job(closed(pins=[{"name": "p", "at": "left.front_top", "landmark": mark, "offset": [0, 0, offset]}]))
        rows, cloth = rows_of(made)
        nodes, weights = rows.particle[3:] - cloth.particle_count, -rows.weight[3:]
        place = rows.targets[0] + weights @ BODY.vertices[nodes]
        away = math.hypot(place[0], place[2]) - RADIUS
        assert away == pytest.approx(distance, abs=2e-4) if distance is not None else 1e-3 <= away < 3e-3


def test_a_pin_rides_on_a_body_that_moves() -> None:
    """A sheet pinned to a plate that is raised by 50 mm and makes a quarter turn comes along to a hundredth of a millimetre and stays."""
    high = 0.009  # above the plate: farther than contact holds it off
    made = job()
    materials, _ = lay_out(made)
    cloth = rectangle_cloth(100.0, 100.0, 20.0, 0.0, materials)
    plate = trimesh.creation.box(extents=(0.5, 0.02, 0.5)).subdivide().subdivide().subdivide()
    frames = []
    for share in (0.0, 0.02, 0.25, 0.5, 0.75, 0.98, 1.0):
        matrix = trimesh.transformations.rotation_matrix(0.5 * math.pi * share, [0.0, 1.0, 0.0])
        matrix[1, 3] = 0.05 * share
        frames.append(trimesh.transform_points(plate.vertices, matrix))
    path = BodyPath(0.4 * np.array([0.0, 0.05, 0.3, 0.5, 0.7, 0.95, 1.0]), np.array(frames))
    positions = np.column_stack([cloth.vertex_uv_mm[:, 0] / 1000.0 + 0.02, np.full(cloth.particle_count, 0.019), cloth.vertex_uv_mm[:, 1] / 1000.0 + 0.02])
    contact = Contact(cloth, materials, (np.asarray(plate.vertices), np.asarray(plate.faces)), path=path)
    dynamics = Dynamics(cloth, ForceAssembly(internal_forces(cloth, materials), cloth.particle_count), strain_limit(cloth, materials), contact)
    face = np.asarray(plate.faces)[int(np.argmax(plate.face_normals[:, 1]))]
    corner = cloth.edge_vertices["rectangle.bottom"][[0, -1]]
    weights = trimesh.triangles.points_to_barycentric(np.tile(plate.vertices[face], (2, 1, 1)), positions[corner] - [0.0, high, 0.0])
    rows = PointRows.plain(
        np.repeat([0, 1], 4), np.concatenate([[p, *(cloth.particle_count + face)] for p in corner]), np.column_stack([np.ones(2), -weights]).ravel(),
        np.array([[0.0, high, 0.0]] * 2), ("a", "b"),
    )  # fmt: skip
    dynamics.constraint = ConstraintPoints(rows, dynamics.inverse_masses, 40.0, nodes=contact.nodes)
    state = State(positions, np.zeros_like(positions), constraint_speeds=np.zeros((2, 3)), constraint_forces=np.zeros((2, 3)))
    start = positions[corner].copy()
    dynamics.start(state)
    worst = 0.0
    while state.time_s < 0.45:
        dynamics.advance(state, 96)
        worst = max(worst, float(dynamics.constraint_errors(state)[0].max()))
    assert worst < 1e-5
    assert state.positions[corner] == pytest.approx(start[:, [2, 1, 0]] * [1.0, 1.0, -1.0] + [0.0, 0.05, 0.0], abs=1e-5)
    assert np.abs(state.velocities[corner]).max() < 1e-3


def placket(data: dict[str, Any]) -> None:
    """The tube, tight enough to stay up, laps over itself in front by 30 mm and has two buttons there, of which the upper one closes after the seam; the right
    half lies over the left one."""
    data["values"] |= {"half": "waist / 2 - 2", "lap": 15.0}
    data["panels"]["right"]["placement"]["wrap"]["offset"] = 22
    data["closures"] = [{"name": name, "button": f"left.{name}", "buttonhole": f"right.{name}", "order": order} for name, order in (("low", 1), ("high", 2))]


def test_buttons_hold_to_a_tenth_of_a_millimetre_and_the_placket_closes() -> None:
    """The distance from button to hole is measured here, on the panels: nothing along the cloth, and at most cloth and thread off it, on its right side."""
    outcome = draped(job(placket))
    told, _ = record(outcome)
    assert told.status == "converged"
    assert told.self_intersections == 0
    assert max(told.constraints["gap_mm"].values()) < 0.1  # type: ignore[attr-defined]
    cloth, positions = outcome.cloth, outcome.state.positions
    for hole in ("low", "high"):
        place = []
        for name in ("left", "right"):
            panel = cloth.panel_names.index(name)
            uv = np.array(outcome.job.pattern.panels[name].drill_holes[hole])
            mine = cloth.triangles[cloth.vertex_panel[cloth.triangles[:, 0]] == panel]
            corners = np.concatenate([cloth.vertex_uv_mm[mine], np.zeros((len(mine), 3, 1))], axis=2)
            weights = trimesh.triangles.points_to_barycentric(corners, np.tile([*uv, 0.0], (len(mine), 1)))
            best = int(np.argmax(weights.min(axis=1)))
            at = positions[cloth.vertex_particle[mine[best]]]
            place.append((weights[best] @ at, np.cross(at[1] - at[0], at[2] - at[0])))
        apart, normal = place[1][0] - place[0][0], place[0][1] / np.linalg.norm(place[0][1])
        assert np.linalg.norm(apart - apart @ normal * normal) < 1e-4
        assert 0.8e-3 < apart @ normal < 2.3e-3
    around_hole = button_shanks(outcome.job.pattern, cloth, outcome.materials).particles[1, 1]
    positions[around_hole] -= 3e-3 * normal
    found = [warning for warning in record(outcome)[0].warnings if "not done up" in warning]
    assert len(found) == 1
    assert "button 'high'" in found[0]


def test_buttons_and_an_elastic_go_with_a_body_that_turns(monkeypatch: pytest.MonkeyPatch) -> None:
    """The tube with its placket and an elastic at its waist on a body that turns by 30 degrees in 0.6 s: it goes along, and nothing comes undone."""
    elastic = {"name": "waist", "along": [["right.top.back_top", "right.top.front_top"]], "ratio": 0.9, "stiffness": 20}
    outcome = draped(job(lambda data: placket(data) or data.update(elastics=[elastic])))
    times = np.linspace(0.0, 0.6, 7)
    turns = [trimesh.transformations.rotation_matrix(math.radians(30.0) * share, [0, 1, 0])[:3, :3] for share in 0.5 - 0.5 * np.cos(np.pi * times / 0.6)]
    monkeypatch.setattr(moving, "motion", lambda body, frames: (times, np.array([body.vertices @ turn.T for turn in turns])))
    movement = moving.move(outcome, [], lambda progress: None)
    assert (movement.status, movement.warning) == ("moved", None)
    forces = {type(force).__name__: force for force in outcome.dynamics.forces.forces}
    assert forces["ForceButton"].gaps(movement.state.positions).max() < 1e-4
    assert forces["ForceBand"].tensions(movement.state.positions) == pytest.approx(forces["ForceBand"].tensions(outcome.state.positions), rel=0.2)
    start, end = (np.arctan2(shape[:, 0], shape[:, 2]) for shape in (outcome.state.positions, movement.state.positions))
    assert np.degrees(np.median(np.angle(np.exp(1j * (end - start))))) == pytest.approx(30.0, abs=3.0)


def test_what_fell_and_what_does_not_hold_is_said() -> None:
    """A tube too wide for its body falls past it, and the run ends there; a pin whose point lies 20 mm inside is kept off by contact."""

    def wide(data: dict[str, Any]) -> None:
        closed()(data)
        data["values"]["half"] = "waist / 2 + 60"
        for half in ("left", "right"):
            data["panels"][half]["placement"]["wrap"]["offset"] = 30

    fell = draped(job(wide, grid_mm=30.0))
    assert (fell.status, fell.state.positions[:, 1].max() < 0.0) == ("max_time", True)
    assert record(fell)[0].warnings == ("the garment fell off: all of it is below the body, and the run ended there",)
    pinned = record(draped(job(closed(pins=[{"name": "p", "at": "left.centre", "point": [-100, 310, 0]}]), grid_mm=30.0, max_time_s=3.0)))[0]
    (said,) = [warning for warning in pinned.warnings if warning.startswith("pin")]
    assert said.startswith("pin 'p' does not hold: its point is 2")
    assert pinned.constraints["gap_mm"]["p"] > 20.0


def test_what_is_worn_stays_done_up_while_more_is_put_on() -> None:
    """Rows of the garment below, of whatever order, hold from the first seams of the one above on; those above keep their own."""
    over = {"name": "over", "button": "outer-left.low", "buttonhole": "outer-right.low", "order": 2}
    specs = [copy.deepcopy(TUBE), copy.deepcopy(TUBE)]
    placket(specs[0])
    placket(specs[1])
    specs[1]["closures"] = [{**over, "button": "left.low", "buttonhole": "right.low"}]
    for spec, name in zip(specs, ("inner", "outer")):
        spec["name"] = name
    read = [parse_spec(spec) for spec in specs]
    pattern = put_on("both", [draft(spec, BODY.measurements_mm) for spec in read], "cylinder")
    fabric = load_fabric(resolve_reference("wool-suiting", "fabrics", Path()))
    fabrics = dict.fromkeys([pattern.fabric, *(panel.fabric or pattern.fabric for panel in pattern.panels.values())], fabric)
    made = Job(read[0], pattern, fabrics, BODY, 30.0, worn=tuple(read))
    materials, material_of = lay_out(made)
    cloth = build_cloth(pattern, material_of, materials, 30.0)
    rows = hardware_rows(pattern, cloth, materials, BODY)
    held = held_from_the_start(rows, cloth, below(pattern).panels)
    names = np.array(held.names)
    assert set(rows.order[names == "inner-high"]) == {2.0}
    assert set(held.order[names == "inner-high"]) == {1.0}
    assert set(held.order[names == "outer-over"]) == {2.0}


def everything(data: dict[str, Any]) -> None:
    """Buttons, a pin to the body, an elastic and a belt, and folds to press: all that a State has to carry."""
    placket(data)
    data["pins"] = [{"name": "nape", "at": "left.back_top", "point": [0, 370, -124]}]
    data["elastics"] = [{"name": "waist", "along": [["left.top.front_top", "left.top.back_top"]], "ratio": 0.95, "stiffness": 20}]
    data["belts"] = [
        {"name": "belt", "along": [["left.belt_front", "left.belt_back"], ["right.belt_back", "right.belt_front"]], "length": 760, "stiffness": 500}
    ]


class Stopped(Exception):
    pass


def test_same_bits_for_two_threads_and_after_a_checkpoint(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """At 20 mm with 40 mm before it, so that states go through weld, and from lattice to lattice."""
    monkeypatch.setattr(lattices, "COARSEST_MM", 40.0)
    monkeypatch.setattr(lattices, "FEWEST_CELLS", 1.0)
    monkeypatch.setattr(keeper, "CHECKPOINT_EVERY_S", 0.0)
    made = job(everything, max_time_s=1.8)
    found = []
    for threads in (1, 2):
        numba.set_num_threads(threads)
        found.append(draped(made).state)
    assert found[0].sha256() == found[1].sha256()
    for phase, least in (("close", 0.3), ("fall", 1.3)):
        path = tmp_path / f"{phase}.npz"

        def stop(progress: Any, phase: str = phase, least: float = least) -> None:
            if progress.phase == phase and progress.time_s > least:
                raise Stopped

        with pytest.raises(Stopped):
            run(made, stop, path)
        assert load_state(path).constraint_speeds.any()
        resumed = run(made, lambda progress: None, path, resume=True).state
        assert resumed.sha256() == found[0].sha256()
        assert np.array_equal(resumed.constraint_speeds, found[0].constraint_speeds)
