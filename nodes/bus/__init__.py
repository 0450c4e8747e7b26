"""The only code that knows Zenoh: open a session, ask, serve, publish, follow."""

from nodes.bus import own_config
from nodes.bus.asking import TIMEOUT_S, Encoded, ForeignReply, Patience, ask, ask_later, read_reply
from nodes.bus.lifelines import Lifelines, appear, follow_presence, robots
from nodes.bus.pieces import MESSAGE, PIECE, PUBLISHED
from nodes.bus.pubsub import follow, follow_cameras, includes, listen, publisher, watched
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
    linked_routers,
    open_session,
    over_tls,
    read_links_apart,
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
    "linked_routers",
    "listen",
    "open_session",
    "over_tls",
    "own_config",
    "publisher",
    "read_links_apart",
    "read_reply",
    "require_tls",
    "robots",
    "serve",
    "serve_puts",
    "watched",
]
