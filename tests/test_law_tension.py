"""The tensile curve against its definition, numerical quadrature, central differences and its limits."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.interpolate import CubicSpline

from garmentcad.errors import FabricError
from garmentcad.fabric.law_tension import initial_slope, linearity, loading, loading_energy, solve_exponent, strain_at_force

FM = 490.3325
CURVES = [(0.05, FM, x) for x in (-4.8, -1.0, -1e-3, 0.0, 1e-9, 1e-4, 0.3, 2.27, 8.0)] + [(0.30, 49.03, 3.0), (0.012, FM, 1.5)]


def curve(em: float, fm: float, x: float) -> tuple[float, float, float, float]:
    return em, fm, x, float(initial_slope(em, fm, x))


@pytest.mark.parametrize(("em", "fm", "x"), CURVES)
def test_force_is_the_published_curve(em: float, fm: float, x: float) -> None:
    for u in (1e-6, 1e-3, 0.1, 0.5, 0.9, 1.0):
        expected = fm * u if abs(x) < 1e-8 else fm * math.expm1(x * u) / math.expm1(x)
        assert loading(u * em, *curve(em, fm, x))[0] == pytest.approx(expected, rel=1e-7 if abs(x) < 1e-8 else 1e-12)


@pytest.mark.parametrize(("em", "fm", "x"), CURVES)
def test_energy_force_and_tangent_are_derivatives(em: float, fm: float, x: float) -> None:
    arguments = curve(em, fm, x)
    for u in (-0.4, -0.01, 0.02, 0.3, 0.97, 1.05, 1.6):
        strain, step = u * em, 2e-6 * em
        force, tangent = loading(strain, *arguments)
        energy_slope = (loading_energy(strain + step, *arguments) - loading_energy(strain - step, *arguments)) / (2 * step)
        force_slope = (loading(strain + step, *arguments)[0] - loading(strain - step, *arguments)[0]) / (2 * step)
        assert energy_slope == pytest.approx(force, rel=1e-6, abs=1e-6 * fm)
        assert force_slope == pytest.approx(tangent, rel=1e-6)


@pytest.mark.parametrize("lt", [0.06, 0.3, 0.5, 0.65, 0.999999, 1.0, 1.000001, 1.2, 1.6])
def test_linearity_round_trip_by_quadrature(lt: float) -> None:
    """WT of the curve, integrated numerically, is LT Fm em/2: the definition of LT."""
    em, x = 0.08, solve_exponent(lt)
    arguments = curve(em, FM, x)
    energy = quad(lambda strain: loading(strain, *arguments)[0], 0.0, em, epsabs=1e-12, epsrel=1e-11, limit=200)[0]
    assert energy == pytest.approx(lt * FM * em / 2, rel=1e-9)
    assert loading_energy(em, *arguments) == pytest.approx(lt * FM * em / 2, rel=1e-10)


def test_linearity_series_meets_the_formula() -> None:
    for x in (0.0499999, 0.0500001, 0.1, -0.3, 0.49):
        assert linearity(x) == pytest.approx(2 / x - 2 / math.expm1(x), abs=1e-12)
    assert linearity(1.3) + linearity(-1.3) == pytest.approx(2.0, abs=1e-14)


@pytest.mark.parametrize(("em", "fm", "x"), CURVES)
def test_continuous_at_rest_and_at_em(em: float, fm: float, x: float) -> None:
    arguments = curve(em, fm, x)
    for knot, scale in ((0.0, fm), (em, fm)):
        below, above = (loading(knot + sign * 1e-12 * em, *arguments) for sign in (-1, 1))
        assert below[0] == pytest.approx(above[0], abs=1e-10 * scale)
        assert below[1] == pytest.approx(above[1], rel=1e-9)
        below_e, above_e = (loading_energy(knot + sign * 1e-12 * em, *arguments) for sign in (-1, 1))
        assert below_e == pytest.approx(above_e, abs=1e-10 * scale * em)
    assert loading(em, *arguments)[0] == pytest.approx(fm, rel=1e-14)
    assert loading_energy(0.0, *arguments) == 0.0


def test_small_exponents_do_not_cancel() -> None:
    """Force and energy for x -> 0 go over into the linear law with an error of order x."""
    for x in (1e-3, 1e-6, 1e-9, 1e-12, -1e-6, 0.0):
        for strain in (1e-7, 1e-4, 0.02):
            arguments = curve(0.05, FM, x)
            assert loading(strain, *arguments)[0] == pytest.approx(FM * strain / 0.05, rel=abs(x) + 1e-14)
            assert loading_energy(strain, *arguments) == pytest.approx(FM * strain**2 / 0.1, rel=abs(x) + 1e-14)


def test_energy_is_smooth_where_its_series_ends() -> None:
    em, x = 0.05, 2.27
    arguments = curve(em, FM, x)
    strains = np.linspace(0.8e-2, 1.2e-2, 41) * em / x  # |x u| around 1e-2, where series and formula meet
    forces = CubicSpline(strains, [loading_energy(e, *arguments) for e in strains]).derivative()(strains[5:-5])
    assert forces == pytest.approx([loading(e, *arguments)[0] for e in strains[5:-5]], rel=1e-7)


@pytest.mark.parametrize(("em", "fm", "x"), CURVES)
def test_strain_at_force_inverts_the_curve(em: float, fm: float, x: float) -> None:
    for share in (-0.3, 0.0, 1e-6, 0.2, 1.0, 1.5, 4.0):
        strain = strain_at_force(share * fm, em, fm, x)
        assert loading(strain, *curve(em, fm, x))[0] == pytest.approx(share * fm, rel=1e-9, abs=1e-12)


@pytest.mark.parametrize("lt", [0.0, 0.04, 1.96, -1.0, float("nan"), float("inf")])
def test_impossible_linearity_is_refused(lt: float) -> None:
    with pytest.raises(FabricError, match=r"0\.05\.\.1\.95"):
        solve_exponent(lt)
