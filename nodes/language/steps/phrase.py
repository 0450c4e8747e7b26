"""Noun phrases as read: the words of a thing, person or place and what they state."""

from __future__ import annotations

from dataclasses import dataclass, field
from fractions import Fraction
from typing import Literal

Kind = Literal["thing", "person", "name", "pronoun", "speaker", "robot", "here"]


@dataclass(slots=True)
class Amount:
    """How many things a phrase denotes, other than a number or all of them."""

    at_least: int | None = None
    at_most: int | None = None
    share: Fraction | None = None
    """The part of the things that fit, or 1 for more than half of them."""
    all_but: int = 0
    total: int | None = None
    """How many things fit: two for *both cups*, three for *two of the three cups*."""
    is_none: bool = False
    is_vague: bool = False
    is_same: bool = False
    """Whether the thing was mentioned before: the same cup."""
    is_other: bool = False
    """Whether things that were mentioned before are excluded: another cup, the rest of the cups."""


@dataclass(slots=True)
class PlacePhrase:
    """Where a described thing is: a preposition and the thing it relates to."""

    preposition: str
    other: NounPhrase
    first: int
    end: int
    negated: bool = False
    names: tuple[str, ...] = ()
    """The entities of the other thing, if it is a pronoun that was resolved."""


@dataclass(slots=True)
class NounPhrase:
    """A noun phrase: the indices of its words and what they say.

    `noun` is the noun as written, `key` its base form, and `attributes` are qualities as written.
    """

    first: int
    end: int = 0
    head: int = 0
    kind: Kind = "thing"
    noun: str = ""
    key: str = ""
    name: str = ""
    determiner: str = ""
    attributes: list[str] = field(default_factory=list)
    superlative: str = ""
    quantity: int | None = None
    all_of: bool = False
    amount: Amount = field(default_factory=Amount)
    purpose: str = ""
    is_plural: bool = False
    places: list[PlacePhrase] = field(default_factory=list)
    owner: NounPhrase | None = None
    of: NounPhrase | None = None
    second: NounPhrase | None = None
    """The other thing after *between*."""
    excluded: list[NounPhrase] = field(default_factory=list)
    alternatives: list[NounPhrase] = field(default_factory=list)
    """The other things after *or*, any of which will do as well."""
    asked: list[str] = field(default_factory=list)
    """What a question asks whether it is so of the things, in English: open, not red."""
    asks_existence: bool = False
    """Whether a question asks whether there is such a thing: is there the milk."""
    asks_any: bool = False
    """Whether a question asks which of the alternatives is so: is it open or closed."""

    def exclude(self, others: list[NounPhrase]) -> None:
        """Add an exception: the red one, or two of them."""
        for other in others:
            is_counted = other.quantity is not None and not (other.places or other.determiner)
            if is_counted and other.key in ("", self.key) and not other.attributes:
                self.amount.all_but += other.quantity or 0
            else:
                self.excluded.append(other)

    @property
    def is_definite(self) -> bool:
        """Return whether the phrase denotes one particular thing."""
        return self.determiner in (
            "the",
            "this",
            "that",
            "my",
            "your",
            "his",
            "her",
            "their",
            "its",
            "our",
        ) or (self.owner is not None)
