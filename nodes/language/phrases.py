"""A small grammar: the phrases of a sentence, without saying which belongs to which."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from semmap.nodes.language.lexicon import Lexicon
from semmap.nodes.language.words import Word

_NOMINAL = ("det", "num", "adj", "noun", "pron")


@dataclass(frozen=True, slots=True)
class Phrase:
    """A noun phrase (`np`), one with its preposition (`pp`), or a word by itself, by its part of speech."""

    kind: str
    first: int  # index of its first word
    last: int
    head: int  # index of the word that it is about
    nominal: int  # index of the first word behind the preposition
    preposition: str = ""

    @property
    def names(self) -> bool:
        """Whether it names something."""
        return self.kind in ("np", "pp")


def phrases(said: Sequence[Word], lexicon: Lexicon) -> list[Phrase]:
    """The phrases in order; every word is in exactly one."""
    found: list[Phrase] = []
    i = 0
    while i < len(said):
        nominal = i + _preposition(said, i, lexicon)
        end = _end(said, nominal, lexicon)
        if end == nominal:  # no noun follows: the word stands by itself
            found.append(Phrase(said[i].kind, i, i, i, i))
            i += 1
            continue
        preposition = " ".join(word.text for word in said[i:nominal])
        kind = "pp" if preposition else "np"
        found.append(Phrase(kind, i, end - 1, _head(said, nominal, end), nominal, preposition))
        i = end
    return found


def _preposition(said: Sequence[Word], i: int, lexicon: Lexicon) -> int:
    """How many words the preposition is long that begins here; 0 where none does."""
    for several in lexicon.prepositions:
        if tuple(word.text for word in said[i : i + len(several)]) == several:
            return len(several)
    return int(said[i].kind == "prep")


def _end(said: Sequence[Word], first: int, lexicon: Lexicon) -> int:
    """Behind the last word of the noun phrase that begins at `first`; `first` where none does."""
    i = first
    while i < len(said) and said[i].kind in _NOMINAL:
        if i > first:
            previous = said[i - 1]
            begins_anew = said[i].kind == "det" and not lexicon.is_a(previous.text, "universal")
            if begins_anew or "pron" in (said[i].kind, previous.kind):
                break
        i += 1
    return i


def _head(said: Sequence[Word], first: int, end: int) -> int:
    """The last noun, or the last word."""
    nouns = [i for i in range(first, end) if said[i].kind in ("noun", "pron")]
    return nouns[-1] if nouns else end - 1
