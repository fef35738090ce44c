"""Placed panels: collisions and twisted seams around a body made by hand."""

from __future__ import annotations

import copy
import dataclasses
import re
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
import trimesh
from drawn import materials

from garmentcad.arrays import indices
from garmentcad.check.finding import Finding
from garmentcad.check.one_sided import seams_turned_over
from garmentcad.check.placement import check_crossed, check_far, check_placement, check_reach, check_twists
from garmentcad.cloth.lattice import build_cloth
from garmentcad.errors import SpecError
from garmentcad.io.mannequin_file import read_mannequin
from garmentcad.io.shipped import shipped_names
from garmentcad.io.spec_file import read_spec
from garmentcad.mannequin.mannequin import ArrangementCylinder, Mannequin
from garmentcad.pattern.draft import draft
from garmentcad.pattern.parse import parse_spec
from garmentcad.pattern.pattern import Pattern
from garmentcad.placement.place import place_vertices

GRID_MM = 10.0


def body() -> Mannequin:
    """An upright cylinder, 100 mm in radius and 1 m high, on the floor; the arrangement cylinder is as large."""
    mesh = trimesh.creation.cylinder(radius=0.1, height=1.0, sections=48)
    vertices = mesh.vertices[:, [1, 2, 0]] + np.array([0.0, 0.5, 0.0])  # an even permutation keeps the faces' orientation
    torso = ArrangementCylinder(np.zeros(3), np.array([0.0, 1.0, 0.0]), np.array([0.0, 0.0, 1.0]), 0.1, 0.1)
    return Mannequin("post", vertices, indices(mesh.faces), {}, {}, {"torso": torso}, ("torso",), np.zeros(len(mesh.faces), dtype=np.int32))


def panel(angle: float) -> dict[str, Any]:
    return {
        "points": {"a": [-150, 0], "b": [150, 0], "c": [150, 200], "d": [-150, 200]},
        "edges": [
            {"name": "hem", "from": "a", "to": "b"}, {"name": "right", "from": "b", "to": "c"}, {"name": "top", "from": "c", "to": "d"},
            {"name": "left", "from": "d", "to": "a"},
        ],
        "placement": {"wrap": {"part": "torso", "angle": angle, "height": 400, "offset": 30}},
    }  # fmt: skip


TUBE: dict[str, Any] = {
    "name": "tube", "fabric": "x", "mannequin": "post", "panels": {"front": panel(0), "back": panel(180)},
    "seams": [
        {"name": "one", "a": ["front.right.c", "front.right.b"], "b": ["back.left.d", "back.left.a"]},
        {"name": "two", "a": ["front.left.d", "front.left.a"], "b": ["back.right.c", "back.right.b"]},
    ],
}  # fmt: skip


def findings(change: Callable[[dict[str, Any]], Any] = lambda data: None) -> list[Finding]:
    data = copy.deepcopy(TUBE)
    change(data)
    pattern, mannequin = draft(parse_spec(data, "tube.yaml"), {}), body()
    cloth = build_cloth(pattern, lambda _, points: np.zeros(len(points), dtype=np.int32), materials(0.2), GRID_MM)
    positions = place_vertices(pattern, cloth, mannequin)
    off = check_reach(pattern, cloth, positions, mannequin, "tube.yaml")
    sewn = [*check_twists(pattern, cloth, positions, "tube.yaml"), *check_crossed(pattern, cloth, positions, "tube.yaml")]
    return [*off, *sewn, *check_placement(cloth, positions, mannequin, "tube.yaml")]


def test_a_tube_is_clean() -> None:
    assert findings() == []


def test_twisted_seam() -> None:
    found = findings(lambda data: data["seams"][0].update(b=["back.left.a", "back.left.d"]))
    assert [(finding.code, finding.key, finding.severity) for finding in found] == [("seam-twisted", "seams.one", "error")]
    # Round a radius of 130 mm the panels' edges stand 300 mm apart along the arc, 54.2 mm by the chord; the twisted points are 100 mm higher or lower.
    gap = 2 * 130 * np.cos(150 / 130)
    far = np.hypot(gap, 100)
    assert f"{far:.0f} and {far:.0f} mm apart; with one side turned around they would be {gap:.0f} and {gap:.0f}" in found[0].message


