"""The overhanging strip: against an independent boundary value solve, against Peirce's formula where it is good, and against published ratios."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import solve_bvp

from garmentcad.fabric.cantilever import bending_from_overhang, overhang_ratio


def chord_deg(ratio: float) -> float:
    """Chord angle of a strip of length `ratio` (in c) from its shape theta(t), t from the edge (0) to the tip (1), as a boundary value problem with
    the moment from the weight beyond t: theta'' = -ratio^3 (1 - t) cos(theta), theta(0) = 0, theta'(1) = 0; reach and drop by quadrature."""

    def slopes(t: np.ndarray, y: np.ndarray) -> np.ndarray:
        return np.vstack((y[1], -(ratio**3) * (1.0 - t) * np.cos(y[0])))

    def ends(a: np.ndarray, b: np.ndarray) -> np.ndarray:
        return np.array((a[0], b[1]))

    grid = np.linspace(0.0, 1.0, 201)
    solved = solve_bvp(slopes, ends, grid, np.vstack((grid * 0.5, 0.5 - 0.0 * grid)), tol=1e-9, max_nodes=20_000)
    assert solved.success
    fine = np.linspace(0.0, 1.0, 4001)
    theta = solved.sol(fine)[0]
    return math.degrees(math.atan2(np.trapezoid(np.sin(theta), fine), np.trapezoid(np.cos(theta), fine)))


@pytest.mark.parametrize("angle", [7.1, 20.0, 41.5, 43.0, 60.0])
def test_boundary_value_solve_gives_the_same_angle_back(angle: float) -> None:
    assert chord_deg(overhang_ratio(angle)) == pytest.approx(angle, abs=2e-4)


@pytest.mark.parametrize("held", [0.3, 3.0])
def test_internal_friction_lengthens_the_overhang(held: float) -> None:
    """The strip of this length, bent once out of the flat state, as a boundary value problem: theta' = max(m/16, m - h), the stick spring being 15 times as
    stiff as the cloth, m' = -s cos(theta), s from the tip; theta(0) = 0, m(1) = 0."""
    ratio = overhang_ratio(held=held)

    def slopes(t: np.ndarray, y: np.ndarray) -> np.ndarray:
        return np.vstack((ratio * np.maximum(y[1] / 16.0, y[1] - held), -(ratio**2) * (1.0 - t) * np.cos(y[0])))

    def ends(a: np.ndarray, b: np.ndarray) -> np.ndarray:
        return np.array((a[0], b[1]))

    grid = np.linspace(0.0, 1.0, 401)
    solved = solve_bvp(slopes, ends, grid, np.vstack((grid, (1.0 + held) * (1.0 - grid))), tol=1e-6, max_nodes=50_000)
    assert solved.success
    fine = np.linspace(0.0, 1.0, 4001)
    theta = solved.sol(fine)[0]
    angle = math.degrees(math.atan2(np.trapezoid(np.sin(theta), fine), np.trapezoid(np.cos(theta), fine)))
    assert angle == pytest.approx(41.5, abs=0.01)
    assert ratio > 2.2


def test_standard_angle_is_two_bending_lengths() -> None:
    assert overhang_ratio() == pytest.approx(2.0004, abs=1e-4)


@pytest.mark.parametrize(("angle", "overstated"), [(7.1, 1.0016), (41.5, 1.0575), (60.0, 1.1386)])
def test_peirce_overstates_as_published(angle: float, overstated: float) -> None:
    a = math.radians(angle)
    peirce = (math.cos(a / 2) / (8 * math.tan(a))) ** (1 / 3)  # c/L
    assert (peirce * overhang_ratio(angle)) ** 3 == pytest.approx(overstated, abs=2e-4)


def test_small_angles_are_linear_bending() -> None:
    """Euler beam: tip drop w L^4/(8 B), so that the chord is (L/c)^3/8."""
    assert overhang_ratio(0.6) ** 3 / 8 == pytest.approx(math.tan(math.radians(0.6)), rel=1e-3)


def test_stiffness_of_a_strip() -> None:
    """A fabric of 200 g/m2 with B = 10 uN.m has c = (1e-5/1.962)^(1/3) = 17.21 mm and reaches 41.5 degrees at 34.4 mm."""
    c = (1e-5 / 1.962) ** (1 / 3)
    assert bending_from_overhang(2.0004 * c, 1.962) == pytest.approx(1e-5, rel=2e-4)
