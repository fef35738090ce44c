"""Seams that were forgotten: every seam of shipped garments is taken out in turn, and what it joined has to be named; what is open on purpose is not."""

from __future__ import annotations

import copy
from functools import lru_cache
from pathlib import Path
from typing import Any

import pytest
import yaml

from garmentcad.check.examine import examine
from garmentcad.check.finding import Finding
from garmentcad.io.mannequin_file import read_mannequin
from garmentcad.io.shipped import shipped_file
from garmentcad.pattern.draft import draft
from garmentcad.pattern.parse import parse_spec

CODES = ("edges-unsewn", "not-joined")


@lru_cache
def shipped(name: str) -> dict[str, Any]:
    data: dict[str, Any] = yaml.safe_load(Path(shipped_file("patterns", name)).read_text())
    return data


def found(data: dict[str, Any]) -> list[Finding]:
    return [finding for finding in examine(parse_spec(copy.deepcopy(data), "x.yaml"), grid_mm=20.0) if finding.code in CODES]


def joined(data: dict[str, Any], seam: str) -> set[str]:
    """Keys PANEL.EDGE of both sides of a seam."""
    pattern = draft(parse_spec(copy.deepcopy(data), "x.yaml"), read_mannequin(data["mannequin"]).measurements_mm)
    taken = next(one for one in pattern.seams if one.name == seam)
    return {f"{use.panel}.{pattern.panels[use.panel].edges[use.edge].name}" for use in (*taken.a, *taken.b)}


@pytest.mark.parametrize("name", ["t-shirt", "trousers", "mens-shirt", "pleated-skirt", "sheath-dress", "wrap-skirt", "lined-skirt"])
def test_whole_garments_have_nothing_open(name: str) -> None:
    """Hems, necklines, plackets in the line of a seam, fronts that button, a zip: all meant."""
    assert found(shipped(name)) == []


@pytest.mark.parametrize(
    ("name", "seam"),
    [
        ("t-shirt", "shoulder_left"), ("t-shirt", "side_right"), ("t-shirt", "underarm_left"), ("t-shirt", "armhole_left_front"), ("t-shirt", "neck_front"),
        ("t-shirt", "neckband_closing"), ("flared-skirt", "waist_back"), ("straight-skirt", "waist_front"), ("trousers", "inside_left"),
        ("trousers", "side_right"), ("sheath-dress", "bust_dart_left"), ("sheath-dress", "side_left"),
    ],
)  # fmt: skip
def test_a_seam_that_was_forgotten(name: str, seam: str) -> None:
    """Over darts as well (waist of the straight skirt, side of the sheath dress), and where one side is eased or stretched onto the other (armhole, neck)."""
    data = copy.deepcopy(shipped(name))
    data["seams"] = [one for one in data["seams"] if one["name"] != seam]
    (finding,) = found(data)
    assert (finding.severity, finding.code) == ("warning", "edges-unsewn")
    named = {text for text in finding.message.split() if "." in text}
    assert named == joined(shipped(name), seam)
    assert str(finding.key).removeprefix("panels.").replace(".edges.", ".") in named


def test_a_slit_in_the_line_of_a_seam_is_meant() -> None:
    """The side seam of a skirt ends at a point half-way down; below, both edges go straight on. In a corner of its own the same opening is reported."""
    sides: dict[str, Any] = {"points": {"a": [-300, 0], "b": [300, 0], "s": [300, 250], "c": [300, 500], "d": [-300, 500], "t": [-300, 250]}}
    names = (("hem", "a", "b"), ("slit", "b", "s"), ("right", "s", "c"), ("top", "c", "d"), ("left", "d", "t"), ("vent", "t", "a"))
    sides["edges"] = [{"name": name, "from": p, "to": q} for name, p, q in names]
    data: dict[str, Any] = {"name": "x", "fabric": "cotton-shirting", "mannequin": "woman-88", "panels": {}, "pins": []}
    for panel, angle in (("front", 0), ("back", 180)):
        wrap = {"part": "torso", "anchor": [0, 500], "angle": angle, "height": 1000, "offset": 60}
        data["panels"][panel] = {**copy.deepcopy(sides), "placement": {"wrap": wrap}}
    data["seams"] = [
        {"name": "one", "a": ["front.right.c", "front.right.s"], "b": ["back.left.d", "back.left.t"]},
        {"name": "two", "a": ["front.left.d", "front.left.t"], "b": ["back.right.c", "back.right.s"]},
    ]
    assert found(data) == []
    for panel in ("front", "back"):
        data["panels"][panel]["points"] |= {"a": [-400, 0], "b": [400, 0]}  # the slits' edges turn out by 22 degrees
    assert sorted({text for finding in found(data) for text in finding.message.split() if "." in text}) == [
        "back.slit",
        "back.vent",
        "front.slit",
        "front.vent",
    ]


