"""Checkpoints of a journal: two are kept, and the newest intact one is used."""

import pytest

from semmap.nodes.kb_node.storage.journal import Checkpoint, Journal
from semmap.nodes.kb_node.storage.journal.checkpoints import load_newest
from tests.kb_node.storage.journal.test_journal import commit, edit


@pytest.fixture
def checkpointed(path):
    """A journal of four commits, with checkpoints after the second, third and fourth."""
    journal = Journal.create(path, b"<urn:t> <urn:t> <urn:t> .\n")
    for seq in range(1, 5):
        journal.append(commit(seq))
        if seq > 1:
            journal.checkpoint(Checkpoint(seq=seq, triples=(("<urn:a>", "<urn:b>", f'"{seq}"'),)))
    journal.close()
    return path


def load(path, begins=0):
    journal = Journal(path)
    found = load_newest(journal.file, begins=begins, progress=lambda: None)
    with journal.file.reading() as db:
        kept = [seq for (seq,) in db.execute("SELECT seq FROM checkpoints ORDER BY seq")]
    journal.close()
    return None if found is None else found.seq, kept


def test_an_older_checkpoint_is_kept_as_well(checkpointed):
    assert load(checkpointed) == (4, [3, 4])


@pytest.mark.parametrize(
    ("damage", "used"),
    [
        ("UPDATE checkpoints SET body = x'00' WHERE seq = 4", 3),
        ("UPDATE checkpoints SET digest = x'00' WHERE seq = 4", 3),
        ("UPDATE checkpoints SET body = x'00'", None),
        ("UPDATE checkpoints SET seq = 5 WHERE seq = 4", 3),  # it is of another commit
        ("DELETE FROM checkpoints", None),
    ],
)
def test_a_damaged_checkpoint_is_not_used(checkpointed, caplog, damage, used):
    edit(checkpointed, damage)
    assert load(checkpointed)[0] == used
    assert ("is damaged and not used" in caplog.text) == (not damage.startswith("DELETE"))


@pytest.mark.parametrize(("begins", "used"), [(3, 4), (4, 4), (5, None)])
def test_a_checkpoint_before_the_start_of_the_history_is_not_used(checkpointed, begins, used):
    assert load(checkpointed, begins)[0] == used
