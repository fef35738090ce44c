"""The stress set of contact: nine scenes that are hard on it, in true dynamics, judged at every frame by ipctk, libigl and an exact count.

`python -m tools.stress_study` writes docs/studies/contact-stress.md, `python -m tools.stress_study TEXT` runs only scenes with TEXT in their name. The tests
play the scenes on coarser lattices.
"""

from __future__ import annotations

import hashlib
import itertools
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import igl
import ipctk
import numpy as np
import trimesh

from garmentcad import __version__
from garmentcad.arrays import floats, indices
from garmentcad.bench import cloth_on_ball
from garmentcad.cloth.cloth import Cloth
from garmentcad.cloth.lattice import build_cloth
from garmentcad.cloth.state import State
from garmentcad.cloth.weld import weld
from garmentcad.contact.contact import Contact
from garmentcad.fabric.material import MaterialTable
from garmentcad.forces.assembly import ForceAssembly
from garmentcad.forces.gravity import ForceGravity
from garmentcad.forces.internal import internal_forces
from garmentcad.geometry.curve import Line
from garmentcad.geometry.intersection import crossing_triangle_pairs, crossing_triangle_pairs_between
from garmentcad.io.atomic import write_atomic
from garmentcad.pattern.pattern import Edge, EdgeUse, Panel, Pattern, Seam, Transform
from garmentcad.simulation.course import AIR_DRAG
from garmentcad.simulation.materials import lay_out
from garmentcad.simulation.study import StudyCase, run_study, study_table
from garmentcad.solve.dynamics import DivergedError, Dynamics, IntersectingError
from garmentcad.solve.strain_limit import strain_limit
from garmentcad.units import M_TO_MM, MM_TO_M

FOLDER = Path(__file__).resolve().parent.parent / "docs" / "studies"
GRID_MM = 10.0
THICKNESS_M = 1e-3  # the least gap that contact knows
FRAME_S = 0.01
PATH_S = 1e-3  # clamps go straight for so long
WATCHED_STEPS = 200  # in a row that the continuous test judges
JITTER_M = 1e-5  # of the start: no fold is decided by round-off
Mesh = tuple[np.ndarray, np.ndarray]
Row = dict[str, Any]


class Scene(NamedTuple):
    """A cloth in the air or in clamps. positions, velocities (P,3) at the start; body: vertices m and faces; watched_s: when the continuous test begins.

    held: (P,) bool, particles in clamps; path(seconds): their places (K,3) m.
    """

    cloth: Cloth
    materials: MaterialTable
    positions: np.ndarray
    velocities: np.ndarray
    seconds: float
    watched_s: float
    body: Mesh | None = None
    held: np.ndarray | None = None
    path: Callable[[float], np.ndarray] | None = None


class Judge:
    """What is true of places of the cloth (P,3); nothing of it is the solver's."""

    def __init__(self, scene: Scene) -> None:
        self._triangles, self._body = scene.cloth.particle_triangles, scene.body
        faces = self._triangles
        if self._body is not None:
            faces = np.concatenate([faces, self._body[1] + scene.cloth.particle_count])
        self._mesh = ipctk.CollisionMesh(self._all(scene.positions), ipctk.edges(faces), faces)

    def intersects(self, positions: np.ndarray) -> bool:
        """Any intersection of cloth with cloth or body, by ipctk."""
        return bool(ipctk.has_intersections(self._mesh, self._all(positions)))

    def crossings(self, positions: np.ndarray) -> int:
        """Pairs of crossing triangles, by the exact count."""
        count = len(crossing_triangle_pairs(positions, self._triangles))
        return count + (0 if self._body is None else len(crossing_triangle_pairs_between(positions, self._triangles, *self._body)))

    def depth_mm(self, positions: np.ndarray) -> float | None:
        """Greatest depth in the body at particles and at three points of each triangle, by libigl; None without a body."""
        if self._body is None:
            return None
        corners = positions[self._triangles]
        inner = [np.einsum("k,fkx->fx", np.roll([2 / 3, 1 / 6, 1 / 6], k), corners) for k in range(3)]
        distances = igl.signed_distance(np.concatenate([positions, *inner]), *self._body)[0]
        return M_TO_MM * max(0.0, -float(distances.min()))

    def passes(self, before: np.ndarray, after: np.ndarray) -> bool:
        """Whether anything passes through anything on the straight way between two places, by ipctk's continuous test."""
        return not ipctk.is_step_collision_free(self._mesh, self._all(before), self._all(after))

    def _all(self, positions: np.ndarray) -> np.ndarray:
        return positions if self._body is None else np.concatenate([positions, self._body[0]])


