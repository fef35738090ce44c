"""Drafting: values against hand computation, mirror and darts against plane geometry, seams by meeting points, and a message for every fault."""

from __future__ import annotations

import copy
import math
from collections.abc import Callable
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
import shapely

from garmentcad.errors import ExpressionError, InputError, SpecError
from garmentcad.geometry.curve import Arc, Line, Spline
from garmentcad.geometry.polygon import loop_points, signed_area
from garmentcad.pattern.draft import draft, draft_errors
from garmentcad.pattern.parse import parse_spec
from garmentcad.pattern.pattern import Edge, Panel, Pattern, Transform, Wrap
from garmentcad.pattern.runs import resolve_side, side_length, side_notches

BODY = {"waist": 720.0, "hip": 960.0, "waist_height": 1040.0}

# A half front with a dart, drawn clockwise; a back drawn counter-clockwise from it by hand; a band over both.
SKIRT: dict[str, Any] = {
    "schema": 1, "units": "mm", "name": "skirt", "fabric": "wool", "mannequin": "woman",
    "parameters": {"length": {"value": 500, "range": [300, 700]}, "ease": {"value": "hip / 48", "range": [0, 60]}},
    "values": {"half": "(waist + ease) / 4 + intake", "intake": 30},
    "panels": {
        "front": {
            "points": {"top": [0, 0], "bottom": [0, "-length"], "hem_side": ["half + 40", "-length"], "waist_side": ["half", 10]},
            "edges": [
                {"name": "waist", "from": "top", "to": "waist_side", "role": "waist"},
                {"name": "side", "from": "waist_side", "to": "hem_side", "spline": {"through": [["half + 35", -200]], "end_tangent": [0, -2]}, "allowance": 15},
                {"name": "hem", "from": "hem_side", "to": "bottom", "role": "hem"},
                {"name": "center", "from": "bottom", "to": "top"},
            ],
            "grain": 5, "mirror": "center",
            "notches": [{"edge": "side", "at": {"mm": 200, "from": "waist_side"}, "name": "hip"}, {"edge": "waist", "at": 0.1, "name": "x"}],
            "darts": [{"name": "dart", "edge": "waist", "at": {"mm": 90, "from": "top"}, "intake": "intake", "length": 100}],
            "internal_lines": {"hip_line": [[0, -200], [100, -200]]}, "drill_holes": {"pocket": [50, -100]},
            "regions": [{"name": "border", "band": {"edge": "hem", "width": 30}, "factors": {"B": 2}},
                        {"name": "yoke", "polygon": [[10, -20], [60, -20], [60, -60]]}],
            "placement": {"wrap": {"part": "torso", "angle": 0, "height": "waist_height"}},
        },
        "back": {
            "points": {"a": [0, -400], "b": [300, -400], "c": [300, 0], "d": [0, 0], "h": [150, -200]},
            "edges": [
                {"name": "hem", "from": "a", "to": "b"}, {"name": "right", "from": "b", "to": "c"}, {"name": "waist", "from": "c", "to": "d"},
                {"name": "left", "from": "d", "to": "a"},
            ],
            "cutouts": [[{"name": "hole", "from": "h", "to": "h", "arc": {"center": [150, -220], "direction": "counterclockwise"}}]],
            "darts": [
                {"name": "two", "edge": "waist", "at": 0.75, "intake": 20, "length": 100},
                {"name": "one", "edge": "waist", "at": 0.25, "intake": 10, "length": 80},
            ],
            "placement": {"transform": {"translation": [1, 2, 3], "rotation": [0, "deg(atan(1)) * 4", 0]}},
        },
        "twin": {"mirrored_from": "back", "layer": 1, "placement": {"transform": {"translation": [0, 0, 0]}}},
    },
    "seams": [
        {"name": "side", "a": ["front.side.waist_side", "front.side.hem_side"], "b": ["back.right.c", "back.right.b"], "ease": "0.25"},
        {"name": "waist", "a": ["front.waist.waist_side", "front.waist_m.waist_side_m"],
         "b": [["back.waist.c", "back.waist.d"], ["twin.waist.d", "twin.waist.c"]]},
        {"name": "around", "a": ["back.left.d", "back.right.c"], "b": ["front.hem_m.hem_side_m", "front.hem.hem_side"]},
    ],
}  # fmt: skip


def drafted(change: Callable[[dict[str, Any]], Any] = lambda data: None, values: dict[str, float] | None = None) -> Pattern:
    data = copy.deepcopy(SKIRT)
    change(data)
    return draft(parse_spec(data, "skirt.yaml"), BODY, values)


