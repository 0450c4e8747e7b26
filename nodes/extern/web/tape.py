"""The past of the map for all tabs: what its commits are, and the map as it was after each.

A map that was asked for is kept, and so are the commits after it, some hundred at a time: to step from one
commit to the next, forward or backward, nothing is asked for, and a few entities are exchanged.
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

from semmap.nodes.extern.web.live import Happening, Live
from semmap.nodes.extern.web.moments import Past
from semmap.schemas import bridge, errors, keys
from semmap.schemas.commands import History, List
from semmap.schemas.commits import Commit
from semmap.schemas.entities import Entity
from semmap.schemas.moments import When, read_moment
from semmap.schemas.replies import LoggedCommit

log = logging.getLogger(__name__)

BLOCK: Final = 100
"""Commits that are asked for together."""
_KEPT: Final = 12
"""Maps, and blocks of commits, that are kept; each entity that did not change is there once."""
_ROWS: Final = 500
"""Commits whose headlines are asked for together."""
_MOST_ROWS: Final = 50_000
"""Headlines that are kept; of a longer history those of the newest."""
_PATIENCE_S: Final = 30.0

T = TypeVar("T")

_TAPES: WeakKeyDictionary[Live, Tape] = WeakKeyDictionary()


def tape_of(live: Live) -> Tape:
    """The one of this process; made when it is first wanted, on the event loop."""
    if live not in _TAPES:
        _TAPES[live] = Tape(live)
    return _TAPES[live]


class Tape:
    """Belongs to the event loop, as `Live` does."""

    def __init__(self, live: Live) -> None:
        self._live = live
        self.rows: list[LoggedCommit] = []
        """What is known of the commits, in order; without gaps, up to the newest."""
        self.begins_there = False
        """The first of `rows` is the first that there is."""
        self._maps: OrderedDict[int, Mapping[str, Entity]] = OrderedDict()
        self._blocks: OrderedDict[int, Mapping[int, Commit]] = OrderedDict()
        self._told: list[Callable[[], None]] = []
        self._reading: asyncio.Task[None] | None = None
        self._map_id = live.map_id
        live.listen(self._on_happening)

    def listen(self, told: Callable[[], None]) -> Callable[[], None]:
        """Call `told` when more is known of the commits; what is returned ends that."""
        self._told.append(told)

        def stop() -> None:
            if told in self._told:
                self._told.remove(told)

        return stop

    @property
    def first(self) -> int:
        """The first commit that is known of; 1 before any is."""
        return self.rows[0].seq if self.rows else 1

    def row(self, seq: int) -> LoggedCommit | None:
        """What is known of a commit."""
        place = seq - self.first
        return self.rows[place] if self.rows and 0 <= place < len(self.rows) else None

    def seq_at(self, when: When) -> int:
        """The commit after which the map was as then. Raises BadRequest, Refused for what is not there."""
        moment = read_moment(when)
        last = self._live.commit
        if moment.commit is not None:
            seq = moment.commit
        else:
            seq = self.first - 1 + bisect_right([row.stamp_ns for row in self.rows], moment.last_ns)
        if seq > last:
            raise errors.Refused(f"there is no commit {seq} yet; the last one is {last}")
        if seq < self.first and self.begins_there:
            raise errors.Refused(f"that is before the history begins, with commit {self.first}")
        return max(seq, 1)

    # What its commits are

    def read(self) -> None:
        """Begin to read what the commits are, the newest first; what is known already is not read again."""
        if self._reading is None or self._reading.done():
            self._reading = asyncio.get_running_loop().create_task(self._read())

    async def caught_up(self) -> None:
        """Wait until what the commits are has been read, as far as it can be."""
        self.read()
        if self._reading is not None:
            await asyncio.shield(self._reading)  # others wait for it, too

    async def _read(self) -> None:
        try:
            await self._read_newest()
            while not self.begins_there and self.rows and len(self.rows) < _MOST_ROWS:
                older = await self._asked(None, self.first - 1)
                older = [row for row in older if row.seq < self.first]
                self.begins_there = len(older) < _ROWS
                self.rows[:0] = older
                self._tell()
                await self._read_newest()
        except errors.SemmapError as error:
            log.info("the history cannot be read just now: %s", error)

    async def _read_newest(self) -> None:
        """Those that came since the last one that is known."""
        while not self.rows or self.rows[-1].seq < self._live.commit:
            last = self.rows[-1].seq if self.rows else None
            until = None if last is None else min(last + _ROWS, self._live.commit)
            newer = await self._asked(None if last is None else last + 1, until)
            newer = [row for row in newer if last is None or row.seq > last]
            if not newer:
                return
            if last is None:
                self.begins_there = len(newer) < _ROWS
            self.rows.extend(newer)
            if len(self.rows) > _MOST_ROWS:
                del self.rows[:-_MOST_ROWS]
                self.begins_there = False
            self._tell()

    async def _asked(self, since: int | None, until: int | None) -> Sequence[LoggedCommit]:
        found = await self._live.ask(History(since=since, until=until, limit=_ROWS), _PATIENCE_S)
        return [_headline(row) for row in found]

    def _tell(self) -> None:
        for told in tuple(self._told):
            told()

    def _on_happening(self, happening: Happening) -> None:
        if happening.kind == "begun":
            if happening.anew or self._map_id != self._live.map_id or self.rows_are_ahead:
                self.rows.clear()
                self._maps.clear()
                self._blocks.clear()
                self.begins_there = False
            self._map_id = self._live.map_id
        if happening.kind in ("begun", "commit"):
            self.read()

    @property
    def rows_are_ahead(self) -> bool:
        """Is more known than there is? Then the map was repaired or restored, and has another past."""
        return bool(self.rows) and self.rows[-1].seq > self._live.commit

    # The map as it was

    async def past(self, seq: int) -> Past:
        """The map after a commit. Raises Refused where it is not there any more or not yet, NoAnswer."""
        if seq == self._live.commit:
            return _past(dict(self._live.entities), seq)
        base = max(seq - seq % BLOCK, self.first if self.begins_there else 1)
        if seq < base:
            base = seq
        try:
            entities = dict(await self._map_after(base))
            if seq > base:
                block = await self._commits_after(base)
                for number in range(base + 1, seq + 1):
                    _apply(entities, block[number])
        except (KeyError, errors.NoAnswer, errors.UnknownVerb):  # compacted, abridged, or not for this role
            entities = await self._asked_map(seq)
        return _past(entities, seq)

    async def _map_after(self, seq: int) -> Mapping[str, Entity]:
        if seq not in self._maps:
            _keep(self._maps, seq, await self._asked_map(seq))
        self._maps.move_to_end(seq)
        return self._maps[seq]

    async def _commits_after(self, base: int) -> Mapping[int, Commit]:
        """Those of a block, as far as there are any; one that is abridged is not among them."""
        last = min(base - base % BLOCK + BLOCK - 1, self._live.commit)
        known = self._blocks.get(base)
        if known is None or last not in known:
            seqs = tuple(range(base + 1, last + 1))
            commits = await self._live.query(keys.BRIDGE, bridge.Recall(seqs=seqs), _PATIENCE_S)
            known = {commit.seq: commit for commit in commits if commit.abridged is None}
            _keep(self._blocks, base, known)
        self._blocks.move_to_end(base)
        return known

    async def _asked_map(self, seq: int) -> dict[str, Entity]:
        """As the knowledge base has it; where this role may not ask that, as the coordinator tells it."""
        if self._live.identity is None:
            found = await self._live.query(keys.BRIDGE, bridge.Entities(as_of=seq), _PATIENCE_S)
        else:
            reply = await self._live.ask(List(as_of=seq), _PATIENCE_S)
            found = tuple(entity for entity in reply if isinstance(entity, Entity))
        return {entity.name: entity for entity in found}


def _keep(kept: OrderedDict[int, T], seq: int, what: T) -> None:
    """Keep it, and of the others those that were wanted last."""
    kept[seq] = what
    while len(kept) > _KEPT:
        kept.popitem(last=False)


def _headline(row: LoggedCommit) -> LoggedCommit:
    """A commit as it is kept: who, when and why, and what it touched, without how that was and is."""
    return structs.replace(
        row,
        agent=sys.intern(row.agent),
        verb=sys.intern(row.verb),
        changed=tuple(map(sys.intern, row.changed)),
        changes=(),
        notes=(),
    )


def _apply(entities: dict[str, Entity], commit: Commit) -> None:
    for gone in commit.removed:
        entities.pop(gone.name, None)
    for entity in commit.changed:
        entities[entity.name] = entity


def _past(entities: Mapping[str, Entity], seq: int) -> Past:
    poses = {name: entity.pose for name, entity in entities.items() if entity.pose is not None}
    return Past(entities=entities, poses=poses, commit=seq)
