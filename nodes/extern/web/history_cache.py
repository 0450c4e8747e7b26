"""A cache of the history for all tabs: the list of commits, and the map after each commit.

It keeps requested maps, and the commits after them in blocks of 100. Steps from one commit to the next need
no request.
"""

from __future__ import annotations

import asyncio
import logging
import sys
from bisect import bisect_right
from collections import OrderedDict
from collections.abc import Callable, Mapping, Sequence
from typing import Final, TypeVar
from weakref import WeakKeyDictionary

from msgspec import structs

from semmap.nodes.extern.web.live import Live, LiveEvent
from semmap.nodes.extern.web.map_state import Snapshot
from semmap.schemas import bridge, errors, keys
from semmap.schemas.commands import History, List
from semmap.schemas.commits import Commit
from semmap.schemas.entities import Entity
from semmap.schemas.moments import When, read_moment
from semmap.schemas.replies import LoggedCommit

log = logging.getLogger(__name__)

BLOCK: Final = 100
"""Number of commits per request."""
_KEPT: Final = 12
"""Number of cached maps, and of cached blocks. Maps share unchanged entities."""
_ROWS: Final = 500
"""Number of rows of the commit list per request."""
_MOST_ROWS: Final = 50_000
"""Maximum number of cached rows; of a longer history the newest are kept."""
_DETAILED: Final = 2_000
"""Number of the newest rows that keep what they changed, which takes most of the memory of a row."""
_FEW: Final = 2
"""Number of entities whose changes a row keeps."""
_TIMEOUT_S: Final = 30.0
_RETRY_S: Final = 2.0
"""Time after which a request without a reply is repeated."""

T = TypeVar("T")

_CACHES: WeakKeyDictionary[Live, HistoryCache] = WeakKeyDictionary()


def history_cache_of(live: Live) -> HistoryCache:
    """Return the cache of this process, which is created on first use. To be called on the event loop."""
    if live not in _CACHES:
        _CACHES[live] = HistoryCache(live)
    return _CACHES[live]


