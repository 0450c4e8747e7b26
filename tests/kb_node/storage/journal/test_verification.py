"""The verification of a whole journal detects damage anywhere in it."""

import pytest
from msgspec import structs

from semmap.nodes.kb_node.storage.journal import Checkpoint, Journal
from semmap.nodes.kb_node.storage.journal.beginning import Beginning
from semmap.nodes.kb_node.storage.journal.rows import Damaged
from semmap.nodes.kb_node.storage.journal.verification import verify
from semmap.schemas import errors
from tests.kb_node.relations.entities import thing
from tests.kb_node.storage.journal.test_journal import commit, edit, flip


def write(path, *, checkpoint=0, compacted=0):
    """Write a journal of four commits that change cup1, of which the third replaces the TBox."""
    journal = Journal.create(path, b"<urn:t> <urn:t> <urn:t> .\n")
    for seq in range(1, 5):
        changed = structs.replace(commit(seq), changed=(thing("cup1", None),), tbox=seq == 3)
        journal.append(changed, b"<urn:t> <urn:t> <urn:u> .\n" if seq == 3 else None)
        if seq == checkpoint:
            journal.checkpoint(Checkpoint(seq=seq))
    if compacted:
        head = Beginning(seq=compacted, stamp_ns=1, chain=journal.digest(compacted))
        journal.start_from(head, Checkpoint(seq=compacted))
    journal.close()


def verified(path):
    """Return the problem of a journal, or None, and how often its verification reported progress."""
    told = []
    journal = Journal(path)
    try:
        verify(journal, lambda: told.append(""))
    except errors.Refused as error:
        return error, len(told)
    finally:
        journal.close()
    return None, len(told)


@pytest.mark.parametrize(
    ("fields", "rows"), [({}, 4), ({"checkpoint": 2}, 4), ({"checkpoint": 4}, 4), ({"compacted": 2}, 2)]
)
def test_a_sound_journal_is_read_completely(path, fields, rows):
    write(path, **fields)
    assert verified(path) == (None, rows)


@pytest.mark.parametrize("checkpoint", [0, 4])
@pytest.mark.parametrize(
    ("damage", "problem"),
    [
        ("UPDATE tboxes SET value = x'00' WHERE seq = 3", "its TBox is damaged"),
        ("UPDATE tboxes SET value = x'00' WHERE seq = 0", "its TBox is damaged"),
        ("DELETE FROM touches WHERE seq = 2", "an index is damaged"),
        ("DELETE FROM touches WHERE seq = 4", "an index is damaged"),
        ("INSERT INTO touches VALUES ('cup2', 3)", "an index is damaged"),
        ("INSERT INTO tboxes SELECT 4, value, digest FROM tboxes WHERE seq = 3", "an index is damaged"),
        ("UPDATE commits SET command_id = 'x' WHERE seq = 1", "an index is damaged"),
    ],
)
def test_damage_outside_the_commits_is_detected(path, damage, problem, checkpoint):
    write(path, checkpoint=checkpoint)
    edit(path, damage)
    error, _ = verified(path)
    assert problem in error.text


@pytest.mark.parametrize("checkpoint", [0, 4])
@pytest.mark.parametrize("seq", [1, 3, 4])
def test_a_damaged_commit_is_named(path, seq, checkpoint):
    write(path, checkpoint=checkpoint)
    flip(path, "commits", seq)
    error, rows = verified(path)
    assert isinstance(error, Damaged)
    assert (error.last_good, rows) == (seq - 1, seq - 1)


def test_a_damaged_record_of_the_indexes_is_detected(path):
    write(path, checkpoint=2)
    edit(path, "UPDATE meta SET value = x'00' WHERE key = 'index'")
    assert "the record of its indexes is damaged" in verified(path)[0].text


def test_a_damaged_snapshot_is_detected(path):
    write(path, compacted=2)
    edit(path, "UPDATE beginning SET body = x'00'")
    assert "the snapshot at the start of its history is damaged" in verified(path)[0].text
