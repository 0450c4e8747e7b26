"""The core of the knowledge base: one transaction in, one checked and durable commit out."""

from __future__ import annotations

import time
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence, Set
from typing import Any, NamedTuple, TypeVar

from msgspec import structs

from nodes.kb_node import gc_pause, preconditions, proofs
from nodes.kb_node.beliefs import UNCHANGED, Beliefs, Believed
from nodes.kb_node.documents import rdf
from nodes.kb_node.documents.tbox import tbox_validation
from nodes.kb_node.entities import entity_changes, entity_reading, entity_writing
from nodes.kb_node.entities.class_table import ClassTable
from nodes.kb_node.entities.fast_reading import Patterns
from nodes.kb_node.places import Places, at_most
from nodes.kb_node.progress import parts, steadily
from nodes.kb_node.reasoner import Change, Inconsistent, Reasoner
from nodes.kb_node.relations.facts.place_facts import Facts
from nodes.kb_node.relations.geometry.placed import Placed
from nodes.kb_node.storage import closure_cache, commit_encoding, conclusions_format
from nodes.kb_node.storage.journal import Checkpoint, Journal
from nodes.kb_node.storage.sqlite_file import NotWritten
from ontology import vocabulary as v
from schemas import agents, errors, wording
from schemas.commits import Commit, Snapshot, Star, Transaction
from schemas.entities import ClassInfo, Entity
from schemas.explanations import Term, Triple

CHECKPOINT_EVERY = 5000
CHECKPOINT_AT_LATEST = 20_000
CHECKPOINT_EVERY_TRIPLES = 100_000
"""Triples that changed; at once if they are half of the map."""
LARGE = 1_000_000
"""Triples."""
PART = 250_000
"""Triples that the reasoner takes in at once, in a second or two; in smaller parts it takes longer in all."""

T = TypeVar("T")


class _Tried(Exception):
    """A change was tried, up to where it would be durable. `seen` is what there was to see."""

    def __init__(self, seen: Any) -> None:
        super().__init__()
        self.seen = seen


class _Memento(NamedTuple):
    """A commit that is not durable yet, and the entities that it touched as they were before."""

    commit: Commit
    before: Mapping[str, Entity | None]
    """By name; None for one that was not there."""


