"""The pattern doctor: silent on good patterns, and each fault found with its place, numbers and a remedy."""

from __future__ import annotations

import ast
import copy
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import shapely
import yaml

from garmentcad.check.doctor import check_pattern, refusal
from garmentcad.check.examine import examine
from garmentcad.check.finding import Finding
from garmentcad.check.gather import check_gathers, fullest
from garmentcad.errors import SpecError
from garmentcad.export.drape import drape
from garmentcad.fabric.material import material_row
from garmentcad.io.fabric_file import fabric_path, load_fabric
from garmentcad.io.shipped import shipped_file
from garmentcad.io.spec_file import read_spec
from garmentcad.pattern.draft import draft, draft_errors
from garmentcad.pattern.parse import parse_spec

BODY = {"waist": 720.0, "hip": 960.0}
WOMAN_88 = {
    "bust": 880.0, "waist": 720.0, "hip": 960.0, "stature": 1680.0, "neck_base": 370.0, "back_width": 344.0, "chest_front": 324.0, "shoulder": 122.5,
    "armscye_depth": 210.0, "nape_to_waist": 410.0, "waist_to_hip": 206.0, "waist_to_knee": 585.0, "waist_to_floor": 1040.0, "top_arm": 284.0,
    "wrist": 160.0, "arm_length": 585.0, "thigh": 560.0, "nape_height": 1450.0, "neck_front_height": 1403.0, "shoulder_height": 1378.0,
    "bust_height": 1210.0, "waist_height": 1040.0, "hip_height": 840.0, "crotch_height": 773.0, "knee_height": 470.0,
}  # fmt: skip


def square(**more: Any) -> dict[str, Any]:
    return {
        "points": {"a": [0, 0], "b": [300, 0], "c": [300, 400], "d": [0, 400], "h": [150, 200]},
        "edges": [
            {"name": "hem", "from": "a", "to": "b"}, {"name": "right", "from": "b", "to": "c"}, {"name": "waist", "from": "c", "to": "d"},
            {"name": "left", "from": "d", "to": "a"},
        ],
        "notches": [
            {"edge": "right", "at": {"mm": 100, "from": "c"}, "name": "r"}, {"edge": "left", "at": {"mm": 100, "from": "d"}, "name": "r"},
        ],
        "placement": {"transform": {"translation": [0, 0, 0]}},
        **more,
    }  # fmt: skip


GOOD: dict[str, Any] = {
    "name": "tube", "fabric": "wool", "mannequin": "woman-88", "panels": {"front": square(), "back": square()},
    "seams": [
        {"name": "one", "a": ["front.right.c", "front.right.b"], "b": ["back.left.d", "back.left.a"]},
        {"name": "two", "a": ["front.left.d", "front.left.a"], "b": ["back.right.c", "back.right.b"]},
    ],
}  # fmt: skip


def findings(change: Callable[[dict[str, Any]], Any], grid_mm: float = 10.0) -> list[Finding]:
    data = copy.deepcopy(GOOD)
    change(data)
    spec = parse_spec(data, "tube.yaml")
    return check_pattern(spec, draft(spec, BODY), grid_mm)


@pytest.mark.parametrize("name", ["flared-skirt", "straight-skirt", "t-shirt"])
def test_shipped_garments_are_clean(name: str) -> None:
    spec = read_spec(shipped_file("patterns", name))
    assert check_pattern(spec, draft(spec, WOMAN_88)) == []


def test_a_good_pattern_is_clean() -> None:
    assert findings(lambda data: None) == []


def long_back(data: dict[str, Any], by: float) -> None:
    data["panels"]["back"]["points"] |= {"a": [0, -by], "b": [300, -by]}


