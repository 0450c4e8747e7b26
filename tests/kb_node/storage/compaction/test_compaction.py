"""A compacted journal has the same map and a shorter history."""

import shutil
import time

import pytest

from semmap.nodes.kb_node import undo
from semmap.nodes.kb_node.semantic_map import SemanticMap
from semmap.nodes.kb_node.storage.compaction import compaction, leftovers
from semmap.nodes.kb_node.storage.history import HistoryReader
from semmap.nodes.kb_node.storage.journal import FILENAME, Journal, index_check
from semmap.nodes.kb_node.storage.journal.verification import verify
from semmap.nodes.kb_node.storage.repair.repair import repair
from semmap.schemas import errors
from semmap.schemas.bridge import TakeBack
from semmap.schemas.commands import History
from tests.kb_node import home
from tests.kb_node.documents.tbox.test_tbox_validation import NEW_CLASSES, replace
from tests.kb_node.home import chair, state, transaction
from tests.kb_node.storage.journal.test_journal import edit, flip

DAY_NS = 86_400 * 1_000_000_000


@pytest.fixture
def day(monkeypatch):
    """A clock that counts days."""
    began_ns, days = time.time_ns() - 100 * DAY_NS, [0.0]
    monkeypatch.setattr("time.time_ns", lambda: began_ns + int(days[0] * DAY_NS))

    def is_now(number):
        days[0] = number

    return is_now


@pytest.fixture
def semantic_map(tmp_path, day):
    """A commit a day for ten days: eight chairs, a new TBox on day 5, no chair2 on day 10."""
    made = home.new_map(tmp_path)
    for number in range(1, 11):
        day(number)
        if number == 5:
            replace(made, number, NEW_CLASSES)
        elif number == 10:
            made.commit(transaction(number, retract=chair("chair2"), reason="day 10", verb="remove"))
        else:
            made.commit(transaction(number, chair(f"chair{number}"), reason=f"day {number}", verb="add"))
    yield made
    home.close(made)


def opened(data):
    journal = Journal(data / FILENAME)
    try:
        return state(SemanticMap(journal)), list(journal.commits())
    finally:
        journal.close()


@pytest.mark.parametrize("until", range(1, 10))
def test_compaction_keeps_the_map_and_the_recent_history(tmp_path, semantic_map, until):
    journal, past = semantic_map._journal, HistoryReader(semantic_map._journal)
    before, commits, origin = state(semantic_map), list(journal.commits()), journal.origin()
    as_of = {seq: past.entities(seq) for seq in range(1, 11)}
    compaction.compact(journal, past, until)
    assert list(journal.commits()) == commits[until:]  # their digests, too
    assert {seq: past.entities(seq) for seq in range(until, 11)} == {s: as_of[s] for s in range(until, 11)}
    assert semantic_map.commit(transaction("more", chair("chair11"))).seq == 11
    undo.undo(semantic_map, journal, TakeBack(id="u", source="operator", commit=11))
    home.close(semantic_map)
    after, _ = opened(tmp_path)
    assert after[1:] == before[1:] or {e.name for e in after[2].entities} == {
        e.name for e in before[2].entities
    }
    journal = Journal(tmp_path / FILENAME)
    assert (journal.first, journal.last, journal.origin()) == (until + 1, 12, origin)
    assert not leftovers.exist(journal)
    journal.close()
    assert repair(tmp_path).startswith("nothing is damaged")


def test_the_range_depends_on_stamps(semantic_map, day):
    journal = semantic_map._journal

    def older(days):
        return compaction.choose_range(journal, keep_ns=int(days * DAY_NS), now_ns=time.time_ns())

    day(10.5)
    assert older(30) == (0, 0)
    assert older(3) == (7, 7)
    assert older(0.25) == (9, 9)  # the last one stays
    compaction.compact(journal, HistoryReader(journal), 4)
    assert older(3) == (7, 3)
    assert older(30) == (4, 0)


def test_stamps_in_the_future_are_ignored(tmp_path, day):
    semantic_map = home.new_map(tmp_path)
    for number, stamped in enumerate((1, 900, 2, 8, 3, 9), start=1):
        day(stamped)
        semantic_map.commit(transaction(number, chair(f"chair{number}")))
    day(10)
    share = compaction.choose_range(semantic_map._journal, keep_ns=4 * DAY_NS, now_ns=time.time_ns())
    assert share == (3, 3)  # commit 4 is young, so whatever came after it stays
    home.close(semantic_map)


