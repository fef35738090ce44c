"""Contact of a cloth with itself and with a body: candidates found now and then, distances kept in every step.

In a step, after all else that changes velocities: pairs of elements are solved together by impulses, particles on the body are held by planes, which have
the last word on velocities, and a continuous test makes sure that nothing passes in the step; a step that would is cut.

The clock: no two points come closer faster than the fastest node moves. Candidates serve until a node has gone the way that their margin covers, and of
them only those matter whose slack the way since then has used up.
"""

from __future__ import annotations

import numpy as np

from garmentcad.arrays import CHUNKS, compact, entry, floats, frozen, indices, kernel, long_kernel
from garmentcad.cloth.cloth import Cloth
from garmentcad.cloth.state import State
from garmentcad.contact.body import ELEMENT_GAP, LARGEST_GAP, BodyElements
from garmentcad.contact.bvh import Tree, refit_swept
from garmentcad.contact.carry import carry, set_pace
from garmentcad.contact.cloth import ClothElements
from garmentcad.contact.elements import LEAST_GAP, largest_around
from garmentcad.contact.pairs import Pairs, by_distance, carry_over, fastest_of, joined, make_pairs, room_for, stop_collisions, take_stand
from garmentcad.contact.path import STANDING, BodyPath
from garmentcad.contact.planes import Grip, Planes, fresh_planes, respond_planes
from garmentcad.contact.surface import Surface, edge_of_side, pseudo_normals
from garmentcad.contact.sweeps import keep_apart
from garmentcad.errors import InputError
from garmentcad.fabric.material import MaterialTable
from garmentcad.geometry.closest import distance_between
from garmentcad.units import MM_TO_M

# Of the lattice spacing: how far two parts may at least come nearer, gap included, until one detection is used up, and the least way of each. More costs pairs,
# whose number grows with its square where a lattice is coarser than the mesh of the body or lies in layers; less costs detections.
_ACROSS, _COVERED_LEAST = 0.35, 0.125
# Fast motion would use that up in no time: then the way of so many steps, up to this part of the spacing.
_STEPS, _COVERED_FAST = 16.0, 0.2
SURGE = 1.5  # fastest speed after a response, in fastest speeds before it, up to which the candidates in reach were chosen right


@entry
@kernel
def farthest(positions, home):  # type: ignore[no-untyped-def]
    """The longest way from `home` to `positions`, of the rows of home (P,3), m."""
    way = 0.0
    for n in range(len(home)):
        way = max(way, distance_between(positions, home, n))
    return way


@entry
@long_kernel
def go_with_body(contact, leg, since, motion):  # type: ignore[no-untyped-def]
    """Set the body's velocities for the step that begins `since` s into the leg, and bring the planes to where the body is. Arguments as of `respond`."""
    surface, _, _, _, planes, _, _, pace, _, _ = contact
    positions, velocities, _, time_step = motion
    set_pace(leg, since, time_step, len(planes.held), positions, velocities, pace)
    carry(planes, surface.faces, positions, velocities, time_step)


@entry
@long_kernel
def respond(contact, motion, way, covered, fastest):  # type: ignore[no-untyped-def]
    """Correct velocities in place, so that positions + time_step * velocities keep their distances.

    contact: `Contact.arguments`; motion: positions, velocities, inverse masses of all nodes, time step; way: m, longest since detection, or a bound of it;
    covered: m, that the candidates serve; fastest: m/s. Returns the part of the step that is safe, the pair that limits it
    (-1: none), the work of friction on the cloth, J, and the fastest speed.
    """
    surface, tree, largest, grip, planes, pairs, stand, pace, out, path = contact
    positions, velocities, inverse_masses, time_step = motion
    work, part, worst = 0.0, 1.0, -1
    reach = SURGE * fastest
    count = take_stand(pairs, path[0], reach * time_step, motion, surface, stand)
    work += keep_apart(count, pairs, stand, planes, grip, fastest, motion)
    respond_planes(surface, tree, largest, planes, grip, positions, velocities, inverse_masses, time_step, pace, out)
    square = 0.0
    for chunk in range(len(out)):
        work += out[chunk, 0]
        square = max(square, out[chunk, 1])
    speed = max(np.sqrt(square), pace[2])
    if speed > reach:
        reach = min(speed, (covered - way) / time_step)
        count = take_stand(pairs, path[0], reach * time_step, motion, surface, stand)
    if count > 0:
        part, worst, touched = stop_collisions(count, pairs, stand, planes, reach, motion)
        if touched:
            speed = fastest_of(velocities)
    # Impulses near held or heavy particles throw light ones: these go as far as pairs were looked at, and no farther.
    if part * speed > reach:
        part = reach / speed
    path[0] += part * speed * time_step
    planes.path[0] += part * speed * time_step
    return part, worst, work, speed


