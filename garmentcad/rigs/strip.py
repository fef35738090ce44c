"""A strip in clamps under its own weight: overhanging (ASTM D1388), and bent into a loop (heart, ring, pear; Peirce 1930).

The strip lies in the plane of y (up) and z, x across it. A clamp lies midway between two held rows: the bend line centred on the last held row stands for half
a spacing on either side. Weight comes in little by little, so that the strip finds the shape that it would be let down into.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from scipy.interpolate import PchipInterpolator

from garmentcad.errors import InputError, did_you_mean
from garmentcad.fabric.cantilever import STANDARD_CHORD_DEG, overhang_ratio, slid_ratio
from garmentcad.fabric.material import MaterialTable
from garmentcad.rigs.equilibrium import UnbalancedError
from garmentcad.rigs.specimen import Specimen
from garmentcad.units import GRAVITY_M_S2, M_TO_MM, MM_TO_M

WIDTH_MM = 25.0  # ASTM D1388
GRIP = 2.5  # spacings of cloth in each clamp
LOADS = 6  # steps in which weight comes in
TURNS = 6  # steps in which the clamps of a loop are turned
_INSIDE = 0.5 * (1.0 + 1e-6)  # of a spacing: how far into the free length the last held row stands
_FINENESS, _FINEST_MM, _COARSEST_MM = 8.0, 0.5, 5.0  # spacings in a bending length; lattices of the standard test
_LEAST_SPACINGS = 4  # in a strip; within 2 % of theory from eight on
_SPARE = 1.1  # length of a strip over the overhang that is expected
_READ_FROM = 4  # slides between whose chord angles the overhang is read
SHAPES = {"ring": 0.0, "heart": 0.5 * math.pi, "pear": -0.5 * math.pi}  # by how much each end of a strip in a ring is turned up


class Droop(NamedTuple):
    """From the edge to the middle of the tip, mm."""

    reach_mm: float
    drop_mm: float


def overhang(materials: MaterialTable, length_mm: float, grid_mm: float, angle_deg: float = 0.0) -> Droop:
    """How a strip of the fabric in row 0 of `materials` hangs over an edge; angle_deg: from its length to its warp (a multiple of 90). InputError for another
    angle and for less than four spacings of length, UnbalancedError where it comes to no rest, as a strip of dozens of bending lengths."""
    _allow(length_mm, grid_mm, angle_deg)
    grip = GRIP * grid_mm
    strip = Specimen(materials, WIDTH_MM, grip + length_mm, grid_mm, angle_deg, (0.5 * WIDTH_MM, grip + 0.5 * grid_mm), stays_flat=False)
    along = strip.rest[:, 1] - grip * MM_TO_M
    held = np.flatnonzero(along <= _INSIDE * strip.cloth.spacing)
    strip.hold(held)
    given = np.column_stack([strip.rest[:, 0], np.zeros(len(along)), along])
    positions = _loaded(strip, given, np.zeros_like(given), held)
    _, tip = strip.ends
    return Droop(M_TO_MM * float(positions[tip, 2].mean()), -M_TO_MM * float(positions[tip, 1].mean()))


def standard_overhang(materials: MaterialTable, angle_deg: float = 0.0) -> float:
    """The overhang [mm] at which the chord of a strip of the fabric in row 0 of `materials` lies 41.5 degrees below the horizontal, slid out as ASTM D1388
    does; half of it is the bending length that the standard prints. angle_deg: from the strip's length to its warp, 0 or 90.

    The clamp lets go of one row after another, under the whole weight, so that internal friction keeps what the cloth was bent at the edge, as in a
    laboratory. An eighth of the bending length without friction is the spacing, between 0.5 and 5 mm.
    InputError for other angles, UnbalancedError where a strip comes to no rest.
    """
    scale_mm, held = _scale(materials, angle_deg)
    about = scale_mm * slid_ratio(held)
    grid_mm = min(max(scale_mm / _FINENESS, _FINEST_MM), _COARSEST_MM)
    slides, grip = math.ceil(_SPARE * about / grid_mm), GRIP * grid_mm
    length_mm = grip + slides * grid_mm
    strip = Specimen(materials, WIDTH_MM, length_mm, grid_mm, angle_deg, (0.5 * WIDTH_MM, grip + 0.5 * grid_mm), stays_flat=False)
    along, spacing = strip.rest[:, 1], strip.cloth.spacing
    given = np.column_stack([strip.rest[:, 0], np.zeros(len(along)), along])
    edges = MM_TO_M * length_mm - spacing * np.arange(1, slides + 1)
    last_rows = [np.flatnonzero(np.abs(along - edge) <= _INSIDE * spacing) for edge in edges]
    strip.hold(*last_rows)  # each of them is the clamp's edge once
    positions, angles = given, [0.0]
    for edge in edges:
        held_by_clamp = np.flatnonzero(along <= edge + _INSIDE * spacing)
        positions = _balanced(strip, given, positions - given, held_by_clamp, 1.0)
        _, tip = strip.ends
        angles.append(math.degrees(math.atan2(-positions[tip, 1].mean(), positions[tip, 2].mean() - edge)))
        if angles[-1] >= STANDARD_CHORD_DEG:
            out_mm = grid_mm * np.arange(len(angles))
            return float(PchipInterpolator(angles[-_READ_FROM:], out_mm[-_READ_FROM:])(STANDARD_CHORD_DEG))
    raise UnbalancedError(f"a strip of {length_mm - grip:.0f} mm hangs over to {angles[-1]:.1f} degrees; {STANDARD_CHORD_DEG} were expected at {about:.0f} mm")


def elastic_bending_length(materials: MaterialTable, angle_deg: float = 0.0) -> float:
    """Bending length [mm] of the fabric in row 0 without friction, half the overhang at 41.5 degrees by the exact elastica; angle_deg: 0 or 90. InputError for
    other angles."""
    return 0.5 * overhang_ratio() * _scale(materials, angle_deg)[0]


def _scale(materials: MaterialTable, angle_deg: float) -> tuple[float, float]:
    """c = (B/(W g))^(1/3) [mm] along a standard strip, and what its internal friction holds, H c/B."""
    if angle_deg not in (0.0, 90.0):
        raise InputError(f"a standard strip at {angle_deg:g} degrees; allowed are 0 (along the warp) and 90")
    axis = int(angle_deg == 90.0)
    bending, holds = float(materials.bending[0, axis]), float(materials.bending_friction[0, axis])
    scale = (bending / (GRAVITY_M_S2 * float(materials.areal_mass[0]))) ** (1.0 / 3.0)
    return M_TO_MM * scale, holds * scale / bending


def loop_drop(materials: MaterialTable, length_mm: float, grid_mm: float, shape: str, angle_deg: float = 0.0) -> float:
    """How far [mm] a loop of this length hangs below the clamp that holds both of its ends: level for a ring, upward for a heart, downward for a pear.

    The strip may lie through itself where its ends meet. Lengths of an odd number of spacings have a row at the lowest point. InputError for another shape, an
    angle that is no multiple of 90 and less than four spacings of length.
    """
    if shape not in SHAPES:
        raise InputError(f"a loop {shape!r}{did_you_mean(shape, SHAPES)}", key="shape")
    _allow(length_mm, grid_mm, angle_deg)
    grip = GRIP * grid_mm
    strip = Specimen(materials, WIDTH_MM, length_mm + 2.0 * grip, grid_mm, angle_deg, (0.5 * WIDTH_MM, grip + 0.5 * grid_mm), stays_flat=False)
    along, length = strip.rest[:, 1] - grip * MM_TO_M, length_mm * MM_TO_M
    inside = _INSIDE * strip.cloth.spacing
    first, last = along <= inside, along >= length - inside
    strip.hold(np.flatnonzero(first), np.flatnonzero(last))
    held = np.flatnonzero(first | last)
    # a ring whose chords are a spacing long; in the clamps it lies straight
    turn = 2.0 * math.pi * np.clip(along, 0.0, length) / length
    radius = length / (2.0 * math.pi)
    ring = np.column_stack([strip.rest[:, 0], radius * (np.cos(turn) - 1.0), radius * np.sin(turn)])
    free, positions = np.zeros_like(ring), ring
    for lift in np.linspace(0.0, SHAPES[shape], TURNS + 1 if SHAPES[shape] else 1):
        given = ring.copy()
        for clamp, way, end in ((first, 1.0, 0.0), (last, -1.0, length)):
            beyond = along[clamp] - end
            given[clamp, 1:] = np.outer(beyond, (way * math.sin(lift), math.cos(lift)))
        positions = _balanced(strip, given, free, held, 0.0)
        free = positions - given
    positions = _loaded(strip, given, free, held)
    return -M_TO_MM * float(positions[:, 1].min())


def _allow(length_mm: float, grid_mm: float, angle_deg: float) -> None:
    """InputError for what is no strip on a lattice along its warp or weft."""
    if angle_deg % 90.0 != 0.0:
        raise InputError(f"a strip at {angle_deg:g} degrees to its warp; multiples of 90 are allowed", key="angle_deg")
    if not 0.0 < _LEAST_SPACINGS * grid_mm <= length_mm < math.inf:
        raise InputError(f"a strip of {length_mm:g} mm on a lattice of {grid_mm:g} mm; {_LEAST_SPACINGS} spacings or more are allowed", key="length_mm")


def _loaded(strip: Specimen, given: np.ndarray, free: np.ndarray, held: np.ndarray) -> np.ndarray:
    """Positions (P,3) m under the strip's own weight; free: how far from `given` those that nothing holds begin."""
    for share in np.linspace(0.0, 1.0, LOADS + 1)[1:]:
        free = _balanced(strip, given, free, held, share) - given
    return given + free


def _balanced(strip: Specimen, given: np.ndarray, free: np.ndarray, held: np.ndarray, share: float) -> np.ndarray:
    modes = strip.modes([held])
    weight = np.zeros_like(given)
    weight[:, 1] = -share * GRAVITY_M_S2 * strip.cloth.masses
    positions = given + (modes @ strip.balance.solve(given, modes, modes.T @ free.ravel(), modes.T @ weight.ravel())).reshape(-1, 3)
    strip.balance.keep(positions)
    return positions
