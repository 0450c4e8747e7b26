"""Multilayer perceptrons, evaluation only."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from semmap.nodes.perception_node.views.boxes import Numbers

REACH = 6.0
"""Standardised inputs are clipped to this many standard deviations."""


@dataclass(frozen=True)
class Perceptron:
    """Standardised inputs, ReLU layers, and a linear output layer.

    `mean`, `scale`: (D,) of the inputs. `weights`: one (inputs, outputs) per layer, `biases`: (outputs,).
    """

    mean: Numbers
    scale: Numbers
    weights: tuple[Numbers, ...]
    biases: tuple[Numbers, ...]

    def __call__(self, inputs: Numbers) -> Numbers:
        """Return outputs (N, outputs) for inputs (N, D)."""
        values = np.clip((inputs - self.mean) / self.scale, -REACH, REACH)
        for weight, bias in zip(self.weights[:-1], self.biases[:-1], strict=True):
            values = np.maximum(values @ weight + bias, 0.0)
        return np.asarray(values @ self.weights[-1] + self.biases[-1])


def log_softmax(scores: Numbers) -> Numbers:
    """Return (N, K) log probabilities for scores (N, K)."""
    shifted = scores - scores.max(axis=1, keepdims=True)
    return np.asarray(shifted - np.log(np.exp(shifted).sum(axis=1, keepdims=True)))
