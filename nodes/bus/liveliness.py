"""Presence of nodes by Zenoh's liveliness tokens; queries to a node are cancelled when it goes away.

Zenoh (1.10.2) ends the queries to a peer that goes away. A query that is sent in the few milliseconds before
this is noticed reaches no node, and waits for its time-out.
"""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Any, Final

import zenoh

from semmap.schemas import keys

_ROBOTS_S: Final = 3.0
_LOOK_S: Final = 1.0
_LOOKS: Final = 6
_MAX_GONE: Final = 10_000
"""The largest number of remembered sessions; the oldest are dropped."""


class LivelinessMonitor:
    """The nodes that serve, as one session sees them; cancels queries to nodes that go away.

    Costs some microseconds for each query. Any thread may use it.
    """

    def __init__(self, session: zenoh.Session) -> None:
        self._session = session
        self._tokens: dict[tuple[str, ...], zenoh.CancellationToken] = {}
        self._there: set[str] = set()
        self._foreign_replies: set[str] = set()
        self._instances: dict[str, frozenset[str]] = {}
        session.liveliness().declare_subscriber(keys.live_key("*"), self._on_change, history=True)

    def is_there(self, node: str) -> bool:
        """Return whether a process of this node is ready."""
        return any(keys.live_node(key) == node for key in tuple(self._there))

    def has_seen(self, nodes: tuple[str, ...]) -> bool:
        """Return whether a process of any of these nodes has been ready since this session began."""
        return not self._instances.keys().isdisjoint(nodes)

    def wait_until_known(self, nodes: tuple[str, ...]) -> None:
        """Wait until it is known which of these nodes are there, if none has been seen yet.

        In the first moments of a session, a reply may arrive before the liveliness tokens. The query is
        repeated, because Zenoh (1.10.2) sometimes returns no token. Must not be called on a thread of Zenoh.
        """
        for _ in range(_LOOKS):
            if self.has_seen(nodes):
                return
            for reply in self._session.liveliness().get(keys.live_key("*"), timeout=_LOOK_S):
                if reply.ok is not None:
                    self._know(str(reply.ok.key_expr))

    def is_from(self, nodes: tuple[str, ...], reply: zenoh.Reply) -> bool:
        """Return whether a reply is from one of these nodes; True if none of them is ready."""
        ready = {instance for node in nodes for instance in self._instances.get(node, ())}
        replier = reply.replier_id if ready else None
        return replier is None or str(replier.zid) in ready

    def is_first_foreign_reply(self, key: str) -> bool:
        """Return whether this is the first foreign reply on this key."""
        known = key in self._foreign_replies
        self._foreign_replies.add(key)
        return not known

    def token_for(self, nodes: tuple[str, ...]) -> zenoh.CancellationToken:
        """Return the cancellation token for new queries that any of these nodes may answer."""
        return self._tokens.get(nodes) or self._tokens.setdefault(nodes, zenoh.CancellationToken())

    def _know(self, key: str) -> None:
        node = keys.live_node(key)
        self._instances[node] = self._instances.get(node, frozenset()) | {keys.last_chunk(key)}

    def _on_change(self, sample: zenoh.Sample) -> None:
        key = str(sample.key_expr)
        if sample.kind != zenoh.SampleKind.DELETE:
            self._there.add(key)
            self._know(key)
            return
        node, instance = keys.live_node(key), keys.last_chunk(key)
        self._there.discard(key)
        self._instances[node] = self._instances.get(node, frozenset()) - {instance}
        gone = node
        for nodes in [nodes for nodes in list(self._tokens) if gone in nodes]:
            self._tokens.pop(nodes).cancel()  # type: ignore[no-untyped-call]


class DepartureMonitor:
    """The sessions that have gone. Every session of `open_session` holds a token; others never count as gone.

    A session that is linked only through a node also counts as gone when that node goes: it receives no reply
    to its present queries, and repeats them itself. Any thread may use it.
    """

    def __init__(self, session: zenoh.Session) -> None:
        self._gone: dict[str, None] = {}
        session.liveliness().declare_subscriber(keys.session_key(), self._on_change)

    def has_gone(self, instance: str) -> bool:
        """Return whether the session with this id has gone."""
        return instance in self._gone

    def _on_change(self, sample: zenoh.Sample) -> None:
        instance = keys.last_chunk(str(sample.key_expr))
        if sample.kind != zenoh.SampleKind.DELETE:
            self._gone.pop(instance, None)
            return
        self._gone[instance] = None
        if len(self._gone) > _MAX_GONE:
            self._gone.pop(next(iter(self._gone)))


def declare_presence(session: zenoh.Session, node: str) -> Any:
    """Declare this session as a ready `node`, as long as the returned token is kept.

    The token contains the id of the session, which is also in its replies, so that clients can attribute
    them.
    """
    return session.liveliness().declare_token(keys.live_key(node, str(session.info.zid())))


def find_robots(session: zenoh.Session) -> dict[str, frozenset[str]]:
    """Return the reachable robots by name, with their running nodes.

    The session must have no namespace. A system without a namespace is a robot without a name: "".
    """
    found: dict[str, set[str]] = {}
    for pattern, name_of in ((keys.robots_live(), keys.live_robot), (keys.live_key("*"), lambda _: "")):
        for reply in session.liveliness().get(pattern, timeout=_ROBOTS_S):
            if reply.ok is not None:
                key = str(reply.ok.key_expr)
                found.setdefault(name_of(key), set()).add(keys.live_node(key))
    return {name: frozenset(nodes) for name, nodes in sorted(found.items())}


def follow_robots(session: zenoh.Session, node: str, receive: Callable[[str, str, bool], None]) -> Any:
    """Call `receive(robot, instance, there)` whenever a process of this node of a robot appears or goes.

    When this function returns, `receive` has been called for the present processes. Later it is called on a
    thread of Zenoh. The session must have no namespace. Returns the subscriber.
    """
    pattern = keys.robots_live(node)
    reported: set[str] = set()
    changed = threading.Condition()

    def on_change(sample: zenoh.Sample) -> None:
        key = str(sample.key_expr)
        receive(keys.live_robot(key), keys.last_chunk(key), sample.kind != zenoh.SampleKind.DELETE)
        with changed:
            reported.add(key)
            changed.notify_all()

    # queried first: next to a new subscriber, Zenoh (1.10.2) sometimes returns no token
    replies = list(session.liveliness().get(pattern, timeout=_ROBOTS_S))
    there = {str(reply.ok.key_expr) for reply in replies if reply.ok is not None}
    subscriber = session.liveliness().declare_subscriber(pattern, on_change, history=True)
    with changed:
        changed.wait_for(lambda: there <= reported, _ROBOTS_S)  # one that has gone is not reported
    return subscriber


def follow_presence(session: zenoh.Session, node: str, receive: Callable[[bool], None]) -> Any:
    """Call `receive(there)` whenever the first process of a node appears or the last one is gone.

    It is called on a thread of Zenoh, initially if a process is already there. Returns the subscriber.
    """
    there: set[str] = set()

    def on_change(sample: zenoh.Sample) -> None:
        was = bool(there)
        (there.discard if sample.kind == zenoh.SampleKind.DELETE else there.add)(str(sample.key_expr))
        if was != bool(there):
            receive(bool(there))

    return session.liveliness().declare_subscriber(keys.live_key(node), on_change, history=True)
