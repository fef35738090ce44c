"""Whole garments as GarmentCode files, drafted by us for its default body: a collar, a hood, godets, tiers, a jumpsuit. Data as in garmentcode_patterns.py."""

from __future__ import annotations

from typing import Any

from tools.garmentcode_patterns import Data, panel, pattern_file, stitch

Points = list[tuple[float, float]]
FRONT_Z, BACK_Z = 28, -20
_ARMHOLE = ([0.4, 0.2], [0.6, 0.2])  # of the wearer's left on a front, and of the other side


def _top(neck: float) -> Data:
    """Half of a boxy top without sleeves; neck: height of its middle. Edges: hem, side, armhole, shoulder, half a neck, and the same back again."""
    points = [(-28, 0), (28, 0), (28, 30), (18, 47), (8, 51), (0, neck), (-8, 51), (-18, 47), (-28, 30)]
    deep = 0.25 if neck < 48 else 0.1
    curves: dict[str, Any] = {"e2": _ARMHOLE[0], "e4": [0.5, deep], "e5": [0.5, deep], "e7": _ARMHOLE[1]}
    return {"points": points, "curves": curves}


def _body() -> tuple[Data, list[Any]]:
    """Front and back of the top, sewn at shoulders and sides."""
    front, back = _top(43), _top(49)
    panels = {
        "front": panel(*front["points"], at=(0, 90, FRONT_Z), label="body", label4="left_collar", label5="right_collar", **front["curves"]),
        "back": panel(*back["points"], at=(0, 90, BACK_Z), turned=(0, 180, 0), label="body", label4="right_collar", label5="left_collar", **back["curves"]),
    }
    return panels, [stitch("front", 1, "back", 8), stitch("front", 8, "back", 1), stitch("front", 3, "back", 6), stitch("front", 6, "back", 3)]


def collar() -> Data:
    """A boxy top with a stand collar: two straight bands, each sewn to both halves of its neck."""
    panels, stitches = _body()
    panels["collar_front"] = panel((0, 0), (12.2, 0), (24.4, 0), (24.4, 5), (0, 5), at=(-12.2, 143, 18), label="body")
    panels["collar_back"] = panel((0, 0), (8.3, 0), (16.6, 0), (16.6, 5), (0, 5), at=(8.3, 143, -12), turned=(0, 180, 0), label="body")
    stitches += [stitch("collar_front", 0, "front", 5), stitch("collar_front", 1, "front", 4), stitch("collar_back", 0, "back", 5)]
    stitches += [stitch("collar_back", 1, "back", 4), stitch("collar_front", 2, "collar_back", 4), stitch("collar_front", 4, "collar_back", 2)]
    return pattern_file(panels, stitches)


def hood() -> Data:
    """A boxy top with a hood: a panel on each side of the head, sewn to each other from the nape to the forehead."""
    panels, stitches = _body()
    side: Points = [(0, 0), (9, 7), (17, 7.5), (21, 20), (20, 36), (10, 44), (-1, 42)]
    panels["hood_left"] = panel(*side, at=(12, 143, 13), turned=(0, 90, 0), e0=[0.5, -0.1], e4=[0.5, -0.2])
    panels["hood_right"] = panel(
        *[(-x, y) for x, y in [side[0], *side[:0:-1]]], at=(-12, 143, 13), turned=(0, -90, 0), e2=[0.5, -0.2], e6=[0.5, -0.1],
    )  # fmt: skip
    stitches += [stitch("hood_left", k, "hood_right", 6 - k) for k in (2, 3, 4, 5)]
    stitches += [stitch("hood_left", 0, "front", 4), stitch("hood_left", 1, "back", 5), stitch("hood_right", 6, "front", 5), stitch("hood_right", 5, "back", 4)]
    return pattern_file(panels, stitches)


def _band() -> tuple[Data, list[Any]]:
    """A waistband of front and back, 4 high; the edge to sew on is 0."""
    panels = {
        "band_front": panel((0, 0), (43, 0), (43, 4), (0, 4), at=(-21.5, 105, FRONT_Z), label="body", label2="lower_interface"),
        "band_back": panel((0, 0), (43, 0), (43, 4), (0, 4), at=(21.5, 105, BACK_Z), turned=(0, 180, 0), label="body", label2="lower_interface"),
    }
    return panels, [stitch("band_front", 1, "band_back", 3), stitch("band_front", 3, "band_back", 1)]


