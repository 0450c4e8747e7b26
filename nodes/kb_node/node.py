"""The knowledge base on the wire: `semmap/bridge/<verb>` in, commits and entities out."""

from __future__ import annotations

import uuid
from collections.abc import Iterable
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import suppress

from nodes import bus
from nodes.kb_node import answers, documents, rdf_files, terms
from nodes.kb_node.config import KbConfig
from nodes.kb_node.journal import FILENAME, Journal
from nodes.kb_node.semantic_map import SemanticMap
from nodes.kb_node.sparql.news import NewsStand
from nodes.kb_node.sparql.service import SparqlService
from nodes.loop import Node, open_node
from schemas import codec, errors, keys
from schemas.bridge import BRIDGE, LoadDocument, Loaded, SnapshotQuery, StarQuery
from schemas.commands import (
    Check,
    Checked,
    Classes,
    Document,
    Done,
    Explain,
    Export,
    Get,
    Infer,
    Inferred,
    List,
    Renew,
    Sparql,
    Watch,
)
from schemas.commits import Commit, Snapshot, Star, Transaction
from schemas.entities import ClassInfo, Entity
from schemas.explanations import Explanation
from schemas.sparql import SparqlResult, Watching

CHECKPOINT_PERIOD_S = 10.0


class KnowledgeBase:
    """Binds the map to the wire."""

    def __init__(self, node: Node, journal: Journal) -> None:
        self._node = node
        tbox = rdf_files.parse(journal.tbox(), f"the TBox in {journal.path}")
        self.map = SemanticMap(journal, tbox, progress=node.beat)
        self._commits = bus.publisher(node.session, keys.COMMIT)
        self._published = {entity.name: entity.types for entity in self.map.entities()}
        self._aside = ThreadPoolExecutor(max_workers=2, thread_name_prefix="check")
        self._sparql = SparqlService(lambda: self.map.reasoner.asserted(), NewsStand(node.session).publish)
        functions = {
            name.removeprefix("on_"): getattr(self, name) for name in dir(self) if name.startswith("on_")
        }
        node.serve(keys.BRIDGE, {verb: (BRIDGE[verb][0], function) for verb, function in functions.items()})
        node.every(CHECKPOINT_PERIOD_S, self._checkpoint)
        node.ready(self._summary())

    def on_commit(self, transaction: Transaction) -> Commit | None:
        """One transaction: journal (durable), publish, reply."""
        terms.require_triples(transaction.insert)
        return self._commit(transaction)

    def _commit(self, transaction: Transaction) -> Commit | None:
        before = self.map.seq
        commit = self.map.commit(transaction)
        if commit is not None and commit.seq > before:
            self._publish(commit)
            self._sparql.follow(commit)
        return commit

    def on_load(self, load: LoadDocument) -> Loaded:
        """An RDF document in one commit."""
        label = f"f{uuid.uuid4().hex[:8]}"
        triples = rdf_files.parse(load.content, load.filename, label_prefix=label)
        kept, skipped = documents.sort_out(triples, self.map.classes, skip_unknown=load.skip_unknown)
        transaction = Transaction(
            id=load.id,
            source=load.source,
            agent=load.agent,
            reason=load.reason,
            retract=tuple(self.map.abox()) if load.replace else (),
            insert=tuple(t for t in kept if t not in self.map.tbox),
        )
        return Loaded(commit=self._commit(transaction), skipped=tuple(skipped))

    def on_snapshot(self, _: SnapshotQuery) -> Snapshot:
        """Every entity, as of the last commit."""
        return self.map.snapshot()

    def on_star(self, query: StarQuery) -> tuple[Star, ...]:
        """The triples about some entities."""
        return self.map.stars(query.names)

    def on_classes(self, _: Classes) -> tuple[ClassInfo, ...]:
        """The class table."""
        return tuple(self.map.class_table())

    def on_list(self, query: List) -> tuple[Entity, ...]:
        """The entities of a class."""
        return answers.entities_of(self.map, query.class_)

    def on_get(self, query: Get) -> Entity:
        """One entity."""
        return self.map.entity(query.name)

    def on_infer(self, query: Infer) -> Inferred:
        """What follows."""
        return answers.infer(self.map, query.name)

    def on_explain(self, query: Explain) -> Explanation:
        """Why it follows."""
        return answers.explain(self.map, query)

    def on_export(self, query: Export) -> Future[Document]:
        """The map as a document; checked first, and written beside the node's own work."""
        return self._aside.submit(answers.export, answers.picture(self.map, query.inferred), query.format)

    def on_check(self, query: Check) -> Future[Checked]:
        """Consistency, worked out beside the node's own work."""
        return self._aside.submit(answers.check, [*self.map.tbox, *self.map.abox()], query.engine)

    def on_sparql(self, query: Sparql) -> Future[SparqlResult]:
        """A query, evaluated beside the node's own work."""
        return self._sparql.ask(query, self.map.seq)

    def on_watch(self, query: Watch) -> Future[Watching]:
        """A standing query."""
        return self._sparql.ask(query, self.map.seq)

    def on_renew(self, renewal: Renew) -> Future[Done]:
        """A standing query goes on, or ends."""
        return self._sparql.ask(renewal, self.map.seq)

    def close(self) -> None:
        """Leave a checkpoint for a quick start, if the disk takes it."""
        self._sparql.close()
        self._aside.shutdown(wait=False, cancel_futures=True)
        with suppress(errors.Refused):
            self.map.checkpoint()

    def _checkpoint(self) -> None:
        if self.map.checkpoint_is_due:
            self.map.checkpoint()

    def _publish(self, commit: Commit) -> None:
        """The commit, and under each of its classes the entity or, where it is no more, a delete."""
        self._commits.put(codec.encode(commit), encoding=codec.encoding_of(commit))
        for gone in commit.removed:
            self._unpublish(gone.name, self._published.pop(gone.name, gone.types))
        for entity in commit.changed:
            lost = set(self._published.get(entity.name, ())).difference(entity.types)
            self._unpublish(entity.name, sorted(lost))
            payload, encoding = codec.encode(entity), codec.encoding_of(entity)
            for class_name in entity.types:
                self._node.session.put(keys.entity_key(class_name, entity.name), payload, encoding=encoding)
            self._published[entity.name] = entity.types
        self._node.describe(self._summary())

    def _unpublish(self, name: str, class_names: Iterable[str]) -> None:
        for class_name in class_names:
            self._node.session.delete(keys.entity_key(class_name, name))

    def _summary(self) -> str:
        return f"{len(self.map)} entities, {len(self.map.reasoner)} triples, commit {self.map.seq}"


def run(config: KbConfig) -> None:
    """Serve until stopped."""
    path = config.data / FILENAME
    if not path.exists():
        raise errors.BadFile(f"there is no map in {config.data}; seed one with --tbox and --abox")
    with open_node("kb_node", config.network) as node:
        journal = Journal(path)
        try:
            knowledge_base = KnowledgeBase(node, journal)
            node.run()
            knowledge_base.close()
        finally:
            journal.close()
