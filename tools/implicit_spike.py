"""The explicit route against an implicit one, on the same forces, from the same state: docs/studies/implicit-spike.md.

    garmentcad drape flared-skirt --fabric wool-suiting --grid 10 --max-time 2.2 -o DIR
    python -m tools.implicit_spike DIR...

The state is that of a garment that has fallen and has not settled. What touches the body is held where it is, and cloth does not see cloth: contact, which
would cost the implicit route more than the explicit one, is given to it for nothing. Both routes run until the residual of true masses is below READY of the
rest test. Implicit: pseudo-transient steps (M/dt^2 + K) dx = f, K v by differences of forces, conjugate gradients preconditioned by the 3 x 3 blocks of the
particles, alone or with a coarse space of the rigid motions (and stretch) of tiles of 4 x 4 particles; dt grows while the residual falls.
"""

from __future__ import annotations

import argparse
import json
import time
from contextlib import suppress
from copy import deepcopy
from pathlib import Path
from typing import Any

import numpy as np
from scipy.sparse import coo_array, csr_array
from scipy.sparse.linalg import splu

from garmentcad.cloth.lattice import build_cloth
from garmentcad.cloth.weld import weld
from garmentcad.contact.contact import Contact
from garmentcad.forces.assembly import ForceAssembly
from garmentcad.forces.bend import CORNERS
from garmentcad.forces.force import NO_PARTICLE
from garmentcad.forces.gravity import ForceGravity
from garmentcad.forces.internal import internal_forces
from garmentcad.io.atomic import write_atomic
from garmentcad.simulation.checkpoint import load_state
from garmentcad.simulation.course import READY, Course, Progress
from garmentcad.simulation.job import make_job
from garmentcad.simulation.materials import lay_out
from garmentcad.solve.dynamics import Dynamics
from garmentcad.solve.rest import RESIDUAL_G, patches, residual
from garmentcad.solve.strain_limit import strain_limit
from garmentcad.units import MM_TO_M

PAGE = Path(__file__).resolve().parent.parent / "docs" / "studies" / "implicit-spike.md"
TILE = 4
NUDGE_M = 1e-7
LARGEST_MOVE_M = 2e-3
FORCING = 0.1  # of the residual of the linear system
VERDICT = (
    "Read so. To go 16 ms the explicit route takes about 170 steps at 10 mm, each with one evaluation of the forces. Conjugate gradients with blocks",
    "alone take several times as many products with K, with tiles about as many, and fewer where steps are longer still; so the coarse space is the lead",
    "that PHYSICS 3 calls it. In this form the implicit route is slower all the same: K is made by differences (a fifth to a tenth of its time), products",
    "run in interpreted sparse code, and contact with friction, whose share of an explicit step is a half, is not in it yet. Drape mode keeps the",
    "explicit route until a compiled implicit one with contact has been tried.",
)
TIME_STEPS_MS = (0.25, 1.0, 4.0, 16.0)


