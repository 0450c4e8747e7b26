"""The authors of labels that a message of the system quotes."""

from __future__ import annotations

import re
from collections.abc import Iterable
from typing import Final

from semmap.nodes.extern.mcp.answers import format_author
from semmap.schemas.entities import Entity

SYSTEM: Final = "semmap"
_MOST: Final = 5
_WORD: Final = re.compile(r"\w+|[^\w\s]")
_Words = tuple[str, ...]


class Authors:
    """The authors of the labels of these entities."""

    def __init__(self, entities: Iterable[Entity]) -> None:
        self._by_words: dict[_Words, set[str]] = {}
        self._beginning: dict[str, set[_Words]] = {}  # labels (as words), by their first word
        for entity in entities:
            by = format_author(entity.reference_provenance.source, entity.reference_provenance.agent)
            for reference in (entity.preferred_reference, *entity.alternative_references):
                if words := _words(reference or ""):
                    self._by_words.setdefault(words, set()).add(by)
                    self._beginning.setdefault(words[0], set()).add(words)

    def by(self, *texts: str) -> str:
        """Return the author of texts of the system: `semmap`, or `semmap, quoting agent helper and file`."""
        found: set[str] = set()
        for text in texts:
            words = _words(text)
            for start, word in enumerate(words):
                for reference in self._beginning.get(word, ()):
                    if words[start : start + len(reference)] == reference:
                        found |= self._by_words[reference]
        if not found:
            return SYSTEM
        named = sorted(found)[:_MOST]
        others = ["others"] if len(found) > _MOST else []
        return f"{SYSTEM}, quoting {' and '.join([*named, *others])}"


def _words(text: str) -> _Words:
    """Return the words and punctuation marks, in lower case."""
    return tuple(_WORD.findall(text.casefold()))
