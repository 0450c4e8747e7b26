"""Queries and puts between real sessions on loopback."""

from __future__ import annotations

import json
import threading
import time

import msgpack
import pytest
import zenoh

from semmap.nodes import bus
from semmap.nodes.bus import query_server
from semmap.schemas import codec, commands, errors, keys, replies
from tests.bus.conftest import PREFIX, answer
from tests.conftest import PATIENCE_S, until
from tests.waiting import until_followed

MANY = 500
SLOWLY = 3000


def test_selector_parameters_are_fields_and_format_json_replies_in_json(pair):
    server, client = pair
    bus.serve(server, PREFIX, answer(lambda request: request.read(commands.Add)))
    (reply,) = client.get(f"{PREFIX}/add?class=Chair;at=1,2,0;alt=a|b;format=json")
    said = json.loads(reply.ok.payload.to_bytes())
    assert (said["class"], said["at"], said["alt"]) == ("Chair", [1.0, 2.0, 0.0], ["a", "b"])
    assert str(reply.ok.encoding) == "application/json"


def test_messages_are_plain_messagepack(pair):
    server, client = pair
    bus.serve(server, PREFIX, answer(lambda request: request.read(commands.Get)))
    (reply,) = client.get(f"{PREFIX}/get", payload=msgpack.packb({"name": "chair1"}))
    assert msgpack.unpackb(reply.ok.payload.to_bytes()) == {"verb": "get", "name": "chair1"}
    assert str(reply.ok.encoding) == "application/msgpack;semmap.Get.v1"


@pytest.mark.parametrize("payload", [b"\xc1", b"{", b"\x93\x01\x02", b"", b"\xff" * 100, b'{"name": 3}'])
def test_a_malformed_message_is_a_bad_request(pair, payload):
    server, client = pair
    bus.serve(server, PREFIX, answer(lambda request: request.read(commands.Get)))
    (reply,) = client.get(f"{PREFIX}/get", payload=payload)
    assert codec.decode(reply.err.payload.to_bytes(), errors.ErrorMessage).code == "bad-request"


def test_a_put_is_executed_and_acknowledged(pair):
    server, client = pair
    acks = []
    client.declare_subscriber(keys.ACK.key, lambda sample: acks.append(sample.payload.to_bytes()))
    bus.serve_puts(server, PREFIX, answer(lambda request: replies.Done(text=request.verb)))
    until_followed(server, keys.ACK.key)
    until_followed(client, PREFIX)
    client.put(PREFIX, msgpack.packb({"verb": "get", "name": "chair1", "id": "7"}))
    assert until(lambda: acks, "the put is acknowledged")
    ack = msgpack.unpackb(acks[0])
    assert (ack["id"], ack["verb"], ack["ok"], ack["reply"]["text"]) == ("7", "get", True, "get")
    client.put(f"{PREFIX}/add", b'{"class": "Chair"}')
    assert until(lambda: len(acks) == 2, "the put of JSON is acknowledged")
    assert json.loads(acks[1])["verb"] == "add"


class Gate:
    """A publisher that blocks until it is opened, and stores what it published."""

    def __init__(self) -> None:
        self.opened = threading.Event()
        self.passed: list[bytes] = []

    def put(self, content: bytes) -> None:
        """Publish it."""
        assert self.opened.wait(PATIENCE_S)
        self.passed.append(content)


def test_a_server_of_puts_does_not_wait_for_slow_readers_of_acknowledgements(pair, monkeypatch):
    server, client = pair
    requests, gate = [], Gate()
    monkeypatch.setattr(query_server, "publisher", lambda *_: gate)
    bus.serve_puts(server, PREFIX, requests.append)
    until_followed(client, f"{PREFIX}/get")
    for number in range(MANY):
        client.put(f"{PREFIX}/get", codec.encode({"id": str(number)}))
    assert until(lambda: len(requests) == MANY, "all have come")
    assert in_time(lambda: [request.reply(replies.Done(text="x" * 100_000)) for request in requests])
    assert gate.passed == []
    gate.opened.set()
    assert until(lambda: len(gate.passed) == MANY, "all are acknowledged")
    ids = [codec.decode(ack, replies.Ack).id for ack in gate.passed]
    assert ids == [str(number) for number in range(MANY)]


class ClearedTooLate(threading.Event):
    """An event: all waiting acknowledgements are published just before it is cleared."""

    def __init__(self, gate: Gate, expected: int) -> None:
        super().__init__()
        self.set()
        self._gate, self._expected = gate, expected

    def clear(self) -> None:
        """Clear it when the publisher has published all."""
        self._gate.opened.set()
        until(lambda: len(self._gate.passed) == self._expected, "all are published")
        super().clear()


def in_time(function):
    """Return whether it returns; on a thread of its own, so that a test can fail."""
    thread = threading.Thread(target=function, daemon=True)
    thread.start()
    thread.join(PATIENCE_S)
    return not thread.is_alive()


def test_room_made_while_the_queue_was_marked_full_is_found(pair, monkeypatch):
    monkeypatch.setattr(query_server, "_ACKS", 2)
    server, _ = pair
    acks = query_server._Acks(server)
    acks._publisher = gate = Gate()
    acks._has_room = ClearedTooLate(gate, 3)
    acks.put(b"1")
    assert until(acks._waiting.empty, "the first is at the gate")
    acks.put(b"2")
    acks.put(b"3")
    assert in_time(acks.wait_for_room)
    acks.end()


def test_there_is_no_wait_for_room_after_the_end(pair, monkeypatch):
    monkeypatch.setattr(query_server, "_ACKS", 1)
    server, _ = pair
    acks = query_server._Acks(server)
    acks.end()
    for _ in range(20):
        acks.put(b"x")
    assert in_time(acks.wait_for_room)


def test_a_slow_node_answers_each_put_of_a_sender_that_stays(pair):
    """If the sender closed its session immediately, most would be lost: Zenoh waits only half a second."""
    server, client = pair
    acks = []
    client.declare_subscriber(keys.ACK.key, acks.append)
    slow = answer(lambda request: time.sleep(0.001) or replies.Done(text=""))
    bus.serve_puts(server, PREFIX, slow)
    until_followed(server, keys.ACK.key)
    until_followed(client, PREFIX)
    for number in range(SLOWLY):
        client.put(
            f"{PREFIX}/get",
            codec.encode({"id": str(number), "ref": "x" * 1000}),
            congestion_control=zenoh.CongestionControl.BLOCK,
        )
    assert until(lambda: len(acks) == SLOWLY, "each is answered")
