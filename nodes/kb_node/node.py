"""The knowledge base on the wire: `semmap/bridge/<verb>` in, commits and entities out."""

from __future__ import annotations

import hashlib
import uuid
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import contextmanager, suppress
from functools import partial
from typing import TypeVar

from msgspec import structs

from nodes.kb_node import gc_pause, undo
from nodes.kb_node.announcing import Announcer
from nodes.kb_node.answers import answers, questions, trials, whereabouts
from nodes.kb_node.answers.pages import Pages
from nodes.kb_node.answers.standing_places import StandingPlaces
from nodes.kb_node.beliefs import Believed
from nodes.kb_node.config import KbConfig
from nodes.kb_node.documents import blank_nodes, document_change, load_parts, rdf, term_syntax
from nodes.kb_node.documents.tbox import tbox_notes, tbox_validation
from nodes.kb_node.reasoner import Held
from nodes.kb_node.reasoner.entailment.explaining import nearby
from nodes.kb_node.reasoner.tbox.axioms import NotCompilable
from nodes.kb_node.semantic_map import SemanticMap
from nodes.kb_node.sparql.protocol import Surrounded
from nodes.kb_node.sparql.service import SparqlService
from nodes.kb_node.sparql.standing_queries.news import NewsStand
from nodes.kb_node.sparql.triples.large_map import LargeMap
from nodes.kb_node.storage import history
from nodes.kb_node.storage.journal import FILENAME, Journal
from nodes.kb_node.storage.sqlite_file import NotWritten
from nodes.runtime import heap
from nodes.runtime.loop import Node, open_node
from ontology import vocabulary as v
from schemas import errors, keys, wording
from schemas.bridge import (
    Entities,
    LoadDocument,
    Loaded,
    LoadOf,
    LoadTBox,
    MadeBy,
    Outcome,
    Recall,
    SnapshotQuery,
    StarQuery,
    TakeBack,
    Transactions,
)
from schemas.calls import Handler, by_verb
from schemas.commands import (
    Check,
    Classes,
    Could,
    Explain,
    Export,
    Get,
    History,
    Infer,
    LastSeen,
    Properties,
    Relations,
    Renew,
    Sparql,
    Watch,
)
from schemas.commits import Commit, Effects, Snapshot, Star, Transaction
from schemas.entities import ClassInfo, Entity, PropertyInfo
from schemas.explanations import Explanation, Triple
from schemas.health import LOADING
from schemas.relations import Described, Relation
from schemas.replies import Checked, Document, Done, Inferred, LoggedCommit, Possible, Sighting
from schemas.sparql import SparqlResult, Watching

CHECKPOINT_PERIOD_S = 10.0
CHECKPOINT_DELAY_S = 3.0
"""After a very large commit, which others fetch first."""
_FEW = 1000
"""Entities that are added at once without a word on it."""
C = TypeVar("C", Commit, Commit | None)
R = TypeVar("R", Explanation, Possible)


