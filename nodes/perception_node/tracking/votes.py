"""Combines the class votes of several frames."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from semmap.nodes.perception_node.tracking.class_hierarchy import ANYTHING, ClassHierarchy

_SURE = 0.4
"""A class that has this much of the votes is believed."""
_FORGET = 0.9
"""What a look's vote is worth one look later."""


@dataclass(frozen=True)
class Votes:
    """What was said of one thing, look by look: class to probability, older looks counting less."""

    weights: Mapping[str, float] = field(default_factory=dict)
    frames: float = 0.0

    @staticmethod
    def remembered(class_name: str, probability: float) -> Votes:
        """What is left of very many looks that said the same, with this mean probability."""
        looks = 1.0 / (1.0 - _FORGET)
        return Votes({class_name: probability * looks}, looks)

    def cast(self, class_name: str, probability: float, worth: float = 1.0) -> Votes:
        """One more look, that is worth so many."""
        weights = {name: weight * _FORGET for name, weight in self.weights.items()}
        weights[class_name] = weights.get(class_name, 0.0) + probability * worth
        return Votes(weights, self.frames * _FORGET + worth)

    def moved(self, class_name: str, to: str) -> Votes:
        """The same, but what was said of one class is said of another."""
        weights = dict(self.weights)
        weights[to] = weights.get(to, 0.0) + weights.pop(class_name, 0.0)
        return Votes(weights, self.frames)

    def share(self, class_name: str, classes: ClassHierarchy) -> float:
        """The mean probability that it is of this class."""
        support = sum(w for voted, w in self.weights.items() if classes.is_a(voted, class_name))
        return support / self.frames if self.frames else 0.0

    def belief(self, classes: ClassHierarchy) -> str:
        """The most special class that is sure enough."""
        named = {*self.weights, *(a for voted in self.weights for a in classes.ancestors.get(voted, ()))}
        sure = [name for name in named if self.share(name, classes) >= _SURE and classes.is_a(name, ANYTHING)]
        return max(
            sure, key=lambda name: (classes.depth(name), self.share(name, classes), name), default=ANYTHING
        )
