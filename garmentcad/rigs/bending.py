"""KES-FB2: pure bending of a specimen 20 cm wide to 2.5 /cm on either side and back.

Both ends are held in rigid clamps, of which one is turned and is free to go where no force acts on it. Curvature is rotation over free length, the moment
that of the reactions at the turned clamp. The tester's specimen is 1 cm long; here at least LEAST_LINKS rows are free, since a tester must not measure one
element. Weight is left out, as on the tester, whose specimen stands upright; so is contact of the rolled-up strip with itself.

A clamp lies midway between two held rows: the bend line centred on the last held row stands for half a link on either side. Where rows run across the
specimen at no constant distance, particles up to RAGGED spacings inside the clamp are held.

Off the grain a bent cell at a free edge looks sheared: where the strip turns by t between two rows, the diagonal along it is a chord, and the trellis angle
t^2/8 too large, which costs a moment in proportion to G (h kappa)^2 kappa; inside, arcs leave a part of higher order (forces/arcs.py). So the curvature goes
only to t h = LARGEST_TURN x 10 mm there, and the window of B goes along.
"""

from __future__ import annotations

import math

import numpy as np

from garmentcad.fabric.material import MaterialTable
from garmentcad.rigs.loop import Branch, Loop
from garmentcad.rigs.specimen import Specimen
from garmentcad.units import GF_CM_CM_TO_N, MM_TO_M

WIDTH_MM = 200.0
LARGEST_PER_CM, STEPS = 2.5, 5  # on each way
WINDOW = (0.2, 0.6)  # of the largest curvature: 0.5 and 1.5 /cm
HYSTERESIS_AT = 0.4  # of the largest curvature: 1.0 /cm
LEAST_LINKS, LEAST_MM = 8, 30.0
LARGEST_FOLD = 2.5  # rad between two rows, along the grain
LARGEST_TURN = 0.08  # rad between two rows at 10 mm
RAGGED = 0.75
GRIP = 3.0  # spacings of cloth in each clamp: elements that stand for the strip along the end lie wholly in it
_CM = 1e-2


def row_distance_mm(grid_mm: float, angle_deg: float) -> float | None:
    """Distance along the specimen of the rows of particles that run straight across it, None where there are none."""
    turned = angle_deg % 90.0
    if turned in (0.0, 45.0):
        return grid_mm * math.cos(math.radians(turned))
    return None


def largest_curvature_per_cm(grid_mm: float, angle_deg: float) -> float:
    """How far a specimen is bent on a lattice."""
    if angle_deg % 90.0 == 0.0:
        return min(LARGEST_PER_CM, LARGEST_FOLD / (0.1 * grid_mm))
    return min(LARGEST_PER_CM, 100.0 * LARGEST_TURN / (grid_mm * (row_distance_mm(grid_mm, angle_deg) or grid_mm)))


def bending_test(materials: MaterialTable, angle_deg: float, grid_mm: float, shift: float = 0.0, sides: int = 2) -> Loop:
    """Curvature [1/cm] and moment per width [gf.cm/cm] over a whole cycle. shift: of the lattice across the specimen, in spacings; sides: 1 for its first
    half."""
    rows = row_distance_mm(grid_mm, angle_deg)
    step = rows or grid_mm
    free_mm = step * max(LEAST_LINKS, math.ceil(LEAST_MM / step))
    grip_mm = GRIP * grid_mm + 0.5 * step
    origin = None if rows is None else (shift * grid_mm, grip_mm + 0.5 * step)
    specimen = Specimen(materials, WIDTH_MM, free_mm + 2.0 * grip_mm, grid_mm, angle_deg, origin, stays_flat=False)
    along = specimen.rest[:, 1] - grip_mm * MM_TO_M
    free = free_mm * MM_TO_M
    inside = (0.5 * step * (1.0 + 1e-6) if rows else RAGGED * grid_mm) * MM_TO_M
    still, turned = np.flatnonzero(along <= inside), np.flatnonzero(along >= free - inside)
    specimen.hold(still, turned)
    modes = specimen.modes([still, turned], [(turned, 1), (turned, 2)])
    shared = np.asarray(modes.sum(axis=0))
    flat = np.column_stack([specimen.rest[:, 0], along, np.zeros(len(along))])
    beside = np.zeros_like(flat)  # how the strip lies beside the roll, in a frame that turns with it: the guess for the next curvature

    def branch(start: float, stop: float) -> Branch:
        nonlocal beside
        points = []
        for per_cm in np.linspace(start, stop, STEPS + 1):
            given = _rolled(flat, still, turned, free, per_cm / _CM, step * MM_TO_M)
            angle = np.clip(per_cm / _CM * along, *sorted((0.0, per_cm / _CM * free)))
            guess = modes.T @ _turned(beside, angle).ravel() / shared
            positions = given + (modes @ specimen.balance.solve(given, modes, guess)).reshape(-1, 3)
            beside = _turned(positions - given, -angle)
            forces = specimen.balance.keep(positions)[turned]
            arms = positions[turned] - positions[turned].mean(axis=0)
            moment = -np.cross(arms, forces)[:, 0].sum() / specimen.width
            points.append((per_cm, moment / GF_CM_CM_TO_N))
        return Branch(*np.array(points).T)

    most = largest_curvature_per_cm(grid_mm, angle_deg)
    ways = ((0.0, most), (most, 0.0), (0.0, -most), (-most, 0.0))
    return Loop(*(branch(*way) for way in ways[: 2 * sides]))


def _rolled(flat: np.ndarray, still: np.ndarray, turned: np.ndarray, free: float, curvature: float, step: float) -> np.ndarray:
    """The strip rolled up between its clamps at y = 0 and y = free, with chords of length `step` from row to row; particles in the clamps lie straight.

    The turned clamp stands in its direction exactly; its place is that of a strip that rolls up evenly.
    """
    if curvature == 0.0:
        return flat.copy()
    half = 0.5 * curvature * step
    radius = step / (2.0 * math.sin(half))
    middle = radius * math.cos(half)  # distance of the middle of a chord, where the clamps are, from the axis
    angle, end = curvature * flat[:, 1], curvature * free
    rolled = np.column_stack([flat[:, 0], radius * np.sin(angle), middle - radius * np.cos(angle)])
    rolled[still] = flat[still]
    beyond = flat[turned, 1] - free
    rolled[turned, 1] = middle * math.sin(end) + beyond * math.cos(end)
    rolled[turned, 2] = middle * (1.0 - math.cos(end)) + beyond * math.sin(end)
    return rolled


def _turned(vectors: np.ndarray, angle: np.ndarray) -> np.ndarray:
    """Vectors (P,3) turned by angles (P,) about the axis of the roll, from y toward z."""
    cosine, sine = np.cos(angle), np.sin(angle)
    return np.column_stack([vectors[:, 0], cosine * vectors[:, 1] - sine * vectors[:, 2], sine * vectors[:, 1] + cosine * vectors[:, 2]])


def printed_bending(loop: Loop) -> dict[str, float]:
    """B (gf.cm2/cm) and 2HB (gf.cm/cm) of the record."""
    most = float(loop.out.x[-1])
    return {"B": loop.slope((WINDOW[0] * most, WINDOW[1] * most)), "2HB": loop.width(HYSTERESIS_AT * most)}
