"""What a change of the triples does to the entities."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Set
from itertools import chain
from typing import NamedTuple

from msgspec import structs

from semmap.nodes.kb_node import preconditions
from semmap.nodes.kb_node.entities import entity_reading
from semmap.nodes.kb_node.entities.class_table import ClassTable
from semmap.nodes.kb_node.entities.fast_reading import Pattern, Patterns, read_at_sight
from semmap.nodes.kb_node.progress import steadily
from semmap.nodes.kb_node.reasoner import Change, Reasoner
from semmap.ontology import entity_triples
from semmap.ontology import vocabulary as v
from semmap.schemas import errors
from semmap.schemas.commits import Commit, Departed
from semmap.schemas.entities import Entity, Provenance
from semmap.schemas.explanations import Term

_COORDINATES = frozenset(entity_triples.COORDINATE_PROPERTIES)


class Reading(NamedTuple):
    """What entities are read with: the triples as they are after the change, classes, known patterns."""

    reasoner: Reasoner
    classes: ClassTable
    patterns: Patterns
    progress: Callable[[], None]
    """Called now and then."""


def of(
    commit: Commit,
    change: Change,
    before: Mapping[str, Entity],
    reading: Reading,
    *,
    owners: Set[Term],
    new: Set[Term],
) -> Commit:
    """`commit` with the entities that it changed and those that it removed.

    `before` are the entities by their names. `owners` are those to whose stars the commit's triples belong,
    before it or after it. Of `new` individuals it says all there is. Raises BadRequest for a star that makes
    no sense, NameTaken.
    """
    changed: dict[str, Entity] = {}
    removed: list[Departed] = []
    reasoner, classes, _, progress = reading
    provenance = commit.provenance
    at_sight, seen, unseen = _read_at_sight(change, reading, provenance)
    others = (owners - seen) | change.others | unseen
    about = entity_reading.about(reasoner, commit.inserted, others & new)
    concerned = (
        iri
        for iri in others
        if not reasoner.types(iri).isdisjoint(classes.spatial) or (iri not in new and known(before, iri))
    )
    moved = _moved_nodes(commit, change)
    for iri in steadily(sorted({*at_sight, *concerned}), progress):
        was = None if iri in new else known(before, iri)
        entity: Entity | None
        if moved and was is not None and iri not in moved:
            entity = entity_reading.moved(reasoner, was, provenance)
        else:
            entity = at_sight.get(iri) or entity_reading.read_entity(
                reasoner, classes, iri, provenance, about
            )
            if entity is not None and entity.pose is None and was is not None and not _is_said(reasoner, iri):
                entity = None  # only what is computed still speaks of it, and will not
        if entity is None:
            removed += [Departed(name=was.name, types=was.types)] if was is not None else []
            continue
        if was is not None:
            entity = entity_reading.inherit(entity, was, concerned=iri in owners)
        if (other := changed.setdefault(entity.name, entity)) is not entity:
            raise _taken(other)
    gone = {departed.name for departed in removed}
    for name, entity in changed.items():
        if name not in gone and (holder := before.get(name, entity)).iri != entity.iri:
            raise _taken(holder)
    return structs.replace(
        commit,
        changed=tuple(e for name, e in changed.items() if e != before.get(name)),
        removed=tuple(removed),
    )


def known(by_name: Mapping[str, Entity], iri: Term) -> Entity | None:
    """The entity with this IRI."""
    entity = by_name.get(v.entity_name(iri))
    return entity if entity is not None and v.iri(entity.iri) == iri else None


def _is_said(reasoner: Reasoner, iri: Term) -> bool:
    """Is anything asserted of an individual?"""
    return any(reasoner.asserted(iri)) or any(reasoner.asserted(None, None, iri))


def _moved_nodes(commit: Commit, change: Change) -> set[Term]:
    """The individuals with other coordinates, if nothing but these is otherwise; else none."""
    triples = chain(commit.retracted, commit.inserted)
    if change.alike or any(p not in _COORDINATES for _, p, _ in triples):
        return set()
    nodes = preconditions.subjects(commit.retracted, commit.inserted)
    return nodes if change.others <= nodes else set()


def _read_at_sight(
    change: Change, reading: Reading, provenance: Provenance
) -> tuple[dict[Term, Entity], set[Term], set[Term]]:
    """The new entities whose stars are of known shapes, the individuals of these stars, and of the others."""
    read: dict[Term, Entity] = {}
    seen: set[Term] = set()
    unseen: set[Term] = set()
    for alike in change.alike:
        pattern: Pattern | None = None
        for star in alike.stars():
            individuals, _ = star
            entity: Entity | None = None
            if change.others.isdisjoint(individuals):
                pattern = pattern or reading.patterns.of(alike, star, reading.reasoner, reading.classes)
                entity = read_at_sight(pattern, star, provenance, reading.classes) if pattern else None
            if entity is None:
                unseen.update(individuals[place] for place in alike.shape.touched)
            else:
                read[individuals[0]] = entity
                seen.update(individuals)
    return read, seen, unseen


def _taken(holder: Entity) -> errors.NameTaken:
    return errors.NameTaken(f"the name '{holder.name}' is taken by <{holder.iri}>")
