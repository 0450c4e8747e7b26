"""The words and punctuation marks of a command, with their place in its text."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Final

from semmap.nodes.language.words import without_markup

_TOKEN: Final = re.compile(
    r"(?:mr|mrs|ms|dr)\.|\d{1,2}[:.]\d{2}|o'clock|[ap]\.m\.?|n't\b|'\w+|\d+(?:[.,]\d+)?"
    r"|[^\W\d_]+(?:-[^\W_]+)*(?=n't\b)|[^\W_]+(?:[-][^\W_]+)*|[,.;:!?]"
)
_HESITATION: Final = frozenset(("um", "uh", "uhm", "er", "erm", "hm", "hmm", "ehm", "oh", "ah", "eh"))
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


def _without_hesitation(tokens: list[Token]) -> Iterator[Token]:
    """Yield tokens without sounds such as *uh*, and without the commas around one."""
    sounds = [token.word in _HESITATION for token in tokens]
    for i, token in enumerate(tokens):
        is_beside = (i > 0 and sounds[i - 1]) or (i + 1 < len(tokens) and sounds[i + 1])
        if not sounds[i] and not (token.word == "," and is_beside):
            yield token


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
