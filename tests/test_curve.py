"""Curves: lengths against closed forms and an independent quadrature, splitting, mirroring and flattening against the curve itself."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad

from garmentcad.geometry.curve import Arc, Cubic, Curve, Line, Quadratic, Spline, mirror_point

CURVES: dict[str, Curve] = {
    "line": Line((1.0, 2.0), (301.0, 402.0)),
    "quadratic": Quadratic((0.0, 0.0), (200.0, 0.0), (150.0, 180.0)),
    "cubic": Cubic((0.0, 0.0), (100.0, 250.0), (120.0, -40.0), (-30.0, 200.0)),
    "cubic_loop": Cubic((0.0, 0.0), (1.0, 0.0), (300.0, 300.0), (-300.0, 300.0)),
    "cubic_control_on_end": Cubic((0.0, 0.0), (100.0, 0.0), (0.0, 0.0), (100.0, 80.0)),
    "arc": Arc((120.0, 0.0), (0.0, 120.0), (0.0, 0.0), False),
    "arc_long": Arc((120.0, 0.0), (0.0, 120.0), (0.0, 0.0), True),
    "spline": Spline((0.0, 0.0), (220.0, 10.0), ((40.0, 60.0), (130.0, 80.0))),
    "spline_tangents": Spline((0.0, 0.0), (220.0, 10.0), ((40.0, 60.0),), (0.0, 1.0), (1.0, 0.0)),
}


@pytest.fixture(params=CURVES, ids=str)
def curve(request: pytest.FixtureRequest) -> Curve:
    return CURVES[request.param]


def reference_length(curve: Curve, t_a: float = 0.0, t_b: float = 1.0) -> float:
    """Adaptive quadrature (QUADPACK) of the speed, which comes from central differences of the position."""

    def speed(t: float) -> float:
        step = 1e-5
        a, b = curve.evaluate(np.array([t - step, t + step]))
        return math.dist(a, b) / (2 * step)

    inner = [float(t) for t in curve.breaks if t_a < t < t_b]
    return quad(speed, t_a, t_b, points=inner or None, limit=400, epsabs=1e-9)[0]


def test_length_against_quadrature(curve: Curve) -> None:
    assert curve.length == pytest.approx(reference_length(curve), rel=2e-7)


def test_length_closed_forms() -> None:
    assert CURVES["line"].length == 500.0
    assert CURVES["arc"].length == pytest.approx(60.0 * math.pi, rel=1e-15)
    assert CURVES["arc_long"].length == pytest.approx(180.0 * math.pi, rel=1e-15)
    # y = x^2/400 over 0..200 as a Bezier curve; parabola arc length in closed form
    parabola = Quadratic((0.0, 0.0), (200.0, 100.0), (100.0, 0.0))
    assert parabola.length == pytest.approx(100.0 * (math.sqrt(2) + math.asinh(1.0)), rel=1e-13)
    assert Cubic((0.0, 0.0), (90.0, 0.0), (30.0, 0.0), (60.0, 0.0)).length == pytest.approx(90.0, rel=1e-13)
    # there and back on a line: a cusp, where the speed is not smooth; turns at t = 1/2, x = 75
    assert Quadratic((0.0, 0.0), (0.0, 0.0), (150.0, 0.0)).length == pytest.approx(150.0, rel=1e-9)


def test_full_circle() -> None:
    circle = Arc((10.0, 0.0), (10.0, 0.0), (0.0, 0.0), True)
    assert circle.length == pytest.approx(20 * math.pi)
    assert circle.points_at(0.25) == pytest.approx(np.array([[0.0, -10.0]]), abs=1e-12)


def test_points_are_equally_far_along(curve: Curve) -> None:
    fractions = np.linspace(0.0, 1.0, 8)
    t = curve.parameters_at(fractions)
    assert np.all(np.diff(t) > 0)
    for a, b in pairwise(t):
        assert reference_length(curve, float(a), float(b)) == pytest.approx(curve.length / 7, rel=1e-6)


def test_ends_are_exact(curve: Curve) -> None:
    points = curve.points_at([0.0, 1.0])
    assert tuple(points[0]) == curve.start
    assert tuple(points[1]) == curve.end
    assert curve.evaluate(np.array([0.0, 1.0])) == pytest.approx(np.array([curve.start, curve.end]), abs=1e-9)


def test_tangents_are_differences(curve: Curve) -> None:
    fractions = np.array([0.1, 0.35, 0.8])
    step = 1e-5
    differences = (curve.points_at(fractions + step) - curve.points_at(fractions - step)) / (2 * step * curve.length)
    assert curve.tangents_at(fractions) == pytest.approx(differences, abs=1e-6)


def test_tangent_at_control_on_end() -> None:
    tangent = CURVES["cubic_control_on_end"].tangents_at(0.0)[0]
    assert tangent == pytest.approx(np.array([100.0, 80.0]) / math.hypot(100.0, 80.0), abs=1e-5)


def test_spline_interpolates_and_is_smooth() -> None:
    spline = CURVES["spline"]
    assert isinstance(spline, Spline)
    assert spline.evaluate(spline.breaks)[1:-1] == pytest.approx(np.array(spline.through), abs=1e-12)
    for t in spline.breaks[1:-1]:  # the second derivative is continuous, and zero at the free ends
        below, above = spline.evaluate(np.array([t - 1e-9, t + 1e-9]), 2)
        assert below == pytest.approx(above, rel=1e-6)
    assert spline.evaluate(np.array([0.0, 1.0]), 2) == pytest.approx(np.zeros((2, 2)), abs=1e-9)
    assert CURVES["spline_tangents"].tangents_at([0.0, 1.0]) == pytest.approx(np.array([[0.0, 1.0], [1.0, 0.0]]), abs=1e-12)


def test_split_is_the_same_curve(curve: Curve) -> None:
    pieces = curve.split([0.2, 0.5, 0.9])
    assert [piece.length / curve.length for piece in pieces] == pytest.approx([0.2, 0.3, 0.4, 0.1], rel=1e-9)
    ends = [0.0, 0.2, 0.5, 0.9, 1.0]
    for piece, a, b in zip(pieces, ends[:-1], ends[1:]):
        inner = np.linspace(0.0, 1.0, 9)
        assert piece.points_at(inner) == pytest.approx(curve.points_at(a + (b - a) * inner), abs=1e-7)
    assert all(a.end == b.start for a, b in pairwise(pieces))
    assert pieces[0].start == curve.start
    assert pieces[-1].end == curve.end
    again = pieces[1].split([0.5])
    assert again[0].end == pytest.approx(tuple(curve.points_at(0.35)[0]), abs=1e-7)


def test_split_refuses_bad_fractions(curve: Curve) -> None:
    for bad in ([0.0], [1.0], [0.5, 0.5], [0.7, 0.2]):
        with pytest.raises(ValueError, match="rise strictly"):
            curve.split(bad)


def test_reversed(curve: Curve) -> None:
    fractions = np.linspace(0.0, 1.0, 11)
    assert curve.reversed().points_at(1.0 - fractions) == pytest.approx(curve.points_at(fractions), abs=1e-8)
    assert curve.reversed().reversed() == curve
    piece = curve.split([0.3, 0.6])[1]  # a spline piece carries its knots
    assert piece.reversed().points_at(1.0 - fractions) == pytest.approx(piece.points_at(fractions), abs=1e-8)


def test_mirrored(curve: Curve) -> None:
    point, direction = (10.0, -5.0), (3.0, 4.0)
    fractions = np.linspace(0.0, 1.0, 11)
    expected = np.array([mirror_point(tuple(p), point, direction) for p in curve.points_at(fractions)])
    assert curve.mirrored(point, direction).points_at(fractions) == pytest.approx(expected, abs=1e-8)
    assert mirror_point((2.0, 7.0), (0.0, 0.0), (0.0, 9.0)) == (-2.0, 7.0)


@pytest.mark.parametrize("tolerance", [1.0, 0.05])
def test_polyline_stays_within_tolerance(curve: Curve, tolerance: float) -> None:
    line = curve.polyline(tolerance)
    dense = curve.points_at(np.linspace(0.0, 1.0, 400))
    a, b = line[:-1, None], line[1:, None]
    d = b - a
    s = np.clip(((dense - a) * d).sum(-1) / (d * d).sum(-1), 0.0, 1.0)
    distance = np.hypot(*np.moveaxis(dense - a - s[..., None] * d, -1, 0)).min(axis=0)
    assert distance.max() <= tolerance * 1.0001
    assert len(line) < 4 * math.sqrt(curve.length / tolerance) + 3


coordinate = st.floats(-500.0, 500.0)
point = st.tuples(coordinate, coordinate)


@given(st.tuples(point, point, point, point), st.lists(st.floats(0.0, 1.0), min_size=1, max_size=4))
def test_any_cubic(points: tuple, fractions: list[float]) -> None:
    a, b, c, d = points
    curve = Cubic(a, b, c, d)
    polygon = curve.polyline(0.01)
    assert math.dist(a, b) - 1e-6 <= curve.length <= math.dist(a, c) + math.dist(c, d) + math.dist(d, b) + 1e-6
    assert curve.length == pytest.approx(np.hypot(*np.diff(polygon, axis=0).T).sum(), rel=1e-3, abs=0.2)
    assert np.isfinite(curve.points_at(fractions)).all()
    assert np.isfinite(curve.tangents_at(fractions)).all()
