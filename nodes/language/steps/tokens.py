"""The words and punctuation marks of a command, with their place in its text."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

from semmap.nodes.language.words import without_markup

_TOKEN: Final = re.compile(
    r"(?:mr|mrs|ms|dr)\.|\d{1,2}[:.]\d{2}|o'clock|[ap]\.m\.?|n't\b|'\w+|\d+(?:[.,]\d+)?"
    r"|[^\W\d_]+(?:-[^\W_]+)*(?=n't\b)|[^\W_]+(?:[-][^\W_]+)*|[,.;:!?]"
)
_PUNCTUATION: Final = frozenset(",.;:!?")


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
    return Text(plain, tokens, tuple(token.word for token in tokens))
