"""Which material lies where: fabric of the garment, of a panel, of a region; factors; interfacing. Against the rows of the single sheets."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from garmentcad.check.finding import Finding
from garmentcad.check.region import check_regions
from garmentcad.cloth.lattice import build_cloth
from garmentcad.errors import SpecError
from garmentcad.fabric.material import material_row
from garmentcad.fabric.missing import Completed, complete
from garmentcad.fabric.sheet import sheet_from
from garmentcad.io.fabric_file import read_fabric
from garmentcad.io.shipped import shipped_file
from garmentcad.io.spec_file import read_spec
from garmentcad.mannequin.mannequin import Mannequin
from garmentcad.pattern.draft import draft
from garmentcad.pattern.parse import parse_spec
from garmentcad.pattern.pattern import Panel, named_fabrics, with_fabrics
from garmentcad.pattern.spec import MirroredPanelSpec
from garmentcad.simulation.job import Job, make_job
from garmentcad.simulation.materials import lay_out

BODY = Mannequin("none", np.zeros((0, 3)), np.zeros((0, 3), np.int32), {}, {}, {}, (), np.zeros(0, np.int32))


def completed(name: str, mass: float) -> Completed:
    return complete(sheet_from({"schema": 1, "name": name, "source": "our laboratory", "W": mass}))


FABRICS = {"wool": completed("wool", 20.0), "cotton": completed("cotton", 10.0), "measured": completed("measured", 33.0), "fusible": completed("fusible", 4.0)}


def job(**panel: Any) -> Job:
    edges = [{"name": name, "from": name, "to": after} for name, after in zip("abcd", "bcda")]
    drawn = {
        "points": {"a": [0, 0], "b": [300, 0], "c": [300, 100], "d": [0, 100]},
        "edges": edges,
        "placement": {"transform": {"translation": [0, 0, 0]}},
        **panel,
    }
    spec = parse_spec({"name": "x", "fabric": "wool", "mannequin": "woman-88", "panels": {"p": drawn}}, "x.yaml")
    return Job(spec, draft(spec, {}), FABRICS, BODY)


def square(left: float, right: float) -> list[list[float]]:
    return [[left, 0], [right, 0], [right, 100], [left, 100]]


def masses(made: Job, *x: float) -> list[float]:
    """kg/m2 at points along the middle of the panel."""
    table, material_of = lay_out(made)
    panel: Panel = made.pattern.panels["p"]
    return table.areal_mass[material_of(panel, np.array([[value, 50.0] for value in x]))].tolist()


@pytest.mark.parametrize("grid_mm", [10.0, 20.0, 25.0])
@pytest.mark.parametrize("outline", [True, False])
def test_a_region_over_all_of_a_half_panel_leaves_nothing_out(grid_mm: float, outline: bool) -> None:
    """Not where its two images meet, nor along the outline, on which it ends where it is drawn on it: mass is area times that of the region."""
    polygon = [[0, 0], [300, 0], [300, 100], [0, 100]] if outline else [[0, -50], [400, -50], [400, 200], [0, 200]]
    made = job(mirror="d", regions=[{"name": "double", "polygon": polygon, "factors": {"W": 2}}])
    table, material_of = lay_out(made)
    cloth = build_cloth(made.pattern, material_of, table, grid_mm)
    assert cloth.masses.sum() == pytest.approx(0.6 * 0.1 * 0.4, rel=1e-12)
    for elements in (cloth.links, cloth.cells, cloth.border, cloth.bends, cloth.spans):
        assert len(elements.material) > 0
        assert (elements.material != 0).all()
    assert (cloth.triangle_material != 0).all()


def test_a_region_with_a_sheet_of_its_own_stands_in_place_of_the_fabric() -> None:
    made = job(fabric="cotton", regions=[{"name": "yoke", "polygon": square(0, 100), "fabric": "measured"}])
    assert masses(made, 50.0, 150.0) == pytest.approx([0.33, 0.10])
    assert lay_out(made)[0].bending[1] == pytest.approx(material_row(FABRICS["measured"].sheet).bending)


def test_interfacing_of_a_panel_lies_under_its_regions() -> None:
    regions = [
        {"name": "double", "polygon": square(0, 100), "factors": {"W": 2}},
        {"name": "measured", "polygon": square(100, 200), "fabric": "measured"},
    ]
    made = job(interfacing="fusible", regions=regions)
    # two layers and one interfacing; a measured part as it was measured; the fabric with its interfacing
    assert masses(made, 50.0, 150.0, 250.0) == pytest.approx([0.44, 0.33, 0.24])


def test_the_later_region_counts_and_its_interfacing_is_its_own() -> None:
    regions = [
        {"name": "front", "polygon": square(0, 200), "interfacing": "fusible"},
        {"name": "strip", "polygon": square(100, 200), "factors": {"W": 1.5}},
    ]
    assert masses(job(regions=regions), 50.0, 150.0, 250.0) == pytest.approx([0.24, 0.30, 0.20])


def test_impossible_cloth_names_the_region() -> None:
    with pytest.raises(SpecError, match="impossible") as caught:
        lay_out(job(regions=[{"name": "slab", "polygon": square(0, 100), "factors": {"W": 30}, "interfacing": "fusible"}]))
    assert caught.value.key == "panels.p.regions.0.interfacing"
    assert "with 'fusible' fused to it the cloth is impossible: W = 604" in str(caught.value)
    assert caught.value.file == "x.yaml"


def test_an_interfacing_that_makes_impossible_cloth_names_the_panel() -> None:
    made, slab = job(interfacing="fusible"), completed("fusible", 89.0)
    with pytest.raises(SpecError, match="impossible") as caught:
        lay_out(replace(made, fabrics={**FABRICS, "fusible": slab}))
    assert caught.value.key == "panels.p.interfacing"


def test_the_interfacing_of_a_panel_has_its_key_and_goes_with_its_mirror_image_and_into_an_outfit() -> None:
    made = job(interfacing="fusible")
    assert named_fabrics(made.pattern) == {"fusible": "panels.p.interfacing"}
    assert with_fabrics(made.pattern, {"wool": "0 wool", "fusible": "0 fusible"}).panels["p"].interfacing == "0 fusible"
    placement = {"transform": {"translation": [0, 0, 0]}}
    spec = made.spec.model_copy(update={"panels": {**made.spec.panels, "q": MirroredPanelSpec(mirrored_from="p", placement=placement)}})
    assert draft(spec, {}).panels["q"].interfacing == "fusible"


def test_a_region_called_interfacing_is_one_like_any_other() -> None:
    made = job(interfacing="fusible", regions=[{"name": "interfacing", "polygon": square(0, 100), "factors": {"W": 2}}])
    assert masses(made, 50.0, 150.0) == pytest.approx([0.44, 0.24])
    half = job(interfacing="fusible", mirror="d", regions=[{"name": "interfacing_m", "polygon": square(0, 100), "factors": {"W": 2}}])
    assert masses(half, -150.0, -50.0, 50.0, 150.0) == pytest.approx([0.24, 0.44, 0.44, 0.24])


def band(width: float) -> dict[str, Any]:
    return {"name": f"b{width:g}", "band": {"edge": "a", "width": width}, "factors": {"W": 2}}


def without_lattice(made: Job) -> list[Finding]:
    materials, material_of = lay_out(made)
    return list(check_regions(made.pattern, build_cloth(made.pattern, material_of, materials, 10.0), "x.yaml"))


def test_a_region_that_no_element_takes_is_found() -> None:
    """At a grid of 10 mm a band of 3 mm has no effect, nor has one that a later region covers; one of 15 mm has."""

    def found(*regions: dict[str, Any]) -> list[tuple[str, str | None]]:
        return [(finding.code, finding.key) for finding in without_lattice(job(regions=list(regions)))]

    assert found(band(3)) == [("region-without-lattice", "panels.p.regions.b3")]
    assert found(band(15)) == []
    assert found(band(15), {"name": "over", "polygon": square(0, 300), "factors": {"W": 2}}) == [("region-without-lattice", "panels.p.regions.b15")]


def test_a_region_of_the_cloth_around_it_is_found() -> None:
    """Not where it takes a part out of one that lies before it."""
    plain = {"name": "plain", "polygon": square(0, 100)}
    (finding,) = without_lattice(job(regions=[{**plain, "factors": {"B": 1}}]))
    assert (finding.code, finding.key) == ("region-without-effect", "panels.p.regions.plain")
    assert without_lattice(job(regions=[{"name": "over", "polygon": square(0, 300), "factors": {"W": 2}}, plain])) == []
    assert [found.code for found in without_lattice(job(interfacing="fusible", regions=[{**plain, "interfacing": "fusible"}]))] == ["region-without-effect"]
    assert without_lattice(job(regions=[{**plain, "interfacing": "fusible"}])) == []


def test_a_polygon_that_crosses_itself_is_refused() -> None:
    """Twice around, it would cover nothing."""
    for polygon in (2 * square(0, 100), [[0, 0], [100, 100], [100, 0], [0, 50]]):
        with pytest.raises(SpecError, match="crosses or touches itself") as refused:
            job(regions=[{"name": "r", "polygon": polygon, "factors": {"W": 2}}])
        assert refused.value.key == "panels.p.regions.0.polygon"


def test_another_fabric_stands_in_place_of_the_garments_own_alone() -> None:
    """Panels, regions and interfacings that name the fabric which the garment has, too, keep it."""
    region = {"name": "r", "polygon": [[10, -200], [60, -200], [60, -10], [10, -10]], "fabric": "cotton-shirting"}
    spec = read_spec(shipped_file("patterns", "straight-skirt")).model_dump(by_alias=True, exclude_unset=True)
    spec["fabric"] = "cotton-shirting"
    front = next(panel for panel in spec["panels"].values() if "points" in panel)
    front |= {"regions": [region], "interfacing": "cotton-shirting"}
    made = make_job(parse_spec(spec, "x.yaml"), fabric="denim")
    masses = {name: done.sheet.number("W") for name, done in made.fabrics.items()}
    assert masses == {"cotton-shirting": 11.8, "cotton-shirting*": read_fabric("denim").number("W")}
    assert made.pattern.fabric == "cotton-shirting*"
    plain = make_job(parse_spec(spec, "x.yaml"))
    assert plain.pattern.fabric == "cotton-shirting"


def test_a_band_in_pieces_counts_by_its_widest_one() -> None:
    """A dart 1.2 mm from the corner cuts a sliver off the band, which no element takes; at 3 mm one takes the rest of it, at 2 mm none."""
    dart = {"name": "dart", "edge": "a", "at": {"mm": 11.2, "from": "a"}, "intake": 20, "length": 60}
    cut = job(darts=[dart], regions=[band(3)])
    assert len(cut.pattern.panels["p"].regions) == 2
    assert without_lattice(cut) == []
    (finding,) = without_lattice(job(darts=[dart], regions=[band(2)]))
    assert float(finding.message.split("the region is ")[1].split(" mm wide")[0]) == pytest.approx(2.0, abs=0.15)
