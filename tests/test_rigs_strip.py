"""Strips under their own weight against the elastica of an inextensible strip, without internal friction and with it."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest
from test_cantilever import slid_by_shooting

from garmentcad.errors import InputError
from garmentcad.fabric.material import MaterialTable, without_friction
from garmentcad.io.fabric_file import fabric_path, load_fabric
from garmentcad.rigs.bias_extension import bias_extension
from garmentcad.rigs.kes import sheet_materials
from garmentcad.rigs.strip import elastic_bending_length, loop_drop, overhang, standard_overhang
from garmentcad.units import GRAVITY_M_S2

SUITING = sheet_materials(load_fabric(fabric_path("wool-suiting")).sheet)
ELASTIC = without_friction(SUITING)
# Gamma = W g L^3/B: tip drop over reach, by shooting from the tip (an initial value problem in the slope, error below 1e-6)
CANTILEVER = {0.1: 0.01250, 1.0: 0.12456, 2.0: 0.24667, 5.0: 0.58572, 10.0: 1.06680, 20.0: 1.86393, 50.0: 3.70556, 100.0: 5.88810}
LENGTHS_MM = {10.0: (195.0, 200.0), 100.0: (195.0, 200.0, 205.0)}  # contour particles beside the rows, and between them
# W g L^3/B: depth over length, from the closed half loop's boundary value problem
LOOPS = {("ring", 152.1): 0.35444, ("heart", 33.1534): 0.152076, ("heart", 697.6): 0.32135, ("pear", 697.6): 0.45065}


def stiff(gamma: float, length_m: float) -> MaterialTable:
    """The fabric with W g L^3/B = gamma in every direction."""
    bending = float(ELASTIC.areal_mass[0]) * GRAVITY_M_S2 * length_m**3 / gamma
    return ELASTIC._replace(bending=np.full((1, 2), bending), twist=np.full(1, 0.5 * bending))


@pytest.mark.parametrize(("gamma", "length_mm"), [(gamma, length) for gamma in CANTILEVER for length in LENGTHS_MM.get(gamma, (200.0,))])
def test_overhang_is_the_elastica(gamma: float, length_mm: float) -> None:
    """At 10 mm, which is at most min(c/4, L/8) for all of them; c = L Gamma^(-1/3)."""
    droop = overhang(stiff(gamma, 1e-3 * length_mm), length_mm, 10.0)
    assert droop.drop_mm / droop.reach_mm == pytest.approx(CANTILEVER[gamma], rel=0.02)


@pytest.mark.parametrize(("shape", "gamma"), LOOPS)
def test_loops_hang_as_deep_as_the_elastica(shape: str, gamma: float) -> None:
    assert loop_drop(stiff(gamma, 0.205), 205.0, 5.0, shape) / 205.0 == pytest.approx(LOOPS[shape, gamma], rel=0.02)


@pytest.mark.parametrize("c_mm", [12.0, 25.0])
def test_the_standard_test_prints_the_bending_length(c_mm: float) -> None:
    """Without friction the overhang is 2.0004 c; strips on an eighth of c as spacing come out 0.2 % too long."""
    fabric = stiff(1.0, 1e-3 * c_mm)
    assert elastic_bending_length(fabric, 90.0) == pytest.approx(1.0002 * c_mm, rel=1e-4)
    assert standard_overhang(fabric, 90.0) == pytest.approx(2.0004 * c_mm, rel=0.005)


@pytest.mark.parametrize("softer", [1.0, 0.1])
def test_the_standard_test_prints_what_friction_keeps(softer: float) -> None:
    """Wool suiting along the weft, whose friction makes the overhang longer (7 %), and with a tenth of it, shorter (2 %), where what hangs down at its full
    length would be longer by 20 and 3 %."""
    fabric = SUITING._replace(bending_friction=softer * SUITING.bending_friction)
    stiffness, weight = float(fabric.bending[0, 1]), float(fabric.areal_mass[0]) * GRAVITY_M_S2
    c = (stiffness / weight) ** (1 / 3)
    expected = 1e3 * c * slid_by_shooting(float(fabric.bending_friction[0, 1]) * c / stiffness, 0.0125)
    assert (expected > 2.0 * elastic_bending_length(fabric, 90.0)) == (softer == 1.0)
    assert standard_overhang(fabric, 90.0) == pytest.approx(expected, rel=0.02)


@pytest.mark.parametrize("ask", [standard_overhang, elastic_bending_length])
def test_a_strip_on_the_bias_is_refused(ask: Callable[[MaterialTable, float], float]) -> None:
    with pytest.raises(InputError, match="45 degrees; allowed are 0"):
        ask(SUITING, 45.0)


@pytest.mark.parametrize(
    ("tested", "key"),
    [
        (lambda fabric: overhang(fabric, 0.0, 5.0), "length_mm"),
        (lambda fabric: overhang(fabric, math.nan, 5.0), "length_mm"),
        (lambda fabric: overhang(fabric, 100.0, 0.0), "length_mm"),
        (lambda fabric: overhang(fabric, 100.0, 5.0, 45.0), "angle_deg"),
        (lambda fabric: loop_drop(fabric, 10.0, 5.0, "ring"), "length_mm"),
        (lambda fabric: loop_drop(fabric, 155.0, 5.0, "star"), "shape"),
        (lambda fabric: loop_drop(fabric, 155.0, 5.0, "ring", 30.0), "angle_deg"),
        (lambda fabric: bias_extension(fabric, 5.0, [10.0, 42.0]), "ways_mm"),
        (lambda fabric: bias_extension(fabric, 5.0, [-1.0]), "ways_mm"),
        (lambda fabric: bias_extension(fabric, 5.0, [math.nan]), "ways_mm"),
        (lambda fabric: bias_extension(fabric, 60.0, [3.0]), "grid_mm"),
    ],
)
def test_what_no_strip_can_be_is_refused(tested: Callable[[MaterialTable], object], key: str) -> None:
    with pytest.raises(InputError) as refused:
        tested(stiff(1.0, 0.1))
    assert refused.value.key == key
