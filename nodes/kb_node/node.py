"""The knowledge base on the wire: it serves `semmap/bridge/<command>` and publishes commits and entities."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from contextlib import contextmanager, suppress
from functools import partial
from pathlib import Path

from semmap.nodes.kb_node.answers import entity_queries
from semmap.nodes.kb_node.answers.location_queries import LocationQueries
from semmap.nodes.kb_node.answers.past.trail_recording import WRITE_PERIOD_S
from semmap.nodes.kb_node.commit_publisher import CommitPublisher
from semmap.nodes.kb_node.config import KbConfig
from semmap.nodes.kb_node.derived_facts import DerivedChanges
from semmap.nodes.kb_node.documents.tbox import tbox_notes
from semmap.nodes.kb_node.handlers.body_shapes import ShapeHandlers
from semmap.nodes.kb_node.handlers.changes import ChangeHandlers, Report
from semmap.nodes.kb_node.handlers.loading import LoadHandlers
from semmap.nodes.kb_node.handlers.maintenance import MaintenanceHandlers
from semmap.nodes.kb_node.handlers.queries import QueryHandlers
from semmap.nodes.kb_node.replaying import ReplayPlayer, rejecting_handlers
from semmap.nodes.kb_node.semantic_map import SemanticMap
from semmap.nodes.kb_node.shacl.enforcement import ShapeEnforcement
from semmap.nodes.kb_node.sparql.protocol import Placements
from semmap.nodes.kb_node.sparql.service import SparqlService
from semmap.nodes.kb_node.sparql.standing_queries.row_publisher import RowPublisher
from semmap.nodes.kb_node.sparql.triples.large_map import LargeMap
from semmap.nodes.kb_node.storage import body_shapes
from semmap.nodes.kb_node.storage.checkpointing import Checkpointing
from semmap.nodes.kb_node.storage.journal import FILENAME, Journal
from semmap.nodes.kb_node.storage.journal.sqlite_file import DiskFull, NotWritten
from semmap.nodes.runtime import memory
from semmap.nodes.runtime.loop import Node, open_node
from semmap.schemas import errors, keys, wording
from semmap.schemas.commits import Commit

CHECKPOINT_PERIOD_S = 10.0
STARTS_AGAIN = 70
"""The exit status after which supervisord restarts the node."""
_FETCHED_S = 0.05
"""Period of the check whether the map is still being fetched [s]."""
_ROOM_PERIOD_S = 1.0
"""Period of the check whether a full disk has space again [s]."""
_PUBLISHED_AT_ONCE = 100
CHECKPOINT_DELAY_S = 3.0
"""Delay after a very large commit, which other nodes fetch first."""


class KnowledgeBase:
    """Connects the map to the wire."""

    def __init__(self, node: Node, journal: Journal, config: KbConfig) -> None:
        self._node = node
        file = journal.path.with_name(body_shapes.FILENAME)
        if problem := body_shapes.load(file):
            node.report(problem)
        self.map = SemanticMap(journal, progress=node.beat)
        if config.enforce_shapes:
            self.map.enforcement = ShapeEnforcement(self.map.tbox, is_stored=True)
        self._publisher = CommitPublisher(
            node.session, self.map.entities(), entity_queries.CurrentState(self.map).describe
        )
        self._checkpointing = Checkpointing(self.map, journal, node.soon)
        self._sparql = SparqlService(
            lambda: self.map.reasoner.asserted(),
            RowPublisher(node.session).publish,
            LargeMap(journal, lambda: self.map.reasoner, node.soon),
            self.map.all_derived,
            lambda: Placements(placed=self.map.placed(), limits=self.map.classes.limits),
            lambda: self.map.reasoner.closed,
        )
        self.map.on_failure = node.stop_failed
        self.map.prepare = self._sparql.prepare
        self._location_queries = LocationQueries(self.map, RowPublisher(node.session).publish)
        self._queries = QueryHandlers(
            self.map,
            journal,
            self._sparql,
            self._location_queries,
            asker=lambda: node.asker,
            report=node.report,
        )
        report_progress = self._report_progress
        changes = ChangeHandlers(
            self.map,
            journal,
            publish=self._publish,
            on_write_error=self._on_write_error,
            report_progress=report_progress,
        )
        self._loading = LoadHandlers(
            self.map,
            journal,
            changes,
            self._sparql,
            report_progress=report_progress,
            notes=self._notes,
            run_soon=node.soon,
        )
        self._maintenance = MaintenanceHandlers(journal)
        shapes = ShapeHandlers(self.map, file, self._on_shapes)
        handlers = {
            **changes.handlers(),
            **self._loading.handlers(),
            **self._queries.handlers(),
            **self._maintenance.handlers(),
            **shapes.handlers(),
        }
        self._player: ReplayPlayer | None = None
        if config.replay is not None:
            handlers.update(rejecting_handlers())
            publish = partial(self._publish, told=False, at_once=True)
            self._player = ReplayPlayer(node, self.map, config.data, config.replay, publish)
        node.serve(keys.BRIDGE, handlers)
        for verb in keys.OF_THE_MAP:
            for prefix in (keys.CMD, keys.commands_as()):
                node.serve_one(prefix, handlers[verb])
        node.follow_newest(keys.LIVE_POSES, self._queries.on_live_poses)
        node.follow(keys.OBSERVATIONS, self._queries.sightings.record)
        node.every(WRITE_PERIOD_S, self._queries.trail.write)
        node.every(CHECKPOINT_PERIOD_S, self._checkpointing.begin_if_due)
        node.every(CHECKPOINT_PERIOD_S, self._location_queries.drop_expired)
        node.note(self._notes())
        node.head(lambda: (self.map.seq, self.map.digest))
        node.soon(self._derive_places)
        node.ready(self._summary())

    def _derive_places(self) -> None:
        """Derive facts between other work, because the first commit after a start waits for what is left.

        Nodes that fetch the map have priority: the coordinator serves no commands before it has all entities.
        """
        if self._queries.copies.is_being_fetched:
            self._node.later(_FETCHED_S, self._derive_places)
        elif self.map.derive_some():
            self._node.soon(self._derive_places)

    def _publish(self, commit: Commit, *, told: bool, at_once: bool) -> None:
        """Publish a commit, `at_once` or after the reply is sent."""
        derived_changes = self.map.take_derived_changes(commit)
        publish = partial(self._publisher.publish, commit, derived_changes, told=told)
        if at_once:
            publish()
        else:
            self._node.afterwards(publish)
        self._node.afterwards(partial(self._follow, commit, derived_changes))
        self._node.describe(self._summary)
        if commit.tbox:
            self._node.note(self._notes())
        if self.map.checkpoint_is_urgent:
            self._node.later(CHECKPOINT_DELAY_S, self._checkpointing.begin_if_urgent)

    def _follow(self, commit: Commit, derived_changes: DerivedChanges) -> None:
        """Update the SPARQL process and the standing queries after the reply is sent."""
        self._sparql.follow(commit, derived_changes)
        self._location_queries.follow(commit.seq, commit.names)
        self.map.clean_up()

    def _on_shapes(self, names: Collection[str]) -> None:
        """Pass on shapes, and relations that have changed without a commit.

        Nodes with a replica of the map fetch it again, page by page.
        """
        self._node.note_shapes()
        self._sparql.reload()
        self._location_queries.follow(self.map.seq, names)
        self._publish_some(sorted(names))

    def _publish_some(self, names: Sequence[str]) -> None:
        """Publish entities whose relations have changed, some at a time between other work."""
        some, rest = names[:_PUBLISHED_AT_ONCE], names[_PUBLISHED_AT_ONCE:]
        self._publisher.publish_entities(filter(None, map(self.map.find, some)))
        if rest:
            self._node.soon(partial(self._publish_some, rest))

    def _on_write_error(self, error: NotWritten) -> None:
        self._node.report(error.text)
        self._node.describe(f"{self._summary()}; the disk accepts no commits")

    @contextmanager
    def _report_progress(self, work: str) -> Iterator[Report]:
        """Report the progress of a large change in the heartbeat, and prepare the process for it."""

        def report(text: str) -> None:
            self._node.describe(f"{work}: {text}")
            self._node.beat()

        try:
            with memory.uncollected(freeze=True):
                yield report
        finally:
            self._node.afterwards(memory.trim)
            self._node.describe(self._summary)

    def _notes(self) -> tuple[str, ...]:
        return tbox_notes.notes(self.map.tbox, self.map.reasoner, self.map.classes)

    def _summary(self) -> str:
        entities = wording.entities(len(self.map))
        replay = f"{self._player.describe()}: " if self._player is not None else ""
        return f"{replay}{entities}, {len(self.map.reasoner)} triples, commit {self.map.seq}"

    def close(self) -> None:
        """Write a checkpoint for a quick start, if the disk accepts it."""
        self._loading.close()
        self._sparql.close()
        self._queries.close()
        self._maintenance.close()
        if self._player is not None:
            self._player.close()
        with suppress(errors.Refused):
            self._checkpointing.close()


def _open_journal(node: Node, path: Path) -> Journal | None:
    """Open the journal, and wait while its disk is full. Returns None if the node is stopped meanwhile."""
    while True:
        try:
            return Journal(path)
        except DiskFull:
            node.describe(f"disk full: waiting for space in {path.parent}")
            if not node.wait(_ROOM_PERIOD_S):
                return None


def run(config: KbConfig) -> None:
    """Run the node until it is stopped."""
    path = config.data / FILENAME
    if not path.exists():
        raise errors.BadFile(f"there is no map in {config.data}; seed one with --tbox and --abox")
    with open_node("kb_node", config.network) as node:
        journal = _open_journal(node, path)
        if journal is None:
            return
        try:
            with memory.uncollected(freeze=True):
                knowledge_base = KnowledgeBase(node, journal, config)
            memory.trim()
            node.run()
            if not knowledge_base.map.is_sound:
                raise SystemExit(STARTS_AGAIN)
            knowledge_base.close()
        finally:
            journal.close()
