"""Functions without branches against those of `math`."""

from __future__ import annotations

import math

import numpy as np
import pytest

from garmentcad.forces.smooth import expm1_smooth


@pytest.mark.parametrize("largest", [1.0, 10.0, 60.0])
def test_expm1(largest: float) -> None:
    for x in (*np.linspace(-largest, largest, 2001), 1e-12, -1e-12, 1e-5, -1e-5):
        assert expm1_smooth(float(x)) == pytest.approx(math.expm1(x), rel=1e-12, abs=0.0)
    assert expm1_smooth(0.0) == 0.0