def slanted(side: int = 1, **more: Any) -> dict[str, Any]:
    """A panel without symmetry; with side -1 its mirror image, drawn elsewhere and from another corner."""
    points = {"a": [0, 0], "b": [300, 0], "c": [240, 390], "d": [40, 400]}
    if side < 0:
        points = {name: [900 - points[other][0], 50 + points[other][1]] for name, other in zip("abcd", "cbad")}
    return square(points=points, notches=[], **more)


def drawn_dart(data: dict[str, Any], apex: float) -> None:
    """A dart in the hem of the front, drawn as part of its outline: mouth from 100 to 200, 100 deep."""
    front = data["panels"]["front"]
    front["points"] |= {"m": [100, 0], "x": [apex, 100], "n": [200, 0]}
    front["edges"][:1] = [{"name": name, "from": a, "to": b} for name, a, b in (("hem", "a", "m"), ("leg", "m", "x"), ("gel", "x", "n"), ("meh", "n", "b"))]
    data["seams"].append({"name": "dart", "a": ["front.leg.m", "front.leg.x"], "b": ["front.gel.n", "front.gel.x"]})


def sleeved(data: dict[str, Any], cap: float, ease: float | None = None) -> None:
    """A sleeve of two panels whose caps are `cap` long together, sewn to an armhole of 250 + 250 mm."""
    on_arm = {"wrap": {"part": "arm_left", "angle": 0, "height": -300}}
    for name in ("upper", "under"):
        data["panels"][name] = square(points={"a": [0, 0], "b": [cap / 2, 0], "c": [cap / 2, 500], "d": [0, 500]}, notches=[], placement=on_arm)
    for name in ("front", "back"):
        data["panels"][name]["points"] |= {"k": [50, 400], "c": [300, 400]}
        data["panels"][name]["edges"][2:3] = [{"name": "hole", "from": "c", "to": "k"}, {"name": "waist", "from": "k", "to": "d"}]
    ease = cap / 500 - 1 if ease is None else ease
    data["seams"] += [{"name": f"cap_left_{body}", "a": [f"{sleeve}.waist.c", f"{sleeve}.waist.d"], "b": [f"{body}.hole.c", f"{body}.hole.k"], "ease": ease}
                      for sleeve, body in (("upper", "front"), ("under", "back"))]  # fmt: skip


