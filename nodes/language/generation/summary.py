"""A short text about the contents of the map, for a person or a prompt, with a word limit.

The most important things come first. If the limit is low, things are counted instead of named:
"The kitchen has a table with 4 chairs round it, a fridge and 12 other things."
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from itertools import chain
from typing import Final, NamedTuple

from semmap.nodes.language import nouns
from semmap.nodes.language.generation.inventory import Group, How, Inventory
from semmap.nodes.language.generation.paragraphs import Paragraph, Piece, count_mentioned, there_are

_FEW: Final = 3
"""The maximum number of problems that are listed first."""


class Summary(NamedTuple):
    """A text, and the number of things that it does not name."""

    text: str
    left_out: int


def summarize_map(inventory: Inventory, problems: Sequence[str], most_words: int) -> Summary:
    """Summarise a map by places."""
    if not inventory.things and not inventory.places:
        return Summary("The map is empty.", 0)
    paragraphs = [_paragraph(inventory, name) for name in inventory.places_in_order()]
    elsewhere = "Outside all places {be}" if inventory.places else "There {be}"
    paragraphs.append(Paragraph(elsewhere, inventory.standing_in(None)))
    in_sum = inventory.in_sum(inventory.things.values())
    return _fit(_of_all(inventory), problems, paragraphs, in_sum, most_words)


def summarize_large_map(inventory: Inventory, problems: Sequence[str], most_words: int) -> Summary:
    """Summarise a map by counts only."""
    return _fit(_of_all(inventory), problems, (), inventory.in_sum(inventory.things.values()), most_words)


def summarize_place(inventory: Inventory, name: str, problems: Sequence[str], most_words: int) -> Summary:
    """Summarise a place with its parts."""
    own, *parts = inventory.parts_of(name)
    its_own = Paragraph(f"{_capital(inventory.the(own))} has", inventory.standing_in(own))
    paragraphs = [its_own, *(_paragraph(inventory, part) for part in parts)]
    things = [thing for place in (own, *parts) for thing in inventory.in_place(place)]
    in_sum = inventory.in_sum(things)
    within = inventory.places[name].within
    where = f" in {inventory.the(within)}" if within in inventory.places else ""
    title = _capital(inventory.the(name)) + ("" if inventory.the(name).endswith(f" {name}") else f" ({name})")
    if len(things) > its_own.all:
        its_own.heading = f"{_capital(inventory.the(name))} itself has"
    elif not problems:
        its_own.heading = "It has"
    if where and things and len(things) == its_own.all:
        return _fit(f"{title} is{where}.", problems, paragraphs, in_sum, most_words)
    has = nouns.with_number_word(len(things), "thing")
    return _fit(f"{title}{where} has {has}.", problems, paragraphs, in_sum, most_words)


def summarize_thing(
    inventory: Inventory, name: str, first: Iterable[str], last: Iterable[str], most_words: int
) -> Summary:
    """Summarise a thing: the sentences `first`, what is on, in and round it, and the sentences `last`.

    Sentences that exceed the word limit are left out.
    """
    result, left = "", 0
    for sentence in first:
        result = _append(result, sentence, most_words)
    for how, groups in inventory.at(name).items():
        text, unnamed = _at_it(how, groups, most_words - _words(result))
        result, left = _append(result, text, most_words), left + unnamed
    for sentence in last:
        result = _append(result, sentence, most_words)
    return Summary(result, left)


def _of_all(inventory: Inventory) -> str:
    """Return `The map has 9 places and 69 things.`."""
    counts = ((len(inventory.places), "place"), (len(inventory.things), "thing"))
    return (
        f"The map has {nouns.enumerate_nouns([nouns.with_number_word(n, noun) for n, noun in counts if n])}."
    )


def _paragraph(inventory: Inventory, name: str) -> Paragraph:
    """Return the paragraph of a place without its parts: `The dining corner of the kitchen has`."""
    within = inventory.places.get(inventory.places[name].within or "")
    is_outermost = within is None
    of = f" of {inventory.the(within.name)}" if within is not None and within.within is not None else ""
    itself = " itself" if is_outermost and len(inventory.parts_of(name)) > 1 else ""
    return Paragraph(f"{_capital(inventory.the(name))}{of}{itself} has", inventory.standing_in(name))


def _fit(
    opening: str,
    problems: Sequence[str],
    paragraphs: Sequence[Paragraph],
    in_sum: Sequence[Group],
    most_words: int,
) -> Summary:
    """Return the opening, problems and places, as far as the word limit allows.

    If there is no room for a paragraph per place, `in_sum` counts the things of all places together.
    """
    first = [opening, *_of_problems(problems, most_words - _words(opening))]

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
    result = with_(full, pieces[: _most(len(pieces), lambda count: fits(with_(full, pieces[:count])))])
    if is_in_sum and result.left_out == full[0].all:  # the opening contains the number already
        return Summary(" ".join(first), result.left_out)
    return result


def _of_problems(problems: Sequence[str], most_words: int) -> Iterator[str]:
    """Yield at most one sentence: `Problems: cup1, not seen where it should stand; and 2 more.`."""
    for count in range(min(len(problems), _FEW), 0, -1):
        more = [f"and {len(problems) - count} more"] if count < len(problems) else []
        text = f"Problems: {'; '.join([*problems[:count], *more])}."
        if _words(text) <= most_words // 2:
            yield text
            return
    if problems:
        verb = "is" if len(problems) == 1 else "are"
        yield f"There {verb} {nouns.with_number_word(len(problems), 'problem')}."


def _at_it(how: How, groups: Sequence[Group], most_words: int) -> Summary:
    """Summarise what is on, in or round the thing: `On it are 2 plates and one other thing.`."""
    count = sum(group.all for group in groups)
    where = "At it" if how == "round" and count == 1 else f"{how.capitalize()} it"

    def with_(shown: int) -> Summary:
        if not shown:
            return Summary(
                f"{where} {'is' if count == 1 else 'are'} {nouns.with_number_word(count, 'thing')}.", count
            )
        rest = count - sum(map(count_mentioned, groups[:shown]))
        return Summary(there_are(where, groups[:shown], rest), rest)

    return with_(_most(len(groups), lambda shown: _words(with_(shown).text) <= most_words))


def _append(text: str, sentence: str, most_words: int) -> str:
    """Append a sentence if the word limit allows it."""
    longer = f"{text} {sentence}".strip()
    return longer if _words(longer) <= most_words or not text else text


def _most(count: int, fits: Callable[[int], bool]) -> int:
    """Return the largest number up to `count` that fits, found by bisection; 0 if none does."""
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
