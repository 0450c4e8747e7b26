"""Serving queries and puts, between real sessions on loopback."""

from __future__ import annotations

import json
import threading
import time

import msgpack
import pytest

from nodes import bus
from schemas import codec, commands, errors, keys, replies
from tests.bus.conftest import PREFIX, answer
from tests.conftest import until

MANY = 500


def test_parameters_of_a_selector_are_fields_and_format_json_answers_in_json(pair):
    server, client = pair
    bus.serve(server, PREFIX, answer(lambda request: request.read(commands.Add)))
    (reply,) = client.get(f"{PREFIX}/add?class=Chair;at=1,2,0;alt=a|b;format=json")
    said = json.loads(reply.ok.payload.to_bytes())
    assert (said["class"], said["at"], said["alt"]) == ("Chair", [1.0, 2.0, 0.0], ["a", "b"])
    assert str(reply.ok.encoding) == "application/json"


def test_the_wire_is_plain_messagepack(pair):
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
    time.sleep(0.3)
    client.put(PREFIX, msgpack.packb({"verb": "get", "name": "chair1", "id": "7"}))
    assert until(lambda: acks, "the put is acknowledged")
    ack = msgpack.unpackb(acks[0])
    assert (ack["id"], ack["verb"], ack["ok"], ack["reply"]["text"]) == ("7", "get", True, "get")
    client.put(f"{PREFIX}/add", b'{"class": "Chair"}')
    assert until(lambda: len(acks) == 2, "the put of JSON is acknowledged")
    assert json.loads(acks[1])["verb"] == "add"


def test_one_who_answers_puts_does_not_wait_for_those_who_read_the_acknowledgements_slowly(pair):
    server, client = pair
    requests, acks, reading = [], [], threading.Event()
    client.declare_subscriber(keys.ACK.key, lambda ack: reading.wait() and acks.append(ack))
    bus.serve_puts(server, PREFIX, requests.append)
    time.sleep(0.3)
    for number in range(MANY):
        client.put(f"{PREFIX}/get", codec.encode({"id": str(number)}))
    assert until(lambda: len(requests) == MANY, "all have come")
    began_s = time.monotonic()
    for request in requests:
        request.reply(replies.Done(text="x" * 100_000))
    took_s = time.monotonic() - began_s
    reading.set()
    assert until(lambda: len(acks) == MANY, "all are acknowledged")
    ids = [codec.decode(ack.payload.to_bytes(), replies.Ack).id for ack in acks]
    assert ids == [str(number) for number in range(MANY)]
    assert took_s < 1.0  # waiting for the reader would last until Zenoh gives it up, after seconds