FAULTS: list[tuple[str, Callable[[dict[str, Any]], Any], str, str, str, str]] = [
    ("crossing", lambda d: d["panels"]["front"]["edges"][1].update(cubic=[[-300, 100], [-300, 300]]),
     "error", "outline-crosses-itself", "panels.front.edges", "on left and right"),
    ("no length", lambda d: (d["panels"]["front"]["points"].update(e=[300, 0]), d["panels"]["front"]["edges"].insert(1, {"name": "z", "from": "b", "to": "e"}),
                             d["panels"]["front"]["edges"][2].update({"from": "e"}), d["seams"][0].update(a=["front.right.c", "front.right.e"])),
     "error", "edge-without-length", "panels.front.edges.z", "0.000 mm long"),
    ("short", lambda d: (d["panels"]["front"]["points"].update(e=[300, 0.4]), d["panels"]["front"]["edges"].insert(1, {"name": "z", "from": "b", "to": "e"}),
                         d["panels"]["front"]["edges"][2].update({"from": "e"}), d["seams"][0].update(a=["front.right.c", "front.right.e"])),
     "warning", "edge-short", "panels.front.edges.z", "0.400 mm long"),
    ("hem that is sewn", lambda d: d["panels"]["front"]["edges"][1].update(role="hem"),
     "warning", "role-sewn", "panels.front.edges.right", "has the role hem and is sewn in seam"),
    ("narrow", lambda d: d["panels"].update(strip=square(points={"a": [0, 0], "b": [300, 0], "c": [300, 15], "d": [0, 15]}, notches=[])),
     "warning", "panel-too-small", "panels.strip", "15.0 mm wide"),
    ("too narrow", lambda d: d["panels"].update(strip=square(points={"a": [0, 0], "b": [300, 0], "c": [300, 6], "d": [0, 6]}, notches=[])),
     "error", "panel-too-small", "panels.strip", "6.0 mm wide"),
    ("cutout outside", lambda d: (d["panels"]["front"]["points"].update(h=[310, 200]), d["panels"]["front"].update(
        cutouts=[[{"name": "o", "from": "h", "to": "h", "arc": {"center": [290, 200], "direction": "clockwise"}}]])),
     "error", "cutout-outside", "panels.front.cutouts.0", "of 1253 mm2"),
    ("drill hole outside", lambda d: d["panels"]["front"].update(drill_holes={"i": [150, 20], "o": [310, 20]}),
     "warning", "hole-outside", "panels.front.drill_holes.o", "10.0 mm outside the panel, at (310.0, 20.0) mm"),
    ("region half outside", lambda d: d["panels"]["front"].update(regions=[{"name": "r", "polygon": [[250, 0], [350, 0], [350, 100], [250, 100]]}]),
     "warning", "region-outside", "panels.front.regions.r", "of 10000 mm2"),
    ("region outside", lambda d: d["panels"]["front"].update(regions=[{"name": "r", "polygon": [[500, 0], [600, 0], [600, 100]]}]),
     "error", "region-outside", "panels.front.regions.r", "5000 of 5000 mm2"),
    ("fold outside", lambda d: d["panels"]["front"].update(internal_lines={"x": [[400, 0], [400, 90]]}, folds=[{"name": "f", "line": "x", "angle": 170}]),
     "error", "fold-outside", "panels.front.folds.f", "90 of 90 mm"),
    ("fold half outside", lambda d: d["panels"]["front"].update(internal_lines={"x": [[200, 50], [400, 50]]}, folds=[{"name": "f", "line": "x", "angle": 170}]),
     "warning", "fold-outside", "panels.front.folds.f", "100 of 200 mm"),
    ("fold at the edge", lambda d: d["panels"]["front"].update(internal_lines={"x": [[3, 50], [3, 350]]}, folds=[{"name": "f", "line": "x", "angle": 170}]),
     "warning", "fold-at-edge", "panels.front.folds.f", "300 of 300 mm"),
    ("pleat too narrow", lambda d: d["panels"]["front"].update(pleats=[{"name": "k", "edge": "waist", "at": {"mm": 100, "from": "c"}, "depth": 8}]),
     "warning", "folds-close", "panels.front.folds.k_1_fold", "fold k_1_under is 8.0 mm away"),
    ("two folds on one line", lambda d: d["panels"]["front"].update(
        internal_lines={"x": [[100, 50], [100, 350]], "y": [[100, 200], [100, 390]]},
        folds=[{"name": "f", "line": "x", "angle": 90}, {"name": "g", "line": "y", "angle": -90}]),
     "warning", "folds-close", "panels.front.folds.f", "fold g runs along the same line for 15"),
    ("8.5 mm too short", lambda d: (long_back(d, 8.5), d.update(seams=d["seams"][:1])),
     "error", "seam-length", "seams.one", "side b 408.5 mm long; with the intended ease of 0 % side a should be 408.5 mm, it is 8.5 mm too short (8.2 mm"),
    ("8 mm too short", lambda d: (long_back(d, 8), d.update(seams=d["seams"][:1])),
     "note", "seam-length", "seams.one", "8.0 mm too short"),
    ("gathers missing", lambda d: d["seams"][0].update(ease=0.5),
     "error", "seam-length", "seams.one", "with the intended ease of 50 % side a should be 600.0 mm, it is 200.0 mm too short (12.0 mm are allowed)"),
    ("sewn twice", lambda d: d["seams"].append({"name": "three", "a": ["front.right.c", "front.right.b"], "b": ["back.hem.a", "back.hem.b"], "ease": 1 / 3}),
     "error", "edge-sewn-twice", "seams.three", "edge front.right (b to c) is sewn in seam one too"),
    ("sewn to itself", lambda d: d["seams"][0].update(b=["front.right.b", "front.right.c"]),
     "error", "edge-sewn-twice", "seams.one", "twice in this seam"),
    ("notch moved", lambda d: d["panels"]["back"]["notches"][1].update(at={"mm": 120, "from": "d"}),
     "warning", "notch-mismatch", "seams.one", "from the start to notch r side a is 100.0 mm and side b 120.0 mm"),
    ("notches that creep", lambda d: [
        d["panels"][panel]["notches"].extend({"edge": edge, "at": {"mm": mm, "from": start}, "name": name} for name, mm in places)
        for panel, edge, start, places in (("front", "right", "c", (("s", 103), ("t", 206))), ("back", "left", "d", (("s", 106), ("t", 212))))],
     "warning", "notch-mismatch", "seams.one", "from the start to notch t side a is 206.0 mm and side b 212.0 mm long"),
    ("grain a little oblique", lambda d: d["panels"]["front"].update(grain=3),
     "warning", "grain-oblique", "panels.front.grain", "grain of 3 degrees lies 3.0 degrees off"),
    ("bias a little oblique", lambda d: d["panels"]["front"].update(grain=-48),
     "warning", "grain-oblique", "panels.front.grain", "3.0 degrees off"),
    ("oblique strip", lambda d: d["panels"].update(strip=square(points={"a": [0, 0], "b": [400, 28], "c": [397, 70.9], "d": [-3, 42.9]}, notches=[])),
     "warning", "grain-oblique", "panels.strip.grain", "4.0 degrees off straight, cross or bias grain by the long axis of this strip"),
    ("twins off grain", lambda d: d["panels"].update(left=slanted(), right=slanted(-1, grain=20)),
     "warning", "grain-of-twins", "panels.right.grain", "mirror image of left, but its grain of 20 degrees lies 20.0 degrees off"),
    ("drawn dart", lambda d: drawn_dart(d, 152),
     "warning", "dart-legs", "seams.dart", f"{(100**2 + 52**2) ** 0.5:.1f} and {(100**2 + 48**2) ** 0.5:.1f} mm long; they differ by 1.8 mm"),
    ("drawn dart far off", lambda d: drawn_dart(d, 170), "error", "dart-legs", "seams.dart", "differ by 17.7 mm"),
    ("cap too short", lambda d: sleeved(d, 480), "warning", "sleeve-cap", "seams.cap_left_front", "cap is 480 mm long and the armhole 500 mm"),
    ("cap too long", lambda d: sleeved(d, 548), "warning", "sleeve-cap", "seams.cap_left_front", "+48 mm; -5 to 43 mm can be eased in"),
    ("notch alone", lambda d: d["panels"]["back"]["notches"].pop(1),
     "note", "notch-alone", "seams.one", "notch r stands on side a only"),
    ("notch twice", lambda d: d["seams"].__setitem__(slice(None), [{"name": "one", "a": ["front.right.b", "front.left.a"], "b": [
        ["back.right.b", "back.right.c"], ["back.waist.c", "back.waist.d"], ["back.left.d", "back.left.a"]]}]),
     "error", "notch-twice", "seams.one", "side a has 2 notches called r"),
    ("notch order", lambda d: [d["panels"][panel]["notches"].append({"edge": edge, "at": {"mm": mm, "from": start}, "name": "s"})
                               for panel, edge, mm, start in (("front", "right", 120, "c"), ("back", "left", 80, "d"))],
     "error", "notch-order", "seams.one", "the notches r, s"),
]  # fmt: skip


