"""Internal friction: the loops of one element against what the KES testers print, exact sticking, stored and lost energy."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest

from garmentcad.fabric import law_bending, law_shear, law_tension
from garmentcad.fabric.internal_friction import dragged
from garmentcad.fabric.law_tension import loading
from garmentcad.fabric.material import material_row
from garmentcad.fabric.missing import complete
from garmentcad.fabric.sheet import sheet_from
from garmentcad.forces.stretch import tension_coefficients, tension_force
from garmentcad.forces.tension_curves import TensionCurves

SHEET = {"schema": 1, "name": "x", "source": "test", "W": 20.0, "LT": 0.6, "EMT": 6.0, "RT": {"warp": 62.0, "weft": 55.0}, "G": 0.6, "2HG": 0.9, "2HG5": 1.8,
         "B": {"warp": 0.12, "weft": 0.08}, "2HB": {"warp": 0.06, "weft": 0.03}}  # fmt: skip
ROW = material_row(complete(sheet_from(SHEET)).sheet)
GF_CM, GF_CM_CM, GF_CM_DEG = 0.980665, 9.80665e-3, 56.1879  # N/m, N, N/m per rad
LOW_K, RISE = (float(column[0]) for column in law_shear.stick_coefficients(np.array([ROW.shear_friction]), np.array([ROW.shear_way])))
BEND_WAY = ROW.bending_friction[0] / (law_bending.STICK * ROW.bending[0])
CURVE = (ROW.tension_friction[0], ROW.tension_strain[0], ROW.tension_force[0], ROW.tension_exponent[0], ROW.tension_slope[0])


def shear(angle: float, slider: float) -> tuple[float, float, float]:
    return law_shear.shear(angle, slider, ROW.shear, LOW_K, RISE, ROW.shear_way)


def bending(curvature: float, slider: float) -> tuple[float, float, float]:
    return law_bending.bending(curvature, slider, ROW.bending[0], BEND_WAY)


def tension(strain: float, slider: float) -> tuple[float, float, float]:
    return law_tension.tension(strain, slider, *CURVE)


ENERGIES = {
    shear: lambda angle, slider: law_shear.shear_energy(angle, slider, ROW.shear, LOW_K, RISE, ROW.shear_way),
    bending: lambda curvature, slider: law_bending.bending_energy(curvature, slider, ROW.bending[0], BEND_WAY),
    tension: lambda strain, slider: law_tension.tension_energy(strain, slider, *CURVE),
}
WAYS = {shear: ROW.shear_way, bending: BEND_WAY, tension: law_tension.WAY * ROW.tension_strain[0]}
SPANS = {shear: math.radians(8.0), bending: 250.0, tension: 1.3 * ROW.tension_strain[0]}


def cycle(law, strains: np.ndarray, slider: float) -> tuple[np.ndarray, float]:
    """Stresses along a path."""
    found = []
    for strain in strains:
        stress, _, slider = law(strain, slider)
        found.append(stress)
    return np.array(found), slider


def loop(law, largest: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Strains, and the stresses of the branches that rise and fall between -largest and largest."""
    up = np.linspace(-largest, largest, 4001)
    _, slider = cycle(law, np.concatenate([np.linspace(0.0, largest, 50), up[::-1]]), 0.0)
    rising, slider = cycle(law, up, slider)
    falling, _ = cycle(law, up[::-1], slider)
    return up, rising, falling[::-1]


def test_shear_loop_is_as_wide_as_printed_at_half_a_degree_and_at_five() -> None:
    angles, rising, falling = loop(shear, math.radians(8.0))
    for degrees, printed in ((0.5, 0.9), (-0.5, 0.9), (5.0, 1.8), (-5.0, 1.8), (2.75, 1.35)):
        width = np.interp(math.radians(degrees), angles, rising) - np.interp(math.radians(degrees), angles, falling)
        assert width == pytest.approx(printed * GF_CM, rel=1e-4)