class Player:
    """Moves the cloth of a scene: true masses, air drag, clamps on their path."""

    def __init__(self, scene: Scene) -> None:
        cloth, self._scene = scene.cloth, scene
        forces = ForceAssembly(internal_forces(cloth, scene.materials), cloth.particle_count, [ForceGravity(cloth.masses)])
        contact = Contact(cloth, scene.materials, scene.body)
        self.dynamics = Dynamics(cloth, forces, strain_limit(cloth, scene.materials), contact, scene.held)
        self.dynamics.drag = AIR_DRAG
        self.state = State(scene.positions.copy(), scene.velocities.copy())
        self.dynamics.start(self.state)

    def play(self, until_s: float) -> None:
        """On to a time."""
        while self.state.time_s < until_s:
            self.dynamics.advance(self.state, self._clamp(until_s))

    def step_by_step(self, steps: int) -> list[np.ndarray]:
        """The next steps, one by one: the places before and after each."""
        places = [self.state.positions.copy()]
        while len(places) <= steps:
            for _ in range(min(self._clamp(np.inf), steps + 1 - len(places))):
                self.dynamics.advance(self.state, 1)
                places.append(self.state.positions.copy())
        return places

    def _clamp(self, until_s: float) -> int:
        """Send the clamps along their path; for how many steps."""
        scene, state = self._scene, self.state
        self.dynamics.estimate_time_step(state)
        steps = max(1, round(min(PATH_S, until_s - state.time_s) / state.time_step_s))
        if scene.path is not None:
            ahead = steps * state.time_step_s
            state.velocities[scene.held] = (scene.path(state.time_s + ahead) - state.positions[scene.held]) / ahead
        return steps


def judged(scene: Scene, watched_steps: int = WATCHED_STEPS, frame_s: float = FRAME_S) -> Row:
    """Play a scene to its end and judge every frame. A run that contact or the stepper gives up ends there, with the reason as its status."""
    judge, player = Judge(scene), Player(scene)
    state, dynamics = player.state, player.dynamics
    frames, bad, crossings, fastest, wall, passed = 0, 0, 0, 0.0, 0.0, 0
    depths: list[float | None] = []
    status = "done"
    watched: list[np.ndarray] = []
    while status == "done" and state.time_s < scene.seconds:
        began = time.perf_counter()
        try:
            if not watched and state.time_s >= scene.watched_s:
                watched = player.step_by_step(watched_steps)
            player.play(min(scene.seconds, frame_s * (1 + frames)))
        except (DivergedError, IntersectingError) as error:
            status = f"{error.status}: {error}"
        wall += time.perf_counter() - began
        frames += 1
        bad += judge.intersects(state.positions)
        crossings += judge.crossings(state.positions)
        depths.append(judge.depth_mm(state.positions))
        fastest = max(fastest, dynamics.measures(state)[1])
    for before, after in itertools.pairwise(watched):
        passed += judge.passes(before, after)
    return {
        "status": status,
        "particles": scene.cloth.particle_count,
        "simulated_s": float(state.time_s),
        "steps": state.step,
        "frames": frames,
        "intersecting_frames": bad,
        "crossings": crossings,
        "depth_mm": None if depths[0] is None else max(depth for depth in depths if depth is not None),
        "cut_steps": dynamics.cut_steps,
        "watched_steps": max(0, len(watched) - 1),
        "watched_passed": passed,
        "fastest_m_s": fastest,
        "wall_s": wall,
    }


