"""Baselines: tolerances that cover one more lay as often as they say; files that come back equal; what is refused."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from hand_made import flat, rectangles

from garmentcad.errors import FileError, InputError
from garmentcad.regression.baseline import FEWEST_LAYS, Baseline, Shape, distance_figure, factor, figure, read_baseline, read_shape, write_baseline

SETTING = {"garment": "band", "fabric": "denim", "mannequin": "woman-88", "grid_mm": "20"}
KEYS = ["hem.nodes", "hem_height_mm", "shape"]


@pytest.mark.parametrize(("lays", "more"), [(4, 1), (10, 1), (25, 1), (10, 4)])
def test_more_lays_lie_within(lays: int, more: int) -> None:
    """Counted on 200,000 made-up garments whose figures are normal: 1 % of the next lays, or of their means, lie outside, whatever the number of lays."""
    rng = np.random.default_rng(lays)
    before, following = rng.standard_normal((200_000, lays)), rng.standard_normal((200_000, more)).mean(axis=1)
    outside = np.abs(following - before.mean(axis=1)) > factor(lays, more, 0.99) * before.std(axis=1, ddof=1)
    assert outside.mean() == pytest.approx(0.01, abs=4.0 * np.sqrt(0.01 * 0.99 / 200_000))


def test_figures() -> None:
    made = figure([612.0, 613.0, 611.0, 612.0])
    assert made.value == 612.0
    assert made.sd == pytest.approx(np.sqrt(2.0 / 3.0), rel=0.01)
    assert made.tol == pytest.approx(factor(4) * np.sqrt(2.0 / 3.0), rel=0.01)
    assert (made.low, made.high) == (611.0, 613.0)
    assert factor(10, confidence=0.999) == pytest.approx(4.781 * np.sqrt(1.1), abs=1e-3)  # printed tables: t of 9 degrees of freedom, 0.05 % on each side
    assert factor(10) == pytest.approx(6.30, abs=0.01)
    assert figure([612.0, 613.0, 611.0, 612.0], 4).tol == pytest.approx(made.tol * np.sqrt((1 / 4 + 1 / 4) / (1 + 1 / 4)), rel=0.01)
    assert factor(FEWEST_LAYS) < 3.0 * factor(10**6) < factor(FEWEST_LAYS - 1)
    # lays that agree: a node more or less, a thousandth of a length
    assert figure([8, 8, 8]).tol == 1.0
    assert figure([612.0, 612.0, 612.0]).tol == pytest.approx(0.612)
    far = distance_figure([2.0, 3.0, 4.0])
    assert (far.value, far.tol) == (3.0, pytest.approx(factor(3), rel=0.01))


def made(rms: bool = True) -> Baseline:
    far = distance_figure([2.0, 3.0, 4.0]) if rms else None
    report = {"hem_height_mm": figure([612.0, 613.0, 611.0] * 2), "hem.nodes": figure([8, 9, 8] * 2)}
    keys = KEYS if rms else KEYS[:2]
    return Baseline(version="0.1.0", rule="r", lays=6, refused=1, setting=SETTING, keys=keys, report=report, rms_mm=far, max_mm=far)


def test_files_come_back_equal(tmp_path: Path) -> None:
    cloth = rectangles(4, 3, 0.02, 2, sewn=True)
    positions = np.random.default_rng(1).standard_normal((cloth.particle_count, 3))
    path = tmp_path / "band.baseline.json"
    files = write_baseline(path, made(), Shape(positions, cloth.triangles, cloth.vertex_particle))
    assert [file.name for file in files] == ["band.baseline.json", "band.baseline.npz"]
    assert read_baseline(path, SETTING, KEYS) == made()
    shape = read_shape(path)
    np.testing.assert_allclose(shape.positions, positions, atol=3e-7)
    np.testing.assert_array_equal(shape.particle_triangles, cloth.particle_triangles)
    write_baseline(path, made(rms=False), shape)
    assert read_baseline(path, SETTING, KEYS[:2]).distances() == {}


def test_a_baseline_of_another_test_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "band.baseline.json"
    with pytest.raises(FileError, match="--remake"):
        read_baseline(path, SETTING, KEYS)
    cloth = rectangles(2, 2, 0.02, 1, sewn=False)
    write_baseline(path, made(), Shape(flat(cloth), cloth.triangles, cloth.vertex_particle))
    with pytest.raises(InputError, match=r"grid_mm: '20' there, '10' here.*--remake"):
        read_baseline(path, SETTING | {"grid_mm": "10"}, KEYS)
    with pytest.raises(InputError, match=r"keys: .*ease_mm.waist"):
        read_baseline(path, SETTING, [*KEYS, "ease_mm.waist"])


@pytest.mark.parametrize(("lost", "named"), [("report", "hem.nodes, hem_height_mm"), ("rms_mm", "shape"), ("max_mm", "shape")])
def test_one_that_lacks_the_figures_of_its_keys_is_refused(tmp_path: Path, lost: str, named: str) -> None:
    path = tmp_path / "band.baseline.json"
    cloth = rectangles(2, 2, 0.02, 1, sewn=False)
    whole = json.loads(write_baseline(path, made(), Shape(flat(cloth), cloth.triangles, cloth.vertex_particle))[0].read_text())
    path.write_text(json.dumps(whole | {"report": {}} if lost == "report" else {key: value for key, value in whole.items() if key != lost}))
    with pytest.raises(InputError, match=f"there is no figure of {named}; .*--remake"):
        read_baseline(path, SETTING, KEYS)


def test_a_key_that_stands_for_many_has_one_figure_at_least(tmp_path: Path) -> None:
    path = tmp_path / "band.baseline.json"
    cloth = rectangles(2, 2, 0.02, 1, sewn=False)
    shape = Shape(flat(cloth), cloth.triangles, cloth.vertex_particle)
    many = made(rms=False).model_copy(update={"keys": ["seam_tension.*.max_n_m"], "report": {"seam_tension.side.max_n_m": figure([1.0, 2.0, 3.0])}})
    write_baseline(path, many, shape)
    assert read_baseline(path, SETTING, many.keys) == many
    write_baseline(path, many.model_copy(update={"report": {"seam_tension.side.mean_n_m": figure([1.0, 2.0, 3.0])}}), shape)
    with pytest.raises(InputError, match="no figure of seam_tension"):
        read_baseline(path, SETTING, many.keys)


def test_torn_and_foreign_files_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "band.baseline.json"
    cloth = rectangles(2, 2, 0.02, 1, sewn=False)
    write_baseline(path, made(), Shape(flat(cloth), cloth.triangles, cloth.vertex_particle))
    whole = path.read_text()
    data = json.loads(whole)
    texts = [
        "",
        "[]",
        whole[:-40],
        json.dumps(data | {"lays": 5}),
        json.dumps(data | {"more": 1}),
        whole.replace("612.0", "NaN"),
        whole.replace("612.0", ".nan"),
    ]
    for text in texts:
        path.write_text(text)
        with pytest.raises(InputError, match=r"band\.baseline\.json") as fault:
            read_baseline(path, SETTING, KEYS)
        assert "YAML" not in str(fault.value)
    beside = tmp_path / "band.baseline.npz"
    arrays = {"positions": flat(cloth), "triangles": cloth.triangles, "vertex_particle": cloth.vertex_particle}
    faults = (
        {"positions": flat(cloth)[:, :2]}, {"positions": flat(cloth) * np.nan}, {"triangles": cloth.triangles + 7}, {"triangles": cloth.triangles - 7},
        {"triangles": cloth.triangles[:0]}, {"vertex_particle": cloth.vertex_particle + 7}, {"positions": np.array(["x"])},
    )  # fmt: skip
    for change in faults:
        np.savez(beside, **(arrays | change))
        with pytest.raises(FileError, match=r"band\.baseline\.npz"):
            read_shape(path)
    beside.write_bytes(beside.read_bytes()[:100])
    with pytest.raises(FileError, match=r"band\.baseline\.npz"):
        read_shape(path)
    beside.unlink()
    with pytest.raises(FileError, match=r"the shape that belongs to band\.baseline\.json is missing; .* --remake"):
        read_shape(path)
