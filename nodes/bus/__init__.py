"""The only code that knows Zenoh: open a session, ask, serve, publish, follow."""

from nodes.bus.asking import TIMEOUT_S, Encoded, ask, ask_later, read_reply
from nodes.bus.lifelines import Lifelines, appear, follow_presence
from nodes.bus.pubsub import follow, follow_cameras, listen, publisher, watched
from nodes.bus.serving import Request, serve, serve_puts
from nodes.bus.session import DEFAULT_ENDPOINT, PATIENCE_S, RESTART_S, Network, Session, open_session

__all__ = [
    "DEFAULT_ENDPOINT",
    "PATIENCE_S",
    "RESTART_S",
    "TIMEOUT_S",
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
    "listen",
    "open_session",
    "publisher",
    "read_reply",
    "serve",
    "serve_puts",
    "watched",
]
