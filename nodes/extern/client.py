"""The typed Python client.

    from semmap import connect

    with connect() as semmap:
        semmap.add("Beer", "beer1", at=(1.0, 2.0, 0.9), ref="beer")
        for entity in semmap.list("Drinkable"):
            print(entity.name, entity.pose)

Every verb sends one command and returns its reply (`client_verbs.py`).
"""

from __future__ import annotations

import contextlib
import functools
import os
import queue
import time
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any, Literal, TypeVar

import msgspec

from semmap.nodes import bus
from semmap.nodes.extern import backup
from semmap.nodes.extern.client_verbs import Verbs
from semmap.nodes.extern.connection import endpoint, open_session
from semmap.nodes.extern.connection import identity as identify
from semmap.nodes.extern.connection import namespace as robot
from semmap.nodes.extern.sparql_client import StandingQuery
from semmap.nodes.identity import Identity
from semmap.nodes.runtime import version
from semmap.schemas import codec, errors, keys, roles
from semmap.schemas.backups import Opening
from semmap.schemas.calls import reply_type
from semmap.schemas.commands import Clear, Command, Load, Status, Undo, Watch
from semmap.schemas.commits import Commit
from semmap.schemas.entities import Source
from semmap.schemas.frames import FramePose
from semmap.schemas.live import LivePose
from semmap.schemas.moments import When, with_offset
from semmap.schemas.replies import Changed

R = TypeVar("R")
C = TypeVar("C", bound=Command)

LONG_S = 6 * 3600.0
"""Seconds: longer than any command takes. The end of the node that has it ends the question before."""
_VERSION_S = 2.0


@contextlib.contextmanager
def connect(
    where: str | None = None,
    *,
    source: Source | None = None,
    agent: str = "",
    namespace: str | None = None,
    identity: str | None = None,
    mode: Literal["peer", "client"] | None = None,
) -> Iterator[Client]:
    """A client of the system at `where`. Raises NoAnswer when nothing answers there.

    That is said at once where this machine refuses the connection and no system is starting. `identity` is
    `DIR/NAME` of a certificate, for a secure system. Changes are signed as `source`: unless it is given,
    "perception" for a certificate of that role, else "operator".

    `namespace` is the name of one robot of several (`semmap up --namespace`): by default what
    `SEMMAP_NAMESPACE` says, or else that of the system at `where`, if it runs on this machine.

    `mode` is how the session joins, in Zenoh's words. A "peer" has a link to each node, so its questions
    travel the shortest way; a "client" has one link, to whoever listens at `where`, and has joined at once,
    where a peer may take 0.1 s. By default it is a peer on the system's own machine, unless that is secure.
    """
    who = identify(identity)
    where = where or endpoint(robot(namespace))
    with open_session(where, robot(namespace, where), who, mode=mode) as session:
        yield Client(session, source=source, agent=agent, identity=who)


_LONG = (Load, Undo, Clear)
"""What may be at work for long when a node ends: its restart is waited for, so that the end is known."""


