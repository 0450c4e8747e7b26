"""Training of perceptrons by stochastic gradient descent in single precision; reproducible.

Steps are Adam's (Kingma and Ba, 2015), weights decay by themselves (Loshchilov and Hutter, 2019), and the
rate rises and then falls along a cosine. Inputs and hidden units are left out by lot (Srivastava and others,
2014): what depends on few of them does not carry over to things of another make.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float32]
Slope = Callable[[Floats, NDArray[np.int64]], Floats]
"""Returns the gradient of the loss by the scores (B, outputs) of rows (B,)."""

_MEAN, _SQUARE = np.float32(0.1), np.float32(0.001)
_RISING = 0.03  # of the steps
_TINY = np.float32(1e-8)


@dataclass(frozen=True)
class Recipe:
    """Training parameters of a perceptron. `dropped`: dropout rates of inputs and hidden units."""

    hidden: tuple[int, ...]
    rounds: int = 16
    dropped: tuple[float, float] = (0.0, 0.0)
    batch: int = 256
    rate: float = 2e-3
    decay: float = 1e-2


@dataclass
class Layers:
    """Return an (inputs, outputs) array of weights and an (outputs,) array of biases per layer."""

    weights: list[Floats]
    biases: list[Floats]


def descend(inputs: Floats, outputs: int, slope: Slope, recipe: Recipe, seed: int) -> Layers:
    """Train layers from standardised inputs (N, D) to `outputs` outputs."""
    rng = np.random.default_rng(seed)
    layers = _beginning((inputs.shape[1], *recipe.hidden, outputs), rng)
    values = [*layers.weights, *layers.biases]
    decays = [recipe.decay] * len(layers.weights) + [0.0] * len(layers.biases)
    means, squares = ([np.zeros_like(value) for value in values] for _ in range(2))
    recipe = replace(recipe, batch=min(recipe.batch, len(inputs)))
    steps = recipe.rounds * (len(inputs) // recipe.batch)
    for step, rows in enumerate(_batches(len(inputs), recipe, rng), 1):
        rate = _rate(step / steps) * recipe.rate
        slopes = _slopes(layers, inputs[rows], rows, slope, recipe, rng)
        bias, square_bias = 1.0 - 0.9**step, np.float32(1.0 - 0.999**step)
        for value, by, decay, mean, square in zip(values, slopes, decays, means, squares, strict=True):
            mean += _MEAN * (by - mean)
            square += _SQUARE * (by * by - square)
            value -= np.float32(rate * decay) * value
            value -= np.float32(rate / bias) * mean / (np.sqrt(square / square_bias) + _TINY)
    return layers


def _beginning(sizes: tuple[int, ...], rng: np.random.Generator) -> Layers:
    shapes = list(pairwise(sizes))
    return Layers(
        [rng.standard_normal(s, np.float32) * np.float32(math.sqrt(2.0 / s[0])) for s in shapes],
        [np.zeros(s[1], np.float32) for s in shapes],
    )


def _batches(rows: int, recipe: Recipe, rng: np.random.Generator) -> Iterator[NDArray[np.int64]]:
    """Yield shuffled batches of all rows per round, without an incomplete last batch."""
    for _ in range(recipe.rounds):
        order = rng.permutation(rows)
        for first in range(0, rows - recipe.batch + 1, recipe.batch):
            yield order[first : first + recipe.batch]


def _rate(done: float) -> float:
    return min(1.0, done / _RISING) * 0.5 * (1.0 + math.cos(math.pi * done))


def _slopes(
    layers: Layers,
    inputs: Floats,
    rows: NDArray[np.int64],
    slope: Slope,
    recipe: Recipe,
    rng: np.random.Generator,
) -> list[Floats]:
    """Return the gradients of the loss by all weights and all biases, for one batch."""
    of_inputs, of_hidden = recipe.dropped
    values = [inputs * (rng.random(inputs.shape, np.float32) >= of_inputs)]
    kept = []
    for weights, biases in zip(layers.weights[:-1], layers.biases[:-1], strict=True):
        hidden = values[-1] @ weights + biases
        keep = (hidden > 0) & (rng.random(hidden.shape, np.float32) >= of_hidden)
        kept.append(keep * np.float32(1.0 / (1.0 - of_hidden)))
        values.append(hidden * kept[-1])
    back = slope(values[-1] @ layers.weights[-1] + layers.biases[-1], rows) / np.float32(len(rows))
    by_weights, by_biases = [], []
    for depth in range(len(layers.weights) - 1, -1, -1):
        by_weights.append(values[depth].T @ back)
        by_biases.append(back.sum(axis=0))
        if depth:
            back = (back @ layers.weights[depth].T) * kept[depth - 1]
    return [*by_weights[::-1], *by_biases[::-1]]
