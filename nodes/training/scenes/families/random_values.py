"""Random numbers, decisions and colours for sampling families."""

from __future__ import annotations

import math

import numpy as np

from semmap.nodes.sim_node.models.forms import shade
from semmap.nodes.sim_node.models.parts import Colour


class RandomValues:
    """Random values."""

    def __init__(self, rng: np.random.Generator) -> None:
        self.rng = rng

    def __call__(self, low: float, high: float) -> float:
        """Return a log-uniform number between the two."""
        return float(math.exp(self.rng.uniform(math.log(low), math.log(high))))

    def even(self, low: float, high: float) -> float:
        """Return a uniform number between the two."""
        return float(self.rng.uniform(low, high))

    def chance(self, share: float) -> bool:
        """Return True with the probability `share`."""
        return bool(self.rng.random() < share)

    def other(self, colour: Colour) -> Colour:
        """Return a matching colour: darker or lighter, or a grey."""
        if self.chance(0.5):
            return shade(colour, self(0.4, 1.8))
        grey = self.even(0.05, 0.95)
        return (grey, grey, grey)
