"""The only code that knows Zenoh: open a session, ask, serve, publish, follow."""

from nodes.bus import own_config
from nodes.bus.asking import TIMEOUT_S, Encoded, ForeignReply, Patience, ask, ask_later, read_reply
from nodes.bus.lifelines import Lifelines, appear, follow_presence
from nodes.bus.pieces import MESSAGE, PIECE, PUBLISHED
from nodes.bus.pubsub import follow, follow_cameras, includes, listen, meets, publisher, watched
from nodes.bus.serving import Request, serve, serve_puts
from nodes.bus.session import (
    DEFAULT_ENDPOINT,
    FOREVER_S,
    PATIENCE_S,
    RESTART_S,
    TLS,
    HungUp,
    Network,
    Session,
    host_of,
    is_local,
    open_session,
    over_tls,
    require_tls,
)

__all__ = [
    "DEFAULT_ENDPOINT",
    "FOREVER_S",
    "MESSAGE",
    "PATIENCE_S",
    "PIECE",
    "PUBLISHED",
    "RESTART_S",
    "TIMEOUT_S",
    "TLS",
    "Encoded",
    "ForeignReply",
    "HungUp",
    "Lifelines",
    "Network",
    "Patience",
    "Request",
    "Session",
    "appear",
    "ask",
    "ask_later",
    "follow",
    "follow_cameras",
    "follow_presence",
    "host_of",
    "includes",
    "is_local",
    "listen",
    "meets",
    "open_session",
    "over_tls",
    "own_config",
    "publisher",
    "read_reply",
    "require_tls",
    "serve",
    "serve_puts",
    "watched",
]
