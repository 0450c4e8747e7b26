"""Features that indicate an unknown class."""

import math

import numpy as np
import pytest

from semmap.nodes.perception_node.recognition.open_set import OpenSetDetector, open_set_features

SPACE = OpenSetDetector(
    mean=np.array([1.0, 0.0, 0.0]),
    axes=np.array([[1.0, 0.0], [0.0, 2.0], [0.0, 0.0]]),
    centres=np.array([[0.0, 0.0], [3.0, 4.0]]),
    weights=np.array([1.0, 0.0, 0.0, 0.0, 0.0, 2.0, -3.0]),
)
FEATURES = [np.array([[4.0, 0.0]]), np.array([[7.0]])]
POOLED = np.log(np.array([[0.25, 0.75]]))
VOTES = np.log(np.array([[[0.5, 0.5]], [[1.0 - 1e-9, 1e-9]]]))


def test_they_are_doubt_disagreement_and_distance():
    (found,) = open_set_features(SPACE, FEATURES, VOTES, POOLED)
    entropy = -(0.25 * math.log(0.25) + 0.75 * math.log(0.75))
    # (3, 0) in the space: 3 from the first centre, 4 from the second, which is the likelier
    expected = [math.log(0.75), entropy, math.log(0.5), -10.0, math.log(3.0), math.log(4.0)]
    assert found == pytest.approx(expected)


def test_a_regression_makes_a_probability_of_them():
    (chance,) = SPACE(FEATURES, VOTES, POOLED)
    assert chance == pytest.approx(1.0 / (1.0 + math.exp(-(math.log(0.75) + 2.0 * math.log(4.0) - 3.0))))


def test_what_is_farther_off_is_likelier_new():
    features = [np.array([[1.5, 0.0], [40.0, 0.0]]), np.zeros((2, 1))]
    near, far = SPACE(features, np.repeat(VOTES, 2, axis=1), np.repeat(POOLED, 2, axis=0))
    assert near < far