def test_shear_rises_between_half_and_two_and_a_half_degrees_as_printed_and_goes_on_beyond_eight() -> None:
    angles, rising, _ = loop(shear, math.radians(12.0))
    at = np.radians([0.5, 2.5, 6.0, 8.0, 12.0])
    found = np.interp(at, angles, rising)
    assert (found[1] - found[0]) / (at[1] - at[0]) == pytest.approx(0.6 * GF_CM_DEG, rel=1e-3)
    assert (found[4] - found[3]) / (at[4] - at[3]) == pytest.approx((found[3] - found[2]) / (at[3] - at[2]), rel=1e-9)


def test_bending_loop_is_as_wide_as_printed_and_keeps_at_most_its_residual_curvature() -> None:
    curvatures, rising, falling = loop(bending, 250.0)
    assert np.interp(100.0, curvatures, rising) - np.interp(100.0, curvatures, falling) == pytest.approx(0.06 * GF_CM_CM, rel=1e-9)
    assert (np.interp(150.0, curvatures, rising) - np.interp(50.0, curvatures, rising)) / 100.0 == pytest.approx(0.12 * 9.80665e-5, rel=1e-9)
    residual = float(np.interp(0.0, falling, curvatures))
    bound = 0.06 / (2.0 * 0.12) * 100.0  # 2HB/(2 B), 1/m
    assert residual == pytest.approx(bound, rel=1e-6)


@pytest.mark.parametrize("way", [0, 1])
def test_tension_loads_along_the_printed_curve_and_gives_rt_back(way: int) -> None:
    resilience = (0.62, 0.55)[way]
    curve = (ROW.tension_friction[way], ROW.tension_strain[way], ROW.tension_force[way], ROW.tension_exponent[way], ROW.tension_slope[way])
    em = curve[1]
    strains = np.linspace(0.0, em, 20001)
    up, slider = cycle(lambda e, s: law_tension.tension(e, s, *curve), strains, -law_tension.WAY * em)
    assert up == pytest.approx([loading(e, *curve[1:])[0] for e in strains], rel=1e-12)
    down, _ = cycle(lambda e, s: law_tension.tension(e, s, *curve), strains[::-1], slider)
    assert np.trapezoid(down[::-1], strains) / np.trapezoid(up, strains) == pytest.approx(resilience, rel=1e-6)
    below = strains[::-1] < 0.8 * em  # 0.2 em is what the turn takes
    share = down[below][0] / up[::-1][below][0]
    assert 0.0 < share < resilience
    assert down[below] == pytest.approx(share * up[::-1][below], rel=1e-9)
    half_way = float(np.interp(0.9 * em, strains, down[::-1]))
    assert half_way == pytest.approx(0.5 * (1.0 + share) * loading(0.9 * em, *curve[1:])[0], rel=1e-9)


@pytest.mark.parametrize("law", ENERGIES)
def test_sticking_is_an_exact_spring(law) -> None:
    """Within the way of the slider not one of its bits moves, and the stress is the slope of the stored energy, from every slider."""
    span, way = SPANS[law], WAYS[law]
    rng = np.random.default_rng(2)
    for strain in (0.9 * span, 0.3 * span, 0.04 * span, -0.02 * span, -0.5 * span):
        slider = strain + rng.uniform(-0.9, 0.9) * way
        path = slider + way * rng.uniform(-0.999, 0.999, 1000)
        assert cycle(law, path, slider)[1] == slider
        for turn in (strain - 0.05 * way, strain + 0.05 * way):
            stress, tangent, after = law(turn, slider)
            step = 1e-4 * way
            assert after == slider
            slope = (ENERGIES[law](turn + step, slider) - ENERGIES[law](turn - step, slider)) / (2.0 * step)
            assert slope == pytest.approx(stress, rel=1e-6)
            assert (law(turn + step, slider)[0] - law(turn - step, slider)[0]) / (2.0 * step) == pytest.approx(tangent, rel=1e-6)


