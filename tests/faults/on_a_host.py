"""Actions on one of several hosts, in its own process: `host.do(up, ...)`."""

from __future__ import annotations

import contextlib
import os
import threading
import time
from pathlib import Path
from typing import NamedTuple

import zenoh

from semmap.nodes.extern.client import connect
from semmap.schemas import errors
from semmap.schemas.endpoints import IDENTITY_VARIABLE
from tests.conftest import running
from tests.faults.ground import Load, free_place, wait_for
from tests.faults.processes import all_pids_of

_stack = contextlib.ExitStack()
_loads: list[Load] = []
_watchers: list[Watcher] = []
_BREATH_S = 0.25


class Watcher(threading.Thread):
    """Follows the map, and records the number of each commit."""

    def __init__(self, endpoint: str) -> None:
        super().__init__(daemon=True)
        self.seqs: list[int] = []
        self._client = _stack.enter_context(connect(endpoint))
        self._commits = _stack.enter_context(self._client.commits())

    def run(self) -> None:
        for commit in self._commits:
            self.seqs.append(commit.seq)


def identify(identity: str) -> None:
    """Use this certificate for clients on this host."""
    os.environ[IDENTITY_VARIABLE] = identity


def up(data: str, endpoint: str, words: tuple[str, ...]) -> None:
    """Start a part of a system, and return when it is ready."""
    _stack.enter_context(running(Path(data), *words, endpoint=endpoint))


def route(configuration: str) -> None:
    """Run a plain Zenoh router from its configuration file, as zenohd would."""
    _stack.enter_context(zenoh.open(zenoh.Config.from_json5(configuration)))


def load(endpoint: str, number: int) -> None:
    """Begin to add cups; an earlier load must have ended."""
    _loads[:] = [Load(endpoint, number, _BREATH_S, insists=True)]
    _loads[0].start()


def watch(endpoint: str) -> None:
    """Begin to follow the map."""
    _watchers.append(Watcher(endpoint))
    _watchers[-1].start()


def pids(data: str) -> dict[str, int]:
    """Return the processes of the nodes on this host."""
    return all_pids_of(Path(data)) if Path(data).is_dir() else {}  # a router of Zenoh has no nodes


def seconds_until_whole(endpoint: str, nodes: set[tuple[str, str]]) -> float:
    """Return the time until the system is complete, as seen from this host.

    All nodes (each with its host) are ready, a new client can add a plate that gets its body, and the load
    and the watcher continue.
    """
    began_s = time.monotonic()
    added, seen = [len(one.added) for one in _loads], [len(one.seqs) for one in _watchers]

    def is_whole() -> bool:
        try:
            with connect(endpoint) as client:
                status = client.status()
                ready = {(node.node, node.host) for node in status.nodes if node.state == "ready"}
                return ready >= nodes and "present" in client.add("Plate", at=free_place(), wait=True).text
        except errors.NoAnswer:
            return False

    def goes_on() -> bool:
        return all(len(one.added) > before for one, before in zip(_loads, added, strict=True)) and all(
            len(one.seqs) > before for one, before in zip(_watchers, seen, strict=True)
        )

    wait_for(is_whole, "the system is whole again")
    wait_for(goes_on, "the load goes on, and the map is followed")
    return time.monotonic() - began_s


class Ended(NamedTuple):
    """The result of a load."""

    acknowledged: list[str]
    unanswered: int
    """Number of changes that were not answered and sent again."""
    in_doubt: bool
    refused: list[str]


def stop_load() -> Ended:
    """Stop the load of this host."""
    (one,) = _loads
    one.stop()
    return Ended(one.added, one.unanswered, one.in_doubt, one.refused)


def followed(until: int) -> list[list[int]]:
    """Return what each watcher has received up to commit `until`."""
    wait_for(lambda: all(w.seqs and w.seqs[-1] >= until for w in _watchers), f"commit {until} is received")
    return [list(watcher.seqs) for watcher in _watchers]


def cups(endpoint: str) -> tuple[set[str], int]:
    """Return the cups and the last commit, when all cups are placed in the scene."""

    def agreed() -> tuple[set[str], int] | None:
        with connect(endpoint) as client:
            status = client.status()
            there = {entity.name for entity in client.list("Cup")}
            agrees = status.in_agreement and status.bodies == status.entities
            return (there, status.commit) if agrees else None

    found: tuple[set[str], int] = wait_for(agreed, "map and scene agree")
    return found


def clear(endpoint: str) -> None:
    """Clear the map, so that the number of bodies does not affect the next measurement."""
    with connect(endpoint) as client:
        client.clear()
        wait_for(lambda: client.status().bodies == 0, "the bodies are gone")


def recorded(endpoint: str, until: int) -> None:
    """Return when the recorder, on any host, reports that it has all commits."""

    def has_all() -> bool:
        with connect(endpoint) as client:
            details = [node.detail for node in client.status().nodes if node.node == "recorder"]
            return all(detail.startswith(f"commit {until},") for detail in details)

    wait_for(has_all, f"commit {until} is recorded")


def end() -> None:
    """Stop everything on this host."""
    _stack.close()