class SemanticMap:
    """The ABox with its TBox: checked, explained, durable. Owned by one thread."""

    def __init__(
        self,
        journal: Journal,
        *,
        reasoner: Reasoner | None = None,
        progress: Callable[[], None] = lambda: None,
    ) -> None:
        """Rebuild the map from `journal`; `reasoner` is one that holds its TBox and no more, if there is one.

        `progress` is called between the steps of long work. Raises Refused when the journal is damaged.
        """
        self._journal = journal
        self._progress = progress
        journal.verify(progress)
        start = journal.last_checkpoint(progress)
        self.tbox = self.tbox_at(start.seq)
        self.reasoner = reasoner or closure_cache.reasoner(self.tbox, journal.path.parent)
        self.classes = ClassTable(self.reasoner)
        self.beliefs = Beliefs(self.reasoner, self.classes.limits, progress)
        self._believed: dict[int, Believed] = {}
        """What the last commits changed of what is computed, until somebody asks."""
        self._following: Iterator[None] | None = None
        self._follows = False
        """Whether what is computed is worked out at each commit; not yet after a start."""
        self._believes = False
        """Whether the reasoner has what is computed; after a start it does if its columns were kept."""
        self._entities: dict[str, Entity] = {}
        self._patterns = Patterns()
        self.places = Places(
            self._entities,
            self.entities,
            lambda p: self.reasoner.asserted(None, p, None),
            lambda: self.classes.limits,
            self._facts,
        )
        self.foretell: Callable[[Commit], Callable[[], None]] = lambda _: lambda: None
        """Told of each commit before it is checked; what it returns is called if that is not made."""
        self._look: Callable[[Commit], Any] | None = None
        """While a change is only tried: who looks at it."""
        self._undo_log: list[_Memento] | None = None
        """While commits are made together: what takes them back, in their order."""
        self.seq = 0
        self.digest = ""
        """That of the last commit, and so of the whole history, in hexadecimal; empty before the first."""
        self._checkpointed = 0
        self._changed = self._changed_then = 0
        """Triples that changed, and those of them that are in the checkpoint."""
        self._pictured = (0, 0)
        """The number of the last commit in the last picture, and how many triples had changed."""
        self._replay(start)

    # Asking

    def __len__(self) -> int:
        return len(self._entities)

    def follow_places(self) -> None:
        """Work out where everything is, if that was not done since the start.

        Whoever asks what follows needs it, and the first commit.
        """
        while self.follow_some():
            self._progress()

    def follow_some(self) -> bool:
        """Do a part of that, some tens of milliseconds; whether there is more to do."""
        if self._follows:
            return False
        following, self._following = self._following or self._follow(), None
        for _ in following:
            self._following = following
            return True
        return False

    def _follow(self) -> Iterator[None]:
        self.beliefs.begin()
        yield from self.beliefs.filling(self._entities)
        self._follows = self._believes = True
        for name, entity in self._entities.items():
            types = self._types(entity)
            if types != entity.types:
                self._entities[name] = structs.replace(entity, types=types)

    def believe_places(self) -> None:
        """Let the reasoner have what is computed of where things are, if it has not."""
        if not self._believes:
            self.follow_places()

    def _facts(self) -> Facts | None:
        """The relations that are computed, if any are, with their solids."""
        self.follow_places()
        return None if self.beliefs.computed.is_idle else self.beliefs.computed.facts

    def entity(self, name: str) -> Entity:
        """The entity of that name. Raises UnknownName with the nearest ones."""
        if name in self._entities:
            return self._entities[name]
        raise errors.UnknownName(f"no entity is named '{name}'{errors.did_you_mean(name, self._entities)}")

    def find(self, name: str) -> Entity | None:
        """The entity of that name, if there is one."""
        return self._entities.get(name)

    @property
    def names(self) -> Collection[str]:
        """Those of the entities."""
        return self._entities.keys()

    def entities(self, class_iri: Term | None = None) -> Iterator[Entity]:
        """The entities, or those of a class by inference, in the order of their names."""
        if class_iri is None:
            return (self._entities[name] for name in sorted(self._entities))
        self.believe_places()
        found = filter(None, map(self._known, self.reasoner.instances(class_iri)))
        return iter(sorted(found, key=lambda entity: entity.name))

    def snapshot(self) -> Snapshot:
        """Every entity, as of the last commit."""
        return Snapshot(seq=self.seq, entities=tuple(self.entities()), digest=self.digest)

    def stars(self, names: Iterable[str]) -> tuple[Star, ...]:
        """The triples about some entities, taken together. Raises UnknownName, Refused for the TBox's."""
        iris = [v.iri(self.entity(name).iri) for name in names]
        leaving = frozenset(iris)
        return tuple(
            entity_reading.read_star(self.reasoner, self.classes, iri, self.seq, leaving, self.tbox)
            for iri in iris
        )

    def class_table(self) -> Iterator[ClassInfo]:
        """The classes with the number of entities of each, asserted and inferred."""
        return self.classes.counted(self._entities.values())

    def abox(self) -> list[Triple]:
        """The asserted triples that are not the TBox's."""
        tbox = self.tbox
        return [t for said in self.reasoner.by_subject() for t in said if t not in tbox]

    def inferred(self, name: str | None = None) -> Iterator[Triple]:
        """What follows and was not said, about one entity or all. Raises UnknownName."""
        self.believe_places()
        for entity in [self.entity(name)] if name is not None else self.entities():
            yield from sorted(self.reasoner.inferred(v.iri(entity.iri), None, None))

    def steadily(self, items: Iterable[T]) -> Iterator[T]:
        """The items, for long work on them: the node tells meanwhile that it lives."""
        return steadily(items, self._progress)

    def all_believed(self) -> Believed:
        """What is computed and what is set aside."""
        self.believe_places()
        return self.beliefs.all()

    def placed(self) -> tuple[Placed, ...]:
        """Where everything is."""
        return tuple(map(Placed.of, self._entities.values()))

    def believed_of(self, commit: Commit) -> Believed:
        """What a commit changed of that; it is told once."""
        return self._believed.pop(commit.seq, UNCHANGED)

    def tidy(self) -> None:
        """What a commit leaves to be done when nobody waits for it."""
        self.beliefs.computed.facts.forget()

    def has(self, triple: Triple) -> bool:
        """Is it asserted?"""
        return any(self.reasoner.asserted(*triple))

    def tbox_at(self, seq: int) -> frozenset[Triple]:
        """The TBox that held after commit `seq`. Raises Refused when it is damaged."""
        return frozenset(rdf.parse(self._journal.tbox(seq), f"the TBox in {self._journal.path}"))

    # Changing

    def commit(self, transaction: Transaction) -> Commit | None:
        """Apply, check and make durable; None when it changes nothing. On any error the map is as before.

        A command that comes a second time is answered with its first commit. That is looked up only when
        there is nothing to do or something is in the way, as the journal is: it takes no command twice.

        Raises PreconditionFailed; NameTaken; UnknownName for an intent about what is not there; Inconsistent
        (with the explanation); BadRequest for a star that does not make sense; Refused when it takes away
        from the TBox or the disk does not take the commit.
        """
        if self._undo_log is None:
            self._believed.clear()
        try:
            made = self._commit(transaction)
        except errors.SemmapError:
            if (known := self._journal.commit_of(transaction.id)) is None:
                raise
            return known
        return made or self._journal.commit_of(transaction.id)

    def _commit(self, transaction: Transaction) -> Commit | None:
        self.follow_places()
        transaction, notes = self._spelled_out(transaction)
        held = preconditions.held(self.reasoner, transaction, self._progress)
        preconditions.require(transaction, held)
        wanted = dict.fromkeys(transaction.insert)
        retracted = tuple(t for t in dict.fromkeys(transaction.retract) if t not in wanted and t in held)
        inserted = tuple(t for t in wanted if t not in held) if held else tuple(wanted)
        if not retracted and not inserted:
            return None
        denied = self.places.taken_back(self.reasoner, self.classes, retracted, inserted)
        retracted += tuple(t for t in denied.triples if t not in self.tbox and t not in wanted)
        for triple in retracted:
            if triple in self.tbox:
                raise errors.Refused(
                    f"the TBox says that {v.spoken(triple)}, and no command changes the TBox"
                )
        with gc_pause.uncollected():
            commit = self._signed(transaction, retracted, inserted, notes=(*notes, *denied.notes))
            if self._look is not None:
                return self._apply(commit, self._write, self._with_doubts)
            give_up, begun = self.foretell(commit), commit_encoding.early(commit)
            try:
                return self._apply(commit, lambda whole: self._write(whole, begun=begun), self._with_doubts)
            except BaseException:
                give_up()
                raise

    def _with_doubts(self, commit: Commit) -> Commit:
        """With a word on what it says of places and is not so."""
        doubts = self.places.doubts(commit)
        return structs.replace(commit, notes=(*commit.notes, *doubts)) if doubts else commit

    def try_out(self, change: Callable[[], Commit | None], look: Callable[[Commit], T]) -> T | None:
        """What `look(commit)` sees once `change` would be durable; then all is taken back.

        None if it changes nothing, or was done before. Raises what `change` raises.
        """
        self._look = look
        try:
            change()
        except _Tried as tried:
            seen: T = tried.seen
            return seen
        finally:
            self._look = None
        return None

    def _write(
        self, commit: Commit, tbox: bytes | None = None, *, begun: commit_encoding.EarlyBody | None = None
    ) -> Commit:
        """The commit, durable and with its digest. Raises NotWritten; _Tried if it is only tried."""
        if self._look is not None:
            raise _Tried(self._look(commit))
        return structs.replace(commit, digest=self._journal.append(commit, tbox, begun=begun).hex())

    def replace_tbox(self, transaction: Transaction, tbox: Iterable[Triple]) -> Commit:
        """Let another TBox hold, in one commit with the transaction's changes of the ABox.

        Raises Inconsistent, BadFile for what is no TBox, Refused when the map does not fit it or the disk
        does not take it. Then everything is as before.
        """
        if (known := self._journal.commit_of(transaction.id)) is not None:
            return known
        new = frozenset(tbox)
        retracted = (*transaction.retract, *sorted(self.tbox - new))
        inserted = (*transaction.insert, *sorted(new - self.tbox))
        commit = self._signed(transaction, retracted, inserted, tbox=True)
        self.follow_places()
        before = self.classes

        def make_durable(commit: Commit) -> Commit:
            tbox_validation.require_fit(self.abox(), before, self.classes)
            return self._write(commit, rdf.serialise(new, "ntriples"))

        return self._switch(commit, new, make_durable)

    def commit_together(
        self, transactions: Sequence[Transaction]
    ) -> list[Commit | errors.SemmapError | None]:
        """Like `commit` for each by itself, in order, but durable together; errors are among the results.

        When the disk does not take them, all are refused and the map is as before.
        """
        log = self._undo_log = []
        self._believed.clear()
        results: list[Commit | errors.SemmapError | None] = []
        try:
            with self._journal.together():
                for transaction in transactions:
                    try:
                        results.append(self.commit(transaction))
                    except NotWritten:
                        raise
                    except errors.SemmapError as error:
                        results.append(error)
        except BaseException as error:
            for memento in reversed(log):
                self._take_back(memento)
            if not isinstance(error, NotWritten):
                raise
            return [error] * len(transactions)
        finally:
            self._undo_log = None
        return results

    def _take_back(self, memento: _Memento) -> None:
        """Undo the last commit, of which the journal keeps nothing."""
        commit, before = memento
        self._reverse(commit, before)
        self.places.take(commit.names, commit.inserted, commit.retracted)
        for name, entity in before.items():
            if entity is None:
                self._entities.pop(name, None)
            else:
                self._entities[name] = entity
        self.seq = commit.seq - 1
        self.digest = self._journal.digest(self.seq).hex()

    def checkpoint_is_due(self, *, quiet: bool) -> bool:
        """Would the next start have much to replay? Unless it is `quiet`, very much? Another TBox is much."""
        if quiet and self._changed - self._changed_then > CHECKPOINT_EVERY_TRIPLES:
            return True
        if quiet and self._journal.tbox_changes(after=self._checkpointed):
            return True
        return self.seq - self._checkpointed >= (CHECKPOINT_EVERY if quiet else CHECKPOINT_AT_LATEST)

    @property
    def checkpoint_is_urgent(self) -> bool:
        """Would the next start have to replay most of the map?"""
        changed = self._changed - self._changed_then
        return changed > CHECKPOINT_EVERY_TRIPLES and 2 * changed >= len(self.reasoner)

    @property
    def is_large(self) -> bool:
        """Does a checkpoint take so long that nobody should wait for it without need?"""
        return len(self.reasoner) > LARGE

    def picture(self) -> Checkpoint:
        """The map as it is now, to be written down while it goes on changing. Takes some 0.2 us a triple."""
        self.believe_places()
        self._pictured = self.seq, self._changed
        columns = self.reasoner.columns()
        return Checkpoint(
            seq=self.seq,
            triples=tuple(self.reasoner.set_aside() if columns is not None else self.abox()),
            columns=columns,
            entities=tuple(self._entities.values()),
            read_by=conclusions_format.mark(),
        )

    def checkpoint(self) -> None:
        """Write down the whole map, so that the next start need not replay its history.

        Raises Refused when the disk does not take it; then the history is replayed.
        """
        if self.seq != self._checkpointed:
            self._journal.checkpoint(self.picture(), self._progress)
            self.written(self.seq)

    def written(self, seq: int) -> None:
        """There is a checkpoint of the map after commit `seq`, made of the last picture."""
        self._checkpointed, self._changed_then = seq, self._pictured[1]

    def _spelled_out(self, transaction: Transaction) -> tuple[Transaction, tuple[str, ...]]:
        """The transaction with its intents said in triples, too; and what is to be known of them."""
        remove, edit, add = transaction.remove, transaction.edit, transaction.add
        if not (remove or edit or add):
            return transaction, ()
        draft = entity_writing.Draft(self.reasoner, self.classes, self.tbox, self._entities)
        draft.remove([self.entity(name) for name in self.steadily(remove)])
        notes = list(self.places.left_behind(remove)) if remove else []
        for one in self.steadily(edit):
            draft.edit(self.entity(one.name), one)
            if one.carry:
                load = self.places.load_of(one, edit)
                for other in load:
                    draft.edit(self._entities[other.name], other)
                if load or transaction.source == "operator":
                    notes.append(wording.carried(one.name, [other.name for other in load], one.leave))
        for new in self.steadily(add):
            draft.add(new)
        spelled_out = structs.replace(
            transaction,
            retract=(*transaction.retract, *draft.retract),
            insert=(*transaction.insert, *draft.insert),
        )
        return spelled_out, tuple(notes)

    def _replay(self, start: Checkpoint) -> None:
        is_ours = start.read_by == conclusions_format.mark()
        if start.columns is not None and is_ours and self.reasoner.fill(start.columns):
            self.reasoner.believe(aside=start.triples)
            self._believes = True
        else:
            self._change(insert=tuple(start.said()), lenient=True)
        self.seq = self._checkpointed = start.seq
        self.digest = self._journal.digest(start.seq).hex()
        if start.seq == 0:
            self._show(entity_reading.of_the_tbox(self.reasoner, self.classes))
        elif is_ours:
            self._show(start.entities)
        else:
            self._show(entity for known in start.entities if (entity := self._read_again(known)) is not None)
        for commit in self._journal.commits(after=start.seq):
            try:
                if commit.tbox:
                    self._switch(commit, self.tbox_at(commit.seq), _as_it_is)
                else:
                    self._apply(commit, _as_it_is)
            except errors.SemmapError as error:
                raise errors.Refused(f"commit {commit.seq} no longer fits its TBox: {error.text}") from None
            self._progress()
        if self.seq > start.seq or start.read_by != conclusions_format.mark():
            self.follow_places()  # else the entities have the classes that they have by their places

    def _signed(
        self,
        transaction: Transaction,
        retracted: tuple[Triple, ...],
        inserted: tuple[Triple, ...],
        *,
        tbox: bool = False,
        notes: tuple[str, ...] = (),
    ) -> Commit:
        """The next commit, by the transaction's author."""
        return Commit(
            seq=self.seq + 1,
            stamp_ns=time.time_ns(),
            id=transaction.id,
            source=transaction.source,
            agent=agents.name_of(transaction.agent),
            authenticated=agents.is_proved(transaction.agent),
            verb=transaction.verb,
            reason=transaction.reason,
            confidence=transaction.confidence,
            undoes=transaction.undoes,
            tbox=tbox,
            retracted=retracted,
            inserted=inserted,
            notes=notes,
        )

    def _switch(
        self, commit: Commit, tbox: frozenset[Triple], make_durable: Callable[[Commit], Commit]
    ) -> Commit:
        """Like `_apply`, for a commit that replaces the TBox: all is worked out anew beside the old."""
        before = self.tbox, self.reasoner, self.classes, self.beliefs
        abox = {*self.abox(), *commit.inserted}.difference(commit.retracted, tbox)
        try:
            self.tbox, self.reasoner = tbox, tbox_validation.compiled(tbox)
            self.classes = ClassTable(self.reasoner)
            self.beliefs = Beliefs(self.reasoner, self.classes.limits, self._progress)
            self._change(insert=abox, lenient=True)
            concerned = {v.iri(entity.iri) for entity in self._entities.values()}
            concerned.update(i for c in self.classes.spatial for i in self.reasoner.instances(c))
            commit = self._with_effects(commit, set(), Change(frozenset(concerned)), set())
            if self._follows:
                commit = self._with_places_anew(commit, before[-1].withheld.keys())
            commit = make_durable(commit)
        except BaseException:
            self.tbox, self.reasoner, self.classes, self.beliefs = before
            raise
        return self._taken(commit)

    def _apply(
        self,
        commit: Commit,
        make_durable: Callable[[Commit], Commit],
        noted: Callable[[Commit], Commit] = lambda commit: commit,
    ) -> Commit:
        """Change the triples, check them, make the commit durable, and only then let the entities show it."""
        subjects = preconditions.subjects(commit.retracted, commit.inserted)
        known = self.reasoner.mentioned(subjects)
        owners = subjects.union(
            *(entity_reading.owners(self.reasoner, self.classes, s) for s in steadily(known, self._progress))
        )
        self.beliefs.begin()
        restores = bool(commit.undoes)
        contradicted = self.beliefs.contradicted.keys() if restores else frozenset()
        lenient = restores or not self._follows
        change = self._change(delete=commit.retracted, insert=commit.inserted, lenient=lenient)
        try:
            if not lenient:
                self._require_agreement(commit)
            commit = noted(self._with_effects(commit, owners, change, subjects - known))
            if self._follows:
                commit = self._with_places(commit)
            if restores and self._follows:
                self._require_no_more_than(contradicted)
            commit = make_durable(commit)
        except BaseException:
            self._reverse(commit, {name: self._entities.get(name) for name in commit.names})
            raise
        return self._taken(commit)

    def _require_agreement(self, commit: Commit) -> None:
        """Raises Inconsistent for a commit that contradicts what was said before and geometry denies."""
        try:
            self.beliefs.require_agreement(commit.inserted)
        except Inconsistent as error:
            raise proofs.refusal(error) from None

    def _require_no_more_than(self, contradicted: Set[Triple]) -> None:
        """Raises Inconsistent when assertions contradict one another that geometry does not deny.

        Taking something back may bring such together that did at the time, since geometry denied them.
        """
        newly = {t: why for t, why in self.beliefs.contradicted.items() if t not in contradicted}
        if newly:
            raise proofs.refusal(Inconsistent(newly[min(newly)]))

    def _reverse(self, commit: Commit, before: Mapping[str, Entity | None]) -> None:
        """Let the reasoner have all as it was before the last commit; `before` are that one's entities."""
        self._change(delete=commit.inserted, insert=commit.retracted, lenient=True)
        if not self._follows:
            return
        after: dict[str, Entity | None] = {departed.name: None for departed in commit.removed}
        after.update((entity.name, entity) for entity in commit.changed)
        self.beliefs.follow(
            changed=[entity for entity in before.values() if entity is not None],
            removed=[name for name, entity in before.items() if entity is None],
            before=lambda name: after[name] if name in after else self._entities.get(name),
            retracted=commit.inserted,
            inserted=commit.retracted,
        )

    def _with_places(self, commit: Commit) -> Commit:
        """`commit` with the entities, too, whose classes change by where things are."""
        entities = self._entities
        moved = self.beliefs.follow(
            changed=commit.changed,
            removed=[departed.name for departed in commit.removed],
            before=entities.get,
            retracted=commit.retracted,
            inserted=commit.inserted,
        )
        self._believed[commit.seq] = self.beliefs.believed
        crowds = self.places.crowds(commit.names)
        if crowds:
            commit = structs.replace(commit, notes=(*commit.notes, *crowds))
        commit = self._with_withheld(commit, self.beliefs.newly_withheld)
        if not moved:
            return commit
        changed = {entity.name: entity for entity in commit.changed}
        gone = {departed.name for departed in commit.removed}
        for iri in sorted(moved):
            name = v.entity_name(iri)
            entity = changed.get(name) or (None if name in gone else entities.get(name))
            if entity is not None and v.iri(entity.iri) == iri:
                changed[name] = structs.replace(entity, types=self._types(entity))
        return structs.replace(commit, changed=tuple(e for n, e in changed.items() if e != entities.get(n)))

    def _with_withheld(self, commit: Commit, facts: Collection[Triple]) -> Commit:
        """`commit` with a note on what it lets contradict the map, so that it is left out."""
        if not facts:
            return commit
        return structs.replace(commit, notes=(*commit.notes, *at_most(list(map(self.beliefs.told, facts)))))

    def _with_places_anew(self, commit: Commit, withheld: Set[Triple]) -> Commit:
        """The same for a commit that replaces the TBox, so that everything is worked out anew.

        `withheld` is what was before.
        """
        gone = {departed.name for departed in commit.removed}
        after = {name: e for name, e in self._entities.items() if name not in gone}
        after.update((entity.name, entity) for entity in commit.changed)
        self.beliefs.fill(after)
        commit = self._with_withheld(commit, sorted(self.beliefs.withheld.keys() - withheld))
        for name, entity in after.items():
            after[name] = structs.replace(entity, types=self._types(entity))
        changed = tuple(e for name, e in after.items() if e != self._entities.get(name))
        return structs.replace(commit, changed=changed)

    def _types(self, entity: Entity) -> tuple[str, ...]:
        """The classes of an entity as it is now, by what is computed, too."""
        return self.classes.spoken_types(self.reasoner.types(v.iri(entity.iri)))

    def _change(
        self, *, delete: Collection[Triple] = (), insert: Collection[Triple], lenient: bool = False
    ) -> Change:
        """What the reasoner makes of triples that are there and of some that are not. Raises Inconsistent.

        When it is `lenient`, what is asserted of places and contradicts the rest is set aside.
        """
        try:
            if len(delete) + len(insert) <= PART or not self.reasoner.is_compiled:
                return self.beliefs.change(delete, insert, lenient=lenient)
            return self._change_in_parts(delete, insert, lenient)
        except Inconsistent as error:
            raise proofs.refusal(error) from None

    def _change_in_parts(self, delete: Iterable[Triple], insert: Iterable[Triple], lenient: bool) -> Change:
        """Whatever is a part of a consistent map is consistent, so nothing is refused that should not be."""
        reasoner, changes = self.beliefs, list[Change]()
        deleted, inserted = list[Triple](), list[Triple]()
        try:
            for part in parts(delete, PART, self._progress):
                changes.append(reasoner.change(part, (), lenient=lenient))
                deleted += part
            for part in parts(insert, PART, self._progress):
                changes.append(reasoner.change((), part, lenient=lenient))
                inserted += part
        except BaseException:
            reasoner.change(inserted, deleted)
            raise
        return Change.together(changes)

    def _taken(self, commit: Commit) -> Commit:
        self.seq, self.digest = commit.seq, commit.digest
        self.places.take(commit.names, commit.retracted, commit.inserted)
        self._changed += len(commit.inserted) + len(commit.retracted)
        if self._undo_log is not None:
            before = {name: self._entities.get(name) for name in commit.names}
            self._undo_log.append(_Memento(commit, before))
        for gone in commit.removed:
            del self._entities[gone.name]
        self._show(commit.changed)
        return commit

    def _with_effects(self, commit: Commit, owners: Set[Term], change: Change, new: Set[Term]) -> Commit:
        reading = entity_changes.Reading(self.reasoner, self.classes, self._patterns, self._progress)
        return entity_changes.of(commit, change, self._entities, reading, owners=owners, new=new)

    def _read_again(self, known: Entity) -> Entity | None:
        """An entity as this code reads it, changed when it was."""
        iri = v.iri(known.iri)
        entity = entity_reading.read_entity(self.reasoner, self.classes, iri, known.provenance)
        return (
            None
            if entity is None
            else structs.replace(
                entity,
                pose_provenance=known.pose_provenance,
                shape_provenance=known.shape_provenance,
                reference_provenance=known.reference_provenance,
            )
        )

    def _known(self, iri: Term) -> Entity | None:
        """The entity with this IRI, as of the last commit."""
        return entity_changes.known(self._entities, iri)

    def _show(self, changed: Iterable[Entity]) -> None:
        self._entities.update((entity.name, entity) for entity in changed)


def _as_it_is(commit: Commit) -> Commit:
    """One that is durable already."""
    return commit
