"""Stores of triples on disk."""

import os

import pyoxigraph as ox
import pytest

from semmap.nodes.kb_node.sparql.triples import disk_stores
from semmap.nodes.kb_node.sparql.triples.disk_stores import FOLDER, DiskStores, clone_path, clone_store

QUAD = ox.Quad(ox.NamedNode("urn:s"), ox.NamedNode("urn:p"), ox.NamedNode("urn:o"))


@pytest.fixture
def store(tmp_path):
    """The path of a finished store of commit 7."""
    stores = DiskStores(tmp_path)
    made = stores.begin()
    ox.Store(str(made)).extend([QUAD])
    return stores.finish(made, 7, b"\x01\xab")


def test_no_folder_is_made_before_a_store(tmp_path):
    assert list(DiskStores(tmp_path).found()) == []
    assert not (tmp_path / FOLDER).exists()


def test_a_finished_store_is_named_by_its_commit_and_replaces_the_previous_one(tmp_path):
    stores = DiskStores(tmp_path)
    first, second = stores.begin(), stores.begin()
    assert first != second
    for made in (first, second):
        made.mkdir()
    one = stores.finish(first, 7, b"\x01\xab")
    assert list(stores.found()) == [(7, "01ab", one)]
    other = stores.finish(second, 12, b"\xff")
    assert list(stores.found()) == [(12, "ff", other)]
    assert not one.exists()


def test_a_restart_deletes_what_is_unfinished_and_keeps_finished_stores(tmp_path, store):
    unfinished = DiskStores(tmp_path).begin()
    clone = clone_path(store, 1)
    for path in (unfinished, clone):
        path.mkdir()
    assert [found for _, _, found in DiskStores(tmp_path).found()] == [store]
    assert not unfinished.exists()
    assert not clone.exists()


def test_a_clone_has_the_triples_and_leaves_the_store_alone(store):
    before = sorted(file.name for file in store.iterdir())
    clone = clone_store(store)
    assert list(clone) == [QUAD]
    clone.remove(QUAD)
    del clone
    assert sorted(file.name for file in store.iterdir()) == before
    assert list(clone_store(store)) == [QUAD]


def test_the_clone_of_a_process_is_removed_and_only_once(store):
    clone_store(store)
    path = clone_path(store, os.getpid())
    assert path.is_dir()
    assert path.parent == store.parent
    for _ in range(2):
        disk_stores.remove_clone(store, os.getpid())
        assert not path.exists()


def test_the_stores_of_a_replaced_journal_are_deleted(tmp_path, store):
    disk_stores.forget(tmp_path)
    assert not store.exists()
    disk_stores.forget(tmp_path)