@pytest.mark.parametrize("fault", FAULTS, ids=lambda fault: fault[0])
def test_faults(fault: tuple) -> None:
    _, change, severity, code, key, message = fault
    found = [finding for finding in findings(change) if finding.code == code and finding.key == key]
    assert found
    assert (found[0].severity, found[0].file) == (severity, "tube.yaml")
    assert message in found[0].message
    assert found[0].remedy


CLEAN: list[tuple[str, Callable[[dict[str, Any]], Any]]] = [
    ("bias grain", lambda d: d["panels"].update(bias=slanted(grain=45))),
    ("grain along a slanted edge", lambda d: d["panels"].update(slanted=slanted(grain=8.7462))),
    ("a strip drawn aslant, grain along it", lambda d: d["panels"].update(
        strip=square(points={"a": [0, 0], "b": [400, 28], "c": [397, 70.9], "d": [-3, 42.9]}, notches=[], grain=4.0))),
    ("twins cut alike", lambda d: d["panels"].update(left=slanted(grain=20), right=slanted(-1, grain=-20))),
    ("folds that cross, and that meet at their ends", lambda d: d["panels"]["front"].update(
        internal_lines={"x": [[100, 50], [100, 350]], "y": [[50, 200], [200, 220]], "z": [[100, 50], [150, 350]]},
        folds=[{"name": name, "line": name, "angle": 90} for name in "xyz"])),
    ("a dart of equal legs", lambda d: drawn_dart(d, 150)),
    ("caps eased in", lambda d: sleeved(d, 520)),
    ("a gathered cap", lambda d: sleeved(d, 750)),
]  # fmt: skip


