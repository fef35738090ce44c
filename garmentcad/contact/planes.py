"""Particles against a body, each by itself: planes that stand for the faces around it, and the velocities that they allow.

A look at the body lists the faces in reach of a particle and keeps at most two planes: of the nearest face, and of one on the other side of a hollow corner.

    room(x) = n.(x - x_home) + signed distance at x_home - gap

serves until the particle has gone its allowance. Distance from a convex body is a convex function, so that this plane never lies below the body's own
distance there: a particle that slides along a bulge of radius R is held off by at most way^2/(2 R) too much. In a hollow it is the other way round; the gap
covers that. Response: the approach beyond room/dt is removed, Coulomb friction with exact sticking takes what is left along the plane.

On a body that moves, planes and homes ride on their faces (carry.py), velocities count relative to theirs, and what the body bends by counts as way gone.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import prange

from garmentcad.arrays import CHUNKS, chunk_range, inlined_kernel, kernel, long_kernel, making_kernel, parallel_kernel, row_kernel
from garmentcad.contact.bvh import box_distance2, node_after
from garmentcad.contact.carry import anchor, row_at
from garmentcad.geometry.closest import FACE, along, cross, distance_between, dot, minus, mixed, point_triangle, row, unit

PUSH_SPEED = 0.25  # m/s, fastest separation of what stands below its gap
PUSH_TIME = 5e-3  # s, time constant of that separation
# m: this close to its gap, on either side, a contact is closed. Without it what rests on something may still approach by the room that is left, a fraction
# of a micrometre in a step of some 10 us, which looks like several g.
CLOSED = 2e-6
MARGIN = 0.5e-3  # m, way that one look covers at least
_STEPS_PER_LOOK = 16  # and more where the particle is fast: the way of so many steps,
_MOST = 3e-3  # m, but not more than this
_FAR = 0.5  # m, beyond this the distance to the body is not looked for
_APART = 0.95  # cosine between normals below which a second face is a contact of its own (the other side of a hollow corner)
_FACING = 0.7  # cosine to the feature's pseudo-normal above which a face holds a closest point of its own
_SAME = 1e-9  # m, distance of two points that are one
_LISTED = 64  # faces that one look may list; of more, the nearest


class Planes(NamedTuple):
    """What the last look of each particle found; lives in State."""

    home: np.ndarray  # (P,3) m, where it looked
    allowance: np.ndarray  # (P,) m, how far it may go from there
    closest: np.ndarray  # (P,) m, distance of the nearest face there, or a lower bound of it
    held: np.ndarray  # (P,) int32 planes, 0 to 2
    normal: np.ndarray  # (P,2,3) unit
    room: np.ndarray  # (P,2) m, at home
    due: np.ndarray  # (P,) m, path at which the particle may need a look or meet its plane; past where it stands on one, or on two, or the body moves
    path: np.ndarray  # (1,) m, of the fastest nodes since the beginning: no particle goes farther
    # Of a body that moves; else without rows.
    face: np.ndarray  # (P,2) int32 that each plane rides on
    weights: np.ndarray  # (P,2,3) of its point below home
    upright: np.ndarray  # (P,2,3) the normal in the face's axes
    height: np.ndarray  # (P,2) m, of home above that point
    gap: np.ndarray  # (P,2) m, height without room
    drift: np.ndarray  # (P,2,3) m/s, of what rests on the plane, in this step
    travel: np.ndarray  # (P,2) m, the body's ways (`pace`) at the look


class Grip(NamedTuple):
    """Constants of the response, and room for it."""

    gap: np.ndarray  # (P,) m
    rise: np.ndarray  # (V,) m, least gap at the body's vertices because it curves there
    largest_gap: np.ndarray  # (1,) m, up to which curvature raises the gap
    friction: np.ndarray  # (P,)
    near: np.ndarray  # (P,) int8, room for which particles are near something in a step


@kernel
def _list_faces(surface, tree, x, reaches, rows):  # type: ignore[no-untyped-def]
    """Faces within reach of x into `rows` (distance, face), nearest first; for a particle inside the body at least the nearest face. reaches: this reach,
    and how far to look for the closest face. Returns their number, and the distance of the closest face or how far it was looked for in vain."""
    leaves, count = len(tree.boxes) // 2, len(tree.order)
    reach2, closest2 = reaches[0] ** 2, reaches[1] ** 2
    found, inside, nearest = 0, False, 0
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
                distance = math.sqrt(distance2)
                if found == _LISTED:
                    if distance >= rows[found - 1, 0]:
                        continue
                    found -= 1
                place = found
                while place > 0 and rows[place - 1, 0] > distance:
                    rows[place, 0], rows[place, 1] = rows[place - 1, 0], rows[place - 1, 1]
                    place -= 1
                rows[place, 0], rows[place, 1] = distance, face
                found += 1
        node = node_after(node)
        if node == 1:
            break
    if inside and found == 0:
        found, rows[0, 0], rows[0, 1] = 1, math.sqrt(closest2), nearest
    return found, math.sqrt(closest2)


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
    gap = max(grip.gap[p], min(rise, grip.largest_gap[0]))
    facing = dot(apart, outward)
    if distance < 1e-9:
        return 0.0, outward, -gap, 1.0
    size = -1.0 / distance if facing < 0.0 else 1.0 / distance
    signed = -distance if facing < 0.0 else distance
    return signed, (apart[0] * size, apart[1] * size, apart[2] * size), signed - gap, abs(facing) / distance


@kernel
def _goes_on(surface, face, rows, k, x):  # type: ignore[no-untyped-def]
    """Whether a nearer face, of rows 0 to k - 1, goes on into `face`, row k, without a hollow between them: the point of `face` closest to x lies on both.

    It is no closest point of the surface then; a plane there would make a bump of every edge of a flat or bulging body.
    """
    corners = row(surface.faces, face)
    a, b, c = row(surface.vertices, corners[0]), row(surface.vertices, corners[1]), row(surface.vertices, corners[2])
    u, v, w, _, _ = point_triangle(x, a, b, c)
    there = mixed(a, b, c, u, v, w)
    own = (surface.normals[face, FACE, 0], surface.normals[face, FACE, 1], surface.normals[face, FACE, 2])
    for j in range(k):
        near = int(rows[j, 1])
        of = row(surface.faces, near)
        p, q, r = row(surface.vertices, of[0]), row(surface.vertices, of[1]), row(surface.vertices, of[2])
        if point_triangle(there, p, q, r)[3] < _SAME * _SAME:
            normal = (surface.normals[near, FACE, 0], surface.normals[near, FACE, 1], surface.normals[near, FACE, 2])
            rise = max(dot(minus(a, there), normal), dot(minus(b, there), normal), dot(minus(c, there), normal))
            if rise < _SAME or dot(own, normal) > _APART:
                return True
    return False


@kernel
def _keep(planes, p, place, normal, room):  # type: ignore[no-untyped-def]
    planes.normal[p, place, 0], planes.normal[p, place, 1], planes.normal[p, place, 2] = normal
    planes.room[p, place] = room
    planes.held[p] = place + 1


@kernel
def _tie(p, place, planes, surface, motion, face, height):  # type: ignore[no-untyped-def]
    if len(planes.face) > 0:
        corners = row(surface.faces, face)
        a, b, c = row(surface.vertices, corners[0]), row(surface.vertices, corners[1]), row(surface.vertices, corners[2])
        u, v, w, _, _ = point_triangle(row(planes.home, p), a, b, c)
        anchor(p, place, planes, surface.faces, motion, (face, (u, v, w), height))


@making_kernel
def _look(p, surface, tree, grip, x, reaches, planes, motion, pace):  # type: ignore[no-untyped-def]
    """Set the planes of particle p at x. reaches: largest gap of any particle, the way that the look should cover, and how far the body has come nearer."""
    largest, margin, nearer = reaches
    way = math.sqrt(dot(minus(x, row(planes.home, p)), minus(x, row(planes.home, p)))) + nearer
    before = planes.closest[p]
    bound = min(_FAR, way + before)  # the closest face is no farther than it was plus the way
    rows = np.empty((_LISTED, 2))  # made here, not by the caller, who goes on without counting references; a look takes many times as long
    found, closest = _list_faces(surface, tree, x, (largest + margin, bound), rows)
    planes.held[p] = 0
    for axis in range(3):
        planes.home[p, axis] = x[axis]
    nearest, first = (0.0, 0.0, 0.0), 0.0
    for k in range(found):
        signed, normal, room, own = _face_contact(surface, int(rows[k, 1]), grip, x, p)
        if k == 0:
            nearest, first = normal, room
            _keep(planes, p, 0, normal, room)
            _tie(p, 0, planes, surface, motion, int(rows[k, 1]), signed)
        elif own > _FACING and signed > 0.0 and dot(nearest, normal) < _APART and not _goes_on(surface, int(rows[k, 1]), rows, k, x):
            _keep(planes, p, 1, normal, room)
            _tie(p, 1, planes, surface, motion, int(rows[k, 1]), signed)
            break
    if len(planes.face) > 0:
        planes.travel[p, 0], planes.travel[p, 1] = pace[0], pace[1]
    planes.closest[p] = closest
    # One inside the body moves out by planes that its way changes quickly.
    planes.allowance[p] = closest - largest if found == 0 else margin
    if found > 0 and first < -largest:
        planes.allowance[p] = 0.25 * MARGIN


@inlined_kernel
def rooms(planes, p, place, x):  # type: ignore[no-untyped-def]
    """Unit normal of a plane of particle p, and the room of x above it, m."""
    normal = (planes.normal[p, place, 0], planes.normal[p, place, 1], planes.normal[p, place, 2])
    return normal, planes.room[p, place] + dot(normal, minus(x, row(planes.home, p)))


@inlined_kernel
def _cone(v, slide, limit):  # type: ignore[no-untyped-def]
    """v without its part `slide`, or with that part shortened by `limit` m/s."""
    size = math.sqrt(dot(slide, slide))
    share = 1.0 if size <= limit else limit / size
    return along(v, slide, -share)


@inlined_kernel
def demanded(room, time_step):  # type: ignore[no-untyped-def]
    """Least speed of separation, m/s, for a contact with this room, m: negative while it may still approach, positive where it stands below its gap."""
    if room > CLOSED:
        return (CLOSED - room) / time_step
    return min(PUSH_SPEED, max(0.0, -CLOSED - room) / max(PUSH_TIME, time_step))


@inlined_kernel
def _on_one(v, n, least, mu):  # type: ignore[no-untyped-def]
    """v with at least the speed `least` along n, with friction and without."""
    press = max(0.0, least - dot(v, n))
    v = along(v, n, press)
    return _cone(v, along(v, n, -dot(v, n)), mu * press), v


@kernel
def _on_both(v, n1, n2, least1, least2, mu):  # type: ignore[no-untyped-def]
    """v with both speeds, with friction along the line of the two planes and without."""
    lean = dot(n1, n2)
    need1, need2 = least1 - dot(v, n1), least2 - dot(v, n2)
    det = max(1.0 - lean * lean, 1e-3)
    press1, press2 = max(0.0, (need1 - lean * need2) / det), max(0.0, (need2 - lean * need1) / det)
    v = along(along(v, n1, press1), n2, press2)
    line = unit(cross(n1, n2))
    speed = dot(v, line)
    return _cone(v, (speed * line[0], speed * line[1], speed * line[2]), mu * (press1 + press2)), v


@inlined_kernel
def _hold(p, planes, mu, x, v, time_step, n1, room1):  # type: ignore[no-untyped-def]
    """Velocity of particle p that its planes allow, and the part of it that friction took; v and both relative to the first plane's. n1, room1: of that."""
    n2, room2 = n1, math.inf
    if planes.held[p] > 1:
        n2, room2 = rooms(planes, p, 1, x)
    # Speeds along the normals that the gap demands in this step; what is below the gap already is pushed out afterwards, without friction.
    least1, least2, lead = min(0.0, demanded(room1, time_step)), min(0.0, demanded(room2, time_step)), 0.0
    if len(planes.face) > 0 and planes.held[p] > 1:
        lead = dot(minus(row_at(planes.drift, p, 1), row_at(planes.drift, p, 0)), n2)
        least2 += lead
    # One plane holds alone if with its friction the other is not reached; only a closed plane may press, or the place of rest would depend on the time step.
    before = v
    v, pressed = _on_one(before, n1, least1, mu)
    if dot(v, n2) < least2:
        v, pressed = _on_one(before, n2, least2, mu)
        if dot(v, n1) < least1:
            v, pressed = _on_both(before, n1, n2, least1, least2, mu)
    lost = minus(v, pressed)
    if room2 < -CLOSED:
        v = along(v, n2, max(0.0, demanded(room2, time_step) + lead - dot(v, n2)))
    if room1 < -CLOSED:
        v = along(v, n1, max(0.0, demanded(room1, time_step) - dot(v, n1)))
    return v, lost


