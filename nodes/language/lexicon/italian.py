"""The Italian lexicon: expressions, verb forms used in commands, and clitics, with their English words."""

from __future__ import annotations

import functools
import tomllib
from collections.abc import Iterator
from dataclasses import dataclass
from importlib import resources
from typing import Final

_ARTICLES: Final = {"l": "il", "llo": "lo", "lla": "la", "lle": "le", "ll'": "l'", "i": "i", "gli": "gli"}
_JOINED: Final = {"a": "a", "da": "da", "de": "di", "ne": "in", "su": "su", "co": "con"}
ARTICULATED: Final = {
    start + end: (preposition, article)
    for start, preposition in _JOINED.items()
    for end, article in _ARTICLES.items()
}
"""Preposition and article in one word: `della` is `di` and `la`."""

# Endings: imperatives (tu, Lei, voi), present, infinitives (also before a clitic), past subjunctive.
_ENDINGS: Final = {
    "are": ("a", "i", "ate", "are", "ar", "assi"),
    "ere": ("i", "a", "e", "ete", "ere", "er", "essi"),
    "ire": ("i", "a", "e", "ite", "ire", "ir", "issi"),
}


@dataclass(frozen=True, slots=True)
class Italian:
    """The words of Italian, in lower case."""

    expressions: dict[tuple[str, ...], str]  # words -> English; words in parentheses have no original
    relative: dict[str, str]
    verbs: dict[str, str]  # form -> English base form
    clitics: dict[str, str]  # -> English pronoun, "" for none
    moving: frozenset[str]  # forms of verbs for which the robot itself moves
    adjectives: dict[str, str]  # form -> English
    synonyms: dict[str, str]  # -> class of the household TBox

    def is_word(self, text: str) -> bool:
        """Return whether this is a word of the lexicon; nouns are in the TBox."""
        return (
            (text,) in self.expressions
            or text in self.verbs
            or text in self.adjectives
            or text in self.clitics
            or text in self.relative
            or text in ARTICULATED
        )


@functools.cache
def italian() -> Italian:
    """Return the Italian lexicon."""
    table = tomllib.loads((resources.files(__package__) / "italian.toml").read_text("utf-8"))
    irregular: dict[str, list[str]] = table["irregular"]
    verbs: dict[str, str] = {}
    moving: set[str] = set()
    for english, infinitives in table["verbs"].items():
        for infinitive in infinitives:
            forms = {*_forms(infinitive), *irregular.get(infinitive, ())}
            verbs.update(dict.fromkeys(forms, english))
            if infinitive in table["moving"]["verbs"]:
                moving |= forms
    for english, infinitives in table["verbs"].items():  # "da" is of dare, and "di" of dire
        verbs.update((form, english) for infinitive in infinitives for form in irregular.get(infinitive, ()))
    return Italian(
        {tuple(_pieces(text)): english for english, words in table["words"].items() for text in words},
        {text: english for english, words in table["relative"].items() for text in words},
        verbs,
        table["clitics"],
        frozenset(moving),
        {
            form: english
            for english, words in table["adjectives"].items()
            for adjective in words
            for form in _inflected(adjective)
        },
        {text: name for name, words in table["synonyms"].items() for text in words},
    )


def singulars(word: str) -> Iterator[str]:
    """Yield the word itself and the possible singulars of it."""
    yield word
    for plural, singular in (
        ("chi", "co"), ("ghi", "go"), ("che", "ca"), ("ghe", "ga"), ("ci", "cio"), ("gi", "gio"),
        ("gli", "glio"), ("i", "o"), ("i", "e"), ("e", "a"), ("i", "io"), ("ce", "cia"), ("ge", "gia"),
    ):  # fmt: skip
        if word.endswith(plural) and len(word) > len(plural) + 1:
            yield word[: -len(plural)] + singular


def _pieces(text: str) -> Iterator[str]:
    """Yield the words of an expression; an articulated preposition is two words, as in a command."""
    words = text.replace("'", "' ").split()
    for word in words:
        yield from ARTICULATED.get(word, (word,)) if len(words) > 1 else (word,)


def _forms(infinitive: str) -> Iterator[str]:
    stem, kind = infinitive[:-3], infinitive[-3:]
    for ending in _ENDINGS.get(kind, ()):
        if kind == "are" and ending == "i":
            if stem.endswith(("c", "g")):
                yield stem + "hi"
            else:
                yield stem if stem.endswith("i") else stem + "i"
        else:
            yield stem + ending


def _inflected(adjective: str) -> Iterator[str]:
    """Yield the forms of an adjective in gender and number."""
    yield adjective
    stem = adjective[:-1]
    hard = "h" if stem.endswith(("c", "g")) else ""
    if adjective.endswith("o"):
        yield from (stem + "a", f"{stem}{hard}e", stem + ("" if stem.endswith("i") else f"{hard}i"))
    elif adjective.endswith("e"):
        yield stem + "i"
