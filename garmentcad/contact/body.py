"""Cloth against a still body: each particle directly, and pairs of elements where a sharp feature of the body lies between particles."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import prange

from garmentcad.arrays import CHUNKS, chunk_range, floats, kernel, parallel_kernel
from garmentcad.cloth.cloth import Cloth
from garmentcad.cloth.state import State
from garmentcad.contact.bvh import EDGE_EDGE, TRIANGLE_POINT, box_distance2, fitted_tree, near_pairs, node_after
from garmentcad.contact.elements import LEAST_GAP, elements, largest_around, unique_edges
from garmentcad.contact.pairs import CLOSED, PUSH_SPEED, PUSH_TIME, Stand, candidates, farthest, keep_apart, load_pairs, room_for, store_pairs
from garmentcad.contact.surface import build_surface, convex_curvature
from garmentcad.fabric.material import MaterialTable
from garmentcad.geometry.closest import along, cross, distance_between, dot, minus, mixed, point_triangle, row, unit

CLEARANCE = 0.6e-3  # m, what a flat triangle keeps above the body's curve between its particles
LARGEST_GAP = 0.4  # of the lattice spacing
ELEMENT_GAP = 0.15e-3  # m, of body vertices and edges against cloth triangles and edges
_MARGIN = 0.5e-3  # m, travel that one look covers: a look costs as much as a few responses to faces that turn out to be too far
_ELEMENT_MARGIN = 1e-3  # m, the same for the pairs of elements
_WIDTH = 16  # faces a particle can list at the start; more room is made when needed
_FAR = 0.5  # m, beyond this the distance to the body is not looked for
_APART = 0.9  # cosine between normals below which a second candidate is a contact of its own (the other side of a hollow corner)
_FACING = 0.7  # cosine to the feature's pseudo-normal above which a candidate is a closest point of its own


class Near(NamedTuple):
    """What the last look of each particle found; lives in State."""

    home: np.ndarray  # (P,3) m, where it looked
    allowance: np.ndarray  # (P,) m, how far it may go from there
    found: np.ndarray  # (P,) int32, how many faces are in reach
    faces: np.ndarray  # (P,K) int32, by rising distance
    distances: np.ndarray  # (P,K) m
    rise: np.ndarray  # (P,) m, the largest rise of those faces; infinite for a particle inside the body


class Grip(NamedTuple):
    """Constants of the response."""

    gap: np.ndarray  # (P,) m
    rise: np.ndarray  # (V,) m, least gap at the body's vertices because it curves there
    largest_gap: float  # m, up to which curvature raises the gap
    friction: np.ndarray  # (P,)
    inverse_masses: np.ndarray  # (P,) 1/kg


@kernel
def _collect(p, surface, tree, x, reaches, rise, near):  # type: ignore[no-untyped-def]
    """List the faces within reach of x for particle p, nearest first; for one inside the body at least the nearest. reaches: this reach, and how far
    to look for the closest face.

    Returns the distance of the closest face, or how far it was looked for in vain.
    """
    leaves, count = len(tree.boxes) // 2, len(tree.order)
    reach2, closest2 = reaches[0] ** 2, reaches[1] ** 2
    found, largest, inside, nearest = 0, 0.0, False, 0
    node = 1
    while True:
        # Until something is in reach, the closest face is looked for; from then on all within reach.
        apart = box_distance2(tree.boxes, node, x) > max(closest2, reach2)
        if not apart and node < leaves:
            node *= 2
            continue
        if not apart:
            for slot in range((node - leaves) * count // leaves, (node - leaves + 1) * count // leaves):
                face = tree.order[slot]
                corners = row(surface.faces, face)
                a, b, c = row(surface.vertices, corners[0]), row(surface.vertices, corners[1]), row(surface.vertices, corners[2])
                u, v, w, distance2, feature = point_triangle(x, a, b, c)
                if distance2 <= closest2:
                    outward = (surface.normals[face, feature, 0], surface.normals[face, feature, 1], surface.normals[face, feature, 2])
                    inside, nearest = dot(minus(x, mixed(a, b, c, u, v, w)), outward) < 0.0, face
                closest2 = min(closest2, distance2)
                if distance2 > reach2:
                    continue
                found += 1
                largest = max(largest, rise[corners[0]], rise[corners[1]], rise[corners[2]])
                if found <= near.faces.shape[1]:
                    distance, place = math.sqrt(distance2), found - 1
                    while place > 0 and near.distances[p, place - 1] > distance:
                        near.distances[p, place], near.faces[p, place] = near.distances[p, place - 1], near.faces[p, place - 1]
                        place -= 1
                    near.distances[p, place], near.faces[p, place] = distance, face
        node = node_after(node)
        if node == 1:
            break
    if inside and found == 0:
        found, near.faces[p, 0], near.distances[p, 0] = 1, nearest, math.sqrt(closest2)
    near.found[p], near.rise[p] = found, math.inf if inside else largest
    return math.sqrt(closest2)


@kernel
def _look_of(particles, surface, tree, positions, reaches, rise, near, looked):  # type: ignore[no-untyped-def]
    reserve, gap, margin = reaches
    for p in range(particles[0], particles[1]):
        way = distance_between(positions, near.home, p)
        looked[p] = way + reserve > near.allowance[p]
        if looked[p]:
            # The closest face is no farther than it was plus the way.
            before = near.distances[p, 0] if near.found[p] > 0 else near.allowance[p] + gap
            bound = min(_FAR, way + before) if before > 0.0 else _FAR
            closest = _collect(p, surface, tree, row(positions, p), (gap + margin, bound), rise, near)
            for axis in range(3):
                near.home[p, axis] = positions[p, axis]
            near.allowance[p] = margin if near.found[p] > 0 else closest - gap


@parallel_kernel
def _look(surface, tree, positions, reaches, rise, near, looked):  # type: ignore[no-untyped-def]
    """Particles whose way exceeds their allowance collect the faces within gap + margin; where there is none, the distance is their allowance.

    reaches: the reserve, gap and margin, m; rise: (V,) of the body's vertices.
    """
    for chunk in prange(CHUNKS):
        _look_of(chunk_range(chunk, len(positions)), surface, tree, positions, reaches, rise, near, looked)


@kernel
def _face_contact(surface, face, grip, x, p):  # type: ignore[no-untyped-def]
    """Signed distance of x from the face, unit vector along which it grows, room above the gap there, and its cosine to the feature's pseudo-normal."""
    corners = row(surface.faces, face)
    a, b, c = row(surface.vertices, corners[0]), row(surface.vertices, corners[1]), row(surface.vertices, corners[2])
    u, v, w, distance2, feature = point_triangle(x, a, b, c)
    outward = (surface.normals[face, feature, 0], surface.normals[face, feature, 1], surface.normals[face, feature, 2])
    apart = minus(x, mixed(a, b, c, u, v, w))
    distance = math.sqrt(distance2)
    rise = u * grip.rise[corners[0]] + v * grip.rise[corners[1]] + w * grip.rise[corners[2]]
    gap = max(grip.gap[p], min(rise, grip.largest_gap))
    facing = dot(apart, outward)
    if distance < 1e-9:
        return 0.0, outward, -gap, 1.0
    size = -1.0 / distance if facing < 0.0 else 1.0 / distance
    signed = -distance if facing < 0.0 else distance
    return signed, (apart[0] * size, apart[1] * size, apart[2] * size), signed - gap, abs(facing) / distance


