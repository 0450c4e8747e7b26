"""Perceptrons for classification and regression."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from semmap.nodes.perception_node.recognition.perceptron import REACH, Perceptron
from semmap.nodes.training.recognition.gradient_descent import Floats, Recipe, Slope, descend

Numbers = NDArray[np.float64]
_NEVER_SEEN = -12.0


def classifier(
    inputs: Numbers, target: NDArray[np.int64], classes: int, recipe: Recipe, *, seed: int = 0
) -> Perceptron:
    """Train scores (N, classes) from inputs (N, D); classes without samples get very low scores."""

    def slope(scores: Floats, rows: NDArray[np.int64]) -> Floats:
        likely = np.exp(scores - scores.max(axis=1, keepdims=True))
        likely /= likely.sum(axis=1, keepdims=True)
        likely[np.arange(len(rows)), target[rows]] -= 1.0
        return np.asarray(likely)

    fitted = _fitted(inputs, classes, slope, recipe, seed)
    never = ~np.isin(np.arange(classes), target)
    fitted.weights[-1][:, never], fitted.biases[-1][never] = 0.0, _NEVER_SEEN
    return fitted


def regressor(inputs: Numbers, target: Numbers, recipe: Recipe) -> Perceptron:
    """Train the regression of one number from inputs (N, D)."""

    def slope(scores: Floats, rows: NDArray[np.int64]) -> Floats:
        return np.asarray(scores - target[rows, None], np.float32)

    return _fitted(inputs, 1, slope, recipe, seed=0)


def _fitted(inputs: Numbers, outputs: int, slope: Slope, recipe: Recipe, seed: int) -> Perceptron:
    mean, scale = inputs.mean(axis=0), inputs.std(axis=0) + 1e-6
    standard = np.clip((inputs - mean) / scale, -REACH, REACH).astype(np.float32)
    layers = descend(standard, outputs, slope, recipe, seed)
    return Perceptron(
        mean,
        scale,
        tuple(weights.astype(float) for weights in layers.weights),
        tuple(biases.astype(float) for biases in layers.biases),
    )
