"""A short text of what is there, for a person and for a prompt, with a budget of words.

What matters most is said first. Where words are few, things are counted instead of named, and what is left
out is said to be: "The kitchen has a table with 4 chairs round it, a fridge and 12 other things."
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from itertools import chain
from typing import Final, NamedTuple

from semmap.nodes.language import nouns
from semmap.nodes.language.generation.inventory import Group, How, Inventory
from semmap.nodes.language.generation.paragraphs import Paragraph, Piece, spoken_of, there_are

_FEW: Final = 3
"""Troubles that are told before anything else."""


class Summary(NamedTuple):
    """A text, and how many things of those that it is about are not named in it."""

    text: str
    left_out: int


def summarize_map(inventory: Inventory, troubles: Sequence[str], most_words: int) -> Summary:
    """What a map has."""
    if not inventory.things and not inventory.places:
        return Summary("The map is empty.", 0)
    paragraphs = [_paragraph(inventory, name) for name in inventory.places_in_order()]
    elsewhere = "In no place {be}" if inventory.places else "There {be}"
    paragraphs.append(Paragraph(elsewhere, inventory.standing_in(None)))
    in_sum = inventory.in_sum(inventory.things.values())
    return _fitted(_of_all(inventory), troubles, paragraphs, in_sum, most_words)


def summarize_large_map(inventory: Inventory, troubles: Sequence[str], most_words: int) -> Summary:
    """What a map has, wherever it is."""
    return _fitted(_of_all(inventory), troubles, (), inventory.in_sum(inventory.things.values()), most_words)


def summarize_place(inventory: Inventory, name: str, troubles: Sequence[str], most_words: int) -> Summary:
    """What a place has, and what its parts have."""
    own, *parts = inventory.parts_of(name)
    its_own = Paragraph(f"{_capital(inventory.the(own))} has", inventory.standing_in(own))
    paragraphs = [its_own, *(_paragraph(inventory, part) for part in parts)]
    things = [thing for place in (own, *parts) for thing in inventory.in_place(place)]
    in_sum = inventory.in_sum(things)
    within = inventory.places[name].within
    where = f" in {inventory.the(within)}" if within in inventory.places else ""
    called = _capital(inventory.the(name)) + (
        "" if inventory.the(name).endswith(f" {name}") else f" ({name})"
    )
    if len(things) > its_own.all:
        its_own.heading = f"{_capital(inventory.the(name))} itself has"
    elif not troubles:
        its_own.heading = "It has"
    if where and things and len(things) == its_own.all:
        return _fitted(f"{called} is{where}.", troubles, paragraphs, in_sum, most_words)
    has = nouns.number(len(things), "thing")
    return _fitted(f"{called}{where} has {has}.", troubles, paragraphs, in_sum, most_words)


def summarize_thing(
    inventory: Inventory, name: str, sentences: Iterable[str], said_last: Iterable[str], most_words: int
) -> Summary:
    """What a thing is and where, what is on, in and round it, and what else is said of it.

    `sentences` are said first and `said_last` at the end, as far as there are words for them.
    """
    told, left = "", 0
    for sentence in sentences:
        told = _longer(told, sentence, most_words)
    for how, groups in inventory.at(name).items():
        text, unnamed = _at_it(how, groups, most_words - _words(told))
        told, left = _longer(told, text, most_words), left + unnamed
    for sentence in said_last:
        told = _longer(told, sentence, most_words)
    return Summary(told, left)


def _of_all(inventory: Inventory) -> str:
    """`The map has 9 places and 69 things.`."""
    counts = ((len(inventory.places), "place"), (len(inventory.things), "thing"))
    return f"The map has {nouns.listed([nouns.number(n, noun) for n, noun in counts if n])}."


def _paragraph(inventory: Inventory, name: str) -> Paragraph:
    """What a place has itself: `The dining corner of the kitchen has`."""
    within = inventory.places.get(inventory.places[name].within or "")
    is_outermost = within is None
    of = f" of {inventory.the(within.name)}" if within is not None and within.within is not None else ""
    itself = " itself" if is_outermost and len(inventory.parts_of(name)) > 1 else ""
    return Paragraph(f"{_capital(inventory.the(name))}{of}{itself} has", inventory.standing_in(name))


def _fitted(
    opening: str,
    troubles: Sequence[str],
    paragraphs: Sequence[Paragraph],
    in_sum: Sequence[Group],
    most_words: int,
) -> Summary:
    """The opening, then as much as there are words for: troubles, and places with their groups in turn.

    Where there are no words for each place, the things of all of them are told together: `in_sum`.
    """
    first = [opening, *_of_troubles(troubles, most_words - _words(opening))]

    def with_(those: Sequence[Paragraph], named: Collection[Piece]) -> Summary:
        texts, left = list(first), 0
        for paragraph in those:
            text, unnamed = paragraph.text(set(named))
            texts.append(text)
            left += unnamed
        return Summary(" ".join(texts), left)

    def fits(summary: Summary) -> bool:
        return _words(summary.text) <= most_words

    full = [paragraph for paragraph in paragraphs if paragraph.groups]
    is_in_sum = bool(in_sum) and (not full or len(full) > most_words or not fits(with_(full, ())))
    if (in_sum and not full) or len(full) > most_words or not fits(with_(full, ())):
        full = [Paragraph("There {be}", tuple(in_sum))]
        if not fits(with_(full, ())):
            return Summary(" ".join(first), full[0].all)
    largest_first = sorted(full, key=lambda paragraph: -paragraph.all)
    in_turn = chain.from_iterable(paragraph.pieces[:most_words] for paragraph in largest_first)
    pieces = sorted(in_turn, key=lambda piece: piece.position)[:most_words]
    told = with_(full, pieces[: _most(len(pieces), lambda count: fits(with_(full, pieces[:count])))])
    if is_in_sum and told.left_out == full[0].all:  # the opening has said how many there are
        return Summary(" ".join(first), told.left_out)
    return told


def _of_troubles(troubles: Sequence[str], most_words: int) -> Iterator[str]:
    """At most one sentence: `Not as it should be: cup1, not seen where it should stand; and 2 more.`."""
    for count in range(min(len(troubles), _FEW), 0, -1):
        more = [f"and {len(troubles) - count} more"] if count < len(troubles) else []
        text = f"Not as it should be: {'; '.join([*troubles[:count], *more])}."
        if _words(text) <= most_words // 2:
            yield text
            return
    if troubles:
        verb = "is" if len(troubles) == 1 else "are"
        yield f"{_capital(nouns.number(len(troubles), 'thing'))} {verb} not as it should be."


def _at_it(how: How, groups: Sequence[Group], most_words: int) -> Summary:
    """What is on, in or round the thing spoken of: `On it are 2 plates and one other thing.`."""
    count = sum(group.all for group in groups)
    where = "At it" if how == "round" and count == 1 else f"{how.capitalize()} it"

    def with_(shown: int) -> Summary:
        if not shown:
            return Summary(f"{where} {'is' if count == 1 else 'are'} {nouns.number(count, 'thing')}.", count)
        rest = count - sum(map(spoken_of, groups[:shown]))
        return Summary(there_are(where, groups[:shown], rest), rest)

    return with_(_most(len(groups), lambda shown: _words(with_(shown).text) <= most_words))


def _longer(told: str, sentence: str, most_words: int) -> str:
    """With a sentence more, if there are words for it."""
    longer = f"{told} {sentence}".strip()
    return longer if _words(longer) <= most_words or not told else told


def _most(count: int, fits: Callable[[int], bool]) -> int:
    """The largest number up to `count` that fits, as nearly as bisection tells; 0 if none does."""
    if fits(count):
        return count
    low, high = 0, count
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (middle, high) if fits(middle) else (low, middle)
    return low


def _words(text: str) -> int:
    return len(text.split())


def _capital(text: str) -> str:
    return text[:1].upper() + text[1:]