@pytest.fixture(scope="module")
def pattern() -> Pattern:
    return drafted(lambda data: data.update(values={"intake": 30, "half": SKIRT["values"]["half"]}))


def ordered(data: dict[str, Any]) -> None:
    data["values"] = {"intake": 30, "half": SKIRT["values"]["half"]}


def by_name(panel: Panel, name: str) -> list[Edge]:
    return [edge for edge in panel.edges if edge.name == name]


def area(panel: Panel) -> float:
    return signed_area(loop_points([edge.curve for edge in panel.edges], 0.001))


def test_values(pattern: Pattern) -> None:
    assert pattern.values == {"length": 500.0, "ease": 20.0}
    assert pattern.panels["front"].points["waist_side"] == (215.0, 10.0)
    assert pattern.panels["front"].placement == Wrap("torso", (0.0, 0.0), 0.0, 1040.0)
    assert pattern.panels["back"].placement == Transform((1.0, 2.0, 3.0), (0.0, pytest.approx(180.0), 0.0))
    assert (pattern.fabric, pattern.mannequin, pattern.measurements_mm) == ("wool", "woman", BODY)


def test_values_from_outside() -> None:
    changed = drafted(ordered, {"length": 300.0, "ease": 0})
    assert changed.values == {"length": 300.0, "ease": 0.0}
    assert changed.panels["front"].points["waist_side"] == (210.0, 10.0)


def test_loops_are_closed_and_counter_clockwise(pattern: Pattern) -> None:
    for panel in pattern.panels.values():
        for edge, after in pairwise([*panel.edges, panel.edges[0]]):
            assert edge.end == after.start
            assert edge.curve.end == after.curve.start  # to the bit
            assert math.dist(panel.points[edge.end], edge.curve.end) < 1e-9
        assert area(panel) > 0.0
        for hole in panel.holes:
            assert signed_area(loop_points([edge.curve for edge in hole], 0.01)) == pytest.approx(-math.pi * 400, rel=1e-3)


def test_unfolded_panel(pattern: Pattern) -> None:
    front = pattern.panels["front"]
    assert [edge.name for edge in front.edges] == [
        "hem", "side", "waist", "dart_leg_a", "dart_leg_b", "waist",
        "waist_m", "dart_leg_b_m", "dart_leg_a_m", "waist_m", "side_m", "hem_m",
    ]  # fmt: skip
    assert [edge.piece for edge in front.edges] == [0, 0, 1, 0, 0, 2, 1, 0, 0, 2, 0, 0]
    assert front.points["top"] == (0.0, 0.0)
    assert front.points["waist_side_m"] == (-215.0, 10.0)
    assert "top_m" not in front.points
    assert "bottom_m" not in front.points
    outline = shapely.Polygon(loop_points([edge.curve for edge in front.edges], 0.01))
    assert outline.symmetric_difference(shapely.affinity.scale(outline, -1, 1, origin=(0, 0))).area < 1e-6
    drawn = pattern.panels["front"].edges[1].curve
    assert isinstance(drawn, Spline)
    assert drawn.start == front.points["hem_side"]  # drawn clockwise, turned around
    assert drawn.tangents_at(0.0)[0] == pytest.approx([0.0, 1.0], abs=1e-12)
    assert front.drill_holes == {"pocket": (50.0, -100.0), "pocket_m": (-50.0, -100.0)}
    assert front.internal_lines["hip_line_m"] == pytest.approx(np.array([[0.0, -200.0], [-100.0, -200.0]]))
    assert by_name(front, "side_m")[0].seam_allowance_mm == 15.0
    assert by_name(front, "hem_m")[0].role == "hem"
    assert front.grain_deg == 5.0


def test_mirror_over_a_slanted_edge() -> None:
    """A quarter disc mirrored over one of its radii, turned by 30 degrees, is a half disc."""
    c, s = math.cos(math.radians(30)), math.sin(math.radians(30))

    def quarter(data: dict[str, Any]) -> None:
        ordered(data)
        data["panels"] = {"front": {
            "points": {"m": [5, 7], "p": [5 + 100 * c, 7 + 100 * s], "q": [5 - 100 * s, 7 + 100 * c]},
            "edges": [
                {"name": "fold", "from": "m", "to": "p"}, {"name": "round", "from": "p", "to": "q", "arc": {"center": [5, 7], "direction": "counterclockwise"}},
                {"name": "flat", "from": "q", "to": "m"},
            ],
            "mirror": "fold", "placement": SKIRT["panels"]["front"]["placement"],
        }}  # fmt: skip
        data["seams"] = []

    half = drafted(quarter).panels["front"]
    assert area(half) == pytest.approx(math.pi * 1e4 / 2, rel=1e-4)
    assert [edge.name for edge in half.edges] == ["round", "flat", "flat_m", "round_m"]
    assert all(isinstance(edge.curve, Arc) and edge.curve.length == pytest.approx(50 * math.pi) for edge in half.edges if "round" in edge.name)


