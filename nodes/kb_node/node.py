"""The knowledge base on the wire: `semmap/bridge/<verb>` in, commits and entities out."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager, suppress
from functools import partial

from semmap.nodes.kb_node.announcing import Announcer
from semmap.nodes.kb_node.answers import whereabouts
from semmap.nodes.kb_node.answers.standing_places import StandingPlaces
from semmap.nodes.kb_node.beliefs import Believed
from semmap.nodes.kb_node.checkpointing import Checkpointing
from semmap.nodes.kb_node.config import KbConfig
from semmap.nodes.kb_node.documents.tbox import tbox_notes
from semmap.nodes.kb_node.handlers.asking import Asking
from semmap.nodes.kb_node.handlers.changing import Changing, Tell
from semmap.nodes.kb_node.handlers.keeping import Keeping
from semmap.nodes.kb_node.handlers.loading import Loading
from semmap.nodes.kb_node.replaying import Player, refusing
from semmap.nodes.kb_node.semantic_map import SemanticMap
from semmap.nodes.kb_node.sparql.protocol import Surrounded
from semmap.nodes.kb_node.sparql.service import SparqlService
from semmap.nodes.kb_node.sparql.standing_queries.news import NewsStand
from semmap.nodes.kb_node.sparql.triples.large_map import LargeMap
from semmap.nodes.kb_node.storage.journal import FILENAME, Journal
from semmap.nodes.kb_node.storage.journal.sqlite_file import NotWritten
from semmap.nodes.runtime import gc_pause, heap
from semmap.nodes.runtime.loop import Node, open_node
from semmap.schemas import errors, keys, wording
from semmap.schemas.commits import Commit

CHECKPOINT_PERIOD_S = 10.0
STARTS_AGAIN = 70
"""The exit status after which supervisord starts the node again."""
_FETCHED_S = 0.05
"""Until it is looked again whether the map is still being fetched."""
CHECKPOINT_DELAY_S = 3.0
"""After a very large commit, which others fetch first."""


class KnowledgeBase:
    """Binds the map to the wire."""

    def __init__(self, node: Node, journal: Journal, config: KbConfig) -> None:
        self._node = node
        self.map = SemanticMap(journal, progress=node.beat)
        self._announcer = Announcer(node.session, self.map.entities(), whereabouts.Now(self.map).described)
        self._checkpointing = Checkpointing(self.map, journal, node.soon)
        self._sparql = SparqlService(
            lambda: self.map.reasoner.asserted(),
            NewsStand(node.session).publish,
            LargeMap(journal, lambda: self.map.reasoner, node.soon),
            self.map.all_believed,
            lambda: Surrounded(placed=self.map.placed(), limits=self.map.classes.limits),
        )
        self.map.broke = node.stop
        self.map.foretell = self._sparql.foretell
        self._standing_places = StandingPlaces(self.map, NewsStand(node.session).publish)
        self._asking = Asking(
            self.map, journal, self._sparql, self._standing_places, asker=lambda: node.asker
        )
        telling_of = self._telling_of
        changing = Changing(
            self.map, journal, spread=self._spread, not_written=self._not_written, telling_of=telling_of
        )
        loading = Loading(self.map, journal, changing, self._sparql, telling_of=telling_of, notes=self._notes)
        self._keeping = Keeping(journal)
        handlers = {
            **changing.handlers(),
            **loading.handlers(),
            **self._asking.handlers(),
            **self._keeping.handlers(),
        }
        self._player: Player | None = None
        if config.replay is not None:
            handlers.update(refusing())
            tell = partial(self._spread, told=False, at_once=True)
            self._player = Player(node, self.map, config.data, config.replay, tell)
        node.serve(keys.BRIDGE, handlers)
        for verb in keys.OF_THE_MAP:
            for prefix in (keys.CMD, keys.commands_as()):
                node.serve_one(prefix, handlers[verb])
        node.follow_newest(keys.LIVE_POSES, self._asking.live.take)
        node.follow(keys.OBSERVATIONS, self._asking.sightings.see)
        node.every(CHECKPOINT_PERIOD_S, self._checkpointing.if_due)
        node.every(CHECKPOINT_PERIOD_S, self._standing_places.drop_expired)
        node.note(self._notes())
        node.head(lambda: (self.map.seq, self.map.digest))
        node.soon(self._follow_places)
        node.ready(self._summary())

    def _follow_places(self) -> None:
        """Between other work: the first commit after a start waits for what is left of it.

        Those who fetch the map go first: nobody is answered by the coordinator before it has all.
        """
        if self._asking.is_being_fetched:
            self._node.later(_FETCHED_S, self._follow_places)
        elif self.map.follow_some():
            self._node.soon(self._follow_places)

    def _spread(self, commit: Commit, *, told: bool, at_once: bool) -> None:
        """Tell everybody, `at_once` or when the reply is on its way: nobody else is answered before that."""
        believed = self.map.believed_of(commit)
        announce = partial(self._announcer.announce, commit, believed, told=told)
        if at_once:
            announce()
        else:
            self._node.afterwards(announce)
        self._node.afterwards(partial(self._follow, commit, believed))
        self._node.describe(self._summary)
        if commit.tbox:
            self._node.note(self._notes())
        if self.map.checkpoint_is_urgent:
            self._node.later(CHECKPOINT_DELAY_S, self._checkpointing.if_urgent)

    def _follow(self, commit: Commit, believed: Believed) -> None:
        """What this node does with a commit when the reply is on its way."""
        self._sparql.follow(commit, believed)
        self._standing_places.follow(commit.seq, commit.names)
        self.map.tidy()

    def _not_written(self, error: NotWritten) -> None:
        self._node.report(error.text)
        self._node.describe(f"{self._summary()}; the disk accepts no commits")

    @contextmanager
    def _telling_of(self, work: str) -> Iterator[Tell]:
        """Lets the heartbeat tell how far a large change is, and prepares for it."""

        def tell(text: str) -> None:
            self._node.describe(f"{work}: {text}")
            self._node.beat()

        try:
            with gc_pause.uncollected(freeze=True):
                yield tell
        finally:
            self._node.afterwards(heap.trim)
            self._node.describe(self._summary)

    def _notes(self) -> tuple[str, ...]:
        return tbox_notes.notes(self.map.tbox, self.map.reasoner, self.map.classes)

    def _summary(self) -> str:
        entities = wording.entities(len(self.map))
        replay = f"{self._player.describe()}: " if self._player is not None else ""
        return f"{replay}{entities}, {len(self.map.reasoner)} triples, commit {self.map.seq}"

    def close(self) -> None:
        """Leave a checkpoint for a quick start, if the disk takes it."""
        self._sparql.close()
        self._asking.close()
        self._keeping.close()
        if self._player is not None:
            self._player.close()
        with suppress(errors.Refused):
            self._checkpointing.close()


def run(config: KbConfig) -> None:
    """Serve until stopped."""
    path = config.data / FILENAME
    if not path.exists():
        raise errors.BadFile(f"there is no map in {config.data}; seed one with --tbox and --abox")
    with open_node("kb_node", config.network) as node:
        journal = Journal(path)
        try:
            with gc_pause.uncollected(freeze=True):
                knowledge_base = KnowledgeBase(node, journal, config)
            heap.trim()
            node.run()
            if not knowledge_base.map.is_sound:
                raise SystemExit(STARTS_AGAIN)
            knowledge_base.close()
        finally:
            journal.close()