@pytest.mark.parametrize("case", CLEAN, ids=lambda case: case[0])
def test_no_false_alarm(case: tuple) -> None:
    assert [str(finding) for finding in findings(case[1])] == []


def test_thin_enough_for_a_finer_grid() -> None:
    strip = square(points={"a": [0, 0], "b": [300, 0], "c": [300, 15], "d": [0, 15]}, notches=[])
    (finding,) = findings(lambda data: data["panels"].update(strip=strip))
    assert "grid of at most 7.5 mm" in finding.remedy
    assert findings(lambda data: data["panels"].update(strip=strip), grid_mm=7.5) == []


def test_as_wide_as_two_grids_is_wide_enough() -> None:
    """The largest circle is found a hair too small."""
    strip = square(points={"a": [0, 0], "b": [20, 0], "c": [20, 300], "d": [0, 300]}, notches=[])
    assert findings(lambda data: data["panels"].update(strip=strip), grid_mm=10.0) == []


def test_too_thin_for_any_grid() -> None:
    """The finest grid is 2 mm; one of 0.5 was advised."""
    strip = square(points={"a": [0, 0], "b": [300, 0], "c": [300, 2], "d": [0, 2]}, notches=[])
    (finding,) = findings(lambda data: data["panels"].update(strip=strip))
    assert (finding.code, finding.remedy) == ("panel-too-small", "Make the panel wider.")


@pytest.mark.parametrize(("apart", "remedy"), [(1.5, "Move them apart."), (2.5, "Use a grid of at most 2.5 mm, or move them apart.")])
def test_folds_that_no_grid_tells_apart(apart: float, remedy: str) -> None:
    """The finest grid is 2 mm."""
    lines = {"x": [[100, 50], [100, 350]], "y": [[100 + apart, 50], [100 + apart, 350]]}
    folds = [{"name": name, "line": name, "angle": 90} for name in lines]
    (finding,) = findings(lambda data: data["panels"]["front"].update(internal_lines=lines, folds=folds))
    assert (finding.code, finding.remedy) == ("folds-close", remedy)


def test_a_fold_that_meets_its_mirror_image_on_the_mirror_edge() -> None:
    """A V whose two lines begin at one point, but for 1e-13 mm: the mirror edge stands at x = 0.1 and slants."""
    half = square(points={"a": [0.1, 0], "b": [300, 0], "c": [300, 400], "d": [0.3, 400]}, mirror="left")
    half["notches"] = half["notches"][:1]
    half |= {"internal_lines": {"x": [[0.2, 200], [160, 300]]}, "folds": [{"name": "f", "line": "x", "angle": 30}]}
    spec = parse_spec({**GOOD, "panels": {"front": half}, "seams": []})
    pattern = draft(spec, BODY)
    one, two = (shapely.LineString(fold.points_mm) for fold in pattern.panels["front"].folds)
    assert 0.0 < one.distance(two) < 1e-9
    assert [finding for finding in check_pattern(spec, pattern) if finding.code == "folds-close"] == []


