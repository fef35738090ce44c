"""The garments in patterns/ draft for small and large bodies: seams as intended, lengths and areas as computed by hand."""

from __future__ import annotations

import math
import re
from pathlib import Path

import numpy as np
import pytest
import shapely

from garmentcad.check.examine import examine
from garmentcad.io.shipped import shipped_file
from garmentcad.io.spec_file import read_spec
from garmentcad.pattern.draft import draft
from garmentcad.pattern.pattern import EdgeUse, Panel, Pattern, Wrap

# Women: girths of EN 13402-3 steps; the rest from a public table of UK sizes 6, 12, 20 and 26. The man is an estimate. Heights are proportions of the stature.
BODIES = ("woman-76", "woman-88", "woman-104", "woman-122", "man-100")
MEASUREMENTS = {
    "bust": (760, 880, 1040, 1220, 1000), "waist": (600, 720, 880, 1060, 880), "hip": (840, 960, 1120, 1270, 1020), "stature": (1680, 1680, 1680, 1680, 1780),
    "neck_base": (340, 370, 410, 452, 420), "back_width": (314, 344, 384, 426, 400), "chest_front": (288, 324, 372, 426, 380),
    "shoulder": (115, 122.5, 132.5, 142, 155), "armscye_depth": (198, 210, 226, 244, 244), "nape_to_waist": (398, 410, 426, 438, 446),
    "waist_to_hip": (197, 206, 218, 227, 210), "waist_to_knee": (570, 585, 605, 620, 610), "waist_to_floor": (1010, 1040, 1080, 1110, 1080),
    "top_arm": (248, 284, 332, 392, 320), "wrist": (145, 160, 180, 201, 175), "arm_length": (570, 585, 602.5, 610, 640), "thigh": (500, 560, 640, 720, 570),
}  # fmt: skip
HEIGHTS = {"nape": 0.863, "neck_front": 0.835, "shoulder": 0.82, "bust": 0.72, "waist": 0.62, "hip": 0.5, "crotch": 0.46, "knee": 0.28}
GARMENTS = ("flared-skirt", "straight-skirt", "t-shirt", "trousers", "knit-top")
WOMENS = ("sheath-dress", "lined-skirt")
WORN = [(garment, body) for garment in GARMENTS for body in BODIES] + [(garment, body) for garment in WOMENS for body in BODIES if body.startswith("woman")]
FREE = {"hem", "hem_m", "top"}  # edges that are sewn to nothing, but for
FACED = {"sheath-dress": {"neck", "neck_m", "armhole", "armhole_m"}}


def measurements(body: str) -> dict[str, float]:
    values = {name: float(row[BODIES.index(body)]) for name, row in MEASUREMENTS.items()}
    return values | {f"{name}_height": share * values["stature"] for name, share in HEIGHTS.items()}


def drafted(garment: str, body: str) -> Pattern:
    return draft(read_spec(shipped_file("patterns", garment)), measurements(body))


def edge_length(panel: Panel, *names: str) -> float:
    """Summed length of the named edges, darts left out."""
    lengths = {name: sum(edge.curve.length for edge in panel.edges if edge.name == name and edge.dart is None) for name in names}
    assert all(lengths.values()), lengths
    return sum(lengths.values())


def side_length(pattern: Pattern, side: tuple[EdgeUse, ...]) -> float:
    return sum(pattern.panels[use.panel].edges[use.edge].curve.length for use in side)


def side_ends(pattern: Pattern, side: tuple[EdgeUse, ...]) -> tuple[str, str]:
    first, last = (pattern.panels[use.panel].edges[use.edge] for use in (side[0], side[-1]))
    return first.end if side[0].reverse else first.start, last.start if side[-1].reverse else last.end


def polygon(panel: Panel) -> shapely.Polygon:
    return shapely.Polygon(np.concatenate([edge.curve.polyline(0.01)[:-1] for edge in panel.edges]))


