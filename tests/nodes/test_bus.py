"""Asking, serving, publishing and following, between real sessions on loopback."""

from __future__ import annotations

import json
import queue
import threading
import time

import msgpack
import pytest

from nodes import bus
from schemas import codec, commands, errors, keys, replies
from schemas.commits import Commit
from tests.conftest import free_endpoint

PREFIX = "semmap/test"


@pytest.fixture
def pair():
    """Two peers, one listening and one connected to it."""
    endpoint = free_endpoint()
    with (
        bus.open_session(bus.Network(mode="peer", listen=(endpoint,), connect=())) as server,
        bus.open_session(bus.Network(connect=(endpoint,))) as client,
    ):
        yield server, client


def answer(handle):
    """Serve on the thread of the callback: fit for a test."""

    def receive(request: bus.Request) -> None:
        try:
            request.reply(handle(request))
        except errors.SemmapError as error:
            request.refuse(error)

    return receive


def test_a_question_is_answered(pair):
    server, client = pair
    bus.serve(server, PREFIX, answer(lambda request: replies.Done(text=request.read(commands.Get).name)))
    reply = bus.ask(client, PREFIX, "get", commands.Get(name="chair1"), replies.Done)
    assert reply == replies.Done(text="chair1")


def test_an_error_reply_is_raised_with_its_code(pair):
    server, client = pair

    def refuse(request):
        raise errors.NameTaken("the name 'x' is taken")

    bus.serve(server, PREFIX, answer(refuse))
    with pytest.raises(errors.NameTaken, match="taken"):
        bus.ask(client, PREFIX, "add", commands.Get(name="x"), replies.Done)


def test_nobody_is_no_answer(pair):
    _, client = pair
    with pytest.raises(errors.NoAnswer, match="nobody serves it"):
        bus.ask(client, PREFIX, "get", commands.Get(name="x"), replies.Done, patience_s=0.2)


def test_one_who_does_not_answer_in_time_is_no_answer(pair):
    server, client = pair
    kept = []
    bus.serve(server, PREFIX, kept.append)
    with pytest.raises(errors.NoAnswer, match=r"within 0\.2 s"):
        bus.ask(client, PREFIX, "get", commands.Get(name="x"), replies.Done, timeout_s=0.2)


def test_patience_lasts_until_somebody_serves(pair):
    server, client = pair
    serve = threading.Timer(
        0.4, lambda: bus.serve(server, PREFIX, answer(lambda _: replies.Done(text="here")))
    )
    serve.start()
    assert bus.ask(client, PREFIX, "get", commands.Get(name="x"), replies.Done).text == "here"
    serve.join()


def test_ask_later_answers_once_also_when_nobody_is_there(pair):
    _, client = pair
    answers: queue.SimpleQueue = queue.SimpleQueue()
    bus.ask_later(client, PREFIX, "get", commands.Get(name="x"), replies.Done, answers.put)
    read = answers.get(timeout=5)
    with pytest.raises(errors.NoAnswer, match="nobody serves it"):
        read()
    assert answers.empty()


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
    acks = client.declare_subscriber(keys.ACK.key)
    bus.serve_puts(server, PREFIX, answer(lambda request: replies.Done(text=request.verb)))
    time.sleep(0.3)
    client.put(PREFIX, msgpack.packb({"verb": "get", "name": "chair1", "id": "7"}))
    ack = msgpack.unpackb(acks.recv().payload.to_bytes())
    assert (ack["id"], ack["verb"], ack["ok"], ack["reply"]["text"]) == ("7", "get", True, "get")
    client.put(f"{PREFIX}/add", b'{"class": "Chair"}')
    assert json.loads(acks.recv().payload.to_bytes())["verb"] == "add"


def commit(seq: int) -> Commit:
    return Commit(seq=seq, stamp_ns=seq, id=str(seq), source="operator")


def test_commits_arrive_in_order_and_none_is_lost(pair):
    server, client = pair
    arrived: queue.SimpleQueue = queue.SimpleQueue()
    publisher = bus.publisher(server, keys.COMMIT)
    bus.follow(client, keys.COMMIT, lambda _, message: arrived.put(message.seq))
    time.sleep(0.3)
    for seq in range(1, 501):
        publisher.put(codec.encode(commit(seq)))
    assert [arrived.get(timeout=10) for _ in range(500)] == list(range(1, 501))


def test_what_is_not_ours_is_not_followed(pair):
    server, client = pair
    arrived: queue.SimpleQueue = queue.SimpleQueue()
    bus.follow(client, keys.COMMIT, lambda _, message: arrived.put(message))
    time.sleep(0.3)
    server.put(keys.COMMIT.key, b"\xc1 nonsense")
    server.put(keys.COMMIT.key, codec.encode(commit(1)))
    assert arrived.get(timeout=5).seq == 1


@pytest.mark.parametrize("endpoint", ["nonsense", "tcp/", "udp7/127.0.0.1:1"])
def test_a_malformed_endpoint_is_told(endpoint):
    with (
        pytest.raises((errors.BadRequest, errors.NoAnswer), match=endpoint),
        bus.open_session(bus.Network(connect=(endpoint,))),
    ):
        pass
