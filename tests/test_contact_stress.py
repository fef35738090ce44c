"""The stress set of contact on coarse lattices: every frame clean, no step that passes anything; and that its judges see what is wrong."""

from __future__ import annotations

import numpy as np
import pytest

from tools.stress_study import SCENES, Judge, judged, needle, ten_sheets

GRID_MM = 40.0
GRIDS_MM = {"ten sheets on a ball": 50.0, "sleeve through itself": 30.0}  # a sleeve of fewer columns jams in itself
SECONDS = {"sleeve through itself": 0.8, "into a funnel": 0.7}  # less than the whole scene
WATCHED_STEPS = 20
FRAME_S = 0.03


@pytest.mark.parametrize("name", SCENES)
def test_scene_stays_clean(name: str) -> None:
    scene = SCENES[name](GRIDS_MM.get(name, GRID_MM))
    row = judged(scene._replace(seconds=SECONDS.get(name, scene.seconds)), WATCHED_STEPS, FRAME_S)
    assert row["status"] == "done"
    assert (row["intersecting_frames"], row["crossings"]) == (0, 0)
    assert row["depth_mm"] in (0.0, None)
    assert (row["watched_steps"], row["watched_passed"]) == (WATCHED_STEPS, 0)
    assert row["cut_steps"] < 0.01 * row["steps"]


def test_judges_see_cloth_in_the_body() -> None:
    scene = needle(GRID_MM)
    judge, inside = Judge(scene), scene.positions - [0.0, 0.05, 0.0]
    assert not judge.intersects(scene.positions)
    assert (judge.crossings(scene.positions), judge.depth_mm(scene.positions)) == (0, 0.0)
    assert judge.intersects(inside)
    assert judge.crossings(inside) > 0
    assert judge.passes(scene.positions, inside)
    assert not judge.passes(scene.positions, scene.positions - [0.0, 0.01, 0.0])
    # One particle on the axis, 20 mm below the tip: as deep as the cone is wide there, but for its slope.
    deep = scene.positions.copy()
    deep[0] = [0.0, 0.18, 0.0]
    assert judge.depth_mm(deep) == pytest.approx(1.2 * np.cos(np.pi / 12), rel=0.01)


def test_judges_see_a_sheet_that_passes_another_one() -> None:
    """Before and after all is well; on the way the lowest sheet goes through all others."""
    scene = ten_sheets(GRID_MM)
    judge, after = Judge(scene), scene.positions.copy()
    after[scene.cloth.vertex_particle[scene.cloth.vertex_panel == 0]] += [0.0, 0.05, 0.0]
    assert not judge.intersects(after)
    assert judge.crossings(after) == 0
    assert judge.passes(scene.positions, after)
    assert not judge.passes(after, after - [0.0, 1e-3, 0.0])
