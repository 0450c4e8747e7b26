"""ROS 2 over Zenoh as documented by rmw_zenoh: keys, attachments and liveliness tokens of one node.

Data is published in CDR on `<domain>/<topic>/<type>/<hash>`, with an attachment that has a sequence number
and a stamp. A liveliness token announces each endpoint. Latched publications are kept in the publisher's
cache, which late subscribers query.
"""

from __future__ import annotations

import hashlib
import itertools
import struct
import time
from collections.abc import Callable
from typing import Any, Final, NamedTuple

import zenoh
from zenoh import ext

from semmap.nodes.bus import fragmentation

_SPACE: Final = "@ros2_lv"
_DEPTH: Final = 10
_CDR: Final = "application/cdr"
_ATTACHED: Final = struct.Struct("<qqB16s")


class RosTopic(NamedTuple):
    """A topic: its name as in `/map`, its type as in `nav_msgs/msg/OccupancyGrid`, and the type's hash.

    A `latched` publication also reaches later subscribers.
    """

    name: str
    type: str
    hash: str
    latched: bool = False
    reliable: bool = True

    def key(self, domain: int) -> str:
        """Return the key of its messages."""
        return f"{domain}/{self.name.strip('/')}/{self._dds_type}/{self.hash}"

    @property
    def qos(self) -> str:
        """Its quality of service as written in a token; an empty field is the default."""
        reliability = "" if self.reliable else "2"
        return f"{reliability}:{'1' if self.latched else ''}:,{self.depth}:,:,:,,"

    @property
    def depth(self) -> int:
        """The number of messages that are kept for a subscriber."""
        return 1 if self.latched else _DEPTH

    @property
    def token(self) -> str:
        """The end of the tokens of its endpoints."""
        return f"{self.name.replace('/', '%')}/{self._dds_type}/{self.hash}/{self.qos}"

    @property
    def tokens(self) -> str:
        """The same for any quality of service."""
        return f"{self.name.replace('/', '%')}/{self._dds_type}/{self.hash}/*"

    @property
    def _dds_type(self) -> str:
        package, kind, name = self.type.split("/")
        return f"{package}::{kind}::dds_::{name}_"


class RosNode:
    """A node in the ROS graph, within one session until that is closed. Any thread may use it."""

    def __init__(self, session: zenoh.Session, name: str, domain: int) -> None:
        self._session, self._name, self._domain = session, name, domain
        self._numbers = itertools.count(1)
        self._space = f"{_SPACE}/{domain}/{session.zid()}/0"
        self._kept: list[object] = []
        """Declarations end when no reference to them is left."""
        self._kept.append(session.liveliness().declare_token(f"{self._space}/0/NN/%/%/{name}"))

    def publish(self, topic: RosTopic) -> RosPublisher:
        """Create a publisher of a topic."""
        token = self._announce("MP", topic)
        made = RosPublisher(self._session, topic, topic.key(self._domain), token)
        self._kept.append(made)
        return made

    def subscribe(self, topic: RosTopic, receive: Callable[[bytes], None]) -> None:
        """Pass each message of a topic to `receive(cdr)`, on a thread of Zenoh, unless it is too large."""

        def on_sample(sample: zenoh.Sample) -> None:
            if len(sample.payload) <= fragmentation.PLANE_BYTES:
                receive(sample.payload.to_bytes())

        key = topic.key(self._domain)
        if topic.latched:
            ext.declare_advanced_subscriber(
                self._session,
                key,
                on_sample,
                history=ext.HistoryConfig(detect_late_publishers=True, max_samples=1),
            )
        else:
            self._session.declare_subscriber(key, on_sample)
        self._announce("MS", topic)

    def when_subscribed(self, topic: RosTopic, on_subscriber: Callable[[], None]) -> None:
        """Call `on_subscriber()` for each present and future subscriber of a topic."""

        def on_sample(sample: zenoh.Sample) -> None:
            if sample.kind == zenoh.SampleKind.PUT:
                on_subscriber()

        of_topic = f"{_SPACE}/{self._domain}/*/*/*/MS/*/*/*/{topic.tokens}"
        self._session.liveliness().declare_subscriber(of_topic, on_sample, history=True)

    def _announce(self, kind: str, topic: RosTopic) -> str:
        token = f"{self._space}/{next(self._numbers)}/{kind}/%/%/{self._name}/{topic.token}"
        self._kept.append(self._session.liveliness().declare_token(token))
        return token


class RosPublisher:
    """Publishes messages of one topic."""

    def __init__(self, session: zenoh.Session, topic: RosTopic, key: str, token: str) -> None:
        self._sequence = itertools.count(1)
        self._gid = hashlib.blake2b(token.encode(), digest_size=16).digest()
        wait = zenoh.CongestionControl.BLOCK if topic.reliable else zenoh.CongestionControl.DROP
        if topic.latched:
            self._publisher: Any = ext.declare_advanced_publisher(
                session,
                key,
                congestion_control=wait,
                cache=ext.CacheConfig(max_samples=1),
                sample_miss_detection=ext.MissDetectionConfig(heartbeat=None, sporadic_heartbeat=None),
                publisher_detection=True,
            )
        else:
            self._publisher = session.declare_publisher(key, congestion_control=wait)

    def put(self, cdr: bytes | memoryview) -> None:
        """Publish a message with the current time."""
        attached = _ATTACHED.pack(next(self._sequence), time.time_ns(), len(self._gid), self._gid)
        self._publisher.put(bytes(cdr), encoding=_CDR, attachment=attached)
