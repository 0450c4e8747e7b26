"""Damaged indexes of a journal are detected."""

import sqlite3

import pytest

from semmap.nodes.kb_node.storage.journal import index_check
from semmap.nodes.kb_node.storage.journal.index_check import Expected, Record
from semmap.schemas.commits import Commit
from tests.kb_node.relations.entities import thing


def commit(seq, name, *, tbox=False):
    changed = (thing(name, None, "box"),)
    return Commit(id=f"id{seq}", seq=seq, stamp_ns=seq, source="operator", changed=changed, tbox=tbox)


@pytest.fixture
def db():
    db = sqlite3.connect(":memory:")
    db.executescript(
        """
        CREATE TABLE commits (seq INTEGER PRIMARY KEY, command_id TEXT);
        CREATE TABLE touches (name TEXT, seq INTEGER);
        CREATE TABLE tboxes (seq INTEGER PRIMARY KEY);
        CREATE TABLE meta (key TEXT PRIMARY KEY, value BLOB);
        INSERT INTO commits VALUES (1, 'id1'), (2, 'id2'), (3, 'id3');
        INSERT INTO touches VALUES ('cup1', 1), ('cup1', 3), ('table1', 2);
        INSERT INTO tboxes VALUES (0), (2);
        """
    )
    yield db
    db.close()


def expected(*numbers):
    found = Expected()
    commits = {1: commit(1, "cup1"), 2: commit(2, "table1", tbox=True), 3: commit(3, "cup1")}
    for number in numbers:
        found.add(commits[number])
    return found


DAMAGE = [
    "UPDATE commits SET command_id = 'other' WHERE seq = 3",
    "DELETE FROM commits WHERE seq = 2",
    "UPDATE touches SET seq = 2 WHERE seq = 3",
    "DELETE FROM touches WHERE name = 'table1'",
    "INSERT INTO touches VALUES ('cup2', 2)",
    "INSERT INTO tboxes VALUES (3)",
    "DELETE FROM tboxes WHERE seq = 2",
]


def test_sound_indexes_match_their_commits(db):
    assert expected(1, 2, 3).matches(db, 0)
    assert expected(2, 3).matches(db, 1)
    assert not expected(1, 2).matches(db, 0)
    assert not expected(1, 2, 3).matches(db, 1)


@pytest.mark.parametrize("damage", DAMAGE)
def test_a_damaged_index_does_not_match_the_commits(db, damage):
    db.execute(damage)
    assert not expected(1, 2, 3).matches(db, 0)


@pytest.mark.parametrize("damage", DAMAGE)
def test_a_damaged_index_is_not_as_recorded(db, damage):
    index_check.write(db, 1, 3)
    record = index_check.read(db)
    assert record.seq == 3
    assert index_check.is_as_recorded(db, 1, record)
    db.execute(damage)
    assert not index_check.is_as_recorded(db, 1, record)


def test_later_and_compacted_commits_do_not_count(db):
    index_check.write(db, 1, 2)
    record = index_check.read(db)
    db.execute("DELETE FROM commits WHERE seq = 3")
    db.execute("DELETE FROM commits WHERE seq = 1")
    assert index_check.is_as_recorded(db, 1, record)
    assert not index_check.is_as_recorded(db, 0, record)


def test_a_record_replaces_the_one_before_and_may_be_missing(db):
    assert index_check.read(db) is None
    index_check.write(db, 0, 2)
    index_check.write(db, 0, 3)
    assert index_check.read(db).seq == 3
    assert not index_check.is_as_recorded(db, 0, Record(3, b"another"))


def test_an_empty_journal_has_a_record_too(db):
    db.executescript("DELETE FROM commits; DELETE FROM touches; DELETE FROM tboxes")
    index_check.write(db, 0, 0)
    assert index_check.is_as_recorded(db, 0, index_check.read(db))
    assert Expected().matches(db, 0)


def test_sqlite_can_read_a_sound_file(db):
    assert index_check.is_well_formed(db)
