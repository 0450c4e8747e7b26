"""Combines the class votes of several frames."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from semmap.nodes.perception_node.tracking.class_hierarchy import ANYTHING, ClassHierarchy
from semmap.schemas.perception import SURE

_CLEAR = 0.6
"""Minimum share of the votes of a clear winner."""
_FORGET = 0.9
"""Weight of a vote after one frame."""
_FORGOTTEN = 1e-4
"""Votes with less weight are dropped: a detector that describes in words may give new ones in each frame."""


@dataclass(frozen=True)
class Votes:
    """The votes for one thing: class to weighted probability, with exponential decay."""

    weights: Mapping[str, float] = field(default_factory=dict)
    frames: float = 0.0

    @staticmethod
    def remembered(class_name: str, probability: float) -> Votes:
        """Return the votes after very many frames with this mean probability."""
        looks = 1.0 / (1.0 - _FORGET)
        return Votes({class_name: probability * looks}, looks)

    def cast(self, class_name: str, probability: float, weight: float = 1.0) -> Votes:
        """Return the votes with one more, of this weight."""
        weights = {name: weight * _FORGET for name, weight in self.weights.items() if weight > _FORGOTTEN}
        weights[class_name] = weights.get(class_name, 0.0) + probability * weight
        return Votes(weights, self.frames * _FORGET + weight)

    @property
    def clear_winner(self) -> str | None:
        """Return the name with a clear majority of all votes, regardless of classes; None without one."""
        best = max(self.weights, key=self.weights.__getitem__, default=None)
        return best if best is not None and self.weights[best] >= _CLEAR * self.frames else None

    def moved(self, class_name: str, to: str) -> Votes:
        """Return the votes with those for one class moved to another."""
        weights = dict(self.weights)
        weights[to] = weights.get(to, 0.0) + weights.pop(class_name, 0.0)
        return Votes(weights, self.frames)

    def share(self, class_name: str, classes: ClassHierarchy) -> float:
        """Return the mean probability of a class."""
        support = sum(w for voted, w in self.weights.items() if classes.is_a(voted, class_name))
        return support / self.frames if self.frames else 0.0

    def belief(self, classes: ClassHierarchy) -> str:
        """Return the most specific class that is certain enough."""
        named = {*self.weights, *(a for voted in self.weights for a in classes.ancestors.get(voted, ()))}
        sure = [name for name in named if self.share(name, classes) >= SURE and classes.is_a(name, ANYTHING)]
        return max(
            sure, key=lambda name: (classes.depth(name), self.share(name, classes), name), default=ANYTHING
        )
