"""Large messages are sent in fragments, and their size is limited."""

from __future__ import annotations

import queue
from concurrent.futures import ThreadPoolExecutor

import pytest
import zenoh

from semmap.nodes import bus
from semmap.nodes.bus import fragmentation
from semmap.schemas import codec, commands, errors, keys, replies
from tests.bus.conftest import PREFIX, answer
from tests.conftest import PATIENCE_S, until
from tests.waiting import until_followed


@pytest.fixture
def small(monkeypatch):
    """Fragments of a kilobyte."""
    monkeypatch.setattr(fragmentation, "FRAGMENT_BYTES", 1000)


def load(size):
    return commands.Load(content=bytes(range(256)) * (size // 256))


def echoed(request):
    return replies.Document(content=request.read(commands.Load).content, media_type="x", triples=0, seq=0)


@pytest.mark.parametrize("size", [256, 1024, 10_240, 102_400])
def test_a_large_request_and_a_large_reply_arrive_complete(pair, small, size):
    server, client = pair
    bus.serve(server, PREFIX, answer(echoed))
    reply = bus.ask(client, PREFIX, "load", load(size), replies.Document)
    assert reply.content == load(size).content


def test_large_messages_arrive_complete_with_ask_later(pair, small):
    server, client = pair
    bus.serve(server, PREFIX, answer(echoed))
    got = queue.SimpleQueue()
    bus.ask_later(client, PREFIX, "load", load(10_240), replies.Document, got.put)
    assert got.get(timeout=PATIENCE_S)().decode().content == load(10_240).content


def test_a_large_error_arrives_in_fragments(pair, small):
    server, client = pair

    def refuse(request):
        raise errors.NameTaken(f"no: {len(request.read(commands.Load).content)}")

    bus.serve(server, PREFIX, answer(refuse))
    with pytest.raises(errors.NameTaken, match="no: 10240"):
        bus.ask(client, PREFIX, "load", load(10_240), replies.Document)


def test_fragments_pass_a_session_with_a_size_limit(pair):
    server, client = pair
    bus.serve(server, PREFIX, answer(echoed))
    large = load(40 << 20)
    assert bus.ask(client, PREFIX, "load", large, replies.Document).content == large.content


def test_a_message_larger_than_a_session_takes_does_not_arrive(pair):
    server, client = pair
    came = queue.SimpleQueue()
    server.declare_subscriber("semmap/large", lambda sample: came.put(len(sample.payload)))
    until_followed(client, "semmap/large")
    client.put(
        "semmap/large",
        bytes(fragmentation.PLANE_BYTES + (1 << 20)),
        congestion_control=zenoh.CongestionControl.BLOCK,
    )
    client.put("semmap/large", bytes(bus.PUBLICATION_BYTES), congestion_control=zenoh.CongestionControl.BLOCK)
    assert came.get(timeout=PATIENCE_S) == bus.PUBLICATION_BYTES


def test_a_large_request_of_a_small_kind_is_rejected(pair):
    server, client = pair
    bus.serve(server, PREFIX, answer(lambda request: request.read(commands.Get)))
    with pytest.raises(
        errors.BadRequest, match=r"the message has 2\.0 MB or more; one of this kind may have up to 1 MB"
    ):
        bus.ask(client, PREFIX, "get", commands.Get(name="x" * (2 << 20)), replies.Document)


def test_a_large_request_of_a_small_kind_is_not_assembled(pair, small):
    server, client = pair
    bus.serve(server, PREFIX, answer(echoed), most=lambda verb: 5000)
    with pytest.raises(errors.BadRequest, match="one of this kind may have up to"):
        bus.ask(client, PREFIX, "load", load(10_240), replies.Document)


def test_concurrent_messages_are_not_mixed(pair, small):
    server, client = pair
    bus.serve(server, PREFIX, answer(echoed))
    with ThreadPoolExecutor(8) as pool:
        sizes = [256 * n for n in range(10, 42)]
        asked = [pool.submit(bus.ask, client, PREFIX, "load", load(n), replies.Document) for n in sizes]
        assert [len(a.result(PATIENCE_S).content) for a in asked] == sizes


def test_json_is_not_cut(pair, small):
    server, client = pair
    bus.serve(server, PREFIX, answer(lambda request: replies.Done(text="x" * 2000)))
    (reply,) = client.get(f"{PREFIX}/get?name=x;format=json")
    assert "the limit for JSON is" in reply.err.payload.to_bytes().decode()


def test_an_invalid_attachment_gets_an_error(pair):
    server, client = pair
    bus.serve(server, PREFIX, answer(echoed))
    (reply,) = client.get(f"{PREFIX}/load", payload=b"x", attachment=b"strange")
    assert codec.decode(reply.err.payload.to_bytes(), errors.ErrorMessage).code == "bad-request"


def piece(number, count=4, of="a"):
    return fragmentation.Fragment(of=of, number=number, count=count)


def test_fragments_are_counted_until_the_request_is_done():
    arrivals = fragmentation.RequestAssembler(most=100)
    for number in range(3):
        assert arrivals.take(piece(number), b"x" * 20, 1000) is None
    assert arrivals.take(piece(3), b"y" * 20, 1000) == b"x" * 60 + b"y" * 20
    with pytest.raises(errors.Busy):
        arrivals.take(piece(0, of="b"), b"x" * 21, 1000)
    arrivals.done(80)
    assert arrivals.take(piece(0, of="b"), b"x" * 21, 1000) is None


@pytest.mark.parametrize("numbers", [[1], [0, 2], [0, 1, 1]])
def test_after_a_missing_fragment_the_message_is_sent_again(numbers):
    arrivals = fragmentation.RequestAssembler()
    *before, last = numbers
    for number in before:
        arrivals.take(piece(number), b"x", 1000)
    with pytest.raises(errors.Busy, match="send the message again"):
        arrivals.take(piece(last), b"x", 1000)


def test_an_incomplete_message_is_dropped_after_a_time_out(monkeypatch):
    arrivals = fragmentation.RequestAssembler(most=100)
    arrivals.take(piece(0), b"x" * 80, 1000)
    with pytest.raises(errors.Busy):
        arrivals.take(piece(0, of="b"), b"x" * 80, 1000)
    monkeypatch.setattr(fragmentation, "_FRAGMENT_TIMEOUT_S", -1.0)
    assert arrivals.take(piece(0, of="b"), b"x" * 80, 1000) is None


def test_the_number_of_messages_in_assembly_is_limited():
    arrivals = fragmentation.RequestAssembler()
    for number in range(16):
        arrivals.take(piece(0, of=str(number)), b"x", 1000)
    with pytest.raises(errors.Busy):
        arrivals.take(piece(0, of="one more"), b"x", 1000)


def test_a_large_unfragmented_request_is_rejected(pair):
    server, client = pair
    bus.serve(server, PREFIX, answer(echoed))
    (reply,) = client.get(f"{PREFIX}/load", payload=bytes(bus.MESSAGE_BYTES + 1))
    error = codec.decode(reply.err.payload.to_bytes(), errors.ErrorMessage)
    assert (error.code, error.text[-16:]) == ("bad-request", "have up to 16 MB")


def test_a_publication_that_is_too_large_is_counted(pair):
    server, client = pair
    heard, ignored = [], []
    bus.follow(server, keys.HEALTH, lambda _, beat: heard.append(beat), lambda: ignored.append(1))
    until_followed(client, keys.health_key("x"))
    client.put(
        keys.health_key("x"), bytes(bus.MESSAGE_BYTES + 1), congestion_control=zenoh.CongestionControl.BLOCK
    )
    until(lambda: ignored, "it is ignored")
    assert heard == []
