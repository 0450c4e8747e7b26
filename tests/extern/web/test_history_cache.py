"""The history cache: its requests and its snapshots."""

import asyncio

import pytest
from msgspec import structs

from semmap.nodes.extern.web import history_cache as history_cache_module
from semmap.nodes.extern.web.history_cache import BLOCK, HistoryCache
from semmap.nodes.extern.web.live import LiveEvent
from semmap.schemas import bridge, errors
from semmap.schemas.changes import Change
from semmap.schemas.commands import History
from semmap.schemas.replies import LoggedCommit
from tests.recorder.messages import START_NS, commit, entity, pose


class Map:
    """A stub of `Live` with a map of `last` commits; it records requests."""

    def __init__(self, last, first=1):
        self.first, self.identity, self.map_id = first, None, "a"
        self.commits, self.states, now = {}, {0: {}}, {}
        for seq in range(1, last + 1):
            self._commit(seq, now)
        self.asked = []
        self.listening = []

    def _commit(self, seq, now):
        name = f"cup{seq % 7}"
        if seq % 11 == 10 and name in now:
            made = commit(seq, removed=(name,))
            del now[name]
        else:
            now[name] = entity(name, "Cup", pose(float(seq)))
            made = commit(seq, now[name])
        self.commits[seq], self.states[seq] = made, dict(now)

    commit = property(lambda self: max(self.commits))
    entities = property(lambda self: self.states[self.commit])

    def listen(self, told):
        self.listening.append(told)
        return lambda: None

    def grow(self):
        seq = self.commit + 1
        self._commit(seq, dict(self.states[seq - 1]))
        for told in self.listening:
            told(LiveEvent(kind="commit", commits=(self.commits[seq],)))

    async def ask(self, command, timeout_s=10.0):
        assert isinstance(command, History)
        until = self.commit if command.until is None else min(command.until, self.commit)
        seqs = range(max(command.since or 0, self.first), until + 1)
        return tuple(map(self._logged, seqs[-command.limit :]))

    def _logged(self, seq):
        made = self.commits[seq]
        about = {"verb": "", "confidence": None, "undoes": (), "tbox": False, "inserted": 0, "retracted": 0}
        return LoggedCommit(
            seq=seq,
            stamp_ns=made.stamp_ns,
            source="operator",
            agent="",
            reason="",
            changed=tuple(e.name for e in made.changed),
            removed=tuple(gone.name for gone in made.removed),
            changes=tuple(Change(name=name, kind="added", now="Cup") for name in ("a", "b", "c", "b")),
            **about,
        )

    async def query(self, prefix, call, timeout_s=10.0):
        self.asked.append(call)
        await asyncio.sleep(0)
        if isinstance(call, bridge.Recall):
            assert 0 < len(call.seqs) <= BLOCK
            return tuple(self.commits[seq] for seq in call.seqs if self.first <= seq <= self.commit)
        if call.as_of < self.first:
            raise errors.Refused("it has been compacted")
        return tuple(self.states[call.as_of].values())


async def whole(live):
    cache = HistoryCache(live)
    cache.start_reading()
    await cache._reading
    return cache


def run(coroutine):
    return asyncio.run(coroutine)


def test_read_waits_for_the_newest_commit():
    async def grown():
        live = Map(20)
        cache = await whole(live)
        live.grow()
        assert cache.row(21) is None  # it is only being asked for
        await asyncio.gather(cache.read(), cache.read())
        return cache.row(21)

    assert run(grown()).seq == 21


def test_a_request_without_a_reply_is_repeated_although_no_commit_follows(monkeypatch):
    monkeypatch.setattr(history_cache_module, "_RETRY_S", 0.0)

    async def run():
        live = Map(5)
        reply, live.ask = live.ask, _no_reply
        history = HistoryCache(live)
        await history.read()
        assert history.rows == []
        live.ask = reply
        has_rows = asyncio.Event()
        history.listen(has_rows.set)
        await asyncio.wait_for(has_rows.wait(), 60.0)
        assert [row.seq for row in history.rows] == [1, 2, 3, 4, 5]

    asyncio.run(run())


async def _no_reply(command, timeout_s):
    raise errors.NoAnswer("no response from the knowledge base")


def test_the_newest_rows_keep_what_they_changed_of_the_first_entities(monkeypatch):
    monkeypatch.setattr(history_cache_module, "_ROWS", 10)
    monkeypatch.setattr(history_cache_module, "_DETAILED", 15)

    async def read():
        live = Map(42)
        cache = await whole(live)
        for _ in range(3):
            live.grow()
            await cache.read()
        return cache.rows

    rows = run(read())
    assert [row.seq for row in rows] == list(range(1, 46))
    told = {row.seq: [change.name for change in row.changes] for row in rows}
    assert all(told[seq] == ["a", "b", "b"] for seq in range(31, 46))
    assert all(told[seq] == [] for seq in range(1, 23))