def test_dart_geometry(pattern: Pattern) -> None:
    front = pattern.panels["front"]
    leg_a, leg_b = by_name(front, "dart_leg_a")[0], by_name(front, "dart_leg_b")[0]
    first, second = by_name(front, "waist")
    along = np.array([215.0, 10.0]) / math.hypot(215, 10)
    middle = 90.0 * along
    assert np.array(leg_a.curve.start) == pytest.approx(middle + 15.0 * along)  # counter-clockwise the outline comes from the side seam
    assert np.array(leg_b.curve.end) == pytest.approx(middle - 15.0 * along)
    apex = np.array(leg_a.curve.end)
    assert (apex - middle) @ along == pytest.approx(0.0, abs=1e-9)
    assert np.linalg.norm(apex - middle) == pytest.approx(100.0)
    assert apex[1] < 0.0  # inside
    assert leg_a.curve.length == pytest.approx(leg_b.curve.length) == pytest.approx(math.hypot(15, 100))
    assert first.curve.length + second.curve.length == pytest.approx(math.hypot(215, 10) - 30.0)
    assert (leg_a.start, leg_a.end, leg_b.end) == ("dart_a", "dart_apex", "dart_b")
    assert leg_a.dart == leg_b.dart == "dart"
    assert second.notches == (("x", pytest.approx(1 - 0.1 * math.hypot(215, 10) / 75.0)),)


def test_dart_takes_its_area_out(pattern: Pattern) -> None:
    back = pattern.panels["back"]
    assert [edge.name for edge in back.edges if edge.dart] == ["one_leg_a", "one_leg_b", "two_leg_a", "two_leg_b"]
    assert area(back) == pytest.approx(300 * 400 - 20 * 100 / 2 - 10 * 80 / 2)
    assert [edge.curve.length for edge in by_name(back, "waist")] == pytest.approx([300 * 0.25 - 5, 150 - 15, 75 - 10])
    assert back.points["one_apex"] == pytest.approx((225.0, -80.0))  # `at` counts from c, the right end


def test_dart_seams_come_by_themselves(pattern: Pattern) -> None:
    seams = {seam.name: seam for seam in pattern.seams}
    assert [name for name in seams if "." in name] == ["front.dart", "front.dart_m", "back.one", "back.two", "twin.two", "twin.one"]
    for name in ("front.dart", "front.dart_m", "twin.one"):
        (a,), (b,) = seams[name].a, seams[name].b
        edges = pattern.panels[a.panel].edges
        assert not a.reverse
        assert b.reverse
        assert edges[a.edge].end == edges[b.edge].start  # both run from the mouth to the apex
        assert edges[a.edge].end.removesuffix("_m").endswith("apex")


def test_mirrored_panel(pattern: Pattern) -> None:
    back, twin = pattern.panels["back"], pattern.panels["twin"]
    assert area(twin) == pytest.approx(area(back))
    assert twin.points["b"] == (-300.0, -400.0)
    assert by_name(twin, "right")[0].curve == Line((-300.0, 0.0), (-300.0, -400.0))
    assert (twin.layer, twin.name, back.layer) == (1, "twin", 0)
    slanted = drafted(lambda data: (ordered(data), data["panels"]["back"].update(grain=30)))
    assert slanted.panels["twin"].grain_deg == -30.0


def test_runs(pattern: Pattern) -> None:
    seams = {seam.name: seam for seam in pattern.seams}

    def path(uses: tuple) -> list[str]:
        return [("-" if use.reverse else "") + pattern.panels[use.panel].edges[use.edge].name for use in uses]

    assert path(seams["side"].a) == ["-side"]
    assert path(seams["waist"].a) == ["waist", "waist", "waist_m", "waist_m"]
    assert path(seams["waist"].b) == ["waist"] * 3 + ["waist"] * 3
    assert [use.panel for use in seams["waist"].b] == ["back"] * 3 + ["twin"] * 3
    assert path(seams["around"].a) == ["left", "hem", "right"]
    assert path(seams["around"].b) == ["hem_m", "hem"]
    assert seams["side"].ease == 0.25
    assert side_length(pattern, seams["waist"].b) == pytest.approx(2 * 270.0)
    assert side_notches(pattern.panels, seams["side"].a) == [("hip", pytest.approx(200.0))]
    length = math.hypot(215, 10)
    assert side_notches(pattern.panels, seams["waist"].a) == [("x", pytest.approx(0.9 * length - 30)), ("x_m", pytest.approx(1.1 * length - 30))]


