import pytest

from semmap.nodes.kb_node.storage.checkpointing import CheckpointSchedule
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