@inlined_kernel
def held(p, planes, mu, x, v, time_step):  # type: ignore[no-untyped-def]
    """Velocity that the planes of particle p, at least one, leave of v, and the part of it that friction took; mu: friction of the particle on the body."""
    normal, room = rooms(planes, p, 0, x)
    return held_by(p, planes, mu, x, v, time_step, normal, room)


@inlined_kernel
def held_by(p, planes, mu, x, v, time_step, normal, room):  # type: ignore[no-untyped-def]
    """The same; normal, room: of the first plane."""
    if len(planes.face) == 0:
        return _hold(p, planes, mu, x, v, time_step, normal, room)
    drift = row_at(planes.drift, p, 0)
    v, lost = _hold(p, planes, mu, x, minus(v, drift), time_step, normal, room)
    return along(v, drift, 1.0), lost


@kernel
def allowed(planes, p, x, v, time_step):  # type: ignore[no-untyped-def]
    """v without its approach beyond the room of the planes of particle p, x; for impulses that have been through friction and push already."""
    for place in range(planes.held[p]):
        normal, room = rooms(planes, p, place, x)
        least = min(0.0, demanded(room, time_step))
        if len(planes.face) > 0:
            least += dot(row_at(planes.drift, p, place), normal)
        v = along(v, normal, max(0.0, least - dot(v, normal)))
    return v


