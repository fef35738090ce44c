"""What is read from a record, on records made of formulas."""

from __future__ import annotations

import numpy as np
import pytest

from garmentcad.rigs.bending import printed_bending
from garmentcad.rigs.loop import Branch, Loop
from garmentcad.rigs.shear import printed_shear
from garmentcad.rigs.tension import printed_tension


def test_tension_of_a_power_law() -> None:
    # F = Fm u^2: energy Fm em/3, so LT = 2/3; the way back has half of the force, so RT = 50
    u = np.linspace(0.0, 1.0, 30) ** 0.8
    out = Branch(4.0 * u, 500.0 * u**2)
    printed = printed_tension(out, Branch(out.x[::-1], 0.5 * out.y[::-1]))
    assert printed == pytest.approx({"LT": 2.0 / 3.0, "WT": 500.0 * 0.04 / 3.0, "RT": 50.0, "EMT": 4.0}, rel=1e-3)


def loop(largest: float, slope: float, half_width: float) -> Loop:
    """A loop of two parallel lines; the other side is wider by a fifth."""
    x = np.linspace(0.0, largest, 21)
    other = 1.2 * half_width
    return Loop(
        Branch(x, slope * x + half_width),
        Branch(x[::-1], slope * x[::-1] - half_width),
        Branch(-x, -slope * x - other),
        Branch(-x[::-1], -slope * x[::-1] + other),
    )


def test_slopes_and_mean_widths_of_parallel_lines() -> None:
    assert printed_bending(loop(2.5, 0.3, 0.1)) == pytest.approx({"B": 0.3, "2HB": 0.22})
    assert printed_shear(loop(8.0, 0.7, 0.5), (0.5, 2.5)) == pytest.approx({"G": 0.7, "2HG": 1.1, "2HG5": 1.1})


def test_the_first_half_of_a_cycle_is_read_alone() -> None:
    whole = loop(2.5, 0.3, 0.1)
    half = Loop(whole.out, whole.back)
    assert half.branches() == (whole.out, whole.back)
    assert printed_bending(half) == pytest.approx({"B": 0.3, "2HB": 0.2})
    assert len(whole.branches()) == 4
