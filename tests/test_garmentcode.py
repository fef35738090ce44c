"""Patterns as GarmentCode files: import, export, import gives the same garment, and our own drafts keep their lengths, stitches and curves."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from garmentcad.errors import SpecError
from garmentcad.export.garmentcode import garmentcode_of, write_garmentcode
from garmentcad.io.garmentcode_import import import_garmentcode
from garmentcad.io.mannequin_file import read_mannequin
from garmentcad.io.shipped import shipped_file, shipped_names
from garmentcad.io.spec_file import read_spec
from garmentcad.pattern.draft import draft
from garmentcad.pattern.parse import parse_spec
from garmentcad.pattern.runs import side_length
from garmentcad.placement.wrap import transform_points, wrap_points
from tools.garmentcode_garments import GARMENTS
from tools.garmentcode_patterns import ALL, write

FILES = ALL | GARMENTS


@pytest.mark.parametrize("name", FILES)
def test_import_export_import(name: str, tmp_path: Path) -> None:
    first = draft(import_garmentcode(write(FILES[name](), tmp_path)).spec, {})
    body = read_mannequin("garmentcode-mean")
    assert write_garmentcode(tmp_path / "again.json", first, body) == []
    again = draft(import_garmentcode(tmp_path / "again.json").spec, {})
    fractions = np.linspace(0.0, 1.0, 33)
    assert list(again.panels) == list(first.panels)
    for before, after in zip(first.panels.values(), again.panels.values()):
        assert len(before.edges) == len(after.edges)
        for a, b in zip(before.edges, after.edges):
            place_a, place_b = (transform_points(edge.curve.points_at(fractions), panel.placement) for edge, panel in ((a, before), (b, after)))
            assert place_b == pytest.approx(place_a, abs=1e-8)  # m; 0.01 mm is asked for
            assert (a.role, before.grain_deg) == (b.role, after.grain_deg)
    assert [(seam.name, seam.a, seam.b) for seam in again.seams] == [(seam.name, seam.a, seam.b) for seam in first.seams]
    assert [seam.ease for seam in again.seams] == pytest.approx([seam.ease for seam in first.seams], abs=1e-6)


def test_the_file_is_the_same_twice(tmp_path: Path) -> None:
    body = read_mannequin("garmentcode-mean")
    once = garmentcode_of(draft(import_garmentcode(write(ALL["bodice"](), tmp_path)).spec, {}), body)[0]
    twice = garmentcode_of(draft(import_garmentcode(write(once, tmp_path)).spec, {}), body)[0]
    assert json.dumps(twice) == json.dumps(once)


LINED = {"lined-skirt"}  # the format has no third layer in a seam


@pytest.mark.parametrize("name", [name for name in shipped_names("patterns") if name not in LINED])
def test_shipped_drafts_keep_their_outlines_and_seams(name: str, tmp_path: Path) -> None:
    spec = read_spec(shipped_file("patterns", name))
    body = read_mannequin(spec.mannequin)
    pattern = draft(spec, body.measurements_mm)
    notes = write_garmentcode(tmp_path / "out.json", pattern, body)
    assert any("placed flat" in note for note in notes)
    again = draft(import_garmentcode(tmp_path / "out.json").spec, {})
    for panel in pattern.panels.values():
        lengths = [sum(edge.curve.length for edge in drawn.edges) for drawn in (panel, again.panels[panel.name])]
        assert lengths[1] == pytest.approx(lengths[0], abs=1e-5)
        # Every corner of the draft is one of the file, in the same order from the first on.
        corners = [[edge.curve.start for edge in drawn.edges] for drawn in (panel, again.panels[panel.name])]
        assert all(min(np.hypot(*(np.array(corners[1]) - corner).T)) < 1e-6 for corner in corners[0])
    before, after = (sum(side_length(drawn, side) for seam in drawn.seams for side in (seam.a, seam.b)) for drawn in (pattern, again))
    assert after == pytest.approx(before, abs=1e-4)
    # The pieces have the ease of their seam, so that the same points meet: equal fractions between the ends and the notches, which agree with the ease.
    eases = {round(1.0 + seam.ease, 5) for seam in pattern.seams}
    for seam in again.seams:
        ratio = side_length(again, seam.a) / side_length(again, seam.b)
        assert {round(ratio, 5), round(1.0 / ratio, 5)} & eases, seam.name


def flat_spec(edges: list[dict[str, Any]], points: dict[str, Any], seams: list[Any] = []) -> Any:  # noqa: B006
    panels = {
        name: {"points": points, "edges": edges, "placement": {"transform": {"translation": [0, 1000, z], "rotation": [0, 0, 0]}}}
        for name, z in (("a", 200), ("b", -200))
    }
    return parse_spec({"name": "flat", "fabric": "cotton-shirting", "mannequin": "woman-88", "panels": panels, "seams": seams})


POINTS = {"p": [0, 0], "q": [300, 0], "r": [300, 200], "s": [0, 200]}
SPLINE = [
    {"name": "low", "from": "p", "to": "q", "spline": {"through": [[80, -30], [190, 20]], "end_tangent": [1, 0]}, "role": "waist"},
    {"name": "right", "from": "q", "to": "r"}, {"name": "top", "from": "r", "to": "s", "role": "neck"}, {"name": "left", "from": "s", "to": "p"},
]  # fmt: skip


def test_splines_become_cubics_and_partners_are_cut_alike(tmp_path: Path) -> None:
    """A spline with two knots sewn to a straight edge: three stitches, whose ends lie at the knots' fractions of length."""
    spec = flat_spec(SPLINE, POINTS, [{"name": "s", "a": ["a.low.p", "a.low.q"], "b": ["b.top.s", "b.top.r"]}])
    pattern = draft(spec, {})
    content, _ = garmentcode_of(pattern, read_mannequin("woman-88"))
    kinds = [edge.get("curvature", {}).get("type") for edge in content["pattern"]["panels"]["a"]["edges"]]
    assert kinds == ["cubic", "cubic", "cubic", None, None, None]
    again = draft(import_garmentcode(write(content, tmp_path)).spec, {})
    curve = pattern.panels["a"].edges[0].curve
    pieces = [edge.curve for edge in again.panels["a"].edges[:3]]
    done = 0.0
    for piece in pieces:
        fractions = np.linspace(done, done + piece.length, 9) / curve.length
        assert piece.points_at(np.linspace(0, 1, 9)) == pytest.approx(curve.points_at(fractions), abs=1e-5)
        done += piece.length
    assert done == pytest.approx(curve.length, abs=1e-6)
    sides = [tuple(side_length(again, side) for side in (seam.a, seam.b)) for seam in again.seams]
    assert [a / b for a, b in sides] == pytest.approx([curve.length / 300.0] * 3, rel=1e-6)
    assert [a for a, _ in sides] == pytest.approx([piece.length for piece in pieces])