def test_a_run_along_a_dart_leg_is_that_leg(pattern: Pattern) -> None:
    (use,) = resolve_side(("front.dart_leg_a.dart_a", "front.dart_leg_a.dart_apex"), pattern.panels, "a")
    edge = pattern.panels["front"].edges[use.edge]
    assert (edge.name, edge.start, edge.end, use.reverse) == ("dart_leg_a", "dart_a", "dart_apex", False)


def test_a_band_along_an_edge_that_closes_on_itself_is_a_ring() -> None:
    """A round panel with a hole: 30 mm beside its rim, in pieces that overlap by a hair; the middle is no part of it, and every point of the ring is."""
    disc = {
        "points": {"a": [300, 0], "n": [80, 0]}, "placement": {"transform": {"translation": [0, 0, 0]}},
        "edges": [{"name": "hem", "from": "a", "to": "a", "arc": {"center": [0, 0], "direction": "counterclockwise"}}],
        "cutouts": [[{"name": "neck", "from": "n", "to": "n", "arc": {"center": [0, 0], "direction": "clockwise"}}]],
        "regions": [{"name": "border", "band": {"edge": "hem", "width": 30}, "factors": {"B": 2}}],
    }  # fmt: skip
    pieces = [shapely.Polygon(region.polygon_mm) for region in drafted(lambda data: (ordered(data), data["panels"].update(disc=disc))).panels["disc"].regions]
    wanted = math.pi * (300.0**2 - 270.0**2)
    assert shapely.union_all(pieces).area == pytest.approx(wanted, rel=2e-3)
    assert sum(piece.area for piece in pieces) == pytest.approx(wanted, rel=2e-3)
    ring = [(285.0 * math.cos(t), 285.0 * math.sin(t)) for t in np.linspace(0.0, 2.0 * math.pi, 721)]
    assert all(any(piece.contains(shapely.Point(at)) for piece in pieces) for at in ring)
    assert not any(piece.contains(shapely.Point(0.0, 150.0)) for piece in pieces)


def test_regions(pattern: Pattern) -> None:
    border, yoke, border_m, yoke_m = pattern.panels["front"].regions
    assert (border.name, border_m.name, yoke_m.name) == ("border", "border_m", "yoke_m")
    assert border.factors == {"B": 2.0}
    assert signed_area(border.polygon_mm) == pytest.approx(255 * 30, rel=0.01)
    for region in (border, yoke, border_m, yoke_m):
        assert signed_area(region.polygon_mm) > 0.0
    assert border_m.polygon_mm[:, 0].min() == pytest.approx(-255.0, abs=0.2)
    fused = drafted(lambda data: (ordered(data), data["panels"]["back"].update(interfacing="light")))
    assert (fused.panels["front"].interfacing, fused.panels["back"].interfacing) == (None, "light")


def test_arc_by_radius() -> None:
    for bulge, large, length, side in (("left", False, 90, -1), ("right", False, 90, 1), ("left", True, 270, -1), ("right", True, 270, 1)):
        chord = {"points": {"a": [0, 0], "b": [100, 0], "c": [50, -300]}, "placement": SKIRT["panels"]["front"]["placement"], "edges": [
            {"name": "x", "from": "b", "to": "a", "arc": {"radius": "50 * sqrt(2)", "bulge": bulge, "large": large}},
            {"name": "y", "from": "a", "to": "c"}, {"name": "z", "from": "c", "to": "b"},
        ]}  # fmt: skip
        edge = drafted(lambda data, chord=chord: data.update(panels={"p": chord}, seams=[], values={})).panels["p"].edges[0]
        assert edge.curve.length == pytest.approx(50 * math.sqrt(2) * math.radians(length))
        height = 50 * (math.sqrt(2) + (1 if large else -1))
        assert edge.curve.points_at(0.5)[0] == pytest.approx([50.0, side * height], abs=1e-9)