def godets() -> Data:
    """A straight skirt, eased into its band, with a godet in a slit of front and back."""
    panels, stitches = _band()
    half: Points = [(0, 0), (26, 0), (27, 25), (28, 0), (54, 0), (53, 55), (1, 55)]
    wedge: Points = [(0, 0), (20, 0), (10, 22.94)]
    for name, turned, away, z in (("front", 0, 1, FRONT_Z), ("back", 180, -1, BACK_Z)):
        panels[f"skirt_{name}"] = panel(*half, at=(-27 * away, 48, z), turned=(0, turned, 0), label="leg")
        panels[f"godet_{name}"] = panel(*wedge, at=(-10 * away, 48, z + 6 * away), turned=(0, turned, 0), label="leg")
        stitches += [stitch(f"skirt_{name}", 1, f"godet_{name}", 2), stitch(f"skirt_{name}", 2, f"godet_{name}", 1)]
        stitches.append(stitch(f"skirt_{name}", 5, f"band_{name}", 0))
    return pattern_file(panels, [*stitches, stitch("skirt_front", 4, "skirt_back", 6), stitch("skirt_front", 6, "skirt_back", 4)])


def tiers() -> Data:
    """A skirt of two tiers under a band, each gathered 1.3 to 1."""
    panels, stitches = _band()
    above, edge = "band", 0
    for name, width, height, low in (("upper", 56.0, 20, 83), ("lower", 73.0, 24, 57)):
        points: Points = [(0, 0), (width, 0), (width, height), (0, height)]
        for side, turned, away, z in (("front", 0, 1, FRONT_Z), ("back", 180, -1, BACK_Z)):
            panels[f"{name}_{side}"] = panel(*points, at=(-0.5 * width * away, low, z), turned=(0, turned, 0), label="leg")
            stitches.append(stitch(f"{name}_{side}", 2, f"{above}_{side}", edge))
        stitches += [stitch(f"{name}_front", 1, f"{name}_back", 3), stitch(f"{name}_front", 3, f"{name}_back", 1)]
        above = name
    return pattern_file(panels, stitches)


def jumpsuit() -> Data:
    """A wide jumpsuit without sleeves: four panels from shoulder to ankle, with the crotch in their middle seams."""
    front: Points = [(4.5, 135), (4.5, 82), (0, 70), (3, 12), (30, 12), (33, 80), (32, 120), (22, 138), (12, 142)]
    back: Points = [(8, 140), (8, 84), (0, 70), (3, 12), (32, 12), (36, 80), (35.5, 120), (25.5, 138), (15.5, 142)]
    panels: Data = {}
    for name, points, z, deep in (("front", front, FRONT_Z, 0.2), ("back", back, BACK_Z, 0.1)):
        crotch, neck = {"type": "quadratic", "params": [[0.7, 0.3]]}, [0.5, deep]
        # Loops run counter-clockwise seen from outside: the half that lies at positive x of its panel goes down the middle first.
        left, right = (1, -1) if name == "front" else (-1, 1)
        for side, sign in (("left", left), ("right", right)):
            drawn = points if sign > 0 else [(-x, y) for x, y in [points[0], *points[:0:-1]]]
            curves: dict[str, Any] = {"e1": crotch, "e6": _ARMHOLE[0], "e8": neck}
            if sign < 0:
                curves = {"e7": {"type": "quadratic", "params": [[0.3, 0.3]]}, "e2": _ARMHOLE[1], "e0": neck}
            panels[f"{side}_{name}"] = panel(*drawn, at=(0, 0, z), turned=(0, 0 if name == "front" else 180, 0), label="leg", **curves)
    # Edges of the half at positive x: middle 0, crotch 1, inseam 2, hem 3, side 4 and 5, armhole 6, shoulder 7, neck 8; of the other one 8 - k.
    fore, aft = ("left_front", "right_front"), ("right_back", "left_back")
    stitches = [stitch(*pair) for k in (0, 1) for pair in ((fore[0], k, fore[1], 8 - k), (aft[0], k, aft[1], 8 - k))]
    stitches += [stitch(*pair) for k in (2, 4, 5, 7) for pair in ((fore[0], k, aft[1], 8 - k), (aft[0], k, fore[1], 8 - k))]
    return pattern_file(panels, stitches)


GARMENTS = {"collar": collar, "hood": hood, "godets": godets, "tiers": tiers, "jumpsuit": jumpsuit}
