"""Overload of a whole system: commands are rejected or executed, and none is lost silently."""

from __future__ import annotations

import asyncio
import threading
import time
from collections import Counter

import pytest
import zenoh

from semmap import aio
from semmap.nodes import bus
from semmap.schemas import codec, keys
from tests.conftest import until

PUTS = 4000
LOOK_S = 0.05
PATIENCE_S = 300.0
"""After so long the test has failed, whatever it still waits for."""


@pytest.fixture(scope="module")
def system(flat_map):
    return flat_map


def test_endless_puts_are_executed_or_rejected_and_the_status_stays_available(system):
    acks: dict[str, str] = {}
    flooding, answered = threading.Event(), threading.Event()

    def flood(who: str) -> None:
        with bus.open_session(bus.Network(connect=(system.endpoint,))) as session:
            flooding.wait(PATIENCE_S)
            for number in range(PUTS):
                command = {"id": f"{who}{number}", "name": "fridge1", "ref": f"{who} {number}"}
                session.put(
                    f"{keys.CMD}/update",
                    codec.encode(command),
                    congestion_control=zenoh.CongestionControl.BLOCK,
                )
            answered.wait(PATIENCE_S)  # what a session has not got rid of when it is closed is lost

    def told(_: str, ack) -> None:
        acks[ack.id] = "done" if ack.ok else ack.error.code

    floods = [threading.Thread(target=flood, args=(who,)) for who in "ab"]
    with bus.open_session(bus.Network(connect=(system.endpoint,))) as session, system.client() as client:
        bus.follow(session, keys.ACK, told)
        bob = {"id": "first", "name": "fridge1", "ref": "fridge"}
        session.put(f"{keys.CMD}/update", codec.encode(bob))
        until(lambda: acks.pop("first", None), "the session follows acknowledgements")
        for thread in floods:
            thread.start()
        before = client.status().commit
        flooding.set()
        answered_meanwhile = 0
        deadline_s = time.monotonic() + PATIENCE_S
        while len(acks) < 2 * PUTS and time.monotonic() < deadline_s:
            client.status()
            answered_meanwhile += 1
            time.sleep(LOOK_S)
        answered.set()
        for thread in floods:
            thread.join()
        assert len(acks) == 2 * PUTS
        ended = Counter(acks.values())
        assert set(ended) == {"done", "busy"}
        assert until(lambda: client.status().commit - before == ended["done"], "all that was done is there")
        assert answered_meanwhile > 2  # one that waits for all others is the last that is answered


def test_second_opinions_on_the_map_hold_up_no_other_question(system):
    """They take seconds each, and waited among what takes milliseconds."""

    async def main():
        async with aio.connect(system.endpoint) as client:
            opinions = [asyncio.ensure_future(client.check("owlrl")) for _ in range(4)]
            await asyncio.sleep(0.5)
            fridge = await client.get("fridge1", as_of=1)
            commits = await client.history(limit=1)
            are_done = [opinion.done() for opinion in opinions]
            for opinion in opinions:
                opinion.cancel()
            return fridge.name, len(commits), any(are_done)

    assert asyncio.run(asyncio.wait_for(main(), PATIENCE_S)) == ("fridge1", 1, False)