@pytest.mark.parametrize(("garment", "body"), WORN)
def test_drafts_for_small_and_large_bodies(garment: str, body: str) -> None:
    pattern = drafted(garment, body)
    for name, panel in pattern.panels.items():
        outline = polygon(panel)
        assert outline.is_valid, name
        assert outline.exterior.is_ccw, name
        assert min(edge.curve.length for edge in panel.edges) > 3.0, name
        for a, b in zip(panel.edges, (*panel.edges[1:], panel.edges[0]), strict=True):
            assert math.dist(a.curve.end, b.curve.start) < 1e-6, (name, a.name, b.name)
    for seam in pattern.seams:
        assert side_length(pattern, seam.a) == pytest.approx((1.0 + seam.ease) * side_length(pattern, seam.b), abs=1e-6), seam.name


@pytest.mark.parametrize("garment", [*GARMENTS, *WOMENS])
def test_every_edge_is_sewn_once_or_is_free_on_purpose(garment: str) -> None:
    pattern = drafted(garment, "woman-88")
    sides = [seam.b if seam.caught_in is not None else (*seam.a, *seam.b) for seam in pattern.seams]
    used = [(use.panel, use.edge) for side in sides for use in side]
    assert len(used) == len(set(used))
    free = {(name, edge.name) for name, panel in pattern.panels.items() for index, edge in enumerate(panel.edges) if (name, index) not in set(used)}
    assert {edge for _, edge in free} <= FREE | FACED.get(garment, set()), free
    assert {name for name, _ in free} == set(pattern.panels)


@pytest.mark.parametrize("body", BODIES)
@pytest.mark.parametrize("sector", [60.0, 90.0, 150.0])
def test_flared_skirt_is_a_sector_of_an_annulus(body: str, sector: float) -> None:
    pattern = draft(read_spec(shipped_file("patterns", "flared-skirt")), measurements(body), {"sector": sector})
    waist = measurements(body)["waist"] + 20.0
    angle = math.radians(2.0 * sector)
    inner = waist / angle
    outer = inner + 600.0
    area = sum(polygon(pattern.panels[name]).area for name in ("front", "back"))
    assert area == pytest.approx(angle / 2.0 * (outer**2 - inner**2), rel=1e-4)
    assert edge_length(pattern.panels["front"], "hem", "hem_m") == pytest.approx(angle / 2.0 * outer, rel=1e-9)
    assert edge_length(pattern.panels["waistband"], "top") == pytest.approx(waist, abs=1e-9)
    rule = pattern.panels["front"].placement
    assert isinstance(rule, Wrap)
    assert math.sin(math.radians(rule.flare_deg)) == pytest.approx(angle / (2.0 * math.pi))
    if sector == 90.0:
        assert inner == pytest.approx(waist / math.pi)
        assert rule.flare_deg == pytest.approx(30.0)


@pytest.mark.parametrize("body", BODIES)
def test_straight_skirt_girths_are_body_plus_ease(body: str) -> None:
    pattern, given = drafted("straight-skirt", body), measurements(body)
    front, left, right, band = (pattern.panels[name] for name in ("front", "back_left", "back_right", "waistband"))
    sewn_waist = edge_length(front, "waist", "waist_m") + edge_length(left, "waist") + edge_length(right, "waist")
    assert sewn_waist == pytest.approx(given["waist"] + 20.0, abs=1e-6)
    assert edge_length(band, "top") == pytest.approx(given["waist"] + 20.0, abs=1e-9)
    level = shapely.LineString([(-1e4, -given["waist_to_hip"]), (1e4, -given["waist_to_hip"])])
    girth = sum(polygon(panel).intersection(level).length for panel in (front, left, right))
    assert girth == pytest.approx(given["hip"] + 85.0, abs=0.1)
    # the waist line of half a front, darts open, is an arc from (0, 0), horizontal there, to the side seam
    side = front.points["waist_side"]
    radius = math.hypot(*side) ** 2 / (2.0 * side[1])
    assert side[1] == pytest.approx(12.0)
    legs = [edge for edge in front.edges if edge.dart is not None]
    intake = radius * 2.0 * math.asin(math.hypot(*side) / (2.0 * radius)) - edge_length(front, "waist")
    assert len(legs) == 8
    assert 4.0 < 0.5 * intake < 20.0, "two darts in each half"
    apexes = sorted(point[1] for edge in right.edges if edge.dart for point in (edge.curve.start, edge.curve.end))
    assert right.points["waist_center"][1] == pytest.approx(-10.0)
    assert -given["waist_to_hip"] + 30.0 < apexes[0], "back darts end above the hip line"