def test_the_twisted_ends_of_a_band_that_stand_far_apart() -> None:
    """Seen from 200 mm away both ends of a side of 10 mm are equally far, to a quarter of a millimetre."""

    def band(data: dict[str, Any], b: list[str]) -> None:
        drawn = panel(0)
        drawn["points"] = {"a": [-300, 0], "b": [300, 0], "c": [300, 10], "d": [-300, 10]}
        data["panels"] = {"band": drawn}
        data["seams"] = [{"name": "ends", "a": ["band.right.b", "band.right.c"], "b": b}]

    assert findings(lambda data: band(data, ["band.left.a", "band.left.d"])) == []
    (found,) = findings(lambda data: band(data, ["band.left.d", "band.left.a"]))
    assert (found.code, found.key, found.severity) == ("seam-twisted", "seams.ends", "error")
    assert "its sides go opposite ways" in found.message


def test_a_side_that_lies_higher_than_the_other_is_not_twisted() -> None:
    """Turned around, one pair of points would be closer and the other one farther away."""
    assert findings(lambda data: data["panels"]["back"]["placement"]["wrap"].update(height=700)) == []
    assert findings(lambda data: data["panels"]["front"]["placement"]["wrap"].update(height=700)) == []


def test_a_side_of_two_edges_is_measured_along_both() -> None:
    """The front's right side falls into two edges of 50 and 150 mm; its quarters lie where they lay on the whole one."""

    def split(data: dict[str, Any]) -> None:
        front = data["panels"]["front"]
        front["points"]["e"] = [150, 150]
        front["edges"][1:2] = [{"name": "low", "from": "b", "to": "e"}, {"name": "high", "from": "e", "to": "c"}]
        data["seams"][0].update(a=["front.high.c", "front.low.b"], b=["back.left.a", "back.left.d"])

    (found,) = findings(split)
    gap = 2 * 130 * np.cos(150 / 130)
    far = np.hypot(gap, 100)
    assert f"{far:.0f} and {far:.0f} mm apart; with one side turned around they would be {gap:.0f} and {gap:.0f}" in found.message


def test_twisted_ring() -> None:
    """Two closed tubes, one above the other: where the ring between them begins and ends says nothing."""

    def ring(data: dict[str, Any]) -> None:
        cuff = panel(0)
        cuff["points"] = {"a": [-400, 0], "b": [400, 0], "c": [400, 60], "d": [-400, 60]}
        cuff["placement"]["wrap"] |= {"height": 300, "offset": 28}
        upper = copy.deepcopy(cuff)
        upper["placement"]["wrap"]["height"] = 400
        data["panels"] = {"upper": upper, "lower": cuff}
        data["seams"] = [
            {"name": "lower_tube", "a": ["lower.left.d", "lower.left.a"], "b": ["lower.right.c", "lower.right.b"]},
            {"name": "upper_tube", "a": ["upper.left.d", "upper.left.a"], "b": ["upper.right.c", "upper.right.b"]},
            {"name": "ring", "a": ["upper.hem.a", "upper.hem.b"], "b": ["lower.top.d", "lower.top.c"]},
        ]

    def turned(data: dict[str, Any]) -> None:
        ring(data)
        data["seams"][2]["b"] = ["lower.top.c", "lower.top.d"]

    assert findings(ring) == []
    assert [finding.key for finding in findings(turned)] == ["seams.ring"]


def laid(front: list[float], back: list[float]) -> Callable[[dict[str, Any]], None]:
    """The tube's panels laid flat before and behind the body, with these rotations."""

    def change(data: dict[str, Any]) -> None:
        for name, z, rotation in (("front", 200, front), ("back", -200, back)):
            data["panels"][name]["placement"] = {"transform": {"translation": [0, 400, z], "rotation": rotation}}

    return change


def test_a_panel_that_lies_wrong_side_out_crosses_its_seams() -> None:
    """Sides 300 mm apart, 400 mm before and behind: 400 mm from partner to partner, and 500 mm crosswise. Either panel may be the wrong one."""
    assert findings(laid([0, 0, 0], [0, 180, 0])) == []
    for wrong in (laid([0, 0, 0], [0, 0, 0]), laid([0, 180, 0], [0, 180, 0])):
        (found,) = findings(wrong)
        assert (found.code, found.key, found.severity) == ("seams-cross-over", "seams.one", "warning")
        assert "seams one and two cross over: they join front to back over 500 and 500 mm" in found.message
        assert "with partners swapped it would be 400 and 400 mm" in found.message
        assert "[0, 180, 0]" in found.remedy


