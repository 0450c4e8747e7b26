"""Perceptrons, compared with values computed by hand."""

from dataclasses import FrozenInstanceError

import numpy as np
import pytest

from semmap.nodes.perception_node.recognition.perceptron import REACH, Perceptron, log_softmax

PLAIN = Perceptron(
    mean=np.array([1.0, 2.0]),
    scale=np.array([2.0, 0.5]),
    weights=(np.array([[1.0, -1.0], [0.5, 2.0]]), np.array([[2.0], [3.0]])),
    biases=(np.array([0.25, -0.5]), np.array([10.0])),
)


def test_inputs_are_standardised_rectified_between_layers_and_linear_at_the_end():
    # (3, 3) -> (1, 2) -> (1 + 1 + .25, -1 + 4 - .5) = (2.25, 2.5) -> 4.5 + 7.5 + 10
    assert PLAIN(np.array([[3.0, 3.0]])) == pytest.approx(np.array([[22.0]]))
    # (3, 2) -> (1, 0) -> (1.25, -1.5 -> 0) -> 2.5 + 10
    assert PLAIN(np.array([[3.0, 2.0]])) == pytest.approx(np.array([[12.5]]))


def test_the_end_may_be_negative():
    one = Perceptron(np.zeros(1), np.ones(1), (np.array([[-2.0]]),), (np.array([0.5]),))
    assert one(np.array([[3.0], [-1.0]])) == pytest.approx(np.array([[-5.5], [2.5]]))


def test_inputs_far_from_their_mean_are_taken_for_less_far():
    one = Perceptron(np.zeros(1), np.ones(1), (np.array([[1.0]]),), (np.zeros(1),))
    assert one(np.array([[100.0], [-100.0], [5.0]])) == pytest.approx(np.array([[REACH], [-REACH], [5.0]]))
    with pytest.raises(FrozenInstanceError):
        one.mean = np.ones(1)


def test_logarithms_of_probabilities_add_up_to_one_however_large_the_scores():
    scores = np.array([[1.0, 2.0, 3.0], [1000.0, 1000.0, -1000.0]])
    found = log_softmax(scores)
    assert np.exp(found).sum(axis=1) == pytest.approx(1.0)
    assert found[0, 2] - found[0, 0] == pytest.approx(2.0)
    assert np.exp(found[1]) == pytest.approx((0.5, 0.5, 0.0))
