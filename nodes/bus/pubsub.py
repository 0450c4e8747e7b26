"""Publishers and subscribers of topics, with their quality of service."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Iterator
from functools import partial
from typing import Any, Literal

import zenoh
from zenoh import ext

from semmap.nodes.bus import fragmentation
from semmap.schemas import codec, errors, keys
from semmap.schemas.scenes import CameraFrame


def publisher(session: zenoh.Session, topic: keys.Topic, key: str | None = None) -> Any:
    """Return a publisher with the topic's quality of service."""
    key = key or topic.key
    if topic.qos == "newest":
        return session.declare_publisher(key, congestion_control=zenoh.CongestionControl.DROP)
    return ext.declare_advanced_publisher(
        session,
        key,
        congestion_control=zenoh.CongestionControl.BLOCK,
        cache=ext.CacheConfig(max_samples=1000),
        sample_miss_detection=ext.MissDetectionConfig(heartbeat=None, sporadic_heartbeat=0.5),
        publisher_detection=True,
    )


def await_subscriber(publisher: Any, most_s: float) -> None:
    """Wait until a publisher has a subscriber, at most `most_s`: before, Zenoh drops what it publishes."""
    end = time.monotonic() + most_s
    while not publisher.matching_status.matching and time.monotonic() < end:
        time.sleep(0.005)


def subscriber_check(session: zenoh.Session, topic: keys.Topic) -> Callable[[], bool]:
    """Return a function that returns whether any key of `topic` currently has a subscriber."""
    publisher = session.declare_publisher(topic.key)
    return lambda: publisher.matching_status.matching  # type: ignore[attr-defined]


def follow(
    session: zenoh.Session,
    topic: keys.Topic,
    receive: Callable[[str, Any], None],
    ignored: Callable[[], None] = lambda: None,
) -> Any:
    """Pass each publication of `topic` to `receive(key, message)`, on a thread of Zenoh.

    A malformed or too large publication is dropped, and `ignored()` is called.
    """

    def on_sample(sample: zenoh.Sample) -> None:
        if sample.kind == zenoh.SampleKind.DELETE:
            receive(str(sample.key_expr), None)
            return
        if len(sample.payload) > fragmentation.MESSAGE_BYTES:
            ignored()
            return
        try:
            message = codec.decode(sample.payload.to_bytes(), topic.message)
        except errors.BadRequest:
            ignored()
            return
        receive(str(sample.key_expr), message)

    # In a burst larger than the cache, Zenoh (1.10.2) skips samples while it recovers earlier ones.
    if topic.qos == "newest" or "*" in topic.key or topic is keys.ACK:
        return session.declare_subscriber(topic.key, on_sample)
    return ext.declare_advanced_subscriber(
        session,
        topic.key,
        on_sample,
        recovery=ext.RecoveryConfig(periodic_queries=None, heartbeat=True),
    )


class NewestSamples:
    """The newest publication of each key, for topics that are too frequent to handle one by one."""

    def __init__(
        self, session: zenoh.Session, topic: keys.Topic, most: int = 4096, *, deletions: bool = False
    ) -> None:
        """If more than `most` samples arrive between two calls of `take`, the oldest are dropped.

        With `deletions`, deleted keys are returned too: `read()` then returns None.
        """
        self._deletions = deletions
        self._subscriber = session.declare_subscriber(topic.key, zenoh.handlers.RingChannel(most))
        self._kind = topic.message

    def take(self) -> Iterator[tuple[str, Callable[[], Any]]]:
        """Yield the key and `read()`, which returns the message, of what has arrived since the last call.

        `read` raises BadRequest for an invalid message.
        """
        newest: dict[str, zenoh.Sample] = {}
        while (sample := self._subscriber.try_recv()) is not None:
            if sample.kind == zenoh.SampleKind.PUT or self._deletions:
                newest[str(sample.key_expr)] = sample
        for key, sample in newest.items():
            yield key, partial(self._read, sample)

    def _read(self, sample: zenoh.Sample) -> Any:
        if sample.kind == zenoh.SampleKind.DELETE:
            return None
        if len(sample.payload) > fragmentation.MESSAGE_BYTES:
            raise errors.BadRequest(f"message too large: {len(sample.payload):,} bytes")
        return codec.decode(sample.payload.to_bytes(), self._kind)


def follow_cameras(
    session: zenoh.Session,
    plane: Literal["rgb", "depth"],
    receive: Callable[[CameraFrame, Callable[[], bytes]], None],
    refuse: Callable[[str], None],
) -> Callable[[], None]:
    """Pass each plane of each camera to `receive(frame, read)`; `read()` returns its pixels.

    Both are called on a thread of Zenoh, so they must only queue. `refuse(reason)` is called for an invalid
    frame. Returns a function that ends the subscription.
    """

    def on_sample(sample: zenoh.Sample) -> None:
        try:
            attached = sample.attachment.to_bytes() if sample.attachment is not None else b""
            receive(codec.decode(attached, CameraFrame), sample.payload.to_bytes)
        except errors.BadRequest as error:
            refuse(f"{sample.key_expr}: {error.text}")

    subscriber = session.declare_subscriber(keys.camera_key("*", plane), on_sample)

    def stop() -> None:
        subscriber.undeclare()  # type: ignore[no-untyped-call]

    return stop


def includes(key_exprs: Iterable[str], key_expr: str) -> bool:
    """Return whether one of `key_exprs` includes `key_expr`; True for an invalid key expression."""
    try:
        wanted = zenoh.KeyExpr(key_expr)
    except zenoh.ZError:
        return True
    return any(zenoh.KeyExpr(one).includes(wanted) for one in key_exprs)


def intersects(key_exprs: Iterable[str], key_expr: str) -> bool:
    """Return whether one of `key_exprs` intersects `key_expr`; True for an invalid key expression."""
    try:
        wanted = zenoh.KeyExpr(key_expr)
    except zenoh.ZError:
        return True
    return any(zenoh.KeyExpr(one).intersects(wanted) for one in key_exprs)


def listen(session: zenoh.Session, key_expr: str) -> Iterator[tuple[str, str]]:
    """Yield key and content (as JSON) of new publications. Raises BadRequest if `key_expr` is invalid."""
    try:
        subscriber = session.declare_subscriber(key_expr)
    except zenoh.ZError as error:
        raise errors.BadRequest(
            f"'{key_expr}' is not a valid key expression: {str(error).split(' at /', 1)[0]}"
        ) from None
    for sample in subscriber:
        if sample.kind == zenoh.SampleKind.DELETE:
            yield str(sample.key_expr), "gone"
        else:
            yield str(sample.key_expr), codec.as_json(sample.payload.to_bytes())
