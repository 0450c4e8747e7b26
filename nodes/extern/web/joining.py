"""Which system the page shows, and how its process joins it, however often the link is cut."""

from __future__ import annotations

from semmap.nodes import bus
from semmap.nodes.extern.connection import endpoint, open_session
from semmap.nodes.extern.connection import identity as identify
from semmap.nodes.extern.connection import namespace as robot


def network_of(where: str | None, identity: str | None, namespace: str | None) -> bus.Network:
    """How to reach the system that is meant, as `semmap.connect` understands its arguments.

    Raises NoAnswer when nothing answers there now, and what `connect` raises.
    """
    who = identify(identity)
    where = where or endpoint(robot(namespace))
    name = robot(namespace, where)
    with open_session(where, name, who, mode="client"):
        pass
    at = where if who is None else bus.to_tls(where)
    return bus.Network(connect=(at,), mode="client", namespace=name, patience_s=bus.FOREVER_S, identity=who)
