"""The changes of commits, from old to new values. Commits of older versions are supported."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable, Iterable, Mapping

from msgspec import structs

from semmap.nodes.kb_node.entities.property_table import STRUCTURAL
from semmap.nodes.kb_node.entities.property_values import to_json_value
from semmap.nodes.kb_node.storage.journal import Journal
from semmap.ontology import vocabulary as v
from semmap.ontology.entity_triples import find_renamed
from semmap.schemas.changes import Change, between, of_properties, removed
from semmap.schemas.commits import Commit
from semmap.schemas.entities import Entity, Stated
from semmap.schemas.explanations import Term

FEW = 20
"""Entities of a commit that are listed."""
_KEPT = 4


class Changelog:
    """A reader of the changes of successive commits, which remembers the entities it has read."""

    def __init__(self, journal: Journal, first: Callable[[], Mapping[str, Entity]]) -> None:
        """`first()` returns the entities before commit 1."""
        self._journal = journal
        self._first = first
        self._known: dict[str, Entity | None] = {}
        self._commits: OrderedDict[int, dict[str, Entity]] = OrderedDict()

    def of(self, commit: Commit, only: str | None = None) -> tuple[Change, ...]:
        """Return the changes of the first entities that `commit` touched, or of `only` one."""
        changes: list[Change] = []
        renamed = find_renamed(commit)
        earlier = {v.entity_name(now): v.entity_name(was) for now, was in renamed.items()}
        stated = _collect_changes(commit, {was: now for now, was in renamed.items()})
        changed = [e for e in commit.changed if only in (None, e.name, earlier.get(e.name))]
        for entity in sorted(changed, key=lambda e: e.name not in earlier)[:FEW]:
            was = self._before(earlier.get(entity.name, entity.name), commit.seq)
            if was is None:
                changes += between(None, entity)
            else:
                changes += between(_without_properties(was), _without_properties(entity))
                properties = stated.get(v.iri(entity.iri), ())
                changes += of_properties(
                    entity.name, (_complete_values(*one, was, entity) for one in properties)
                )
            self._known[entity.name] = entity
        for gone in commit.removed:
            self._known[gone.name] = None
            if gone.name in earlier.values():
                continue
            if only in (None, gone.name) and len(changes) < FEW:
                changes.append(removed(gone.name, gone.types[0] if gone.types else ""))
        return tuple(changes)

    def _before(self, name: str, seq: int) -> Entity | None:
        """Return an entity as it was before commit `seq`."""
        if name in self._known:
            return self._known[name]
        touching = self._journal.touching(name, until=seq - 1)
        return self._after(touching[-1]).get(name) if touching else self._first().get(name)

    def _after(self, seq: int) -> dict[str, Entity]:
        """Return the entities that a commit changed.

        A few commits are cached, because a load changes many.
        """
        if seq not in self._commits:
            self._commits[seq] = {entity.name: entity for entity in self._journal.commit(seq).changed}
            if len(self._commits) > _KEPT:
                self._commits.popitem(last=False)
        self._commits.move_to_end(seq)
        return self._commits[seq]


def _without_properties(entity: Entity) -> Entity:
    """Return an entity without properties, which older commits lack. Their triples are used instead."""
    return structs.replace(entity, properties={})


def _collect_changes(
    commit: Commit, renamed: Mapping[Term, Term]
) -> dict[Term, list[tuple[str, Stated | None, Stated | None]]]:
    """Return the properties of each individual, with old and new values.

    `renamed` has the present IRIs of renamed entities by their earlier ones.
    """
    if len(commit.retracted) + len(commit.inserted) > FEW * 50:
        return {}
    found: dict[tuple[Term, Term], tuple[list[Term], list[Term]]] = {}
    for i, triples in enumerate((commit.retracted, commit.inserted)):
        for s, p, o in triples:
            if p not in STRUCTURAL:
                found.setdefault((renamed.get(s, s), p), ([], []))[i].append(o)
    found_changes: dict[Term, list[tuple[str, Stated | None, Stated | None]]] = {}
    for (s, p), (gone, come) in sorted(found.items()):
        found_changes.setdefault(s, []).append((v.local_name(p), _values(gone), _values(come)))
    return found_changes


def _complete_values(
    name: str, gone: Stated | None, come: Stated | None, was: Entity, now: Entity
) -> tuple[str, Stated | None, Stated | None]:
    """Return a property with all its old and new values if they are known, else the changed ones."""
    matching = {known for known in (*was.properties, *now.properties) if known.rpartition(":")[2] == name}
    if len(matching) == 1:  # with its prefix, if others have the same name
        name = matching.pop()
    before, after = was.properties.get(name), now.properties.get(name)
    if isinstance(before, tuple) or isinstance(after, tuple):
        return name, before, after
    return name, gone, come


def _values(terms: Iterable[Term]) -> Stated | None:
    values = tuple(map(to_json_value, sorted(terms)))
    return values[0] if len(values) == 1 else values or None