P = "panels.front"
FAULTS: list[tuple[Callable[[dict[str, Any]], Any], str, str]] = [
    (lambda d: d["values"].update(half="waste / 4"), "values.half", "did you mean 'waist'"),
    (lambda d: d["values"].update(half="half + 1"), "values.half", "unknown name 'half'"),
    (lambda d: d["values"].update(waist=3), "values.waist", "is taken"),
    (lambda d: d["parameters"]["length"].update(value=800), "parameters.length.value", "came 800; allowed is 300 to 700"),
    (lambda d: d["parameters"]["length"].update(range=[7, 3]), "parameters.length.range", "smallest value 7 is larger"),
    (lambda d: d["panels"]["front"]["points"].update(top=["1 / (waist - 720)", 0]), f"{P}.points.top.0", "divides by zero"),
    (lambda d: d["panels"]["front"]["points"].update(top=[0, "1e6 * 2"]), f"{P}.points.top.1", "came 2e+06 (from '1e6 * 2'); allowed is -20000 to 20000"),
    (lambda d: d["panels"]["front"]["edges"][0].update({"from": "tip"}), f"{P}.edges.0.from", "did you mean 'top'"),
    (lambda d: d["panels"]["front"]["edges"][1].update({"from": "top"}), f"{P}.edges.1.from", "open: edge 'waist' ends at 'waist_side' and the next edge"),
    (lambda d: d["panels"]["front"]["edges"].pop(), f"{P}.edges.0.from", "500.0 mm away"),
    (lambda d: d["panels"]["front"]["edges"][1].update(name="waist"), f"{P}.edges.1.name", "a second edge is called 'waist'"),
    (lambda d: d["panels"]["front"]["edges"][0].update(arc={"center": [100, 0], "direction": "clockwise"}), f"{P}.edges.0.arc.center", "100.000 and 115.4"),
    (lambda d: d["panels"]["front"]["edges"][0].update(arc={"radius": 90, "bulge": "left"}), f"{P}.edges.0.arc.radius", "cannot span the chord of 215.232 mm"),
    (lambda d: d["panels"]["front"]["edges"][0].update(spline={"through": [[0, 0]]}), f"{P}.edges.0.spline.through.0", "must differ"),
    (lambda d: d["panels"]["front"]["edges"][1]["spline"].update(end_tangent=[0, 0]), f"{P}.edges.1.spline.end_tangent", "no length"),
    (lambda d: d["panels"]["front"].update(mirror="centre"), f"{P}.mirror", "did you mean 'center'"),
    (lambda d: d["panels"]["front"].update(mirror="side"), f"{P}.mirror", "is not straight"),
    (lambda d: d["panels"]["front"].update(mirror="waist"), f"{P}.mirror", "is cut by a dart"),
    (lambda d: d["panels"]["front"]["points"].update(hem_side_m=[0, 0]), f"{P}.mirror", "would be called 'hem_side_m'"),
    (lambda d: d["panels"]["front"]["darts"][0].update(edge="wast"), f"{P}.darts.0.edge", "did you mean 'waist'"),
    (lambda d: d["panels"]["front"]["darts"][0].update(at=0.02), f"{P}.darts.0", "free is 1.0 to 214.2 mm"),
    (lambda d: d["panels"]["back"]["darts"][0].update(at={"mm": 8, "from": "c"}), "panels.back.darts.0", "from 'c', the mouth of dart 'two' takes -2.0"),
    (lambda d: d["panels"]["back"]["darts"][0].update(at={"mm": 8, "from": "d"}), "panels.back.darts.0", "-2.0 to 18.0 mm of edge 'waist'; free is 1.0 to 219"),
    (lambda d: d["panels"]["front"]["darts"][0].update(at=1.5), f"{P}.darts.0.at", "allowed is 0 to 1, a fraction of the edge; a distance is {mm: 1.5, from"),
    (lambda d: d["panels"]["front"]["darts"][0].update(intake=0), f"{P}.darts.0.intake", "larger than 0"),
    (lambda d: d["panels"]["front"]["darts"][0].update(at={"mm": 5, "from": "bottom"}), f"{P}.darts.0.at.from", "runs from 'top' to 'waist_side'"),
    (lambda d: d["panels"]["front"]["points"].update(dart_apex=[0, 0]), f"{P}.darts.0.name", "makes a point 'dart_apex'"),
    (lambda d: d["panels"]["back"]["darts"][1].update(at=0.73), "panels.back.darts.0", "the dart before it"),
    (lambda d: d["panels"]["back"]["darts"][1].update(name="two"), "panels.back.darts.1.name", "a second dart"),
    (lambda d: d["panels"]["front"]["notches"][1].update(at={"mm": 90, "from": "top"}), f"{P}.darts.0", "a notch of edge 'waist' lies in the mouth"),
    (lambda d: d["panels"]["front"]["notches"][0].update(edge="sid"), f"{P}.notches.0.edge", "did you mean 'side'"),
    (lambda d: d["panels"]["front"]["notches"][1].update(edge="side", name="hip"), f"{P}.notches.1.name", "a second notch"),
    (lambda d: d["panels"]["front"]["notches"][0]["at"].update(mm=9999), f"{P}.notches.0.at.mm", "came 9999; allowed is 0 to 5"),
    (lambda d: d["panels"]["front"]["regions"][0]["band"].update(edge="hen"), f"{P}.regions.0.band.edge", "did you mean 'hem'"),
    (lambda d: d["panels"]["front"]["regions"][1].update(name="border"), f"{P}.regions.1.name", "a second region"),
    (lambda d: d["panels"]["front"]["regions"][0].update(factors={"B": 0}), f"{P}.regions.0.factors.B", "came 0; a factor above 0, up to 10000"),
    (lambda d: d["panels"]["front"]["regions"][0].update(factors={"B": 10001}), f"{P}.regions.0.factors.B", "came 10001; a factor above 0, up to 10000"),
    (lambda d: d["panels"]["front"]["placement"]["wrap"].update(flare=95), f"{P}.placement.wrap.flare", "allowed is -89 to 89"),
    (lambda d: d["panels"]["front"]["placement"]["wrap"].update(flare=5, spiral=5), f"{P}.placement.wrap.spiral", "not on both"),
    (lambda d: d["panels"]["back"]["cutouts"][0][0].update(name="hem"), "panels.back.cutouts.0", "a second edge is called 'hem'"),
    (lambda d: d["panels"]["twin"].update(mirrored_from="bach"), "panels.twin.mirrored_from", "did you mean 'back'"),
    (lambda d: d["panels"]["twin"].update(mirrored_from="twin"), "panels.twin.mirrored_from", "is not a drawn panel"),
    (lambda d: d["seams"][0].update(ease=-0.95), "seams.side.ease", "came -0.95; allowed is -0.9 to 9"),
    (lambda d: d["seams"][0].update(fold_angle=181), "seams.side.fold_angle", "came 181; allowed is -180 to 180"),
    (lambda d: d["seams"][0].update(fold_angle=-181), "seams.side.fold_angle", "came -181; allowed is -180 to 180"),
    (lambda d: d["seams"][0].update(bend_factor=-1), "seams.side.bend_factor", "allowed is 0 to 1000"),
    (lambda d: d["seams"][0].update(a=["frond.side.waist_side", "front.side.hem_side"]), "seams.side.a.0", "did you mean 'front'"),
    (lambda d: d["seams"][0].update(a=["front.side.waist_side", "front.sid.hem_side"]), "seams.side.a.1", "did you mean 'side'"),
    (lambda d: d["seams"][0].update(a=["front.center.top", "front.center.bottom"]), "seams.side.a.0", "a mirror edge goes"),
    (lambda d: d["seams"][0].update(a=["front.side.top", "front.side.hem_side"]), "seams.side.a.0", "does not end at 'top'"),
    (lambda d: d["seams"][0].update(a=["front.side.waist_side", "back.right.b"]), "seams.side.a", "one run for each panel"),
    (lambda d: d["seams"][0].update(a=["front.side.hem_side", "front.waist.waist_side"]), "seams.side.a", "no way along the outline"),
    (lambda d: d["seams"][0].update(a=["back.hole.h", "back.hole.h"]), "seams.side.a.0", "belongs to a cutout"),
    (lambda d: d["seams"][1]["b"].__setitem__(1, ["twin.waist.d", "twin.waist.a"]), "seams.waist.b.1.1", "does not end at 'a'"),
    (lambda d: d["seams"][1].update(name="side"), "seams.1.name", "a second seam is called 'side'"),
]


