"""The way of a body that moves: key frames, and a smooth curve of every vertex through them.

Each vertex follows the cubic of every interval whose velocities at the key frames are those of the parabola through the frame and its neighbours. Velocity is
continuous, so that friction sees the accelerations of the motion and no jolt at each frame; constant acceleration is exact, two frames are a straight way.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from garmentcad.arrays import floats
from garmentcad.errors import InputError

FASTEST_M_S = 10.0  # of a vertex


class Leg(NamedTuple):
    """Motion of a body for some steps: vertices start + t first + t^2 second + t^3 third, t in s from the start of the leg. (V,3) each; no rows: it stands."""

    first: np.ndarray
    second: np.ndarray
    third: np.ndarray

    def at(self, start: np.ndarray, t: float) -> np.ndarray:
        """Vertices (V,3) m that were at `start`, after t s of the leg."""
        return floats(start + t * (self.first + t * (self.second + t * self.third)))


STANDING = Leg(np.zeros((0, 3)), np.zeros((0, 3)), np.zeros((0, 3)))


class BodyPath:
    """Key frames of a body's vertices. It stands still before the first frame and after the last; a motion that begins gently says so by its frames.

    times_s: (K,) rising; vertices: (K,V,3) m. InputError where they do not fit each other, are not finite, or go faster than 10 m/s.
    """

    def __init__(self, times_s: np.ndarray, vertices: np.ndarray) -> None:
        self._times, self._frames = floats(times_s), floats(vertices)
        shape = self._frames.shape
        if self._times.ndim != 1 or len(self._times) == 0 or len(shape) != 3 or shape[0] != len(self._times) or shape[2] != 3:
            raise InputError(f"key frames of times {self._times.shape} and vertices {shape}; wanted (K,) and (K,V,3) with at least one frame")
        if not (np.isfinite(self._times).all() and np.isfinite(self._frames).all()):
            raise InputError("a key frame holds a number that is not finite")
        if not (np.diff(self._times) > 0.0).all():
            raise InputError("the times of key frames must rise")
        for k in range(len(self._times) - 1):
            rate, begins, ends = self._rate(k), self._velocity(k), self._velocity(k + 1)
            # velocity is a parabola in time: at both ends and half-way
            speed = max(float(np.linalg.norm(rates, axis=1).max(initial=0.0)) for rates in (begins, 1.5 * rate - 0.25 * (begins + ends), ends))
            if speed > FASTEST_M_S:
                when = f"between {self._times[k]:g} and {self._times[k + 1]:g} s"
                raise InputError(f"the body goes {speed:.4g} m/s {when}; at most {FASTEST_M_S:g} m/s are allowed")

    @property
    def vertex_count(self) -> int:
        """Vertices V of each key frame."""
        return self._frames.shape[1]

    def at(self, time_s: float) -> np.ndarray:
        """Vertices (V,3) m at a time."""
        return self._motion(time_s, "right")[0]

    def leg(self, time_s: float, span_s: float) -> tuple[np.ndarray, Leg]:
        """Vertices (V,3) m at a time, and the motion of the `span_s` seconds that follow: the cubic that meets place and velocity at both of their ends."""
        start, begins = self._motion(time_s, "right")
        if span_s <= 0.0:
            return start, STANDING
        end, ends = self._motion(time_s + span_s, "left")
        rate = (end - start) / span_s
        if not (begins.any() or ends.any() or rate.any()):
            return start, STANDING
        return start, Leg(begins, floats((3.0 * rate - 2.0 * begins - ends) / span_s), floats((begins + ends - 2.0 * rate) / span_s**2))

    def _rate(self, k: int) -> np.ndarray:
        """(V,3) m/s from frame k to the next one."""
        return (self._frames[k + 1] - self._frames[k]) / (self._times[k + 1] - self._times[k])

    def _velocity(self, k: int) -> np.ndarray:
        """(V,3) m/s at frame k: of the parabola through it and its neighbours, at an end through the three outermost."""
        last = len(self._times) - 1
        if last == 1:
            return self._rate(0)
        middle = min(max(k, 1), last - 1)
        before, after = self._times[middle] - self._times[middle - 1], self._times[middle + 1] - self._times[middle]
        backward, forward = self._rate(middle - 1), self._rate(middle)
        bend = (forward - backward) / (before + after)
        return forward + bend * (2.0 * self._times[k] - self._times[middle] - self._times[middle + 1])

    def _motion(self, time_s: float, side: str) -> tuple[np.ndarray, np.ndarray]:
        """Vertices and velocities (V,3) at a time; where velocity jumps, at both ends of the path, that after the time ('right') or before it ('left')."""
        k = int(np.searchsorted(self._times, time_s, side="right" if side == "right" else "left")) - 1
        if k < 0 or k == len(self._times) - 1:
            frame = self._frames[max(k, 0)]
            return frame.copy(), np.zeros_like(frame)
        length = self._times[k + 1] - self._times[k]
        rate, begins, ends = self._rate(k), self._velocity(k), self._velocity(k + 1)
        t = time_s - self._times[k]
        second, third = (3.0 * rate - 2.0 * begins - ends) / length, (begins + ends - 2.0 * rate) / length**2
        place = self._frames[k] + t * (begins + t * (second + t * third))
        return floats(place), floats(begins + t * (2.0 * second + 3.0 * t * third))
