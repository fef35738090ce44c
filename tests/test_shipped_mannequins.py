"""The shipped mannequins, and bodies near them, against independent tapes and checkers."""

import functools

import igl
import numpy as np
import pytest
import trimesh

from garmentcad.export.obj import write_mannequin_obj
from garmentcad.io.mannequin_file import mannequin_names, read_human, read_mannequin
from garmentcad.mannequin.make import make_mannequin
from garmentcad.mannequin.sizes import full_sizes
from tools.body_study import TAPED, asymmetry_mm, closed, crosses_itself, girth_mm, judged, taped_mm

CASES = [("woman", 800, 45), ("woman", 880, 45), ("woman", 880, 25), ("woman", 1040, 45), ("woman", 1160, 45),
         ("man", 920, 45), ("man", 1000, 45), ("man", 1000, 25), ("man", 1160, 45)]  # fmt: skip
SIZES = {
    "woman-80": (800, 640, 880, 1680), "woman-88": (880, 720, 960, 1680), "woman-104": (1040, 880, 1120, 1680), "woman-116": (1160, 1000, 1220, 1680),
    "man-92": (920, 800, 940, 1780), "man-100": (1000, 880, 1020, 1780), "man-116": (1160, 1040, 1180, 1780),
}  # fmt: skip
NEEDED = """
    bust waist hip stature neck_base back_width chest_front shoulder armscye_depth nape_to_waist waist_to_hip waist_to_knee waist_to_floor top_arm wrist
    arm_length thigh nape_height neck_front_height shoulder_height bust_height waist_height hip_height crotch_height knee_height
"""
LANDMARKS = {"nape", "neck_front", "crotch"} | {
    f"{name}_{side}" for name in ("neck_side", "shoulder_point", "bust_point", "elbow", "wrist", "knee", "ankle", "armpit") for side in ("left", "right")
} | {f"{name}_{side}" for name in ("waist", "hip") for side in ("front", "back", "left", "right")}  # fmt: skip


@functools.lru_cache
def body(kind, bust, angle):
    return make_mannequin(read_human(kind), {"bust": bust}, name=f"{kind}-{bust}", arm_angle_deg=angle)


@pytest.fixture(params=CASES, ids=lambda case: "-".join(map(str, case)))
def made(request):
    return body(*request.param)


@pytest.mark.parametrize("name", SIZES)
def test_shipped_body_has_the_measurements_of_its_name(name, tmp_path):
    mannequin = read_mannequin(name)
    found = taped_mm(write_mannequin_obj(tmp_path / "body.obj", mannequin), mannequin)
    for girth, wanted in zip(("bust", "waist", "hip", "stature"), SIZES[name]):
        assert found[girth] == pytest.approx(wanted, abs=0.5)
        assert mannequin.measurements_mm[girth] == pytest.approx(wanted, abs=0.5)
    assert mannequin.vertices[:, 1].min() == 0.0


def test_sizes_that_are_shipped():
    women, men = (76, 80, 84, 88, 92, 96, 100, 104, 110, 116, 122), range(84, 121, 4)
    assert mannequin_names() == ["garmentcode-mean"] + [f"man-{size}" for size in men] + [f"woman-{size}" for size in women]


def test_women_stand_145_cm_from_floor_to_nape():
    measured = read_mannequin("woman-88").measurements_mm
    assert measured["nape_to_waist"] + measured["waist_to_floor"] == pytest.approx(1450, abs=2)
    assert measured["nape_height"] == pytest.approx(1450, abs=2)


def test_every_girth_by_an_independent_tape(made, tmp_path):
    found = taped_mm(write_mannequin_obj(tmp_path / "body.obj", made), made)
    kind, bust = made.name.split("-")
    asked = full_sizes(kind, {"bust": int(bust)})
    for name in TAPED:
        assert found[name] == pytest.approx(asked[name], abs=0.5), name
        assert found[name] == pytest.approx(made.measurements_mm[name], abs=0.5), name


ODD = {"pear": ("woman", {"bust": 860, "waist": 650, "hip": 1060, "stature": 1550}), "straight": ("woman", {"bust": 900, "waist": 860, "hip": 920}),
       "between": ("woman", {"bust": 1075}), "athlete": ("man", {"bust": 1100, "waist": 820, "hip": 980, "stature": 1900})}  # fmt: skip


