"""The grammar of commands: frames with their verbs and roles, and closed classes of expressions."""

from __future__ import annotations

import functools
import re
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from importlib import resources

Words = tuple[str, ...]


@dataclass(frozen=True, slots=True)
class FrameRoles:
    """A frame; `roles` maps `object`, `receiver` and classes of prepositions to its roles."""

    name: str
    roles: Mapping[str, str]


@dataclass(frozen=True, slots=True)
class Grammar:
    """The verbs and closed word classes of commands."""

    frames: Mapping[str, FrameRoles]
    verbs: Mapping[Words, str]  # verb with its particles -> frame
    longest_verb: int
    kinds: Mapping[str, Mapping[Words, None]]  # class of expressions -> its expressions
    opening: Mapping[str, frozenset[str]]  # class of expressions -> their first words
    longest: Mapping[str, int]  # class of expressions -> words of its longest
    persons: Mapping[str, str]  # frame -> frame with a person as its object
    numbers: Mapping[str, int]
    shares: Mapping[str, Fraction]  # expression -> part of the things; 1 for more than half
    purposes: Mapping[str, str]  # verb -> class of things: something to drink

    def match(self, kind: str, words: Sequence[str], i: int) -> int:
        """Return the number of words of the longest expression of a class that begins at `i`, or 0."""
        if i >= len(words) or words[i] not in self.opening[kind]:
            return 0
        known = self.kinds[kind]
        for length in range(min(self.longest[kind], len(words) - i), 0, -1):
            if tuple(words[i : i + length]) in known:
                return length
        return 0

    def is_a(self, word: str, kind: str) -> bool:
        """Return whether a word alone is an expression of a class."""
        return (word,) in self.kinds[kind]

    def contains(self, kind: str, text: str) -> bool:
        """Return whether a text is an expression of a class."""
        return tuple(text.split()) in self.kinds[kind]

    def verb(self, words: Sequence[str], i: int) -> tuple[int, str]:
        """Return the number of words and the frame of the longest verb that begins at `i`, or (0, "")."""
        for length in range(min(self.longest_verb, len(words) - i), 0, -1):
            text = tuple(words[i : i + length])
            if text in self.verbs:
                return length, self.verbs[text]
            if length == 1 and (base := self._gerund(text[0])):
                return 1, self.verbs[(base,)]
        return 0, ""

    def gerund(self, words: Sequence[str], i: int) -> tuple[int, str]:
        """Return the number of words and the frame of a verb that begins with a gerund at `i`, or (0, "")."""
        base = self._gerund(words[i]) if i < len(words) else ""
        return self.verb((base, *words[i + 1 :]), 0) if base else (0, "")

    def _gerund(self, word: str) -> str:
        """Return the base form of a verb that ends in -ing: bringing, putting."""
        stem = word.removesuffix("ing")
        if stem == word or len(stem) < 2:
            return ""
        forms = (stem, f"{stem}e", stem[:-1] if stem[-1] == stem[-2] else stem)
        return next((form for form in forms if (form,) in self.verbs), "")

    def number(self, word: str) -> int | None:
        """Return the value of a number word or numeral below 1000."""
        if re.fullmatch(r"\d{1,3}", word):
            return int(word)
        tens, _, ones = word.partition("-")  # twenty-one
        parts = [self.numbers[part] for part in (tens, ones) if part in self.numbers]
        return sum(parts) if len(parts) == 1 + bool(ones) else None


@functools.cache
def load() -> Grammar:
    """Return the English grammar, which other languages are translated to."""
    table = tomllib.loads((resources.files(__package__) / "english.toml").read_text("utf-8"))
    verbs: dict[Words, str] = {}
    frames: dict[str, FrameRoles] = {}
    for name, entry in table["frames"].items():
        frames[name] = FrameRoles(name, {key: role for key, role in entry.items() if key != "verbs"})
        for verb in entry["verbs"]:
            verbs.setdefault(tuple(verb.split()), name)
    words = {**table["words"], "share": list(table["shares"])}
    kinds = {kind: {tuple(text.split()): None for text in texts} for kind, texts in words.items()}
    return Grammar(
        frames,
        verbs,
        max(map(len, verbs)),
        kinds,
        {kind: frozenset(text[0] for text in texts) for kind, texts in kinds.items()},
        {kind: max(map(len, texts)) for kind, texts in kinds.items()},
        table["persons"],
        table["numbers"],
        {text: Fraction(share) for text, share in table["shares"].items()},
        table["purposes"],
    )