def test_crossing_is_where_it_is() -> None:
    found = findings(lambda data: data["panels"]["front"]["points"].update(c=[100, 400], d=[150, 400], h=[150, 200]) or data.update(seams=[]))
    assert [finding.code for finding in found] == ["outline-crosses-itself"]
    # The lines from (300, 0) to (100, 400) and from (150, 400) to (0, 0) meet where 8x/3 = 2 (300 - x).
    x = 600 / (2 + 8 / 3)
    assert f"at ({x:.1f}, {8 * x / 3:.1f}) mm, on right and left" in found[0].message


def gathered(fabric: str, ratio: float, grid_mm: float = 10.0) -> list[Finding]:
    """A tube whose front is `ratio` times as high as its back, in a shipped fabric."""
    data = copy.deepcopy(GOOD)
    data["panels"]["front"]["points"] |= {"c": [300, 400 * ratio], "d": [0, 400 * ratio]}
    for seam in data["seams"]:
        seam["ease"] = ratio - 1
    sheets = {"wool": load_fabric(fabric_path(fabric)).sheet}
    return list(check_gathers(draft(parse_spec(data, "tube.yaml"), BODY), sheets, "tube.yaml", grid_mm))


def test_gathers_against_the_fabric() -> None:
    (finding, other) = gathered("wool-suiting", 2.3)
    assert (finding.severity, finding.code, finding.key, other.key) == ("warning", "gather-too-tight", "seams.one", "seams.two")
    assert "920 mm of wool-suiting are gathered into 400 mm, 2.30 to 1" in finding.message
    assert [(coarse.severity, coarse.code, coarse.key) for coarse in gathered("wool-suiting", 1.9, 20.0)] == [
        ("note", "gather-coarse", "seams.one"), ("note", "gather-coarse", "seams.two"),
    ]  # fmt: skip
    assert gathered("wool-suiting", 1.2, 20.0) == []
    assert gathered("wool-suiting", 1.9) == gathered("cotton-voile", 3.0) == gathered("wool-overcoating", 1.1) == []
    assert len(gathered("wool-overcoating", 1.5)) == 2
    row = material_row(load_fabric(fabric_path("wool-suiting")).sheet)
    stiff = row._replace(bending=(8.0 * row.bending[0], 8.0 * row.bending[1]), thickness=1e-5)
    soft = stiff._replace(bending=row.bending)
    assert (fullest(soft) - 1.0) / (fullest(stiff) - 1.0) == pytest.approx(8.0)
    assert fullest(soft._replace(thickness=0.6e-3)) == pytest.approx(2.0)


@pytest.mark.parametrize(
    ("factors", "severity", "key", "said"),
    [
        ({"W": 5}, "note", "W", "times 5, W is 93.5 mg/cm2; a sheet may have 1 to 90 mg/cm2"),
        ({"W": 20}, "warning", "W", "times 20, W is 374 mg/cm2; a sheet may have 1 to 90 mg/cm2"),
        ({"EMT": 100, "G": 2}, "warning", "EMT", "a sheet may have 0.2 to 150 %"),
        ({"Fm": 100}, "warning", "Fm", "times 100, Fm is 5000 gf/cm; a sheet may have 10 to 1000 gf/cm"),
        ({"B.warp": 1e-3}, "warning", "B.warp", "times 0.001, B.warp is "),
    ],
)
def test_a_factor_that_takes_a_value_out_of_the_range_of_a_sheet_is_found(factors: dict[str, float], severity: str, key: str, said: str) -> None:
    data = copy.deepcopy(GOOD)
    data["panels"]["front"]["regions"] = [{"name": "r", "band": {"edge": "hem", "width": 50}, "factors": factors}]
    data["fabric"] = "interlock-knit"
    found = [finding for finding in examine(parse_spec(data, "tube.yaml")) if finding.code == "factor-out-of-range"]
    assert [(finding.severity, finding.key) for finding in found] == [(severity, f"panels.front.regions.0.factors.{key}")]
    assert said in found[0].message
    data["panels"]["front"]["regions"][0]["factors"] = {"W": 2, "Fm": 40, "EMT": 0.5, "B": 4}
    assert "factor-out-of-range" not in {finding.code for finding in examine(parse_spec(data, "tube.yaml"))}


