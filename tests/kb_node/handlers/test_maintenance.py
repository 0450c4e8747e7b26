"""Requests to compact the journal, and the rest of a compaction that was interrupted."""

import time

import pytest

from semmap.nodes.kb_node.handlers.maintenance import MaintenanceHandlers
from semmap.nodes.kb_node.storage.compaction import compaction, leftovers
from semmap.nodes.kb_node.storage.history import HistoryReader
from semmap.schemas import errors
from semmap.schemas.commands import Compact
from tests.conftest import PATIENCE_S
from tests.kb_node import home
from tests.kb_node.home import chair, transaction

DAY_NS = 86_400 * 1_000_000_000


@pytest.fixture
def journal(tmp_path, monkeypatch):
    """A journal with a commit a day for four days. Now is two hours after the last."""
    made = home.new_map(tmp_path)
    began_ns = time.time_ns() - 10 * DAY_NS
    for day in range(4):
        monkeypatch.setattr("time.time_ns", lambda day=day: began_ns + day * DAY_NS)
        made.commit(transaction(day, chair(f"chair{day}")))
    monkeypatch.setattr("time.time_ns", lambda: began_ns + 3 * DAY_NS + DAY_NS // 12)
    yield made._journal
    home.close(made)


@pytest.fixture
def maintenance(journal):
    handlers = MaintenanceHandlers(journal)
    yield handlers
    handlers.close()


def compact(maintenance, keep, **fields):
    return maintenance.on_compact(Compact(keep=keep, **fields)).result(PATIENCE_S)


def test_a_dry_run_tells_what_would_be_compacted_and_changes_nothing(maintenance, journal):
    found = compact(maintenance, "36h", dry_run=True)
    assert (found.commits, found.first, found.dry_run) == (2, 3, True)
    assert found.text.startswith(
        "2 commits would become a snapshot, and the history would begin with commit 3"
    )
    assert found.bytes_after == found.bytes_before == journal.size_bytes
    assert journal.first == 1


def test_commits_that_are_old_enough_become_a_snapshot(maintenance, journal):
    found = compact(maintenance, "1d")
    assert (found.commits, found.first, found.dry_run) == (3, 4, False)
    assert found.text.startswith("3 commits became a snapshot: the history begins with commit 4 of ")
    assert journal.first == 4
    again = compact(maintenance, "1d")
    assert (again.commits, again.first) == (0, 4)
    assert again.text.startswith("no commit is older than 1d: the history begins with commit 4 of ")


def test_an_invalid_age_is_rejected(maintenance):
    for keep in ("", "d", "0d", "1w", "1.5d", "-1d", "1d 2h"):
        with pytest.raises(errors.BadRequest, match=f"'{keep}' is not an age; examples: 12h, 30d"):
            compact(maintenance, keep)


def test_an_interrupted_compaction_is_completed_at_the_next_start(journal, monkeypatch):
    with monkeypatch.context() as patch:
        patch.setattr(leftovers, "delete", lambda _: None)
        compaction.compact(journal, HistoryReader(journal), 2)
    assert leftovers.exist(journal)
    handlers = MaintenanceHandlers(journal)
    compact(handlers, "1000d")  # after the rest of the earlier one
    assert not leftovers.exist(journal)
    handlers.close()