class Client(Verbs):
    """Commands over a session of yours; `source` and `agent` sign those that do not say their own."""

    def __init__(
        self,
        session: bus.Session,
        *,
        source: Source | None = None,
        agent: str = "",
        identity: Identity | None = None,
    ) -> None:
        self.session = session
        self.identity = identity
        self._liveliness = bus.LivelinessMonitor(session)
        self._live: dict[str, Any] = {}
        """The publishers of live poses and frames, by key."""
        self.prefix = keys.CMD if identity is None else keys.commands_as(identity.name)
        role = "" if identity is None else identity.role
        self._signature: dict[str, Any] = {"source": source or roles.default_source(role), "agent": agent}

    def send(self, command: Command[R], *, timeout_s: float = LONG_S) -> R:
        """Send any command and return its reply; raises the error that it is answered with.

        Raises BadRequest, before anything is sent, for a field that is not of its type, Refused for what the
        role of this client's certificate does not permit, and NoAnswer when the reply takes longer than
        `timeout_s` [s].
        """
        signed, prefer_complete = _checked(command, self._signature), command.VERB in keys.OF_THE_MAP
        if self.identity is not None and (refusal := roles.refusal(self.identity.role, signed)) is not None:
            raise errors.Refused(refusal)
        reply: R = self._ask(
            command.VERB,
            signed,
            reply_type(type(command)),
            timeout_s=timeout_s,
            patience_s=bus.RESTART_S if isinstance(command, _LONG) else bus.PATIENCE_S,
            prefer_complete=prefer_complete,
        )
        return reply

    def _ask(self, verb: str, command: Command, kind: Any, **how: Any) -> Any:
        """As `bus.ask`; a misunderstanding between versions is told as one."""
        try:
            return bus.ask(self.session, self.prefix, verb, command, kind, liveliness=self._liveliness, **how)
        except errors.SemmapError as error:
            if _may_be_of_versions(error) and (difference := version.difference(self._version_of_system())):
                raise type(error)(f"{error.text}; {difference}", explanation=error.explanation) from None
            raise

    def _version_of_system(self) -> str:
        """What its status says; this client's own where nobody says."""
        ask = functools.partial(bus.ask, timeout_s=_VERSION_S, patience_s=0.0)
        try:
            said = ask(self.session, self.prefix, Status.VERB, Status(), dict[str, Any])
        except errors.SemmapError:
            return version.version()
        return str(said.get("version", ""))

    def request(self, make: Callable[[], Command[R]], read: Callable[[R], Any] | None = None) -> Any:
        """Make a command, send it, and `read` its reply: what each verb does."""
        reply = self.send(make())
        return reply if read is None else read(reply)

    def backup(self, file: str | Path, *, overwrite: bool = False) -> Opening:
        """Write the map with its history to a file here, while the system runs; `semmap restore` reads it.

        Returns which map it is, and as of which commit. Raises BadFile when the file is there and not to be
        overwritten, or cannot be written.
        """
        return backup.write(self.send, file, overwrite=overwrite)

    def publish_pose(
        self,
        name: str,
        at: Sequence[float],
        *,
        yaw: float | None = None,
        orientation: Sequence[float] | None = None,
        stamp_ns: int = 0,
    ) -> None:
        """Say where a tracked entity is just now, as often as that is known; the newest pose wins.

        `at` is its bottom centre [m] in the map frame, `yaw` [rad] or `orientation` (unit quaternion wxyz)
        how it is turned, and `stamp_ns` when that was measured (0: when it arrives). There is no reply: what
        was taken, `client.get(name).live` tells, and what was not, the problems of `client.status()`. Raises
        BadRequest for what is no pose, Refused where this client's certificate does not permit it.
        """
        fields = {"at": at, "yaw": yaw, "orientation": orientation, "stamp_ns": stamp_ns}
        self._publish(keys.LIVE_POSE, keys.live_pose_key(name), LivePose, fields)

    def publish_frame(
        self,
        name: str,
        parent: str,
        at: Sequence[float] = (0.0, 0.0, 0.0),
        *,
        yaw: float | None = None,
        orientation: Sequence[float] | None = None,
        stamp_ns: int = 0,
        fixed: bool = False,
    ) -> None:
        """Say where a frame of yours is in its `parent`.

        `client.publish_frame("robot1/lidar", "robot1", at=(0.2, 0.0, 0.3))`. `at` is its origin [m] in the
        parent, `yaw` [rad] or `orientation` (unit quaternion wxyz) how it is turned, and `stamp_ns` when that
        was measured (0: when it arrives). It is stale when it is not said again within `semmap up --stale`
        seconds; what is `fixed` is said once, and again after a restart of the coordinator.

        There is no reply: what was taken, `client.frames(name)` tells, and what was not, the problems of
        `client.status()`. Raises BadRequest for what is no pose, Refused where this client's certificate
        does not permit it.
        """
        pose = {"at": at, "yaw": yaw, "orientation": orientation, "stamp_ns": stamp_ns}
        self._publish(keys.FRAME, _frame_key(name), FramePose, {"parent": parent, "fixed": fixed, **pose})

    def withdraw_frame(self, name: str) -> None:
        """Take a frame that is published away, a fixed one too."""
        self._publish(keys.FRAME, _frame_key(name), None, {})

    def _publish(
        self, topic: keys.Topic, key: str, kind: type[LivePose | FramePose] | None, fields: dict[str, Any]
    ) -> None:
        """Put a pose on a key; without a `kind` delete what was put there."""
        message: LivePose | FramePose | None = None
        if kind is not None:
            plain = msgspec.to_builtins(fields, enc_hook=_plain)
            try:
                message = codec.convert(plain, kind)
                message.require_pose()
            except errors.BadRequest as error:
                raise errors.BadRequest(error.text.removeprefix(codec.MALFORMED)) from None
        if self.identity is not None and not roles.may_publish(self.identity.role, topic):
            raise errors.Refused(roles.not_publishing(self.identity.role, topic))
        if key not in self._live:
            self._live[key] = bus.publisher(self.session, topic, key)
        if message is None:
            self._live[key].delete()
        else:
            self._live[key].put(codec.encode(message), encoding=codec.encoding_of(message))

    @contextlib.contextmanager
    def watch(
        self,
        query: str | None = None,
        *,
        inferred: bool = False,
        class_: str | None = None,
        on: str | None = None,
        in_: str | None = None,
        near: str | None = None,
        within: float | None = None,
    ) -> Iterator[StandingQuery]:
        """`with client.watch(select) as standing: ...`: its rows, and in `standing.changes()` the news.

        Or, instead of a query, `on`, `in_` and `near` as for `list`: a row is an entity's IRI.
        """
        wanted = Watch(
            query=query, inferred=inferred, class_=class_, on=on, in_=in_, near=near, within=within
        )
        standing = StandingQuery(self.session, self._ask, _checked(wanted, {}))
        try:
            yield standing
        finally:
            standing.close()

    @contextlib.contextmanager
    def commits(self, *, timeout: float | None = None) -> Iterator[Iterator[Commit]]:
        """`with client.commits() as commits: for commit in commits: ...`: every commit from now on.

        The next one is waited for without end, or for `timeout` seconds, which then raises NoAnswer.

        A late subscriber is sent some of the past, too (that is how nothing is lost); it is passed over. When
        the system gives way to one with another map, whose numbers may be lower, that one's commits follow.
        """
        began_ns = time.time_ns()
        events: queue.SimpleQueue[Commit | None] = queue.SimpleQueue()
        subscriber = bus.follow(self.session, keys.COMMIT, lambda _, commit: events.put(commit))
        try:
            now = self.status().commit
            yield (c for c in _each(events, timeout) if c.seq > now or c.stamp_ns > began_ns)
        finally:
            subscriber.undeclare()
            events.put(None)  # whoever waits for the next one on another thread is told of the end


