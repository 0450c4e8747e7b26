"""Chunking: the phrases of a sentence, without attachment."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from semmap.nodes.language.lexicon import Lexicon
from semmap.nodes.language.words import Word

_NOMINAL = ("det", "num", "adj", "noun", "pron")


@dataclass(frozen=True, slots=True)
class Phrase:
    """A noun phrase (`np`), a prepositional phrase (`pp`), or a single word, by its part of speech."""

    kind: str
    first: int  # index of its first word
    last: int
    head: int  # index of the head
    nominal: int  # index of the first word after the preposition
    preposition: str = ""

    @property
    def names(self) -> bool:
        """Whether it is a noun phrase, with or without a preposition."""
        return self.kind in ("np", "pp")


def phrases(words: Sequence[Word], lexicon: Lexicon) -> list[Phrase]:
    """Return the phrases in order; every word is in exactly one."""
    found: list[Phrase] = []
    i = 0
    while i < len(words):
        nominal = i + _preposition(words, i, lexicon)
        end = _end(words, nominal, lexicon)
        if end == nominal:  # no noun follows: a phrase of one word
            found.append(Phrase(words[i].kind, i, i, i, i))
            i += 1
            continue
        preposition = " ".join(word.text for word in words[i:nominal])
        kind = "pp" if preposition else "np"
        found.append(Phrase(kind, i, end - 1, _head(words, nominal, end), nominal, preposition))
        i = end
    return found


def _preposition(words: Sequence[Word], i: int, lexicon: Lexicon) -> int:
    """Return the number of words of the preposition that begins at i, or 0."""
    for several in lexicon.prepositions:
        if tuple(word.text for word in words[i : i + len(several)]) == several:
            return len(several)
    return int(words[i].kind == "prep")


def _end(words: Sequence[Word], first: int, lexicon: Lexicon) -> int:
    """Return the index after the noun phrase that begins at `first`, or `first` if none does."""
    i = first
    while i < len(words) and words[i].kind in _NOMINAL:
        if i > first:
            previous = words[i - 1]
            begins_phrase = words[i].kind == "det" and not lexicon.is_a(previous.text, "universal")
            if begins_phrase or "pron" in (words[i].kind, previous.kind):
                break
        i += 1
    return i


def _head(words: Sequence[Word], first: int, end: int) -> int:
    """Return the index of the last noun, or of the last word."""
    nouns = [i for i in range(first, end) if words[i].kind in ("noun", "pron")]
    return nouns[-1] if nouns else end - 1
