"""Where the entities of a map will be after a large commit, as far as that is plain before it is made."""

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
from semmap.schemas import codec
from semmap.schemas.entities import IDENTITY, Entity, Pose
from semmap.schemas.explanations import Term


class ClassModel(NamedTuple):
    """What a class says of how its entities look."""

    model: str
    place: bool


FactsByName = dict[str, tuple[About, ...]]
"""What holds of each by a rule, by name; of others nothing does."""
Numbers = tuple[float | Term | None, ...]
"""As they are wanted, or as literals; all are None of what has none of them."""


class ExpectedEntity(NamedTuple):
    """One that comes, and which of some looks it has. Its position and size are in metres."""

    iri: Term
    look: int
    position: Numbers
    orientation: Numbers | None
    size: Numbers | None


class ExpectedEntities(Struct, frozen=True, array_like=True):
    """The entities that come; whatever has no position is not among them."""

    looks: Sequence[ClassModel]
    arrivals: Sequence[ExpectedEntity]

    def __len__(self) -> int:
        return len(self.arrivals)

    def placed(self) -> Iterator[PlacedEntity]:
        """Each of them. Raises ValueError, IndexError for what is no number."""
        for iri, look, position, orientation, size in self.arrivals:
            name, (model, place) = v.entity_name(iri), self.looks[look]
            position_m, turn, size_m = map(_read, (position, orientation, size))
            yield PlacedEntity(
                name=name,
                iri=v.bare(iri),
                pose=Pose(position_m=position_m, orientation_wxyz=turn or IDENTITY),
                size_m=size_m,
                place=place,
                model=chosen(model, name, size_m),
            )


class PrecomputeRequest(Struct, frozen=True, array_like=True):
    """Who is there already and stays as it is, and who comes."""

    limits: Thresholds
    there: tuple[PlacedEntity, ...]
    coming: ExpectedEntities


class PrecomputeResult(Struct, frozen=True, array_like=True):
    """The facts of all who are there then, by rule and name."""

    mark: bytes
    """Of those of whom it was foreseen that they come."""
    facts: tuple[FactsByName, ...]

    def match(self, came: Iterable[Entity | PlacedEntity]) -> tuple[FactsByName, ...] | None:
        """The facts if it is these who came, each as it was foreseen."""
        placed = (
            one if isinstance(one, PlacedEntity) else PlacedEntity.of(one)
            for one in came
            if one.pose is not None
        )
        return self.facts if self.mark == compute_digest(placed) else None


def compute_digest(placed: Iterable[PlacedEntity]) -> bytes:
    """Differs where any of some entities is otherwise; their order does not matter."""
    in_order = sorted(placed, key=attrgetter("name"))
    return hashlib.blake2b(codec.encode(in_order), digest_size=16).digest()


def _read(numbers: Numbers | None) -> Any:
    """Floats; None of what has none."""
    if numbers is None or None in numbers:
        return None
    return tuple([float(n.split('"', 2)[1]) if isinstance(n, str) else n for n in numbers])
