"""The core of the knowledge base: one transaction in, one checked and durable commit out."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Iterator, Mapping

from msgspec import structs

from nodes.kb_node import entities
from nodes.kb_node.classes import ClassTable
from nodes.kb_node.journal import Checkpoint, Journal, Marks
from nodes.kb_node.reasoner import Inconsistent, Reasoner
from ontology import stars
from ontology import vocabulary as v
from schemas import errors
from schemas.commits import Commit, Departed, Snapshot, Star, Transaction
from schemas.entities import ClassInfo, Entity, Provenance
from schemas.explanations import Term, Triple

CHECKPOINT_EVERY = 5000
_UNMARKED = Marks(any=0, pose=0, shape=0)
_UNKNOWN = Provenance(commit=0, stamp_ns=0, source="file")


class SemanticMap:
    """The ABox with its TBox: checked, explained, durable. Owned by one thread."""

    def __init__(
        self, journal: Journal, tbox: Iterable[Triple], *, progress: Callable[[], None] = lambda: None
    ) -> None:
        """Rebuild the map from `journal`. Raises Refused when the journal is damaged."""
        self._journal = journal
        self.tbox = frozenset(tbox)
        self.reasoner = Reasoner(self.tbox)
        self.classes = ClassTable(self.reasoner)
        self._provenance: dict[int, Provenance] = {0: _UNKNOWN}
        self._marks: dict[Term, Marks] = {}
        self._entities: dict[str, Entity] = {}
        self.seq = 0
        self._replay(progress)

    # Asking

    def __len__(self) -> int:
        return len(self._entities)

    def entity(self, name: str) -> Entity:
        """The entity of that name. Raises UnknownName with the nearest ones."""
        if name in self._entities:
            return self._entities[name]
        raise errors.UnknownName(f"no entity is named '{name}'{errors.did_you_mean(name, self._entities)}")

    def entities(self, class_iri: Term | None = None) -> Iterator[Entity]:
        """The entities, or those of a class by inference, in the order of their names."""
        if class_iri is None:
            return (self._entities[name] for name in sorted(self._entities))
        names = {v.local_name(i) for i in self.reasoner.instances(class_iri)} & self._entities.keys()
        return (self._entities[name] for name in sorted(names))

    def snapshot(self) -> Snapshot:
        """Every entity, as of the last commit."""
        return Snapshot(seq=self.seq, entities=tuple(self.entities()))

    def stars(self, names: Iterable[str]) -> tuple[Star, ...]:
        """The triples about some entities, taken together. Raises UnknownName."""
        iris = [v.iri(self.entity(name).iri) for name in names]
        return tuple(entities.read_star(self.reasoner, iri, self.seq, frozenset(iris)) for iri in iris)

    def class_table(self) -> Iterator[ClassInfo]:
        """The classes with the number of entities of each, asserted and inferred."""
        asserted: dict[str, int] = {}
        inferred: dict[str, int] = {}
        for entity in self._entities.values():
            asserted[entity.class_] = asserted.get(entity.class_, 0) + 1
            for name in entity.types:
                inferred[name] = inferred.get(name, 0) + 1
        return (
            structs.replace(row, asserted=asserted.get(row.name, 0), inferred=inferred.get(row.name, 0))
            for row in self.classes.rows
        )

    def abox(self) -> list[Triple]:
        """The asserted triples that are not the TBox's."""
        return [t for t in self.reasoner.asserted() if t not in self.tbox]

    def inferred(self, name: str | None = None) -> Iterator[Triple]:
        """What follows and was not said, about one entity or all. Raises UnknownName."""
        for entity in [self.entity(name)] if name is not None else self.entities():
            yield from sorted(self.reasoner.inferred(v.iri(entity.iri), None, None))

    def has(self, triple: Triple) -> bool:
        """Is it asserted?"""
        return any(True for _ in self.reasoner.asserted(*triple))

    # Changing

    def commit(self, transaction: Transaction) -> Commit | None:
        """Apply, check and make durable; None when it changes nothing. On any error the map is as before.

        Raises PreconditionFailed, NameTaken, Inconsistent (with the explanation), BadRequest for a star that
        does not make sense, Refused when the disk does not take the commit.
        """
        if (known := self._journal.commit_of(transaction.id)) is not None:
            return known
        self._require(transaction)
        wanted = dict.fromkeys(transaction.insert)
        retracted = tuple(t for t in dict.fromkeys(transaction.retract) if t not in wanted and self.has(t))
        inserted = tuple(t for t in wanted if not self.has(t))
        if not retracted and not inserted:
            return None
        commit = Commit(
            seq=self.seq + 1,
            stamp_ns=time.time_ns(),
            id=transaction.id,
            source=transaction.source,
            agent=transaction.agent,
            reason=transaction.reason,
            confidence=transaction.confidence,
            retracted=retracted,
            inserted=inserted,
        )
        changed, removed = self._apply(commit, self._journal.append)
        if commit.seq % CHECKPOINT_EVERY == 0:
            self.checkpoint()
        return structs.replace(commit, changed=changed, removed=removed)

    def checkpoint(self) -> None:
        """Write down the whole map, so that the next start need not replay its history."""
        named = {seq for marks in self._marks.values() for seq in (marks.any, marks.pose, marks.shape)}
        provenance = {seq: self._provenance[seq] for seq in named}
        self._journal.checkpoint(
            Checkpoint(seq=self.seq, triples=tuple(self.abox()), marks=self._marks, commits=provenance)
        )

    def _require(self, transaction: Transaction) -> None:
        for triple in transaction.require:
            if not self.has(triple):
                raise errors.PreconditionFailed(f"it no longer holds that {v.spoken(triple)}; ask again")
        for term in transaction.vacant:
            if any(True for _ in self.reasoner.asserted(term, None, None)):
                raise errors.NameTaken(f"the name '{v.local_name(term)}' is taken")

    def _replay(self, progress: Callable[[], None]) -> None:
        start = self._journal.last_checkpoint()
        self.reasoner.apply(insert=start.triples)
        self.seq = start.seq
        self._provenance.update(start.commits)
        self._show({iri: self._read(iri, marks) for iri, marks in start.marks.items()}, start.marks)
        for commit in self._journal.commits(after=start.seq):
            self._apply(commit, lambda _: None)
            progress()

    def _apply(
        self, commit: Commit, make_durable: Callable[[Commit], None]
    ) -> tuple[tuple[Entity, ...], tuple[Departed, ...]]:
        """Change the triples, check them, make the commit durable, and only then let the entities show it."""
        aspects = self._aspects(commit)
        try:
            change = self.reasoner.apply(delete=commit.retracted, insert=commit.inserted)
        except Inconsistent as error:
            raise errors.Inconsistent(error.explanation.text, explanation=error.explanation) from None
        try:
            for iri, aspect in self._aspects(commit).items():
                aspects.setdefault(iri, set()).update(aspect)
            self._provenance[commit.seq] = _provenance_of(commit)
            marks = {iri: self._marked(iri, aspect, commit.seq) for iri, aspect in aspects.items()}
            touched = {
                iri: marks.get(iri) or self._marks.get(iri, _UNMARKED) for iri in {*aspects, *change.touched}
            }
            states = {iri: self._read(iri, marks) for iri, marks in touched.items()}
            self._require_unique_names(states)
            make_durable(commit)
        except BaseException:
            self._provenance.pop(commit.seq, None)
            self.reasoner.apply(delete=commit.inserted, insert=commit.retracted)
            raise
        self.seq = commit.seq
        return self._show(states, touched)

    def _aspects(self, commit: Commit) -> dict[Term, set[str]]:
        """Whose star the commit's triples belong to, and whether pose or shape is concerned."""
        found: dict[Term, set[str]] = {}
        owners: dict[Term, list[Term]] = {}
        for s, p, _ in (*commit.retracted, *commit.inserted):
            if s not in owners:
                owners[s] = list(entities.owners(self.reasoner, s))
            for owner in owners[s]:
                aspects = found.setdefault(owner, set())
                if p in stars.POSE_PROPERTIES:
                    aspects.add("pose")
                elif p in stars.SHAPE_PROPERTIES and (p != v.RDF_TYPE or owner == s):
                    aspects.add("shape")
        return found

    def _marked(self, iri: Term, aspects: set[str], seq: int) -> Marks:
        old = self._marks.get(iri)
        if old is None:
            return Marks(any=seq, pose=seq, shape=seq)
        return Marks(
            any=seq,
            pose=seq if "pose" in aspects else old.pose,
            shape=seq if "shape" in aspects else old.shape,
        )

    def _read(self, iri: Term, marks: Marks) -> Entity | None:
        """The entity as the triples have it now, or None if `iri` is none."""
        if self.classes.spatial.isdisjoint(self.reasoner.types(iri)):
            return None
        if not entities.is_valid_name(iri):
            raise errors.BadRequest(
                f"{iri} cannot be an entity: it needs an IRI that ends in a name of letters, digits, '_', '.'"
                " and '-', not beginning with a digit"
            )
        return entities.read_entity(self.reasoner, self.classes, iri, marks, self._provenance)

    def _require_unique_names(self, states: Mapping[Term, Entity | None]) -> None:
        new: dict[str, str] = {}
        for entity in filter(None, states.values()):
            known = self._entities.get(entity.name)
            other = known.iri if known is not None else new.setdefault(entity.name, entity.iri)
            if other != entity.iri and states.get(v.iri(other), known) is not None:
                raise errors.NameTaken(f"the name '{entity.name}' is taken by <{other}>")

    def _show(
        self, states: Mapping[Term, Entity | None], marks: Mapping[Term, Marks]
    ) -> tuple[tuple[Entity, ...], tuple[Departed, ...]]:
        changed, removed = [], []
        for iri, entity in sorted(states.items()):
            known = self._entities.get(v.local_name(iri))
            if entity is not None:
                self._entities[entity.name] = entity
                self._marks[iri] = marks[iri]
                changed.append(entity)
            elif known is not None and v.iri(known.iri) == iri:
                del self._entities[known.name], self._marks[iri]
                removed.append(Departed(name=known.name, types=known.types))
        return tuple(changed), tuple(removed)


def _provenance_of(commit: Commit) -> Provenance:
    return Provenance(
        commit=commit.seq,
        stamp_ns=commit.stamp_ns,
        source=commit.source,
        agent=commit.agent,
        reason=commit.reason,
        confidence=commit.confidence,
    )
