import pytest

from semmap.nodes.kb_node.answers import pages as pages_module
from semmap.nodes.kb_node.answers.pages import Pages
from semmap.schemas.bridge import SnapshotQuery
from tests.kb_node.home import chair, close, new_map, transaction

NAMES = tuple(f"chair{i}" for i in range(1, 6))


@pytest.fixture
def semantic_map(tmp_path):
    semantic_map = new_map(tmp_path)
    for i, name in enumerate(NAMES):
        semantic_map.commit(transaction(i, chair(name)))
    yield semantic_map
    close(semantic_map)


def names(snapshot):
    return tuple(entity.name for entity in snapshot.entities)


def test_without_a_limit_the_whole_map_is_returned(semantic_map):
    snapshot = Pages(semantic_map).snapshot(SnapshotQuery())
    assert (snapshot.seq, names(snapshot), snapshot.more) == (5, NAMES, False)


def test_pages_are_in_the_order_of_names(semantic_map):
    pages = Pages(semantic_map)
    first = pages.snapshot(SnapshotQuery(limit=2))
    second = pages.snapshot(SnapshotQuery(limit=2, after="chair2"))
    last = pages.snapshot(SnapshotQuery(limit=2, after="chair4"))
    assert [names(page) for page in (first, second, last)] == [NAMES[:2], NAMES[2:4], NAMES[4:]]
    assert (first.more, second.more, last.more) == (True, True, False)


def test_an_entity_that_is_removed_between_two_pages_is_in_neither(semantic_map):
    pages = Pages(semantic_map)
    pages.snapshot(SnapshotQuery(limit=2))
    semantic_map.commit(transaction("gone", retract=chair("chair3")))
    page = pages.snapshot(SnapshotQuery(limit=2, after="chair2"))
    assert (page.seq, names(page), page.more) == (6, ("chair4", "chair5"), False)


def test_a_page_is_the_last_if_the_remaining_entities_were_removed(semantic_map):
    pages = Pages(semantic_map)
    pages.snapshot(SnapshotQuery(limit=4))
    semantic_map.commit(transaction("gone", retract=chair("chair5")))
    page = pages.snapshot(SnapshotQuery(limit=4, after="chair4"))
    assert (names(page), page.more) == ((), False)


def test_a_request_for_the_next_page_is_expected(semantic_map, monkeypatch):
    clock = [100.0]
    monkeypatch.setattr(pages_module.time, "monotonic", lambda: clock[0])
    pages = Pages(semantic_map)
    assert pages.is_request_expected  # after a start
    clock[0] += 10.0
    assert not pages.is_request_expected
    pages.snapshot(SnapshotQuery(limit=2))
    assert pages.is_request_expected
    pages.snapshot(SnapshotQuery(limit=200, after="chair2"))
    assert not pages.is_request_expected
    pages.snapshot(SnapshotQuery(limit=2))
    clock[0] += 10.0
    assert not pages.is_request_expected  # the timeout has passed