@pytest.mark.parametrize(("change", "key", "message"), FAULTS, ids=[fault[1] for fault in FAULTS])
def test_faults(change: Callable[[dict[str, Any]], Any], key: str, message: str) -> None:
    with pytest.raises(InputError) as caught:
        drafted(lambda data: (ordered(data), change(data)))
    assert isinstance(caught.value, (SpecError, ExpressionError))
    assert (caught.value.file, caught.value.key) == ("skirt.yaml", key)
    assert message in caught.value.message


def named_twice(change: Callable[[dict[str, Any]], Any], mirror: str | None = None) -> tuple[str | None, str]:
    """Key and message of the refusal of a rectangle of 1200 x 500 mm, its upper right corner c, with pleats k in its top and a dart d in its hem."""
    points = {"a": [0, 0], "b": [1200, 0], "c": [1200, 500], "d": [0, 500]}
    edges = [{"name": name, "from": start, "to": end} for name, start, end in (("hem", "a", "b"), ("right", "b", "c"), ("top", "c", "d"), ("left", "d", "a"))]
    panel: dict[str, Any] = {
        "points": points, "edges": edges, "mirror": mirror, "placement": SKIRT["panels"]["back"]["placement"],
        "pleats": [{"name": "k", "edge": "top", "at": {"mm": 200, "from": "c"}, "depth": 40, "count": 3, "every": 200}],
        "darts": [{"name": "d", "edge": "hem", "at": 0.5, "intake": 20, "length": 50}],
    }  # fmt: skip
    spec = {"name": "x", "fabric": "wool", "mannequin": "woman", "panels": {"p": panel}}
    assert draft(parse_spec(spec), BODY)
    change(panel)
    with pytest.raises(SpecError) as caught:
        draft(parse_spec(spec), BODY)
    return caught.value.key, caught.value.message


