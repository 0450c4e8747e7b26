"""Requests that end their node are counted across restarts, and then rejected."""

from __future__ import annotations

import pytest

from semmap.nodes.runtime import requests_in_work
from semmap.nodes.runtime.requests_in_work import RequestsInWork, count_ends, is_counted
from semmap.schemas import bridge, commands, errors
from semmap.schemas.commits import Transaction

TWICE = "kb_node: request rejected: it ended the node twice; restart the system to try it again"
LOAD = ("a client", "load", b"a file")


@pytest.fixture
def begun(tmp_path):
    """Begins a process that reads the file of those before it."""
    return lambda: RequestsInWork("kb_node", tmp_path / "kb_node")


@pytest.mark.parametrize(
    ("ends", "in_work", "counted"),
    [
        ({}, "", {}),
        ({"a": 1}, "", {"a": 1}),
        ({}, "a", {"a": 1}),
        ({"a": 1}, "a", {"a": 2}),
        ({"a": 1}, "b", {"a": 1, "b": 1}),
    ],
)
def test_only_the_request_in_work_is_counted(ends, in_work, counted):
    assert count_ends(ends, in_work) == counted


def test_the_oldest_counts_are_dropped(monkeypatch):
    monkeypatch.setattr(requests_in_work, "_MAX_COUNTED", 2)
    assert count_ends({"a": 1, "b": 1}, "a") == {"b": 1, "a": 2}
    assert count_ends({"a": 1, "b": 1}, "c") == {"b": 1, "c": 1}


def test_a_request_is_rejected_after_two_ends(begun):
    for _ in range(2):
        begun().begin(*LOAD)  # the process ends during it
    third = begun()
    with pytest.raises(errors.Refused) as rejected:
        third.begin(*LOAD)
    assert rejected.value.text == TWICE
    for other in (("another", *LOAD[1:]), (*LOAD[:2], b"another file"), ("a client", "check", b"a file")):
        third.begin(*other)
        third.end()
    with pytest.raises(errors.Refused):
        begun().begin(*LOAD)  # also after a restart without a request in work


def test_a_request_that_the_node_survives_is_not_counted(begun):
    begun().begin(*LOAD)
    second = begun()
    second.begin(*LOAD)
    second.end()
    begun().begin(*LOAD)  # counted once
    begun().begin(*LOAD)
    with pytest.raises(errors.Refused):
        begun().begin(*LOAD)


@pytest.mark.parametrize("content", [b"", b"\0" * 10, b"\xff" * 40, b"a" * 32 + b'{"b":', b"a" * 32 + b"[1]"])
def test_a_damaged_file_counts_nothing(begun, tmp_path, content):
    (tmp_path / "kb_node").write_bytes(content)
    begun().begin(*LOAD)
    begun().begin(*LOAD)
    with pytest.raises(errors.Refused):
        begun().begin(*LOAD)


def test_without_a_supervisor_or_a_folder_nothing_is_counted(tmp_path, monkeypatch):
    monkeypatch.delenv(requests_in_work.IN_WORK_VARIABLE, raising=False)
    for _ in range(3):
        RequestsInWork.of("kb_node").begin(*LOAD)
    monkeypatch.setenv(requests_in_work.IN_WORK_VARIABLE, str(tmp_path / "none"))
    for _ in range(3):
        RequestsInWork.of("kb_node").begin(*LOAD)
    monkeypatch.setenv(requests_in_work.IN_WORK_VARIABLE, str(tmp_path))
    RequestsInWork.of("kb_node").begin(*LOAD)
    assert (tmp_path / "kb_node").is_file()


@pytest.mark.parametrize(
    "kind", [commands.Add, commands.Check, Transaction, bridge.Transactions, bridge.LoadDocument]
)
def test_commands_and_changes_are_counted(kind):
    assert is_counted(kind)


@pytest.mark.parametrize("kind", [bridge.SnapshotQuery, bridge.CopyQuery, bridge.Recall, bridge.StarQuery])
def test_queries_that_nodes_need_to_start_are_not(kind):
    assert not is_counted(kind)