class Problem:
    """Forces, masses and tangent of a garment whose held particles are left out."""

    def __init__(self, folder: Path) -> None:
        report = json.loads((folder / "report.json").read_text())
        job = make_job(report["garment"], report["fabric"], mannequin=report["mannequin"], grid_mm=report["grid_mm"])
        materials, material_of = lay_out(job)
        self.materials = materials
        self.cloth, _ = weld(build_cloth(job.pattern, material_of, materials, job.grid_mm))
        self.state = load_state(folder / "state.npz")
        self.state.velocities[:] = 0.0
        self.fixed = self.state.contact["planes_held"] > 0
        weight = [ForceGravity(self.cloth.masses)]
        self.forces = ForceAssembly(internal_forces(self.cloth, materials), self.cloth.particle_count, weight)
        self.contact = Contact(self.cloth, materials, None, itself=False)
        self.limit = strain_limit(self.cloth, materials)
        self.free = np.flatnonzero(~self.fixed)
        self.name = f"{report['garment']}, {report['fabric']}, {report['grid_mm']:g} mm"
        self.evaluations = 0
        self._still = np.zeros_like(self.state.positions)

    def force(self, positions: np.ndarray) -> np.ndarray:
        total = np.empty_like(positions)
        self.forces.add_up(positions, self._still, total)
        total[self.fixed] = 0.0
        self.evaluations += 1
        return total

    def tangent(self, positions: np.ndarray, at_home: np.ndarray, way: np.ndarray) -> np.ndarray:
        """K times way (P,3)."""
        largest = np.abs(way).max()
        if largest == 0.0:
            return np.zeros_like(way)
        nudge = NUDGE_M / largest
        return (at_home - self.force(positions + nudge * way)) / nudge

    def neighbours(self) -> csr_array:
        """Particles that share an element, with themselves."""
        count, pairs = self.cloth.particle_count, []
        for force, corners in zip(self.forces.forces, (None, 3, CORNERS, 4, 4)):
            if corners is not None:
                rows = force.corners.reshape(-1, corners)
                pairs += [rows[:, [i, j]] for i in range(corners) for j in range(corners)]
        cells, links, bends = self.cloth.cells.corners, self.cloth.links.ends, self.cloth.bends
        pairs += [cells[:, [i, j]] for i in range(4) for j in range(4)] + [links, links[:, ::-1]]
        line = np.column_stack([bends.center, bends.arm_a, bends.arm_b])
        pairs += [line[:, [i, j]] for i in range(line.shape[1]) for j in range(line.shape[1])]
        both = np.concatenate(pairs)
        both = both[(both != NO_PARTICLE).all(axis=1)]
        graph = csr_array((np.ones(len(both)), (both[:, 0], both[:, 1])), shape=(count, count))
        # The strain of a border triangle is a mean over patches, and so depends on all triangles around its corners.
        border = self.cloth.border
        triangles = np.repeat(np.arange(len(border.area)), 3)
        of_patch = csr_array((np.ones(len(triangles)), (triangles, border.patch.ravel())))
        of_particle = csr_array((np.ones(len(triangles)), (triangles, border.corners.ravel())), shape=(len(border.area), count))
        graph = csr_array(graph + of_particle.T @ (of_patch @ of_patch.T) @ of_particle)
        graph.data[:] = 1.0
        return graph

    def matrix(self, positions: np.ndarray, colours: np.ndarray, graph: csr_array) -> csr_array:
        """K as a sparse matrix of the free degrees of freedom, by differences with all particles of a colour moved at once."""
        at_home, count = self.force(positions), self.cloth.particle_count
        owner = np.full(count, -1)
        rows, columns, values = [], [], []
        of_row = np.repeat(np.arange(count), np.diff(graph.indptr))
        for colour in range(colours.max() + 1):
            moved = np.flatnonzero(colours == colour)
            owner[:] = -1
            chosen = colours[graph.indices] == colour
            owner[of_row[chosen]] = graph.indices[chosen]
            touched = np.flatnonzero(owner >= 0)
            for axis in range(3):
                way = np.zeros_like(positions)
                way[moved, axis] = 1.0
                image = self.tangent(positions, at_home, way)[touched]
                rows.append((3 * touched[:, None] + np.arange(3)).ravel())
                columns.append(np.repeat(3 * owner[touched] + axis, 3))
                values.append(image.ravel())
        full = coo_array((np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))), shape=(3 * count, 3 * count)).tocsr()
        full = full + self._straightened(positions)
        own = (3 * self.free[:, None] + np.arange(3)).ravel()
        part = full[own][:, own]
        return csr_array(0.5 * (part + part.T))

    def _straightened(self, positions: np.ndarray) -> csr_array:
        """What takes from K the part of compressed links that would let them buckle: without it K has directions of negative curvature."""
        cloth, size = self.cloth, 3 * self.cloth.particle_count
        a, b = cloth.links.ends[:, 0].astype(np.int64), cloth.links.ends[:, 1].astype(np.int64)
        way = positions[b] - positions[a]
        length = np.linalg.norm(way, axis=1)
        strain = length / cloth.links.rest_length - 1.0
        slope = self.materials.tension_slope[cloth.links.material, cloth.links.direction]
        push = np.maximum(0.0, -slope * strain) * cloth.links.width / length
        across = push[:, None, None] * (np.eye(3) - np.einsum("li,lj->lij", way, way) / (length**2)[:, None, None])
        rows, columns, values = [], [], []
        for p, q, sign in ((a, a, 1.0), (b, b, 1.0), (a, b, -1.0), (b, a, -1.0)):
            rows.append(np.broadcast_to((3 * p[:, None] + np.arange(3))[:, :, None], across.shape).ravel())
            columns.append(np.broadcast_to((3 * q[:, None] + np.arange(3))[:, None, :], across.shape).ravel())
            values.append(sign * across.ravel())
        return coo_array((np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))), shape=(size, size)).tocsr()