def test_a_back_between_two_fronts_crosses_its_seams_too() -> None:
    """The front is cut in two at its middle, and each half is sewn to the back at one side."""

    def halved(back: list[float]) -> Callable[[dict[str, Any]], None]:
        def change(data: dict[str, Any]) -> None:
            laid([0, 0, 0], back)(data)
            front = data["panels"].pop("front")
            for name, move in (("left", {"a": [1, 0], "d": [1, 200]}), ("right", {"b": [-1, 0], "c": [-1, 200]})):
                data["panels"][name] = front | {"points": front["points"] | move}
            data["seams"][0]["a"] = ["left.right.c", "left.right.b"]
            data["seams"][1]["a"] = ["right.left.d", "right.left.a"]

        return change

    assert findings(halved([0, 180, 0])) == []
    (found,) = findings(halved([0, 0, 0]))
    assert "join back to left and right over 500 and 500 mm" in found.message


@pytest.mark.parametrize("apart", [0.0, 4.0])
def test_a_godet_that_is_sewn_in_with_left_and_right_exchanged(apart: float) -> None:
    """A wedge of 200 mm before the slit between two fronts of 150 mm, which begin `apart` degrees (of 130 mm: 9 mm) from the middle."""

    def godet(left: str, right: str) -> Callable[[dict[str, Any]], None]:
        def change(data: dict[str, Any]) -> None:
            front = data["panels"].pop("front")
            for name, side, ends in (("left", 1, {"a": [0, 0], "d": [0, 200]}), ("right", -1, {"b": [0, 0], "c": [0, 200]})):
                wrap = {"part": "torso", "anchor": [0, 0], "angle": side * apart, "height": 400, "offset": 30}
                data["panels"][name] = {**front, "points": front["points"] | ends, "placement": {"wrap": wrap}}
            wedge = {"points": {"t": [0, 200], "l": [-60, 0], "r": [60, 0]}, "placement": {"transform": {"translation": [0, 400, 180]}}}
            wedge["edges"] = [{"name": name, "from": a, "to": b} for name, a, b in (("left", "t", "l"), ("hem", "l", "r"), ("right", "r", "t"))]
            data["panels"]["godet"] = wedge
            data["seams"][0]["a"], data["seams"][1]["a"] = ["left.right.c", "left.right.b"], ["right.left.d", "right.left.a"]
            data["seams"] += [
                {"name": "godet_left", "a": ["left.left.d", "left.left.a"], "b": [f"godet.{left}.t", f"godet.{left}.{left[0]}"]},
                {"name": "godet_right", "a": ["right.right.c", "right.right.b"], "b": [f"godet.{right}.t", f"godet.{right}.{right[0]}"]},
            ]

        return change

    # The left front is the wearer's, on the godet's right as seen from outside.
    assert [finding for finding in findings(godet("right", "left")) if finding.code != "placement-crossing"] == []
    (found,) = [finding for finding in findings(godet("left", "right")) if finding.code != "placement-crossing"]
    assert (found.code, found.key, found.severity) == ("seams-cross-over", "seams.godet_left", "warning")
    assert "seams godet_left and godet_right cross over: they join godet to left and right" in found.message


