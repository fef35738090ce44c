"""Stretch and repel: tension along warp and weft in the lattice links.

    E = w l0 f(e, s)   [J]      e = |x_b - x_a|/l0 - 1
    F = w (T(e, s) + tau k de/dt)   [N] along the link

T [N/m] is the tensile law of the sheet, s its slider, and f [J/m2] what it stores (fabric/law_tension.py), w the tributary width, l0 the rest length.
Damping acts on the strain rate alone, with the initial slope k of the curve: when a link stiffens its damping ratio falls, so that damping never costs time
step.
Source: KES-FB1 curve; pairs of lattice neighbours after Provot (1995).
"""

from __future__ import annotations

import math

import numpy as np

from garmentcad.arrays import indices, kernel, row_kernel
from garmentcad.cloth.cloth import WARP, WEFT, Links
from garmentcad.fabric.internal_friction import dragged
from garmentcad.fabric.law_tension import WAY
from garmentcad.fabric.material import MaterialTable
from garmentcad.forces.force import between
from garmentcad.forces.rows import LatticeSlots, ends
from garmentcad.forces.smooth import expm1_smooth
from garmentcad.forces.tension_curves import TensionCurves, tension_curves, tension_energy_at
from garmentcad.geometry.vectors import lengths, picked

LEAST_EXPONENT = 1e-9  # a linear curve is one with this exponent: it differs by less than the tenth digit
SHORTEST = 1e-2  # in units of the rest length: shorter links lose their force, since one without length has no direction

# Coefficients of a link from each slot to its neighbour: x/em; w k em/x [N]; em; c/(WAY em). The slope beyond em, k + x Fm/em, is k exp(x).
COEFFICIENTS = 4


@kernel
def tension_force(strain, damped_rate, slider, rate, amplitude, em, stick):  # type: ignore[no-untyped-def]
    """T + tau k de/dt from strain, tau de/dt, slider and coefficients, the slider after it and what it lost over its length: law_tension.py, without
    branches."""
    inside = min(max(strain, 0.0), em)
    growth = expm1_smooth(rate * inside)
    slope = rate * (1.0 + growth)
    curve = growth + slope * (strain - inside)
    way = WAY * em
    after = dragged(slider, strain, way)
    held = strain - after
    share = 1.0 + (stick * (held - way) if strain > 0.0 else 0.0)
    # H at the middle of the stick spring, by the tangent; amplitude and curve are both negative where LT > 1
    gone = stick * way * max(amplitude * (curve - 0.5 * slope * held), 0.0) * abs(after - slider)
    return amplitude * (curve * share + rate * damped_rate), after, gone


@kernel
def tension_bound(strain, rate, amplitude, em, stick):  # type: ignore[no-untyped-def]
    """(|K_aa| + |K_ab|) l0 [N] of a link with these coefficients, whatever its slider: 2 max(T', T/(1 + e)), along the link, and across it, where only tension
    stiffens."""
    inside = min(max(strain, 0.0), em)
    growth = expm1_smooth(rate * inside)
    slope = rate * (1.0 + growth)
    tension = max(amplitude * (growth + slope * (strain - inside)), 0.0)
    return 2.0 * max(amplitude * slope + stick * tension, tension / (1.0 + max(strain, 0.0)))


