"""What was described and is not there, to be looked for in the past."""

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
"""Things of a kind, and others of each, whose pairs are looked for."""


@dataclass(frozen=True, slots=True)
class Missing:
    """A noun with its qualities that nothing fits now, and relations that held, perhaps, once.

    pairs: a thing that is there, a relation, and what it is not in that relation to.
    """

    nouns: Nouns
    key: str
    qualities: tuple[Quality, ...] = ()
    pairs: tuple[tuple[str, KeptRelation, str], ...] = ()

    def is_such(self, item: Item) -> bool:
        """Whether an entity that was there, as it was then, is one of those that were described."""
        names = self.nouns.classes.get(self.key, set())
        if names.isdisjoint(item.types) and not any(
            self.key in self.nouns.keys(reference) for reference in item.references
        ):
            return False
        return all(not quality.values.isdisjoint(item.all_values) for quality in self.qualities)


def missing(answer: Answer) -> Missing | None:
    """What to look for in the past where nothing fits; None where that is nothing by name."""
    if answer.outcome != "none":
        return None
    part = next((part for part in answer.parts if not part.names), None)
    if part is None or part.description.head != "noun":
        return None
    nouns = answer.resolver.known.nouns[answer.resolver.language]
    said = part.description
    qualities = tuple(r for r in said.restrictions if isinstance(r, Quality))
    return Missing(nouns, said.key, qualities, tuple(_pairs(part, answer.resolver)))


def _pairs(part: Resolved, resolver: Resolver) -> Iterator[tuple[str, KeptRelation, str]]:
    """Of what is there and not where it was said to be: those and where that is."""
    for restriction in part.description.restrictions:
        if isinstance(restriction, Related) and restriction.relation in ("isOn", "isInside"):
            borne: KeptRelation = "isOn" if restriction.relation == "isOn" else "isInside"
            others = resolver.resolve(restriction.others[0]).names[:_MOST]
            for name in part.kind[:_MOST]:
                for other in others:
                    is_place = resolver.known.items[other].is_place
                    yield name, "isLocatedIn" if is_place else borne, other