def test_seams_alike_along_both_outlines_are_right_wrong() -> None:
    edges = [{key: value for key, value in edge.items() if key != "spline"} for edge in SPLINE]
    straight = {"name": "s", "a": ["a.right.q", "a.right.r"], "b": ["b.left.p", "b.left.s"]}
    turned = {"name": "s", "a": ["a.right.q", "a.right.r"], "b": ["b.left.s", "b.left.p"]}
    body = read_mannequin("woman-88")
    for seam, wanted in ((straight, 2), (turned, 3)):
        content, _ = garmentcode_of(draft(flat_spec(edges, POINTS, [seam]), {}), body)
        (stitch,) = content["pattern"]["stitches"]
        assert len(stitch) == wanted
        assert stitch[:2] == [{"panel": "a", "edge": 1}, {"panel": "b", "edge": 3}]


def test_labels_of_a_stitch_agree() -> None:
    """GarmentCode's simulator refuses a stitch between a collar and a waist."""
    spec = flat_spec(SPLINE, POINTS, [{"name": "s", "a": ["a.low.p", "a.low.q"], "b": ["b.top.s", "b.top.r"]}])
    content, _ = garmentcode_of(draft(spec, {}), read_mannequin("woman-88"))
    panels = content["pattern"]["panels"]
    for a, b in content["pattern"]["stitches"]:
        labels = {panels[end["panel"]]["edges"][end["edge"]].get("label") for end in (a, b)}
        assert labels == {"lower_interface", None}
    assert panels["a"]["edges"][4]["label"] == "collar"


