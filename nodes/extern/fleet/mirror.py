"""`semmap fleet mirror`: robots' commits go into one named graph each of a SPARQL server, exactly once.

One thread owns what is known and writes; robots are asked on threads beside it, and what they publish is put
on its queue. What has to be written of all robots at a time goes in one request, so the more commits come,
the less each of them costs.
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
from semmap.nodes.extern.fleet.catching_up import FAR, Anew, Continued, catch_up
from semmap.nodes.extern.fleet.facts import Facts
from semmap.nodes.extern.fleet.following import Following
from semmap.nodes.extern.fleet.frames import Frame
from semmap.nodes.extern.fleet.server import TIMEOUT_S, SparqlServer
from semmap.nodes.identity import Identity
from semmap.schemas import errors, keys
from semmap.schemas.calls import Call, reply_type

_WAIT_S: Final = 0.2
_VERIFY_S: Final = 10.0
"""How often it makes sure that what it has is what the robot has."""
_AGAIN_S: Final = 1.0
"""After so long a robot that did not answer is asked again."""
_REFUSED_S: Final = 30.0
"""After so long what the server found wrong is tried again."""
_FIRST_S, _LONGEST_S = 0.5, 30.0
"""How long a server that is in trouble is left alone, at first and at most."""
_REQUEST_TRIPLES: Final = 50_000
_ASKED_AT_ONCE: Final = 8
_ANSWER_S: Final = 120.0


class MirrorConfig(Struct, frozen=True, kw_only=True):
    """What is mirrored, and where to."""

    update_url: str
    query_url: str
    robots: tuple[str, ...] = ("*",)
    """Patterns of names."""
    frames: dict[str, Frame] = {}
    endpoints: tuple[str, ...]
    """Where robots are reached."""
    identity: Identity | None = None
    far: int = FAR
    """Commits: a copy that is further behind is made anew."""
    timeout_s: float = TIMEOUT_S
    """How long the server may take."""


class _Robot:
    """A robot that was seen: how far its copy is, and the way to it."""

    def __init__(self, name: str, endpoint: str) -> None:
        self.name = name
        self.endpoint = endpoint
        self.following = Following(name)
        self.instances: set[str] = set()
        """The processes of its knowledge base that are there."""
        self.way = contextlib.ExitStack()
        self.ask: Callable[[Call[Any]], Any] | None = None
        self.is_asked = False
        self.ask_at_s = 0.0
        self.told = ""


class Mirror:
    """Follows robots until it is stopped. `tell(sentence)` is called with what a person wants to know."""

    def __init__(self, config: MirrorConfig, tell: Callable[[str], None] = lambda _: None) -> None:
        """Raises BadRequest for URLs that are none."""
        self._config = config
        self._tell = tell
        self._writer = SparqlServer(config.update_url, timeout_s=config.timeout_s)
        self._reader = SparqlServer(config.query_url, timeout_s=config.timeout_s)
        self._robots: dict[str, _Robot] = {}
        self._events: queue.SimpleQueue[Callable[[], None]] = queue.SimpleQueue()
        self._threads = ThreadPoolExecutor(_ASKED_AT_ONCE, thread_name_prefix="fleet")
        self._ways = contextlib.ExitStack()
        self._stopped = False
        self._found = 0
        """Endpoints at which it was seen which robots there are."""
        self._server: dict[str, Facts] | None = None
        """What the server said of robots when it was last asked about all; None when that is to be done."""
        self._pause_s = _FIRST_S
        self._not_before_s = 0.0
        self.trouble = ""
        """What keeps the server from being written to; empty when all is well."""
        self.commits = 0
        """How many were written, those in copies of whole maps not counted."""
        self.requests = 0
        """How many requests wrote something."""

    @property
    def facts(self) -> dict[str, Facts]:
        """What the server is known to have, by robot."""
        known = {name: robot.following.facts for name, robot in self._robots.items()}
        return {name: facts for name, facts in known.items() if facts is not None}

    def stop(self) -> None:
        """End `run`; from any thread, or a signal's handler."""
        self._stopped = True

    def run(self, *, once: bool = False) -> None:
        """Follow until stopped; with `once` until all robots that are there have been caught up with.

        With `once` it raises what keeps it from that: NoAnswer, Refused.
        """
        try:
            for endpoint in self._config.endpoints:
                self._look_at(endpoint)
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
                robot.way.close()
            self._ways.close()
            self._writer.close()
            self._reader.close()

    def _is_done(self) -> bool:
        if self.trouble:
            raise errors.NoAnswer(self.trouble)
        there = [robot for robot in self._robots.values() if robot.instances]
        if self._found == len(self._config.endpoints) and not there:
            where = ", ".join(self._config.endpoints)
            raise errors.NoAnswer(f"no robot that matches {', '.join(self._config.robots)} is at {where}")
        for robot in there:
            if robot.told and robot.following.phase == "behind":
                raise errors.NoAnswer(f"{robot.name}: {robot.told}")
        return bool(there) and all(
            robot.following.phase == "level" and not robot.following.has_work for robot in there
        )

    def _handle(self) -> None:
        """What has come; it is waited for if there is nothing to write."""
        busy = not self.trouble and any(robot.following.has_work for robot in self._robots.values())
        with contextlib.suppress(queue.Empty):
            self._events.get(timeout=0.001 if busy else _WAIT_S)()
            while True:
                self._events.get_nowait()()

    # Robots

    def _look_at(self, endpoint: str) -> None:
        """See which robots are reached at an endpoint, from now on."""

        def look() -> None:
            where = open_session(endpoint, "", self._config.identity, mode="client")
            session = self._ways.enter_context(where)
            bus.follow_robots(session, "kb_node", functools.partial(self._later, self._appear, endpoint))

        def looked(done: Future[None]) -> None:
            error = done.exception()
            if error is None:
                self._found += 1
            elif isinstance(error, errors.SemmapError):
                self._say(f"{error}; trying again")
                self._threads.submit(time.sleep, _AGAIN_S).add_done_callback(
                    lambda _: self._later(self._look_at, endpoint)
                )
            else:
                raise error

        self._beside(look, looked)

    def _appear(self, endpoint: str, name: str, instance: str, there: bool) -> None:
        """A process of a robot's knowledge base is there, or has gone."""
        if not any(fnmatchcase(name, pattern) for pattern in self._config.robots):
            return
        robot = self._robots.get(name)
        if robot is None:
            robot = self._robots[name] = _Robot(name, endpoint)
            robot.following.learn((self._server or {}).get(name))
        if endpoint != robot.endpoint:
            return
        if there:
            robot.instances.add(instance)
            robot.following.begin_anew()
            robot.ask_at_s = 0.0
        else:
            robot.instances.discard(instance)
            if not robot.instances:
                self._say(f"{name} has gone; it is followed again when it comes back")

    def _ask(self) -> None:
        """Have the robots asked that are behind, or have to be made sure of."""
        now_s = time.monotonic()
        for robot in self._robots.values():
            following = robot.following
            idle = following.phase == "level" and not following.has_work
            due = now_s >= robot.ask_at_s and (
                idle or (following.phase == "behind" and not following.copying)
            )
            if robot.instances and due and not robot.is_asked:
                robot.is_asked = True
                frame = self._config.frames.get(robot.name)
                ask = functools.partial(self._catch_up, robot, following.facts, frame)
                done = functools.partial(self._caught_up, robot, following.generation)
                self._beside(ask, done)

    def _catch_up(self, robot: _Robot, facts: Facts | None, frame: Frame | None) -> Continued | Anew | None:
        """On a thread beside: subscribe first, then fetch."""
        if robot.ask is None:
            where = open_session(robot.endpoint, robot.name, self._config.identity, mode="client")
            session = robot.way.enter_context(where)
            liveliness = bus.LivelinessMonitor(session)
            hear = robot.following.hear
            bus.follow(session, keys.COMMIT, lambda _, commit: self._later(hear, commit))

            def ask(call: Call[Any]) -> Any:
                kind = reply_type(type(call))
                how: dict[str, Any] = {"timeout_s": _ANSWER_S, "patience_s": _AGAIN_S}
                return bus.ask(session, keys.BRIDGE, call.VERB, call, kind, liveliness=liveliness, **how)

            robot.ask = ask
        return catch_up(robot.ask, robot.name, facts, frame, far=self._config.far)

    def _caught_up(self, robot: _Robot, generation: int, done: Future[Continued | Anew | None]) -> None:
        robot.is_asked = False
        following = robot.following
        try:
            found = done.result()
        except errors.SemmapError as error:
            robot.ask_at_s = time.monotonic() + _AGAIN_S
            self._tell_of(robot, error.text)
            return
        was = following.phase
        following.catch_up(found, generation)
        robot.ask_at_s = time.monotonic() + (_VERIFY_S if following.phase == "level" else _AGAIN_S)
        if isinstance(found, Continued) and was == "behind":
            at = found.commits[-1].seq if found.commits else following.facts and following.facts.commit
            self._tell_of(robot, "")
            self._say(f"{robot.name}: going on from commit {at}")
        elif found is None:
            self._tell_of(robot, "has no map yet")

    # The server

    def _read(self) -> bool:
        """Know what the server has; False while it cannot be asked."""
        if time.monotonic() < self._not_before_s:
            return False
        if self._server is not None:
            return True
        try:
            self._server = f.read(self._reader.query(f.QUERY).rows)
        except errors.SemmapError as error:
            self._complain(error.text)
            return False
        for robot in self._robots.values():
            robot.following.learn(self._server.get(robot.name))
        if self.trouble:
            self._say("the SPARQL server answers again")
        self.trouble, self._pause_s = "", _FIRST_S
        return True

    def _complain(self, text: str) -> None:
        """The server is left alone for a while, longer each time; then it is asked what it has."""
        if text != self.trouble:
            self._say(f"{text}; trying again")
        self.trouble, self._server = text, None
        self._not_before_s = time.monotonic() + self._pause_s
        self._pause_s = min(2 * self._pause_s, _LONGEST_S)

    def _write(self) -> None:
        for robot in self._robots.values():
            if robot.following.copying is not None and not self._stopped:
                self._copy(robot)
        pending: list[tuple[_Robot, list[str], Facts, int]] = []
        triples = 0
        for robot in self._robots.values():
            before = robot.following.facts
            if triples < _REQUEST_TRIPLES and (next_ := robot.following.change()) and before is not None:
                change, wanted = next_
                triples += len(change)
                pending.append((robot, list(change.operations(before, wanted)), wanted, len(change)))
        if not pending or self._server is None:
            return
        try:
            self._send([operation for _, operations, _, _ in pending for operation in operations])
        except errors.BadRequest:  # one of them is at fault, and the others shall not wait for it
            for robot, operations, wanted, size in pending:
                self._write_alone(robot, operations, wanted, size=size)
        except errors.SemmapError as error:
            self._complain(error.text)
        else:
            self._confirm([(robot, wanted) for robot, _, wanted, _ in pending])

    def _copy(self, robot: _Robot) -> None:
        """Write a robot's whole map, in one request if it is small."""
        following = robot.following
        anew, before = following.copying, following.facts
        if anew is None:
            raise errors.InternalError(f"there is no copy of the map of {robot.name} to write")
        wanted = structs.replace(anew.facts, copying=os.urandom(8).hex())
        operations = list(updates.copying(before, wanted, anew.whole))
        small = len(anew.whole.triples) <= 2 * updates.CHUNK
        if self._write_alone(robot, operations, wanted, one_by_one=not small):
            count = len(anew.whole.triples)
            self._tell_of(robot, "")
            self._say(f"{robot.name}: copied at commit {wanted.commit} ({count:,} triples): {anew.why}")

    def _write_alone(
        self,
        robot: _Robot,
        operations: Sequence[str],
        wanted: Facts,
        *,
        size: int = 0,
        one_by_one: bool = False,
    ) -> bool:
        """Write what is to be written of one robot; is it there now?

        A change of `size` triples that the server refuses is tried again in smaller steps: Virtuoso 7 refuses
        one of 800 commits, of which it would make more than 10 000 lines of SQL.
        """
        try:
            for some in ([operation] for operation in operations) if one_by_one else [operations]:
                self._send(some)
        except errors.BadRequest as error:
            if robot.following.take_less(size, wanted):
                return False
            self._tell_of(robot, error.text)
            robot.following.begin_anew()
            robot.ask_at_s = time.monotonic() + _REFUSED_S
            return False
        except errors.SemmapError as error:
            self._complain(error.text)
            return False
        return self._confirm([(robot, wanted)])

    def _send(self, operations: Sequence[str]) -> None:
        self._writer.update(operations)
        self.requests += 1

    def _confirm(self, written: Sequence[tuple[_Robot, Facts]]) -> bool:
        """Ask the server where it is now; where it is not what was written, somebody else has."""
        graphs = " ".join(f.graph(robot.name) for robot, _ in written)
        query = (
            f"SELECT ?robot ?digest {{ GRAPH {f.FACTS} {{"
            f" VALUES ?robot {{ {graphs} }} ?robot {f.term('digest')} ?digest }} }}"
        )
        try:
            rows = self._reader.query(query).rows
        except errors.SemmapError as error:
            self._complain(error.text)
            return False
        digests = {row[0]: row[1] for row in rows}
        as_wanted = True
        for robot, wanted in written:
            before = robot.following.facts
            if digests.get(f.graph(robot.name)) == f.text(wanted.digest):
                if robot.following.copying is None and before is not None:
                    self.commits += (wanted.commit or 0) - (before.commit or 0)
                robot.following.learn(structs.replace(wanted, copying=""), wanted)
            else:
                as_wanted = False
                robot.following.learn(before, wanted)
                self._server = None  # look at all of it
        return as_wanted

    # Threads

    def _beside(self, function: Callable[[], Any], done: Callable[[Future[Any]], None]) -> None:
        """Call `function` on a thread beside, and then `done(future)` on this one."""
        self._threads.submit(function).add_done_callback(functools.partial(self._later, done))

    def _later(self, function: Callable[..., None], *args: Any) -> None:
        """Call `function` on the thread that owns everything."""
        if not self._stopped:
            self._events.put(functools.partial(function, *args))

    def _tell_of(self, robot: _Robot, text: str) -> None:
        """Something that is wrong with a robot, once."""
        if text and text != robot.told:
            self._say(f"{robot.name}: {text}; trying again")
        robot.told = text

    def _say(self, text: str) -> None:
        self._tell(text)