def test_names_that_darts_and_pleats_make_are_their_own() -> None:
    def renamed(name: str) -> Callable[[dict[str, Any]], Any]:
        return lambda panel: panel["edges"][1].update(name=name)

    folded = {"internal_lines": {"line": [[50, 0], [50, 500]]}, "folds": [{"name": "k_2_under", "line": "line", "angle": 90}]}
    assert named_twice(lambda panel: panel["darts"][0].update(name="k_1")) == (
        "panels.p.pleats.0.name", "pleat 'k_1' makes a seam 'k_1', and that of dart 'k_1' is called so, too; rename one",
    )  # fmt: skip
    for change, place, made in (
        (renamed("d_leg_a"), "darts.0", "dart 'd' makes an edge 'd_leg_a', and an edge"),
        (renamed("k_3_leg_b"), "pleats.0", "pleat 'k_3' makes an edge 'k_3_leg_b', and an edge"),
        (lambda panel: panel.update(folded), "pleats.0", "pleat 'k_2' makes a fold 'k_2_under', and a fold"),
        (lambda panel: panel["points"].update(k_1_fold=[5, 5]), "pleats.0", "pleat 'k_1' makes a point 'k_1_fold', and a point"),
        (lambda panel: panel["points"].update(k_2_b=[5, 5]), "pleats.0", "pleat 'k_2' makes a point 'k_2_b', and a point"),
        (lambda panel: panel["points"].update(d_a=[5, 5]), "darts.0", "dart 'd' makes a point 'd_a', and a point"),
        (lambda panel: panel["points"].update(d_b=[5, 5]), "darts.0", "dart 'd' makes a point 'd_b', and a point"),
        (lambda panel: panel.update(drill_holes={"d_apex": [5, 5]}), "darts.0", "dart 'd' makes a point 'd_apex', and a drill hole"),
    ):
        assert named_twice(change) == (f"panels.p.{place}.name", f"{made} is called so, too; rename one")
    key, message = named_twice(lambda panel: panel.update(drill_holes={"c": [20, 100]}))
    assert (key, message.split(";")[0]) == ("panels.p.drill_holes.c", "a point is called 'c' too")


def test_images_have_names_of_their_own() -> None:
    square = [[50, 50], [60, 50], [60, 60]]
    lines = {"l": [[50, 0], [50, 500]], "l_m": [[70, 0], [70, 500]], "n": [[90, 0], [90, 500]]}
    for more, named in (
        ({"darts": [{"name": name, "edge": "hem", "at": at, "intake": 20, "length": 50} for name, at in (("d", 0.3), ("d_m", 0.6))]}, "dart or pleat 'd'"),
        ({"drill_holes": {"h": [50, 300], "h_m": [80, 100]}}, "point or drill hole 'h'"),
        ({"drill_holes": {"a_m": [50, 300]}}, "point or drill hole 'a'"),
        ({"internal_lines": {"l": lines["l"], "l_m": lines["l_m"]}}, "internal line 'l'"),
        ({"regions": [{"name": name, "polygon": square, "factors": {"B": 2}} for name in ("r", "r_m")]}, "region 'r'"),
        (
            {"internal_lines": {"l": lines["l"], "n": lines["n"]}, "folds": [{"name": "f", "line": "l", "angle": 9}, {"name": "f_m", "line": "n", "angle": 9}]},
            "fold 'f'",
        ),
    ):
        key, message = named_twice(lambda panel, more=more: panel.update(more), "right")
        assert key == "panels.p.mirror"
        assert message.startswith(f"the image of {named} would be called ")


def test_the_image_of_an_edge_of_a_cutout_has_a_name_of_its_own() -> None:
    def change(panel: dict[str, Any]) -> None:
        panel["points"] |= {"p": [100, 300], "q": [140, 300], "r": [140, 340]}
        panel["cutouts"] = [[{"name": name, "from": start, "to": end} for name, start, end in (("x", "p", "q"), ("y", "q", "r"), ("z", "r", "p"))]]
        panel["edges"][3]["name"] = "x_m"

    assert named_twice(change, "right")[1].startswith("the image of edge 'x' would be called 'x_m'")