def coloured(graph: csr_array) -> np.ndarray:
    """Colour (P,) of each particle: two of one colour have no neighbour in common."""
    far = csr_array(graph @ graph)
    colours = np.full(graph.shape[0], -1)
    for node in range(graph.shape[0]):
        taken = set(colours[far.indices[far.indptr[node] : far.indptr[node + 1]]].tolist())
        colour = 0
        while colour in taken:
            colour += 1
        colours[node] = colour
    return colours


def coarse_space(problem: Problem, positions: np.ndarray) -> csr_array:
    """Affine motions of tiles of the panels, 12 columns each: translations and their gradients along warp and weft and the normal's tilt."""
    cloth = problem.cloth
    tile = np.floor(cloth.vertex_uv_mm * MM_TO_M / (TILE * cloth.spacing)).astype(np.int64)
    _, label = np.unique(np.column_stack([cloth.vertex_panel, tile]), axis=0, return_inverse=True)
    of = np.zeros(cloth.particle_count, dtype=np.int64)
    of[cloth.vertex_particle] = label.ravel()
    of = np.unique(of[problem.free], return_inverse=True)[1]
    count = of.max() + 1
    weight = np.bincount(of)
    at = positions[problem.free]
    centre = np.column_stack([np.bincount(of, at[:, axis]) / weight for axis in range(3)])
    arm = (at - centre[of]) / cloth.spacing
    index = np.arange(len(of))
    rows, columns, values = [], [], []
    for axis in range(3):
        rows.append(3 * index + axis)
        columns.append(6 * of + axis)
        values.append(np.ones(len(of)))
        # a rotation about `axis`: axis x arm
        for other, sign in (((axis + 1) % 3, 1.0), ((axis + 2) % 3, -1.0)):
            target = 3 - axis - other
            rows.append(3 * index + target)
            columns.append(6 * of + 3 + axis)
            values.append(sign * arm[:, other])
    return csr_array((np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))), shape=(3 * len(of), 6 * count))


class Preconditioner:
    def __init__(self, matrix: csr_array, space: csr_array | None) -> None:
        blocks = matrix.tobsr((3, 3))
        count = matrix.shape[0] // 3
        diagonal = np.zeros((count, 3, 3))
        of_row = np.repeat(np.arange(count), np.diff(blocks.indptr))
        mine = blocks.indices == of_row
        diagonal[of_row[mine]] = blocks.data[mine]
        values, vectors = np.linalg.eigh(diagonal)
        values = np.maximum(np.abs(values), 1e-3 * np.abs(values).max(axis=1, keepdims=True))
        self._inverse = np.einsum("nij,nj,nkj->nik", vectors, 1.0 / values, vectors)
        self._space, self._coarse = space, None
        if space is not None:
            coarse = (space.T @ matrix @ space).tocsc()
            small = 1e-9 * np.abs(coarse.diagonal()).max()
            self._coarse = splu(
                coarse + csr_array((np.full(coarse.shape[0], small), (range(coarse.shape[0]), range(coarse.shape[0]))), shape=coarse.shape).tocsc()
            )

    def __call__(self, vector: np.ndarray) -> np.ndarray:
        image = np.einsum("nij,nj->ni", self._inverse, vector.reshape(-1, 3)).ravel()
        if self._coarse is not None:
            image = image + self._space @ self._coarse.solve(self._space.T @ vector)
        return image