@row_kernel
def _sift(particles, due, path, velocities, inverse_masses, time_step, near):  # type: ignore[no-untyped-def]
    """Tell in near (P,) which particles may meet their planes or need a look in this step. Returns the largest squared speed of the others, m2/s2; infinite
    where one of them is no number."""
    first, count = particles[0], np.uint64(particles[1] - particles[0])
    speeds, limit, masses, found = velocities.reshape(-1)[3 * first :], due[first:], inverse_masses[first:], near[first:]
    least, reach, largest = PUSH_SPEED * PUSH_SPEED, time_step * time_step, np.int64(0)
    for i in range(count):
        k = np.uint64(3) * i
        x, y, z = speeds[k], speeds[k + np.uint64(1)], speeds[k + np.uint64(2)]
        square, ahead = x * x + y * y + z * z, limit[i] - path
        past = (masses[i] == 0.0) | ((ahead > 0.0) & (ahead * ahead > max(square, least) * reach))
        found[i] = not past
        bits = np.float64(abs(square)).view(np.int64)
        largest = max(largest, bits if past else np.int64(0))
    square = np.int64(largest).view(np.float64)
    return square if square == square else math.inf


@long_kernel
def _respond_of(particles, body, planes, grip, motion, pace, out):  # type: ignore[no-untyped-def]
    surface, tree, largest = body
    positions, velocities, inverse_masses, time_step = motion
    moving = len(planes.face) > 0
    total = 0.0
    largest_square = _sift(particles, planes.due, planes.path[0], velocities, inverse_masses, time_step, grip.near)
    for p in range(particles[0], particles[1]):
        if grip.near[p] == 0:
            continue
        v, x = row(velocities, p), row(positions, p)
        square = dot(v, v)
        speed, nearer = math.sqrt(square), 0.0
        if moving:
            # Near the body relative to the face below, and by what the body bends; else by all that the body moves.
            near = 1 if planes.held[p] > 0 else 0
            if near:
                beside = minus(v, row_at(planes.drift, p, 0))
                speed = math.sqrt(dot(beside, beside))
            speed, nearer = speed + pace[2 + near], pace[near] - planes.travel[p, near]
        # What a push adds to the way is no faster than its own cap.
        reserve = max(speed, PUSH_SPEED) * time_step
        gone = distance_between(positions, planes.home, p)
        within = gone + nearer + reserve <= planes.allowance[p]
        if not within and planes.held[p] > 0:
            # What presses on its planes does not go where it would without them, and a new look at the place where it rests finds others, micrometres off.
            kept = held(p, planes, grip.friction[p], x, v, time_step)[0]
            if moving:
                kept = minus(kept, row_at(planes.drift, p, 0))
            within = gone + nearer + math.sqrt(dot(kept, kept)) * time_step + (pace[3] * time_step if moving else 0.0) <= planes.allowance[p]
        if not within:
            gone = 0.0
            margin = max(MARGIN, 2.0 * reserve, min(_STEPS_PER_LOOK * speed * time_step, _MOST))
            _look(p, surface, tree, grip, x, (largest, margin, nearer), planes, (positions, velocities, time_step), pace)
        room = math.inf if planes.held[p] == 0 else -math.inf
        normal, first = (0.0, 0.0, 0.0), 0.0
        if planes.held[p] > 0:
            normal, first = rooms(planes, p, 0, x)
        if planes.held[p] == 1:
            room = first - CLOSED
        if not moving:
            planes.due[p] = planes.path[0] + min(planes.allowance[p] - gone, room)
        if room <= reserve:
            v, lost = held_by(p, planes, grip.friction[p], x, v, time_step, normal, first)
            rest = minus(v, row_at(planes.drift, p, 0)) if moving else v
            total += dot(lost, rest) / inverse_masses[p]
            velocities[p, 0], velocities[p, 1], velocities[p, 2] = v
            square = dot(v, v)
        largest_square = max(largest_square, square) if square == square else math.inf
    out[0], out[1] = total, largest_square


