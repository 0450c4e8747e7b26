"""The stored start of a compacted history."""

import sqlite3

import pytest

from semmap.nodes.kb_node.storage.journal import beginning
from semmap.nodes.kb_node.storage.journal.beginning import Beginning


@pytest.fixture
def db():
    db = sqlite3.connect(":memory:")
    yield db
    db.close()


START = Beginning(
    seq=2, stamp_ns=5, chain=b"c", map_id="ab", begun_ns=1, body_digest=beginning.digest(b"snapshot")
)


def test_a_journal_without_compaction_begins_with_its_first_commit(db):
    assert not beginning.exists(db)
    assert beginning.read(db) == Beginning()
    assert beginning.read(db).seq == 0


def test_the_start_of_a_compacted_history_is_read_back_and_replaced(db):
    beginning.write(db, Beginning(seq=1), b"earlier")
    beginning.write(db, START, b"snapshot")
    assert beginning.exists(db)
    assert beginning.read(db) == START
    assert beginning.body_of(db, START) == b"snapshot"


@pytest.mark.parametrize(
    "damage",
    [
        "DELETE FROM beginning",
        "UPDATE beginning SET seq = 3",
        "UPDATE beginning SET head = x'00'",
        "UPDATE beginning SET digest = x'00'",
    ],
)
def test_a_damaged_start_is_detected(db, damage):
    beginning.write(db, START, b"snapshot")
    db.execute(damage)
    assert beginning.read(db) is None


def test_a_start_of_another_format_is_detected(db):
    beginning.write(db, START, b"snapshot")
    db.execute("UPDATE beginning SET head = x'c0', digest = ?", (beginning.digest(b"\xc0"),))
    assert beginning.read(db) is None


def test_a_damaged_snapshot_is_detected(db):
    beginning.write(db, START, b"snapshot")
    db.execute("UPDATE beginning SET body = x'00'")
    assert beginning.read(db) == START
    assert beginning.body_of(db, START) is None
    db.execute("DELETE FROM beginning")
    assert beginning.body_of(db, START) is None
