"""Angles by a polynomial against those of `math`."""

from __future__ import annotations

import math

import numpy as np
import pytest

from garmentcad.geometry.angle import angle_over_sine, arcsin, arctan2


def test_angle_over_sine() -> None:
    assert angle_over_sine(1.0) == pytest.approx(1.0, rel=1e-11)
    for angle in np.linspace(1e-3, 0.5 * math.pi, 2001):
        assert angle_over_sine(math.cos(angle)) == pytest.approx(angle / math.sin(angle), rel=1e-11)


def test_angles_of_directions_and_sines() -> None:
    rng = np.random.default_rng(3)
    angle = np.concatenate([rng.uniform(-math.pi, math.pi, 500), 10.0 ** -np.arange(12.0), [0.0, math.pi, 0.5 * math.pi, -0.5 * math.pi]])
    radius = 10.0 ** rng.uniform(-6.0, 6.0, len(angle))
    assert np.allclose(arctan2(radius * np.sin(angle), radius * np.cos(angle)), angle, rtol=2e-11, atol=1e-30)
    quarter = 0.5 * angle
    assert np.allclose(arcsin(np.sin(quarter)), quarter, rtol=2e-11, atol=1e-30)
    assert arctan2(np.zeros(1), np.zeros(1)).tolist() == [0.0]