def test_straps_that_cross_behind_the_back_are_meant() -> None:
    """From the ends of a back band up to flat straps over the shoulders, each to the other side: 500 mm away, crosswise hardly more."""

    def crossed(partners: tuple[str, str], deep: float) -> list[Finding]:
        def change(data: dict[str, Any]) -> None:
            band = {"a": [-60, 0], "b": [60, 0], "c": [60, 60], "d": [-60, 60], "m": [0, 60]}
            names = (("low", "a", "b"), ("right", "b", "c"), ("top_right", "c", "m"), ("top_left", "m", "d"), ("left", "d", "a"))
            edges = [{"name": name, "from": a, "to": b} for name, a, b in names]
            place = {"transform": {"translation": [0, 400, -150], "rotation": [0, 180, 0]}}
            data["panels"] = {"band": {"points": band, "edges": edges, "placement": place}}
            data["seams"] = []
            for name, side, partner in (("right", 1, partners[0]), ("left", -1, partners[1])):
                at = {"l": 75, "r": -75}[partner]  # x of the wearer's left and right shoulder
                outline = {"p": [at - 20, 0], "q": [at + 20, 0], "r": [at + 20, 300], "s": [at - 20, 300]}
                drawn = [{"name": key, "from": key[0], "to": key[1]} for key in ("pq", "qr", "rs", "sp")]
                lies = {"transform": {"translation": [0, 400 + deep, 0], "rotation": [-90, 0, 0]}}
                data["panels"][partner] = {"points": outline, "edges": drawn, "placement": lies}
                ends = ["c", "m"] if side > 0 else ["m", "d"]
                data["seams"].append({"name": name, "a": [f"band.top_{name}.{end}" for end in ends], "b": [f"{partner}.pq.p", f"{partner}.pq.q"], "ease": 0.5})

        return [finding for finding in findings(change) if finding.code == "seams-cross-over"]

    assert crossed(("r", "l"), 400.0) == []  # seen from behind the band's right end is at the wearer's right
    assert crossed(("l", "r"), 400.0) == []
    assert len(crossed(("l", "r"), 60.0)) == 1, "so near it is a strap too far"


def test_straps_that_cross_are_no_panel_on_its_face() -> None:
    """From a band in front they slant to either side, one before the other: where they begin they lie 45 mm apart, and their middles the other way."""

    def crossed(data: dict[str, Any]) -> None:
        names = (("right", "a", "b"), ("top_right", "b", "m"), ("top_left", "m", "c"), ("left", "c", "d"), ("hem", "d", "a"))
        edges = [{"name": name, "from": a, "to": b} for name, a, b in names]
        points = {"a": [60, 150], "b": [60, 200], "m": [0, 200], "c": [-60, 200], "d": [-60, 150]}
        data["panels"] = {"band": {"points": points, "edges": edges, "placement": {"transform": {"translation": [0, 400, 200]}}}}
        data["seams"] = []
        for name, side, z in (("right", 1, 210), ("left", -1, 220)):
            outline = {"p": [side * 2, 200], "q": [side * 42, 200], "r": [side * -200, 500], "s": [side * -240, 500]}
            drawn = [{"name": key, "from": key[0], "to": key[1]} for key in ("pq", "qr", "rs", "sp")]
            data["panels"][name] = {"points": outline, "edges": drawn, "placement": {"transform": {"translation": [0, 400, z]}}}
            ends = ["m", "b" if side > 0 else "c"]
            data["seams"].append({"name": name, "a": [f"band.top_{name}.{end}" for end in ends], "b": [f"{name}.pq.p", f"{name}.pq.q"], "ease": 0.5})

    assert findings(crossed) == []


def test_a_facing_is_sewn_alike_and_does_not_cross_over() -> None:
    """Of 60 mm, within the tops of two fronts that meet in the middle: it comes to lie on its face, as it is meant."""

    def faced(data: dict[str, Any]) -> None:
        facing = {**panel(0), "points": {"a": [-150, 140], "b": [150, 140], "c": [150, 200], "d": [-150, 200]}}
        halves = {"left": {"a": [0, 0], "d": [0, 200]}, "right": {"b": [0, 0], "c": [0, 200]}}
        front = data["panels"].pop("front")
        for name, ends in halves.items():
            data["panels"][name] = {**front, "points": front["points"] | ends}
        facing["points"] |= {"m": [0, 200]}
        facing["edges"][2:3] = [{"name": "top_left", "from": "c", "to": "m"}, {"name": "top_right", "from": "m", "to": "d"}]
        facing["placement"]["wrap"]["offset"] = 20
        data["panels"]["facing"] = facing
        data["seams"] = [
            {"name": "one", "a": ["left.top.c", "left.top.d"], "b": ["facing.top_left.c", "facing.top_left.m"]},
            {"name": "two", "a": ["right.top.c", "right.top.d"], "b": ["facing.top_right.m", "facing.top_right.d"]},
        ]

    assert [finding for finding in findings(faced) if finding.code != "placement-crossing"] == []


