"""`semmap fleet mirror`: commits of robots are written to named graphs of a SPARQL server, exactly once.

One thread owns the state and writes. Requests to robots run on other threads, and published commits are put
on its queue. The changes of all robots are combined in one request, so frequent commits are cheaper.
"""

from __future__ import annotations

import contextlib
import functools
import os
import queue
import time
from collections.abc import Callable, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from fnmatch import fnmatchcase
from typing import Any, Final

from msgspec import Struct, structs

from semmap.nodes import bus
from semmap.nodes.extern.connection import open_session
from semmap.nodes.extern.fleet import facts as f
from semmap.nodes.extern.fleet import updates
from semmap.nodes.extern.fleet.facts import Facts
from semmap.nodes.extern.fleet.frames import Frame
from semmap.nodes.extern.fleet.replica import Replica
from semmap.nodes.extern.fleet.server import TIMEOUT_S, SparqlServer
from semmap.nodes.extern.fleet.synchronization import FAR, FullCopy, NextCommits, synchronize
from semmap.nodes.identity import Identity
from semmap.schemas import errors, keys
from semmap.schemas.calls import Call, reply_type

_WAIT_S: Final = 0.2
_VERIFY_S: Final = 10.0
"""Period of comparing a copy with the robot [s]."""
_AGAIN_S: Final = 1.0
"""Time before a request to a robot is retried [s]."""
_REFUSED_S: Final = 30.0
"""Time before a change that the server rejected is retried [s]."""
_FIRST_S, _LONGEST_S = 0.5, 30.0
"""Minimum and maximum time before a request to a failing server is retried [s]."""
_REQUEST_TRIPLES: Final = 50_000
_ASKED_AT_ONCE: Final = 8
_ANSWER_S: Final = 120.0


class MirrorConfig(Struct, frozen=True, kw_only=True):
    """The settings of a mirror."""

    update_url: str
    query_url: str
    robots: tuple[str, ...] = ("*",)
    """Patterns of robot names."""
    frames: dict[str, Frame] = {}
    endpoints: tuple[str, ...]
    """The endpoints of robots."""
    identity: Identity | None = None
    far: int = FAR
    """The number of commits from which the whole map is copied."""
    timeout_s: float = TIMEOUT_S
    """The timeout of requests to the server."""


class _Robot:
    """A robot that was discovered: the state of its copy, and the connection to it."""

    def __init__(self, name: str, endpoint: str) -> None:
        self.name = name
        self.endpoint = endpoint
        self.replica = Replica(name)
        self.instances: set[str] = set()
        """The running processes of its knowledge base."""
        self.connections = contextlib.ExitStack()
        self.ask: Callable[[Call[Any]], Any] | None = None
        self.is_queried = False
        self.query_at_s = 0.0
        self.error = ""


