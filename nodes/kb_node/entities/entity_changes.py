"""The effects of changed triples on entities."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Set
from itertools import chain
from typing import NamedTuple

from msgspec import structs

from semmap.nodes.kb_node import preconditions
from semmap.nodes.kb_node.entities import entity_reading, equal_individuals
from semmap.nodes.kb_node.entities.class_table import ClassTable
from semmap.nodes.kb_node.entities.fast_reading import Pattern, Patterns, read_regular
from semmap.nodes.kb_node.progress import with_progress
from semmap.nodes.kb_node.reasoner import Change, Reasoner
from semmap.ontology import entity_triples
from semmap.ontology import vocabulary as v
from semmap.schemas import errors, wording
from semmap.schemas.commits import Commit, Departed
from semmap.schemas.entities import Entity, Provenance
from semmap.schemas.explanations import Term

_COORDINATES = frozenset(entity_triples.COORDINATE_PROPERTIES)


class Reading(NamedTuple):
    """The input for reading entities: the triples after the change, the classes and the known patterns."""

    reasoner: Reasoner
    classes: ClassTable
    patterns: Patterns
    progress: Callable[[], None]
    """Called now and then."""
    strict: bool = False
    """Whether several poses or sizes of an entity are an error. Older maps may have such entities."""
    is_new: bool = False
    """Whether the commit is new. Then individuals that become equal must not have different poses."""


def add_effects(
    commit: Commit,
    change: Change,
    before: Mapping[str, Entity],
    reading: Reading,
    *,
    owners: Set[Term],
    new: Set[Term],
) -> Commit:
    """Return `commit` with its changed and removed entities.

    `before` are the entities by name. `owners` are the individuals that the commit's triples describe, before
    or after it. The commit contains all triples about `new` individuals. Raises NameTaken, and BadRequest for
    an invalid entity, also one with several poses or sizes if the reading is strict.
    """
    changed: dict[str, Entity] = {}
    removed: list[Departed] = []
    reasoner, classes, _, progress, strict, _ = reading
    provenance = commit.provenance
    at_sight, seen, unseen = _read_regular(change, reading, provenance)
    others = equal_individuals.with_equals(reasoner, (owners - seen) | change.others | unseen)
    about = entity_reading.about(reasoner, commit.inserted, others & new)
    concerned = (
        iri
        for iri in others
        if not reasoner.types(iri).isdisjoint(classes.spatial) or (iri not in new and known(before, iri))
    )
    moved = _moved_nodes(commit, change)
    for iri in with_progress(sorted({*at_sight, *concerned}), progress):
        was = None if iri in new else known(before, iri)
        entity: Entity | None
        if strict and iri not in at_sight:
            entity_reading.require_one_place(about, classes, iri)
        if moved and was is not None and iri not in moved:
            entity = entity_reading.read_moved(reasoner, was, provenance)
        else:
            entity = at_sight.get(iri) or entity_reading.read_entity(
                reasoner, classes, iri, provenance, about
            )
            if (
                entity is not None
                and entity.pose is None
                and was is not None
                and not _is_asserted(reasoner, iri)
            ):
                entity = None  # only computed facts still mention it, and they will be removed
        if (
            entity is not None
            and entity.other_names
            and (strict or _is_regrouped(entity, was))
            and reading.is_new
        ):
            merged = equal_individuals.about_entity(reasoner, iri, about)
            name = f"{entity.name} (the same as {wording.few(entity.other_names)})"
            entity_reading.require_one_place(merged, classes, iri, name)
        if entity is None:
            removed += [Departed(name=was.name, types=was.types)] if was is not None else []
            continue
        if was is not None and was.name != entity.name:
            removed.append(Departed(name=was.name, types=was.types))
        if was is not None:
            is_concerned = not owners.isdisjoint(reasoner.equals(iri) or (iri,))
            entity = entity_reading.inherit_provenance(entity, was, concerned=is_concerned)
        if (other := changed.setdefault(entity.name, entity)) is not entity:
            raise _name_taken(other, entity)
    notes = tuple(_equality_notes(changed.values(), before, removed))
    removed_names = {departed.name for departed in removed}
    for name, entity in changed.items():
        if name not in removed_names and (holder := before.get(name, entity)).iri != entity.iri:
            raise _name_taken(holder, entity)
    return structs.replace(
        commit,
        changed=tuple(e for name, e in changed.items() if e != before.get(name)),
        removed=tuple(removed),
        notes=(*commit.notes, *(note for note in notes if note not in commit.notes)),
    )


def known(by_name: Mapping[str, Entity], iri: Term) -> Entity | None:
    """Return the entity with this IRI, or None."""
    entity = by_name.get(v.entity_name(iri))
    return entity if entity is not None and v.iri(entity.iri) == iri else None


def _equality_notes(
    changed: Iterable[Entity], before: Mapping[str, Entity], removed: Iterable[Departed]
) -> Iterator[str]:
    """Yield a note on each entity that is now another one, too."""
    gone = {departed.name for departed in removed}
    for entity in changed:
        if entity.other_names and (merged := gone.intersection(entity.other_names)):
            yield (
                f"{entity.name} and {wording.few(sorted(merged))} are the same individual:"
                f" one entity, {entity.name}, which all these names refer to"
            )


def _is_regrouped(entity: Entity, was: Entity | None) -> bool:
    """Return whether an entity has other names than before."""
    return was is None or was.other_names != entity.other_names


def _is_asserted(reasoner: Reasoner, iri: Term) -> bool:
    """Return whether anything is asserted about an individual."""
    return any(reasoner.asserted(iri)) or any(reasoner.asserted(None, None, iri))


def _moved_nodes(commit: Commit, change: Change) -> set[Term]:
    """Return the individuals with changed coordinates if nothing else has changed, or an empty set."""
    triples = chain(commit.retracted, commit.inserted)
    if change.alike or any(p not in _COORDINATES for _, p, _ in triples):
        return set()
    nodes = preconditions.subjects(commit.retracted, commit.inserted)
    return nodes if change.others <= nodes else set()


def _read_regular(
    change: Change, reading: Reading, provenance: Provenance
) -> tuple[dict[Term, Entity], set[Term], set[Term]]:
    """Return new entities of known patterns, the individuals read with them, and the other individuals."""
    read: dict[Term, Entity] = {}
    seen: set[Term] = set()
    unseen: set[Term] = set()
    for alike in change.alike:
        pattern: Pattern | None = None
        for star in alike.rows():
            individuals, _ = star
            entity: Entity | None = None
            if change.others.isdisjoint(individuals):
                pattern = pattern or reading.patterns.of(alike, star, reading.reasoner, reading.classes)
                entity = read_regular(pattern, star, provenance, reading.classes) if pattern else None
            if entity is None:
                unseen.update(individuals[place] for place in alike.shape.touched)
            else:
                read[individuals[0]] = entity
                seen.update(individuals)
    return read, seen, unseen


def _name_taken(holder: Entity, other: Entity) -> errors.NameTaken:
    return errors.NameTaken(
        f"the name '{holder.name}' of <{other.iri}> is also that of <{holder.iri}>, and names are unique;"
        f" give <{other.iri}> another last part"
    )