@pytest.mark.parametrize("name", ODD)
def test_measurements_of_no_table_are_reached(name):
    kind, given = ODD[name]
    row = judged(make_mannequin(read_human(kind), given, name=name), full_sizes(kind, given))
    assert row["worst"] < 0.5
    assert row["closed"]
    assert not row["crosses"]
    assert row["asymmetry"] < 0.1


def test_surface_is_closed_and_turned_outward(made):
    assert closed(made.vertices, made.faces)
    assert 0.03 < trimesh.Trimesh(made.vertices, made.faces, process=False).volume < 0.13


def test_surface_does_not_cross_itself(made):
    assert not crosses_itself(made.vertices, made.faces)


def test_intersection_check_sees_a_crossing():
    mannequin = body("woman", 880, 45)
    vertices, faces = np.array(mannequin.vertices), np.array(mannequin.faces)
    vertices[np.argmin(np.abs(vertices - mannequin.landmarks["waist_front"]).sum(1)), 2] -= 0.4
    assert crosses_itself(vertices, faces)


def test_left_and_right_are_mirror_images(made):
    assert asymmetry_mm(made.vertices, made.faces) < 0.1
    for name, point in made.landmarks.items():
        if name.endswith("_left"):
            np.testing.assert_allclose(made.landmarks[name[:-4] + "right"] * [-1, 1, 1], point, atol=1e-4)


def test_parts_stay_apart(made):
    def rows(part):
        return np.unique(made.faces[made.face_part == made.part_names.index(part)])

    def distance(points, *parts):
        chosen = np.isin(made.face_part, [made.part_names.index(part) for part in parts])
        return np.sqrt(igl.point_mesh_squared_distance(points, np.array(made.vertices), made.faces[chosen].astype(np.int64))[0])

    arm, torso = rows("arm_left"), rows("torso")
    rim = made.vertices[np.intersect1d(arm, torso)]
    free = np.array([point for point in made.vertices[arm] if np.linalg.norm(rim - point, axis=1).min() > 0.060])
    near_joint = [np.linalg.norm(rim - point, axis=1).min() <= 0.060 for point in made.vertices]
    trunk = (made.face_part == made.part_names.index("torso")) & ~np.array(near_joint)[made.faces].any(1)
    others = np.sqrt(igl.point_mesh_squared_distance(free, np.array(made.vertices), made.faces[trunk].astype(np.int64))[0])
    assert others.min() > 0.008
    assert distance(free, "leg_left", "leg_right").min() > 0.008
    leg = made.vertices[rows("leg_left")]
    low = leg[leg[:, 1] < made.landmarks["crotch"][1] - 0.060]
    assert distance(low, "leg_right").min() > 0.008


def test_arms_hang_at_the_angle_asked_for():
    for angle in (25, 45):
        marks = body("woman", 880, angle).landmarks
        axis = body("woman", 880, angle).cylinders["arm_left"].up
        assert np.degrees(np.arctan2(-axis[0], axis[1])) == pytest.approx(angle, abs=0.01)
        assert marks["wrist_left"][0] > marks["elbow_left"][0] > marks["shoulder_point_left"][0]


def test_triangles_of_the_body_are_even(made):
    torso = made.faces[np.isin(made.face_part, [made.part_names.index(part) for part in ("torso", "arm_left", "leg_left")])]
    corners = made.vertices[torso]
    edges = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2)
    area = 0.5 * np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    quality = 4 * np.sqrt(3) * area / (edges**2).sum(1)  # 1 is equilateral
    assert np.percentile(edges, 1) > 0.006
    assert edges.max() < 0.047 * made.measurements_mm["hip"] / 1000  # one mesh for all sizes: triangles grow with the body
    assert np.percentile(quality, 1) > 0.45
    assert np.median(quality) > 0.9


