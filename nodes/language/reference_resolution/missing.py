"""Descriptions that no current entity matches, to be searched for in the map's history."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

from semmap.nodes.language.reference_resolution.description import Quality, Related
from semmap.nodes.language.reference_resolution.map_index import Item, Nouns
from semmap.nodes.language.reference_resolution.resolution import Answer
from semmap.nodes.language.reference_resolution.resolver import Resolved, Resolver
from semmap.schemas.map_history import KeptRelation

_MOST: Final = 3
"""The maximum number of subjects, and of related objects for each, that are searched for."""


@dataclass(frozen=True, slots=True)
class Missing:
    """A noun with its qualities that no entity matches now, and relations that may have held earlier.

    `pairs` are existing entities with a relation that does not hold between them now.
    """

    nouns: Nouns
    key: str
    qualities: tuple[Quality, ...] = ()
    pairs: tuple[tuple[str, KeptRelation, str], ...] = ()

    def is_such(self, item: Item) -> bool:
        """Return whether an entity, in its earlier state, matches the description."""
        names = self.nouns.classes.get(self.key, set())
        if names.isdisjoint(item.types) and not any(
            self.key in self.nouns.keys(reference) for reference in item.references
        ):
            return False
        return all(not quality.values.isdisjoint(item.all_values) for quality in self.qualities)


def missing(answer: Answer) -> Missing | None:
    """Return what to search for in the history if nothing matches; None if the description has no noun."""
    if answer.outcome != "none":
        return None
    part = next((part for part in answer.parts if not part.names), None)
    if part is None or part.description.head != "noun":
        return None
    nouns = answer.resolver.index.nouns[answer.resolver.language]
    description = part.description
    qualities = tuple(r for r in description.restrictions if isinstance(r, Quality))
    return Missing(nouns, description.key, qualities, tuple(_pairs(part, answer.resolver)))


def _pairs(part: Resolved, resolver: Resolver) -> Iterator[tuple[str, KeptRelation, str]]:
    """Yield the entities of the described kind with each relation that the description requires."""
    for restriction in part.description.restrictions:
        if isinstance(restriction, Related) and restriction.relation in ("isOn", "isInside"):
            support: KeptRelation = "isOn" if restriction.relation == "isOn" else "isInside"
            others = resolver.resolve(restriction.others[0]).names[:_MOST]
            for name in part.kind[:_MOST]:
                for other in others:
                    is_place = resolver.index.items[other].is_place
                    yield name, "isLocatedIn" if is_place else support, other
