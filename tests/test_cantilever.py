"""The overhanging strip: against an independent boundary value solve, against Peirce's formula where it is good, and against
published ratios; with friction against shooting along the way that the strip was slid."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import solve_bvp
from scipy.optimize import brentq

from garmentcad.fabric.cantilever import bending_from_overhang, overhang_ratio, slid_ratio


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


def slid_by_shooting(held: float, step: float) -> float:
    """Overhang in c at 41.5 degrees of a strip that is slid out by two steps at a time: each shape as an initial value problem from its tip (Runge-Kutta of
    fourth order), theta' = -kappa, m' = s cos(theta), the tip's slope such that the edge is level. kappa + f = m, where f is 15 times the way from the
    slider that the shape before left at that place, h at most. Its error is of the first order in the step."""
    sliders, before = [0.0], (0.0, 0.0)

    def bend(m: float, slider: float) -> float:
        return min(max((m + 15.0 * slider) / 16.0, m - held), m + held)

    def shape(tip: float) -> tuple[np.ndarray, list[float]]:
        y, bends = np.array((tip, 0.0, 0.0, 0.0)), [0.0]  # slope, moment, reach, drop
        for i in range(len(sliders) - 1):
            s = i * step

            def rate(at: float, slider: float, y: np.ndarray) -> np.ndarray:
                return np.array((-bend(y[1], slider), at * math.cos(y[0]), math.cos(y[0]), math.sin(y[0])))

            middle = 0.5 * (sliders[i] + sliders[i + 1])
            a = rate(s, sliders[i], y)
            b = rate(s + 0.5 * step, middle, y + 0.5 * step * a)
            c = rate(s + 0.5 * step, middle, y + 0.5 * step * b)
            d = rate(s + step, sliders[i + 1], y + step * c)
            y = y + step / 6.0 * (a + 2.0 * b + 2.0 * c + d)
            bends.append(bend(y[1], sliders[i + 1]))
        return y, bends

    while True:
        sliders += [0.0, 0.0]
        y, bends = shape(brentq(lambda tip: shape(tip)[0][0], 0.0, 1.57, xtol=1e-7))
        sliders = [min(max(s, k - held / 15.0), k + held / 15.0) for s, k in zip(sliders, bends)]
        angle, length = math.degrees(math.atan2(y[3], y[2])), step * (len(sliders) - 1)
        if angle > 41.5:
            return before[1] + (length - before[1]) * (41.5 - before[0]) / (angle - before[0])
        before = (angle, length)


@pytest.mark.parametrize("held", [0.0, 0.1, 0.5, 2.0])
def test_friction_keeps_what_was_bent_at_the_edge(held: float) -> None:
    """Extrapolated to steps of no length."""
    coarse, fine = (slid_by_shooting(held, step) for step in (0.05, 0.025))
    assert slid_ratio(held) == pytest.approx(2.0 * fine - coarse, rel=1.5e-3)


def test_little_friction_shortens_the_overhang_and_much_lengthens_it() -> None:
    assert slid_ratio(0.1) < 0.98 * overhang_ratio()
    assert slid_ratio(1.0) > 1.2 * overhang_ratio()


@pytest.mark.parametrize("held", [0.05, 0.5, 5.0])
def test_stiffness_of_a_strip_with_friction(held: float) -> None:
    """c = 17.21 mm and H = held B/c give B back from their overhang."""
    c = (1e-5 / 1.962) ** (1 / 3)
    assert bending_from_overhang(slid_ratio(held) * c, 1.962, held * 1e-5 / c) == pytest.approx(1e-5, rel=5e-4)


def test_friction_that_nowhere_gives_way_is_refused() -> None:
    """Then a strip is elastic with 16 B, whose edge bears M = 16 B theta'; the stick springs have 15/16 of it. Just below, B is all but a sixteenth of what
    is read without friction."""
    out, weight = 0.04, 2.0
    elastic = weight * (out / overhang_ratio()) ** 3
    path = solve_bvp(
        lambda t, y: np.vstack((y[1], -(overhang_ratio() ** 3) * (1.0 - t) * np.cos(y[0]))),
        lambda a, b: np.array((a[0], b[1])),
        np.linspace(0.0, 1.0, 201),
        np.vstack((np.linspace(0.0, 0.5, 201), np.full(201, 0.5))),
        tol=1e-9,
    )
    most = 15.0 / 16.0 * elastic * float(path.sol(0.0)[1]) / out
    assert bending_from_overhang(out, weight, 0.999 * most) == pytest.approx(elastic / 16.0, rel=0.01)
    with pytest.raises(ValueError, match="nowhere gives way"):
        bending_from_overhang(out, weight, 1.001 * most)


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
