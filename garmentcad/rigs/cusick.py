"""Cusick drapemeter: a round specimen hangs over a smaller round disc; its shadow gives the drape coefficient.

The cloth is clamped between two discs, as in the tester: particles up to CLAMPED spacings outside the disc are held, and the first two bend
lines that lead out of the clamp stand for the cloth from the disc's edge on, wherever their particles lie.

It is laid flat with a small random waviness (the lay) and let down: its weight comes on little by little, as where a plate sinks away from under it. Then
the disc is shaken up and down three times and the cloth is left to itself, and at last it settles as a garment does (docs/rigs.md).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from copy import deepcopy
from dataclasses import dataclass, replace
from functools import partial
from typing import NamedTuple

import numpy as np
from scipy.interpolate import CloughTocher2DInterpolator

from garmentcad.cloth.cloth import Cloth
from garmentcad.cloth.lattice import panel_cloth
from garmentcad.cloth.state import State
from garmentcad.contact.contact import Contact
from garmentcad.errors import InputError
from garmentcad.fabric.material import MaterialTable
from garmentcad.forces.assembly import ForceAssembly
from garmentcad.forces.gravity import ForceGravity
from garmentcad.forces.internal import internal_forces, soften
from garmentcad.geometry.curve import Arc
from garmentcad.pattern.pattern import Edge, Panel, Transform
from garmentcad.rigs.shadow import Shadow, cast_shadow, drape_coefficient
from garmentcad.simulation.course import AIR_DRAG, FALL_DRAG, STEPS_PER_LOOK, Course, advance_or_retreat
from garmentcad.simulation.refine import refined, refined_sliders
from garmentcad.solve.dynamics import Dynamics
from garmentcad.solve.strain_limit import strain_limit
from garmentcad.units import GRAVITY_M_S2, M_TO_MM, MM_TO_M

CLAMPED = 0.3
# Arms between the edge of the disc and the first free particle of a bend line. The most is that of a line askew to the edge; from 1.96 on nothing would be
# left for the second line, and such lines, nearly along the edge, hardly bend.
LEAST_FREE, MOST_FREE = CLAMPED, 1.6
WAVINESS_MM = 0.5  # greatest height of a lay
WAVES = 12  # of the waviness around the specimen
LAYS = 5
MAX_TIME_S = 20.0
LOWERED_S = 1.5  # as long as a garment falls, three times the slowest swing of what hangs down
# How fast and how far the disc is shaken is an estimate: 27 mm from top to bottom, so that the cloth always bears on it.
SHAKES, SHAKEN_S, SHAKEN_G = 3, 1.0, 0.5
LEFT_S = 0.5
LOADED_EVERY_S = 5e-3  # the load follows in slices of time, whatever the time step
PROCEDURE = f"let down within {LOWERED_S:g} s, shaken {SHAKES} times within {SHAKEN_S:g} s at {SHAKEN_G:g} g, left alone for {LEFT_S:g} s, settled"


class Geometry(NamedTuple):
    """Diameters in mm."""

    disc_mm: float
    specimen_mm: float


GEOMETRIES = {"18/24": Geometry(180.0, 240.0), "18/30": Geometry(180.0, 300.0), "18/36": Geometry(180.0, 360.0), "12.7/25.4": Geometry(127.0, 254.0)}
USUAL = "18/30"


class Handling(NamedTuple):
    """A part of what is done to a specimen. load: weight over true weight, from the share of the part that is over."""

    seconds: float
    drag: float
    load: Callable[[float], float]


HANDLED = (
    Handling(LOWERED_S, FALL_DRAG, lambda share: share),
    Handling(SHAKEN_S, AIR_DRAG, lambda share: 1.0 + SHAKEN_G * math.sin(2.0 * math.pi * SHAKES * share)),
    Handling(LEFT_S, AIR_DRAG, lambda share: 1.0),
)


@dataclass(frozen=True)
class Drape:
    """One lay at rest. status: converged or max_time; lowest_mm: how far the lowest point lies below the disc."""

    status: str
    cloth: Cloth
    state: State
    shadow: Shadow
    dc_percent: float
    lowest_mm: float


class Drapemeter:
    """The fabric in row 0 of `materials`, clamped on one lattice. origin_mm: a point of the specimen through which a lattice line of either direction passes,
    its centre by default. InputError for an unknown geometry."""

    def __init__(self, materials: MaterialTable, grid_mm: float, geometry: str = USUAL, origin_mm: tuple[float, float] | None = None) -> None:
        if geometry not in GEOMETRIES:
            raise InputError(f"no drapemeter {geometry!r}; allowed are {', '.join(GEOMETRIES)} cm")
        self.geometry = GEOMETRIES[geometry]
        self._materials = materials
        self.cloth = panel_cloth(_disc(0.5 * self.geometry.specimen_mm), materials, grid_mm=grid_mm, origin_mm=origin_mm)
        self._place = MM_TO_M * self.cloth.vertex_uv_mm
        self._clamp = 0.5 * self.geometry.disc_mm * MM_TO_M + CLAMPED * self.cloth.spacing
        self._fixed = np.linalg.norm(self._place, axis=1) <= self._clamp
        self.cloth = _clamped(self.cloth, self._fixed, 0.5 * self.geometry.disc_mm * MM_TO_M)

    def lay(self, seed: int, step_factor: float = 1.0) -> Drape:
        """Lay it down, let it down, shake it. seed: of the lay; the same seed gives the same waviness on any lattice. step_factor: multiplies the time step."""
        positions = self._spread(_waviness(self._place, self._clamp, seed))
        state = State(positions, np.zeros_like(positions), phase="fall", run={"step_factor": step_factor})
        self._handle(state)
        state.phase, state.run["phase_from_s"] = "settle", state.time_s
        return self._to_rest(state, state.time_s + MAX_TIME_S)

    def taken_over(self, other: Drapemeter, drape: Drape) -> Drape:
        """A drape at rest on another lattice settles on this one."""
        before = drape.state
        positions = _on_smooth_surface(other.cloth, before.positions, self.cloth)
        positions[self._fixed] = self._spread(np.zeros(len(positions)))[self._fixed]
        friction = refined_sliders(other.cloth, other._forces(), before, self.cloth, self._forces(), positions)
        state = State(positions, np.zeros_like(positions), before.time_s, before.step, phase="settle", friction=friction, run={"phase_from_s": before.time_s})
        return self._to_rest(state, before.time_s + MAX_TIME_S)

    def waited(self, drape: Drape, seconds: float) -> Drape:
        """What has become of a drape after some more seconds of true motion."""
        state = deepcopy(drape.state)
        state.phase, state.run, end = "watch", {}, state.time_s + seconds
        dynamics = self._dynamics(state)
        self._course(dynamics, "dynamics", end).set_phase(state)
        while state.time_s < end:
            dynamics.advance(state, STEPS_PER_LOOK)
        return self._read(drape.status, state)

    def _handle(self, state: State) -> None:
        """Move `state` through HANDLED."""
        weight = ForceGravity(self.cloth.masses)
        dynamics = self._dynamics(state, weight)
        dynamics.equalise = True
        for part in HANDLED:
            dynamics.drag, began = part.drag, state.time_s
            while (left := began + part.seconds - state.time_s) > 0.5 * state.time_step_s:
                slice_s = min(left, LOADED_EVERY_S)
                weight.gravity = GRAVITY_M_S2 * part.load((state.time_s - began + 0.5 * slice_s) / part.seconds)
                advance_or_retreat(dynamics, state, max(1, round(slice_s / state.time_step_s)))

    def _forces(self, weight: ForceGravity | None = None) -> ForceAssembly:
        return ForceAssembly(internal_forces(self.cloth, self._materials), self.cloth.particle_count, [weight or ForceGravity(self.cloth.masses)])

    def _course(self, dynamics: Dynamics, mode: str, until_s: float) -> Course:
        return Course(dynamics, partial(soften, dynamics.forces.forces, self.cloth, self._materials), mode, until_s)

    def _dynamics(self, state: State, weight: ForceGravity | None = None) -> Dynamics:
        contact = Contact(self.cloth, self._materials)
        dynamics = Dynamics(self.cloth, self._forces(weight), strain_limit(self.cloth, self._materials), contact, fixed=self._fixed)
        dynamics.start(state)
        return dynamics

    def _to_rest(self, state: State, until_s: float) -> Drape:
        status = self._course(self._dynamics(state), "drape", until_s).run(state, lambda progress: None)
        return self._read(status, state)

    def _read(self, status: str, state: State) -> Drape:
        shadow = cast_shadow(state.positions, self.cloth.particle_triangles)
        return Drape(status, self.cloth, state, shadow, drape_coefficient(shadow.area_m2, *self.geometry), -M_TO_MM * float(state.positions[:, 1].min()))

    def _spread(self, heights: np.ndarray) -> np.ndarray:
        """Positions (P,3) m of the flat specimen at these heights: right side up, warp along -z, weft along x."""
        return np.column_stack([self._place[:, 0], heights, -self._place[:, 1]])


def _disc(radius_mm: float) -> Panel:
    right, left = (radius_mm, 0.0), (-radius_mm, 0.0)
    edges = (Edge("upper", "right", "left", Arc(right, left, (0.0, 0.0), False)), Edge("lower", "left", "right", Arc(left, right, (0.0, 0.0), False)))
    return Panel("specimen", edges, 0.0, Transform((0.0, 0.0, 0.0), (0.0, 0.0, 0.0)))


def _clamped(cloth: Cloth, fixed: np.ndarray, radius: float) -> Cloth:
    """The cloth whose bend lines bend from the edge of the disc of this radius [m] on, wherever between two particles it lies. fixed (P,) bool: the particles
    that the clamp holds.

    The first free particle of a line lies a arms beyond the edge. Two bend lines stand together for what is free up to half an arm beyond it: that of the last
    held particle, l0 arms long, and its own, l1. As the cloth would (a cantilever of small deflection), a force on the free particle lowers it, l0 = a^3/3, and
    a moment turns what hangs beyond, l0 + l1 = a + 1/2. Lengths are changed, not widths: the moment that internal friction holds is the cloth's.
    """
    bends = cloth.bends
    place = MM_TO_M * cloth.vertex_uv_mm
    line = np.full((len(place), 2), -1)
    line[bends.center, bends.direction] = np.arange(len(bends.center))
    share = np.ones(len(bends.center))
    for inner, outer, weight in ((bends.arm_b, bends.arm_a, bends.weight_a), (bends.arm_a, bends.arm_b, bends.weight_b)):
        out = np.flatnonzero(fixed[bends.center] & fixed[inner].all(axis=1) & ~fixed[outer].all(axis=1))
        start = place[bends.center[out]]
        way = (1.0 - weight[out])[:, None] * place[outer[out, 0]] + weight[out][:, None] * place[outer[out, 1]] - start
        arm = np.linalg.norm(way, axis=1)
        along = np.sum(start * way, axis=1) / arm
        crossed = along**2 - np.sum(start**2, axis=1) + radius**2
        reach = np.where(crossed > 0.0, 1.0 + (along - np.sqrt(np.maximum(crossed, 0.0))) / arm, MOST_FREE)
        second = np.where(weight[out] == 0.0, line[outer[out, 0], bends.direction[out]], -1)
        paired = second >= 0
        free = np.clip(reach, LEAST_FREE, MOST_FREE)
        share[out] = free**3 / 3.0
        share[second[paired]] = (free + 0.5 - share[out])[paired]
    return replace(cloth, bends=bends._replace(length_a=share * bends.length_a, length_b=share * bends.length_b))


def _on_smooth_surface(here: Cloth, positions: np.ndarray, there: Cloth) -> np.ndarray:
    """Positions (P,3) m on another lattice: on the smooth surface (cubic, by Clough and Tocher) through those of this one, so that cloth need not bend anew,
    which would let go what friction holds; beyond its outermost particles as `refined`."""
    surface = CloughTocher2DInterpolator(here.vertex_uv_mm, positions)(there.vertex_uv_mm)
    return np.where(np.isnan(surface), refined(here, positions, there), surface)


def _waviness(place: np.ndarray, held: float, seed: int) -> np.ndarray:
    """Heights (P,) m of a lay: waves around the specimen of random height and phase that grow from the clamp to the rim."""
    rng = np.random.default_rng(seed)
    heights, phases = rng.standard_normal(WAVES), rng.uniform(0.0, 2.0 * math.pi, WAVES)
    angle, radius = np.arctan2(place[:, 1], place[:, 0]), np.linalg.norm(place, axis=1)
    waves = sum(height * np.cos((k + 1) * angle + phase) for k, (height, phase) in enumerate(zip(heights, phases)))
    grown = np.clip((radius - held) / (radius.max() - held), 0.0, None)
    return np.asarray(WAVINESS_MM * MM_TO_M * waves * grown / np.abs(heights).sum())
