"""Body measurements of GarmentCode become mannequins that measure so."""

from __future__ import annotations

from pathlib import Path

import pytest

from garmentcad.errors import MannequinError
from garmentcad.io.garmentcode_body import mannequin_of_body, write_body
from garmentcad.io.mannequin_file import read_mannequin

# The neutral body of GarmentCode (assets/bodies/mean_all, github.com/maria-korosteleva/GarmentCode): facts, cm and degrees.
MEAN = {
    "arm_length": 53.9697, "arm_pose_angle": 45.483, "armscye_depth": 12.8679, "back_width": 47.6761, "bum_points": 18.2342, "bust": 99.8407,
    "bust_line": 25.6947, "bust_points": 16.9463, "crotch_hip_diff": 8.81363, "head_l": 26.3262, "height": 171.99, "hip_back_width": 54.8237,
    "hip_inclination": 9.86489, "hips": 103.478, "hips_line": 23.4837, "leg_circ": 60.2039, "neck_w": 18.9328, "shoulder_incl": 21.6777,
    "shoulder_w": 36.4568, "underbust": 86.2455, "vert_bust_line": 21.1388, "waist": 84.3338, "waist_back_width": 39.1358, "waist_line": 36.8913,
    "waist_over_bust_line": 40.5603, "wrist": 16.5945,
}  # fmt: skip


def test_the_shipped_body_is_the_one_that_garmentcode_drafts_for(tmp_path: Path) -> None:
    made = mannequin_of_body({"body": MEAN})
    (tmp_path / "body_measurements.yaml").write_text("body:\n" + "".join(f"  {name}: {value}\n" for name, value in MEAN.items()))
    shipped, read = read_mannequin("garmentcode-mean"), read_mannequin(tmp_path / "body_measurements.yaml")
    for name, value in shipped.measurements_mm.items():
        assert read.measurements_mm[name] == pytest.approx(value, abs=0.2)
    assert made["arm_angle"] == pytest.approx(90.0 - 45.483)
    wanted_mm = {"bust": 998.4, "waist": 843.3, "hip": 1034.8, "waist_height": 1087.7, "hip_height": 852.9, "crotch_height": 764.7, "thigh": 602.0}
    for name, wanted in wanted_mm.items():
        assert shipped.measurements_mm[name] == pytest.approx(wanted, abs=0.3)
    assert shipped.measurements_mm["stature"] == pytest.approx(1719.9, abs=2)
    shoulders = shipped.landmarks["shoulder_point_left"][0] - shipped.landmarks["shoulder_point_right"][0]
    assert 1000 * shoulders == pytest.approx(364.6, abs=15)


def test_what_is_written_reads_alike(tmp_path: Path) -> None:
    body = tmp_path / "body_measurements.yaml"
    body.write_text("body:\n" + "".join(f"  {name}: {value}\n" for name, value in MEAN.items()))
    written = read_mannequin(write_body(body, tmp_path / "made.yaml"))
    assert written.measurements_mm == read_mannequin(body).measurements_mm


def test_few_measurements_and_derived_ones(tmp_path: Path) -> None:
    few = {name: MEAN[name] for name in ("bust", "waist", "hips", "height", "head_l", "waist_line")} | {"_waist_level": 108.77}
    made = mannequin_of_body({"body": few})
    assert made["kind"] == "woman"
    assert set(made["measurements"]) == {"bust", "waist", "hip", "stature", "nape_to_waist", "waist_to_floor"}
    assert mannequin_of_body({"body": few | {"bust": 110.0}})["kind"] == "man"


@pytest.mark.parametrize(
    ("change", "key", "says"),
    [
        ({"bust": "wide"}, "body.bust", "not a number"),
        ({"waste": 80}, "body.waste", "did you mean 'waist'"),
        ({"bust": None}, "body.bust", "None is not a number"),
        ({"bust": 998.4}, "measurements.bust", "are the values in mm"),
        ({"arm_length": 99.0}, "measurements.arm_length", "does not go with stature"),
        ({"arm_pose_angle": 0.0}, "arm_angle", "allowed: 25 to 60"),
    ],
)
def test_refused(change: dict[str, object], key: str, says: str, tmp_path: Path) -> None:
    path = tmp_path / "body_measurements.yaml"
    path.write_text("body:\n" + "".join(f"  {name}: {'null' if value is None else value}\n" for name, value in (MEAN | change).items()))
    with pytest.raises(MannequinError) as caught:
        read_mannequin(path)
    assert (caught.value.file, caught.value.key) == (str(path), key)
    assert says in str(caught.value)


def test_missing(tmp_path: Path) -> None:
    with pytest.raises(MannequinError, match="waist, hips, head_l, waist_line"):
        mannequin_of_body({"body": {"bust": 99.0, "height": 170.0}})


def test_what_stands_beside_the_body_is_refused() -> None:
    with pytest.raises(MannequinError, match="'pose' is not a key of GarmentCode's measurements; allowed: body"):
        mannequin_of_body({"body": MEAN, "pose": {"arm": 45}})
