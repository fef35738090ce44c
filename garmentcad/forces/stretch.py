"""Stretch and repel: tension along warp and weft in the lattice links.

    E = w l0 f(e)   [J]      e = |x_b - x_a|/l0 - 1
    F = w (T(e) + tau k de/dt)   [N] along the link

T [N/m] is the tensile curve of the sheet and f [J/m2] its integral (fabric/law_tension.py), w the tributary width, l0 the rest length. Damping acts on the
strain rate alone, with the initial slope k of the curve: when a link stiffens its damping ratio falls, so that damping never costs time step.
Source: KES-FB1 curve; pairs of lattice neighbours after Provot (1995).
"""

from __future__ import annotations

import math

import numpy as np

from garmentcad.arrays import kernel
from garmentcad.cloth.cloth import WARP, WEFT, Cloth
from garmentcad.fabric.material import MaterialTable
from garmentcad.forces.force import OneLaw
from garmentcad.forces.rows import LatticeSlots
from garmentcad.forces.smooth import expm1_smooth
from garmentcad.forces.tension_curves import TensionCurves, tension_at, tension_curves

LEAST_EXPONENT = 1e-9  # a linear curve is one with this exponent: it differs by less than the tenth digit
SHORTEST = 1e-2  # in units of the rest length: shorter links lose their force, since one without length has no direction

# Coefficients of a link from each slot to its neighbour: x/em; w k em/x [N]; em. The slope beyond em, k + x Fm/em, is k exp(x).
COEFFICIENTS = 3


@kernel
def tension_force(strain, damped_rate, rate, amplitude, em):  # type: ignore[no-untyped-def]
    """T + tau k de/dt from strain, tau de/dt, x/em, k em/x and em: the curve of law_tension.py with its tangents beyond 0 and em, without branches."""
    inside = min(max(strain, 0.0), em)
    growth = expm1_smooth(rate * inside)
    return amplitude * (growth + rate * ((1.0 + growth) * (strain - inside) + damped_rate))


@kernel
def stretch_row(span, origin, links, rest, damping_time, motion, lines, pull):  # type: ignore[no-untyped-def]
    """Links from each slot to a neighbour; span: first slot in the room, slots to the neighbour, number of links; origin: slot at which the room begins.

    links (3,S): coefficients; motion (6,R). Into lines (4,R): the direction, shortened where a link is shorter than SHORTEST, and
    1/length; into pull (3+,R): the force on the first end.
    """
    first, step, count = span
    second = first + step
    xa, ya, za, xb, yb, zb = motion[0, first:], motion[1, first:], motion[2, first:], motion[0, second:], motion[1, second:], motion[2, second:]
    ua, va, wa, ub, vb, wb = motion[3, first:], motion[4, first:], motion[5, first:], motion[3, second:], motion[4, second:], motion[5, second:]
    rate, amplitude, em = links[0, origin + first :], links[1, origin + first :], links[2, origin + first :]
    ex, ey, ez, inverses = lines[0, first:], lines[1, first:], lines[2, first:], lines[3, first:]
    fx, fy, fz = pull[0, first:], pull[1, first:], pull[2, first:]
    inverse_rest, shortest = 1.0 / rest, SHORTEST * rest
    damping = damping_time * inverse_rest
    for i in range(np.uint64(count)):
        dx, dy, dz = xb[i] - xa[i], yb[i] - ya[i], zb[i] - za[i]
        length = math.sqrt(dx * dx + dy * dy + dz * dz)
        inverse = 1.0 / max(length, shortest)
        dx, dy, dz = dx * inverse, dy * inverse, dz * inverse
        speed = (ub[i] - ua[i]) * dx + (vb[i] - va[i]) * dy + (wb[i] - wa[i]) * dz
        force = tension_force(length * inverse_rest - 1.0, damping * speed, rate[i], amplitude[i], em[i])
        ex[i], ey[i], ez[i], inverses[i] = dx, dy, dz, inverse
        fx[i], fy[i], fz[i] = force * dx, force * dy, force * dz


def tension_coefficients(curves: TensionCurves, rows: np.ndarray, width: np.ndarray | float = 1.0) -> np.ndarray:
    """What `tension_force` needs of the curves in `rows` (N,), times width [m]: (3,N)."""
    exponent = curves.exponent[rows]
    exponent = np.where(np.abs(exponent) < LEAST_EXPONENT, LEAST_EXPONENT, exponent)
    rate = exponent / curves.em[rows]
    return np.stack([rate, width * curves.slope[rows] / rate, curves.em[rows]])


class LawStretch(OneLaw):
    """Tension of the links of `cloth`."""

    name = "stretch"

    def __init__(self, cloth: Cloth, materials: MaterialTable) -> None:
        self._links = cloth.links
        self._curve = 2 * cloth.links.material + cloth.links.direction
        self._curves = tension_curves(materials)
        self.corners = cloth.links.ends.ravel()

    def rows(self, slots: LatticeSlots) -> tuple[np.ndarray, np.ndarray]:
        """Coefficients (3,S) of the weft links and of the warp links."""
        links = self._links
        columns = tension_coefficients(self._curves, self._curve, links.width)
        found = []
        for direction in (WEFT, WARP):
            mine = np.flatnonzero(links.direction == direction)
            a, b = slots.slot[links.ends[mine]].T
            at = np.minimum(a, b)
            if not (np.maximum(a, b) - at == slots.step(at, direction)).all():
                raise ValueError("a link does not join two neighbours of the lattice")
            found.append(np.stack([slots.spread(at, column[mine]) for column in columns]))
        return found[0], found[1]

    def _strain(self, positions: np.ndarray) -> np.ndarray:
        ends = self._links.ends
        return np.linalg.norm(positions[ends[:, 1]] - positions[ends[:, 0]], axis=1) / self._links.rest_length - 1.0

    def energy(self, positions: np.ndarray) -> float:
        energy, _, _ = tension_at(self._curves, self._curve, self._strain(positions))
        return float(np.sum(energy * self._links.width * self._links.rest_length))

    def write_stiffness(self, positions: np.ndarray, out: np.ndarray) -> None:
        # |K_aa| + |K_ab| = 2 max(T', T/(1 + e)) w/l0: along the link, and across it, where only tension stiffens
        strain = self._strain(positions)
        _, force, tangent = tension_at(self._curves, self._curve, strain)
        across = np.where(strain > 0.0, force / (1.0 + np.maximum(strain, 0.0)), 0.0)
        out[:] = np.repeat(2.0 * np.maximum(tangent, across) * self._links.width / self._links.rest_length, 2)

    def write_rest_stiffness(self, out: np.ndarray) -> None:
        """`write_stiffness` at rest, wherever the panels lie."""
        out[:] = np.repeat(2.0 * self._curves.slope[self._curve] * self._links.width / self._links.rest_length, 2)
