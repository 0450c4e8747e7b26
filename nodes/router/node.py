"""The router on the wire: it listens, admits, and begins anew whenever the register of names has changed.

Zenoh's access control cannot be changed while a session is open (1.10.2), so another register is another
session. Everybody connects again by themselves, within a fraction of a second.
"""

from __future__ import annotations

import signal

from msgspec import structs

from nodes import bus
from nodes.identity.register import LiveRegister, Register
from nodes.router.access import access_control
from nodes.router.config import RouterConfig
from nodes.runtime.loop import Node
from schemas import keys

_LOOK_S = 0.5


class Router:
    """Routes for one register after another, until it is told to stop."""

    def __init__(self, config: RouterConfig) -> None:
        """Raises BadFile for a folder without keys."""
        self._network = config.network
        self._live = LiveRegister(config.keys)
        self._node: Node | None = None
        self._stopped = False

    def run(self) -> None:
        """Route until stopped."""
        while not self._stopped:
            self._route(self._live.now)

    def stop(self) -> None:
        """End `run`; fit for a signal's handler."""
        self._stopped = True
        if self._node is not None:
            self._node.stop()

    def _route(self, register: Register) -> None:
        """Admit those of `register` until there is another one."""
        network = structs.replace(self._network, access=access_control(register.admitted))
        with bus.open_session(network) as session:
            node = self._node = Node(keys.ROUTER, session)

            def look() -> None:
                if self._stopped or self._live.now is not register:
                    node.stop()

            node.ready(f"{len(register.admitted)} certificates")
            node.every(_LOOK_S, look)
            node.run()


def run(config: RouterConfig) -> None:
    """Route until SIGTERM or SIGINT."""
    router = Router(config)
    for number in (signal.SIGTERM, signal.SIGINT):
        signal.signal(number, lambda *_: router.stop())
    router.run()