@pytest.mark.parametrize("body", BODIES)
def test_t_shirt_girths_neckline_and_cap(body: str) -> None:
    pattern, given = drafted("t-shirt", body), measurements(body)
    front, back, sleeve, band = (pattern.panels[name] for name in ("front", "back", "sleeve_left", "neckband"))
    assert 2.0 * (front.points["underarm"][0] + back.points["underarm"][0]) == pytest.approx(given["bust"] + 120.0)
    assert 2.0 * (front.points["waist_side"][0] + back.points["waist_side"][0]) == pytest.approx(given["bust"] + 120.0), "straight to the waist"
    assert front.points["waist_side"][1] == back.points["waist_side"][1] == -given["nape_to_waist"]
    # By hand: 20 below the armscye line, and an eighth of what the bust has beyond 1000, 24 at most.
    depth = {"woman-76": 218.0, "woman-88": 230.0, "woman-104": 251.0, "woman-122": 288.0, "man-100": 264.0}[body]
    assert [panel.points["underarm"][1] for panel in (front, back)] == pytest.approx([-depth, -depth])
    assert edge_length(front, "hem", "hem_m") + edge_length(back, "hem", "hem_m") == pytest.approx(max(given["bust"] + 120.0, given["hip"] + 60.0))
    opening = edge_length(front, "neck", "neck_m", "neck_side", "neck_side_m") + edge_length(back, "neck", "neck_m", "neck_side", "neck_side_m")
    assert opening == pytest.approx(edge_length(band, "seam_back", "seam_front"), abs=1e-6)
    assert opening >= 595.0 - 1e-6, "a head of 575 mm passes"
    front_armhole, back_armhole = (edge_length(panel, "armhole_top", "armhole", "armhole_low") for panel in (front, back))
    cap = edge_length(sleeve, "crown_front", "cap_front", "hollow_front", "crown_back", "cap_back", "hollow_back")
    assert cap / (front_armhole + back_armhole) - 1.0 == pytest.approx(0.01, abs=1e-9)
    assert 0.45 * given["bust"] < front_armhole + back_armhole < 0.65 * given["bust"]
    bicep = sleeve.points["underarm_back"][0] - sleeve.points["underarm_front"][0]
    assert 80.0 < bicep - given["top_arm"] < 150.0
    cap_height = polygon(sleeve).bounds[3]
    assert 0.22 < cap_height / (front_armhole + back_armhole) < 0.33
    assert edge_length(front, "shoulder") > 60.0
    for point in ("neck", "shoulder"):  # sewn at the shoulder, neckline and armhole run on without a corner
        assert [interior_angle(panel, point) for panel in (front, back)] == pytest.approx([90.0, 90.0])


def interior_angle(panel: Panel, point: str) -> float:
    """Angle inside the panel at a named corner, degrees."""
    before, after = next(edge for edge in panel.edges if edge.end == point), next(edge for edge in panel.edges if edge.start == point)
    back, ahead = -before.curve.tangents_at(1.0)[0], after.curve.tangents_at(0.0)[0]
    return math.degrees((math.atan2(back[1], back[0]) - math.atan2(ahead[1], ahead[0])) % (2.0 * math.pi))


