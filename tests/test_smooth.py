"""Functions without branches against those of `math`."""

from __future__ import annotations

import math

import numpy as np
import pytest

from garmentcad.forces.smooth import arctan_over, expm1_smooth


@pytest.mark.parametrize(("largest", "error"), [(10.0, 1e-12), (60.0, 1e-11)])
def test_expm1(largest: float, error: float) -> None:
    for x in (*np.linspace(-largest, largest, 401), 1e-12, -1e-12, 1e-5, -1e-5):
        assert expm1_smooth(float(x)) == pytest.approx(math.expm1(x), rel=error, abs=0.0)


def test_arctan_over() -> None:
    assert arctan_over(0.0) == 1.0
    for z in np.linspace(1e-6, math.tan(math.pi / 8.0), 200):
        assert arctan_over(float(z * z)) == pytest.approx(math.atan(z) / z, rel=1e-12)
    for z in np.linspace(1e-6, 0.2, 100):
        assert arctan_over(float(z * z)) == pytest.approx(math.atan(z) / z, rel=1e-15)