@pytest.mark.parametrize("law", ENERGIES)
def test_work_is_what_is_stored_and_lost(law) -> None:
    """Over two turns that slide; the loss counted slider by slider, k taken at the middle of the stick spring."""
    span = SPANS[law]
    strains = np.concatenate([np.linspace(0.0, span, 4000), np.linspace(span, -0.2 * span, 4000), np.linspace(-0.2 * span, 0.7 * span, 4000)])
    slider = -WAYS[law] if law is tension else 0.0
    work = gone = before = 0.0
    for strain, ahead in itertools.pairwise(strains):
        stress, _, after = law(strain, slider)
        middle = 0.5 * (strain + after)
        if law is shear:
            stick = law_shear.stick_stiffness(middle, LOW_K, RISE)
        elif law is bending:
            stick = law_bending.STICK * ROW.bending[0]
        else:
            stick = CURVE[0] / WAYS[law] * max(loading(middle, *CURVE[1:])[0], 0.0)
        gone += stick * WAYS[law] * abs(after - slider)
        slider, before = after, stress
        work += 0.5 * (before + law(ahead, slider)[0]) * (ahead - strain)
    assert gone > 0.1 * abs(work)
    assert work == pytest.approx(ENERGIES[law](strains[-1], slider) + gone, rel=2e-3)


@pytest.mark.parametrize("linearity", [0.45, 0.8, 1.0, 1.1, 1.4])
def test_links_pull_as_the_law_says_and_lose_the_work_of_their_loop(linearity: float) -> None:
    """The branchless copy of the law in the links, for curves that stiffen and that soften: its stress and slider are those of the law, and what it counts as
    lost is the work of a closed turn."""
    row = material_row(complete(sheet_from({**SHEET, "LT": linearity})).sheet)
    curve = [float(column[0]) for column in (row.tension_friction, row.tension_strain, row.tension_force, row.tension_exponent, row.tension_slope)]
    coefficients = tension_coefficients(TensionCurves(*(np.array([value]) for value in curve)), np.array([0]))[:, 0]
    em = curve[1]
    turn = np.concatenate([np.linspace(0.0, 1.2 * em, 6000), np.linspace(1.2 * em, 0.0, 6000)])
    slider = theirs = -law_tension.WAY * em
    _, _, slider = law_tension.tension(0.0, slider, *curve)
    stresses, lost = [], 0.0
    for strain in turn:
        stress, after, gone = tension_force(strain, 0.0, slider, *coefficients)
        expected, _, theirs = law_tension.tension(strain, theirs, *curve)
        assert (stress, after) == (pytest.approx(expected, rel=1e-9, abs=1e-9 * curve[2]), pytest.approx(theirs, abs=1e-15))
        slider = after
        stresses.append(stress)
        lost += gone
    work = np.trapezoid(stresses, turn)
    assert work > 0.1 * np.trapezoid(stresses[:6000], turn[:6000])
    kept = law_tension.tension_energy(0.0, slider, *curve)  # what the stick spring still holds
    assert lost == pytest.approx(work - kept, rel=0.03)  # H by the tangent in the middle of the stick spring: 2 % off where LT is 0.45


def test_moving_a_slider_twice_is_moving_it_once() -> None:
    rng = np.random.default_rng(0)
    for slider, strain, way in rng.uniform(-1.0, 1.0, (200, 3)):
        once = dragged(slider, strain, abs(way))
        assert dragged(once, strain, abs(way)) == once
    assert dragged(0.3, -0.7, 0.0) == -0.7


def test_bias_bending_loses_what_the_sheet_says() -> None:
    """A bend by kappa along the bias bends warp, weft and twist by kappa/2 each: the mean of warp and weft, and half of what twist holds."""
    hold = GF_CM_CM * 0.5
    for bias, expected in ((math.sqrt(0.06 * 0.03), 0.0), (0.05, 2.0 * 0.05 - 0.06 - 0.03)):
        row = material_row(complete(sheet_from({**SHEET, "2HB": {"warp": 0.06, "weft": 0.03, "bias": bias}})).sheet)
        assert row.twist_friction == pytest.approx(hold * expected, abs=1e-12)
        assert 0.5 * (sum(row.bending_friction) + row.twist_friction) >= 0.999 * hold * bias
