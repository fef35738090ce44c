"""What a tester records, and what the printed values are read from: nothing else than the recorded points."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.interpolate import CubicSpline


class Branch(NamedTuple):
    """Points of one way out from zero or back to it: x (N,) deformation, y (N,) force, in the tester's units, in the order of recording."""

    x: np.ndarray
    y: np.ndarray

    def at(self, x: float) -> float:
        """Force at a deformation, between two recorded points."""
        order = np.argsort(self.x)
        return float(np.interp(x, self.x[order], self.y[order]))

    def slope(self, window: tuple[float, float]) -> float:
        """Slope between two deformations."""
        a, b = window
        return (self.at(b) - self.at(a)) / (b - a)

    def energy(self) -> float:
        """Integral of force over deformation, by cubics through the points; negative on the way back."""
        place = np.arange(len(self.x))
        force, deformation = CubicSpline(place, self.y), CubicSpline(place, self.x)
        # a Gauss rule of four nodes between two points is exact for the product of a cubic and the derivative of one
        nodes, weights = np.polynomial.legendre.leggauss(4)
        at = place[:-1, None] + 0.5 * (1.0 + nodes)
        return float((0.5 * weights * force(at) * deformation(at, 1)).sum())


class Loop(NamedTuple):
    """A specimen deformed to one side and back, then to the other side and back, which may be left out. The other side is recorded with its signs."""

    out: Branch
    back: Branch
    out_other: Branch | None = None
    back_other: Branch | None = None

    def slope(self, window: tuple[float, float]) -> float:
        """Mean slope of the ways out."""
        slope = self.out.slope(window)
        return slope if self.out_other is None else 0.5 * (slope + self.out_other.slope((-window[1], -window[0])))

    def width(self, at: float) -> float:
        """Mean distance of way out and way back at a deformation of either sign."""
        width = self.out.at(at) - self.back.at(at)
        if self.out_other is None or self.back_other is None:
            return width
        return 0.5 * (width + self.back_other.at(-at) - self.out_other.at(-at))

    def branches(self) -> tuple[Branch, ...]:
        """Those that were recorded, in order."""
        return tuple(branch for branch in self if branch is not None)