class KnowledgeBase:
    """Binds the map to the wire."""

    def __init__(self, node: Node, journal: Journal) -> None:
        self._node = node
        self._journal = journal
        self._past = history.Past(journal)
        self._seq_then = 0
        self.map = SemanticMap(journal, progress=node.beat)
        self._pages = Pages(self.map)
        self._now, self._then = whereabouts.Now(self.map), whereabouts.Then(self.map, self._past)
        self._announcer = Announcer(node.session, self.map.entities())
        self._aside = ThreadPoolExecutor(max_workers=2, thread_name_prefix="check")
        self._beside = ThreadPoolExecutor(max_workers=1, thread_name_prefix="checkpoint")
        self._writing: Future[int] | None = None
        """While a checkpoint is written: the number of its last commit."""
        self._sparql = SparqlService(
            lambda: self.map.reasoner.asserted(),
            NewsStand(node.session).publish,
            LargeMap(journal, lambda: self.map.reasoner, node.soon),
            self.map.all_believed,
            lambda: Surrounded(placed=self.map.placed(), limits=self.map.classes.limits),
        )
        self.map.foretell = self._sparql.foretell
        self._standing_places = StandingPlaces(self.map, NewsStand(node.session).publish)
        handlers = self._handlers()
        node.serve(keys.BRIDGE, handlers)
        for verb in keys.OF_THE_MAP:
            for prefix in (keys.CMD, keys.commands_as()):
                node.serve_one(prefix, handlers[verb])
        node.every(CHECKPOINT_PERIOD_S, self._checkpoint)
        node.every(CHECKPOINT_PERIOD_S, self._standing_places.drop_expired)
        node.note(self._notes())
        node.head(lambda: (self.map.seq, self.map.digest))
        node.soon(self._follow_places)
        node.ready(self._summary())

    def _handlers(self) -> dict[str, Handler]:
        return by_verb(
            Transaction.answered_by(self.on_commit),
            Transactions.answered_by(self.on_commits),
            LoadDocument.answered_by(self.on_load),
            SnapshotQuery.answered_by(self.on_snapshot),
            Recall.answered_by(self.on_recall),
            StarQuery.answered_by(self.on_star),
            LoadOf.answered_by(self.on_load_of),
            MadeBy.answered_by(self.on_made_by),
            Classes.answered_by(self.on_classes),
            Properties.answered_by(self.on_properties),
            Entities.answered_by(self.on_list),
            Get.answered_by(self.on_get),
            Infer.answered_by(self.on_infer),
            Explain.answered_by(self.on_explain),
            Could.answered_by(self.on_could),
            Relations.answered_by(self.on_relations),
            Export.answered_by(self.on_export),
            History.answered_by(self.on_history),
            LastSeen.answered_by(self.on_last_seen),
            TakeBack.answered_by(self.on_undo),
            LoadTBox.answered_by(self.on_load_tbox),
            Check.answered_by(self.on_check),
            Sparql.answered_by(self.on_sparql),
            Watch.answered_by(self.on_watch),
            Renew.answered_by(self.on_renew),
        )

    def _follow_places(self) -> None:
        """Between other work: the first commit after a start waits for what is left of it."""
        if self.map.follow_some():
            self._node.soon(self._follow_places)

    def on_commit(self, transaction: Transaction) -> Effects | None:
        """One transaction: journal (durable), reply, publish."""
        term_syntax.require_triples(transaction.insert)
        if len(transaction.add) <= _FEW:
            return self._changed(
                lambda: self.map.commit(transaction), transaction.dry_run, told=transaction.told
            )
        with self._telling_of(transaction.reason.removeprefix("load ")) as tell:
            tell(f"{len(transaction.add):,} entities to check and write")
            return self._changed(
                lambda: self.map.commit(transaction), transaction.dry_run, told=transaction.told
            )

    def _changed(
        self, change: Callable[[], Commit | None], dry_run: bool, *, told: bool = False
    ) -> Effects | None:
        """What `change` commits, and publishes; or would commit, in a dry run."""
        if dry_run:
            return trials.of(self.map, change)
        return _effects(self._published_if_new(change, told=told))

    def _commit_part(self, transaction: Transaction) -> Commit | None:
        """A part of a load, published at once: the reply comes after many of them."""
        return self._published_if_new(lambda: self.map.commit(transaction), at_once=True)

    def _published_if_new(self, change: Callable[[], C], *, told: bool = False, at_once: bool = False) -> C:
        """What `change` commits; published unless it is the answer to an old command."""
        before = self.map.seq
        try:
            commit = change()
        except NotWritten as error:
            self._not_written(error)
            raise
        if commit is not None and commit.seq > before:
            self._spread(commit, told=told, at_once=at_once)
        return commit

    def _not_written(self, error: NotWritten) -> None:
        self._node.report(error.text)
        self._node.describe(f"{self._summary()}; the disk accepts no commits")

    def _spread(self, commit: Commit, *, told: bool, at_once: bool = False) -> None:
        """Tell everybody, `at_once` or when the reply is on its way: nobody else is answered before that."""
        announce = partial(self._announcer.announce, commit, told=told)
        if at_once:
            announce()
        else:
            self._node.afterwards(announce)
        self._node.afterwards(partial(self._follow, commit, self.map.believed_of(commit)))
        self._node.describe(self._summary)
        if commit.tbox:
            self._node.note(self._notes())
        if self.map.checkpoint_is_urgent:
            self._node.later(CHECKPOINT_DELAY_S, self._checkpoint_if_urgent)

    def _follow(self, commit: Commit, believed: Believed) -> None:
        """What this node does with a commit once the reply is on its way."""
        self._sparql.follow(commit, believed)
        self._standing_places.follow(commit.seq, commit.names)
        self.map.tidy()

    def on_commits(self, several: Transactions) -> tuple[Outcome, ...]:
        """Several transactions, each by itself: journal (durable, once for all), reply, publish.

        Raises BadRequest, with nothing done, when there is one that is not of RDF terms.
        """
        for transaction in several.transactions:
            term_syntax.require_triples(transaction.insert)
            if transaction.dry_run:
                raise errors.BadRequest("a dry run cannot be combined with other transactions")
        before = self.map.seq
        results = self.map.commit_together(several.transactions)
        for error in results:
            if isinstance(error, NotWritten):
                self._not_written(error)
        for transaction, result in zip(several.transactions, results, strict=True):
            if isinstance(result, Commit) and result.seq > before:
                before = result.seq
                self._spread(result, told=transaction.told)
        return tuple(map(_outcome, results))

    def on_load(self, load: LoadDocument) -> Loaded:
        """An RDF document in one commit, or in parts."""
        before = self.map.seq
        try:
            return self._load(load)
        finally:
            if self.map.seq == before:
                self._sparql.forget()

    def _load(self, load: LoadDocument) -> Loaded:
        if rdf.syntax_of(load.content) == "turtle" and not (load.replace or load.parts or load.dry_run):
            self._sparql.foresee(load.id, load.content, v.ABOX)
        label = f"f{hashlib.blake2b(load.id.encode(), digest_size=4).hexdigest()}"  # the same when sent again
        with self._telling_of(load.filename) as tell:
            triples = rdf.parse(
                load.content,
                load.filename,
                label_prefix=label,
                progress=lambda count: tell(f"{count:,} triples read"),
            )
            tell(f"{len(triples):,} triples to check and write")
            transaction, sorted_out = document_change.of_document(self.map, load, triples)
            if not document_change.is_all(triples, transaction):
                self._sparql.forget()
            if load.dry_run:
                names, effects = self._tried_load(transaction)
                return Loaded(
                    commit=effects,
                    names=names,
                    skipped=tuple(sorted_out.skipped),
                    notes=tuple(sorted_out.notes),
                )
            del triples
            parts = load_parts.in_parts(transaction) if load.parts else [transaction]
            commits = load_parts.commit_each(parts, self._commit_part, tell if load.parts else lambda _: None)
            return Loaded(
                commit=_effects(commits[-1] if commits else None),
                parts=len(commits),
                names=tuple(dict.fromkeys(entity.name for commit in commits for entity in commit.changed)),
                skipped=tuple(sorted_out.skipped),
                notes=(*sorted_out.notes, *(note for earlier in commits[:-1] for note in earlier.notes)),
            )

    def _tried_load(self, transaction: Transaction) -> tuple[tuple[str, ...], Effects | None]:
        """The names of all entities that a load would change, and what it would commit."""
        tried = trials.of(self.map, lambda: self.map.commit(transaction))
        return (tried.trial.changed if tried is not None and tried.trial is not None else (), tried)

    @contextmanager
    def _telling_of(self, filename: str) -> Iterator[Callable[[str], None]]:
        """Lets the heartbeat tell how far the loading of a file is."""

        def tell(text: str) -> None:
            self._node.describe(f"{LOADING} {filename or 'a file'}: {text}")
            self._node.beat()

        try:
            with gc_pause.uncollected(freeze=True):
                yield tell
        finally:
            self._node.afterwards(heap.trim)
            self._node.describe(self._summary)

    def on_snapshot(self, query: SnapshotQuery) -> Snapshot:
        """The entities as of the last commit, or a page of them."""
        return self._pages.snapshot(query)

    def on_recall(self, query: Recall) -> Future[tuple[Commit, ...]]:
        """Commits of the history, whole."""
        return self._aside.submit(self._past.commits, query.seqs)

    def on_star(self, query: StarQuery) -> tuple[Star, ...]:
        """The triples about some entities."""
        return self.map.stars(query.names)

    def on_load_of(self, query: LoadOf) -> tuple[str, ...]:
        """What a thing bears."""
        return tuple(self.map.places.borne_by(query.name, query.leave))

    def on_made_by(self, query: MadeBy) -> tuple[Effects | None, ...]:
        """The commits that some commands have made."""
        return tuple(_effects(self._journal.commit_of(id_)) for id_ in query.ids)

    def on_classes(self, _: Classes) -> tuple[ClassInfo, ...]:
        """The class table."""
        return tuple(self.map.class_table())

    def on_properties(self, _: Properties) -> tuple[PropertyInfo, ...]:
        """The property table."""
        return tuple(self.map.classes.stated.rows())

    def on_list(self, query: Entities) -> tuple[Entity, ...] | Future[tuple[Entity, ...]]:
        """The entities of a class, now or as of then; with `where` those that are there."""
        if query.as_of is None:
            return self._now.entities(query)
        return self._aside.submit(self._then.entities, query)

    def on_relations(self, query: Relations) -> tuple[Relation, ...] | Future[tuple[Relation, ...]]:
        """Where a thing is relative to others, now or as of then."""
        if query.as_of is None:
            return self._now.relations(query)
        return self._aside.submit(self._then.relations, query)

    def on_get(self, query: Get) -> Described | Future[Described]:
        """One entity, now or as of then."""
        if query.as_of is None:
            return self._now.entity(query)
        return self._aside.submit(self._then.entity, query)

    def on_infer(self, query: Infer) -> Inferred:
        """What follows."""
        return answers.infer(self.map, query.name)

    def on_explain(self, query: Explain) -> Explanation | Future[Explanation]:
        """Why it follows or cannot, or what was measured of where a thing is; or why it does not hold."""
        if (measured := self._now.measured(query)) is not None:
            return measured
        asked = questions.of_explain(self.map, query)
        return self._now.explained(query, asked) or self._tried(questions.explain, asked)

    def on_could(self, query: Could) -> Possible | Future[Possible]:
        """Whether it could be."""
        asked = questions.of_could(self.map, query)
        against = self._now.against(asked.triples[0])
        return self._tried(partial(questions.could, against=against), asked)

    def _tried(self, answer: Callable[..., R], asked: questions.Asked) -> R | Future[R]:
        """Answer by supposing something of the map itself, or, if that takes long, of a copy beside it."""
        reasoner, names = self.map.reasoner, self.map.classes.prefixed
        needed: list[Triple] | None = None
        self.map.believe_places()
        if questions.is_quick(reasoner, asked):
            try:
                return answer(reasoner, asked, anew=False)
            except questions.Undecided:
                needed = nearby(reasoner, asked.terms)
            except NotCompilable:
                pass
        held = reasoner.held() if needed is None else Held(needed, [])
        return self._aside.submit(lambda: answer(questions.copy_of(held, names), asked))

    def on_export(self, query: Export) -> Future[Document]:
        """The map as a document; checked first, and written beside the node's own work."""
        return self._aside.submit(answers.export, answers.picture(self.map, query.inferred), query.format)

    def on_history(self, query: History) -> Future[tuple[LoggedCommit, ...]]:
        """Commits of the history."""
        return self._aside.submit(self._past.history, query)

    def on_last_seen(self, query: LastSeen) -> Sighting | Future[Sighting]:
        """Where an entity was last; where it is, if it is there."""
        if (entity := self.map.find(query.name)) is not None:
            return history.sighting(entity, None)
        return self._aside.submit(self._past.last_seen, query.name)

    def on_undo(self, command: TakeBack) -> Effects | None:
        """A commit that takes back another one."""
        return self._changed(lambda: undo.undo(self.map, self._journal, command), command.dry_run)

    def on_load_tbox(self, load: LoadTBox) -> Loaded:
        """Another TBox, in one commit (none for the one that holds), and what is to be known of it."""
        read = document_change.tbox_of(self.map, load, label_prefix=f"t{uuid.uuid4().hex[:8]}")
        tbox = blank_nodes.labelled_like(read, self.map.tbox)
        document_change.require_no_map(self.map, load, tbox)
        transaction = document_change.of_tbox(self.map, load, tbox)
        if transaction is None:
            commit = self._journal.commit_of(load.id)
            return Loaded(commit=_effects(commit), skipped=(), notes=self._notes())
        try:
            effects = self._changed(lambda: self.map.replace_tbox(transaction, tbox), load.dry_run)
            return Loaded(commit=effects, skipped=(), notes=self._notes())
        except tbox_validation.DoesNotFit as error:
            raise tbox_validation.DoesNotFit(
                f"{error.text}; it would replace the current TBox, so it must include whatever is to stay"
            ) from None

    def on_check(self, query: Check) -> Future[Checked]:
        """Consistency, worked out beside the node's own work."""
        self.map.follow_places()
        held, denied = self.map.reasoner.held(), self._now.denied()
        withheld, crowds = tuple(answers.withheld(self.map)), self.map.places.crowds()
        return self._aside.submit(
            lambda: structs.replace(
                answers.check(held.asserted, query.engine), denied=denied, withheld=withheld, crowds=crowds
            )
        )

    def on_sparql(self, query: Sparql) -> Future[SparqlResult]:
        """A query, evaluated beside the node's own work."""
        return self._sparql.ask(query, self.map.seq)

    def on_watch(self, query: Watch) -> Watching | Future[Watching]:
        """A standing query, or a standing question of where things are."""
        asks_where = query.where is not None or query.class_ is not None
        if (query.query is None) != asks_where:
            raise errors.BadRequest(
                "watch either a SELECT query or what is on, in or near something: --on, --in, --near"
            )
        if not asks_where:
            return self._sparql.ask(query, self.map.seq)
        if query.where is None or query.inferred:
            raise errors.BadRequest(
                "--class and --inferred: watch classes with --on, --in or --near, inferences with --sparql"
            )
        return self._standing_places.watch(query)

    def on_renew(self, renewal: Renew) -> Done | Future[Done]:
        """A standing query goes on, or ends."""
        return self._standing_places.renew(renewal) or self._sparql.ask(renewal, self.map.seq)

    def close(self) -> None:
        """Leave a checkpoint for a quick start, if the disk takes it."""
        self._sparql.close()
        self._aside.shutdown(wait=False, cancel_futures=True)
        with suppress(errors.Refused):
            if self._writing is not None:
                self.map.written(self._writing.result())
            if not self.map.is_large or self.map.checkpoint_is_due(quiet=True):
                self.map.checkpoint()

    def _checkpoint(self) -> None:
        """In a quiet moment, if there is one."""
        quiet, self._seq_then = self.map.seq == self._seq_then, self.map.seq
        if self.map.checkpoint_is_due(quiet=quiet):
            self._begin_checkpoint()

    def _checkpoint_if_urgent(self) -> None:
        if self.map.checkpoint_is_urgent:
            self._begin_checkpoint()

    def _begin_checkpoint(self) -> None:
        """Write the map down as it is now, beside the node's other work."""
        if self._writing is not None:
            return
        picture = self.map.picture()

        def write() -> int:
            self._journal.checkpoint(picture)
            return picture.seq

        def end(done: Future[int]) -> None:
            self._writing = None
            heap.trim()
            self.map.written(done.result())

        self._writing = self._beside.submit(write)
        self._writing.add_done_callback(lambda done: self._node.soon(lambda: end(done)))

    def _notes(self) -> tuple[str, ...]:
        return tbox_notes.notes(self.map.tbox, self.map.reasoner, self.map.classes)

    def _summary(self) -> str:
        entities = wording.entities(len(self.map))
        return f"{entities}, {len(self.map.reasoner)} triples, commit {self.map.seq}"


def _outcome(result: Commit | errors.SemmapError | None) -> Outcome:
    if isinstance(result, errors.SemmapError):
        return Outcome(error=errors.to_message(result))
    return Outcome(commit=_effects(result))


def _effects(commit: Commit | None) -> Effects | None:
    return None if commit is None else Effects.of(commit)


def run(config: KbConfig) -> None:
    """Serve until stopped."""
    path = config.data / FILENAME
    if not path.exists():
        raise errors.BadFile(f"there is no map in {config.data}; seed one with --tbox and --abox")
    with open_node("kb_node", config.network) as node:
        journal = Journal(path)
        try:
            with gc_pause.uncollected(freeze=True):
                knowledge_base = KnowledgeBase(node, journal)
            heap.trim()
            node.run()
            knowledge_base.close()
        finally:
            journal.close()
