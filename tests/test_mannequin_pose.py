"""Posing: angles, arm lengths, sections of leaning legs, and poses that are refused."""

import numpy as np
import pytest

from garmentcad.errors import MannequinError
from garmentcad.io.mannequin_file import read_human
from garmentcad.mannequin import pose
from garmentcad.mannequin.grade import standing_body
from garmentcad.mannequin.sizes import full_sizes
from garmentcad.mannequin.stand import wanted_heights
from garmentcad.mannequin.tapes import taped


@pytest.fixture(scope="module")
def standing():
    model = read_human("woman")
    sizes = full_sizes("woman", {"bust": 880})
    return model, standing_body(model, sizes), wanted_heights("woman", sizes)


def test_arm_turns_rigidly_below_the_shoulder(standing):
    model, body, _ = standing
    turned = pose.pose_arms(model, body, 30)
    rigid = model.arm_weight > 1 - 1e-9
    assert rigid.sum() > 300
    for joint in ("elbow", "wrist"):
        before = np.linalg.norm(body.points[rigid] - body.joints[joint], axis=1)
        after = np.linalg.norm(turned.points[rigid] - turned.joints[joint], axis=1)
        np.testing.assert_allclose(after, before, atol=1e-12)
    still = model.arm_weight == 0
    np.testing.assert_allclose(turned.points[still], body.points[still], atol=1e-15)


def test_arm_length_is_as_asked(standing):
    model, body, _ = standing
    longer = pose.stretch_arms(model, body, 0.60)
    tip, elbow, wrist = body.points[model.landmarks["shoulder_point"]], longer.joints["elbow"], longer.joints["wrist"]
    assert np.linalg.norm(elbow - tip) + np.linalg.norm(wrist - elbow) == pytest.approx(0.60, abs=1e-9)


def test_leaning_legs_keep_their_girths_and_come_together(standing):
    model, body, heights = standing
    closer = pose.pose_legs(model, body)
    assert taped("thigh", model, closer, heights).girth == pytest.approx(taped("thigh", model, body, heights).girth, rel=1e-4)
    assert closer.joints["ankle"][0] < body.joints["ankle"][0]
    np.testing.assert_array_equal(closer.points[:, 1:], body.points[:, 1:])


@pytest.mark.parametrize("angle", [24.9, 61, -45, float("nan")])
def test_angles_out_of_range_are_refused(standing, angle):
    model, body, _ = standing
    with pytest.raises(MannequinError, match="25 to 60"):
        pose.pose_arms(model, body, angle)
