"""How many things a phrase of a command denotes: at least two cups, half of the plates, another cup."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import Final

from msgspec import structs

from semmap.nodes.language.lexicon.commands import Grammar
from semmap.nodes.language.steps.phrase import Amount, NounPhrase
from semmap.schemas.language import ThingDescription

_BOUNDS: Final = ("at_least", "at_most", "more_than", "fewer_than", "exactly", "roughly")
_AFTER: Final = ("at_least_after", "at_most_after")
_OTHERS: Final = frozenset(("other", "more", "further", "additional", "remaining"))
_GROUPS: Final = {"dozen": 12, "dozens": 12, "couple": 2, "pair": 2}
_RANGE: Final = {"between": "and", "from": "to"}


def read_bound(g: Grammar, words: Sequence[str], i: int) -> tuple[int, NounPhrase] | None:
    """Return the index after a number with a bound at `i`, and a phrase with its quantity; or None.

    The bound is before the number (*no more than two*), after it (*two or more*) or is a second number
    (*two or three*). A number without a bound is not read.
    """
    kind, length = max(((kind, g.match(kind, words, i)) for kind in _BOUNDS), key=lambda found: found[1])
    j = i + length
    opening = "" if length else words[i] if words[i] in _RANGE else ""
    j += bool(opening)
    number, taken = read_number(g, words, j)
    if not taken:
        return None
    found = NounPhrase(i, quantity=number, is_plural=number > 1)
    j += taken
    before, (second, taken) = taken, read_number(g, words, j + 1)
    if taken and words[j] in ("or", "to", "and") and (words[j] != "and" or opening):
        has_number = taken > 1 and g.number(words[j + 1]) is not None
        if has_number and before == 1:  # two or three dozen, but not: six or A dozen, one or HALF a dozen
            number *= _GROUPS.get(words[j + 2], 1)
        first, last = sorted((number, second))
        found.quantity, found.is_plural, found.amount = first, True, Amount(at_least=first, at_most=last)
        return j + 1 + taken, found
    if opening:
        return None
    after = next((kind for kind in _AFTER if words[j : j + 1] == ("or",) and g.match(kind, words, j)), "")
    if not length and after:
        found.is_plural = True
        limit(found, after)
        return j + g.match(after, words, j), found
    if not length:
        return None
    limit(found, kind)
    return j, found


def read_number(g: Grammar, words: Sequence[str], i: int) -> tuple[int, int]:
    """Return the number at `i` (three, a dozen, a couple of) and how many words it has, or (0, 0)."""
    if length := g.match("half_dozen", words, i):
        return 6, length + _of(g, words, i + length)
    word = words[i] if i < len(words) else ""
    number = 1 if word in ("a", "an") else g.number(word)
    if number is None:
        return 0, 0
    unit = _GROUPS.get(words[i + 1]) if i + 1 < len(words) else None
    if unit is None:
        return number, 1 + (_of(g, words, i + 1) if word == "dozen" else 0)
    return number * unit, 2 + _of(g, words, i + 2)


def _of(g: Grammar, words: Sequence[str], i: int) -> int:
    """Return 1 for *of* at `i` that only joins a number to its noun (a couple OF cups), else 0."""
    is_part = any(g.match(kind, words, i + 1) for kind in ("determiner", "possessive", "all", "pronoun"))
    return int(words[i : i + 1] == ("of",) and i + 1 < len(words) and not is_part)


def limit(phrase: NounPhrase, kind: str) -> None:
    """Make the number of a phrase a bound of a kind; the quantity remains a number within the bound."""
    number = phrase.quantity or 0
    match kind:
        case "at_least" | "at_least_after":
            phrase.amount.at_least = number
        case "at_most" | "at_most_after":
            phrase.amount.at_most = number
        case "more_than":
            phrase.quantity = phrase.amount.at_least = number + 1
        case "fewer_than":
            phrase.quantity = phrase.amount.at_most = number - 1
        case "roughly":
            phrase.amount.is_vague = True


def limit_after(g: Grammar, words: Sequence[str], phrase: NounPhrase) -> int:
    """Return the number of words of a bound after a noun with a number (*two cups at most*), or 0."""
    if phrase.quantity is None:
        return 0
    for kind in _AFTER:
        if length := g.match(kind, words, phrase.end):
            limit(phrase, kind)
            return length
    return 0


def read_amount(g: Grammar, words: Sequence[str], i: int, phrase: NounPhrase, is_noun: bool) -> int:
    """Return the number of words of an amount before a noun at `i`, and add it to the phrase; or 0.

    Examples are *half of*, *most of*, *none of*, *several*, *the rest of*, *only*. `is_noun` tells whether a
    noun is at `i + 1`: *most cups*, but *most expensive cup*.
    """
    amount = phrase.amount
    length = max(g.match(kind, words, i) for kind in ("share", "vague", "none", "several", "rest", "exactly"))
    if not length and (length := g.match("roughly", words, i)):
        if not g.match("all", words, i + length):
            return 0
        amount.is_vague = True  # almost all the cups
        return length
    if not length:
        return 0
    text = " ".join(words[i : i + length])
    of = i + length + (words[i + length : i + length + 1] == ("of",))
    is_partitive = any(g.match(kind, words, of) for kind in ("determiner", "possessive", "all"))
    if g.contains("share", text):
        if of == i + length and not is_partitive and not (is_noun and text == "most"):
            return 0  # the most expensive cup
        amount.share, phrase.is_plural = g.shares[text], True
    elif g.contains("vague", text):
        amount.is_vague = True
    elif g.contains("none", text):
        amount.is_none, phrase.determiner = True, phrase.determiner or "no"
    elif text == "only" and phrase.determiner:
        amount.total = 1  # the only cup
    elif g.contains("several", text):
        amount.at_least, phrase.is_plural = 2, True
    elif g.contains("rest", text):
        amount.is_other, phrase.determiner = True, "another" if text == "another" else "the"
        phrase.is_plural = phrase.is_plural or text not in ("another", "the other")
    return of - i


def is_other(word: str) -> bool:
    """Return whether a word before a noun excludes what was mentioned: the OTHER cup, one MORE cup."""
    return word in _OTHERS


def count(phrase: NounPhrase, known: int | None, text: str) -> str:
    """Complete the quantity of a phrase if `known` things fit it; return a doubt about it, or "".

    `known` is None if the map cannot tell how many there are.
    """
    amount = phrase.amount
    there = "" if known is None else f"there {'is' if known == 1 else 'are'} "
    if amount.is_vague or (known is None and (amount.share or amount.all_but)):
        return f"'{text}': how many are meant is not clear"
    if known is None:
        return ""
    is_exact = amount.at_least is None and amount.at_most is None and not amount.is_other
    if amount.total is None and is_exact and not phrase.superlative:
        is_definite = phrase.is_definite or phrase.determiner in ("these", "those")
        amount.total = phrase.quantity if is_definite else None  # the two cups
    if amount.total not in (None, known):
        return f"'{text}': {there}{'only ' if known < (amount.total or 0) else ''}{known}"
    if amount.share == Fraction(1):  # most of them
        amount.at_least = phrase.quantity = known // 2 + 1
    elif amount.share:
        part = amount.share * known
        if part.denominator != 1:
            return f"'{text}': {there}{known}"
        phrase.quantity = int(part)
    elif amount.all_but:
        phrase.quantity = max(0, known - amount.all_but)
    needed = amount.at_least or (phrase.quantity if amount.at_most is None else None)
    return f"'{text}': {there}only {known}" if needed is not None and known < needed else ""


def describe(phrase: NounPhrase, description: ThingDescription | None) -> ThingDescription | None:
    """Return a description with the quantity of a phrase."""
    if description is None:
        return None
    quantity = "all" if phrase.all_of and phrase.quantity is None else phrase.quantity
    amount = phrase.amount
    return structs.replace(description, quantity=quantity, at_least=amount.at_least, at_most=amount.at_most)