def test_a_point_of_the_fold_leaves_the_name_that_its_image_would_have() -> None:
    edges = [{"name": a + b, "from": a, "to": b} for a, b in ("ab", "bc", "ca")]
    points = {"a": [0, 0], "b": [100, 0], "c": [100, 200], "c_m": [80, 60]}
    panel = {"points": points, "edges": edges, "mirror": "bc", "placement": SKIRT["panels"]["back"]["placement"]}
    unfolded = draft(parse_spec({"name": "x", "fabric": "wool", "mannequin": "woman", "panels": {"p": panel}}), BODY).panels["p"]
    assert {name: unfolded.points[name] for name in ("c", "c_m", "c_m_m")} == {"c": (100, 200), "c_m": (80, 60), "c_m_m": (120, 60)}


def test_a_point_of_the_fold_keeps_its_name_and_no_image_takes_it() -> None:
    def change(panel: dict[str, Any]) -> None:
        panel["points"] |= {"c_m": [1200, 500], "c": [5, 5]}
        panel["edges"][1]["to"] = panel["edges"][2]["from"] = panel["pleats"][0]["at"]["from"] = "c_m"

    assert named_twice(change, "right")[1].startswith("the image of point or drill hole 'c' would be called 'c_m'")


def test_a_notch_does_not_go_with_the_mirror_edge() -> None:
    key, message = named_twice(lambda panel: panel.update(notches=[{"edge": "right", "at": 0.5, "name": "waist"}]), "right")
    assert key == "panels.p.mirror"
    assert message.startswith("notch 'waist' stands on edge 'right', which goes when the panel is unfolded")


def test_points_of_folds_keep_clear_of_drill_holes() -> None:
    panel = copy.deepcopy(SKIRT["panels"]["back"]) | {
        "internal_lines": {"x": [[50, -400], [50, 0]]}, "folds": [{"name": "f", "line": "x", "angle": 90}], "drill_holes": {"f_1": [100, -100]}, "darts": [],
    }  # fmt: skip
    drafted_panel = draft(parse_spec({"name": "x", "fabric": "wool", "mannequin": "woman", "panels": {"p": panel}}), BODY).panels["p"]
    assert [name for name in drafted_panel.points if name.startswith("f_")] == ["f_2", "f_3"]


def test_values_outside_their_range() -> None:
    with pytest.raises(SpecError, match="came 299; allowed is 300 to 700"):
        drafted(ordered, {"length": 299})
    with pytest.raises(SpecError, match="did you mean 'length'"):
        drafted(ordered, {"lenght": 400})
    with pytest.raises(ExpressionError, match="finite"):
        drafted(ordered, {"length": math.nan})


def test_values_are_evaluated_in_order() -> None:
    with pytest.raises(ExpressionError, match=r"unknown name 'intake' up to here: parameters get their values first, then values, each from those above it$"):
        drafted()


def test_of_a_name_that_gets_its_value_later_no_other_one_is_proposed() -> None:
    changes: list[tuple[Callable[[dict[str, Any]], Any], str, str]] = [
        (lambda d: d["parameters"]["length"].update(value="length + 1"), "parameters.length.value", "length"),  # from itself
        (lambda d: d["parameters"]["length"].update(range=["half", 700]), "parameters.length.range.0", "half"),  # from a value
        (lambda d: d["values"].update(half="quarter * 2", quarter="half / 2"), "values.half", "quarter"),  # in a circle
    ]
    for change, key, name in changes:
        with pytest.raises(ExpressionError) as caught:
            drafted(lambda data, change=change: (ordered(data), change(data)))
        assert caught.value.key == key
        assert f"unknown name {name!r} up to here" in caught.value.message
        assert "did you mean" not in caught.value.message


def test_all_faults_are_collected() -> None:
    data = copy.deepcopy(SKIRT)
    ordered(data)
    data["panels"]["front"]["mirror"] = "x"
    data["panels"]["back"]["grain"] = "y"
    data["seams"].append({"name": "z", "a": ["none.a.b", "none.a.b"], "b": ["none.a.b", "none.a.b"]})
    pattern, errors = draft_errors(parse_spec(data), BODY)
    assert pattern is None
    assert [error.key for error in errors] == ["panels.front.mirror", "panels.back.grain", "seams.z.a.0"]  # nothing that only follows from these
    with pytest.raises(SpecError, match="and 2 more faults"):
        draft(parse_spec(data), BODY)
