"""Plane curves of pattern outlines, by arc length. Millimetres. Each curve runs over its own parameter t = 0..1; users ask by arc-length fraction."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass
from functools import cached_property
from typing import Any, TypeAlias

import numpy as np
from scipy.interpolate import CubicHermiteSpline

from garmentcad.arrays import floats
from garmentcad.geometry.portable import product

Point: TypeAlias = tuple[float, float]

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(16)
_RELATIVE = 1e-12  # of the length: what two quadratures may differ by, and where Newton stops


@dataclass(frozen=True)
class Curve(ABC):
    """A directed curve from `start` to `end`. Equal curves compare equal; curves are never changed."""

    start: Point
    end: Point

    @abstractmethod
    def evaluate(self, t: np.ndarray, order: int = 0) -> np.ndarray:
        """Position (order 0) or derivative (1, 2) with respect to t in [0, 1]: (N,2)."""

    @abstractmethod
    def part(self, t_a: float, t_b: float, start: Point, end: Point) -> Curve:
        """The piece between two parameters; its ends take the coordinates given."""

    @abstractmethod
    def reversed(self) -> Curve:
        """The same curve from end to start."""

    @abstractmethod
    def mirrored(self, point: Point, direction: Point) -> Curve:
        """The mirror image over the line through `point` along `direction` (any length but zero), from the image of start to that of end."""

    @property
    def breaks(self) -> np.ndarray:
        """Parameters between which the curve is one polynomial or one arc, 0 and 1 included."""
        return np.array([0.0, 1.0])

    @property
    def length(self) -> float:
        """Arc length in mm, to 1e-9 relative."""
        return float(self._table[1][-1])

    @cached_property
    def _table(self) -> tuple[np.ndarray, np.ndarray]:
        """Parameters and the arc length up to each, fine enough that one Gauss rule per interval is exact to round-off."""
        parameters, lengths = [0.0], [0.0]
        scale = float(np.abs(self.evaluate(np.linspace(0.0, 1.0, 17), 1)).max())
        todo = [(float(a), float(b), 0) for a, b in zip(self.breaks[-2::-1], self.breaks[:0:-1])]
        while todo:
            a, b, depth = todo.pop()
            middle = 0.5 * (a + b)
            whole, first, second = self._quadrature(np.array([a, a, middle]), np.array([b, middle, b]))
            halves = first + second
            if abs(whole - halves) <= _RELATIVE * max(halves, scale * (b - a)) or depth == 40:
                parameters.append(b)
                lengths.append(lengths[-1] + halves)
            else:
                todo += [(middle, b, depth + 1), (a, middle, depth + 1)]
        return np.array(parameters), np.array(lengths)

    def _quadrature(self, a: np.ndarray, b: np.ndarray) -> np.ndarray:
        """Arc length between parameters a and b (K,) by one Gauss-Legendre rule of 16 points."""
        half = 0.5 * (b - a)
        nodes = half[:, None] * (_NODES + 1.0) + a[:, None]
        speed = np.hypot(*self.evaluate(nodes.ravel(), 1).T).reshape(nodes.shape)
        return half * product(speed, _WEIGHTS)

    def parameters_at(self, fractions: Any) -> np.ndarray:
        """Parameters t (N,) of arc-length fractions in [0, 1] (clipped): Newton on the length, kept inside a bracket."""
        fractions = np.clip(np.atleast_1d(floats(fractions)), 0.0, 1.0)
        parameters, lengths = self._table
        if lengths[-1] == 0.0:
            return fractions
        target = fractions * lengths[-1]
        interval = np.clip(np.searchsorted(lengths, target, side="right") - 1, 0, len(lengths) - 2)
        base, low, high = parameters[interval], parameters[interval].copy(), parameters[interval + 1].copy()
        span = lengths[interval + 1] - lengths[interval]
        t = low + (high - low) * np.divide(target - lengths[interval], span, out=np.zeros_like(target), where=span > 0.0)
        for _ in range(60):
            error = lengths[interval] + self._quadrature(base, t) - target
            if np.all(np.abs(error) <= _RELATIVE * lengths[-1]):
                break
            low, high = np.where(error < 0.0, t, low), np.where(error > 0.0, t, high)
            speed = np.hypot(*self.evaluate(t, 1).T)
            step = np.divide(error, speed, out=np.full_like(error, np.inf), where=speed > 0.0)
            newton = t - step
            t = np.where((newton > low) & (newton < high), newton, 0.5 * (low + high))
        return t

    def points_at(self, fractions: Any) -> np.ndarray:
        """Points (N,2) at arc-length fractions in [0, 1]; 0 and 1 give `start` and `end` to the bit."""
        fractions = np.atleast_1d(floats(fractions))
        points = self.evaluate(self.parameters_at(fractions))
        points[fractions <= 0.0] = self.start
        points[fractions >= 1.0] = self.end
        return points

    def tangents_at(self, fractions: Any) -> np.ndarray:
        """Unit tangents (N,2) in the direction of travel at arc-length fractions."""
        t = self.parameters_at(fractions)
        tangent = self.evaluate(t, 1)
        speed = np.hypot(*tangent.T)
        still = speed <= 1e-9 * max(self.length, 1e-300)
        if still.any():  # a control point on an end: the direction is the limit from inside
            nudged = np.where(t < 0.5, t + 1e-6, t - 1e-6)
            tangent = np.where(still[:, None], self.evaluate(nudged, 1), tangent)
            speed = np.hypot(*tangent.T)
        return np.divide(tangent, speed[:, None], out=np.zeros_like(tangent), where=speed[:, None] > 0.0)

    def split(self, fractions: Any) -> list[Curve]:
        """The curve cut at rising arc-length fractions inside (0, 1): one piece more than fractions; joints are equal to the bit."""
        inside = [float(fraction) for fraction in np.atleast_1d(floats(fractions))]
        if any(b <= a for a, b in zip([0.0, *inside], [*inside, 1.0])):
            raise ValueError(f"split fractions must rise strictly inside 0..1, came {inside}")
        t = [0.0, *(float(value) for value in self.parameters_at(inside)), 1.0]
        ends = [self.start, *(as_point(point) for point in self.points_at(inside)), self.end]
        return [self.part(t[k], t[k + 1], ends[k], ends[k + 1]) for k in range(len(t) - 1)]

    def polyline(self, tolerance_mm: float = 0.1) -> np.ndarray:
        """Points (N,2) on the curve, both ends included, whose chords stay within `tolerance_mm` of it.

        A chord over a step d of t is off by at most d^2 max|c''| / 8, and |c''| of these curves is largest at breaks.
        """
        bend = np.hypot(*self.evaluate(self.breaks, 2).T)
        t = [np.zeros(1)]
        for k in range(len(self.breaks) - 1):
            a, b = self.breaks[k], self.breaks[k + 1]
            count = max(1, math.ceil((b - a) * math.sqrt(max(bend[k], bend[k + 1]) / (8.0 * tolerance_mm))))
            t.append(np.linspace(a, b, count + 1)[1:])
        points = self.evaluate(np.concatenate(t))
        points[0], points[-1] = self.start, self.end
        return points


def as_point(values: Any) -> Point:
    """Pair of floats."""
    return float(values[0]), float(values[1])


def mirror_point(value: Point, point: Point, direction: Point) -> Point:
    """Image of a point over the line through `point` along `direction`."""
    dx, dy = direction
    x, y = value[0] - point[0], value[1] - point[1]
    along = 2.0 * (x * dx + y * dy) / (dx * dx + dy * dy)
    return point[0] + along * dx - x, point[1] + along * dy - y


@dataclass(frozen=True)
class Line(Curve):
    """Straight line."""

    def evaluate(self, t: np.ndarray, order: int = 0) -> np.ndarray:
        a, b = np.array(self.start), np.array(self.end)
        if order == 0:
            return a + t[:, None] * (b - a)
        return np.tile(b - a if order == 1 else 0.0 * a, (len(t), 1))

    @property
    def length(self) -> float:
        return math.dist(self.start, self.end)

    def parameters_at(self, fractions: Any) -> np.ndarray:
        return np.clip(np.atleast_1d(floats(fractions)), 0.0, 1.0)

    def polyline(self, tolerance_mm: float = 0.1) -> np.ndarray:
        return np.array([self.start, self.end])

    def part(self, t_a: float, t_b: float, start: Point, end: Point) -> Line:
        return Line(start, end)

    def reversed(self) -> Line:
        return Line(self.end, self.start)

    def mirrored(self, point: Point, direction: Point) -> Line:
        return Line(mirror_point(self.start, point, direction), mirror_point(self.end, point, direction))


@dataclass(frozen=True)
class Quadratic(Curve):
    """Quadratic Bezier curve with one control point."""

    control: Point

    def evaluate(self, t: np.ndarray, order: int = 0) -> np.ndarray:
        a, c, b = np.array(self.start), np.array(self.control), np.array(self.end)
        s = t[:, None]
        if order == 0:
            return (1 - s) ** 2 * a + 2 * s * (1 - s) * c + s**2 * b
        return 2 * ((1 - s) * (c - a) + s * (b - c)) if order == 1 else np.tile(2 * (a - 2 * c + b), (len(t), 1))

    def part(self, t_a: float, t_b: float, start: Point, end: Point) -> Quadratic:
        leg = self.evaluate(np.array([t_a]), 1)[0] * (t_b - t_a) / 2
        return Quadratic(start, end, (start[0] + float(leg[0]), start[1] + float(leg[1])))

    def reversed(self) -> Quadratic:
        return Quadratic(self.end, self.start, self.control)

    def mirrored(self, point: Point, direction: Point) -> Quadratic:
        return Quadratic(*(mirror_point(p, point, direction) for p in (self.start, self.end, self.control)))


@dataclass(frozen=True)
class Cubic(Curve):
    """Cubic Bezier curve; control_a belongs to start, control_b to end."""

    control_a: Point
    control_b: Point

    def evaluate(self, t: np.ndarray, order: int = 0) -> np.ndarray:
        a, c, d, b = (np.array(p) for p in (self.start, self.control_a, self.control_b, self.end))
        s = t[:, None]
        r = 1 - s
        if order == 0:
            return r**2 * r * a + 3 * s * r**2 * c + 3 * s**2 * r * d + s**2 * s * b
        return 3 * (r**2 * (c - a) + 2 * s * r * (d - c) + s**2 * (b - d)) if order == 1 else 6 * (r * (a - 2 * c + d) + s * (c - 2 * d + b))

    def part(self, t_a: float, t_b: float, start: Point, end: Point) -> Cubic:
        leg_a, leg_b = self.evaluate(np.array([t_a, t_b]), 1) * (t_b - t_a) / 3
        return Cubic(start, end, (start[0] + float(leg_a[0]), start[1] + float(leg_a[1])), (end[0] - float(leg_b[0]), end[1] - float(leg_b[1])))

    def reversed(self) -> Cubic:
        return Cubic(self.end, self.start, self.control_b, self.control_a)

    def mirrored(self, point: Point, direction: Point) -> Cubic:
        return Cubic(*(mirror_point(p, point, direction) for p in (self.start, self.end, self.control_a, self.control_b)))


@dataclass(frozen=True)
class Arc(Curve):
    """Circular arc about `center`; both ends must lie on the circle. Equal ends mean the full circle."""

    center: Point
    clockwise: bool

    @cached_property
    def radius(self) -> float:
        return math.dist(self.start, self.center)

    @cached_property
    def sweep(self) -> float:
        """Signed angle from start to end, positive counter-clockwise, at most one turn."""
        a = math.atan2(self.start[1] - self.center[1], self.start[0] - self.center[0])
        b = math.atan2(self.end[1] - self.center[1], self.end[0] - self.center[0])
        turn = (a - b if self.clockwise else b - a) % (2 * math.pi) if self.start != self.end else 2 * math.pi
        return -turn if self.clockwise else turn

    def evaluate(self, t: np.ndarray, order: int = 0) -> np.ndarray:
        angle = math.atan2(self.start[1] - self.center[1], self.start[0] - self.center[0]) + self.sweep * t + order * math.pi / 2
        ray = self.radius * self.sweep**order * np.stack([np.cos(angle), np.sin(angle)], axis=1)
        return ray + np.array(self.center) if order == 0 else ray

    @property
    def length(self) -> float:
        return self.radius * abs(self.sweep)

    def parameters_at(self, fractions: Any) -> np.ndarray:
        return np.clip(np.atleast_1d(floats(fractions)), 0.0, 1.0)

    def part(self, t_a: float, t_b: float, start: Point, end: Point) -> Arc:
        return Arc(start, end, self.center, self.clockwise)

    def reversed(self) -> Arc:
        return Arc(self.end, self.start, self.center, not self.clockwise)

    def mirrored(self, point: Point, direction: Point) -> Arc:
        start, end, center = (mirror_point(p, point, direction) for p in (self.start, self.end, self.center))
        return Arc(start, end, center, not self.clockwise)


@dataclass(frozen=True)
class Spline(Curve):
    """Cubic spline, twice continuously differentiable, through start, `through` and end.

    knots: parameter of each of those points (rising; their chord lengths where not given). Tangents are derivatives with respect to the knots, so
    that a vector of unit length is the natural choice with chord lengths; where none is given the end has no curvature.
    """

    through: tuple[Point, ...]
    start_tangent: Point | None = None
    end_tangent: Point | None = None
    knots: tuple[float, ...] | None = None

    @cached_property
    def _knots(self) -> np.ndarray:
        if self.knots is not None:
            return np.array(self.knots)
        points = np.array([self.start, *self.through, self.end])
        return np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])

    @cached_property
    def _spline(self) -> CubicHermiteSpline:
        points = np.array([self.start, *self.through, self.end])
        return CubicHermiteSpline(self._knots, points, _slopes(self._knots, points, self.start_tangent, self.end_tangent))

    @property
    def breaks(self) -> np.ndarray:
        return (self._knots - self._knots[0]) / (self._knots[-1] - self._knots[0])

    def evaluate(self, t: np.ndarray, order: int = 0) -> np.ndarray:
        span = self._knots[-1] - self._knots[0]
        return self._spline(self._knots[0] + t * span, order) * span**order

    def part(self, t_a: float, t_b: float, start: Point, end: Point) -> Spline:
        # The clamped spline through the same knots is unique, so that a piece with its end derivatives is the same curve, not a refit.
        knots = self._knots
        a, b = knots[0] + np.array([t_a, t_b]) * (knots[-1] - knots[0])
        near = 1e-9 * (b - a)
        inner = knots[(knots > a + near) & (knots < b - near)]
        tangent_a, tangent_b = self._spline(np.array([a, b]), 1)
        through = tuple(as_point(point) for point in self._spline(inner))
        return Spline(start, end, through, as_point(tangent_a), as_point(tangent_b), (float(a), *map(float, inner), float(b)))

    def reversed(self) -> Spline:
        tangents = [None if tangent is None else (-tangent[0], -tangent[1]) for tangent in (self.end_tangent, self.start_tangent)]
        knots = None if self.knots is None else tuple(self.knots[0] + self.knots[-1] - knot for knot in self.knots[::-1])
        return Spline(self.end, self.start, self.through[::-1], tangents[0], tangents[1], knots)

    def mirrored(self, point: Point, direction: Point) -> Spline:
        start, end, *through = (mirror_point(p, point, direction) for p in (self.start, self.end, *self.through))
        tangents = [None if tangent is None else mirror_point(tangent, (0.0, 0.0), direction) for tangent in (self.start_tangent, self.end_tangent)]
        return Spline(start, end, tuple(through), tangents[0], tangents[1], self.knots)


def _slopes(knots: np.ndarray, points: np.ndarray, at_start: Point | None, at_end: Point | None) -> np.ndarray:
    """Derivatives (N,2) at the knots that make the cubic spline through points (N,2) twice continuously differentiable; at an end the one given, or, where
    there is none, such that the spline has no curvature there. Elimination in order: a library's gives other last bits on another processor."""
    count, step = len(knots), np.diff(knots)
    chord = np.diff(points, axis=0) / step[:, None]
    below, diagonal, above, right = np.zeros(count), np.ones(count), np.zeros(count), np.zeros((count, 2))
    below[1:-1], above[1:-1], diagonal[1:-1] = step[1:], step[:-1], 2.0 * (step[1:] + step[:-1])
    right[1:-1] = 3.0 * (step[1:, None] * chord[:-1] + step[:-1, None] * chord[1:])
    right[0], right[-1] = 1.5 * chord[0] if at_start is None else at_start, 1.5 * chord[-1] if at_end is None else at_end
    above[0], below[-1] = (0.5 if tangent is None else 0.0 for tangent in (at_start, at_end))
    for k in range(1, count):
        share = below[k] / diagonal[k - 1]
        diagonal[k] -= share * above[k - 1]
        right[k] -= share * right[k - 1]
    slopes = right
    slopes[-1] /= diagonal[-1]
    for k in range(count - 2, -1, -1):
        slopes[k] = (slopes[k] - above[k] * slopes[k + 1]) / diagonal[k]
    return slopes
