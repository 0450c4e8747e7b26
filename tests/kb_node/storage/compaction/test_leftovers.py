"""Compacted commits are deleted in steps, and later ones stay."""

import pytest
from msgspec import structs

from semmap.nodes.kb_node.storage.compaction import leftovers
from semmap.nodes.kb_node.storage.journal import FILENAME, Checkpoint, Journal
from semmap.nodes.kb_node.storage.journal.beginning import Beginning
from tests.kb_node.relations.entities import thing
from tests.kb_node.storage.journal.test_journal import commit


@pytest.fixture
def journal(tmp_path):
    """A journal of nine commits, each of which changed two of seven entities."""
    made = Journal.create(tmp_path / FILENAME, b"<urn:t> <urn:t> <urn:t> .\n")
    for seq in range(1, 10):
        changed = tuple(thing(f"cup{name}", None) for name in {seq % 7, (seq + 3) % 7})
        made.append(structs.replace(commit(seq), changed=changed))
    yield made
    made.close()


def stored(journal):
    with journal.file.reading() as db:
        commits = [seq for (seq,) in db.execute("SELECT seq FROM commits ORDER BY seq")]
        touches = set(db.execute("SELECT name, seq FROM touches"))
    return commits, touches


@pytest.mark.parametrize("rows", [1, 2, 3, 100])
@pytest.mark.parametrize("until", [1, 5, 9])
def test_compacted_commits_are_deleted_in_steps(journal, monkeypatch, rows, until):
    monkeypatch.setattr(leftovers, "_ROWS", rows)
    before = stored(journal)
    assert not leftovers.exist(journal)
    head = Beginning(seq=until, stamp_ns=1, chain=journal.digest(until))
    journal.start_from(head, Checkpoint(seq=until))
    assert leftovers.exist(journal)
    leftovers.delete(journal)
    assert not leftovers.exist(journal)
    later = {(name, seq) for name, seq in before[1] if seq > until}
    assert stored(journal) == ([seq for seq in before[0] if seq > until], later)