class Mirror:
    """Mirrors robots until it is stopped. `tell(text)` receives log messages."""

    def __init__(self, config: MirrorConfig, tell: Callable[[str], None] = lambda _: None) -> None:
        """Raise BadRequest for invalid URLs."""
        self._config = config
        self._tell = tell
        self._writer = SparqlServer(config.update_url, timeout_s=config.timeout_s)
        self._reader = SparqlServer(config.query_url, timeout_s=config.timeout_s)
        self._robots: dict[str, _Robot] = {}
        self._events: queue.SimpleQueue[Callable[[], None]] = queue.SimpleQueue()
        self._threads = ThreadPoolExecutor(_ASKED_AT_ONCE, thread_name_prefix="fleet")
        self._connections = contextlib.ExitStack()
        self._stopped = False
        self._found = 0
        """The number of endpoints whose robots were discovered."""
        self._server: dict[str, Facts] | None = None
        """The metadata of all robots when the server was last queried; None if it must be queried."""
        self._pause_s = _FIRST_S
        self._next_try_s = 0.0
        self.trouble = ""
        """The error that prevents writing to the server, or an empty text."""
        self.commits = 0
        """The number of written commits, without copies of whole maps."""
        self.requests = 0
        """The number of write requests."""

    @property
    def facts(self) -> dict[str, Facts]:
        """The known metadata in the server, by robot."""
        known = {name: robot.replica.facts for name, robot in self._robots.items()}
        return {name: facts for name, facts in known.items() if facts is not None}

    def stop(self) -> None:
        """End `run`, from any thread or from a signal handler."""
        self._stopped = True

    def run(self, *, once: bool = False) -> None:
        """Mirror until stopped or, with `once`, until all available robots are synchronized.

        With `once`, raises NoAnswer or Refused if that is not possible.
        """
        try:
            for endpoint in self._config.endpoints:
                self._discover(endpoint)
            while not self._stopped:
                self._handle()
                if self._read():
                    self._ask()
                    self._write()
                if once and self._is_done():
                    return
        finally:
            self._stopped = True
            self._threads.shutdown(wait=True, cancel_futures=True)
            for robot in self._robots.values():
                robot.connections.close()
            self._connections.close()
            self._writer.close()
            self._reader.close()

    def _is_done(self) -> bool:
        if self.trouble:
            raise errors.NoAnswer(self.trouble)
        there = [robot for robot in self._robots.values() if robot.instances]
        if self._found == len(self._config.endpoints) and not there:
            where = ", ".join(self._config.endpoints)
            raise errors.NoAnswer(f"no robot at {where} matches {', '.join(self._config.robots)}")
        for robot in there:
            if robot.error and robot.replica.phase == "behind":
                raise errors.NoAnswer(f"{robot.name}: {robot.error}")
        return bool(there) and all(
            robot.replica.phase == "in_sync" and not robot.replica.has_work for robot in there
        )

    def _handle(self) -> None:
        """Handle events; wait for one if there is nothing to write."""
        busy = not self.trouble and any(robot.replica.has_work for robot in self._robots.values())
        with contextlib.suppress(queue.Empty):
            self._events.get(timeout=0.001 if busy else _WAIT_S)()
            while True:
                self._events.get_nowait()()

    # Robots

    def _discover(self, endpoint: str) -> None:
        """Discover the robots at an endpoint, from now on."""

        def discover() -> None:
            where = open_session(endpoint, "", self._config.identity, mode="client")
            session = self._connections.enter_context(where)
            bus.follow_robots(
                session, "kb_node", functools.partial(self._run_on_owner, self._on_presence, endpoint)
            )

        def on_discovered(done: Future[None]) -> None:
            error = done.exception()
            if error is None:
                self._found += 1
            elif isinstance(error, errors.SemmapError):
                self._report(f"{error}; trying again")
                self._threads.submit(time.sleep, _AGAIN_S).add_done_callback(
                    lambda _: self._run_on_owner(self._discover, endpoint)
                )
            else:
                raise error

        self._run_in_thread(discover, on_discovered)

    def _on_presence(self, endpoint: str, name: str, instance: str, there: bool) -> None:
        """Handle that a process of a robot's knowledge base started or ended."""
        if not any(fnmatchcase(name, pattern) for pattern in self._config.robots):
            return
        robot = self._robots.get(name)
        if robot is None:
            robot = self._robots[name] = _Robot(name, endpoint)
            robot.replica.update_facts((self._server or {}).get(name))
        if endpoint != robot.endpoint:
            return
        if there:
            robot.instances.add(instance)
            robot.replica.restart()
            robot.query_at_s = 0.0
        else:
            robot.instances.discard(instance)
            if not robot.instances:
                self._report(f"{name} is unavailable; waiting for it")

    def _ask(self) -> None:
        """Start the synchronization of robots whose copy is behind or must be verified."""
        now_s = time.monotonic()
        for robot in self._robots.values():
            replica = robot.replica
            idle = replica.phase == "in_sync" and not replica.has_work
            due = now_s >= robot.query_at_s and (idle or (replica.phase == "behind" and not replica.copying))
            if robot.instances and due and not robot.is_queried:
                robot.is_queried = True
                frame = self._config.frames.get(robot.name)
                ask = functools.partial(self._synchronize, robot, replica.facts, frame)
                done = functools.partial(self._on_synchronized, robot, replica.generation)
                self._run_in_thread(ask, done)

    def _synchronize(
        self, robot: _Robot, facts: Facts | None, frame: Frame | None
    ) -> NextCommits | FullCopy | None:
        """Subscribe first, then fetch; runs on another thread."""
        if robot.ask is None:
            where = open_session(robot.endpoint, robot.name, self._config.identity, mode="client")
            session = robot.connections.enter_context(where)
            lifelines = bus.Lifelines(session)
            add_commit = robot.replica.add_commit
            bus.follow(session, keys.COMMIT, lambda _, commit: self._run_on_owner(add_commit, commit))

            def ask(call: Call[Any]) -> Any:
                kind = reply_type(type(call))
                how: dict[str, Any] = {"timeout_s": _ANSWER_S, "patience_s": _AGAIN_S}
                return bus.ask(session, keys.BRIDGE, call.VERB, call, kind, lifelines=lifelines, **how)

            robot.ask = ask
        return synchronize(robot.ask, robot.name, facts, frame, far=self._config.far)

    def _on_synchronized(
        self, robot: _Robot, generation: int, done: Future[NextCommits | FullCopy | None]
    ) -> None:
        robot.is_queried = False
        replica = robot.replica
        try:
            found = done.result()
        except errors.SemmapError as error:
            robot.query_at_s = time.monotonic() + _AGAIN_S
            self._report_robot(robot, error.text)
            return
        was = replica.phase
        replica.synchronize(found, generation)
        robot.query_at_s = time.monotonic() + (_VERIFY_S if replica.phase == "in_sync" else _AGAIN_S)
        if isinstance(found, NextCommits) and was == "behind":
            at = found.commits[-1].seq if found.commits else replica.facts and replica.facts.commit
            self._report_robot(robot, "")
            self._report(f"{robot.name}: resuming from commit {at}")
        elif found is None:
            self._report_robot(robot, "has no map yet")

    # The server

    def _read(self) -> bool:
        """Read the metadata from the server; return False while it does not respond."""
        if time.monotonic() < self._next_try_s:
            return False
        if self._server is not None:
            return True
        try:
            self._server = f.read(self._reader.query(f.QUERY).rows)
        except errors.SemmapError as error:
            self._pause_server(error.text)
            return False
        for robot in self._robots.values():
            robot.replica.update_facts(self._server.get(robot.name))
        if self.trouble:
            self._report("the SPARQL server is available again")
        self.trouble, self._pause_s = "", _FIRST_S
        return True

    def _pause_server(self, text: str) -> None:
        """Pause requests to the server, longer each time. Afterwards, its metadata is read again."""
        if text != self.trouble:
            self._report(f"{text}; trying again")
        self.trouble, self._server = text, None
        self._next_try_s = time.monotonic() + self._pause_s
        self._pause_s = min(2 * self._pause_s, _LONGEST_S)

    def _write(self) -> None:
        for robot in self._robots.values():
            if robot.replica.copying is not None and not self._stopped:
                self._copy(robot)
        pending: list[tuple[_Robot, list[str], Facts, int]] = []
        triples = 0
        for robot in self._robots.values():
            before = robot.replica.facts
            if triples < _REQUEST_TRIPLES and (next_ := robot.replica.change()) and before is not None:
                change, wanted = next_
                triples += len(change)
                pending.append((robot, list(change.operations(before, wanted)), wanted, len(change)))
        if not pending or self._server is None:
            return
        try:
            self._send([operation for _, operations, _, _ in pending for operation in operations])
        except errors.BadRequest:  # one robot's change is rejected; write the others
            for robot, operations, wanted, size in pending:
                self._write_alone(robot, operations, wanted, size=size)
        except errors.SemmapError as error:
            self._pause_server(error.text)
        else:
            self._confirm([(robot, wanted) for robot, _, wanted, _ in pending])

    def _copy(self, robot: _Robot) -> None:
        """Write the whole map of a robot, in one request if it is small."""
        replica = robot.replica
        full_copy, before = replica.copying, replica.facts
        if full_copy is None:
            raise errors.InternalError(f"there is no copy of the map of {robot.name} to write")
        wanted = structs.replace(full_copy.facts, copying=os.urandom(8).hex())
        operations = list(updates.copy_operations(before, wanted, full_copy.whole))
        small = len(full_copy.whole.triples) <= 2 * updates.CHUNK
        if self._write_alone(robot, operations, wanted, one_by_one=not small):
            count = len(full_copy.whole.triples)
            self._report_robot(robot, "")
            self._report(
                f"{robot.name}: copied at commit {wanted.commit} ({count:,} triples): {full_copy.why}"
            )

    def _write_alone(
        self,
        robot: _Robot,
        operations: Sequence[str],
        wanted: Facts,
        *,
        size: int = 0,
        one_by_one: bool = False,
    ) -> bool:
        """Write the change of one robot, and return whether it was written.

        A change of `size` triples that the server rejects is retried in smaller steps: Virtuoso 7 rejects a
        change of 800 commits, because it would be translated to more than 10 000 lines of SQL.
        """
        try:
            for some in ([operation] for operation in operations) if one_by_one else [operations]:
                self._send(some)
        except errors.BadRequest as error:
            if robot.replica.halve_changes(size, wanted):
                return False
            self._report_robot(robot, error.text)
            robot.replica.restart()
            robot.query_at_s = time.monotonic() + _REFUSED_S
            return False
        except errors.SemmapError as error:
            self._pause_server(error.text)
            return False
        return self._confirm([(robot, wanted)])

    def _send(self, operations: Sequence[str]) -> None:
        self._writer.update(operations)
        self.requests += 1

    def _confirm(self, written: Sequence[tuple[_Robot, Facts]]) -> bool:
        """Return whether the server has what was written; otherwise another program has written."""
        graphs = " ".join(f.graph(robot.name) for robot, _ in written)
        query = (
            f"SELECT ?robot ?digest {{ GRAPH {f.FACTS} {{"
            f" VALUES ?robot {{ {graphs} }} ?robot {f.term('digest')} ?digest }} }}"
        )
        try:
            rows = self._reader.query(query).rows
        except errors.SemmapError as error:
            self._pause_server(error.text)
            return False
        digests = {row[0]: row[1] for row in rows}
        as_wanted = True
        for robot, wanted in written:
            before = robot.replica.facts
            if digests.get(f.graph(robot.name)) == f.text(wanted.digest):
                if robot.replica.copying is None and before is not None:
                    self.commits += (wanted.commit or 0) - (before.commit or 0)
                robot.replica.update_facts(structs.replace(wanted, copying=""), wanted)
            else:
                as_wanted = False
                robot.replica.update_facts(before, wanted)
                self._server = None  # read all metadata again
        return as_wanted

    # Threads

    def _run_in_thread(self, function: Callable[[], Any], done: Callable[[Future[Any]], None]) -> None:
        """Call `function` on another thread, and then `done(future)` on the owning thread."""
        self._threads.submit(function).add_done_callback(functools.partial(self._run_on_owner, done))

    def _run_on_owner(self, function: Callable[..., None], *args: Any) -> None:
        """Call `function` on the thread that owns the state."""
        if not self._stopped:
            self._events.put(functools.partial(function, *args))

    def _report_robot(self, robot: _Robot, text: str) -> None:
        """Log an error of a robot, once."""
        if text and text != robot.error:
            self._report(f"{robot.name}: {text}; trying again")
        robot.error = text

    def _report(self, text: str) -> None:
        self._tell(text)
