"""The router on the wire: it listens, admits, and begins anew whenever the register of names has changed.

Zenoh's access control cannot be changed while a session is open (1.10.2), so another register is another
session. Everybody connects again by themselves, within a fraction of a second.
"""

from __future__ import annotations

import signal

from msgspec import structs

from nodes import bus
from nodes.identity.register import LiveRegister
from nodes.router.access import access_control
from nodes.router.config import RouterConfig
from nodes.runtime.loop import Node
from schemas import keys

_LOOK_S = 0.5


class _Signals:
    """Told to stop? Sessions come and go, so it is not a node's own business."""

    def __init__(self) -> None:
        self.stopped = False
        self.node: Node | None = None
        for number in (signal.SIGTERM, signal.SIGINT):
            signal.signal(number, self._stop)

    def _stop(self, *_: object) -> None:
        self.stopped = True
        if self.node is not None:
            self.node.stop()


def run(config: RouterConfig) -> None:
    """Route until stopped. Raises BadFile for a folder without keys."""
    signals, live = _Signals(), LiveRegister(config.keys)
    while not signals.stopped:
        register = live.now
        network = structs.replace(config.network, access=access_control(register.admitted))
        with bus.open_session(network) as session:
            node = signals.node = Node(keys.ROUTER, session)
            node.ready(f"{len(register.admitted)} certificates")

            def look(node: Node = node, register: object = register) -> None:
                if live.now is not register:
                    node.stop()

            node.every(_LOOK_S, look)
            if not signals.stopped:
                node.run()
            signals.node = None
