"""The router's Zenoh session: it listens, admits, and restarts when the register has changed.

If it has to connect to routers of other hosts, it is ready once it has met one.

Zenoh's access control cannot be changed while a session is open (1.10.2), so a changed register needs a new
session. All clients reconnect by themselves within a fraction of a second.
"""

from __future__ import annotations

import signal
from collections.abc import Sequence
from datetime import UTC, datetime, timedelta

from msgspec import structs

from semmap.nodes import bus
from semmap.nodes.identity.register import LiveRegister, Register
from semmap.nodes.router.access import access_control
from semmap.nodes.router.config import RouterConfig
from semmap.nodes.router.tcp_timeout import set_user_timeout
from semmap.nodes.runtime.loop import Node
from semmap.schemas import keys
from semmap.schemas.errors import enumerated
from semmap.schemas.wording import counted

_LOOK_S = 0.5
_TELL_S = 60.0
_SILENT_S = 2.5
"""Seconds; longer than a link's lease."""
_SOON = timedelta(days=30)


def describe_certificates(register: Register, now: datetime) -> str:
    """Return in words how many are admitted, and whose certificate expires next, if that is soon."""
    summary = f"{len(register.admitted)} certificates"
    valid = [member for member in register.admitted if member.expires > now]
    first = min(valid, key=lambda member: member.expires, default=None)
    if len(valid) < len(register.admitted):
        summary += f", {len(register.admitted) - len(valid)} of them expired"
    if first is not None and first.expires - now < _SOON:
        summary += f"; that of {first.name} expires on {first.expires:%Y-%m-%d}"
    return summary


def describe_links(met: int, connect: Sequence[str]) -> str:
    """Return in words the links to routers of other hosts; "" if there are none to make."""
    if met:
        return f"linked to {counted(met, 'other router')}"
    return f"waiting for {enumerated(connect)}" if connect else ""


class Router:
    """Routes with the current register until it is stopped."""

    def __init__(self, config: RouterConfig) -> None:
        """Raise BadFile for a folder without keys."""
        self._network = config.network
        self._namespace = config.namespace
        self._live = None if config.keys is None else LiveRegister(config.keys)
        self._node: Node | None = None
        self._stopped = False

    def run(self) -> None:
        """Route until stopped."""
        while not self._stopped:
            self._route(None if self._live is None else self._live.now)

    def stop(self) -> None:
        """End `run`; may be called by a signal handler."""
        self._stopped = True
        if self._node is not None:
            self._node.stop()

    def _route(self, register: Register | None) -> None:
        """Admit the members of `register`, or all clients, until the register changes."""
        network = self._network
        if register is not None:
            access = access_control(register.admitted, self._namespace)
            network = structs.replace(network, access=access)
        with bus.open_session(network) as session:
            node = self._node = Node(keys.ROUTER, session)
            admitted = (
                "admits all clients"
                if register is None
                else describe_certificates(register, datetime.now(UTC))
            )

            def look() -> None:
                if self._stopped or (self._live is not None and self._live.now is not register):
                    node.stop()
                set_user_timeout(_SILENT_S)
                met = bus.linked_routers(session)
                summary = "; ".join(filter(None, (describe_links(met, network.connect), admitted)))
                if met or not network.connect:
                    node.ready(summary)
                else:
                    node.describe(summary)

            def read() -> None:
                nonlocal admitted
                if register is not None:
                    admitted = describe_certificates(register, datetime.now(UTC))

            look()
            node.every(_TELL_S, read)
            node.every(_LOOK_S, look)
            node.run()


def run(config: RouterConfig) -> None:
    """Route until SIGTERM or SIGINT."""
    router = Router(config)
    for number in (signal.SIGTERM, signal.SIGINT):
        signal.signal(number, lambda *_: router.stop())
    router.run()
