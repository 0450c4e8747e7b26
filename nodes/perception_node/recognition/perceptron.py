"""Multilayer perceptrons, evaluated: what is learnt is a few matrices."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from semmap.nodes.perception_node.views.boxes import Numbers

REACH = 6.0
"""Inputs farther from their mean than so many deviations are taken for that far."""


@dataclass(frozen=True)
class Perceptron:
    """Standardised inputs, layers of rectified sums, a linear end.

    `mean`, `scale`: (D,) of the inputs. `weights`: one (inputs, outputs) a layer, `biases`: (outputs,).
    """

    mean: Numbers
    scale: Numbers
    weights: tuple[Numbers, ...]
    biases: tuple[Numbers, ...]

    def __call__(self, inputs: Numbers) -> Numbers:
        """(N, outputs) of inputs (N, D)."""
        values = np.clip((inputs - self.mean) / self.scale, -REACH, REACH)
        for weight, bias in zip(self.weights[:-1], self.biases[:-1], strict=True):
            values = np.maximum(values @ weight + bias, 0.0)
        return np.asarray(values @ self.weights[-1] + self.biases[-1])


def log_softmax(scores: Numbers) -> Numbers:
    """(N, K) logarithms of probabilities from scores (N, K)."""
    shifted = scores - scores.max(axis=1, keepdims=True)
    return np.asarray(shifted - np.log(np.exp(shifted).sum(axis=1, keepdims=True)))
