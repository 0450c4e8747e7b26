"""When checkpoints are due, and that they are written one at a time."""

import queue
import threading

import pytest

from semmap.nodes.kb_node.storage.checkpointing import Checkpointing, CheckpointSchedule
from semmap.nodes.kb_node.storage.encoding.checkpoint_encoding import Checkpoint
from semmap.schemas.commits import Commit
from tests.kb_node.home import chair, transaction


def test_a_checkpoint_waits_for_idle_time_up_to_a_limit(semantic_map, monkeypatch):
    monkeypatch.setattr("semmap.nodes.kb_node.storage.checkpointing.CHECKPOINT_EVERY", 2)
    monkeypatch.setattr("semmap.nodes.kb_node.storage.checkpointing.CHECKPOINT_AT_LATEST", 3)
    due = []
    for i in range(3):
        semantic_map.commit(transaction(i, chair(f"chair{i}")))
        due.append((semantic_map.checkpoint_is_due(quiet=True), semantic_map.checkpoint_is_due(quiet=False)))
    assert due == [(False, False), (True, False), (True, True)]
    semantic_map.checkpoint()
    assert not semantic_map.checkpoint_is_due(quiet=True)


def test_a_checkpoint_is_due_after_many_triples_when_idle(semantic_map, monkeypatch):
    monkeypatch.setattr("semmap.nodes.kb_node.storage.checkpointing.CHECKPOINT_EVERY_TRIPLES", 10)
    semantic_map.commit(transaction(1, chair("chair1")))
    assert not semantic_map.checkpoint_is_due(quiet=True)
    semantic_map.commit(transaction(2, chair("chair2")))
    assert semantic_map.checkpoint_is_due(quiet=True)
    assert not semantic_map.checkpoint_is_due(quiet=False)
    semantic_map.checkpoint()
    assert not semantic_map.checkpoint_is_due(quiet=True)


class NoNewTBox:
    """A journal whose TBox does not change."""

    def tbox_changes(self, *, after):
        return []


@pytest.fixture
def schedule(monkeypatch):
    monkeypatch.setattr("semmap.nodes.kb_node.storage.checkpointing.CHECKPOINT_EVERY_TRIPLES", 10)
    return CheckpointSchedule(NoNewTBox(), checkpointed=5)


def changing(inserted, retracted=0):
    triples = (("<urn:s>", "<urn:p>", "<urn:o>"),)
    return Commit(
        id="1", seq=6, stamp_ns=1, source="file", inserted=triples * inserted, retracted=triples * retracted
    )


def test_a_checkpoint_is_urgent_once_most_of_the_map_has_changed(schedule):
    schedule.count(changing(4, 6))
    assert not schedule.is_urgent(range(20))
    schedule.count(changing(1))
    assert schedule.is_urgent(range(22))
    assert not schedule.is_urgent(range(23))


def test_what_changes_while_a_checkpoint_is_written_counts_for_the_next_one(schedule):
    schedule.count(changing(11))
    assert schedule.is_due(6, quiet=True)
    schedule.mark_snapshot()
    schedule.count(changing(10))
    schedule.mark_written(6)
    assert schedule.is_written(6)
    assert not schedule.is_written(7)
    assert not schedule.is_due(7, quiet=True)
    schedule.count(changing(1))
    assert schedule.is_due(8, quiet=True)
    assert not schedule.is_due(8, quiet=False)


def test_a_written_checkpoint_leaves_only_later_changes_to_replay(schedule):
    schedule.count(changing(30))
    schedule.mark_snapshot()
    schedule.mark_written(6)
    schedule.count(changing(11))
    assert schedule.is_urgent(range(22))
    assert not schedule.is_urgent(range(23))


class Written:
    """A map and its journal, which note the checkpoints; a write waits until the test permits it."""

    def __init__(self):
        self.seq, self.is_large = 1, False
        self.is_due_when_quiet = self.is_due_always = self.checkpoint_is_urgent = False
        self.events, self.tasks, self.may_write = [], queue.SimpleQueue(), threading.Event()
        self.checkpointing = Checkpointing(self, self, self.tasks.put)

    def checkpoint_is_due(self, *, quiet):
        return self.is_due_always or (quiet and self.is_due_when_quiet)

    def snapshot_for_checkpoint(self):
        self.events.append(f"snapshot {self.seq}")
        return Checkpoint(seq=self.seq)

    def checkpoint(self, snapshot=None):
        if snapshot is None:
            self.events.append("at the end")
        else:
            assert self.may_write.wait(60.0)
            self.events.append(f"write {snapshot.seq}")

    def written(self, seq):
        self.events.append(f"written {seq}")


def test_a_checkpoint_is_written_sooner_if_nothing_has_changed_since_the_last_time():
    there = Written()
    there.may_write.set()
    there.is_due_when_quiet = True
    there.checkpointing.begin_if_due()
    assert there.events == []  # a commit since
    there.seq = 2
    there.checkpointing.begin_if_due()
    assert there.events == []
    there.checkpointing.begin_if_due()
    there.tasks.get(timeout=60.0)()
    assert there.events == ["snapshot 2", "write 2", "written 2"]
    there.checkpointing.close()


@pytest.mark.parametrize("how", ["due", "urgent"])
def test_one_checkpoint_is_written_at_a_time(how):
    there = Written()
    there.is_due_always, there.checkpoint_is_urgent = how == "due", how == "urgent"
    begin = there.checkpointing.begin_if_due if how == "due" else there.checkpointing.begin_if_urgent
    begin()
    there.seq = 2
    begin()
    there.may_write.set()
    there.tasks.get(timeout=60.0)()
    begin()
    there.tasks.get(timeout=60.0)()
    assert [e for e in there.events if not e.startswith("write ")] == [
        *("snapshot 1", "written 1"),
        *("snapshot 2", "written 2"),
    ]


@pytest.mark.parametrize(
    ("is_large", "is_due", "at_the_end"),
    [(False, False, True), (False, True, True), (True, False, False), (True, True, True)],
)
def test_a_large_map_is_written_at_the_end_only_if_much_has_changed(is_large, is_due, at_the_end):
    there = Written()
    there.checkpointing.begin_if_due()
    there.checkpointing.begin_if_urgent()
    assert there.events == []
    there.is_large, there.is_due_when_quiet = is_large, is_due
    there.checkpointing.close()
    assert there.events == ["at the end"] * at_the_end


def test_the_end_waits_for_a_checkpoint_that_is_being_written():
    there = Written()
    there.is_large = there.checkpoint_is_urgent = True
    there.checkpointing.begin_if_urgent()
    there.may_write.set()
    there.checkpointing.close()
    assert there.events == ["snapshot 1", "write 1", "written 1"]


def test_a_new_tbox_makes_a_checkpoint_due_when_idle(schedule, monkeypatch):
    asked = []
    monkeypatch.setattr(NoNewTBox, "tbox_changes", lambda self, *, after: asked.append(after) or [6])
    assert schedule.is_due(6, quiet=True)
    assert not schedule.is_due(6, quiet=False)
    assert set(asked) == {5}
