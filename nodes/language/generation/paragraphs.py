"""The sentences about one place: its groups, and what is on, in and round them."""

from __future__ import annotations

from collections.abc import Sequence
from collections.abc import Set as AbstractSet
from dataclasses import dataclass, field
from typing import Final

from semmap.nodes.language import nouns
from semmap.nodes.language.generation.inventory import Group, How

_ON_AND_IN: Final[tuple[How, How]] = ("on", "in")


@dataclass(frozen=True, eq=False)
class Piece:
    """A group that can be named, with the one that must be named before it; lower `position`s come first."""

    group: Group
    above: Piece | None = None
    how: How | None = None
    position: int = 0

    @property
    def speaks_of(self) -> int:
        """The number of things that its phrase mentions."""
        return count_mentioned(self.group) if self.how in _ON_AND_IN else len(self.group.things)


@dataclass(eq=False)
class Paragraph:
    """The sentences about one place, or about the things outside all places."""

    heading: str
    """`The kitchen has`, or with a verb that agrees with what follows: `Outside all places {be}`."""
    groups: tuple[Group, ...]
    pieces: list[Piece] = field(default_factory=list)

    def __post_init__(self) -> None:
        for index, group in enumerate(self.groups):
            above = Piece(group, position=index)
            self.pieces.append(above)
            for how, load in group.load.items():
                later = index + (how in _ON_AND_IN)  # things round it are in the same phrase
                self.pieces += (Piece(one, above, how, later + nth) for nth, one in enumerate(load))

    @property
    def all(self) -> int:
        """The number of things in the place."""
        return sum(group.all for group in self.groups)

    def text(self, named: AbstractSet[Piece]) -> tuple[str, int]:
        """Return the sentences that name these pieces, and the number of things that they leave out."""
        here = [piece for piece in self.pieces if piece in named]
        above = [piece for piece in here if piece.above is None]
        below: dict[Piece, list[Piece]] = {}
        for piece in here:
            if piece.above is not None:
                below.setdefault(piece.above, []).append(piece)
        others = self.all - sum(piece.group.all for piece in above)
        phrases: list[str] = []
        sentences: list[str] = []
        for piece in above:
            loads = below.get(piece, [])
            round_it = [one.group for one in loads if one.how == "round"]
            phrases.append(piece.group.phrase + _round(piece.group, round_it))
            mentioned = len(piece.group.things) + sum(len(group.things) for group in round_it)
            for how in _ON_AND_IN:
                if load := [one.group for one in loads if one.how == how]:
                    all_ = sum(group.all for group in piece.group.load[how])
                    where = f"{how.capitalize()} {piece.group.definite}"
                    sentences.append(there_are(where, load, all_ - sum(map(count_mentioned, load))))
                    mentioned += all_
            others += piece.group.all - mentioned
        unnamed = self.all - sum(piece.speaks_of for piece in here)
        return " ".join([self._first(above, phrases, others), *sentences]), unnamed

    def _first(self, named: Sequence[Piece], phrases: Sequence[str], others: int) -> str:
        """Return `The kitchen has a fridge and 12 other things.` or `The kitchen has 13 things.`."""
        parts = [*phrases, *_others(others)] if phrases else [nouns.with_number_word(others, "thing")]
        is_plural = len(parts) > 1 or (named[0].group.is_plural if named else others > 1)
        return f"{self.heading.replace('{be}', 'are' if is_plural else 'is')} {nouns.enumerate_nouns(parts)}."


def count_mentioned(group: Group) -> int:
    """Return the number of things that a phrase about a group and its load mentions."""
    return len(group.things) + sum(len(one.things) for how in _ON_AND_IN for one in group.load.get(how, ()))


def there_are(where: str, groups: Sequence[Group], others: int) -> str:
    """Return a sentence about the load of something: `On the table are 2 plates and a glass.`."""
    phrases = [_with_load(group) for group in groups] + _others(others)
    is_one = len(phrases) == 1 and not groups[0].is_plural
    return f"{where} {'is' if is_one else 'are'} {nouns.enumerate_nouns(phrases)}."


def _others(count: int) -> list[str]:
    return [nouns.with_number_word(count, "other thing")] if count else []


def _round(group: Group, round_it: Sequence[Group]) -> str:
    """` with 4 chairs round it`."""
    if not round_it:
        return ""
    word = "round" if sum(len(one.things) for one in round_it) > 1 else "at"
    return f" with {nouns.enumerate_nouns([one.phrase for one in round_it])} {word} {_it(group)}"


def _with_load(group: Group) -> str:
    """`a bowl with an apple in it`."""
    loads = [
        f"{nouns.enumerate_nouns([one.phrase for one in group.load[how]])} {how} {_it(group)}"
        for how in _ON_AND_IN
        if how in group.load
    ]
    return f"{group.phrase} with {nouns.enumerate_nouns(loads)}" if loads else group.phrase


def _it(group: Group) -> str:
    return "them" if group.is_plural else "it"