@kernel
def _cone(v, slide, limit):  # type: ignore[no-untyped-def]
    """v without its part `slide`, or with that part shortened by `limit` m/s."""
    size = math.sqrt(dot(slide, slide))
    share = 1.0 if size <= limit else limit / size
    return along(v, slide, -share)


@kernel
def _respond_one(p, reach, surface, near, grip, positions, time_step, velocities):  # type: ignore[no-untyped-def]
    """Velocity of particle p in place; returns the work of friction, J."""
    x, v = row(positions, p), row(velocities, p)
    d1, d2, room1, room2 = math.inf, math.inf, math.inf, math.inf
    n1, n2 = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    for k in range(near.found[p]):
        if near.distances[p, k] > reach:  # they are sorted
            break
        signed, normal, room, own = _face_contact(surface, near.faces[p, k], grip, x, p)
        distance = abs(signed)
        other = own > _FACING and signed > 0.0
        if distance < d1:
            if d1 < math.inf and room1 < d2 and dot(n1, normal) < _APART:
                d2, n2, room2 = d1, n1, room1
            d1, n1, room1 = distance, normal, room
        elif distance < d2 and other and dot(n1, normal) < _APART:
            d2, n2, room2 = distance, normal, room
    if d2 < math.inf and dot(n1, n2) >= _APART:
        room2 = math.inf
    # Speeds along the normals that the gap demands in this step; what is below the gap already is pushed out afterwards, without friction.
    least1, least2 = min(0.0, (CLOSED - room1) / time_step), min(0.0, (CLOSED - room2) / time_step)
    before = v
    press1 = max(0.0, least1 - dot(v, n1))
    v = along(v, n1, press1)
    press2 = 0.0
    if room2 < math.inf:
        lean = dot(n1, n2)
        press2 = max(0.0, least2 - dot(v, n2))
        if press2 > 0.0 and dot(v, n1) + press2 * lean < least1 and lean > -0.99:
            # Both hold: solve for the two pushes together.
            need1, need2 = least1 - dot(before, n1), least2 - dot(before, n2)
            det = 1.0 - lean * lean
            press1, press2 = max(0.0, (need1 - lean * need2) / det), max(0.0, (need2 - lean * need1) / det)
            v = along(along(before, n1, press1), n2, press2)
        else:
            v = along(v, n2, press2)
    mu = grip.friction[p]
    pressed = v
    if press2 == 0.0 and press1 > 0.0:
        v = _cone(v, along(v, n1, -dot(v, n1)), mu * press1)
    elif press1 == 0.0 and press2 > 0.0:
        v = _cone(v, along(v, n2, -dot(v, n2)), mu * press2)
    elif press1 > 0.0:
        line = unit(cross(n1, n2))
        speed = dot(v, line)
        v = _cone(v, (speed * line[0], speed * line[1], speed * line[2]), mu * (press1 + press2))
    lost = minus(v, pressed)
    if room2 < 0.0:
        v = along(v, n2, max(0.0, min(PUSH_SPEED, -room2 / max(PUSH_TIME, time_step)) - dot(v, n2)))
    if room1 < 0.0:
        v = along(v, n1, max(0.0, min(PUSH_SPEED, -room1 / max(PUSH_TIME, time_step)) - dot(v, n1)))
    for axis in range(3):
        velocities[p, axis] = v[axis]
    return dot(lost, v) / grip.inverse_masses[p]


