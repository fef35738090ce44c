"""Many steps in one call: modified Euler after Provot, with every correction of the velocity between forces and positions.

    v <- v + dt (M^-1 (F + m g) - c v)     constraints     strain limiting     contact (last word)     x <- x + dt v

Where a part of the cloth is much stiffer than the rest, its forces F are those of places a little further on (stiff_parts.py).

m true mass, M what resists: another one than m only where drape mode slows a fast element down or lets limp cloth sway faster (inertia.py; weight is that of
the true mass, drag that of M).
Source: Provot 1995, velocity before position, every correction of the velocity between the two.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import prange

from garmentcad.arrays import CHUNKS, chunk_range, entry, kernel, long_kernel, parallel_kernel, row_kernel
from garmentcad.constraints.points import apply_bonds
from garmentcad.contact.contact import farthest, go_with_body, respond
from garmentcad.contact.pairs import BY_BODY, fastest_of, mark_pressed
from garmentcad.contact.planes import CLOSED, rooms
from garmentcad.forces.internal import write_internal
from garmentcad.geometry.closest import row
from garmentcad.solve.stiff_parts import expect, go_on, keep_home, note_what_held, take_home
from garmentcad.solve.strain_limit import least_headroom, pull_back

# Why a call ended: all steps done; contact must look for candidates; a particle is too fast; a step was cut; a link is far beyond its limit.
DONE, LOOK, RUNAWAY, CUT, TORN = 0, 1, 2, 3, 4
TORN_LENGTH = 2.0  # times the longest that a link may be: no force of a garment does that, only a diverging run
MOST_CUTS = 20
FAR = 0.25  # of the longest way that a look covers: what a step has to measure anew grows with the way that it may go


class Controls(NamedTuple):
    """Numbers of a stretch of steps, and what they report."""

    time_step: float  # s
    drag: np.ndarray  # (P,) 1/s
    across: np.ndarray  # (P,3) of inertia.py
    speed_cap: float  # m/s, forces make no particle faster, but press it on the body where it lies there
    runaway: float  # m/s
    surge: float  # of the fastest speed before a response, up to which contact counts on it
    covered: float  # m, the longest way that a look for candidates covers of itself
    out: np.ndarray  # (CHUNKS,2) what each part of the work reports; given, because a kernel that makes arrays counts all others, and compiles twice as long


@kernel
def _add_up_of(chunk, sums):  # type: ignore[no-untyped-def]
    """What acts on particles on which several forces act, into the row of corner forces that has their number: where one does, it stands there already."""
    for m in range(sums.first_mixed[chunk], sums.first_mixed[chunk + 1]):
        p = sums.mixed[m]
        fx = fy = fz = 0.0
        for j in range(sums.starts[p], sums.starts[p + 1]):
            k = sums.slots[j]
            fx, fy, fz = fx + sums.corner_forces[k, 0], fy + sums.corner_forces[k, 1], fz + sums.corner_forces[k, 2]
        sums.corner_forces[p, 0], sums.corner_forces[p, 1], sums.corner_forces[p, 2] = fx, fy, fz


@row_kernel
def _accelerate_of(particles, forces, weights, time_step, inertia, velocities):  # type: ignore[no-untyped-def]
    """Velocities from the forces, uncapped. Returns the largest squared speed as whole number: the bits of numbers that are not negative rise as they do, and
    one that is no number is beyond all."""
    first, count = particles[0], np.uint64(particles[1] - particles[0])
    force, speeds, lights = forces.reshape(-1)[3 * first :], velocities.reshape(-1)[3 * first :], inertia[2].reshape(-1)[3 * first :]
    weight, drag, inverse_masses = weights[first:], inertia[0][first:], inertia[1][first:]
    largest = np.int64(0)
    for i in range(count):
        kx = np.uint64(3) * i
        ky, kz = kx + np.uint64(1), kx + np.uint64(2)
        push, keep = time_step * inverse_masses[i], 1.0 - time_step * drag[i]
        keep = 1.0 if push == 0.0 else keep
        # 0 and a sum of one is that one, but for the sign of nothing
        fx, fy, fz, ax, ay, az = 0.0 + force[kx], (0.0 + force[ky]) - weight[i], 0.0 + force[kz], lights[kx], lights[ky], lights[kz]
        light = ax * fx + ay * fy + az * fz
        fx, fy, fz = fx + light * ax, fy + light * ay, fz + light * az
        x, y, z = keep * speeds[kx] + push * fx, keep * speeds[ky] + push * fy, keep * speeds[kz] + push * fz
        speeds[kx], speeds[ky], speeds[kz] = x, y, z
        largest = max(largest, np.float64(abs(x * x + y * y + z * z)).view(np.int64))
    return largest


@kernel
def _press_of(p, cap, time_step, planes, pressed, positions, velocities):  # type: ignore[no-untyped-def]
    """The way in which particle p presses on the body, or on what keeps it off the body: a unit normal, the speed along it, not positive, and the room [m]."""
    (a, b, c), into, room = (0.0, 0.0, 0.0), 0.0, 0.0
    if planes.held[p] > 0:
        (a, b, c), room = rooms(planes, p, 0, row(positions, p))
        if pressed[p] > 0 or room <= CLOSED + cap * time_step:
            x, y, z = row(velocities, p)
            into = min(0.0, a * x + b * y + c * z)
    elif pressed[p] == BY_BODY:
        # Edges or vertices of the body hold it, along normals that only their pairs know.
        x, y, z = row(velocities, p)
        into = -math.sqrt(x * x + y * y + z * z)
        a, b, c = x / into, y / into, z / into
    return (a, b, c), into, room


@kernel
def _cap_of(particles, cap, time_step, planes, friction, pressed, positions, velocities):  # type: ignore[no-untyped-def]
    """Where forces would make a particle faster than `cap` it becomes no faster. Returns the largest squared speed, m2/s2."""
    largest = 0.0
    for p in range(particles[0], particles[1]):
        x, y, z = row(velocities, p)
        square = x * x + y * y + z * z
        if square > cap * cap:
            # What presses on the body is not cut: it may be many times the weight, contact takes it, and it holds what pulls beside it in balance. It is no
            # speed either: contact leaves at most the cap of it.
            (a, b, c), into, room = _press_of(p, cap, time_step, planes, pressed, positions, velocities)
            # Nor is what friction will take: against a pull cut to the cap it would hold what it cannot hold.
            most = cap + friction[p] * max(0.0, -into - room / time_step)
            x, y, z = x - into * a, y - into * b, z - into * c
            square = x * x + y * y + z * z
            share = most / math.sqrt(square) if square > most * most else 1.0
            square = min(share * share * square, cap * cap) + min(into * into, cap * cap)
            velocities[p, 0], velocities[p, 1], velocities[p, 2] = share * x + into * a, share * y + into * b, share * z + into * c
        # not a number stays one: the comparison is false
        largest = max(largest, square) if square == square else math.inf
    return largest


@kernel
def _fastest_to_come(controls, planes, pressed, positions, velocities):  # type: ignore[no-untyped-def]
    """Largest speed of rows (N,3), m/s. Where a step of it would go far, of what presses on the body only as much as contact will leave of it: an elastic
    that lies on the body presses at 8 m/s and stays where it is, and so does all of a tight garment while its tension is soft."""
    fastest, count = fastest_of(velocities), len(planes.held)
    if not FAR * controls.covered < controls.surge * (fastest * controls.time_step) < math.inf:
        return fastest
    square = 0.0
    for n in range(len(velocities)):
        x, y, z = row(velocities, n)
        one = x * x + y * y + z * z
        if one <= square:
            continue
        if n < count:
            (a, b, c), into, room = _press_of(n, math.inf, controls.time_step, planes, pressed, positions, velocities)
            stopped = min(0.0, into + max(0.0, room) / controls.time_step)
            x, y, z = x - stopped * a, y - stopped * b, z - stopped * c
            one = x * x + y * y + z * z
        square = max(square, one)
    return math.sqrt(square)


@kernel
def _advance_of(chunk, sums, rates, inertia, planes, friction, pressed, positions, velocities, out):  # type: ignore[no-untyped-def]
    (time_step, cap), particles = rates, chunk_range(chunk, len(sums.weight))
    _add_up_of(chunk, sums)
    bits = _accelerate_of(particles, sums.corner_forces, sums.weight, time_step, inertia, velocities)
    out[0] = np.int64(bits).view(np.float64)
    if not out[0] <= cap * cap:
        out[0] = _cap_of(particles, cap, time_step, planes, friction, pressed, positions, velocities)


@parallel_kernel
def advance_velocities(sums, rates, inertia, planes, friction, pressed, positions, velocities, out):  # type: ignore[no-untyped-def]
    """Velocities in place; rates: time step s, speed cap m/s; inertia: drag (P,) 1/s, inverse masses (P,) 1/kg, `across` (P,3) of inertia.py; planes: of the
    body below; friction (P,): on it; pressed (P,): what held the particle apart in the last step (`Stand.pressed`); out (CHUNKS,2): largest squared speed,
    m2/s2, in the first column, of what presses on the body only up to the cap."""
    for chunk in prange(CHUNKS):
        _advance_of(np.int64(chunk), sums, rates, inertia, planes, friction, pressed, positions, velocities, out[chunk])


@kernel
def _largest(out):  # type: ignore[no-untyped-def]
    square = 0.0
    for chunk in range(len(out)):
        square = max(square, out[chunk, 0])
    return math.sqrt(square)


@row_kernel
def _move_of(nodes, step, velocities, positions):  # type: ignore[no-untyped-def]
    speeds, places = velocities.reshape(-1)[3 * nodes[0] :], positions.reshape(-1)[3 * nodes[0] :]
    for k in range(np.uint64(3 * (nodes[1] - nodes[0]))):
        places[k] += step * speeds[k]


@kernel
def _twice_energy_of(particles, velocities, masses):  # type: ignore[no-untyped-def]
    """Sum of m v^2 of some particles, J, in parts that need not wait for each other."""
    one = other = 0.0
    for p in range(particles[0], particles[1] - 1, 2):
        one += masses[p] * (velocities[p, 0] ** 2 + velocities[p, 1] ** 2 + velocities[p, 2] ** 2)
        other += masses[p + 1] * (velocities[p + 1, 0] ** 2 + velocities[p + 1, 1] ** 2 + velocities[p + 1, 2] ** 2)
    if (particles[1] - particles[0]) % 2:
        p = particles[1] - 1
        one += masses[p] * (velocities[p, 0] ** 2 + velocities[p, 1] ** 2 + velocities[p, 2] ** 2)
    return one + other


@parallel_kernel
def _move(count, step, velocities, masses, positions, out):  # type: ignore[no-untyped-def]
    """Move the first `count` nodes, particles first; sums of m v^2 of parts of the particles into the first column of out (CHUNKS,2). Each thread moves the
    particles whose forces it adds up, so that they stay in its cache."""
    particles = len(masses)
    for chunk in prange(CHUNKS):
        mine, others = chunk_range(chunk, particles), chunk_range(chunk, count - particles)
        _move_of(mine, step, velocities, positions)
        _move_of((particles + others[0], particles + others[1]), step, velocities, positions)
        out[chunk, 0] = _twice_energy_of(mine, velocities, masses)


@entry
@long_kernel
def run_steps(order, controls, forces, stiff, sums, bonds, limit, contact, clock):  # type: ignore[no-untyped-def]
    """Up to a number of steps. order: steps, whether the first begins at its contact part, whether it stops short of moving positions (and takes the forces
    where the cloth is).

    forces: `law_arguments` and the `Acting` of the step; stiff: `StiffParts`, whose particles are none where nothing is; bonds: constraint rows with their
    demanded speeds (see constraints/points.py); contact: arguments of the response, motion of all nodes, home and cover of the candidates, leg of the body and
    seconds since its beginning. clock (6,): out: steps done, friction work J, largest mean square speed, pair that cut the last step (-1: only speeds that the
    response raised) or link that is too long, safe part of the step, speed of the step for which contact must look; that in again where it begins there.

    Returns why it ended.
    """
    (steps, resumed, hold), (laws, acting), asked = order, forces, clock[5]
    rules, (positions, velocities, inverse_masses), (home, covered), (leg, since) = contact
    pace, moves = rules[7], len(leg.first) > 0
    dt, count, out = controls.time_step, len(sums.weight), controls.out
    mark_pressed(rules[5], rules[6])
    motion, mass = (positions, velocities, inverse_masses, dt), sums.masses.sum()
    way, headroom = farthest(positions, home), 0.0
    clock[:] = 0.0
    clock[3], clock[4] = -1.0, 1.0
    for step in range(steps):
        if moves:
            go_with_body(rules, leg, since, motion)
        if step > 0 or not resumed:
            ahead = len(stiff.reach) > 0 and not hold
            if ahead:
                keep_home(stiff.particles, positions, velocities, stiff.home)
                for reach in stiff.reach:
                    write_internal(laws, stiff.acting, positions, velocities, sums.corner_forces)
                    far = (reach * dt * dt, 2.0 * reach * dt)
                    go_on(stiff.particles, stiff.home, (stiff.held, stiff.weight), far, sums, inverse_masses, positions, velocities)
            write_internal(laws, acting, positions, velocities, sums.corner_forces)
            if ahead:
                take_home(stiff.particles, stiff.home, positions, velocities)
            expect(stiff.particles, sums, controls.drag, inverse_masses, dt, velocities, stiff.home)
            inertia = (controls.drag, inverse_masses, controls.across)
            rates, grip = (dt, controls.speed_cap), rules[3]
            advance_velocities(sums, rates, inertia, rules[4], grip.friction, rules[6].pressed, positions, velocities, out)
            fastest = _largest(out)
            if not fastest < controls.runaway:
                return RUNAWAY
            if len(bonds.wanted) > 0:
                apply_bonds(bonds, positions, dt, velocities)
                fastest = _fastest_to_come(controls, rules[4], rules[6].pressed, positions, velocities)
            if len(limit.longest) > 0 and headroom < 2.0 * fastest * dt:
                # No link gains more than twice the way of the fastest particle; until that reaches the headroom none can be too long.
                headroom, nearest = least_headroom(positions, limit)
                if -headroom > (TORN_LENGTH - 1.0) * limit.longest[nearest]:
                    clock[3] = nearest
                    return TORN
                if headroom < 2.0 * fastest * dt:
                    pull_back(positions, limit, inverse_masses, dt, velocities)
                    fastest = _fastest_to_come(controls, rules[4], rules[6].pressed, positions, velocities)
        else:
            fastest = asked
        if not fastest < np.inf:
            return RUNAWAY  # no look would cover that way
        fastest = max(fastest, pace[2])
        # `Contact.detect` goes by the speed in the clock. Where that is less, and the cover enough for it, it does not look, and the step goes on with it.
        if way + controls.surge * (fastest * dt) > covered[0]:
            way = farthest(positions, home)
            if way + controls.surge * (fastest * dt) > covered[0]:
                clock[5] = max(_fastest_to_come(controls, rules[4], rules[6].pressed, positions, velocities), pace[2])
                return LOOK
        part, worst, work, fastest = respond(rules, motion, way, covered[0], fastest)
        clock[1] += work
        if hold:
            return DONE
        note_what_held(stiff.particles, stiff.home, velocities, inverse_masses, dt, stiff.held, stiff.weight)
        _move(len(positions) if moves else count, part * dt, velocities, sums.masses, positions, out)
        since += part * dt
        pace[0], pace[1] = pace[0] + part * dt * pace[2], pace[1] + part * dt * pace[3]
        way += fastest * dt
        headroom -= 2.0 * fastest * dt
        clock[0] += 1.0
        clock[2] = max(clock[2], out[:, 0].sum() / mass)
        if part < 1.0:
            clock[3], clock[4] = worst, part
            return CUT
    return DONE
