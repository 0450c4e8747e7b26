"""Perceptrons, trained by scikit-learn."""

from __future__ import annotations

import warnings

import numpy as np
from numpy.typing import NDArray
from sklearn.exceptions import ConvergenceWarning
from sklearn.neural_network import MLPClassifier, MLPRegressor

from nodes.perception_node.recognition.perceptron import REACH, Perceptron

Numbers = NDArray[np.float64]
_ROUNDS = 40
_NEVER_SEEN = -12.0


def classifier(
    inputs: Numbers,
    target: NDArray[np.int64],
    classes: int,
    hidden: tuple[int, ...],
    *,
    seed: int = 0,
    rounds: int = _ROUNDS,
) -> Perceptron:
    """Scores (N, classes) from inputs (N, D); a class that `target` (N,) never names gets a very low one."""
    machine = MLPClassifier(
        hidden_layer_sizes=hidden,
        alpha=0.3,
        batch_size=256,
        learning_rate_init=2e-3,
        max_iter=rounds,
        tol=0.0,
        random_state=seed,
    )
    fitted = _fit(machine, inputs, target)
    weights, biases = np.zeros((hidden[-1], classes)), np.full(classes, _NEVER_SEEN)
    weights[:, machine.classes_], biases[machine.classes_] = fitted.weights[-1], fitted.biases[-1]
    return Perceptron(
        fitted.mean, fitted.scale, (*fitted.weights[:-1], weights), (*fitted.biases[:-1], biases)
    )


def regressor(inputs: Numbers, target: Numbers, hidden: tuple[int, ...]) -> Perceptron:
    """One number for each of inputs (N, D)."""
    machine = MLPRegressor(
        hidden_layer_sizes=hidden, batch_size=512, max_iter=_ROUNDS, tol=0.0, random_state=0
    )
    return _fit(machine, inputs, target)


def _fit(machine: MLPClassifier | MLPRegressor, inputs: Numbers, target: NDArray[np.generic]) -> Perceptron:
    mean, scale = inputs.mean(axis=0), inputs.std(axis=0) + 1e-6
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ConvergenceWarning)  # the number of rounds is what is wanted
        machine.fit(np.clip((inputs - mean) / scale, -REACH, REACH), target)
    return Perceptron(mean, scale, tuple(machine.coefs_), tuple(machine.intercepts_))
