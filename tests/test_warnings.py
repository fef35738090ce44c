"""Warnings of a report: seams pulled beyond their strength, and garments that fall."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from garmentcad.analysis.seam_tension import SeamTension
from garmentcad.cloth.state import State
from garmentcad.io.mannequin_file import read_mannequin
from garmentcad.simulation.job import make_job
from garmentcad.simulation.record import _fallen, _of_sheets, _torn


@pytest.mark.parametrize(("strength", "told"), [(None, []), (90.0, []), (80.0, ["seam 'side_left' is pulled by up to 85 N/m; it holds 80 N/m"])])
def test_a_seam_that_is_pulled_beyond_its_strength_is_told(strength: float | None, told: list[str]) -> None:
    pattern = make_job("straight-skirt").pattern
    seams = tuple(replace(seam, strength_n_m=strength) if seam.name == "side_left" else seam for seam in pattern.seams)
    tensions = {seam.name: SeamTension(400.0, 20.0, 85.0, 3.0) for seam in seams}
    assert _torn(replace(pattern, seams=seams), tensions) == told


def test_a_garment_below_the_floor_has_fallen() -> None:
    def told(lowest: float, **run: float) -> list[str]:
        positions = np.array([[0.0, lowest, 0.0], [0.0, 1.0, 0.0]])
        return _fallen(State(positions, np.zeros_like(positions), run=run), read_mannequin("woman-88"))

    assert told(-0.3) == []
    assert told(-6.653) == ["the garment fell off: it hangs down to 6653 mm below the floor"]
    assert told(-0.3, fell=1.0) == ["the garment fell off: all of it is below the body, and the run ended there"]


def test_what_a_sheet_lacks_is_told_by_its_own_name() -> None:
    replaced = _of_sheets(make_job("knit-top", fabric="stretch-twill"))
    assert replaced
    assert all(warning.startswith("stretch-twill: ") for warning in replaced)
    assert not any("warning" in warning for warning in replaced), "they stand among the warnings of the report"
    names = {warning.partition(": ")[0] for warning in _of_sheets(make_job("tucked-in"))}
    assert names == {"interlock-knit"}, "a garment of an outfit knows its fabrics by their files"
