"""Poses: rigid limbs, level feet on the floor, parts that stay apart, and independent judges on every frame."""

import igl
import numpy as np
import pytest

from garmentcad.contact.path import BodyPath
from garmentcad.errors import GarmentError, InputError, MannequinError
from garmentcad.io.mannequin_file import read_mannequin
from garmentcad.io.pose_file import read_poses
from garmentcad.mannequin.gap import check_apart, check_uncrossed, facings
from garmentcad.mannequin.motion import KeyFrame, Pose, motion, posed
from tools.body_study import crosses_itself

BODIES = ("woman-88", "man-116")


def lengths(points, rows):
    return np.linalg.norm(points[rows][:, None] - points[rows][None, ::7], axis=2)


@pytest.mark.parametrize("name", BODIES)
def test_limbs_turn_rigidly_by_the_angle_asked_for(name):
    body = read_mannequin(name)
    points = posed(body, Pose(arm_left=25, hip_left=40, knee_left=60))
    level = {part: body.landmarks[f"{part}_left"][1] for part in ("knee", "ankle")}
    leg, height = body.rig.leg[:, 0] > 1 - 1e-6, body.vertices[:, 1]
    shank = np.flatnonzero(leg & (height < level["knee"] - 0.11) & (height > level["ankle"] + 0.05))
    foot = np.flatnonzero(leg & (height < level["ankle"] - 0.045))
    forearm = np.flatnonzero((body.rig.arm > 1 - 1e-9) & (body.vertices[:, 0] > 0))
    for rows, about, angle in ((shank, 0, 60 - 40), (foot, 0, 0), (forearm, 2, 25 - 45)):
        assert len(rows) > 30
        np.testing.assert_allclose(lengths(points, rows), lengths(body.vertices, rows), atol=1e-6)
        a, b = [axis for axis in range(3) if axis != about]
        before, after = (body_points[rows][:, [a, b]] - body_points[rows][:, [a, b]].mean(0) for body_points in (body.vertices, points))
        turn = np.degrees(np.arctan2((before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]).sum(), (before * after).sum()))
        assert turn == pytest.approx(angle, abs=1e-3)
    right = (body.vertices[:, 0] < -0.05) & (body.rig.leg[:, 0] == 0)
    np.testing.assert_allclose(np.ptp((points - body.vertices)[right], axis=0), 0, atol=1e-12)  # only the floor moves the other side


@pytest.mark.parametrize("name", BODIES)
def test_body_stands_on_the_floor_turns_and_walks(name):
    body = read_mannequin(name)
    down = posed(body, Pose(hip_left=50, hip_right=50, knee_left=75, knee_right=75))
    assert down[:, 1].min() == pytest.approx(0, abs=1e-12)
    np.testing.assert_allclose(down[body.vertices[:, 1] < 0.01], body.vertices[body.vertices[:, 1] < 0.01], atol=2e-3)  # the feet stay where they are
    assert down[:, 1].max() < body.vertices[:, 1].max() - 0.12
    np.testing.assert_allclose(posed(body, Pose()), body.vertices, atol=1e-15)
    quarter = posed(body, Pose(turn=90, ahead_mm=200))
    np.testing.assert_allclose(quarter[:, 0], body.vertices[:, 2], atol=1e-12)  # the front looks to +x, the wearer's left
    np.testing.assert_allclose(quarter[:, 2], 0.2 - body.vertices[:, 0], atol=1e-12)


MOTIONS = [("woman-88", "arms-down"), ("man-116", "squat"), ("woman-116", "step")]


@pytest.mark.parametrize(("name", "poses"), MOTIONS)
def test_shipped_motions_are_clean(name, poses):
    body = read_mannequin(name)
    times, frames = motion(body, read_poses(poses))
    np.testing.assert_array_equal(frames[0], body.vertices)
    assert np.diff(times).min() > 0
    assert np.linalg.norm(np.diff(frames, axis=0), axis=2).max() < 0.10
    assert not any(crosses_itself(frame, body.faces) for frame in frames[3::6])


@pytest.mark.parametrize(("span", "turn"), [(1.0, 360.0), (0.6, -360.0), (0.3, 120.0), (0.2, 45.0)])
def test_a_body_keeps_its_shape_while_it_turns_and_begins_and_ends_gently(span: float, turn: float) -> None:
    """A rigid turn by the angle of the smooth step, between the frames too: no vertex leaves its circle by more than a thousandth."""
    body = read_mannequin("woman-88")
    path = BodyPath(*motion(body, [KeyFrame(span, Pose(turn=turn))]))
    radius = np.hypot(body.vertices[:, 0], body.vertices[:, 2])
    for share in np.linspace(0.0, 1.0, 43):
        points = path.at(share * span)
        assert np.abs(np.hypot(points[:, 0], points[:, 2]) - radius).max() < 1e-3 * radius.max()
        wanted = posed(body, Pose(turn=turn * share * share * (3.0 - 2.0 * share)))
        assert np.linalg.norm(points - wanted, axis=1).max() < 0.01 * np.radians(abs(turn)) * radius.max()
    way = radius.max() * np.radians(abs(turn))
    for at in (0.0, span):
        assert np.linalg.norm(path.at(min(span, at + 1e-4)) - path.at(max(0.0, at - 1e-4)), axis=1).max() / 1e-4 < 0.1 * way / span