def test_a_cuff_that_nothing_joins() -> None:
    data = copy.deepcopy(shipped("mens-shirt"))
    data["seams"] = [one for one in data["seams"] if one["name"] != "cuff_left"]
    assert {(finding.severity, finding.code) for finding in found(data)} == {("note", "not-joined"), ("note", "edges-unsewn")}
    (alone,) = [finding for finding in found(data) if finding.code == "not-joined"]
    assert alone.key == "panels.cuff_left"


@pytest.mark.parametrize(
    ("forgotten", "twin", "key"),
    [("shoulder_left", "shoulder_right", "panels.front.edges.shoulder"), ("shoulder_right", "shoulder_left", "panels.front.edges.shoulder_m")],
)
def test_a_seam_whose_mirror_twin_is_sewn(forgotten: str, twin: str, key: str) -> None:
    """The shoulder of a sleeveless dress lies between armhole and neckline, where no seam ends. Its front is one unfolded panel, its back two twins."""
    data = copy.deepcopy(shipped("sheath-dress"))
    data["seams"] = [one for one in data["seams"] if one["name"] != forgotten]
    (finding,) = found(data)
    assert (finding.severity, finding.code, finding.key) == ("note", "edges-unsewn", key)
    halves = finding.message.split(f": sewn to nothing, while on the mirrored side seam {twin} sews ")
    assert tuple(set(half.split(" and ")) for half in halves) == (joined(shipped("sheath-dress"), forgotten), joined(shipped("sheath-dress"), twin))


def test_open_edges_with_a_role_or_an_open_twin_are_meant() -> None:
    data = copy.deepcopy(shipped("sheath-dress"))
    data["seams"] = [one for one in data["seams"] if one["name"] != "shoulder_left"]
    both = {**data, "seams": [one for one in data["seams"] if one["name"] != "shoulder_right"]}
    assert found(both) == []
    for panel in ("front", "back_right"):
        next(edge for edge in data["panels"][panel]["edges"] if edge["name"] == "shoulder")["role"] = "neck"
    assert found(data) == []


@pytest.mark.parametrize(("role", "told"), [(None, True), ("armhole", True), ("neck", False), ("hem", False)])
def test_two_edges_that_end_together_are_open_by_their_role_alone(role: str | None, told: bool) -> None:
    """A hood of two halves on a band that closes in front: its face is open. An armhole's role stands on sleeves, which are sewn, as well."""
    outline = {"a": [0, 0], "b": [240, 0], "c": [240, 340], "d": [0, 340]}
    edges = [{"name": name, "from": a, "to": b} for name, a, b in (("neck", "a", "b"), ("back", "b", "c"), ("top", "c", "d"), ("face", "d", "a"))]
    edges[3] |= {} if role is None else {"role": role}
    ring = {"p": [0, 0], "q": [480, 0], "r": [480, 60], "m": [240, 60], "s": [0, 60]}
    around = [{"name": f"{a}{b}", "from": a, "to": b} for a, b in ("pq", "qr", "rm", "ms", "sp")]
    around[0] |= {"role": "hem"}
    panels = {
        "left": {"points": outline, "edges": edges, "placement": {"transform": {"translation": [150, 1500, 0], "rotation": [0, 90, 0]}}},
        "right": {"mirrored_from": "left", "placement": {"transform": {"translation": [-150, 1500, 0], "rotation": [0, -90, 0]}}},
        "band": {"points": ring, "edges": around, "placement": {"transform": {"translation": [-240, 1400, -200], "rotation": [0, 180, 0]}}},
    }
    pairs = {
        "back": (["left.back.b", "left.top.d"], ["right.back.b", "right.top.d"]), "ends": (["band.qr.q", "band.qr.r"], ["band.sp.p", "band.sp.s"]),
        "neck_left": (["left.neck.a", "left.neck.b"], ["band.rm.r", "band.rm.m"]),
        "neck_right": (["right.neck.a", "right.neck.b"], ["band.ms.s", "band.ms.m"]),
    }  # fmt: skip
    seams = [{"name": name, "a": a, "b": b} for name, (a, b) in pairs.items()]
    data = {"name": "hood", "fabric": "wool-suiting", "mannequin": "woman-88", "panels": panels, "seams": seams}
    assert [finding.code for finding in found(data)] == ["edges-unsewn"] * told
