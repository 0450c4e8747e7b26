"""The typed Python client.

    from semmap import connect

    with connect() as semmap:
        semmap.add("Beer", "beer1", at=(1.0, 2.0, 0.9), ref="beer")
        for entity in semmap.list("Drinkable"):
            print(entity.name, entity.pose)

Each method sends one command and returns its reply (`client_commands.py`).
"""

from __future__ import annotations

import contextlib
import functools
import os
import queue
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, Literal, TypeVar

import msgspec

from semmap.nodes import bus
from semmap.nodes.extern import backup
from semmap.nodes.extern.camera_planes import make_planes
from semmap.nodes.extern.client_commands import CommandMethods
from semmap.nodes.extern.connection import identity as identify
from semmap.nodes.extern.connection import namespace as robot
from semmap.nodes.extern.connection import open_session, resolve_endpoint
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
from semmap.schemas.live import LivePose, RobotState
from semmap.schemas.moments import When, with_offset
from semmap.schemas.replies import Changed

R = TypeVar("R")
C = TypeVar("C", bound=Command)

LONG_S = 6 * 3600.0
"""Timeout [s], longer than any command takes. If the node that executes it ends, the request ends earlier."""
_MEET_S = 1.0
"""The longest time until a new publisher knows its subscribers."""
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
    """Connect to the system at `where`, and yield a client. Raises NoAnswer if the system does not respond.

    `identity` is `DIR/NAME` of a certificate, for a secure system. `source` is stored with each change; by
    default it is "perception" for a certificate with that role, else "operator".

    `namespace` is the name of a robot (`semmap up --namespace`). By default it is `SEMMAP_NAMESPACE`, or the
    name of the system at `where` if that runs on this machine.

    `mode` is the mode of the Zenoh session. A "peer" has a direct link to each node, so its requests are
    faster. A "client" has one link, to the endpoint `where`, and connects faster: a peer may take 0.1 s. By
    default it is a peer on the machine of the system, unless the system is secure.
    """
    certificate = identify(identity)
    where = resolve_endpoint(where, robot(namespace))
    with open_session(where, robot(namespace, where), certificate, mode=mode) as session:
        yield Client(session, source=source, agent=agent, identity=certificate)


_LONG = (Load, Undo, Clear)
"""What may be at work for long when a node ends: its restart is waited for, so that the end is known."""