def fabric(friction: float, *areal_masses: float) -> MaterialTable:
    """The linear laws of workload W1, 1 mm thick. One row for each areal mass (kg/m2); none: that of W1."""
    table, _ = lay_out(cloth_on_ball.cloth_on_ball())
    masses = floats(areal_masses or table.areal_mass)
    table = MaterialTable(*(np.repeat(column, len(masses), axis=0) for column in table))
    rows = np.ones(len(masses))
    return table._replace(areal_mass=masses, thickness=THICKNESS_M * rows, friction_body=friction * rows, friction_cloth=friction * rows)


def rectangles(sizes_mm: list[tuple[float, float]], grid_mm: float, materials: MaterialTable, tube: bool = False, grain_deg: float = 0.0) -> Cloth:
    """Rectangles (width, height), each a panel with the material row of its number (or the last one); the grain turns by `grain_deg` from panel to panel.
    tube: both upright sides of each are sewn together."""
    panels = {}
    for number, (width, height) in enumerate(sizes_mm):
        corners = [(0.0, 0.0), (width, 0.0), (width, height), (0.0, height)]
        edges = tuple(Edge(f"e{k}", f"p{k}", f"p{(k + 1) % 4}", Line(corners[k], corners[(k + 1) % 4])) for k in range(4))
        panels[f"panel{number}"] = Panel(f"panel{number}", edges, number * grain_deg, Transform((0.0, 0.0, 0.0), (0.0, 0.0, 0.0)))
    seams = tuple(Seam(name, (EdgeUse(name, 1, False),), (EdgeUse(name, 3, True),)) for name in panels if tube)
    row = {name: min(number, len(materials.areal_mass) - 1) for number, name in enumerate(panels)}
    pattern = Pattern("stress", panels, seams, "", "", {}, {})
    return weld(build_cloth(pattern, lambda panel, points: np.full(len(points), row[panel.name], dtype=np.int32), materials, grid_mm))[0]


def on_pattern(cloth: Cloth) -> tuple[np.ndarray, np.ndarray]:
    """Of every particle its place on its panel, from the middle, m, and the panel."""
    uv, panel = np.empty((cloth.particle_count, 2)), np.empty(cloth.particle_count, dtype=int)
    for number in range(len(cloth.panel_names)):
        chosen = cloth.vertex_panel == number
        of_panel = cloth.vertex_uv_mm[chosen]
        uv[cloth.vertex_particle[chosen]] = MM_TO_M * (of_panel - 0.5 * of_panel.max(axis=0))
        panel[cloth.vertex_particle[chosen]] = number
    return uv, panel


def level(cloth: Cloth, x: float, y: float, z: float) -> np.ndarray:
    """All panels laid level, right side up, with their middles at a place, m."""
    uv, _ = on_pattern(cloth)
    return np.column_stack([uv[:, 0] + x, np.full(len(uv), y), z - uv[:, 1]])


def upright_tube(cloth: Cloth) -> np.ndarray:
    """One sewn panel as a round tube about the y axis, from -height/2 to height/2, right side out."""
    uv, _ = on_pattern(cloth)
    around = 2.0 * uv[:, 0].max()
    angle, radius = 2.0 * np.pi * uv[:, 0] / around, around / (2.0 * np.pi)
    return np.column_stack([radius * np.sin(angle), uv[:, 1], radius * np.cos(angle)])


