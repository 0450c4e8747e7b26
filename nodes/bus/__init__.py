"""The only code that knows Zenoh: open a session, ask, serve, publish, follow."""

from nodes.bus.asking import TIMEOUT_S, Encoded, ask, ask_later, read_reply
from nodes.bus.lifelines import Lifelines, appear, follow_presence
from nodes.bus.pubsub import follow, follow_cameras, listen, publisher, watched
from nodes.bus.serving import Request, serve, serve_puts
from nodes.bus.session import (
    DEFAULT_ENDPOINT,
    FOREVER_S,
    PATIENCE_S,
    RESTART_S,
    TLS,
    Network,
    Session,
    host_of,
    is_local,
    open_session,
    over_tls,
)

__all__ = [
    "DEFAULT_ENDPOINT",
    "FOREVER_S",
    "PATIENCE_S",
    "RESTART_S",
    "TIMEOUT_S",
    "TLS",
    "Encoded",
    "Lifelines",
    "Network",
    "Request",
    "Session",
    "appear",
    "ask",
    "ask_later",
    "follow",
    "follow_cameras",
    "follow_presence",
    "host_of",
    "is_local",
    "listen",
    "open_session",
    "over_tls",
    "publisher",
    "read_reply",
    "serve",
    "serve_puts",
    "watched",
]
