"""Tubes that close beside their limb, on a shipped body: a leg-warmer that spans little of the cylinder on which it is wrapped, and one that goes around."""

from __future__ import annotations

from typing import Any

import pytest

from garmentcad.check.examine import examine
from garmentcad.pattern.parse import parse_spec

EDGES = [{"name": name, "from": p, "to": q} for name, p, q in (("hem", "a", "b"), ("back", "b", "c"), ("top", "c", "d"), ("front", "d", "a"))]


def tube(girth_mm: float, height_mm: float, part: str, height: float, **wrap: Any) -> list[str]:
    """Codes of a tube of one panel, 200 mm long or as its height says."""
    half = girth_mm / 2
    panel = {
        "points": {"a": [-half, 0], "b": [half, 0], "c": [half, height_mm], "d": [-half, height_mm]}, "edges": EDGES,
        "placement": {"wrap": {"part": part, "anchor": [0, 0], "angle": 90, "height": height, "offset": 30, **wrap}},
    }  # fmt: skip
    seams = [{"name": "inside", "a": ["tube.front.d", "tube.front.a"], "b": ["tube.back.c", "tube.back.b"]}]
    spec = {"name": "tube", "fabric": "interlock-knit", "mannequin": "woman-88", "panels": {"tube": panel}, "seams": seams}
    return [finding.code for finding in examine(parse_spec(spec, "tube.yaml"), grid_mm=20.0)]


@pytest.mark.parametrize(("scale", "beside"), [(1.0, True), (0.62, False)])
def test_a_leg_warmer(scale: float, beside: bool) -> None:
    """330 mm on a cylinder of the thigh: less than half of it. Draped it fell off; at 0.62 of the radius it came to rest around the calf."""
    assert ("tube-beside-limb" in tube(330.0, 200.0, "leg_left", 200.0, scale=scale)) is beside


@pytest.mark.parametrize(("girth", "beside"), [(150.0, True), (400.0, False)])
def test_a_band_around_the_wrist(girth: float, beside: bool) -> None:
    assert ("tube-beside-limb" in tube(girth, 60.0, "arm_left", -480.0)) is beside


@pytest.mark.parametrize(("garment", "body"), [("knit-top", "man-100"), ("mens-shirt", "man-120"), ("trousers", "woman-122")])
def test_shipped_sleeves_and_legs_go_around(garment: str, body: str) -> None:
    assert "tube-beside-limb" not in [finding.code for finding in examine(garment, body, 20.0)]
