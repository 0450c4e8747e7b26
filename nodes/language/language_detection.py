"""Language detection by the words of the lexicons."""

from __future__ import annotations

import functools

from semmap.nodes.language import lexicon
from semmap.nodes.language.understanding import italian
from semmap.nodes.language.words import is_verb, lemma, split
from semmap.schemas.language import Language


def detect_language(text: str) -> Language:
    """Return the language whose lexicon has more of a text's words, English if they are equal."""
    return "italian" if italian.share(text) > _english(text) else "english"


def _english(text: str) -> int:
    """Return the number of words of a text that are in the English lexicon."""
    known = lexicon.load()
    return sum(
        word in _listed() or lemma(word, known) in _listed() or is_verb(word, known) for word in split(text)
    )


@functools.cache
def _listed() -> frozenset[str]:
    known = lexicon.load()
    return frozenset().union(*known.classes.values(), known.irregular)
