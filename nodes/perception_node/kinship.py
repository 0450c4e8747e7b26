"""Which class is a kind of which, and what several looks say together."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

from schemas.entities import ClassInfo, Size

ANYTHING = "Object"
"""The class of what is like nothing known."""

_SURE = 0.5
"""A class that has this much of the votes is believed."""
_FORGET = 0.9
"""What a look's vote is worth one look later."""


@dataclass(frozen=True)
class Kinship:
    """What is known of classes: all that each is a kind of, and what people call it, both from the TBox.

    `usual_m`: what things of a class measure, as far as perception learnt that.
    """

    ancestors: Mapping[str, frozenset[str]] = field(default_factory=dict)
    labels: Mapping[str, str] = field(default_factory=dict)
    usual_m: Mapping[str, Size] = field(default_factory=dict)

    def label(self, class_name: str) -> str:
        """What people call a thing of this class."""
        return self.labels.get(class_name) or class_name.replace("_", " ").lower()

    def is_a(self, special: str, general: str) -> bool:
        """Whether everything of class `special` is of class `general`. Everything is an Object."""
        return (
            special == general or general == ANYTHING or general in self.ancestors.get(special, frozenset())
        )

    def related(self, one: str, other: str) -> bool:
        """Whether a thing that is said to be of both classes is no contradiction."""
        return self.is_a(one, other) or self.is_a(other, one)

    def depth(self, class_name: str) -> int:
        """How special a class is."""
        return len(self.ancestors.get(class_name, ()))


def kinship_of(classes: Iterable[ClassInfo], usual_m: Mapping[str, Size]) -> Kinship:
    """The hierarchy and the labels of the TBox's classes, with what is known of their sizes."""
    rows = list(classes)
    labels = {row.name: row.labels.get("en") or row.labels.get("") or "" for row in rows}
    return Kinship({row.name: frozenset(row.ancestors) for row in rows}, labels, usual_m)


@dataclass(frozen=True)
class Votes:
    """What was said of one thing, look by look: class to probability, older looks counting less."""

    weights: Mapping[str, float] = field(default_factory=dict)
    looks: float = 0.0

    @staticmethod
    def remembered(class_name: str, probability: float) -> Votes:
        """What is left of very many looks that said the same, with this mean probability."""
        looks = 1.0 / (1.0 - _FORGET)
        return Votes({class_name: probability * looks}, looks)

    def cast(self, class_name: str, probability: float) -> Votes:
        """One more look."""
        weights = {name: weight * _FORGET for name, weight in self.weights.items()}
        weights[class_name] = weights.get(class_name, 0.0) + probability
        return Votes(weights, self.looks * _FORGET + 1.0)

    def share(self, class_name: str, kinship: Kinship) -> float:
        """The mean probability that it is of this class."""
        support = sum(w for voted, w in self.weights.items() if kinship.is_a(voted, class_name))
        return support / self.looks if self.looks else 0.0

    def belief(self, kinship: Kinship) -> str:
        """The most special class that is sure enough."""
        named = {*self.weights, *(a for voted in self.weights for a in kinship.ancestors.get(voted, ()))}
        sure = [name for name in named if self.share(name, kinship) >= _SURE and kinship.is_a(name, ANYTHING)]
        return max(
            sure, key=lambda name: (kinship.depth(name), self.share(name, kinship), name), default=ANYTHING
        )