def test_grain_lies_on_the_straight_except_where_stated() -> None:
    grains = {garment: {name: panel.grain_deg for name, panel in drafted(garment, "woman-88").panels.items()} for garment in GARMENTS}
    assert grains["flared-skirt"] == {"front": 0.0, "back": 0.0, "waistband": 90.0}
    assert grains["straight-skirt"] == {"front": 0.0, "back_right": 0.0, "back_left": 0.0, "waistband": 90.0}
    assert grains["t-shirt"] == {"front": 0.0, "back": 0.0, "sleeve_left": 0.0, "sleeve_right": 0.0, "neckband": 45.0}
    assert set(grains["trousers"].values()) == {0.0, 90.0}
    front = drafted("flared-skirt", "woman-88").panels["front"]
    side = next(edge for edge in front.edges if edge.name == "side").curve.tangents_at(0.5)[0]
    assert abs(side[0]) == pytest.approx(abs(side[1])), "side seams on the true bias"


def test_mirrored_panels_are_mirror_images() -> None:
    for garment, one, other in (("t-shirt", "sleeve_left", "sleeve_right"), ("straight-skirt", "back_right", "back_left"), ("flared-skirt", "front", "back")):
        pattern = drafted(garment, "woman-88")
        a, b = pattern.panels[one], pattern.panels[other]
        assert a.points.keys() == b.points.keys()
        assert np.array([(-x, y) for x, y in a.points.values()]) == pytest.approx(np.array([b.points[name] for name in a.points]))
        assert polygon(a).area == pytest.approx(polygon(b).area, rel=1e-9)
    sleeve = drafted("t-shirt", "woman-88").panels["sleeve_left"]
    assert sleeve.points["underarm_back"][0] > 0.0, "seen from outside with the shoulder up, the back of the left sleeve is at the right"


@pytest.mark.parametrize("garment", GARMENTS)
def test_seams_join_points_that_meet_on_the_body(garment: str) -> None:
    """Ends that meet carry the same name but for the mirror's suffix, except on the bands, which name points of their own."""
    pattern = drafted(garment, "woman-88")
    for seam in pattern.seams:
        if "." in seam.name or any(use.panel in ("waistband", "neckband") for use in (*seam.a, *seam.b)):  # a dart, a band
            continue
        for a, b in zip(side_ends(pattern, seam.a), side_ends(pattern, seam.b), strict=True):
            assert re.sub("_(m|front|back)$", "", a) == re.sub("_(m|front|back)$", "", b), seam.name
            assert a.endswith("_m") != b.endswith("_m") or garment not in ("t-shirt", "knit-top") or seam.name.startswith(("underarm", "armhole")), seam.name


@pytest.mark.parametrize("mannequin", ["woman-100", "woman-104", "man-120"])
def test_t_shirt_starts_free_on_large_bodies(mannequin: str) -> None:
    """Sleeves once crossed the body panels where the shoulders are wide, and the chest came through the front."""
    assert [str(finding) for finding in examine(shipped_file("patterns", "t-shirt"), mannequin, 20.0) if finding.severity == "error"] == []


@pytest.mark.parametrize(("garment", "mannequin"), [(garment, body) for garment, body in WORN if body in ("woman-88", "man-100")])
def test_the_doctor_finds_nothing(garment: str, mannequin: str) -> None:
    """Seams, outlines, fabrics, the start positions around the body. Zips and flies that the drafts sew shut are seen."""
    shut = "sewn shut" in read_spec(shipped_file("patterns", garment)).description or garment == "flared-skirt"
    assert [str(f) for f in examine(shipped_file("patterns", garment), mannequin) if not (shut and f.code == "closure-missing")] == []


def test_the_how_to_drafts(tmp_path: Path) -> None:
    page = Path(__file__).resolve().parent.parent / "docs/howto/add-a-garment.md"
    blocks = re.findall(r"```yaml\n(.*?)```", page.read_text(), flags=re.DOTALL)
    spec = tmp_path / "apron.yaml"
    spec.write_text("".join(blocks))
    pattern = draft(read_spec(spec), measurements("woman-88"))
    assert side_length(pattern, pattern.seams[0].a) == pytest.approx(side_length(pattern, pattern.seams[0].b)) == pytest.approx(420.0)
