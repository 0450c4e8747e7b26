"""Changes of the map, without the wire."""

from contextlib import contextmanager

import pytest

from semmap.nodes.kb_node.handlers import changes as changes_module
from semmap.nodes.kb_node.handlers.changes import ChangeHandlers
from semmap.schemas import errors
from semmap.schemas.bridge import MadeBy, TakeBack, Transactions
from semmap.schemas.commits import NewEntity
from semmap.schemas.health import WORKING
from tests.kb_node.home import chair, transaction
from tests.kb_node.storage.journal.test_journal import BULKY, full_by_page_count

CLASS = chair()[0][2].strip("<>")


class Listener:
    """Records what the node publishes and reports."""

    def __init__(self):
        self.commits, self.refused, self.work = [], [], []

    def spread(self, commit, *, told, at_once):
        self.commits.append((commit.seq, told))

    @contextmanager
    def report_progress(self, work):
        assert work.startswith(WORKING)
        yield lambda text: self.work.append(f"{work}: {text}")


@pytest.fixture
def listener():
    return Listener()


@pytest.fixture
def changes(semantic_map, listener):
    return ChangeHandlers(
        semantic_map,
        semantic_map._journal,
        publish=listener.spread,
        on_write_error=listener.refused.append,
        report_progress=listener.report_progress,
    )


def new(*names, **fields):
    add = [NewEntity(name=name, class_iri=CLASS) for name in names]
    return transaction("-".join(names), add=add, verb="add", **fields)


def test_each_commit_is_published_once_and_in_order(changes, listener):
    first = changes.on_commit(transaction(1, chair("a"), told=True))
    assert changes.on_commit(transaction(1, chair("x"))) == first
    assert changes.on_commit(transaction(2, chair("a"))) is None
    several = (transaction(3, chair("b")), transaction(1), transaction(4, chair("c"), told=True))
    results = changes.on_commits(Transactions(transactions=several))
    assert [result.commit.seq for result in results] == [2, 1, 3]
    assert listener.commits == [(1, True), (2, False), (3, True)]
    assert [made and made.seq for made in changes.on_made_by(MadeBy(ids=("4", "5")))] == [3, None]


def test_a_dry_run_is_not_published(changes, listener, semantic_map):
    made = changes.on_commit(transaction(1, chair("a"), dry_run=True))
    assert made.trial.changed == ("a",)
    assert (listener.commits, semantic_map.seq) == ([], 0)
    with pytest.raises(errors.BadRequest, match="a dry run cannot be combined"):
        changes.on_commits(Transactions(transactions=(transaction(2, chair("b"), dry_run=True),)))


def test_a_disk_error_is_reported(changes, listener, semantic_map):
    with (
        full_by_page_count(semantic_map._journal),
        pytest.raises(errors.Refused, match="could not be written"),
    ):
        changes.on_commit(transaction(1, chair("a"), reason=BULKY))
    assert len(listener.refused) == 1
    assert listener.commits == []


def test_large_changes_report_their_progress(changes, listener, monkeypatch):
    monkeypatch.setattr(changes_module, "_FEW", 2)
    changes.on_commit(new("a", "b"))
    assert listener.work == []
    changes.on_commit(new("c", "d", "e", reason="load five.json"))
    changes.on_undo(TakeBack(id="u", source="operator"))
    changes.on_commit(new("f"))
    changes.on_undo(TakeBack(id="v", source="operator"))
    changes.on_commit(new("g"))
    changes.on_commit(transaction("clear", remove=["a", "b", "g"]))
    assert listener.work == [
        "loading five.json: 3 entities to check and write",
        "undoing commit 2: 3 entities to check and write",
        "removing entities: 3 entities to check and write",
    ]
