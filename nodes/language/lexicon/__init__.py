"""The hand-written lexicon of a language: words by class, verbs by frame, irregular forms."""

from __future__ import annotations

import functools
import tomllib
from dataclasses import dataclass
from importlib import resources


@dataclass(frozen=True, slots=True)
class Lexicon:
    """The words of a language."""

    classes: dict[str, frozenset[str]]  # name of a class of words -> its words
    frames: dict[str, tuple[str, ...]]  # verb, with its particle if any -> frames, as listed
    irregular: dict[str, str]  # form -> base form
    prepositions: tuple[tuple[str, ...], ...]  # of several words, longest first
    manner_ending: str
    synonyms: dict[str, str]  # word -> class of the household TBox
    numbers: dict[str, int]  # from two to ten

    def is_a(self, word: str, kind: str) -> bool:
        """Return whether a word is in a word class of the lexicon."""
        return word in self.classes.get(kind, frozenset())

    def is_manner(self, word: str) -> bool:
        """Return whether a word looks like an adverb of manner."""
        return word.endswith(self.manner_ending)


@functools.cache
def load(language: str = "english") -> Lexicon:
    """Return the lexicon of a language, `english` or `italian`."""
    table = tomllib.loads((resources.files(__package__) / f"{language}.toml").read_text("utf-8"))
    frames: dict[str, list[str]] = {}
    for frame, verbs in table["verbs"].items():
        for verb in verbs:
            frames.setdefault(verb, []).append(frame)
    several = [tuple(text.split()) for text in table["words"]["complex_preposition"]]
    return Lexicon(
        {kind: frozenset(words) for kind, words in table["words"].items()},
        {verb: tuple(known) for verb, known in frames.items()},
        table["lemmas"],
        tuple(sorted(several, key=len, reverse=True)),
        table["manner_ending"],
        {word: name for name, words in table["synonyms"].items() for word in words},
        {word: n for n, word in enumerate(table["words"]["number"][:11]) if n > 1},
    )
