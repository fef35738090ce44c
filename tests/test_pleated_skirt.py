"""The pleated skirt's draft: panels as wide as the yoke and twice the depth of their pleats, side seams half-way between two pleats, on all sizes."""

from __future__ import annotations

import numpy as np
import pytest
from test_shipped_patterns import drafted, measurements, polygon

from garmentcad.check.examine import examine
from garmentcad.io.shipped import shipped_file
from garmentcad.pattern.runs import side_length

BODIES = ("woman-76", "woman-88", "woman-122")


@pytest.mark.parametrize("body", BODIES)
def test_panels_are_cut_for_the_yoke_and_its_pleats(body: str) -> None:
    pattern = drafted("pleated-skirt", body)
    half = (measurements(body)["hip"] + 50.0) / 2.0
    for name in ("front", "back"):
        assert polygon(pattern.panels[name]).area == pytest.approx((half + 12 * 50.0) * 490.0)
        seam = next(seam for seam in pattern.seams if seam.name == f"yoke_seam_{name}")
        assert side_length(pattern, seam.a) == pytest.approx(half)
        assert side_length(pattern, seam.b) == pytest.approx(half)
    for seam in pattern.seams:
        assert side_length(pattern, seam.a) == pytest.approx(side_length(pattern, seam.b), abs=0.5)


@pytest.mark.parametrize("body", BODIES)
def test_one_pleat_shows_as_far_from_the_next_across_the_side_seams_too(body: str) -> None:
    panel = drafted("pleated-skirt", body).panels["front"]
    flat = np.sort([fold.points_mm[0, 0] for fold in panel.folds if fold.angle_deg < 0.0])
    seen = flat - 100.0 * np.arange(len(flat))
    shown = (measurements(body)["hip"] + 50.0) / 12.0
    assert len(flat) == 6
    assert np.diff(seen) == pytest.approx(np.full(5, shown))
    half = 6.0 * shown
    assert (half - seen[-1]) + seen[0] == pytest.approx(shown)


@pytest.mark.parametrize("body", BODIES)
def test_the_doctor_finds_a_missing_zip_and_nothing_else(body: str) -> None:
    assert {finding.code for finding in examine(shipped_file("patterns", "pleated-skirt"), body)} <= {"closure-missing"}
