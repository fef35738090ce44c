"""A sheet of plain springs that the tests of contact can drop, throw and fold without lattice, laws or stepper."""

from __future__ import annotations

import igl
import ipctk
import numpy as np
from hand_made import flat, materials, rectangles

from garmentcad.cloth.cloth import Cloth
from garmentcad.cloth.state import State
from garmentcad.contact.contact import Contact
from garmentcad.contact.elements import unique_edges
from garmentcad.fabric.material import MaterialTable


def fabric(friction: float = 0.3, thickness_m: float = 0.6e-3) -> MaterialTable:
    """Thickness and friction are all that contact reads."""
    table = materials()
    rows = np.ones(len(table.areal_mass))
    return table._replace(thickness=thickness_m * rows, friction_body=friction * rows, friction_cloth=friction * rows)


class Sheet:
    """A square sheet with springs along all edges of its triangles."""

    def __init__(self, cells: int, spacing_m: float = 0.01, panels: int = 1) -> None:
        self.cloth: Cloth = rectangles(cells, cells, spacing_m, panels, False)
        rest = flat(self.cloth)
        self.positions = np.column_stack([rest[:, 0], 0.0 * rest[:, 0], -rest[:, 1]])
        self.positions -= self.positions.mean(axis=0)
        self.ends = unique_edges(self.cloth.particle_triangles)
        self.rest_length = np.linalg.norm(rest[self.ends[:, 1]] - rest[self.ends[:, 0]], axis=1)
        self.stiffness = np.where(self.rest_length < 1.2 * spacing_m, 60.0, 10.0)  # N/m of each spring; those across the cells are softer

    def at(self, x: float, y: float, z: float) -> np.ndarray:
        """The flat sheet with its middle at a place."""
        return self.positions + np.array([x, y, z])

    def state(self, positions: np.ndarray, velocities: np.ndarray | None = None) -> State:
        return State(positions.copy(), np.zeros_like(positions) if velocities is None else velocities.copy())

    def pull(self, state: State, dt: float, drag: float = 4.0) -> None:
        """Springs, their damping, weight and drag change the velocities."""
        one, other = self.ends.T
        apart, moving = state.positions[other] - state.positions[one], state.velocities[other] - state.velocities[one]
        length = np.linalg.norm(apart, axis=1)
        along = (self.stiffness * (length - self.rest_length) + 1e-3 * (moving * apart).sum(axis=1) / length) / length
        force = along[:, None] * apart
        total = np.zeros_like(state.positions)
        np.add.at(total, one, force)
        np.subtract.at(total, other, force)
        state.velocities += dt * (total / self.cloth.masses[:, None] + [0.0, -9.81, 0.0])
        state.velocities /= 1.0 + drag * dt

    def step(self, state: State, dt: float, contact: Contact) -> None:
        self.pull(state, dt)
        state.positions += correct(state, dt, contact) * dt * state.velocities
        state.step += 1


def correct(state: State, dt: float, contact: Contact) -> float:
    """The contact part of a step; the part of the step that is safe."""
    contact.detect(state, reserve(state, dt))
    return contact.respond(state, dt)


def reserve(state: State, dt: float) -> float:
    return float(np.linalg.norm(state.velocities, axis=1).max()) * dt


def crosses(positions: np.ndarray, triangles: np.ndarray) -> bool:
    """Any intersection, by ipctk."""
    return bool(ipctk.has_intersections(ipctk.CollisionMesh(positions, ipctk.edges(triangles), triangles), positions))


def crosses_body(positions: np.ndarray, triangles: np.ndarray, vertices: np.ndarray, faces: np.ndarray) -> bool:
    """Any intersection of cloth with cloth or body, by ipctk."""
    return crosses(np.concatenate([positions, vertices]), np.concatenate([triangles, faces + len(positions)]))


def least_distance(positions: np.ndarray, triangles: np.ndarray, vertices: np.ndarray, faces: np.ndarray) -> float:
    """Smallest signed distance in m from a closed body at particles and at three points of each triangle, by libigl."""
    corners = positions[triangles]
    inner = [np.einsum("k,fkx->fx", np.roll([2 / 3, 1 / 6, 1 / 6], k), corners) for k in range(3)]
    points = np.concatenate([positions, *inner])
    return float(igl.signed_distance(points, vertices, faces)[0].min())