@pytest.mark.parametrize(
    ("factors", "said"),
    [
        ({"2HG5": 6}, "2HG5: with 2HG = "),
        ({"RT": 0.2}, "RT.warp: with LT = "),
        ({"B.bias": 0.01}, "B.bias: with B = "),
        ({"2HG5": 6, "G": 6}, None),
    ],
)
def test_factors_that_the_laws_cannot_have_together_are_found(factors: dict[str, float], said: str | None) -> None:
    """What a sheet of such values would be told."""
    data = copy.deepcopy(GOOD)
    data["panels"]["front"]["regions"] = [{"name": "r", "band": {"edge": "hem", "width": 50}, "factors": factors}]
    data["fabric"] = "cotton-shirting"
    found = [finding for finding in examine(parse_spec(data, "tube.yaml")) if finding.code == "factor-beyond-law"]
    assert {(finding.severity, finding.key) for finding in found} == ({("warning", "panels.front.regions.0.factors")} if said else set())
    assert all(said and finding.message.startswith(said[:3]) for finding in found)
    assert said is None or any(finding.message.startswith(said) for finding in found)


def test_errors_come_first() -> None:
    found = findings(lambda data: (data["seams"][1].update(ease=0.5), data["panels"]["back"]["notches"].pop(1)))
    ranks = [("error", "warning", "note").index(finding.severity) for finding in found]
    assert ranks == sorted(ranks)
    assert set(ranks) == {0, 1, 2}


def test_a_drape_says_what_the_doctor_calls_an_error_of_its_seams() -> None:
    """It may come to rest clean: 45 mm of a side seam are eased away, and a twisted seam is sewn as well as it goes."""
    data: dict[str, Any] = yaml.safe_load(Path(shipped_file("patterns", "flared-skirt")).read_text(encoding="utf-8"))
    clean = drape(parse_spec(data), grid_mm=50.0, max_time_s=1e-3)
    assert not [warning for warning in clean.report["warnings"] if "garmentcad check" in warning]
    side = next(seam for seam in data["seams"] if seam["name"] == "side_left")
    side["a"] = side["a"][::-1]
    (told,) = [warning for warning in drape(parse_spec(data), grid_mm=50.0, max_time_s=1e-3).report["warnings"] if "garmentcad check" in warning]
    assert told.startswith("`garmentcad check` finds an error: seams.side_left: ")
    assert told.endswith("[seam-twisted]")


def test_a_drape_says_which_regions_have_no_effect_on_its_lattice() -> None:
    data: dict[str, Any] = yaml.safe_load(Path(shipped_file("patterns", "flared-skirt")).read_text(encoding="utf-8"))
    front = data["panels"]["front"]
    hem = next(edge["name"] for edge in front["edges"] if edge.get("role") == "hem")
    front["regions"] = [{"name": "tape", "band": {"edge": hem, "width": 2}, "factors": {"B": 5}}]
    told = [warning for warning in drape(parse_spec(data), grid_mm=50.0, max_time_s=1e-3).report["warnings"] if "garmentcad check" in warning]
    assert [line.split(": ")[1] for line in told] == ["panels.front.regions.tape"]  # once, for the mirror image and the back, which is drafted as the front
    assert all("no element of the lattice of 50 mm" in line and line.endswith("[region-without-lattice]") for line in told)
    front["regions"][0]["band"]["width"] = 120
    assert not [warning for warning in drape(parse_spec(data), grid_mm=50.0, max_time_s=1e-3).report["warnings"] if "garmentcad check" in warning]


