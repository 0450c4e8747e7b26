"""The words and punctuation marks of a command, with their place in its text."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Final

from semmap.nodes.language.lexicon import commands
from semmap.nodes.language.words import without_markup

_TOKEN: Final = re.compile(
    r"(?:mr|mrs|ms|dr)\.|\d{1,2}[:.]\d{2}|o'clock|[ap]\.m\.?|n't\b|'\w+|\d+(?:[.,]\d+)?"
    r"|[^\W\d_]+(?:-[^\W_]+)*(?=n't\b)|[^\W_]+(?:[-][^\W_]+)*|[,.;:!?]"
)
_HESITATION: Final = frozenset(("um", "uh", "uhm", "er", "erm", "hm", "hmm", "ehm", "oh", "ah", "eh"))
_PUNCTUATION: Final = frozenset(",.;:!?")
_GOING_ON: Final = (
    *("determiner", "all", "possessive", "to", "from", "place", "for", "about", "with", "of", "and", "then"),
    *("polite", "negation", "condition", "modal", "be", "wish", "phase", "exclude", "question"),
)
"""Classes of expressions that a clause does not end with."""
_BEHIND_VERBS: Final = ("determiner", "all", "possessive", "pronoun", "speaker", "to", "from", "place", "for")
"""Classes of expressions that show that the word before them is a verb and not a noun."""


@dataclass(frozen=True, slots=True)
class Token:
    """A word in lower case or a punctuation mark; `first` and `end` are its place in the text."""

    word: str
    first: int
    end: int
    is_capital: bool = False


@dataclass(frozen=True, slots=True)
class Text:
    """A text and its tokens."""

    text: str
    tokens: Sequence[Token]
    words: Sequence[str]
    is_translated: bool = False
    """Whether the words are English ones for a text in another language, possibly in another order."""

    def between(self, first: int, end: int) -> str:
        """Return the text of the tokens from index `first` to before `end`."""
        spans = [token for token in self.tokens[first:end] if token.first < token.end]
        return self.text[min(t.first for t in spans) : max(t.end for t in spans)] if spans else ""

    def word(self, i: int) -> str:
        """Return the word at `i` as in the text, in lower case: of a translated compound the first."""
        return self.between(i, i + 1).lower().partition(" ")[0] if self.is_translated else self.words[i]

    def is_mark(self, i: int) -> bool:
        """Return whether a punctuation mark is at `i`, or the text ends there."""
        return i >= len(self.words) or self.words[i] in _PUNCTUATION

    def ends_sentence(self, i: int) -> bool:
        """Return whether a sentence ends at `i`."""
        return i >= len(self.words) or self.words[i] in ".;!?"


def _without_hesitation(tokens: list[Token]) -> Iterator[Token]:
    """Yield tokens without sounds such as *uh*, and without the commas around one.

    Before a verb or a correction one comma is left, since it may be all that separates it from the rest:
    go there, um, close it; the cup, uh, no, the bowl.
    """
    words = [token.word for token in tokens]
    start = 0
    while start < len(tokens):
        end = start
        while end < len(tokens) and (words[end] in _HESITATION or words[end] == ","):
            end += 1
        pause = tokens[start:end]
        if not any(token.word in _HESITATION for token in pause):
            end = max(end, start + 1)
            yield from tokens[start:end]
        elif (
            start
            and _ends_clause(words[:start])
            and (_begins_with_verb(tokens[end:]) or correction_length(words[end:]))
        ):
            comma = next((token for token in pause if token.word == ","), pause[0])
            yield Token(",", comma.first, comma.end)
        start = end


def _ends_clause(words: list[str]) -> bool:
    """Return whether a clause may end after these words: not after an article or a preposition."""
    g = commands.load()
    return not any(
        tuple(words[-length:]) in g.kinds[kind]
        for kind in _GOING_ON
        for length in range(1, g.longest[kind] + 1)
    )


def correction_length(words: Sequence[str]) -> int:
    """Return the number of words of an expression of correction that these words begin with, or 0."""
    g = commands.load()
    return max(g.match(kind, words, 0) for kind in ("correction", "weak_correction"))


def _begins_with_verb(tokens: list[Token]) -> bool:
    """Return whether a command begins with these tokens: a verb and its object or place."""
    g, words = commands.load(), [token.word for token in tokens]
    length, _ = g.verb(words, 0)
    if not length or length == len(words):
        return length > 1 or bool(words and g.is_a(words[0], "untaught"))
    is_name = tokens[length].is_capital
    return length > 1 or is_name or any(g.match(kind, words, length) for kind in _BEHIND_VERBS)


def read(text: str) -> Text:
    """Return a text with its tokens."""
    plain = without_markup(text).replace("’", "'").replace("`", "'")
    lower = plain.lower()
    if len(lower) != len(plain):  # a letter whose lower case is longer
        plain = lower
    tokens = [
        Token(found[0], found.start(), found.end(), plain[found.start()].isupper())
        for found in _TOKEN.finditer(lower)
    ]
    tokens = list(_without_hesitation(tokens))
    return Text(plain, tokens, tuple(token.word for token in tokens))
