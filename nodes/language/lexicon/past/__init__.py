"""The lexicon of questions about the past: what is asked, events, relations, and expressions of time."""

from __future__ import annotations

import functools
import re
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from importlib import resources
from typing import Any, Final

from semmap.schemas.language import Language

Words = tuple[str, ...]
_TIME: Final = r"\d{4}-\d\d-\d\d(?:t\d\d:\d\d(?::\d\d)?)?|\d{1,2}[:.]\d\d(?:[:.]\d\d)?(?![\w:])"
_TOKENS: Final[Mapping[Language, re.Pattern[str]]] = {
    "english": re.compile(
        rf"{_TIME}|o'clock|[ap]\.m\.?|\d+(?=[ap]m\b)|\d+(?![\w])|n't\b|'\w+|[^\W\d]+(?=n't\b)|\w+(?:-\w+)*|[?;]"
    ),
    "italian": re.compile(rf"{_TIME}|[^\W\d_]+'|\d+(?![\w])|\w+(?:-\w+)*|[?;]"),
}
KINDS: Final = ("ask", "event", "state_event", "state", "relation", "mark", "filler")
"""The tables whose expressions are elements of a question."""


@dataclass(frozen=True, slots=True)
class PastLexicon:
    """The expressions of a language. `senses` maps an expression to its meaning by table."""

    language: Language
    senses: Mapping[Words, Mapping[str, str]]
    longest: int
    times: Mapping[str, frozenset[Words]]
    """The expressions of each class of words of time."""
    tables: Mapping[str, Mapping[Words, Any]]
    """Days, parts of the day, points, weekdays and numbers by their expressions."""

    def split(self, text: str) -> list[str]:
        """Return the words of a text in lower case. A clock time is a word."""
        return split(text, self.language)

    def match(self, words: list[str], i: int) -> tuple[int, Mapping[str, str]]:
        """Return the length and the senses of the longest expression that begins at `i`, or (0, {})."""
        for length in range(min(self.longest, len(words) - i), 0, -1):
            if (found := self.senses.get(tuple(words[i : i + length]))) is not None:
                return length, found
        return 0, {}

    def match_time(self, kind: str, words: list[str], i: int) -> int:
        """Return the number of words of the longest expression of a class of time at `i`, or 0."""
        return max((len(w) for w in self.times[kind] if tuple(words[i : i + len(w)]) == w), default=0)

    def look_up(self, table: str, words: list[str], i: int) -> tuple[int, Any]:
        """Return the length and the value of the longest expression of a table at `i`, or (0, None)."""
        found = [
            (len(w), value) for w, value in self.tables[table].items() if tuple(words[i : i + len(w)]) == w
        ]
        return max(found, key=lambda one: one[0], default=(0, None))


def split(text: str, language: Language) -> list[str]:
    """Return the words of a text in lower case, and the marks that end a question."""
    plain = text.lower().replace("’", "'").replace("‘", "'")
    return _TOKENS[language].findall(plain)


@functools.cache
def load(language: Language) -> PastLexicon:
    """Return the lexicon of a language."""
    table = tomllib.loads((resources.files(__package__) / f"{language}.toml").read_text("utf-8"))
    senses: dict[Words, dict[str, str]] = {}
    for kind in KINDS:
        for value, texts in table[kind].items():
            for text in texts:
                senses.setdefault(tuple(split(text, language)), {}).setdefault(kind, value)
    return PastLexicon(
        language,
        senses,
        max(map(len, senses)),
        {kind: frozenset(tuple(split(t, language)) for t in texts) for kind, texts in table["time"].items()},
        {
            name: {tuple(split(text, language)): value for text, value in table[name].items()}
            for name in ("days", "parts", "points", "weekdays", "numbers")
        },
    )