@kernel
def _respond_of(particles, surface, near, grip, positions, time_step, changes):  # type: ignore[no-untyped-def]
    velocities, work = changes
    for p in range(particles[0], particles[1]):
        work[p] = 0.0
        # The cheap question first: is any face in reach, and may the particle move?
        if near.found[p] > 0 and grip.inverse_masses[p] > 0.0:
            way, speed = distance_between(positions, near.home, p), math.sqrt(dot(row(velocities, p), row(velocities, p)))
            # No face farther than this at the look can matter in the step.
            gap = near.rise[p] if near.rise[p] == math.inf else max(grip.gap[p], min(near.rise[p], grip.largest_gap))
            reach = gap + speed * time_step + way
            if near.distances[p, 0] <= reach:
                work[p] = _respond_one(p, reach, surface, near, grip, positions, time_step, velocities)


@parallel_kernel
def _respond(surface, near, grip, positions, time_step, velocities, work):  # type: ignore[no-untyped-def]
    """Velocities (P,3) in place; work (P,): of friction, J."""
    for chunk in prange(CHUNKS):
        _respond_of(chunk_range(chunk, len(positions)), surface, near, grip, positions, time_step, (velocities, work))


class ContactBody:
    """Cloth on a still body (vertices (V,3) m, faces (F,3) counter-clockwise from outside).

    Gap of the mid-surfaces: half the fabric's thickness, at least 1 mm, and at least 0.6 mm + h^2/(4R) where the body bulges with radius R, because a
    flat triangle dips that much between its particles. inverse_masses (P,): 0 for particles that something else moves; default from the cloth.
    """

    name = "body"

    def __init__(self, vertices: np.ndarray, faces: np.ndarray, cloth: Cloth, materials: MaterialTable, inverse_masses: np.ndarray | None = None) -> None:
        self.surface = build_surface(vertices, faces)
        count, body = cloth.particle_count, len(self.surface.vertices)
        rise = CLEARANCE + 0.25 * cloth.spacing**2 * convex_curvature(self.surface)
        gap = np.maximum(0.5 * largest_around(cloth, materials.thickness), LEAST_GAP)
        inverse = floats(1.0 / cloth.masses if inverse_masses is None else inverse_masses)
        self.grip = Grip(gap, rise, LARGEST_GAP * cloth.spacing, largest_around(cloth, materials.friction_body), inverse)
        self._reach = float(max(gap.max(), min(rise.max(), self.grip.largest_gap)))
        self._most = 2.0 * cloth.spacing  # m, up to which a faster motion widens the margins; beyond it a run is lost anyway
        # Pairs of elements name the body's vertices after the cloth's particles: nodes that nothing moves.
        self._triangles = elements(cloth.particle_triangles, np.arange(count + body))
        self._edges = elements(unique_edges(cloth.particle_triangles), np.arange(count + body))
        self._body_points = elements(count + np.arange(body), np.arange(count + body))
        self._body_edges = elements(count + unique_edges(self.surface.faces), np.arange(count + body))
        self._nodes = np.concatenate([np.zeros((count, 3)), self.surface.vertices])
        self._speeds = np.zeros_like(self._nodes)
        self._node_inverse = np.concatenate([inverse, np.zeros(body)])
        self._node_gap = np.full(count + body, ELEMENT_GAP)
        self._node_friction = np.concatenate([self.grip.friction, np.full(body, self.grip.friction.mean())])
        self._face_tree = fitted_tree(elements(self.surface.faces, np.arange(body)), self.surface.vertices)
        self._point_tree = fitted_tree(self._body_points, self._nodes)
        self._edge_tree = fitted_tree(self._body_edges, self._nodes)
        self._work = np.zeros(count)
        self._stand: Stand | None = None

    def start(self, state: State) -> None:
        """Allocate; every particle has to look."""
        count = len(state.positions)
        faces, distances = np.zeros((count, _WIDTH), np.int32), np.zeros((count, _WIDTH))
        fresh = Near(state.positions.copy(), np.full(count, -np.inf), np.zeros(count, np.int32), faces, distances, np.zeros(count))
        for key, array in fresh._asdict().items():
            state.contact[f"{self.name}_{key}"] = array
        self._find_pairs(state)

    def set_inverse_masses(self, inverse_masses: np.ndarray) -> None:
        """See `Contact.set_inverse_masses`."""
        self.grip = self.grip._replace(inverse_masses=floats(inverse_masses))
        self._node_inverse[: len(inverse_masses)] = inverse_masses

    def detect(self, state: State, reserve_m: float) -> bool:
        """See `Contact.detect`: particles look again one by one, pairs of elements all together."""
        looked = np.zeros(len(state.positions), dtype=np.bool_)
        margin = max(_MARGIN, min(2.0 * reserve_m, self._most))
        near = self._near(state)
        _look(self.surface, self._face_tree, state.positions, (reserve_m, self._reach, margin), self.grip.rise, near, looked)
        while (most := int(near.found.max())) > near.faces.shape[1]:
            near.allowance[near.found > near.faces.shape[1]] = -np.inf
            for key in ("faces", "distances"):
                old = getattr(near, key)
                state.contact[f"{self.name}_{key}"] = np.concatenate([old, np.zeros((len(old), most - old.shape[1]), old.dtype)], axis=1)
            near = self._near(state)
            _look(self.surface, self._face_tree, state.positions, (reserve_m, self._reach, margin), self.grip.rise, near, looked)
        home = state.contact[f"{self.name}_pair_home"]
        if farthest(state.positions, home[: len(state.positions)]) + reserve_m <= float(state.contact[f"{self.name}_pair_margin"][0]):
            return bool(looked.any())
        self._find_pairs(state, 2.0 * reserve_m)
        return True

    def respond(self, state: State, time_step_s: float) -> None:
        """See `Contact.respond`: first the pairs of elements, then each particle, which has the last word."""
        count = len(state.positions)
        pairs = load_pairs(state, self.name)
        if len(pairs.nodes):
            self._nodes[:count], self._speeds[:count] = state.positions, state.velocities
            self._stand = room_for(pairs, self._stand)
            work, unresolved = keep_apart(pairs, self._stand, self._nodes, self._speeds, self._node_inverse, time_step_s)
            state.velocities[:] = self._speeds[:count]
            state.work_j["friction"] += work
            if unresolved:
                state.run["unresolved_contacts"] = state.run.get("unresolved_contacts", 0.0) + unresolved
        _respond(self.surface, self._near(state), self.grip, state.positions, time_step_s, state.velocities, self._work)
        state.work_j["friction"] += float(self._work.sum())

    def _near(self, state: State) -> Near:
        return Near(*(state.contact[f"{self.name}_{key}"] for key in Near._fields))

    def _find_pairs(self, state: State, least_margin: float = 0.0) -> None:
        margin = max(_ELEMENT_MARGIN, min(least_margin, self._most))
        self._nodes[: len(state.positions)] = state.positions
        reach, both = ELEMENT_GAP + margin, (self._nodes, self._nodes)
        pierced = near_pairs(TRIANGLE_POINT, reach, self._triangles, self._body_points, self._point_tree, both)
        crossed = near_pairs(EDGE_EDGE, reach, self._edges, self._body_edges, self._edge_tree, both)
        points = np.concatenate([self._body_points.nodes[pierced[:, 1], :1], self._triangles.nodes[pierced[:, 0]]], axis=1)
        edges = np.concatenate([self._edges.nodes[crossed[:, 0], :2], self._body_edges.nodes[crossed[:, 1], :2]], axis=1)
        store_pairs(state, self.name, candidates(points, edges, self._nodes, self._node_gap, self._node_friction), margin)
