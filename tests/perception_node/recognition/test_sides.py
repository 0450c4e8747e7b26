"""The features of the sides of a visible box, and the box of the complete thing."""

from dataclasses import replace

import numpy as np
import pytest

from semmap.nodes.perception_node.recognition.perceptron import Perceptron
from semmap.nodes.perception_node.recognition.sides import SIZE_FEATURES, completed, shifts, side_features
from semmap.nodes.perception_node.views.boxes import Box
from tests.perception_node.recognition.test_features import block

BLOCK = block(((0.0, 0.0, 0.0), (0.2, 0.1, 0.1)))
THING = replace(BLOCK, box=Box(np.zeros(3), np.array([0.2, 0.1, 0.1]), 0.0))
SCALE_M = 0.15
"""The mean of the level sides of the box."""
EXPECTED_M = np.array([0.3, 0.15, 0.075])


def mover(*shares):
    """Return a regressor that moves the five sides by shares of the scale: -x, +x, -y, +y, top."""
    return Perceptron(np.zeros(5), np.ones(5), (np.array(shares)[:, None],), (np.zeros(1),))


def one_side_each():
    return np.eye(5)


def features(thing=THING):
    return side_features(thing, EXPECTED_M)


def test_a_side_that_faces_the_camera_is_told_from_one_that_faces_away():
    least_x, most_x, least_y, most_y, top = features()
    assert most_x[:2] == pytest.approx((0.998, -0.998), abs=0.01)
    assert least_x[:2] == pytest.approx((-0.998, 0.998), abs=0.01)
    assert most_y[0] == pytest.approx(-least_y[0])
    assert least_y[0] == pytest.approx(0.055, abs=0.01)
    assert top[:2] == pytest.approx((0.998, 0.0), abs=0.01)


def test_cameras_on_both_sides_face_both_sides():
    both = replace(THING, eyes=np.array([[1.0, 0.05, 1.0], [-1.0, 0.05, 1.0]]))
    found = features(both)
    assert found[0, :2] == pytest.approx((1.0, 1.0), abs=0.01)
    assert found[1, :2] == pytest.approx((1.0, 1.0), abs=0.01)
    assert found[:, 14] == pytest.approx(1.0)


def test_the_extent_along_a_side_comes_before_the_one_across():
    found = features()
    assert found[0, 2:4] == pytest.approx((0.2 / SCALE_M, 0.1 / SCALE_M))
    assert found[2, 2:4] == pytest.approx((0.1 / SCALE_M, 0.2 / SCALE_M))
    assert found[4, 2:4] == pytest.approx((0.2 / SCALE_M, 0.1 / SCALE_M))


def test_all_sides_share_what_is_known_of_the_thing():
    common = features()[:, 12:]
    assert common == pytest.approx(np.tile(common[0], (5, 1)))
    to_eye = np.array([0.9, -0.05, 0.95])
    distance = np.linalg.norm(to_eye)
    lifted = THING.lifted_m / SCALE_M
    assert common[0, :7] == pytest.approx(
        (to_eye[2] / distance, distance, 0.0, np.log(SCALE_M), 0.1 / SCALE_M, lifted, 0.0)
    )
    assert common[:, SIZE_FEATURES] == pytest.approx(np.tile(np.log(EXPECTED_M / SCALE_M), (5, 1)))


def test_a_thing_that_the_edge_of_an_image_cuts_is_marked():
    cut = replace(THING, segments=(replace(THING.segments[0], cut=True),))
    assert features(cut)[0, 18] == 1.0
    assert features(THING)[0, 18] == 0.0


def test_the_ends_of_a_side_tell_how_full_and_how_high_the_thing_is_there():
    low_end = THING.cells[(THING.cells[:, 0] < 0.02) & (THING.cells[:, 2] < 0.05)]
    rest = THING.cells[(THING.cells[:, 0] > 0.1) & (THING.cells[:, 1] < 0.05)]
    found = features(replace(THING, cells=np.concatenate([low_end, rest])))
    near, far = found[0, 4:8], found[0, 8:12]
    assert near[0] == pytest.approx(len(low_end) / (len(low_end) + len(rest)))
    assert near[1] == pytest.approx(0.96, abs=0.05)
    assert far[1] == pytest.approx(0.48, abs=0.05)
    assert near[3] == pytest.approx(0.24, abs=0.05)
    assert far[3] == pytest.approx(0.48, abs=0.05)
    assert found[1, 4:12] == pytest.approx(np.concatenate([far, near]))


def test_an_end_without_points_is_empty_and_as_high_as_the_box():
    found = features(replace(THING, cells=np.array([[0.1, 0.05, 0.05]])))
    assert found[:4, 4:12] == pytest.approx(np.tile([0.0, 0.0, 1.0, 1.0], (4, 2)))
    assert found[4, 4:8] == pytest.approx((0.0, 0.0, 1.0, 1.0))


def test_each_side_moves_outwards_by_its_share_of_the_scale():
    found = completed(THING, one_side_each(), mover(0.1, 0.2, 0.3, 0.4, 0.5))
    assert found.low == pytest.approx((-0.1 * SCALE_M, -0.3 * SCALE_M, 0.0))
    assert found.high == pytest.approx((0.2 + 0.2 * SCALE_M, 0.1 + 0.4 * SCALE_M, 0.1 + 0.5 * SCALE_M))
    assert found.yaw_rad == THING.box.yaw_rad


def test_a_box_never_turns_inside_out_and_keeps_standing():
    found = completed(THING, one_side_each(), mover(-2.0, -2.0, -2.0, -2.0, -2.0))
    assert found.size_m == pytest.approx((0.002, 0.002, 0.002))
    assert (found.low + found.high)[:2] / 2 == pytest.approx((0.1, 0.05))
    assert found.low[2] == 0.0


def test_the_shifts_of_a_known_box_lead_to_it():
    truth = Box(np.array([-0.03, -0.02, 0.0]), np.array([0.25, 0.11, 0.3]), 0.0)
    assert shifts(THING, truth) == pytest.approx(np.array([0.03, 0.05, 0.02, 0.01, 0.2]) / SCALE_M)
    found = completed(THING, one_side_each(), mover(*shifts(THING, truth)))
    assert (found.low, found.high) == (pytest.approx(truth.low), pytest.approx(truth.high))


def test_a_tiny_thing_is_scaled_as_if_it_were_two_centimetres_wide():
    speck = replace(THING, box=Box(np.zeros(3), np.array([0.004, 0.004, 0.01]), 0.0))
    moved = completed(speck, one_side_each(), mover(1.0, 0.0, 0.0, 0.0, 0.0))
    assert moved.low[0] == pytest.approx(-0.02)
