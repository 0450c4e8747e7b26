"""More than a system can do: what was acknowledged stays, and every command is answered."""

from __future__ import annotations

import threading
import time
from collections import Counter

import zenoh

from nodes import bus
from schemas import codec, keys
from schemas.replies import Ack
from tests.faults.ground import Ground, free_place, wait_for
from tests.faults.table import Fault

_PUTS = 5000
_STATUS_S = 5.0
"""What `status` may take on a machine that is busy with all of this."""


def flood_of_puts(ground: Ground) -> None:
    """Two senders put as fast as they can: each put is done or refused, and others are still answered."""
    with ground.client() as client:
        (name,) = client.add("Bowl", at=free_place()).names
        acks: dict[str, str] = {}

        def flood(who: str) -> None:
            with bus.open_session(bus.Network(connect=(ground.endpoint,))) as session:
                for number in range(_PUTS):
                    session.put(
                        f"{keys.CMD}/update",
                        codec.encode({"id": f"{who}{number}", "name": name, "ref": f"{who} {number}"}),
                        congestion_control=zenoh.CongestionControl.BLOCK,
                    )

        def told(_: str, ack: Ack) -> None:
            acks[ack.id] = "done" if ack.error is None else ack.error.code

        senders = [f"{who} {time.time_ns()} " for who in "ab"]
        with bus.open_session(bus.Network(connect=(ground.endpoint,))) as session:
            bus.follow(session, keys.ACK, told)
            ground.observe(1.0)
            threads = [threading.Thread(target=flood, args=(who,)) for who in senders]
            for thread in threads:
                thread.start()
            while any(thread.is_alive() for thread in threads):
                began_s = time.monotonic()
                client.status()
                assert time.monotonic() - began_s < _STATUS_S, "the status is told meanwhile"
            wait_for(lambda: len(acks) == 2 * _PUTS, "each put is answered")
        assert set(Counter(acks.values())) <= {"done", "busy"}


OVERLOADS: tuple[Fault, ...] = (Fault("10 000 puts from two senders", flood_of_puts, often=3, in_short=0),)