@row_kernel
def stretch_row(span, origin, links, setting, motion, lines, pull, held):  # type: ignore[no-untyped-def]
    """Links from each slot to a neighbour; span: runs of slots (`Blocks.runs`), slots to the neighbour; origin: slot at which the room begins.

    links (4,S): coefficients; setting: rest length, damping time; motion (6+,R). Into lines (4,R): the direction, shortened where a link is shorter than
    SHORTEST, and 1/length; into pull (3+,R): the force on the first end. held: sliders (S,) before, (R,) after, energy lost (R,) [J].
    """
    runs, step = span
    first = runs[0, 0] - origin
    rest, damping_time = setting
    before, after, lost = held
    second = first + step
    xa, ya, za, xb, yb, zb = motion[0, first:], motion[1, first:], motion[2, first:], motion[0, second:], motion[1, second:], motion[2, second:]
    ua, va, wa, ub, vb, wb = motion[3, first:], motion[4, first:], motion[5, first:], motion[3, second:], motion[4, second:], motion[5, second:]
    here = origin + first
    rate, amplitude, em, stick = links[0, here:], links[1, here:], links[2, here:], links[3, here:]
    ex, ey, ez, inverses = lines[0, first:], lines[1, first:], lines[2, first:], lines[3, first:]
    fx, fy, fz = pull[0, first:], pull[1, first:], pull[2, first:]
    slider, moved, gone = before[here:], after[first:], lost[first:]
    inverse_rest, shortest = 1.0 / rest, SHORTEST * rest
    damping = damping_time * inverse_rest
    # Two loops, as one would wait for its root and its division (cell.py); strain and rate stand in for the force meanwhile.
    for run in range(len(runs)):
        begin, end = ends(runs, run)
        for i in range(begin, end):
            dx, dy, dz = xb[i] - xa[i], yb[i] - ya[i], zb[i] - za[i]
            length = math.sqrt(dx * dx + dy * dy + dz * dz)
            inverse = 1.0 / max(length, shortest)
            dx, dy, dz = dx * inverse, dy * inverse, dz * inverse
            speed = (ub[i] - ua[i]) * dx + (vb[i] - va[i]) * dy + (wb[i] - wa[i]) * dz
            ex[i], ey[i], ez[i], inverses[i] = dx, dy, dz, inverse
            fx[i], fy[i] = length * inverse_rest - 1.0, damping * speed
    for run in range(len(runs)):
        begin, end = ends(runs, run)
        for i in range(begin, end):
            force, moved[i], density = tension_force(fx[i], fy[i], slider[i], rate[i], amplitude[i], em[i], stick[i])
            gone[i] += rest * density
            fx[i], fy[i], fz[i] = force * ex[i], force * ey[i], force * ez[i]


def tension_coefficients(curves: TensionCurves, rows: np.ndarray, width: np.ndarray | float = 1.0) -> np.ndarray:
    """What `tension_force` needs of the curves in `rows` (N,), times width [m]: (4,N)."""
    exponent = curves.exponent[rows]
    exponent = np.where(np.abs(exponent) < LEAST_EXPONENT, LEAST_EXPONENT, exponent)
    rate = exponent / curves.em[rows]
    em = curves.em[rows]
    return np.stack([rate, width * curves.slope[rows] / rate, em, curves.friction[rows] / (WAY * em)])


class LawStretch:
    """Tension of links. at: (L,) places of their sliders among the (2 S,) of weft and then warp links."""

    name = "stretch"

    def __init__(self, links: Links, materials: MaterialTable, slots: LatticeSlots) -> None:
        self._links = links
        self.set_curves(materials)
        self.corners = links.ends.ravel()
        a, b = slots.slot[links.ends].T
        first = np.minimum(a, b)
        for direction in (WEFT, WARP):
            mine = links.direction == direction
            if not (np.maximum(a, b) - first == slots.step(first, direction))[mine].all():
                raise ValueError("a link does not join two neighbours of the lattice")
        self.at = indices(np.where(links.direction == WEFT, first, slots.count + first))

    @property
    def _curve(self) -> np.ndarray:
        """(L,) row of each link among the curves."""
        return np.asarray(2 * self._links.material + self._links.direction)

    @property
    def way(self) -> np.ndarray:
        """d (L,)."""
        return np.asarray(WAY * self._curves.em[self._curve])

    def set_curves(self, materials: MaterialTable) -> None:
        """The tensile curves of `materials` from now on; `write_rows` brings them to the kernels."""
        self._curves = tension_curves(materials)

    def write_rows(self, out: np.ndarray) -> None:
        """Coefficients of the weft links and then of the warp links into out (8,S)."""
        columns = tension_coefficients(self._curves, self._curve, self._links.width)
        for k, direction in enumerate((WEFT, WARP)):
            mine = self._links.direction == direction
            out[COEFFICIENTS * k : COEFFICIENTS * (k + 1), self.at[mine] - k * out.shape[1]] = columns[:, mine]

    def slack(self) -> np.ndarray:
        """Sliders (L,) of links that were never stretched."""
        return -self.way

    @property
    def between(self) -> np.ndarray:
        """(L,4) of `Gauge`."""
        return between(self._links.ends)

    def strain(self, positions: np.ndarray) -> np.ndarray:
        first, second = picked(positions, self._links.ends)
        return lengths(second - first) / self._links.rest_length - 1.0

    def energy(self, positions: np.ndarray, sliders: np.ndarray) -> float:
        energy = tension_energy_at(self._curves, self._curve, self.strain(positions), sliders)
        return float(np.sum(energy * self._links.width * self._links.rest_length))

    def rest_stiffness(self) -> np.ndarray:
        """Row sum [N/m] of each corner (2 L,) at rest, wherever the panels lie."""
        return np.repeat(2.0 * self._curves.slope[self._curve] * self._links.width / self._links.rest_length, 2)
