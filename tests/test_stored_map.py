"""Data folders of older versions open as the same map."""

from __future__ import annotations

import tarfile
from pathlib import Path

import pytest

from semmap.nodes.extern.client import connect
from semmap.nodes.extern.testing import own_system
from semmap.nodes.kb_node.semantic_map import SemanticMap
from semmap.nodes.kb_node.storage.history import HistoryReader
from semmap.nodes.kb_node.storage.journal import FILENAME, Journal
from semmap.nodes.kb_node.undo import undo
from semmap.nodes.supervisor.control import Supervisor
from semmap.nodes.supervisor.ports import free_endpoint
from semmap.schemas import errors
from semmap.schemas.bridge import TakeBack
from semmap.schemas.commands import History

STORED = sorted((Path(__file__).parent / "data").glob("written_by_*.tar.xz"))
NOW = {"astrolabe1", "beer1", "cup1", "kitchen1", "table1"}


@pytest.fixture(params=STORED, ids=lambda path: path.name.removesuffix(".tar.xz"))
def data(request, tmp_path):
    with tarfile.open(request.param) as archive:
        archive.extractall(tmp_path / "map", filter="data")
    return tmp_path / "map"


@pytest.fixture(params=["as it was", "without its cache"])
def opened(request, data):
    if request.param == "without its cache":
        for cached in data.glob("*.closure"):
            cached.unlink()
    journal = Journal(data / FILENAME)
    yield SemanticMap(journal), journal
    journal.close()


def take_back(semantic_map, journal, commit=None, id="u"):
    return undo(semantic_map, journal, TakeBack(id=id, source="operator", commit=commit))


def test_there_is_a_stored_map():
    assert "written_by_0.1.0.tar.xz" in [path.name for path in STORED]


def test_its_entities_are_there(opened):
    semantic_map, _ = opened
    assert {entity.name for entity in semantic_map.entities()} == NOW
    cup = semantic_map.entity("cup1")
    assert (cup.class_, cup.pose.position_m) == ("Cup", (1.5, 2.0, 0.75))
    assert (cup.preferred_reference, cup.alternative_references) == ("espresso cup", ("mug",))
    assert cup.size_m == (0.08, 0.08, 0.1)
    assert {"Object", "Graspable_Thing"} <= set(cup.types)
    assert semantic_map.entity("kitchen1").place


def test_its_history_is_unchanged(opened):
    past = HistoryReader(opened[1])
    told = past.history(History())
    assert [commit.verb for commit in told] == [
        "",
        "add",
        "add",
        "update",
        "remove",
        "undo",
        "load",
        "add",
        "update",
    ]
    assert [commit.agent for commit in told[1:]] == ["ann"] * 8
    assert {entity.name for entity in past.entities(5)} == {"cup1", "kitchen1", "table1"}
    assert past.entity("cup1", 2).pose.position_m == (1.0, 2.0, 0.75)
    assert past.entity("cup1", 8).preferred_reference == "coffee cup"
    with pytest.raises(errors.UnknownName):
        past.entity("beer1", 5)


def test_it_can_be_taken_back_commit_by_commit(opened):
    semantic_map, journal = opened
    for number, expected in [(9, NOW), (8, NOW - {"astrolabe1"}), (7, NOW - {"astrolabe1"})]:
        commit = take_back(semantic_map, journal, number, id=str(number))
        assert commit.undoes == (number,)
        assert {entity.name for entity in semantic_map.entities()} == expected
    assert semantic_map.entity("cup1").preferred_reference == "coffee cup"
    assert "Astrolabe" not in {info.name for info in semantic_map.class_table()}
    take_back(semantic_map, journal, 4, id="4")
    assert semantic_map.entity("cup1").pose.position_m == (1.0, 2.0, 0.75)


def test_it_goes_on_and_opens_again(data):
    for number in (10, 11):
        journal = Journal(data / FILENAME)
        semantic_map = SemanticMap(journal)
        assert semantic_map.seq == number - 1
        assert take_back(semantic_map, journal, number - 1, id=str(number)).seq == number
        semantic_map.checkpoint()
        journal.close()


def test_a_system_starts_on_it(data):
    """As in the test of a program that uses semmap: the system is there for it, and gone afterwards."""
    endpoint = free_endpoint()
    with own_system(data, "--no-sim", "--no-record", endpoint=endpoint) as client:
        assert {entity.name for entity in client.list()} == NOW
        assert len(client.list(as_of=5)) == 3
        assert len(client.history()) == 9
        client.undo()
        with connect(endpoint) as other:
            assert other.get("cup1").preferred_reference == "coffee cup"
        assert client.check().consistent
    assert not Supervisor(data).is_running()
