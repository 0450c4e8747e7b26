"""The core of the knowledge base: one transaction in, one checked and durable commit out."""

from __future__ import annotations

import time
from collections.abc import Callable, Container, Iterable, Iterator, Sequence

from msgspec import structs

from nodes.kb_node import entities
from nodes.kb_node.classes import ClassTable
from nodes.kb_node.journal import Checkpoint, Journal, Marks
from nodes.kb_node.reasoner import Inconsistent, Reasoner
from ontology import vocabulary as v
from schemas import errors
from schemas.commits import Commit, Departed, Snapshot, Star, Transaction
from schemas.entities import ClassInfo, Entity, Provenance
from schemas.explanations import Term, Triple

CHECKPOINT_EVERY = 5000
_OF_THE_TBOX = Provenance(commit=0, stamp_ns=0, source="file", reason="the TBox says so")


class SemanticMap:
    """The ABox with its TBox: checked, explained, durable. Owned by one thread."""

    def __init__(
        self,
        journal: Journal,
        tbox: Iterable[Triple],
        *,
        reasoner: Reasoner | None = None,
        progress: Callable[[], None] = lambda: None,
    ) -> None:
        """Rebuild the map from `journal`; `reasoner` is one that holds the TBox and no more, if there is one.

        Raises Refused when the journal is damaged.
        """
        self._journal = journal
        self.tbox = frozenset(tbox)
        self.reasoner = reasoner or Reasoner(self.tbox)
        self.classes = ClassTable(self.reasoner)
        self._entities: dict[str, Entity] = {}
        self.seq = 0
        self._checkpointed = 0
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
        found = filter(None, map(self._known, self.reasoner.instances(class_iri)))
        return iter(sorted(found, key=lambda entity: entity.name))

    def snapshot(self) -> Snapshot:
        """Every entity, as of the last commit."""
        return Snapshot(seq=self.seq, entities=tuple(self.entities()))

    def stars(self, names: Iterable[str], *, together: bool = True) -> tuple[Star, ...]:
        """The triples about some entities, taken together or each alone.

        Raises UnknownName, Refused for the TBox's.
        """
        iris = [v.iri(self.entity(name).iri) for name in names]
        leaving = frozenset(iris)
        return tuple(
            entities.read_star(self.reasoner, iri, self.seq, leaving if together else {iri}, self.tbox)
            for iri in iris
        )

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
        does not make sense, Refused when it takes away from the TBox or the disk does not take the commit.
        """
        if (known := self._journal.commit_of(transaction.id)) is not None:
            return known
        held = self._held(transaction)
        self._require(transaction, held)
        wanted = dict.fromkeys(transaction.insert)
        retracted = tuple(t for t in dict.fromkeys(transaction.retract) if t not in wanted and t in held)
        inserted = tuple(t for t in wanted if t not in held)
        if not retracted and not inserted:
            return None
        for triple in retracted:
            if triple in self.tbox:
                raise errors.Refused(
                    f"the TBox says that {v.spoken(triple)}, and no command changes the TBox"
                )
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
        return self._apply(commit, self._journal.append)

    def commit_together(
        self, transactions: Sequence[Transaction]
    ) -> list[Commit | errors.SemmapError | None]:
        """Like `commit` for each by itself, in order, but durable together; errors are among the results.

        When the disk does not take them, all are refused and the map is as before.
        """
        before, known = self.seq, self._entities.copy()
        results: list[Commit | errors.SemmapError | None] = []
        try:
            with self._journal.together():
                for transaction in transactions:
                    try:
                        results.append(self.commit(transaction))
                    except errors.SemmapError as error:
                        results.append(error)
        except BaseException as error:
            made = {c.seq: c for c in results if isinstance(c, Commit) and c.seq > before}
            for _, commit in sorted(made.items(), reverse=True):
                self.reasoner.apply(delete=commit.inserted, insert=commit.retracted)
            self.seq, self._entities = before, known
            if not isinstance(error, errors.Refused):
                raise
            return [error] * len(transactions)
        return results

    @property
    def checkpoint_is_due(self) -> bool:
        """Would the next start have much to replay?"""
        return self.seq - self._checkpointed >= CHECKPOINT_EVERY

    def checkpoint(self) -> None:
        """Write down the whole map, so that the next start need not replay its history.

        Raises Refused when the disk does not take it; then the history is replayed.
        """
        if self.seq == self._checkpointed:
            return
        marks: dict[Term, Marks] = {}
        commits: dict[int, Provenance] = {}
        for e in self._entities.values():
            since = (e.provenance, e.pose_provenance, e.shape_provenance)
            marks[v.iri(e.iri)] = Marks(*(p.commit for p in since))
            commits.update((p.commit, p) for p in since)
        triples = tuple(self.abox())
        self._journal.checkpoint(Checkpoint(seq=self.seq, triples=triples, marks=marks, commits=commits))
        self._checkpointed = self.seq

    def _held(self, transaction: Transaction) -> set[Triple]:
        """Those of the transaction's triples that are asserted already."""
        named = {*transaction.require, *transaction.retract, *transaction.insert}
        present = {s for s in {s for s, _, _ in named} if self._is_subject(s)}
        return {t for t in named if t[0] in present and self.has(t)}

    def _is_subject(self, term: Term) -> bool:
        return any(True for _ in self.reasoner.asserted(term))

    def _require(self, transaction: Transaction, held: Container[Triple]) -> None:
        for triple in transaction.require:
            if triple not in held:
                raise errors.PreconditionFailed(f"it no longer holds that {v.spoken(triple)}; ask again")
        for term in transaction.vacant:
            if self._is_subject(term):
                raise errors.NameTaken(f"the name '{v.local_name(term)}' is taken")

    def _replay(self, progress: Callable[[], None]) -> None:
        start = self._journal.last_checkpoint()
        self.reasoner.apply(insert=start.triples)
        self.seq = self._checkpointed = start.seq
        of_the_tbox = {
            i for c in self.classes.spatial for i in self.reasoner.instances(c)
        } - start.marks.keys()
        self._show(filter(None, (self._read(iri, _OF_THE_TBOX) for iri in sorted(of_the_tbox))))
        for iri, marks in start.marks.items():
            if (entity := self._read(iri, start.commits[marks.any])) is not None:
                pose, shape = start.commits[marks.pose], start.commits[marks.shape]
                self._show([structs.replace(entity, pose_provenance=pose, shape_provenance=shape)])
        for commit in self._journal.commits(after=start.seq):
            try:
                self._apply(commit, lambda _: None)
            except errors.SemmapError as error:
                raise errors.Refused(f"commit {commit.seq} no longer fits its TBox: {error.text}") from None
            progress()

    def _apply(self, commit: Commit, make_durable: Callable[[Commit], None]) -> Commit:
        """Change the triples, check them, make the commit durable, and only then let the entities show it."""
        owners = self._owners(commit)
        try:
            change = self.reasoner.apply(delete=commit.retracted, insert=commit.inserted)
        except Inconsistent as error:
            raise errors.Inconsistent(error.explanation.text, explanation=error.explanation) from None
        try:
            commit = self._with_effects(commit, owners, change.touched)
            make_durable(commit)
        except BaseException:
            self.reasoner.apply(delete=commit.inserted, insert=commit.retracted)
            raise
        self.seq = commit.seq
        for gone in commit.removed:
            del self._entities[gone.name]
        self._show(commit.changed)
        return commit

    def _owners(self, commit: Commit) -> set[Term]:
        """Whose stars the commit's triples belong to, before it and after it.

        Who comes to own a node only by the commit is itself a subject of its triples.
        """
        subjects = {s for s, _, _ in (*commit.retracted, *commit.inserted)}
        return {owner for s in subjects for owner in entities.owners(self.reasoner, s)}

    def _with_effects(self, commit: Commit, owners: set[Term], touched: Iterable[Term]) -> Commit:
        """`commit` with the entities that it changed and those that it removed."""
        provenance = Provenance(
            commit=commit.seq,
            stamp_ns=commit.stamp_ns,
            source=commit.source,
            agent=commit.agent,
            reason=commit.reason,
            confidence=commit.confidence,
        )
        changed: dict[str, Entity] = {}
        removed: list[Departed] = []
        for iri in sorted(owners.union(touched)):
            known = self._known(iri)
            entity = self._read(iri, provenance)
            if entity is None:
                removed += [Departed(name=known.name, types=known.types)] if known is not None else []
                continue
            if known is not None:
                entity = entities.inherit(entity, known, concerned=iri in owners)
            if (other := changed.setdefault(entity.name, entity)) is not entity:
                raise _taken(other)
        gone = {departed.name for departed in removed}
        for name, entity in changed.items():
            if name not in gone and (holder := self._entities.get(name, entity)).iri != entity.iri:
                raise _taken(holder)
        return structs.replace(
            commit,
            changed=tuple(e for name, e in changed.items() if e != self._entities.get(name)),
            removed=tuple(removed),
        )

    def _read(self, iri: Term, provenance: Provenance) -> Entity | None:
        return entities.read_entity(self.reasoner, self.classes, iri, provenance)

    def _known(self, iri: Term) -> Entity | None:
        """The entity with this IRI, as of the last commit."""
        entity = self._entities.get(v.local_name(iri))
        return entity if entity is not None and v.iri(entity.iri) == iri else None

    def _show(self, changed: Iterable[Entity]) -> None:
        self._entities.update((entity.name, entity) for entity in changed)


def _taken(holder: Entity) -> errors.NameTaken:
    return errors.NameTaken(f"the name '{holder.name}' is taken by <{holder.iri}>")
