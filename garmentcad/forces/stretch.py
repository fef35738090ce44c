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
from garmentcad.forces.tension_curves import tension_at, tension_curves

LEAST_EXPONENT = 1e-9  # a linear curve is one with this exponent: it differs by less than the tenth digit
LEAST_LENGTH2 = 1e-30  # m2: a link without length has no direction, and gets no force


# Coefficients (5,S) of the link from each slot to its neighbour: x/em; w k em/x [N]; em; w k [N]; w (k + Fm x/em) [N], the slope beyond em.
COEFFICIENTS = 5


@kernel
def stretch_row(span, links, inverse_rest, damping_time, motion, out):  # type: ignore[no-untyped-def]
    """Forces (3,S) on the first ends of links; span: first slot, slots to the neighbour, number of links; links (5,S): coefficients; motion (6,S)."""
    first, step, count = span
    second = first + step
    xa, ya, za, xb, yb, zb = motion[0, first:], motion[1, first:], motion[2, first:], motion[0, second:], motion[1, second:], motion[2, second:]
    ua, va, wa, ub, vb, wb = motion[3, first:], motion[4, first:], motion[5, first:], motion[3, second:], motion[4, second:], motion[5, second:]
    rate, amplitude, em, repel, beyond = links[0, first:], links[1, first:], links[2, first:], links[3, first:], links[4, first:]
    fx, fy, fz = out[0, first:], out[1, first:], out[2, first:]
    for i in range(np.uint64(count)):
        dx, dy, dz = xb[i] - xa[i], yb[i] - ya[i], zb[i] - za[i]
        inverse = 1.0 / math.sqrt(dx * dx + dy * dy + dz * dz + LEAST_LENGTH2)
        strain = (dx * dx + dy * dy + dz * dz) * inverse * inverse_rest - 1.0
        speed = ((ub[i] - ua[i]) * dx + (vb[i] - va[i]) * dy + (wb[i] - wa[i]) * dz) * inverse * inverse_rest
        inside = min(max(strain, 0.0), em[i])
        force = amplitude[i] * expm1_smooth(rate[i] * inside) + repel[i] * (min(strain, 0.0) + damping_time * speed) + beyond[i] * max(strain - em[i], 0.0)
        force *= inverse
        fx[i], fy[i], fz[i] = force * dx, force * dy, force * dz


class LawStretch(OneLaw):
    """Tension of the links of `cloth`."""

    name = "stretch"

    def __init__(self, cloth: Cloth, materials: MaterialTable) -> None:
        self._links = cloth.links
        self._curve = 2 * cloth.links.material + cloth.links.direction
        self._curves = tension_curves(materials)
        self.corners = cloth.links.ends.ravel()

    def rows(self, slots: LatticeSlots) -> tuple[np.ndarray, np.ndarray]:
        """Coefficients (5,S) of the weft links and of the warp links."""
        links, curves = self._links, self._curves
        exponent = curves.exponent[self._curve]
        exponent = np.where(np.abs(exponent) < LEAST_EXPONENT, LEAST_EXPONENT, exponent)
        em, slope, rate = curves.em[self._curve], curves.slope[self._curve], exponent / curves.em[self._curve]
        found = []
        for direction in (WEFT, WARP):
            mine = np.flatnonzero(links.direction == direction)
            a, b = slots.slot[links.ends[mine]].T
            at = np.minimum(a, b)
            if not (np.maximum(a, b) - at == slots.step(at, direction)).all():
                raise ValueError("a link does not join two neighbours of the lattice")
            width = links.width[mine]
            columns = (
                rate[mine], width * slope[mine] / rate[mine], em[mine], width * slope[mine], width * (slope + rate * curves.fm[self._curve])[mine]
            )  # fmt: skip
            found.append(np.stack([slots.spread(at, column) for column in columns]))
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
