"""Descending a gradient."""

from __future__ import annotations

import numpy as np
import pytest

from semmap.nodes.training.recognition.fitting import classifier, regressor
from semmap.nodes.training.recognition.gradient_descent import Recipe, descend

RNG = np.random.default_rng(3)
POINTS = RNG.uniform(-1, 1, (1024, 2))
QUADRANT = (POINTS[:, 0] * POINTS[:, 1] > 0).astype(np.int64)
SMALL = Recipe((24,), rounds=60, batch=64, rate=1e-2)


def square(target):
    return lambda scores, rows: (scores - target[rows]).astype(np.float32)


@pytest.mark.parametrize(
    "recipe",
    [
        pytest.param(SMALL, id="plain"),
        pytest.param(Recipe((48, 24), 60, (0.05, 0.1), 64, 1e-2), id="deep, with all that is left to chance"),
    ],
)
def test_classes_that_are_not_linearly_separable_are_learnt(recipe):
    told = classifier(POINTS, QUADRANT, 2, recipe)(POINTS).argmax(axis=1)
    assert (told == QUADRANT).mean() > 0.95


def test_the_same_comes_out_again_and_another_seed_gives_another():
    once, again = (classifier(POINTS, QUADRANT, 2, SMALL, seed=1) for _ in range(2))
    other = classifier(POINTS, QUADRANT, 2, SMALL, seed=2)
    assert all((a == b).all() for a, b in zip(once.weights, again.weights, strict=True))
    assert not (once.weights[0] == other.weights[0]).all()


def test_a_class_that_is_never_named_is_never_likely():
    scores = classifier(POINTS, 2 * QUADRANT, 3, SMALL)(POINTS)
    assert (scores[:, 1] < scores.max(axis=1) - 5).all()


def test_a_number_is_predicted():
    bent = np.abs(POINTS).sum(axis=1)
    told = regressor(POINTS, bent, SMALL)(POINTS)[:, 0]
    assert np.abs(told - bent).mean() < 0.05


def test_more_rounds_come_closer_and_fewer_rows_than_a_batch_are_one_batch():
    inputs = POINTS[:64].astype(np.float32)
    target = np.column_stack([inputs.sum(axis=1), inputs[:, 0] ** 2]).astype(np.float32)

    def loss(rounds):
        layers = descend(inputs, 2, square(target), Recipe((16,), rounds), seed=0)
        hidden = np.maximum(inputs @ layers.weights[0] + layers.biases[0], 0)
        return float(((hidden @ layers.weights[1] + layers.biases[1] - target) ** 2).mean())

    assert loss(1) > loss(30) > loss(300)