def conjugate_gradients(matrix: csr_array, right: np.ndarray, precondition: Preconditioner, tolerance: float, most: int = 2000) -> tuple[np.ndarray, int]:
    """Solution and iterations; these are negative where it ended early, at a direction of negative curvature."""
    x, left = np.zeros_like(right), right.copy()
    z = precondition(left)
    way, size = z.copy(), float(left @ z)
    goal = tolerance * float(np.linalg.norm(right))
    for turn in range(most):
        image = matrix @ way
        curvature = float(way @ image)
        if curvature <= 0.0:
            return (x if turn else way), -(turn + 1)
        step = size / curvature
        x += step * way
        left -= step * image
        if float(np.linalg.norm(left)) < goal:
            return x, turn + 1
        z = precondition(left)
        before, size = size, float(left @ z)
        way = z + size / before * way
    return x, most


def _dynamics(problem: Problem) -> Dynamics:
    return Dynamics(problem.cloth, problem.forces, problem.limit, problem.contact, problem.fixed)


def explicit(problem: Problem) -> dict[str, Any]:
    """The settling of drape mode."""
    dynamics, state = _dynamics(problem), deepcopy(problem.state)
    state.contact, state.phase, state.run = {}, "settle", {"phase_from_s": state.time_s}
    dynamics.equalise = True
    dynamics.start(state)

    class Done(Exception):
        pass

    def look(progress: Progress) -> None:
        if progress.phase == "watch":
            raise Done

    began, steps = time.perf_counter(), state.step
    with suppress(Done):
        Course(dynamics, lambda softness: problem.forces, "drape", 60.0).run(state, look)
    return {"wall_s": time.perf_counter() - began, "steps": state.step - steps, "positions": state.positions}


def implicit(problem: Problem, aggregates: bool, cap_s: float) -> dict[str, Any]:
    """Pseudo-transient steps until the residual is as small."""
    dynamics, state = _dynamics(problem), deepcopy(problem.state)
    state.contact = {}
    dynamics.start(state)
    patch, masses, free = patches(problem.cloth), problem.cloth.masses, problem.free
    graph = problem.neighbours()
    colours = coloured(graph)
    x, dt, iterations, solves, stopped = state.positions.copy(), 1e-3, 0, 0, 0
    began = time.perf_counter()
    norm = np.inf
    tangent_s = 0.0
    while time.perf_counter() - began < cap_s:
        t0 = time.perf_counter()
        matrix = problem.matrix(x, colours, graph)
        tangent_s += time.perf_counter() - t0
        space = coarse_space(problem, x) if aggregates else None
        while True:
            inertia = np.repeat(masses[free] / dt**2, 3)
            whole = csr_array(matrix + csr_array((inertia, (range(len(inertia)), range(len(inertia)))), shape=matrix.shape))
            force = problem.force(x)
            way, turns = conjugate_gradients(whole, force[free].ravel(), Preconditioner(whole, space), FORCING)
            iterations, solves, stopped = iterations + abs(turns), solves + 1, stopped + (turns < 0)
            move = np.zeros_like(x)
            move[free] = way.reshape(-1, 3)
            largest = float(np.abs(move).max())
            move *= min(1.0, LARGEST_MOVE_M / largest)
            trial = x + move
            after = problem.force(trial)
            value = float(np.sqrt((after[free] ** 2 / masses[free, None]).sum()))
            if value < 2.0 * norm or dt < 1e-4:
                break
            dt *= 0.25
        dt = dt * 1.5 if value < norm else dt * 0.7
        x, norm = trial, value
        state.positions[:] = x
        left = residual(dynamics, state, patch)
        if left.rms_g < READY * RESIDUAL_G:
            break
    wall = time.perf_counter() - began
    done = {"wall_s": wall, "solves": solves, "iterations": iterations, "stopped": stopped, "residual_g": left.rms_g, "assembly_s": tangent_s}
    return done | {"time_step_ms": 1e3 * dt, "positions": x, "rested": left.rms_g < READY * RESIDUAL_G}