@parallel_kernel
def respond_planes(surface, tree, largest, planes, grip, positions, velocities, inverse_masses, time_step, pace, out):  # type: ignore[no-untyped-def]
    """Velocities in place; out (CHUNKS,2): work of friction, J, and largest squared speed, m2/s2; largest: m, of all gaps.

    Particles that have gone their allowance look at the body first.
    """
    count = len(planes.held)
    for chunk in prange(CHUNKS):
        _respond_of(chunk_range(chunk, count), (surface, tree, largest), planes, grip, (positions, velocities, inverse_masses, time_step), pace, out[chunk])


def fresh_planes(positions: np.ndarray, moving: bool) -> Planes:
    """Planes of particles (P,3) that all have to look; moving: on a body that moves."""
    count = len(positions)
    ride = count if moving else 0
    return Planes(
        positions.copy(), np.full(count, -np.inf), np.full(count, np.inf), np.zeros(count, np.int32), np.zeros((count, 2, 3)), np.zeros((count, 2)),
        np.full(count, -np.inf), np.zeros(1), np.zeros((ride, 2), np.int32), np.zeros((ride, 2, 3)), np.zeros((ride, 2, 3)), np.zeros((ride, 2)),
        np.zeros((ride, 2)), np.zeros((ride, 2, 3)), np.zeros((ride, 2)),
    )  # fmt: skip