def test_the_start_of_the_history_is_listed(semantic_map, day):
    journal, past = semantic_map._journal, HistoryReader(semantic_map._journal)
    stamp_ns = journal.stamps.of(6)
    compaction.compact(journal, past, 6)
    first, *rest = past.history(History())
    assert (first.seq, first.verb, first.stamp_ns) == (6, "compact", stamp_ns)
    assert first.reason == "the history begins here, with 5 entities; earlier commits were compacted"
    assert [commit.seq for commit in rest] == [7, 8, 9, 10]
    assert [commit.seq for commit in past.history(History(name="chair2"))] == [6, 10]
    assert [commit.seq for commit in past.history(History(name="chair8"))] == [8]
    assert [commit.seq for commit in past.history(History(since=8))] == [8, 9, 10]
    assert past.commits([3, 7]) == (journal.commit(7),)
    for when in (5, (stamp_ns - DAY_NS) / 1e9):
        with pytest.raises(errors.Refused, match=r"before 6 at .* have been compacted: the history begi"):
            past.entities(when)
    assert len(past.entities((stamp_ns + DAY_NS // 2) / 1e9)) == 5
    with pytest.raises(
        errors.Refused, match="commit 3 cannot be undone: it has been compacted, and the hist"
    ):
        undo.undo(semantic_map, journal, TakeBack(id="u", source="operator", commit=3))
    with pytest.raises(
        errors.UnknownName, match="ever named 'sofa' since commit 6, which the history begins"
    ):
        past.last_seen("sofa")
    assert past.last_seen("chair2").removed is not None


def test_an_interruption_loses_nothing(tmp_path, semantic_map, monkeypatch):
    journal, expected = semantic_map._journal, state(semantic_map)
    commits = list(journal.commits())

    def fail(*_):
        raise MemoryError

    with monkeypatch.context() as patch:
        patch.setattr(index_check, "write", fail)
        with pytest.raises(MemoryError):
            compaction.compact(journal, HistoryReader(journal), 6)
    assert list(journal.commits()) == commits
    with monkeypatch.context() as patch:
        patch.setattr(leftovers, "delete", lambda _: None)
        compaction.compact(journal, HistoryReader(journal), 6)
    home.close(semantic_map)
    after, kept = opened(tmp_path)
    assert {e.name for e in after[2].entities} == {e.name for e in expected[2].entities}
    assert kept == commits[6:]
    journal = Journal(tmp_path / FILENAME)
    assert leftovers.exist(journal)
    leftovers.delete(journal)
    assert not leftovers.exist(journal)
    verify(journal)
    journal.close()


def test_compacting_again_goes_further(tmp_path, semantic_map):
    journal, past = semantic_map._journal, HistoryReader(semantic_map._journal)
    expected, commits = past.entities(10), list(journal.commits())
    for until in (3, 6, 9):
        compaction.compact(journal, past, until)
    assert past.entities(9) != expected
    assert past.entities(10) == expected
    assert list(journal.commits()) == commits[9:]
    home.close(semantic_map)
    assert {e.name for e in opened(tmp_path)[0][2].entities} == {e.name for e in expected}


def test_disk_space_is_freed(tmp_path):
    semantic_map = home.new_map(tmp_path)
    for number in range(1, 101):
        one = chair("chair1", at=(number, 2.0, 0.0))
        semantic_map.commit(transaction(number, one, reason="x" * 2000))
        semantic_map.commit(transaction(-number, retract=one))
    home.close(semantic_map)
    size = (tmp_path / FILENAME).stat().st_size
    journal = Journal(tmp_path / FILENAME)
    compaction.compact(journal, HistoryReader(journal), 190)
    journal.close()
    assert (tmp_path / FILENAME).stat().st_size < size / 3


@pytest.mark.parametrize("checkpoint", [True, False])
@pytest.mark.parametrize("part", ["head", "body"])
def test_a_damaged_snapshot_is_detected(tmp_path, semantic_map, checkpoint, part):
    expected = state(semantic_map)
    compaction.compact(semantic_map._journal, HistoryReader(semantic_map._journal), 6)
    if checkpoint:
        semantic_map.checkpoint()
    home.close(semantic_map)
    edit(tmp_path / FILENAME, f"UPDATE beginning SET {part} = x'1234'")
    with pytest.raises(
        errors.Refused, match=r"start of (?:the|its) history is damaged; recover the intact commits"
    ):
        opened(tmp_path)
    if checkpoint:
        assert repair(tmp_path).startswith("the map continues from commit 10 ")
        after, _ = opened(tmp_path)
        assert {e.name for e in after[2].entities} == {e.name for e in expected[2].entities}
    else:
        with pytest.raises(errors.Refused, match="no checkpoint to continue from; restore a backup"):
            repair(tmp_path)


def test_repair_keeps_the_snapshot(tmp_path, semantic_map):
    compaction.compact(semantic_map._journal, HistoryReader(semantic_map._journal), 6)
    home.close(semantic_map)
    flip(tmp_path / FILENAME, "commits", 8)
    assert repair(tmp_path).startswith("the map continues from commit 10 (commit 8 is damaged and left out)")
    after, commits = opened(tmp_path)
    assert [commit.seq for commit in commits] == [7, 8, 9, 10]
    assert {e.name for e in after[2].entities} == {f"chair{n}" for n in (1, 3, 4, 6, 7, 9)}


def test_an_older_journal_is_not_compacted(tmp_path, semantic_map):
    home.close(semantic_map)
    copy = shutil.copytree(tmp_path, tmp_path / "copy")
    edit(copy / FILENAME, "UPDATE meta SET value = x'35' WHERE key = 'format'")
    with pytest.raises(errors.Refused, match="the start of its history is damaged"):
        Journal(copy / FILENAME)
