"""Messages between the knowledge base and the process that precomputes facts of a large commit."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Iterator, Sequence
from operator import attrgetter
from typing import Any, NamedTuple

from msgspec import Struct

from semmap.nodes.kb_node.relations.facts.rules import About
from semmap.nodes.kb_node.relations.geometry.placed_entity import PlacedEntity
from semmap.nodes.kb_node.relations.measuring.thresholds import Thresholds
from semmap.ontology import vocabulary as v
from semmap.ontology.model_choice import chosen
from semmap.ontology.model_shapes import AddedShapes, model_in_world
from semmap.schemas import codec
from semmap.schemas.entities import IDENTITY, Entity, Pose
from semmap.schemas.explanations import Term


class ClassModel(NamedTuple):
    """The model of the entities of a class, and whether they are places or fixed."""

    model: str
    place: bool
    fixed: bool = False


FactsByName = dict[str, tuple[About, ...]]
"""The facts of one rule by subject. Names without facts are missing."""
Numbers = tuple[float | Term | None, ...]
"""Numbers or literals. A None among them means that the value is missing."""


class ExpectedEntity(NamedTuple):
    """An entity that a commit adds, with an index into `classes`. Position and size in metres."""

    iri: Term
    class_index: int
    position: Numbers
    orientation: Numbers | None
    size: Numbers | None


class ExpectedEntities(Struct, frozen=True, array_like=True):
    """The entities that a commit adds, without those that have no position."""

    classes: Sequence[ClassModel]
    arrivals: Sequence[ExpectedEntity]

    def __len__(self) -> int:
        return len(self.arrivals)

    def placed(self) -> Iterator[PlacedEntity]:
        """Yield each entity. Raises ValueError or IndexError for an invalid number."""
        for iri, class_index, position, orientation, size in self.arrivals:
            name, (model, place, fixed) = v.entity_name(iri), self.classes[class_index]
            position_m, turn, size_m = map(_read, (position, orientation, size))
            yield PlacedEntity(
                name=name,
                iri=v.bare(iri),
                pose=Pose(position_m=position_m, orientation_wxyz=turn or IDENTITY),
                size_m=size_m,
                place=place,
                model=model if place else model_in_world(name, chosen(model, name, size_m), size_m),
                fixed=fixed,
            )


class PrecomputeRequest(Struct, frozen=True, array_like=True):
    """The entities that stay as they are, and those that are added."""

    limits: Thresholds
    there: tuple[PlacedEntity, ...]
    coming: ExpectedEntities
    shapes: AddedShapes = AddedShapes()


class PrecomputeResult(Struct, frozen=True, array_like=True):
    """The facts of all these entities, by rule and name."""

    mark: bytes
    """The digest of the expected entities."""
    facts: tuple[FactsByName, ...]

    def match(self, added: Iterable[Entity | PlacedEntity]) -> tuple[FactsByName, ...] | None:
        """Return the facts if exactly the expected entities were added, else None."""
        placed = (
            one if isinstance(one, PlacedEntity) else PlacedEntity.of(one)
            for one in added
            if one.pose is not None
        )
        return self.facts if self.mark == compute_digest(placed) else None


def compute_digest(placed: Iterable[PlacedEntity]) -> bytes:
    """Return a digest of entities that does not depend on their order."""
    in_order = sorted(placed, key=attrgetter("name"))
    return hashlib.blake2b(codec.encode(in_order), digest_size=16).digest()


def _read(numbers: Numbers | None) -> Any:
    """Return floats, or None if a value is missing."""
    if numbers is None or None in numbers:
        return None
    return tuple([float(n.split('"', 2)[1]) if isinstance(n, str) else n for n in numbers])
