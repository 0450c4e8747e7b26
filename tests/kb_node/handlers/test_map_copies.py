"""Copies of the map, and of its commits."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor

import pytest

from semmap.nodes.kb_node.handlers.map_copies import MapCopyHandlers
from semmap.nodes.kb_node.storage.history import HistoryReader
from semmap.schemas import errors
from semmap.schemas.bridge import CopyQuery, Recall, SnapshotQuery, StarQuery
from tests.kb_node.home import chair, transaction


@pytest.fixture
def copies(semantic_map):
    journal = semantic_map._journal
    with ThreadPoolExecutor(1) as aside:
        yield MapCopyHandlers(semantic_map, journal, HistoryReader(journal), aside)


def add(semantic_map, count):
    for n in range(1, count + 1):
        semantic_map.commit(transaction(n, chair(f"chair{n}")))


def test_every_request_has_its_handler(copies):
    assert set(copies.handlers()) == {"snapshot", "copy", "recall", "star"}


def test_a_copy_has_the_whole_map_or_only_its_identity(copies, semantic_map):
    add(semantic_map, 2)
    copy = copies.on_copy(CopyQuery())
    assert (copy.seq, copy.digest) == (2, semantic_map.digest)
    assert set(copy.triples) == set(semantic_map.abox())
    assert {one.name for one in copy.entities} == {"chair1", "chair2"}
    head = copies.on_copy(CopyQuery(content=False))
    assert (head.triples, head.entities) == ((), ())
    assert (head.map_id, head.begun_ns, head.seq) == (copy.map_id, copy.begun_ns, 2)
    assert copy.stamp_ns == semantic_map._journal.stamps.of(2)


def test_an_empty_map_has_the_time_of_its_beginning(copies, semantic_map):
    assert copies.on_copy(CopyQuery()).stamp_ns == semantic_map._journal.beginning.stamp_ns


def test_commits_are_recalled_by_number(copies, semantic_map):
    add(semantic_map, 3)
    found = copies.on_recall(Recall(seqs=(3, 1, 9))).result(60)
    assert {commit.seq for commit in found} == {1, 3}


def test_the_triples_of_an_entity(copies, semantic_map):
    add(semantic_map, 2)
    (star,) = copies.on_star(StarQuery(names=("chair2",)))
    assert (star.name, star.seq) == ("chair2", 2)
    assert set(star.own) == set(chair("chair2"))
    with pytest.raises(errors.UnknownName):
        copies.on_star(StarQuery(names=("chair9",)))


def test_pages_have_the_entities_in_the_order_of_their_names(copies, semantic_map):
    add(semantic_map, 3)
    assert copies.is_being_fetched
    assert not copies.on_snapshot(SnapshotQuery()).more
    first = copies.on_snapshot(SnapshotQuery(limit=2))
    assert ([one.name for one in first.entities], first.more) == (["chair1", "chair2"], True)
    assert copies.is_being_fetched
    semantic_map.commit(transaction(9, chair("chair0")))
    last = copies.on_snapshot(SnapshotQuery(limit=2, after="chair2"))
    assert ([one.name for one in last.entities], last.more, last.seq) == (["chair3"], False, 4)
    assert not copies.is_being_fetched
    whole = copies.on_snapshot(SnapshotQuery(limit=4))
    assert (whole.entities[0].name, whole.more) == ("chair0", False)