class Client(CommandMethods):
    """A client over a Zenoh session. `source` and `agent` sign the commands that do not set their own."""

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
        self._publishers: dict[str, Any] = {}
        """The publishers of live poses and frames, by key."""
        self.prefix = keys.CMD if identity is None else keys.commands_as(identity.name)
        role = "" if identity is None else identity.role
        self._signature: dict[str, Any] = {"source": source or roles.default_source(role), "agent": agent}

    def send(self, command: Command[R], *, timeout_s: float = LONG_S) -> R:
        """Send a command and return its reply. An error reply is raised as its exception.

        Before it sends the command, raises BadRequest for a field with a wrong type, and Refused if the role
        of the certificate does not permit the command. Raises NoAnswer if there is no reply within
        `timeout_s` [s].
        """
        signed, prefer_complete = _prepare(command, self._signature), command.VERB in keys.OF_THE_MAP
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
        """Send a request as `bus.ask` does. An error that different versions cause says so."""
        try:
            return bus.ask(self.session, self.prefix, verb, command, kind, liveliness=self._liveliness, **how)
        except errors.SemmapError as error:
            if _is_version_mismatch(error) and (difference := version.difference(self._system_version())):
                raise type(error)(f"{error.text}; {difference}", explanation=error.explanation) from None
            raise

    def _system_version(self) -> str:
        """Return the version in the status of the system or, without a reply, that of this client."""
        ask = functools.partial(bus.ask, timeout_s=_VERSION_S, patience_s=0.0)
        try:
            status = ask(self.session, self.prefix, Status.VERB, Status(), dict[str, Any])
        except errors.SemmapError:
            return version.version()
        return str(status.get("version", ""))

    def request(self, make: Callable[[], Command[R]], read: Callable[[R], Any] | None = None) -> Any:
        """Make a command, send it, and return its reply, converted by `read`."""
        reply = self.send(make())
        return reply if read is None else read(reply)

    def backup(self, file: str | Path, *, overwrite: bool = False) -> Opening:
        """Write the map and its history to a local file, while the system runs; `semmap restore` reads it.

        Returns which map it is, and its commit. Raises BadFile if the file exists and `overwrite` is not set,
        or if it cannot be written.
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
        """Publish the current pose of a tracked entity; the newest pose is used.

        `at` is the bottom centre [m] in the map frame. `yaw` [rad] or `orientation` (unit quaternion wxyz) is
        the rotation. `stamp_ns` is the time of the measurement; 0 is the time of arrival.

        There is no reply: accepted poses are in `client.get(name).live`, rejected ones in the problems of
        `client.status()`. Raises BadRequest for an invalid pose, and Refused if the certificate of this
        client does not permit it.
        """
        fields = {"at": at, "yaw": yaw, "orientation": orientation, "stamp_ns": stamp_ns}
        self._publish(keys.LIVE_POSE, keys.live_pose_key(name), LivePose, fields)

    def publish_robot(
        self,
        name: str,
        joints: Mapping[str, float],
        at: Sequence[float],
        *,
        yaw: float | None = None,
        orientation: Sequence[float] | None = None,
        stamp_ns: int = 0,
    ) -> None:
        """Publish the joints and the base of a robot, which `semmap up --mask-robot` leaves out of frames.

        `joints` are positions [rad, m] by name; those left out are 0. `at` is the origin of the robot's model
        [m] in the map frame. `yaw`, `orientation` and `stamp_ns` are as for `publish_pose`; the stamp must be
        within 0.1 s of that of a frame.

        There is no reply: perception reports missing or invalid states in `client.status()`. Raises
        BadRequest for an invalid state, and Refused if the certificate of this client does not permit it.
        """
        fields = {"joints": joints, "at": at, "yaw": yaw, "orientation": orientation, "stamp_ns": stamp_ns}
        self._publish(keys.ROBOT_STATE, keys.robot_state_key(name), RobotState, fields)

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
        """Publish the pose of a custom frame in its `parent`.

        For example, `client.publish_frame("robot1/lidar", "robot1", at=(0.2, 0.0, 0.3))`. `at` is the origin
        [m] in the parent. `yaw` [rad] or `orientation` (unit quaternion wxyz) is the rotation. `stamp_ns` is
        the time of the measurement; 0 is the time of arrival. A frame expires unless it is published again
        within `semmap up --stale` seconds. A `fixed` frame is published once, and again after a restart of
        the coordinator.

        There is no reply: accepted frames are in `client.frames(name)`, rejected ones in the problems of
        `client.status()`. Raises BadRequest for an invalid pose, and Refused if the certificate of this
        client does not permit it.
        """
        pose = {"at": at, "yaw": yaw, "orientation": orientation, "stamp_ns": stamp_ns}
        self._publish(keys.FRAME, _frame_key(name), FramePose, {"parent": parent, "fixed": fixed, **pose})

    def publish_camera(
        self,
        name: str,
        rgb: Any,
        depth_m: Any,
        intrinsics: Any,
        map_from_camera: Any,
        *,
        stamp_ns: int = 0,
    ) -> None:
        """Publish one frame of a depth camera to perception; the newest frame is used.

        `rgb` has (height, width, 3) 8-bit numbers. `depth_m` has (height, width) floats: metres along the
        optical axis, 0 or NaN for no measurement. `intrinsics` is (3, 3) or (fx, fy, cx, cy) [pixel].
        `map_from_camera` is the (4, 4) pose [m] of the optical frame: x right, y down, z into the scene.
        `stamp_ns` is the time of the measurement; 0 is now.

        There is no reply: what perception sees is published on `semmap/perception/observations` and, with
        `--truth perceived`, becomes part of the map. Raises BadRequest for invalid arrays, and Refused if the
        certificate of this client does not permit it.
        """
        planes = make_planes(name, rgb, depth_m, intrinsics, map_from_camera, stamp_ns or time.time_ns())
        self._require_publishing(keys.CAMERA)
        for plane, pixels, frame in planes:
            key = keys.camera_key(name, plane)
            self._publisher(keys.CAMERA, key).put(pixels, attachment=codec.encode(frame))

    def withdraw_frame(self, name: str) -> None:
        """Remove a published frame, including a fixed one."""
        self._publish(keys.FRAME, _frame_key(name), None, {})

    def _publish(
        self, topic: keys.Topic, key: str, kind: type[LivePose | FramePose] | None, fields: dict[str, Any]
    ) -> None:
        """Put a pose on a key or, without a `kind`, delete the key."""
        message: LivePose | FramePose | None = None
        if kind is not None:
            plain = msgspec.to_builtins(fields, enc_hook=_to_builtin)
            try:
                message = codec.convert(plain, kind)
                message.require_pose()
            except errors.BadRequest as error:
                raise errors.BadRequest(error.text.removeprefix(codec.MALFORMED)) from None
        self._require_publishing(topic)
        publisher = self._publisher(topic, key)
        if isinstance(message, FramePose) and message.fixed:  # which is published once
            bus.await_subscriber(publisher, _MEET_S)
        if message is None:
            publisher.delete()
        else:
            publisher.put(codec.encode(message), encoding=codec.encoding_of(message))

    def _require_publishing(self, topic: keys.Topic) -> None:
        if self.identity is not None and not roles.may_publish(self.identity.role, topic):
            raise errors.Refused(roles.not_publishing(self.identity.role, topic))

    def _publisher(self, topic: keys.Topic, key: str) -> Any:
        if key not in self._publishers:
            self._publishers[key] = bus.publisher(self.session, topic, key)
        return self._publishers[key]

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
        """Watch the rows of a SELECT query, or the entities at a location.

        `with client.watch(query) as standing: ...` has the current rows in `standing.rows`, and yields their
        changes from `standing.changes()`. `on`, `in_` and `near` have the meaning that they have in `list`;
        then each row is the IRI of an entity.
        """
        command = Watch(
            query=query, inferred=inferred, class_=class_, on=on, in_=in_, near=near, within=within
        )
        standing = StandingQuery(self.session, self._ask, _prepare(command, {}))
        try:
            yield standing
        finally:
            standing.close()

    @contextlib.contextmanager
    def commits(self, *, timeout: float | None = None) -> Iterator[Iterator[Commit]]:
        """Iterate over new commits: `with client.commits() as commits: for commit in commits: ...`.

        Raises NoAnswer if there is no commit for `timeout` seconds. If a system with another map replaces the
        system, its commits follow; their numbers may be lower.
        """
        began_ns = time.time_ns()
        events: queue.SimpleQueue[Commit | None] = queue.SimpleQueue()
        subscriber = bus.follow(self.session, keys.COMMIT, lambda _, commit: events.put(commit))
        try:
            now = self.status().commit
            # A late subscriber also receives cached commits from before, which are skipped.
            yield (c for c in _wait_for_commits(events, timeout) if c.seq > now or c.stamp_ns > began_ns)
        finally:
            subscriber.undeclare()
            events.put(None)  # ends an iteration that waits on another thread


def _frame_key(name: str) -> str:
    if not name or "" in name.split("/"):
        raise errors.BadRequest(f"'{name}' is not a valid frame name; examples: robot1/lidar, lidar1")
    return keys.frame_key(name)


def _wait_for_commits(events: queue.SimpleQueue[Commit | None], timeout_s: float | None) -> Iterator[Commit]:
    while True:
        try:
            commit = events.get(timeout=timeout_s)
        except queue.Empty:
            raise errors.NoAnswer(f"no commit received within {timeout_s:g} s") from None
        if commit is None:
            return
        yield commit


def _is_version_mismatch(error: errors.SemmapError) -> bool:
    """Return whether different versions may cause an error.

    That is a message that cannot be decoded, an unknown command, or an error of an unknown type.
    """
    malformed = isinstance(error, errors.BadRequest) and error.text.startswith(codec.MALFORMED)
    return malformed or isinstance(error, errors.UnknownVerb) or type(error) is errors.SemmapError


def _prepare(command: C, signature: dict[str, Any]) -> C:
    """Return the command to send: signed, with Python numbers, and with time zone offsets in its times.

    A change without an id gets one. So it is executed once, even if the coordinator is killed before it
    replies and the command is sent again. Raises BadRequest.
    """
    fields = msgspec.to_builtins(command, builtin_types=(bytes,), enc_hook=_to_builtin)
    for moment in _time_fields(type(command)) & fields.keys():
        fields[moment] = with_offset(fields[moment])
    if reply_type(type(command)) is Changed and not command.id:
        fields["id"] = _new_id()
    try:
        return codec.convert({**signature, **fields}, type(command))
    except errors.BadRequest as error:  # the caller did not write a message
        raise errors.BadRequest(error.text.removeprefix(codec.MALFORMED)) from None


def _new_id() -> str:
    """Return a unique id. Ids increase with time, so that the index of the journal is appended to."""
    return f"{time.time_ns():016x}{os.urandom(8).hex()}"


@functools.cache
def _time_fields(kind: type[Command]) -> frozenset[str]:
    """Return the names of the fields that are points in the history of the map."""
    return frozenset(f.encode_name for f in msgspec.structs.fields(kind) if f.type == When | None)


def _to_builtin(value: Any) -> Any:
    """Convert NumPy numbers and arrays to Python numbers and lists."""
    if hasattr(value, "tolist"):
        return value.tolist()
    raise errors.BadRequest(f"{value!r} is not a number, a string or a sequence of them")