def test_a_wrapped_panel_lies_in_the_nearest_plane(tmp_path: Path) -> None:
    """A front of the T-shirt: its plane looks forward, and no small turn or shift brings it nearer to the wrapped panel."""
    spec = read_spec(shipped_file("patterns", "t-shirt"))
    body = read_mannequin("woman-88")
    pattern = draft(spec, body.measurements_mm)
    write_garmentcode(tmp_path / "out.json", pattern, body)
    placed = draft(import_garmentcode(tmp_path / "out.json").spec, {}).panels["front"].placement
    panel = pattern.panels["front"]
    flat = np.concatenate([edge.curve.points_at(np.linspace(0, 1, int(edge.curve.length // 5) + 2)[:-1]) for edge in panel.edges])
    wrapped = wrap_points(flat, panel.placement, body.cylinders["torso"])

    def off(translation: tuple[float, ...], rotation: tuple[float, ...]) -> float:
        moved = transform_points(flat, type(placed)(translation, rotation))  # type: ignore[arg-type,call-arg]
        return float(((moved - wrapped) ** 2).sum())

    best = off(placed.translation_mm, placed.rotation_deg)  # type: ignore[union-attr]
    for k in range(3):
        for step in (-2.0, 2.0):
            shifted, turned = list(placed.translation_mm), list(placed.rotation_deg)  # type: ignore[union-attr]
            shifted[k] += step
            turned[k] += step
            assert off(tuple(shifted), placed.rotation_deg) > best  # type: ignore[union-attr]
            assert off(placed.translation_mm, tuple(turned)) > best  # type: ignore[union-attr]
    assert placed.matrix[2, 2] > 0.99  # type: ignore[union-attr]


@pytest.mark.parametrize(
    ("name", "wanted"),
    [
        ("trousers", ["panel front_left: internal lines, seam allowances left out", "seam center_front: order 2 left out", "fabric wool-suiting: left out"]),
        ("pleated-skirt", ["panel front: pleats and their angles", "parameters and values: left out"]),
        ("mens-shirt", ["panel back: notches, seam allowances left out", "seam collar: fold angle, order 4, bend factor left out"]),
    ],
)
def test_what_shipped_garments_lose_is_said(name: str, wanted: list[str]) -> None:
    spec, body = read_spec(name), read_mannequin("woman-88")
    notes = garmentcode_of(draft(spec, body.measurements_mm), body)[1]
    assert [text for text in wanted if not any(note.startswith(text) for note in notes)] == []


def test_a_label_that_gives_way_is_said() -> None:
    spec = flat_spec(SPLINE, POINTS, [{"name": "s", "a": ["a.low.p", "a.low.q"], "b": ["b.top.s", "b.top.r"]}])
    notes = garmentcode_of(draft(spec, {}), read_mannequin("garmentcode-mean"))[1]
    lost = "panel b: the label collar of edge {} left out; it is sewn to an edge with the label lower_interface"
    assert sorted(notes) == [lost.format(edge) for edge in (4, 5, 6)]


def test_what_the_format_cannot_say() -> None:
    hole = [{"name": "h", "from": "h", "to": "h", "arc": {"center": [150, 100], "direction": "clockwise"}}]
    spec = flat_spec(SPLINE, POINTS | {"h": [160, 100]})
    panels = {name: panel.model_copy(update={"grain": 45.0, "drill_holes": {"d": (1.0, 2.0)}}) for name, panel in spec.panels.items()}
    body = read_mannequin("woman-88")
    _, notes = garmentcode_of(draft(spec.model_copy(update={"panels": panels}), {}), body)
    assert notes[0] == "panel a: drill holes, its grain of 45 degrees left out; the format has no place for them"
    assert "mannequin woman-88: left out; the format has no place for it, and `garmentcad import` assumes garmentcode-mean" in notes
    data = spec.model_dump(mode="json", by_alias=True)
    data["panels"]["a"]["cutouts"] = [hole]
    with pytest.raises(SpecError, match="no cutouts"):
        garmentcode_of(draft(parse_spec(data), {}), body)
    with pytest.raises(SpecError, match=r"lining_waist_back_right.*third layer"):
        garmentcode_of(draft(read_spec(shipped_file("patterns", "lined-skirt")), body.measurements_mm), body)


def test_a_curve_without_length_has_no_place_in_the_format() -> None:
    """Two points of a spec may lie on each other; GarmentCode tells curves by their chords."""
    loop = {"name": "loop", "from": "q", "to": "twin", "quadratic": POINTS["q"]}
    edges = [SPLINE[0], loop, {**SPLINE[1], "from": "twin"}, *SPLINE[2:]]
    spec = flat_spec(edges, POINTS | {"twin": POINTS["q"]})
    with pytest.raises(SpecError, match="the curve ends where it begins") as caught:
        garmentcode_of(draft(spec, {}), read_mannequin("woman-88"))
    assert caught.value.key == "panels.a.edges.loop"
