"""Presence of nodes; queries to a node are cancelled when it goes away.

Zenoh (1.10.2) ends the questions that a peer has when it goes. One that was sent within the few milliseconds
until that is noticed nobody has, and it waits for its time-out.
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


class LivelinessMonitor:
    """Of the nodes that serve, as one session sees them: what hangs on one is cancelled when that is cut.

    It costs a question some microseconds. Any thread may use it.
    """

    def __init__(self, session: zenoh.Session) -> None:
        self._session = session
        self._tokens: dict[tuple[str, ...], zenoh.CancellationToken] = {}
        self._there: set[str] = set()
        self._foreign_replies: set[str] = set()
        self._instances: dict[str, frozenset[str]] = {}
        session.liveliness().declare_subscriber(keys.live_key("*"), self._on_change, history=True)

    def is_there(self, node: str) -> bool:
        """Is a process of this node ready?"""
        return any(keys.live_node(key) == node for key in tuple(self._there))

    def has_seen(self, nodes: tuple[str, ...]) -> bool:
        """Has a process of any of these nodes been ready since this session began?"""
        return not self._instances.keys().isdisjoint(nodes)

    def look(self, nodes: tuple[str, ...]) -> None:
        """Wait until it is known which of these nodes are there, if none has been seen yet.

        In a session's first moments a reply may be here before the news of who is there. It is asked several
        times, since Zenoh (1.10.2) now and then says that nobody is. Not for a thread of Zenoh's.
        """
        for _ in range(_LOOKS):
            if self.has_seen(nodes):
                return
            for reply in self._session.liveliness().get(keys.live_key("*"), timeout=_LOOK_S):
                if reply.ok is not None:
                    self._know(str(reply.ok.key_expr))

    def vouch(self, nodes: tuple[str, ...], reply: zenoh.Reply) -> bool:
        """Is the reply by one of these nodes? Of whom none is ready, nobody can tell."""
        ready = {instance for node in nodes for instance in self._instances.get(node, ())}
        replier = reply.replier_id if ready else None
        return replier is None or str(replier.zid) in ready

    def is_news(self, key: str) -> bool:
        """Is it the first time that somebody else was found to answer on this key?"""
        known = key in self._foreign_replies
        self._foreign_replies.add(key)
        return not known

    def of(self, nodes: tuple[str, ...]) -> zenoh.CancellationToken:
        """For questions, from now on, that any of these nodes may answer."""
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


def declare_presence(session: zenoh.Session, node: str) -> Any:
    """Let this session be seen as a ready `node`, for as long as it lives and keeps what is returned.

    The token bears the session's id, which replies bear too, so that others can tell whose they are.
    """
    return session.liveliness().declare_token(keys.live_key(node, str(session.info.zid())))


def find_robots(session: zenoh.Session) -> dict[str, frozenset[str]]:
    """The robots that can be reached, by name, and which of their nodes are there.

    The session has no namespace. A system without one is a robot without a name: "".
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

    It has been called for those that are there already when this returns; later it is called on a thread of
    Zenoh's. The session has no namespace. The subscriber is returned.
    """
    pattern = keys.robots_live(node)
    told: set[str] = set()
    news = threading.Condition()

    def on_change(sample: zenoh.Sample) -> None:
        key = str(sample.key_expr)
        receive(keys.live_robot(key), keys.last_chunk(key), sample.kind != zenoh.SampleKind.DELETE)
        with news:
            told.add(key)
            news.notify_all()

    # asked for first: beside a new subscriber, Zenoh (1.10.2) now and then answers that nobody is there
    replies = list(session.liveliness().get(pattern, timeout=_ROBOTS_S))
    there = {str(reply.ok.key_expr) for reply in replies if reply.ok is not None}
    subscriber = session.liveliness().declare_subscriber(pattern, on_change, history=True)
    with news:
        news.wait_for(lambda: there <= told, _ROBOTS_S)  # one that has gone on_wait is not told of
    return subscriber


def follow_presence(session: zenoh.Session, node: str, receive: Callable[[bool], None]) -> Any:
    """Call `receive(there)` whenever the first process of a node appears or the last one is gone.

    It is called on a thread of Zenoh's, at first when one is there already. The subscriber is returned.
    """
    there: set[str] = set()

    def on_change(sample: zenoh.Sample) -> None:
        was = bool(there)
        (there.discard if sample.kind == zenoh.SampleKind.DELETE else there.add)(str(sample.key_expr))
        if was != bool(there):
            receive(bool(there))

    return session.liveliness().declare_subscriber(keys.live_key(node), on_change, history=True)