@pytest.mark.parametrize(("height", "off"), [(-190, False), (-210, True), (990, False), (1010, True)])
def test_a_panel_above_or_below_its_part(height: float, off: bool) -> None:
    """The post goes from 0 to 1000 mm, the panel 200 mm up from its height."""
    found = findings(lambda data: [data["panels"][name]["placement"]["wrap"].update(height=height) for name in ("front", "back")])
    expected = ["panels.front.placement.wrap.height", "panels.back.placement.wrap.height"] if off else []
    assert [finding.key for finding in found if finding.code == "placement-off-body"] == expected


def reach_beside_a_ball(ball_m: float, height: float) -> list[Finding]:
    """Findings on panels wrapped around the post from `height` mm on, where a ball of 100 mm at the height `ball_m` is another part of that body."""
    post, ball = body(), trimesh.creation.icosphere(subdivisions=2, radius=0.1)
    vertices = np.concatenate([post.vertices, np.add(ball.vertices, [0.0, ball_m, 0.0])])
    faces = indices(np.concatenate([post.faces, np.asarray(ball.faces) + len(post.vertices)]))
    part = indices(np.repeat([0, 1], [len(post.faces), len(ball.faces)]))
    with_ball = dataclasses.replace(post, vertices=vertices, faces=faces, part_names=("torso", "ball"), face_part=part)
    data = copy.deepcopy(TUBE)
    data["panels"]["front"]["placement"]["wrap"]["height"] = height
    pattern = draft(parse_spec(data, "tube.yaml"), {})
    cloth = build_cloth(pattern, lambda _, points: np.zeros(len(points), dtype=np.int32), materials(0.2), GRID_MM)
    return [*check_reach(pattern, cloth, place_vertices(pattern, cloth, with_ball), with_ball, "tube.yaml")]


def test_another_part_where_the_panel_lies_is_not_its_own() -> None:
    """A ball above the post, from 1100 to 1300 mm, as a head is."""
    (finding,) = reach_beside_a_ball(1.2, 1110)
    assert "wrapped from 1110 to 1310 mm along 'torso', which goes from 0 to 1000 mm" in finding.message


@pytest.mark.parametrize(("height", "off"), [(-490, False), (-510, True)])
def test_what_is_wrapped_around_the_torso_may_hang_beside_what_is_below_it(height: float, off: bool) -> None:
    """The ball goes from 300 to 100 mm below the post, as legs do: the lower tier of a skirt hangs beside it."""
    assert [finding.key for finding in reach_beside_a_ball(-0.2, height)] == ["panels.front.placement.wrap.height"] * off


@pytest.mark.parametrize(
    ("translation", "code", "words"),
    [
        ([0, 400, 500], None, ""),
        ([0, 40, 50], None, ""),
        ([0, 400, 1050], None, ""),
        ([0, 400, 1150], "panel-far", "starts 1050 mm away from post"),
        ([0, 400, -1150], "panel-far", "starts 1050 mm away"),
        ([1200, 400, 0], None, ""),  # its near side 950 mm away, its far side 1250 mm
        ([1300, 400, 0], "panel-far", "starts 1050 mm away"),
        ([0, -80, 300], None, ""),
        ([0, -120, 300], "panel-below-floor", "starts 20 mm below the floor"),
        ([3000, 400, 300], "panel-far", ""),
        ([0, 2200, 0], "panel-far", "starts 1200 mm away"),
    ],
)
def test_a_flat_panel_far_from_the_body_or_below_the_floor(translation: list[float], code: str | None, words: str) -> None:
    """The panel is 300 mm wide and 200 mm high, and stands upright on the middle of its lower edge."""
    data = copy.deepcopy(TUBE)
    data["panels"]["front"]["placement"] = {"transform": {"translation": translation}}
    pattern, mannequin = draft(parse_spec(data, "tube.yaml"), {}), body()
    cloth = build_cloth(pattern, lambda _, points: np.zeros(len(points), dtype=np.int32), materials(0.2), GRID_MM)
    found = list(check_far(pattern, cloth, place_vertices(pattern, cloth, mannequin), mannequin, "tube.yaml"))
    assert [(finding.code, finding.key) for finding in found] == ([] if code is None else [(code, "panels.front.placement.transform.translation")])
    assert all(words in finding.message for finding in found)