def _longest_side(cloth: Cloth) -> float:
    """Longest side of a triangle at rest, m."""
    corners = cloth.vertex_uv_mm[cloth.triangles]
    return MM_TO_M * float(np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(initial=0.0))


class Contact:
    """Keeps a cloth's parts apart by the fabric's thickness, and off a body by half of it, at least 1 mm each, between mid-surfaces.

    body: vertices (V,3) m and faces (F,3) counter-clockwise from outside, or None. Where it bulges with radius R the gap is at least 0.6 mm + h^2/(4R).
    path: of a body that moves; where it is at `State.time_s` is all that counts then, and the shape in `body` only for the gap.
    itself: whether the cloth's parts see each other. inverse_masses (P,): 0 for particles that something else moves; default from the cloth.
    """

    def __init__(
        self,
        cloth: Cloth,
        materials: MaterialTable,
        body: tuple[np.ndarray, np.ndarray] | None = None,
        itself: bool = True,
        inverse_masses: np.ndarray | None = None,
        path: BodyPath | None = None,
    ) -> None:
        if path is not None and (body is None or path.vertex_count != len(body[0])):
            raise InputError(f"a path of {path.vertex_count} vertices for a body of {0 if body is None else len(body[0])}")
        thickness = largest_around(cloth, materials.thickness)
        self._cloth_gap, body_gap = compact(np.maximum(thickness, LEAST_GAP)), np.maximum(0.5 * thickness, LEAST_GAP)
        self._cloth_friction, self._body_friction = (compact(largest_around(cloth, values)) for values in (materials.friction_cloth, materials.friction_body))
        self._elements = ClothElements(cloth, float(self._cloth_gap.max(initial=LEAST_GAP)))
        self._body, self._itself = None if body is None else BodyElements(*body, cloth.spacing, _longest_side(cloth)), itself
        self._spacing = cloth.spacing
        self.covered = _COVERED_FAST * cloth.spacing  # m, the longest way that a look covers, unless a single step may go farther
        if self._body is None:
            self._surface = Surface(np.zeros((0, 3)), frozen(np.zeros((0, 3), np.int32)), np.zeros((0, 7, 3)))
            self._tree, rise = Tree(np.zeros(0, np.int32), np.zeros((2, 6))), np.zeros(0)
        else:
            self._surface, self._tree, rise = self._body.surface, self._body.face_tree, self._body.rise
        cap = LARGEST_GAP * cloth.spacing
        self._largest = float(max(body_gap.max(initial=0.0), min(rise.max(initial=0.0), cap)))
        self._grip = Grip(body_gap, rise, np.array([cap]), self._body_friction.copy(), np.zeros(cloth.particle_count, np.int8))
        self.count, self.nodes = cloth.particle_count, cloth.particle_count + len(self._surface.vertices)
        self.positions = np.concatenate([np.zeros((self.count, 3)), self._surface.vertices])
        self.velocities = np.zeros_like(self.positions)
        # One memory: where the body's nodes move, its surface moves.
        self._surface = self._surface._replace(vertices=self.positions[self.count :])
        if self._body is not None:
            self._body.surface = self._surface
        self._path, self.leg = path, STANDING
        self._stands_at: np.ndarray | None = None
        self._edge_of_side = indices([]) if path is None else edge_of_side(self._surface.faces)
        self.inverse_masses = np.zeros(self.nodes)
        self.set_inverse_masses(1.0 / cloth.masses if inverse_masses is None else inverse_masses)
        self._out = np.zeros((CHUNKS, 2))
        self._stand_for: np.ndarray | None = None

    @property
    def outsides(self) -> int:
        """Number of the body's pseudo-normals, which `Pairs.outside` counts."""
        return int(np.prod(self._surface.normals.shape[:2]))

    def let_slip(self, slips: bool) -> None:
        """Whether particles slide on the body without friction."""
        self._grip.friction[:] = 0.0 if slips else self._body_friction

    def let_pass(self, state: State, passing: np.ndarray) -> None:
        """From now on particles `passing` (P,) bool pass through the cloth around them (`ClothElements.let_pass`). Looks for candidates again."""
        self._elements.let_pass(passing)
        self._find_pairs(state, 0.0)

    def set_inverse_masses(self, inverse_masses: np.ndarray) -> None:
        """Inertia (P,) 1/kg that shares impulses between particles from now on; 0 for a particle that contact must not move."""
        self.inverse_masses[: self.count] = floats(inverse_masses)

    def start(self, state: State) -> None:
        """Allocate the detection clock and the candidate lists in `state.contact`, and look. Everything that a later step reads lies there, so that a copied
        or reloaded State goes on with the same bits."""
        self._allocate(state)
        self.place(state, 0.0)
        self._find_pairs(state, 0.0)

    def blank(self) -> State:
        """A state as after `start`, in which nothing is near anything: for the types of `arguments`."""
        state = State(np.zeros((self.count, 3)), np.zeros((self.count, 3)))
        self._allocate(state)
        self._store(state, self._no_pairs(), 0.0)
        return state

    def _allocate(self, state: State) -> None:
        state.contact |= {f"planes_{key}": array for key, array in fresh_planes(state.positions, self._path is not None)._asdict().items()}
        state.contact["body_pace"] = np.zeros(4)
        if self._body is None:
            state.contact["planes_due"][:] = np.inf

    def _no_pairs(self) -> Pairs:
        return make_pairs(np.zeros((0, 4), np.int32), np.zeros((0, 4), np.int32), self._cloth_gap, self._cloth_friction)

    def place(self, state: State, span_s: float) -> None:
        """Put a body that moves to where it is at `state.time_s`, for steps of `span_s` seconds in all from there on, and set the `leg` that they follow."""
        if self._path is None:
            return
        body, pace = slice(self.count, self.nodes), state.contact["body_pace"]
        start, self.leg = self._path.leg(state.time_s, span_s)
        self.positions[body], self.velocities[body], pace[2:] = start, 0.0, 0.0
        if len(self.leg.first):
            # A cubic stays within the hull of these four, and the normals tell sides only.
            span, (first, second, _) = span_s, self.leg
            hull = [start, start + span / 3.0 * first, start + span / 3.0 * (2.0 * first + span * second), self.leg.at(start, span)]
            shape, self._stands_at = self.leg.at(start, 0.5 * span), None
        elif self._stands_at is None or not np.array_equal(start, self._stands_at):
            hull, shape, self._stands_at = [start], start, start
        else:
            hull = []
        if hull:
            refit_swept(self._tree, self._surface.faces, [floats(positions) for positions in hull])
            self._surface.normals[:] = pseudo_normals(shape, self._surface.faces, self._edge_of_side)
        if not len(self.leg.first):
            self.load(state)
            carry(self._planes(state), self._surface.faces, self.positions, self.velocities, 1.0)

    def detect(self, state: State, reserve_m: float) -> bool:
        """Look for candidates again where the longest way since the last look plus `reserve_m`, the most that a node goes in the coming step, exceeds what
        that look covers. True if it did."""
        self.load(state)
        if farthest(self.positions, state.contact["pair_home"]) + SURGE * reserve_m <= float(state.contact["pair_covered"][0]):
            return False
        self._find_pairs(state, reserve_m)
        return True

    def respond(self, state: State, time_step_s: float) -> float:
        """Correct `state.velocities` in place for a step; add the work of friction to `state.work_j`. Returns the part of the step that is safe."""
        self.place(state, time_step_s)
        self.load(state)
        motion, pace = (self.positions, self.velocities, self.inverse_masses, time_step_s), state.contact["body_pace"]
        if len(self.leg.first):
            go_with_body(self.arguments(state), self.leg, 0.0, motion)
        way, fastest = farthest(self.positions, state.contact["pair_home"]), fastest_of(self.velocities)
        part, _, work, _ = respond(self.arguments(state), motion, way, float(state.contact["pair_covered"][0]), fastest)
        pace[:2] += part * time_step_s * pace[2:]
        state.velocities[:] = self.velocities[: self.count]
        state.work_j["friction"] += work
        return float(part)

    def load(self, state: State) -> None:
        """Positions and velocities of the state into those of all nodes."""
        self.positions[: self.count], self.velocities[: self.count] = state.positions, state.velocities

    def arguments(self, state: State):  # type: ignore[no-untyped-def]
        """What the compiled `respond` needs; the arrays that change are the state's own."""
        pairs = load_pairs(state)
        if self._stand_for is not pairs.nodes:
            self._stand, self._stand_for = room_for(pairs, self.nodes), pairs.nodes
        planes, pace = self._planes(state), state.contact["body_pace"]
        return self._surface, self._tree, self._largest, self._grip, planes, pairs, self._stand, pace, self._out, state.contact["pair_path"]

    @staticmethod
    def _planes(state: State) -> Planes:
        return Planes(*(state.contact[f"planes_{key}"] for key in Planes._fields))

    def nodes_of(self, state: State, pair: int) -> np.ndarray:
        """Particles of a pair."""
        nodes = load_pairs(state).nodes[pair]
        return nodes[nodes < self.count]

    def _find_pairs(self, state: State, reserve_m: float) -> None:
        gap = float(self._cloth_gap.max(initial=LEAST_GAP))
        least = max(_COVERED_LEAST * self._spacing, 0.5 * (_ACROSS * self._spacing - gap))
        covered = max(least, min(_STEPS * reserve_m, self.covered), 1.01 * SURGE * reserve_m)
        self._store(state, self.near(state, covered), covered)

    def touching(self, state: State) -> np.ndarray:
        """(P,) bool: particles of candidate pairs, and those that have a face of the body below them."""
        found = state.contact["planes_held"] > 0
        nodes = state.contact["pair_nodes"]
        found[nodes[nodes < self.count]] = True
        return found

    def near(self, state: State, way_m: float) -> Pairs:
        """All pairs that may come below their gap while no node goes farther than `way_m`; the state stays as it is."""
        positions, reach = floats(state.positions), float(self._cloth_gap.max(initial=LEAST_GAP)) + 2.0 * way_m
        parts, moving = [], []
        if self._itself:
            parts.append(self.near_itself(positions, reach))
            moving.append(np.full(len(parts[-1].nodes), 2.0))
        if self._body is not None:
            sides = 1.0 if self._path is None else 2.0
            pierced, crossed, outside = self._body.pairs(self._elements, positions, ELEMENT_GAP + sides * way_m)
            # A pair takes the mean of its elements: twice the cloth's and none of the body's is the cloth's own.
            friction = np.concatenate([2.0 * self._body_friction, np.zeros(self.nodes - self.count)])
            parts.append(make_pairs(pierced, crossed, np.full(self.nodes, ELEMENT_GAP), friction)._replace(outside=outside))
            moving.append(np.full(len(parts[-1].nodes), sides))
        found = joined(*parts) if parts else self._no_pairs()
        return found._replace(moving=np.concatenate([*moving, np.zeros(0)]))

    def near_itself(self, positions: np.ndarray, reach: float) -> Pairs:
        """Pairs of the cloth with itself that are closer than `reach` m at positions (P,3) m."""
        return make_pairs(*self._elements.pairs(floats(positions), reach), self._cloth_gap, self._cloth_friction)

    def _store(self, state: State, pairs: Pairs, covered: float) -> None:
        self.load(state)
        pairs = by_distance(pairs, self.positions)
        if "pair_nodes" in state.contact:
            carry_over(load_pairs(state), float(state.contact["pair_path"][0]), pairs)
        state.contact |= {f"pair_{key}": array for key, array in pairs._asdict().items()}
        home = state.positions if self._path is None else self.positions
        state.contact |= {"pair_home": home.copy(), "pair_covered": np.array([covered]), "pair_path": np.zeros(1)}


def load_pairs(state: State) -> Pairs:
    """The candidates in the state; the arrays are the state's own."""
    return Pairs(*(state.contact[f"pair_{key}"] for key in Pairs._fields))
