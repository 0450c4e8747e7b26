"""Overload: acknowledged changes are kept, and every command is answered."""

from __future__ import annotations

import contextlib
import threading
import time
from collections import Counter
from concurrent.futures import ThreadPoolExecutor

import zenoh

from semmap.nodes import bus
from semmap.ontology import vocabulary as v
from semmap.schemas import codec, errors, keys
from semmap.schemas.commands import Load
from semmap.schemas.replies import Ack
from tests.faults.ground import Ground, free_place, wait_for
from tests.faults.table import Fault

_PUTS = 5000
_RESTRICTIONS = 3000
"""Too many to be closed within the limit of time."""
_STATUS_S = 5.0
"""Longest time of `status` on an overloaded machine."""


def flood_of_puts(ground: Ground) -> None:
    """Two senders send puts as fast as they can: each is executed or rejected, others are still served.

    The senders' sessions stay open until the last acknowledgement. A Zenoh (1.10.2) session that is closed
    drops what its link has not accepted within half a second, even with congestion control "block".
    """
    with ground.client() as client, contextlib.ExitStack() as stack:
        sessions = [stack.enter_context(_session(ground)) for _ in range(3)]
        (name,) = client.add("Bowl", at=free_place()).names
        acks: dict[str, str] = {}

        def flood(session: bus.Session, who: str) -> None:
            for number in range(_PUTS):
                session.put(
                    f"{keys.CMD}/update",
                    codec.encode({"id": f"{who}{number}", "name": name, "ref": f"{who} {number}"}),
                    congestion_control=zenoh.CongestionControl.BLOCK,
                )

        def on_ack(_: str, ack: Ack) -> None:
            acks[ack.id] = "done" if ack.error is None else ack.error.code

        senders = [f"{who} {time.time_ns()} " for who in "ab"]
        bus.follow(sessions[0], keys.ACK, on_ack)
        ground.observe(1.0)
        threads = [
            threading.Thread(target=flood, args=both) for both in zip(sessions[1:], senders, strict=True)
        ]
        for thread in threads:
            thread.start()
        while any(thread.is_alive() for thread in threads) or not acks:
            began_s = time.monotonic()
            client.status()
            assert time.monotonic() - began_s < _STATUS_S, "status is answered during the flood"
        with contextlib.suppress(AssertionError):
            wait_for(lambda: len(acks) == 2 * _PUTS, "each put is answered")
        unanswered = {who: _gaps(acks, who) for who in senders if _gaps(acks, who)}
        assert not unanswered, f"of the puts of each sender these were not answered: {unanswered}"
        assert set(Counter(acks.values())) <= {"done", "busy"}


def many_axioms(ground: Ground) -> None:
    """A file of restrictions, whose pairs are all compared, is rejected; queries are answered meanwhile."""
    axioms = "".join(
        f"<http://o#A{n}> rdfs:subClassOf [ a owl:Restriction ; owl:onProperty <http://o#p> ;"
        f" owl:someValuesFrom <http://o#A{n + 1}> ] .\n"
        for n in range(_RESTRICTIONS)
    )
    content = f"@prefix owl: <{v.OWL}> . @prefix rdfs: <{v.RDFS}> .\n{axioms}".encode()
    with ground.client() as loading, ground.client() as client, ThreadPoolExecutor(1) as thread:
        loaded = thread.submit(loading.send, Load(content=content, filename="axioms.ttl"))
        began_s = time.monotonic()
        while not loaded.done():
            asked_s = time.monotonic()
            client.sparql("SELECT ?thing { ?thing a dm:Cup } LIMIT 1")
            client.status()
            assert time.monotonic() - asked_s < _STATUS_S, "queries are answered during a load"
            time.sleep(0.1)
        ground.observed_s += time.monotonic() - began_s
        assert isinstance(loaded.exception(), errors.BadFile), loaded


def _gaps(acks: dict[str, str], who: str) -> list[range]:
    """Return the numbers of the puts without acknowledgement."""
    gaps: list[range] = []
    for number in range(_PUTS):
        if f"{who}{number}" in acks:
            continue
        if gaps and gaps[-1].stop == number:
            gaps[-1] = range(gaps[-1].start, number + 1)
        else:
            gaps.append(range(number, number + 1))
    return gaps


def _session(ground: Ground) -> contextlib.AbstractContextManager[bus.Session]:
    return bus.open_session(bus.Network(connect=(ground.endpoint,)))


OVERLOADS: tuple[Fault, ...] = (
    Fault("10 000 puts from two senders", flood_of_puts, often=3, in_short=0),
    Fault("a file of many axioms", many_axioms, often=1),
)
