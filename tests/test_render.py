"""Pictures: right size, garment where it should be, and the parts that need no Pillow checked on their own."""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hand_made import cylinder_body, rectangles, tube

from garmentcad.errors import InputError
from garmentcad.export.camera import frame
from garmentcad.export.color_map import painted, round_up
from garmentcad.export.legend import ticks
from garmentcad.export.picture import ViewMissing, render_picture
from garmentcad.export.raster import NOTHING, blank, draw_lines, draw_triangles
from garmentcad.export.seam_lines import seam_and_free_edges
from garmentcad.export.sky_light import SkyLight


def dress():
    cloth = rectangles(20, 20, 0.02, 2, sewn=True)
    return cloth, tube(cloth, 20, 2, lambda row, angle: np.full_like(angle, 0.13), lambda row: 0.7 + 0.02 * row)


def warm(pixels: np.ndarray) -> np.ndarray:
    """Pixels of fabric: clearly redder than blue; body and background are grey."""
    return pixels[..., 0].astype(int) - pixels[..., 2] > 40


def test_picture_shows_the_garment_on_the_body(tmp_path: Path) -> None:
    image = pytest.importorskip("PIL.Image")
    cloth, positions = dress()
    path = render_picture(tmp_path / "front.png", positions, cloth, cylinder_body(0.10), "front", height_px=300)
    pixels = np.asarray(image.open(path))
    assert pixels.shape[0] == 300
    assert pixels.shape[2] == 3
    rows, columns = np.nonzero(warm(pixels))
    # 0.4 m of garment with 22 % of body above and below: the middle 69 % of the height
    assert 0.13 < rows.min() / 300 < 0.21
    assert 0.79 < rows.max() / 300 < 0.87
    middle = pixels.shape[1] / 2
    assert abs(0.5 * (columns.min() + columns.max()) - middle) < 3.0
    assert warm(pixels)[120:180, int(middle) - 30 : int(middle) + 30].mean() > 0.9
    top = pixels[5, int(middle)].astype(int)
    assert np.ptp(top) < 15  # the grey body stands out above the garment
    assert top.max() < 222  # and is darker than the background
    # light from the left: the left flank is brighter than the right one
    width = columns.max() - columns.min()
    bright = pixels[150, columns.min() + width // 6].sum(), pixels[150, columns.max() - width // 6].sum()
    assert bright[0] > bright[1]


def test_layers_keep_their_colors_up_to_the_seam_that_joins_them(tmp_path: Path) -> None:
    """Two panels of 20 mm cells, some 30 pixels wide here, of which one is an outer layer: between their colors lies the line of the seam, and no cell."""
    image = pytest.importorskip("PIL.Image")
    cloth, positions = dress()
    cloth = replace(cloth, panel_layer=np.array([0, 1], dtype=np.int32))
    pixels = np.asarray(image.open(render_picture(tmp_path / "front.png", positions, cloth, None, height_px=600))).astype(int)
    for row in pixels[280:320, :, 0] - pixels[280:320, :, 2]:  # red over blue
        outer, inner = np.flatnonzero(row < -35), np.flatnonzero(row > 60)
        assert min(len(outer), len(inner)) > 100
        assert 0 < inner.min() - outer.max() < 5


def test_wrong_side_is_lit_from_the_same_lamp(tmp_path: Path) -> None:
    """The garment mirrored turns its wrong side out: its color is duller, and the left flank is still the bright one."""
    image = pytest.importorskip("PIL.Image")
    cloth, positions = dress()
    inside_out = positions * [-1.0, 1.0, 1.0]
    found = [np.asarray(image.open(render_picture(tmp_path / "a.png", where, cloth, None, height_px=200))).astype(int) for where in (positions, inside_out)]
    assert found[1][warm(found[1])].mean() < found[0][warm(found[0])].mean() - 5
    columns = np.nonzero(warm(found[1]).sum(axis=0) > 60)[0]
    width = columns.max() - columns.min()
    assert found[1][100, columns.min() + width // 6].sum() > found[1][100, columns.max() - width // 6].sum()


def test_map_colors_follow_the_value(tmp_path: Path) -> None:
    image = pytest.importorskip("PIL.Image")
    cloth, positions = dress()
    strain = np.where(positions[:, 1] > 0.9, 0.04, 0.0)
    path = render_picture(tmp_path / "map.png", positions, cloth, None, "three-quarter", "strain", strain, height_px=300)
    pixels = np.asarray(image.open(path)).astype(int)
    center = (pixels.shape[1] + round(0.16 * 300)) // 2
    upper, lower = pixels[80, center - 20 : center + 20].mean(axis=0), pixels[220, center - 20 : center + 20].mean(axis=0)
    assert lower.min() > 150  # nothing happens: light
    assert upper.sum() < 0.6 * lower.sum()  # much: dark and reddish
    assert upper[0] > upper[1] + 25


def test_seams_and_hems_are_told_apart() -> None:
    cloth, _ = dress()
    seams, free = seam_and_free_edges(cloth)
    assert len(seams) == 2 * 20
    assert len(free) == 2 * 40
    flat_seams, flat_free = seam_and_free_edges(rectangles(3, 2, 0.01, 2, sewn=False))
    assert (len(flat_seams), len(flat_free)) == (0, 20)


@pytest.mark.parametrize(("view", "axis", "sign"), [("front", 2, 1), ("back", 2, -1), ("left", 0, 1), ("right", 0, -1)])
def test_camera_stands_where_the_view_says(view: str, axis: int, sign: int) -> None:
    _, positions = dress()
    camera = frame(view, positions, None, 400)
    direction = camera.position - camera.focus
    assert direction[axis] * sign == np.abs(direction).max()
    assert camera.focus == pytest.approx([0.0, 0.9, 0.0], abs=0.02)


def test_room_for_the_legend_is_on_the_left() -> None:
    _, positions = dress()
    plain, roomy = frame("front", positions, None, 400), frame("front", positions, None, 400, left_px=100)
    assert roomy.width == plain.width + 100
    metres_a_pixel = 2.0 * np.linalg.norm(plain.position - plain.focus) * np.tan(np.radians(plain.view_angle_deg / 2)) / 400
    assert plain.focus[0] - roomy.focus[0] == pytest.approx(50 * metres_a_pixel, rel=0.1)


def test_unknown_view_and_map_are_refused(tmp_path: Path) -> None:
    cloth, positions = dress()
    with pytest.raises(InputError, match=r"top.*front, back"):
        render_picture(tmp_path / "a.png", positions, cloth, None, "top")
    with pytest.raises(InputError, match=r"blocks.*strain, .*tension, pressure"):
        painted("blocks", np.zeros(3))


def test_without_the_extra_the_message_says_what_to_install(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "PIL.Image", None)
    cloth, positions = dress()
    with pytest.raises(ViewMissing, match=r"pip install garmentcad\[view\]"):
        render_picture(tmp_path / "a.png", positions, cloth, None)
    assert not list(tmp_path.iterdir())


def test_legend_ends_at_round_numbers() -> None:
    assert [round_up(value) for value in (0.0, -1.0, 1.0, 1.01, 2.4, 8.1, 0.031, 470.0)] == [1.0, 1.0, 1.0, 1.5, 3.0, 10.0, 0.04, 500.0]
    found = painted("strain", np.array([0.0, 0.01, 0.018]))
    assert (found.low, found.high) == (0.0, 2.0)
    assert found.colors()[0] == pytest.approx(found.kind.colors[0])


def test_legend_has_round_numbers() -> None:
    assert ticks(0.0, 8.0) == [0.0, 2.0, 4.0, 6.0, 8.0]
    assert ticks(0.0, 1.5) == [0.0, 0.5, 1.0, 1.5]
    assert ticks(0.0, 0.03) == pytest.approx([0.0, 0.01, 0.02, 0.03])
    assert ticks(0.0, 73.0) == [0.0, 20.0, 40.0, 60.0]


def test_scale_is_as_long_as_it_says(tmp_path: Path) -> None:
    """The dark line at the foot of the legend says 50 mm: in pixels against the tube, which is 260 mm wide."""
    image = pytest.importorskip("PIL.Image")
    cloth, positions = dress()
    path = render_picture(tmp_path / "map.png", positions, cloth, None, "front", "warp", np.zeros(cloth.particle_count), height_px=600)
    pixels = np.asarray(image.open(path)).astype(int)
    scale = np.flatnonzero((pixels[round(600 - 1.6 * 600 / 64), :96] < 120).all(axis=1))
    tube_columns = 96 + np.flatnonzero(pixels[300, 96:, 0] - pixels[300, 96:, 2] > 8)
    assert np.ptp(scale) / np.ptp(tube_columns) == pytest.approx(50.0 / 260.0, rel=0.03)


def test_the_nearer_triangle_owns_a_pixel() -> None:
    nearness, owner = blank(4, 6)
    points = np.array([[0.0, 0.0, 1.0], [6.0, 0.0, 1.0], [0.0, 4.0, 1.0], [0.0, 0.0, 2.0], [3.0, 0.0, 2.0], [0.0, 4.0, 0.0]])
    triangles = np.array([[0, 1, 2], [3, 4, 5]], dtype=np.int32)
    draw_triangles(points, triangles, 7, nearness, owner)
    assert owner[0].tolist() == [8, 8, 8, 7, 7, NOTHING]  # the second is nearer here
    assert owner[2, 0] == 7  # and farther here
    assert owner[3, 1:].tolist() == [NOTHING] * 5
    assert nearness[0, 4] == 1.0
    draw_lines(points, np.array([[1, 2]], dtype=np.int32), 0.6, 0.01, 9, nearness, owner)
    assert owner[0, 5] == 9  # a rod is as thick as it is drawn
    assert (owner[0, :3] == 8).all()


def test_a_roof_holds_off_the_sky_above() -> None:
    """A point under the middle of a wide roof gets light only from below; one on top of it gets all of it."""
    roof = np.array([[-1.0, 1.0, -1.0], [-1.0, 1.0, 1.0], [1.0, 1.0, 1.0], [1.0, 1.0, -1.0]])
    triangles = np.array([[0, 1, 2], [0, 2, 3]], dtype=np.int32)
    light = SkyLight(roof, triangles).on(np.array([[0.0, 0.9, 0.0], [0.0, 1.0, 0.0]]), np.tile([0.0, 1.0, 0.0], (2, 1)))
    seen = light.seen(np.array([[0, 0, 0], [1, 1, 1]]), np.array([0.0, 0.0, 1.0]))
    assert seen[1] == 1.0
    assert seen[0] < 0.05