def test_a_turn_that_makes_a_hand_too_fast_is_refused() -> None:
    body = read_mannequin("woman-88")
    radius = np.hypot(body.vertices[:, 0], body.vertices[:, 2]).max()
    fastest = 1.5 * 2.0 * np.pi * radius / 0.3  # half-way
    assert fastest > 10.0
    with pytest.raises(InputError, match=r"the body goes 1\d\.\d+ m/s between"):
        BodyPath(*motion(body, [KeyFrame(0.3, Pose(turn=360.0))]))


def test_distance_between_parts_is_that_of_libigl():
    body = read_mannequin("woman-88")
    points = posed(body, Pose(arm_left=20, arm_right=20))
    pairs = {pair.name: pair for pair in facings(body)}
    for name in ("arm_left and torso", "arm_right and legs", "leg_left and leg_right"):
        pair = pairs[name]
        found = igl.point_mesh_squared_distance(points[np.unique(pair.one)], points, pair.other.astype(np.int64))[0].min()
        other = igl.point_mesh_squared_distance(points[np.unique(pair.other)], points, pair.one.astype(np.int64))[0].min()
        least = 1000 * np.sqrt(min(found, other))
        moved = points.copy()
        moved[np.unique(pair.one), 2] += 1.0  # far away: nothing to say
        check_apart([pair], moved, "x")
        if least > 8:
            check_apart([pair], points, "x")
        else:
            with pytest.raises(MannequinError, match=f"{name} come within {least:.1f} mm"):
                check_apart([pair], points, "x")


def test_motions_in_which_parts_meet_are_refused_by_name_and_time():
    body, lowered = read_mannequin("woman-116"), Pose(arm_left=15, arm_right=45)
    with pytest.raises(MannequinError, match=r"after 0.[0-9]+ s .*arm_left and torso"):
        motion(body, [KeyFrame(0.2, lowered)])
    points = posed(body, lowered)
    assert crosses_itself(points, body.faces)
    with pytest.raises(MannequinError, match="arm_left and torso come within"):
        check_apart(facings(body), points, "x")
    with pytest.raises(MannequinError, match=r"crosses itself .arm_left and torso"):
        check_uncrossed(body, points, "x")


BAD = {
    "schema": ("schema: 2\nframes: [{time: 1}]\n", "schema: 1"),
    "schema of a truth": ("schema: true\nframes: [{time: 1}]\n", "schema: 1"),
    "no frames": ("schema: 1\n", "frames"),
    "empty": ("schema: 1\nframes: []\n", "1 to 200"),
    "key": ("schema: 1\nframe: []\nframes: [{time: 1}]\n", "did you mean 'frames'"),
    "part": ("schema: 1\nframes: [{time: 1, arm: 20}]\n", "did you mean 'arms'"),
    "text": ("schema: 1\nframes: [{time: 1, arms: up}]\n", "frames.0.arms"),
    "range": ("schema: 1\nframes: [{time: 1, knees: 120}]\n", "0 to 90"),
    "range of both": ("schema: 1\nframes: [{time: 1, hips: 150}]\n", "frames.0.hips: 150 came; a number from -30 to 70 degrees is allowed"),
    "range of the way": ("schema: 1\nframes: [{time: 1, ahead: 3000}]\n", "frames.0.ahead: 3000 came; a number from -2000 to 2000 mm is allowed"),
    "list of angles": ("schema: 1\nframes: [{time: 1, hips: [10, 20]}]\n", r"frames.0.hips: \[10, 20\] came; a number from -30 to 70 degrees is allowed"),
    "time in words": ("schema: 1\nframes: [{time: now}]\n", "frames.0.time: 'now' came; more than 0 and at most 60 s"),
    "joint twice": ("schema: 1\nframes: [{time: 1, hip_left: 20, hips: 10}]\n", "frames.0.hips: hip_left is given by `hip_left`, too"),
    "no time": ("schema: 1\nframes: [{arms: 20}]\n", "time"),
    "order": ("schema: 1\nframes: [{time: 2}, {time: 1}]\n", "not after"),
    "long": ("schema: 1\nframes: [{time: 1000}]\n", "at most 60"),
    "list": ("- 1\n", "mapping"),
}  # fmt: skip


@pytest.mark.parametrize("name", BAD)
def test_bad_pose_files_are_refused_with_file_and_reason(tmp_path, name):
    text, reason = BAD[name]
    path = tmp_path / "poses.yaml"
    path.write_text(text)
    with pytest.raises(GarmentError, match=reason) as caught:
        read_poses(path)
    assert caught.value.file == str(path)


def test_what_a_frame_leaves_out_stays(tmp_path):
    path = tmp_path / "poses.yaml"
    path.write_text("schema: 1\nframes: [{time: 1, hips: 30}, {time: 2, knee_left: 10}, {time: 3, hip_left: 0}]\n")
    poses = [frame.pose for frame in read_poses(path)]
    assert (poses[2].hip_left, poses[2].hip_right, poses[2].knee_left, poses[2].arm_left) == (0, 30, 10, None)