def test_crossing_panels() -> None:
    across = {"transform": {"translation": [0, 400, 110], "rotation": [10, 0, 0]}}
    found = findings(lambda data: data["panels"]["back"].update(placement=across) or data.update(seams=[]))
    crossing = [finding for finding in found if finding.code == "placement-crossing"]
    assert [(finding.key, finding.severity) for finding in crossing] == [("panels.front.placement", "error")]
    assert "crosses panel back in" in crossing[0].message


def test_a_panel_that_is_wrapped_around_more_than_once_crosses_itself() -> None:
    """900 mm around a circle of 130 mm in radius, which measures 817 mm."""
    wide = {"a": [-450, 0], "b": [450, 0], "c": [450, 200], "d": [-450, 200]}
    (crossing,) = findings(lambda data: data["panels"].pop("back") and (data["panels"]["front"].update(points=wide), data.update(seams=[])))
    assert (crossing.code, crossing.severity, crossing.key) == ("placement-crossing", "error", "panels.front.placement")
    assert "crosses itself in" in crossing.message


@pytest.mark.parametrize(("offset", "severity"), [(-30, "error"), (-12, "error"), (-9, "warning"), (-5, "warning")])
def test_panel_inside_the_body(offset: float, severity: str) -> None:
    found = findings(lambda data: data["panels"]["front"]["placement"]["wrap"].update(offset=offset) or data.update(seams=[]))
    assert [(finding.code, finding.key, finding.severity) for finding in found] == [("panel-inside-body", "panels.front.placement", severity)]
    assert f"up to {-offset} mm deep, in torso, 400 to 600 mm above the floor" in found[0].message


def test_a_flared_skirt_inside_the_forearms() -> None:
    """Half a circle skirt, held out at 70 degrees from the vertical, in the arms of a body that holds them at 45; no offset brings it past them."""
    outline = {"a": [-160, 0], "b": [160, 0], "c": [660, 0], "d": [-660, 0]}
    edges: list[dict[str, Any]] = [{"name": "left", "from": "b", "to": "c"}, {"name": "right", "from": "d", "to": "a"}]
    edges.insert(1, {"name": "hem", "from": "c", "to": "d", "arc": {"center": [0, 0], "direction": "clockwise"}})
    edges.append({"name": "top", "from": "a", "to": "b", "arc": {"center": [0, 0], "direction": "counterclockwise"}})

    def said(flare: float) -> list[Finding]:
        wrap = {"part": "torso", "anchor": [0, -160], "angle": 0, "height": 1040, "offset": 30, "scale": 0.8, "flare": flare}
        skirt = {"points": outline, "edges": edges, "placement": {"wrap": wrap}}
        pattern = draft(parse_spec({"name": "x", "fabric": "x", "mannequin": "woman-88", "panels": {"skirt": skirt}}), {})
        mannequin = read_mannequin(pattern.mannequin)
        cloth = build_cloth(pattern, lambda _, points: np.zeros(len(points), dtype=np.int32), materials(0.2), 20.0)
        return [*check_placement(cloth, place_vertices(pattern, cloth, mannequin), mannequin)]

    (finding,) = said(70)
    assert re.search(r"up to 1\d mm deep, in arm_left and arm_right, 8\d\d to 9\d\d mm above the floor$", finding.message)
    assert finding.remedy.startswith("Wrap a sleeve wider (offset, scale); lay what lies beside the arms nearer to the body ")
    assert "arm_angle of a mannequin file, up to 60 degrees" in finding.remedy
    assert said(60) == []


def test_a_wrap_on_next_to_nothing_is_refused() -> None:
    """An offset that leaves some millimetres of the torso's cylinder, or less: the message names the least one, and that one is laid."""
    with pytest.raises(SpecError, match="next to nothing") as caught:
        findings(lambda data: data["panels"]["front"]["placement"]["wrap"].update(offset=-99.999) or data.update(seams=[]))
    assert caught.value.key == "panels.front.placement.wrap.offset"
    least = float(caught.value.message.split("allowed is ")[1].split(" mm")[0])
    assert (
        findings(lambda data: data["panels"]["front"]["placement"]["wrap"].update(offset=least + 0.1) or data.update(seams=[]))[0].code == "panel-inside-body"
    )


