"""The message with the points of a frame for viewers."""

import numpy as np
import pytest

from semmap.nodes.perception_node.input.cloud import Cloud
from semmap.nodes.perception_node.pipeline import FrameResult
from semmap.nodes.perception_node.segmented_cloud import MOST_POINTS, segmented_cloud
from semmap.schemas.perception import Observations

POINTS = np.array([[[0, 0, 1], [1, 0, 2]], [[0, 1, np.nan], [1, 1, 3]]], np.float32)
LABELS = np.array([[0, 1], [2, 3]], np.int32)
COLORS = np.arange(12, dtype=np.uint8).reshape(2, 2, 3)
LIFTED = np.array([[1.0, 0, 0, 10], [0, 1, 0, 20], [0, 0, 1, 30], [0, 0, 0, 1]])


def message(*clouds, labels=None):
    labels = labels or (LABELS,) * len(clouds)
    seen = Observations(stamp_ns=7, observations=(), views=())
    return segmented_cloud(clouds, FrameResult(seen, labels))


def positions(made):
    return np.frombuffer(made.positions, "<f4").reshape(-1, 3)


def colors(made):
    return np.frombuffer(made.colors, np.uint8).reshape(-1, 3)


def labels(made):
    return np.frombuffer(made.labels, "<u2")


def test_each_measured_point_has_its_colour_and_observation():
    made = message(Cloud(POINTS, COLORS, np.eye(4)))
    assert made.stamp_ns == 7
    assert positions(made).tolist() == [[0, 0, 1], [1, 0, 2], [1, 1, 3]]
    assert colors(made).tolist() == [[0, 1, 2], [3, 4, 5], [9, 10, 11]]
    assert labels(made).tolist() == [0, 1, 3]


def test_points_are_in_the_map_frame_and_those_of_an_unknown_pose_in_the_cameras():
    made = message(Cloud(POINTS, COLORS, LIFTED), Cloud(POINTS, COLORS))
    assert positions(made)[0] == pytest.approx((10, 20, 31))
    assert positions(made)[3] == pytest.approx((0, 0, 1))
    assert labels(made).tolist() == [0, 1, 3] * 2


def test_points_without_a_colour_are_grey():
    assert colors(message(Cloud(POINTS, None, np.eye(4)))).tolist() == [[128, 128, 128]] * 3


@pytest.mark.parametrize(
    ("points", "sent"), [(MOST_POINTS, MOST_POINTS), (MOST_POINTS + 1, MOST_POINTS // 2 + 1)]
)
def test_large_clouds_are_thinned_evenly(points, sent):
    row = np.ones((1, points, 3), np.float32)
    row[0, :, 0] = np.arange(points)
    own = np.arange(points, dtype=np.int32)[None] % 1000
    made = message(Cloud(row, None, np.eye(4)), labels=(own,))
    found = positions(made)
    assert len(found) == sent
    assert labels(made).tolist() == (found[:, 0].astype(int) % 1000).tolist()