def scene(
    cloth: Cloth, materials: MaterialTable, positions: np.ndarray, seconds: float, watched_s: float, velocity: tuple[float, ...] = (0.0, 0.0, 0.0), **given: Any
) -> Scene:
    """A scene whose particles all begin with `velocity`, m/s, a little off their places unless they are held."""
    jitter = JITTER_M * np.random.default_rng(0).standard_normal(positions.shape)
    if "held" in given:
        jitter[given["held"]] = 0.0
    return Scene(cloth, materials, floats(positions + jitter), floats(np.tile(velocity, (len(positions), 1))), seconds, watched_s, **given)


def ball(radius_m: float, center: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> Mesh:
    mesh = trimesh.creation.icosphere(subdivisions=4, radius=radius_m)
    return floats(mesh.vertices + np.array(center)), indices(mesh.faces)


def slide_off(grid_mm: float) -> Scene:
    """A sheet falls on a ball that stands off its middle, and slides off."""
    materials = fabric(0.05)
    cloth = rectangles([(500.0, 500.0)], grid_mm, materials)
    return scene(cloth, materials, level(cloth, 0.0, 0.156, 0.0), 0.9, 0.4, body=ball(0.15, (0.1, 0.0, 0.04)))


def needle(grid_mm: float) -> Scene:
    """A sheet falls on the tip of a slender cone."""
    cone = trimesh.creation.cone(radius=0.012, height=0.2, sections=12)
    body = floats(cone.vertices[:, [1, 2, 0]]), indices(cone.faces)
    materials = fabric(0.3)
    cloth = rectangles([(400.0, 400.0)], grid_mm, materials)
    return scene(cloth, materials, level(cloth, 0.0137, 0.22, 0.0083), 0.6, 0.2, body=body)


def box_edge(grid_mm: float) -> Scene:
    """A sheet falls on the upper edge of a box that stands on its edge."""
    box = trimesh.creation.box(extents=(0.2, 0.2, 0.3))
    box.apply_transform(trimesh.transformations.rotation_matrix(np.pi / 4, [0, 0, 1]))
    materials = fabric(0.2)
    cloth = rectangles([(400.0, 400.0)], grid_mm, materials)
    positions = level(cloth, 0.01, np.sqrt(0.02) + 0.02, 0.0) @ trimesh.transformations.rotation_matrix(0.3, [0, 1, 0])[:3, :3].T
    return scene(cloth, materials, positions, 0.6, 0.2, body=(floats(box.vertices), indices(box.faces)))


def funnel(grid_mm: float) -> Scene:
    """A sheet drops into a funnel."""
    profile = np.array([[0.03, 0.0], [0.045, 0.0], [0.05, 0.1], [0.32, 0.3], [0.3, 0.3], [0.035, 0.11], [0.03, 0.0]])
    mesh = trimesh.creation.revolve(np.concatenate([finer(profile, 0.02), profile[-1:]]), sections=48)
    vertices = np.asarray(mesh.vertices)[:, [1, 2, 0]]
    materials = fabric(0.1)
    cloth = rectangles([(450.0, 450.0)], grid_mm, materials)
    return scene(cloth, materials, level(cloth, 0.02, 0.32, 0.01), 0.9, 0.5, body=(floats(vertices), indices(mesh.faces)))


def finer(profile: np.ndarray, length: float) -> np.ndarray:
    """Points (N,2) along a line, at most `length` apart, without the last one."""
    parts = [np.linspace(a, b, max(2, int(np.ceil(np.linalg.norm(b - a) / length)) + 1))[:-1] for a, b in itertools.pairwise(profile)]
    return np.concatenate(parts)


def ten_sheets(grid_mm: float) -> Scene:
    """Ten sheets, one above the other, each turned and shifted a little, fall on a ball."""
    materials = fabric(0.3)
    cloth = rectangles([(200.0, 200.0)] * 10, grid_mm, materials, grain_deg=7.0)
    positions, (_, panel) = level(cloth, 0.0, 0.074, 0.0), on_pattern(cloth)
    turn, rng = np.radians(5.0) * panel, np.random.default_rng(1)
    x, z = positions[:, 0], positions[:, 2]
    positions = np.column_stack([x * np.cos(turn) + z * np.sin(turn), positions[:, 1] + 0.0025 * panel, z * np.cos(turn) - x * np.sin(turn)])
    positions[:, [0, 2]] += rng.uniform(-0.01, 0.01, (10, 2))[panel]
    return scene(cloth, materials, positions, 0.4, 0.2, body=ball(0.07))


def twist(grid_mm: float) -> Scene:
    """A tube is twisted by two turns, a turn at each end; the ends come 100 mm nearer to each other meanwhile."""
    materials = fabric(0.3)
    cloth = rectangles([(300.0, 400.0)], grid_mm, materials, tube=True)
    positions = upright_tube(cloth)
    held = np.abs(positions[:, 1]) > 0.2 - 1e-6
    x, height, z = positions[held].T
    radius, angle = np.hypot(x, z), np.arctan2(x, z)

    def path(seconds: float) -> np.ndarray:
        share = min(1.0, seconds)
        turned = angle + 2.0 * np.pi * share * np.sign(height)
        return np.column_stack([radius * np.sin(turned), height * (1.0 - 0.25 * share), radius * np.cos(turned)])

    return scene(cloth, materials, positions, 1.1, 0.7, held=held, path=path)


def sleeve(grid_mm: float) -> Scene:
    """A tube hangs from its upper rim; four points of the lower rim are drawn inwards, then up through the tube and out of it."""
    materials = fabric(0.2)
    cloth = rectangles([(400.0, 350.0)], grid_mm, materials, tube=True)
    positions = upright_tube(cloth)
    top = positions[:, 1] > 0.175 - 1e-6
    low = np.flatnonzero(positions[:, 1] < -0.175 + 1e-6)
    angle = np.arctan2(positions[low, 0], positions[low, 2])
    drawn = low[[np.argmin(np.abs(angle - wanted)) for wanted in np.radians([-135.0, -45.0, 45.0, 135.0])]]
    held = top.copy()
    held[drawn] = True
    start, moving = positions[held], np.isin(np.flatnonzero(held), drawn)

    def path(seconds: float) -> np.ndarray:
        places = start.copy()
        places[moving] *= [1.0 - 0.7 * min(1.0, seconds / 0.2), 1.0, 1.0 - 0.7 * min(1.0, seconds / 0.2)]
        places[moving, 1] += 0.65 * np.clip((seconds - 0.2) / 0.9, 0.0, 1.0)
        return places

    return scene(cloth, materials, positions, 1.15, 0.6, held=held, path=path)


def rubbing(grid_mm: float) -> Scene:
    """A sheet of 1.5 kg/m2 (15 Pa) is drawn to and fro at 2 m/s over another one that lies on a table, held at its ends."""
    materials = fabric(0.3, 0.15, 1.5)
    cloth = rectangles([(600.0, 200.0), (200.0, 160.0)], grid_mm, materials, grain_deg=17.0)
    uv, panel = on_pattern(cloth)
    positions = level(cloth, 0.0, 0.002, 0.0)
    upper = panel == 1
    positions[upper] += [-0.18, 0.0012, 0.0]
    held = np.where(upper, np.abs(uv[:, 0]) > 0.1 - 1e-6, np.abs(uv[:, 0]) > 0.3 - 1e-6)
    start, moving = positions[held], upper[held]
    times, ways = [0.0, 0.02, 0.18, 0.20], [0.0, 0.02, 0.34, 0.36]  # at rest, at 2 m/s, at rest again

    def path(seconds: float) -> np.ndarray:
        turn, rest = divmod(seconds, times[-1])
        way = np.interp(rest, times[1:3], ways[1:3])
        way += (50.0 * min(rest, 0.02) ** 2 - ways[1]) + (ways[1] - 50.0 * min(times[-1] - rest, 0.02) ** 2)
        places = start.copy()
        places[moving, 0] += way if int(turn) % 2 == 0 else ways[-1] - way
        return places

    # Its rims hold cloth off, for a few of its faces inwards: these are small, and the rims far away.
    table = trimesh.creation.box(extents=(1.2, 0.1, 0.8))
    for _ in range(4):
        table = table.subdivide()
    return scene(cloth, materials, positions, 0.6, 0.28, body=(floats(table.vertices - [0.0, 0.05, 0.0]), indices(table.faces)), held=held, path=path)


def fast_drop(grid_mm: float) -> Scene:
    """A sheet meets a ball at 3 m/s."""
    materials = fabric(0.3)
    cloth = rectangles([(500.0, 500.0)], grid_mm, materials)
    return scene(cloth, materials, level(cloth, 0.003, 0.17, 0.007), 0.4, 0.05, velocity=(0.0, -3.0, 0.0), body=ball(0.15))


SCENES: dict[str, Callable[[float], Scene]] = {
    "slides off a ball": slide_off,
    "on a needle": needle,
    "on the edge of a box": box_edge,
    "into a funnel": funnel,
    "ten sheets on a ball": ten_sheets,
    "tube twisted two turns": twist,
    "sleeve through itself": sleeve,
    "sheets rubbing at 2 m/s": rubbing,
    "at 3 m/s on a ball": fast_drop,
}
COLUMNS = {
    "scene": "case",
    "status": "status",
    "particles": "particles",
    "simulated s": "simulated_s:.2f",
    "steps": "steps",
    "frames": "frames",
    "of them intersecting (ipctk)": "intersecting_frames",
    "crossing triangles, sum of frames": "crossings",
    "deepest penetration mm": "depth_mm:.2f",
    "cut steps": "cut_steps",
    "steps tested continuously": "watched_steps",
    "of them with cloth passing through (ipctk)": "watched_passed",
    "fastest in a frame m/s": "fastest_m_s:.1f",
    "wall s": "wall_s:.0f",
}
JUDGES = """Every scene is moved by the stepper in true dynamics: true masses, air drag, weight, clamps on a path where there are any. The fabric has the linear
laws of workload W1 (2000 N/m, 0.15 kg/m2) and is 1 mm thick, the least gap; friction is 0.05 to 0.3.

A frame is judged every 10 ms: whether body and cloth, as one mesh, intersect anywhere (`ipctk.has_intersections`), how many pairs of triangles cross
(`geometry/intersection.py`: exact signs, and no code of the solver's contact), how deep the cloth is in the body (libigl, at particles and at three points of
each triangle). In the middle of the action 200 steps in a row are recorded, and `ipctk.is_step_collision_free` tests the way of all nodes in each of them.

Wall time is that of the motion without the judges, on one thread of a shared machine."""


def main(only: str | None) -> None:
    """Run scenes that have no row yet, and write the page."""

    def case(name: str) -> StudyCase:
        made = SCENES[name](GRID_MM)
        start = [made.positions, made.velocities, made.cloth.particle_triangles, *(made.body or ()), np.array([made.seconds, made.watched_s])]
        digest = hashlib.sha256(b"".join(np.ascontiguousarray(array).tobytes() for array in start)).hexdigest()
        return StudyCase(name, digest, "linear", "-", __version__, {"grid_mm": GRID_MM})

    def run_case(case: StudyCase) -> Row:
        row = judged(SCENES[case.name](GRID_MM))
        print(case.name, row, flush=True)
        return row

    study = run_study("contact-stress", map(case, SCENES), run_case, FOLDER, only=only, say=print)
    table = study_table(study.rows, COLUMNS, "python -m tools.stress_study")
    write_atomic(FOLDER / "contact-stress.md", f"# Stress set of contact\n\n{JUDGES}\n\nLattices of {GRID_MM:g} mm. {table}")


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else None)
