"""Whose words a sentence of the system repeats: it calls things what somebody once called them."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Final

from nodes.extern.mcp.answers import who
from schemas.entities import Entity

SYSTEM: Final = "semmap"
_MOST: Final = 5


class Authors:
    """Who wrote the references of these entities."""

    def __init__(self, entities: Iterable[Entity]) -> None:
        self._by_reference: dict[str, set[str]] = {}
        for entity in entities:
            by = who(entity.reference_provenance.source, entity.reference_provenance.agent)
            for reference in (entity.preferred_reference, *entity.alternative_references):
                if reference:
                    self._by_reference.setdefault(reference.casefold(), set()).add(by)

    def by(self, *texts: str) -> str:
        """Who is behind texts of the system: `semmap`, or `semmap, quoting agent helper and file`."""
        said = [text.casefold() for text in texts if text]
        found = {
            author
            for reference, authors in self._by_reference.items()
            if any(_stands_in(reference, text) for text in said)
            for author in authors
        }
        if not found:
            return SYSTEM
        named = sorted(found)[:_MOST]
        others = ["others"] if len(found) > _MOST else []
        return f"{SYSTEM}, quoting {' and '.join([*named, *others])}"


def _stands_in(reference: str, text: str) -> bool:
    """Does it stand there as words of its own, and not as a part of longer ones?"""
    at = text.find(reference)
    while at >= 0:
        end = at + len(reference)
        if not (text[at - 1 : at].isalnum() and reference[0].isalnum()) and not (
            text[end : end + 1].isalnum() and reference[-1].isalnum()
        ):
            return True
        at = text.find(reference, at + 1)
    return False
