"""Functions without branches against those of `math`."""

from __future__ import annotations

import math

import numpy as np
import pytest

from garmentcad.forces.smooth import angle_over_sine, expm1_smooth


@pytest.mark.parametrize("largest", [1.0, 10.0, 60.0])
def test_expm1(largest: float) -> None:
    for x in (*np.linspace(-largest, largest, 2001), 1e-12, -1e-12, 1e-5, -1e-5):
        assert expm1_smooth(float(x)) == pytest.approx(math.expm1(x), rel=1e-12, abs=0.0)
    assert expm1_smooth(0.0) == 0.0


def test_angle_over_sine() -> None:
    assert angle_over_sine(1.0) == pytest.approx(1.0, rel=1e-11)
    for angle in np.linspace(1e-3, 0.5 * math.pi, 2001):
        assert angle_over_sine(math.cos(angle)) == pytest.approx(angle / math.sin(angle), rel=1e-11)
