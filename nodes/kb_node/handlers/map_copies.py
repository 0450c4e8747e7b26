"""Handlers for copies of the map and its commits, for the replicas of other nodes and for backups."""

from __future__ import annotations

from concurrent.futures import Future

from semmap.nodes.kb_node.answers.pages import Pages
from semmap.nodes.kb_node.semantic_map import SemanticMap
from semmap.nodes.kb_node.storage import history
from semmap.nodes.kb_node.storage.journal import Journal
from semmap.nodes.runtime.fair_queue import FairPool
from semmap.schemas.bridge import CopyQuery, MapCopy, Recall, SnapshotQuery, StarQuery
from semmap.schemas.calls import Handler, by_verb
from semmap.schemas.commits import Commit, Snapshot, Star


class MapCopyHandlers:
    """Returns the entities, triples and commits of the map."""

    def __init__(
        self, semantic_map: SemanticMap, journal: Journal, past: history.HistoryReader, aside: FairPool
    ) -> None:
        """Create the handlers. `aside` executes what takes long."""
        self._map = semantic_map
        self._journal = journal
        self._past = past
        self._aside = aside
        self._pages = Pages(semantic_map)

    def handlers(self) -> dict[str, Handler]:
        """Return the handlers by command."""
        return by_verb(
            SnapshotQuery.answered_by(self.on_snapshot),
            CopyQuery.answered_by(self.on_copy),
            Recall.answered_by(self.on_recall),
            StarQuery.answered_by(self.on_star),
        )

    @property
    def is_being_fetched(self) -> bool:
        """Return whether the map is being fetched page by page, or is likely to be after a start."""
        return self._pages.is_request_expected

    def on_snapshot(self, query: SnapshotQuery) -> Snapshot:
        """Return the entities as of the last commit, or a page of them."""
        return self._pages.snapshot(query)

    def on_copy(self, query: CopyQuery) -> MapCopy:
        """Return the whole map, or only its identity."""
        map_id, begun_ns = self._journal.origin()
        seq = self._map.seq
        return MapCopy(
            map_id=map_id,
            begun_ns=begun_ns,
            seq=seq,
            digest=self._map.digest,
            stamp_ns=self._stamp_of_last(seq),
            triples=tuple(self._map.abox()) if query.content else (),
            entities=tuple(self._map.entities()) if query.content else (),
        )

    def _stamp_of_last(self, seq: int) -> int:
        begins = self._journal.beginning
        return self._journal.stamps.of(seq) if seq > begins.seq else begins.stamp_ns

    def on_recall(self, query: Recall) -> Future[tuple[Commit, ...]]:
        """Return whole commits of the history."""
        return self._aside.submit(self._past.commits, query.seqs)

    def on_star(self, query: StarQuery) -> tuple[Star, ...]:
        """Return the triples of some entities."""
        return self._map.stars(query.names)