def iterations_table(problem: Problem) -> list[tuple[float, int, int]]:
    """Iterations of one solve to 1e-2 at each time step, without and with the coarse space."""
    graph = problem.neighbours()
    matrix = problem.matrix(problem.state.positions, coloured(graph), graph)
    space = coarse_space(problem, problem.state.positions)
    right = problem.force(problem.state.positions)[problem.free].ravel()
    rows = []
    for ms in TIME_STEPS_MS:
        inertia = np.repeat(problem.cloth.masses[problem.free] / (1e-3 * ms) ** 2, 3)
        whole = csr_array(matrix + csr_array((inertia, (range(len(inertia)), range(len(inertia)))), shape=matrix.shape))
        rows.append((ms, *(conjugate_gradients(whole, right, Preconditioner(whole, part), 1e-2)[1] for part in (None, space))))
    return rows


def told(turns: int) -> str:
    return str(turns) if turns > 0 else f"negative curvature at {-turns}"


def main() -> None:
    reader = argparse.ArgumentParser(description=__doc__)
    reader.add_argument("folders", nargs="+", type=Path)
    reader.add_argument("--cap", type=float, default=300.0, help="seconds for an implicit route")
    given = reader.parse_args()
    lines = ["# Explicit against implicit settling", "", "`python -m tools.implicit_spike DIR...`; see the head of that file for what is compared.", ""]
    lines += [
        "| state | route | wall s | over explicit "
        "| steps or solves | CG iterations | ended by negative curvature | assembling K, s | last dt ms | residual g RMS |",
        "|" + 10 * "---|",
    ]
    tables = []
    for folder in given.folders:
        problem = Problem(folder)
        problem.force(problem.state.positions)
        began = time.perf_counter()
        for _ in range(200):
            problem.force(problem.state.positions)
        per_force = (time.perf_counter() - began) / 200
        rows = iterations_table(problem)
        tables += [
            "",
            f"{problem.name}: {len(problem.free)} free particles of {problem.cloth.particle_count}, one evaluation of the forces {1e6 * per_force:.0f} us.",
            "",
        ]
        tables += ["| dt ms | CG iterations to 1e-2, blocks | with tiles |", "|---|---|---|", *(f"| {ms:g} | {told(a)} | {told(b)} |" for ms, a, b in rows)]
        first = explicit(problem)
        lines.append(f"| {problem.name} | explicit | {first['wall_s']:.1f} | 1 | {first['steps']} | - | - | - | - | < {READY * RESIDUAL_G:.1e} |")
        print(lines[-1], *tables[-5:], sep="\n", flush=True)
        for aggregates in (False, True):
            run = implicit(problem, aggregates, given.cap)
            kind = "implicit, tiles" if aggregates else "implicit, blocks"
            ratio = run["wall_s"] / first["wall_s"]
            over = f"{ratio:.1f}" if run["rested"] else f"not at rest after {ratio:.1f}"
            lines.append(
                f"| {problem.name} | {kind} | {run['wall_s']:.1f} | {over} | {run['solves']} | {run['iterations']} | {run['stopped']} | "
                f"{run['assembly_s']:.1f} | {run['time_step_ms']:.2g} | {run['residual_g']:.1e} |"
            )
            print(lines[-1], flush=True)
    write_atomic(PAGE, "\n".join([*lines, *tables, "", *VERDICT, ""]))


if __name__ == "__main__":
    main()