def test_every_snapshot_equals_the_map_at_that_commit():
    live = Map(350)

    async def see():
        cache = await whole(live)
        for seq in (1, 2, 99, 100, 101, 350, 349, 200, 199, 5, 250, *range(120, 90, -1)):
            past = await cache.snapshot(seq)
            assert past.commit == seq
            assert past.entities == live.states[seq]
            assert past.poses == {name: e.pose for name, e in past.entities.items()}

    run(see())


def test_single_steps_need_no_further_requests():
    live = Map(350)

    async def see():
        cache = await whole(live)
        await cache.snapshot(150)
        asked = len(live.asked)
        for seq in (*range(150, 200), *range(199, 99, -1)):
            await cache.snapshot(seq)
        return asked, len(live.asked)

    assert run(see()) == (2, 2)


def test_the_number_of_cached_maps_is_bounded():
    live = Map(40 * BLOCK)

    async def see():
        cache = await whole(live)
        for seq in range(BLOCK // 2, 40 * BLOCK, BLOCK):
            await cache.snapshot(seq)
        return len(cache._maps), len(cache._blocks)

    assert run(see()) == (history_cache_module._KEPT, history_cache_module._KEPT)


def test_compacted_commits_are_requested_as_whole_maps_or_rejected():
    live = Map(350, first=130)

    async def see():
        cache = await whole(live)
        assert (cache.first, cache.is_complete) == (130, True)
        for seq in (130, 131, 199, 200, 340):
            assert (await cache.snapshot(seq)).entities == live.states[seq]
        with pytest.raises(errors.Refused, match="compacted"):
            await cache.snapshot(100)
        with pytest.raises(errors.Refused, match="the history begins with commit 130"):
            cache.seq_at(100)

    run(see())


def test_rows_have_no_gaps_and_grow_with_the_map(monkeypatch):
    monkeypatch.setattr(history_cache_module, "_ROWS", 60)
    live = Map(350)

    async def see():
        cache = await whole(live)
        assert [row.seq for row in cache.rows] == list(range(1, 351))
        told = []
        cache.listen(lambda: told.append(len(cache.rows)))
        for _ in range(3):
            live.grow()
        await cache._reading
        live.grow()
        await cache._reading
        assert [row.seq for row in cache.rows] == list(range(1, 355))
        assert told[-1] == 354
        assert cache.row(354).seq == 354
        assert cache.row(355) is cache.row(0) is None

    run(see())


def test_abridged_commits_are_replaced_by_whole_maps():
    live = Map(150)
    live.commits[120] = structs.replace(live.commits[120], abridged=live.commits[120].extent, changed=())

    async def see():
        cache = await whole(live)
        for seq in (119, 120, 121, 149):
            assert (await cache.snapshot(seq)).entities == live.states[seq]

    run(see())


def test_moments_can_be_commits_or_times():
    live = Map(50)

    async def see():
        cache = await whole(live)
        assert cache.seq_at("17") == 17
        assert cache.seq_at(START_NS + 20 * 1_000_000_000) == 20
        for said, why in (
            ("51", "commit 51 does not exist yet; the last commit is 50"),
            ("soon", "neither a commit"),
        ):
            with pytest.raises(errors.SemmapError, match=why):
                cache.seq_at(said)

    run(see())


def test_a_new_map_resets_the_cache():
    live = Map(50)

    async def see():
        cache = await whole(live)
        await cache.snapshot(20)
        other = Map(10)
        live.commits, live.states, live.map_id = other.commits, other.states, "b"
        for told in live.listening:
            told(LiveEvent(kind="reset", is_new_map=True))
        await cache._reading
        assert [row.seq for row in cache.rows] == list(range(1, 11))
        assert (await cache.snapshot(5)).entities == other.states[5]

    run(see())


def test_all_tabs_share_one_cache():
    live = Map(3)

    async def see():
        assert history_cache_module.history_cache_of(live) is history_cache_module.history_cache_of(live)

    run(see())


def test_the_newest_rows_of_a_long_history_are_kept(monkeypatch):
    monkeypatch.setattr(history_cache_module, "_MOST_ROWS", 20)

    async def scenario():
        live = Map(18)
        cache = await whole(live)
        assert (cache.first, cache.is_complete) == (1, True)
        for _ in range(5):
            live.grow()
            await cache.read()
        assert [row.seq for row in cache.rows] == list(range(4, 24))
        assert not cache.is_complete
        assert cache.row(3) is None

    asyncio.run(scenario())