def test_nothing_is_sharp_where_garments_touch(made):
    chosen = np.isin(made.face_part, [made.part_names.index(part) for part in ("torso", "arm_left", "arm_right", "leg_left", "leg_right")])
    mesh = trimesh.Trimesh(made.vertices, made.faces[chosen], process=False)
    middle = mesh.vertices[mesh.face_adjacency_edges].mean(1)
    hand = np.abs(middle[:, 0]) > abs(made.landmarks["wrist_left"][0])
    foot = middle[:, 1] < made.landmarks["ankle_left"][1]
    crotch = np.linalg.norm(middle - made.landmarks["crotch"], axis=1) < 0.08
    convex = mesh.face_adjacency_convex & ~(hand | foot | crotch)
    assert np.degrees(mesh.face_adjacency_angles[convex]).max() < 50


def test_all_names_are_there(made):
    assert set(NEEDED.split()) <= set(made.measurements_mm)
    assert all(np.isfinite(value) and value > 0 for value in made.measurements_mm.values())
    assert set(made.landmarks) >= LANDMARKS
    assert set(made.cylinders) >= {"torso", "arm_left", "arm_right", "leg_left", "leg_right", "neck"}
    assert made.part_names == ("torso", "arm_left", "arm_right", "leg_left", "leg_right", "head")
    assert set(np.unique(made.face_part)) == set(range(6))
    assert made.estimated == ("back_width", "chest_front")


def test_heights_and_lengths_agree(made):
    values = made.measurements_mm
    assert values["waist_height"] - values["hip_height"] == pytest.approx(values["waist_to_hip"])
    assert values["waist_height"] - values["knee_height"] == pytest.approx(values["waist_to_knee"])
    assert values["crotch_height"] < values["hip_height"] < values["waist_height"] < values["bust_height"] < values["nape_height"] < values["stature"]
    assert values["bust_height"] < 1000 * made.landmarks["armpit_left"][1] < values["shoulder_height"] < values["nape_height"]
    assert values["arm_length"] == pytest.approx(full_sizes(made.name.split("-")[0], {"bust": values["bust"]})["arm_length"], abs=1)


def test_wearer_faces_z_with_left_on_x(made):
    marks = made.landmarks
    assert marks["bust_point_left"][2] > marks["nape"][2] + 0.1
    assert marks["waist_left"][0] > 0 > marks["waist_right"][0]
    foot = made.vertices[made.vertices[:, 1] < 0.03]
    assert foot[:, 2].max() > marks["ankle_left"][2] + 0.08


def test_cylinders_enclose_their_parts(made):
    marks = made.landmarks
    for part in ("torso", "arm_left", "arm_right", "leg_left", "leg_right"):
        cylinder = made.cylinders[part]
        assert np.linalg.norm(cylinder.up) == pytest.approx(1)
        assert cylinder.up @ cylinder.ref == pytest.approx(0, abs=1e-12)
        points = made.vertices[np.unique(made.faces[made.face_part == made.part_names.index(part)])]
        heights = (points - cylinder.origin) @ cylinder.up
        if part == "torso":
            span = (heights > marks["hip_left"][1]) & (heights < marks["shoulder_point_left"][1])
        elif part.startswith("leg"):
            span = heights > marks["ankle_left"][1]
        else:
            length = np.linalg.norm(marks["wrist_left"] - made.cylinders["arm_left"].origin)
            span = (heights < -0.05) & (heights > -length)
        offset = (points - cylinder.origin)[span]
        a, b = offset @ cylinder.ref / cylinder.radius_ref, offset @ np.cross(cylinder.up, cylinder.ref) / cylinder.radius_side
        assert np.hypot(a, b).max() <= 1 + 1e-9
        assert np.hypot(a, b).max() > 0.99  # and no wider than needed


def test_waist_is_the_narrowest_place(made):
    waist = made.measurements_mm["waist_height"] / 1000
    torso = made.faces[made.face_part == made.part_names.index("torso")]
    girths = [girth_mm(made.vertices, torso, [0, waist + step, 0], [0, 1, 0]) for step in np.arange(-0.06, 0.061, 0.02)]
    assert min(girths) > made.measurements_mm["waist"] - 12


def test_same_measurements_give_the_same_bits():
    one, two = (make_mannequin(read_human("woman"), {"bust": 880}, name="x") for _ in range(2))
    assert one.vertices.tobytes() == two.vertices.tobytes()
