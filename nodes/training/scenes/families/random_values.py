"""What families are drawn with: numbers, chances and colours by lot."""

from __future__ import annotations

import math

import numpy as np

from semmap.nodes.sim_node.models.forms import shade
from semmap.nodes.sim_node.models.parts import Colour


class RandomValues:
    """Numbers drawn by lot."""

    def __init__(self, rng: np.random.Generator) -> None:
        self.rng = rng

    def __call__(self, low: float, high: float) -> float:
        """Any number between the two; as likely a tenth more as a tenth less."""
        return float(math.exp(self.rng.uniform(math.log(low), math.log(high))))

    def even(self, low: float, high: float) -> float:
        """Any number between the two."""
        return float(self.rng.uniform(low, high))

    def chance(self, share: float) -> bool:
        """True so often."""
        return bool(self.rng.random() < share)

    def other(self, colour: Colour) -> Colour:
        """A colour that goes with it: darker or lighter, or a grey."""
        if self.chance(0.5):
            return shade(colour, self(0.4, 1.8))
        grey = self.even(0.05, 0.95)
        return (grey, grey, grey)