class HistoryCache:
    """The cache of the history; it is used on the event loop only, as `Live` is."""

    def __init__(self, live: Live) -> None:
        self._live = live
        self.rows: list[LoggedCommit] = []
        """The commits in order, without gaps, up to the newest."""
        self.is_complete = False
        """Whether the first of `rows` is the first commit of the history."""
        self._maps: OrderedDict[int, Mapping[str, Entity]] = OrderedDict()
        self._blocks: OrderedDict[int, Mapping[int, Commit]] = OrderedDict()
        self._listeners: list[Callable[[], None]] = []
        self._reading: asyncio.Task[None] | None = None
        self._map_id = live.map_id
        live.listen(self._on_event)

    def listen(self, listener: Callable[[], None]) -> Callable[[], None]:
        """Call `listener` when `rows` has changed; return a function that stops this."""
        self._listeners.append(listener)

        def stop() -> None:
            if listener in self._listeners:
                self._listeners.remove(listener)

        return stop

    @property
    def first(self) -> int:
        """The first cached commit; 1 without any."""
        return self.rows[0].seq if self.rows else 1

    def row(self, seq: int) -> LoggedCommit | None:
        """Return the row of a commit; None if it is not cached."""
        place = seq - self.first
        return self.rows[place] if self.rows and 0 <= place < len(self.rows) else None

    def seq_at(self, when: When) -> int:
        """Return the last commit at a moment. Raises BadRequest, or Refused for a moment without a commit."""
        moment = read_moment(when)
        last = self._live.commit
        if moment.commit is not None:
            seq = moment.commit
        else:
            seq = self.first - 1 + bisect_right([row.stamp_ns for row in self.rows], moment.last_ns)
        if seq > last:
            raise errors.Refused(f"commit {seq} does not exist yet; the last commit is {last}")
        if seq < self.first and self.is_complete:
            raise errors.Refused(f"the history begins with commit {self.first}")
        return max(seq, 1)

    # The list of commits

    def start_reading(self) -> None:
        """Start to read the commits that are not cached, the newest first."""
        if self._reading is None or self._reading.done():
            self._reading = asyncio.get_running_loop().create_task(self._read())

    async def read(self) -> None:
        """Read the commits that are not cached, and wait for the end of it."""
        self.start_reading()
        if self._reading is not None:
            await asyncio.shield(self._reading)  # other callers wait for it, too

    async def _read(self) -> None:
        try:
            await self._read_newest()
            while not self.is_complete and self.rows and len(self.rows) < _MOST_ROWS:
                older = await self._fetch_rows(None, self.first - 1)
                is_old = len(self.rows) >= _DETAILED
                older = [_without_changes(row) if is_old else row for row in older if row.seq < self.first]
                self.is_complete = len(older) < _ROWS
                self.rows[:0] = older
                self._notify()
                await self._read_newest()
        except errors.NoAnswer as error:
            log.info("cannot read the history: %s; it is requested again", error)
            asyncio.get_running_loop().call_later(_RETRY_S, self.start_reading)
        except errors.SemmapError as error:
            log.info("cannot read the history: %s", error)

    async def _read_newest(self) -> None:
        """Read the commits after the last cached one."""
        while not self.rows or self.rows[-1].seq < self._live.commit:
            last = self.rows[-1].seq if self.rows else None
            until = None if last is None else min(last + _ROWS, self._live.commit)
            newer = await self._fetch_rows(None if last is None else last + 1, until)
            newer = [row for row in newer if last is None or row.seq > last]
            if not newer:
                return
            if last is None:
                self.is_complete = len(newer) < _ROWS
            self.rows.extend(newer)
            begin, end = (max(0, len(self.rows) - number) for number in (_DETAILED + len(newer), _DETAILED))
            self.rows[begin:end] = map(_without_changes, self.rows[begin:end])
            if len(self.rows) > _MOST_ROWS:
                del self.rows[:-_MOST_ROWS]
                self.is_complete = False
            self._notify()

    async def _fetch_rows(self, since: int | None, until: int | None) -> Sequence[LoggedCommit]:
        found = await self._live.ask(History(since=since, until=until, limit=_ROWS), _TIMEOUT_S)
        return [_with_few_details(row) for row in found]

    def _notify(self) -> None:
        for listener in tuple(self._listeners):
            listener()

    def _on_event(self, event: LiveEvent) -> None:
        if event.kind == "reset":
            if event.is_new_map or self._map_id != self._live.map_id or self.rows_are_ahead:
                self.rows.clear()
                self._maps.clear()
                self._blocks.clear()
                self.is_complete = False
            self._map_id = self._live.map_id
        if event.kind in ("reset", "commit"):
            self.start_reading()

    @property
    def rows_are_ahead(self) -> bool:
        """Whether more commits are cached than exist: the map was repaired or restored."""
        return bool(self.rows) and self.rows[-1].seq > self._live.commit

    # Snapshots of the map

    async def snapshot(self, seq: int) -> Snapshot:
        """Return the map after a commit. Raises Refused if it does not exist, or NoAnswer."""
        if seq == self._live.commit:
            return _snapshot(dict(self._live.entities), seq)
        base = max(seq - seq % BLOCK, self.first if self.is_complete else 1)
        if seq < base:
            base = seq
        try:
            entities = dict(await self._map_after(base))
            if seq > base:
                block = await self._commits_after(base)
                for number in range(base + 1, seq + 1):
                    _apply(entities, block[number])
        except (KeyError, errors.NoAnswer, errors.UnknownVerb):  # compacted, abridged, or not for this role
            entities = await self._fetch_map(seq)
        return _snapshot(entities, seq)

    async def _map_after(self, seq: int) -> Mapping[str, Entity]:
        if seq not in self._maps:
            _store(self._maps, seq, await self._fetch_map(seq))
        self._maps.move_to_end(seq)
        return self._maps[seq]

    async def _commits_after(self, base: int) -> Mapping[int, Commit]:
        """Return the commits of a block, without abridged ones."""
        last = min(base - base % BLOCK + BLOCK - 1, self._live.commit)
        known = self._blocks.get(base)
        if known is None or last not in known:
            seqs = tuple(range(base + 1, last + 1))
            commits = await self._live.query(keys.BRIDGE, bridge.Recall(seqs=seqs), _TIMEOUT_S)
            known = {commit.seq: commit for commit in commits if commit.abridged is None}
            _store(self._blocks, base, known)
        self._blocks.move_to_end(base)
        return known

    async def _fetch_map(self, seq: int) -> dict[str, Entity]:
        """Request a map from the knowledge base or, in a secure system, from the coordinator."""
        if self._live.identity is None:
            found = await self._live.query(keys.BRIDGE, bridge.Entities(as_of=seq), _TIMEOUT_S)
        else:
            reply = await self._live.ask(List(as_of=seq), _TIMEOUT_S)
            found = tuple(entity for entity in reply if isinstance(entity, Entity))
        return {entity.name: entity for entity in found}


def _store(cache: OrderedDict[int, T], seq: int, value: T) -> None:
    """Add a value to a cache, and remove the least recently used ones."""
    cache[seq] = value
    while len(cache) > _KEPT:
        cache.popitem(last=False)


def _with_few_details(row: LoggedCommit) -> LoggedCommit:
    """Return a commit with the changes of its first entities, and without its notes, to save memory."""
    first = list(dict.fromkeys(change.name for change in row.changes))[:_FEW]
    return structs.replace(
        row,
        agent=sys.intern(row.agent),
        verb=sys.intern(row.verb),
        changed=tuple(map(sys.intern, row.changed)),
        changes=tuple(change for change in row.changes if change.name in first),
        notes=(),
    )


def _without_changes(row: LoggedCommit) -> LoggedCommit:
    return structs.replace(row, changes=()) if row.changes else row


def _apply(entities: dict[str, Entity], commit: Commit) -> None:
    for removed in commit.removed:
        entities.pop(removed.name, None)
    for entity in commit.changed:
        entities[entity.name] = entity


def _snapshot(entities: Mapping[str, Entity], seq: int) -> Snapshot:
    poses = {name: entity.pose for name, entity in entities.items() if entity.pose is not None}
    return Snapshot(entities=entities, poses=poses, commit=seq)