def test_refusals_are_findings() -> None:
    data = copy.deepcopy(GOOD)
    data["panels"]["front"]["edges"][1]["to"] = "d"
    pattern, errors = draft_errors(parse_spec(data, "tube.yaml"), BODY)
    assert pattern is None
    finding = refusal(errors[0])
    assert (finding.severity, finding.file, finding.key) == ("error", "tube.yaml", "panels.front.edges.2.from")
    assert str(finding).startswith("error: tube.yaml: panels.front.edges.2.from: the outline is open")
    assert str(finding).endswith(" Correct it; docs/spec.md describes every key of a spec. [refused]")
    assert "docs/garmentcode.md" in refusal(SpecError("no panel is called 'x'", file="x.json")).remedy


@pytest.mark.parametrize(("spec", "more"), [("straight-skirt", {"grid_mm": 0.0}), ("strait-skirt", {}), ("none.yaml", {}), ("t-shirt", {"fabric": "silk-9"})])
def test_only_faults_of_a_spec_name_its_page(spec: str, more: dict[str, Any]) -> None:
    (finding,) = examine(spec, **more)
    assert finding.code == "refused"
    assert str(finding).endswith(f"{finding.message}. [refused]")


def test_an_unknown_factor_is_told_once_at_its_place_in_the_file(tmp_path: Path) -> None:
    """The skirt's other front is the mirror image of the one that is drawn."""
    garment = shipped_file("patterns", "wrap-skirt").read_text(encoding="utf-8")
    (tmp_path / "skirt.yaml").write_text(garment.replace("2HG5: 2, B: 4", "2HG5: 2, BB: 4"), encoding="utf-8")
    found = [(finding.key, finding.message.partition(" is not")[0]) for finding in examine(str(tmp_path / "skirt.yaml"))]
    assert found == [(f"panels.{name}.regions.0.factors.BB", "'BB'") for name in ("back", "front_over")]


def test_names_that_nothing_uses() -> None:
    """A parameter in another's range, in a value and in a point; one that was mistyped; a value that is left over."""
    found = findings(
        lambda data: (
            data.update(
                parameters={"least": {"value": 5}, "wide": {"value": 10, "range": ["least", 20]}, "widht": {"value": 7, "doc": "of the widht"}},
                values={"more": "wide + 1", "spare": "2 * more"},
            )
            or data["panels"]["front"]["points"].update(extra=["0 * wide", 0])
        )
    )
    assert [(finding.severity, finding.code, finding.key) for finding in found] == [
        ("note", "name-unused", "parameters.widht"),
        ("note", "name-unused", "values.spare"),
    ]


def test_every_code_is_on_the_page() -> None:
    """The codes of docs/doctor.md are those of the findings in garmentcad/check, no more and no fewer."""
    root = Path(__file__).parents[1]
    emitted = set()
    for file in (root / "garmentcad" / "check").glob("*.py"):
        for call in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
            if isinstance(call, ast.Call) and isinstance(call.func, ast.Name) and call.func.id == "Finding":
                codes = call.args[1]
                emitted |= {part.value for part in ((codes.body, codes.orelse) if isinstance(codes, ast.IfExp) else (codes,)) if isinstance(part, ast.Constant)}
    table = [line.split("|")[1] for line in (root / "docs" / "doctor.md").read_text(encoding="utf-8").splitlines() if line.startswith("| `")]
    assert emitted == {code for cell in table for code in re.findall("`([a-z-]+)`", cell)}
    assert len(emitted) > 30