def test_a_panel_that_is_wrapped_far_off_or_below_the_floor() -> None:
    """Heights above the floor in cm, and a zero too many in an offset."""

    def said(**wrap: float) -> list[tuple[str, str]]:
        data = copy.deepcopy(TUBE)
        data["panels"]["front"]["placement"]["wrap"].update(wrap)
        pattern, mannequin = draft(parse_spec(data, "tube.yaml"), {}), body()
        cloth = build_cloth(pattern, lambda _, points: np.zeros(len(points), dtype=np.int32), materials(0.2), GRID_MM)
        found = check_far(pattern, cloth, place_vertices(pattern, cloth, mannequin), mannequin, "tube.yaml")
        return [(finding.code, finding.key) for finding in found]

    assert said() == said(height=-90) == said(offset=900) == []
    assert said(height=-120) == [("panel-below-floor", "panels.front.placement.wrap.height")]
    assert said(offset=3000) == [("panel-far", "panels.front.placement.wrap.offset")]


def shirt(shoulder: list[str]) -> Pattern:
    """Front and back sewn at one side and at one shoulder; distances say nothing, as nothing is placed."""
    points = {"a": [0, 0], "b": [200, 0], "c": [200, 300], "d": [120, 310], "e": [0, 300]}
    edges = [{"name": name, "from": name[0], "to": name[1]} for name in ("ab", "bc", "cd", "de", "ea")]
    panels = {name: {"points": points, "edges": edges, "placement": {"transform": {"translation": [0, 0, 0]}}} for name in ("front", "back")}
    panels["lining"] = panels["front"]
    seams = [
        {"name": "side", "a": ["front.bc.b", "front.bc.c"], "b": ["back.ea.a", "back.ea.e"]},
        {"name": "shoulder", "a": ["front.cd.c", "front.cd.d"], "b": shoulder},
        {"name": "hem", "a": ["front.ab.a", "front.ab.b"], "b": ["lining.ab.a", "lining.ab.b"]},
        {"name": "facing", "a": ["front.ea.e", "front.ea.a"], "b": ["lining.ea.e", "lining.ea.a"]},
    ]
    return draft(parse_spec({"name": "shirt", "fabric": "x", "mannequin": "post", "panels": panels, "seams": seams}), {})


def test_a_seam_that_turns_the_cloth_over() -> None:
    """The lining lies on its face all along, which turns nothing over."""
    assert seams_turned_over(shirt(["back.de.e", "back.de.d"])) == []
    assert seams_turned_over(shirt(["back.de.d", "back.de.e"])) == ["shoulder"]
    back_to_front = dataclasses.replace(shirt(["back.de.d", "back.de.e"]), seams=tuple(reversed(shirt(["back.de.d", "back.de.e"]).seams)))
    assert seams_turned_over(back_to_front) == ["shoulder"]


@pytest.mark.parametrize("name", shipped_names("patterns"))
def test_no_shipped_garment_is_one_sided(name: str) -> None:
    spec = read_spec(name)
    assert seams_turned_over(draft(spec, read_mannequin(spec.mannequin).measurements_mm)) == []


@pytest.mark.parametrize("turned", [False, True])
def test_a_strap_that_is_sewn_on_turned_around(turned: bool) -> None:
    """In front of the body, 40 mm wide, to be sewn on behind, where the band goes round: distances tell nothing, its outer point is farther either way."""

    def strap(data: dict[str, Any]) -> None:
        back = data["panels"]["back"]
        back["points"] |= {"i": [60, 200], "o": [100, 200]}
        back["edges"][2:3] = [{"name": name, "from": p, "to": q} for name, p, q in (("side", "c", "o"), ("strap", "o", "i"), ("middle", "i", "d"))]
        drawn = panel(0)
        drawn["points"] = {"a": [0, 0], "b": [40, 0], "c": [40, 300], "d": [0, 300]}
        drawn["placement"] = {"transform": {"translation": [-100, 500, 150]}}
        data["panels"]["strap"] = drawn
        ends = ["back.strap.i", "back.strap.o"] if turned else ["back.strap.o", "back.strap.i"]
        data["seams"].append({"name": "on", "a": ["strap.top.d", "strap.top.c"], "b": ends})

    found = [finding.key for finding in findings(strap) if finding.code == "seam-twisted"]
    assert found == (["seams.on"] if turned else [])
