"""An index of the parts of entities, and of parts of parts, by the properties of several ontologies."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from typing import Final

_OF_PARTS: Final = re.compile(r"is\w*(Part|Component|Constituent)Of")
"""Properties of a part, whose value is the whole, by their local names."""
_OF_WHOLES: Final = re.compile(r"has\w*(Part|Component|Constituent|Element)s?|\w*[pP]arts")
"""Properties of a whole, whose values are its parts."""
_MOST: Final = 1000
"""Wholes of one part, beyond which the search ends."""


class PartIndex:
    """The wholes of parts, updated entity by entity."""

    def __init__(self) -> None:
        self._stated: dict[str, list[tuple[str, str]]] = {}
        """By entity: the pairs of a part and a whole that its properties state."""
        self._wholes: dict[str, dict[str, int]] = {}
        """By part: its direct wholes, with the number of statements."""

    def add(self, name: str, values: Mapping[str, frozenset[object]]) -> None:
        """Add what the properties of an entity state."""
        if pairs := list(_find_pairs(name, values)):
            self._stated[name] = pairs
            for part, whole in pairs:
                wholes = self._wholes.setdefault(part, {})
                wholes[whole] = wholes.get(whole, 0) + 1

    def remove(self, name: str) -> None:
        """Remove what the properties of an entity stated."""
        for part, whole in self._stated.pop(name, ()):
            wholes = self._wholes[part]
            wholes[whole] -= 1
            if not wholes[whole]:
                del wholes[whole]
            if not wholes:
                del self._wholes[part]

    def is_part(self, part: str, whole: str) -> bool:
        """Return whether an entity is a part of another, or a part of such a part."""
        seen = {part}
        pending = [part]
        while pending and len(seen) < _MOST:
            direct = self._wholes.get(pending.pop(), {})
            if whole in direct:
                return True
            new = direct.keys() - seen
            seen |= new
            pending += new
        return False


def _find_pairs(name: str, values: Mapping[str, frozenset[object]]) -> Iterator[tuple[str, str]]:
    """Yield the pairs of a part and a whole that the properties of an entity state."""
    for prop, objects in values.items():
        local = prop.rpartition(":")[2]
        if _OF_PARTS.fullmatch(local):
            yield from ((name, other) for other in objects if isinstance(other, str))
        elif _OF_WHOLES.fullmatch(local):
            yield from ((other, name) for other in objects if isinstance(other, str))