def _frame_key(name: str) -> str:
    if not name or "" in name.split("/"):
        raise errors.BadRequest(f"'{name}' is no name of a frame; such are robot1/lidar or lidar1")
    return keys.frame_key(name)


def _each(events: queue.SimpleQueue[Commit | None], timeout_s: float | None) -> Iterator[Commit]:
    while True:
        try:
            commit = events.get(timeout=timeout_s)
        except queue.Empty:
            raise errors.NoAnswer(f"no commit came within {timeout_s:g} s") from None
        if commit is None:
            return
        yield commit


def _may_be_of_versions(error: errors.SemmapError) -> bool:
    """A message that one end cannot read, a verb that it does not have, or an error of an unknown kind."""
    malformed = isinstance(error, errors.BadRequest) and error.text.startswith(codec.MALFORMED)
    return malformed or isinstance(error, errors.UnknownVerb) or type(error) is errors.SemmapError


def _checked(command: C, signature: dict[str, Any]) -> C:
    """The command as it is sent: signed, in Python's own numbers, with offsets in its times.

    A change has an id, so that it is executed once even if the coordinator is killed before it replies and
    the command is sent again. Raises BadRequest.
    """
    fields = msgspec.to_builtins(command, builtin_types=(bytes,), enc_hook=_plain)
    for moment in _moments(type(command)) & fields.keys():
        fields[moment] = with_offset(fields[moment])
    if reply_type(type(command)) is Changed and not command.id:
        fields["id"] = _new_id()
    try:
        return codec.convert({**signature, **fields}, type(command))
    except errors.BadRequest as error:  # a message is not what the caller knows of
        raise errors.BadRequest(error.text.removeprefix(codec.MALFORMED)) from None


def _new_id() -> str:
    """Unique, and later ones after earlier ones: then the journal's index of them grows at its end."""
    return f"{time.time_ns():016x}{os.urandom(8).hex()}"


@functools.cache
def _moments(kind: type[Command]) -> frozenset[str]:
    """The fields that are points in the map's history."""
    return frozenset(f.encode_name for f in msgspec.structs.fields(kind) if f.type == When | None)


def _plain(value: Any) -> Any:
    """Numbers and arrays of NumPy as Python's own."""
    if hasattr(value, "tolist"):
        return value.tolist()
    raise errors.BadRequest(f"{value!r} is not a number, a string or a sequence of them")
