"""A node keeps running whatever its handlers do."""

from __future__ import annotations

import json
import queue
import threading
from concurrent.futures import Future
from itertools import count

import pytest
import zenoh

from semmap.nodes import bus
from semmap.nodes.bus import query_client
from semmap.nodes.runtime import heartbeat, loop
from semmap.nodes.runtime.fair_queue import FairQueue
from semmap.nodes.runtime.loop import Node
from semmap.schemas import codec, commands, errors, keys, replies
from semmap.schemas.calls import Call, Handler, Relay
from semmap.schemas.health import Health
from semmap.schemas.scenes import Poses
from tests.conftest import PATIENCE_S, free_endpoint, handling, until
from tests.waiting import publications_kept, questions_asked, until_followed, until_served

PREFIX = "semmap/test"


class Get(Call[replies.Done]):
    VERB = "get"
    name: str


class Quick(Get):
    """A quick variant, which may be repeated."""

    is_quick = True


class Fly(Get):
    VERB = "fly"


def fail(_):
    raise ZeroDivisionError("oops")


def relay(m):
    """Forwards to the given verb, of this node or of none."""
    return Relay(m.predicate, {"get": Get, "fly": Fly}[m.value](name=m.name), 1.0)


@pytest.fixture
def network():
    endpoint = free_endpoint()
    peer = bus.Network(mode="peer", listen=(endpoint,), connect=())
    with bus.open_session(peer) as session, bus.open_session(bus.Network(connect=(endpoint,))) as client:
        node = Node("test_node", session)
        promise: Future = Future()
        handlers = {
            "get": (commands.Get, lambda m: replies.Done(text=m.name)),
            "check": (commands.Check, fail),
            "infer": (commands.Infer, lambda _: promise),
            "explain": (commands.Explain, relay),
        }
        node.serve(PREFIX, handlers)
        node.every(
            0.05, lambda: promise.set_result(replies.Done(text="late")) if not promise.done() else None
        )
        with handling(node):
            yield node, client


def test_an_error_is_the_reply_and_the_node_keeps_running(network):
    _, client = network
    with pytest.raises(errors.InternalError, match="ZeroDivisionError: oops"):
        bus.ask(client, PREFIX, "check", commands.Check(), replies.Done)
    assert bus.ask(client, PREFIX, "get", commands.Get(name="x"), replies.Done).text == "x"


def test_an_unknown_command_is_reported_with_the_available_ones(network):
    _, client = network
    with pytest.raises(errors.UnknownVerb, match="available: check, explain, get, infer"):
        bus.ask(client, PREFIX, "fly", commands.Get(name="x"), replies.Done)


def test_a_verb_is_left_to_the_node_that_serves_it():
    """Two nodes on one prefix: `get` belongs to the first unless it is away, the rest to the other."""
    endpoint = free_endpoint()
    first = bus.Network(mode="peer", listen=("tcp/127.0.0.1:0",), connect=(endpoint,))
    other = bus.Network(mode="peer", listen=(endpoint,), connect=())
    away = threading.Event()

    def done(text):
        return Handler(commands.Get, lambda _: replies.Done(text=text))

    def get(client, verb, **how):
        return bus.ask(client, PREFIX, verb, commands.Get(name="x"), replies.Done, **how).text

    with bus.open_session(other) as there, bus.open_session(first) as here:
        nodes = Node("first", here), Node("other", there)
        nodes[0].serve_one(PREFIX, done("first"))
        handlers = {"get": done("other"), "list": done("other")}
        nodes[1].serve(PREFIX, handlers, leave=lambda verb: verb == "get" and not away.is_set())
        threads = [threading.Thread(target=node.run) for node in nodes]
        for thread in threads:
            thread.start()
        try:
            with bus.open_session(bus.Network(connect=(endpoint,))) as client:
                assert [get(client, "get") for _ in range(20)] == ["first"] * 20
                assert [get(client, "get", prefer_complete=True) for _ in range(20)] == ["first"] * 20
                assert get(client, "list", prefer_complete=True) == "other"
                assert get(client, "list") == "other"
                with pytest.raises(errors.UnknownVerb, match="available: get, list"):
                    bus.ask(client, PREFIX, "*", commands.Get(name="x"), replies.Done)
                away.set()
                nodes[0].stop()
                threads[0].join(timeout=PATIENCE_S)
                firsts = client.declare_querier(f"{PREFIX}/get", target=zenoh.QueryTarget.ALL_COMPLETE)
                until(lambda: firsts.matching_status.matching, "the client knows the first")
                here.close()
                until(lambda: not firsts.matching_status.matching, "the client knows that the first is gone")
                assert get(client, "get") == "other"
                assert get(client, "get", prefer_complete=True) == "other"
        finally:
            for node, thread in zip(nodes, threads, strict=True):
                node.stop()
                thread.join(timeout=PATIENCE_S)


def test_a_reply_may_come_later(network):
    _, client = network
    assert bus.ask(client, PREFIX, "infer", commands.Infer(), replies.Done).text == "late"


def test_a_fault_is_in_the_heartbeat(network):
    _, client = network
    beats: list[Health] = []
    bus.follow(client, keys.HEALTH, lambda _, health: beats.append(health))
    with pytest.raises(errors.InternalError):
        bus.ask(client, PREFIX, "check", commands.Check(), replies.Done)
    until(lambda: beats and "check: ZeroDivisionError: oops" in beats[-1].last_error, "the error")


def test_a_blocked_loop_publishes_no_heartbeat(network, monkeypatch):
    monkeypatch.setattr(heartbeat, "_PERIOD_S", 0.05)
    node, client = network
    beats: list[str] = []
    bus.follow(client, keys.HEALTH, lambda _, health: beats.append(health.node))
    is_blocked, release = threading.Event(), threading.Event()
    node.soon(lambda: node.note(()))  # so that the next beat is due
    other = Node("other_node", node.session)
    with handling(other):
        until(lambda: {"test_node", "other_node"} <= set(beats), "both beat")
        node.soon(lambda: is_blocked.set() or release.wait(PATIENCE_S))
        try:
            assert is_blocked.wait(PATIENCE_S)
            until_one_more(beats, "other_node")  # earlier messages of the node have arrived by then
            silent_from = len(beats)
            for _ in range(10):
                until_one_more(beats, "other_node")
            assert "test_node" not in beats[silent_from:]
        finally:
            release.set()
        until_one_more(beats, "test_node")


def until_one_more(beats, name):
    before = beats.count(name)
    until(lambda: beats.count(name) > before, f"another beat of {name}")


def test_a_busy_node_gets_the_newest_publication(network, monkeypatch):
    node, client = network
    seen, release = [], threading.Event()
    come = publications_kept(monkeypatch)
    node.follow_newest(keys.POSES, lambda poses: (seen.append(poses.version), release.wait(PATIENCE_S)))
    publisher = bus.publisher(client, keys.POSES)

    def publish(version):
        poses = Poses(
            run="r", version=version, stamp_ns=1, sim_time_s=0.0, names=(), poses=(), resting=(), commits=()
        )
        publisher.put(codec.encode(poses))

    until(lambda: publish(0) or seen, "it follows")
    versions = count(1)

    def many_have_come():
        for _ in range(20):  # of which Zenoh may drop any
            publish(next(versions))
        return come[-1].version >= 20

    until(many_have_come, "many have come")
    newest = come[-1].version
    release.set()
    until(lambda: seen[-1] >= newest, "it has seen the newest")
    assert [version for version in seen[1:] if version < newest] == []


def test_deferred_work_is_done_when_no_event_waits(network):
    node, client = network
    done: list[int] = []
    put_off: list[Future] = []

    def finish():
        done.append(len(put_off))
        while put_off:
            put_off.pop().set_result(replies.Done(text="done"))

    def later(_):
        put_off.append(Future())
        return put_off[-1]

    node.when_idle(finish)
    node.serve("semmap/later", {"get": (commands.Get, later)})
    assert bus.ask(client, "semmap/later", "get", commands.Get(name="x"), replies.Done).text == "done"
    assert 1 in done


def test_the_period_of_repeated_work_can_be_changed_at_any_time(network):
    node, _ = network
    done: list[int] = []

    def begin():
        change = node.every(3600.0, lambda: work(change))  # due now, and then after an hour
        node.later(0.0, lambda: change(0.001))

    def work(change):
        done.append(len(done))
        if len(done) == 5:
            change(3600.0)
            node.later(0.02, lambda: done.append(-1))

    node.soon(begin)
    until(lambda: done[-1:] == [-1], "a period of an hour holds no longer, and then again")
    assert done == [0, 1, 2, 3, 4, -1]


def test_work_after_a_reply_does_not_delay_it_and_precedes_the_next_event(network):
    node, client = network
    order: list[str] = []
    answered = threading.Event()

    def await_the_answer():
        assert answered.wait(PATIENCE_S)
        order.append("the first thing")

    def answer(_):
        node.afterwards(await_the_answer)
        node.afterwards(lambda: fail(None))
        node.afterwards(lambda: order.append("the last thing"))
        node.soon(lambda: order.append("the next event"))
        return replies.Done(text="done")

    node.serve("semmap/first", {"get": (commands.Get, answer)})
    assert bus.ask(client, "semmap/first", "get", commands.Get(name="x"), replies.Done).text == "done"
    answered.set()
    until(lambda: order == ["the first thing", "the last thing", "the next event"], "in that order")


def asking_for(prefix, verb, name="x"):
    return commands.Explain(name=name, predicate=prefix, value=verb)


@pytest.mark.parametrize("length", [1, 1000])
def test_a_relayed_reply_is_forwarded_unchanged(network, length):
    _, client = network
    question = asking_for(PREFIX, "get", "x" * length)
    assert bus.ask(client, PREFIX, "explain", question, replies.Done).text == "x" * length


def test_a_relayed_reply_in_json(network):
    _, client = network
    (reply,) = client.get(f"{PREFIX}/explain?name=x;predicate={PREFIX};value=get;format=json")
    assert json.loads(reply.ok.payload.to_bytes()) == {"text": "x"}


@pytest.mark.parametrize(
    ("prefix", "verb", "error", "said"),
    [
        (PREFIX, "fly", errors.UnknownVerb, "unknown command 'fly'"),
        ("semmap/unserved", "get", errors.NoAnswer, "no response on semmap/unserved/get: no node serves it"),
    ],
)
def test_a_relayed_error_is_forwarded(network, monkeypatch, prefix, verb, error, said):
    monkeypatch.setattr(bus, "RESTART_S", 0.5)
    _, client = network
    with pytest.raises(error, match=said):
        bus.ask(client, PREFIX, "explain", asking_for(prefix, verb), replies.Done)


def test_a_relayed_request_waits_for_its_server(network, monkeypatch):
    _, client = network
    late = "semmap/late"
    asked = questions_asked(monkeypatch)

    def serve():
        until(lambda: asked.count(f"{late}/get") > 2, "it was queried without reply")
        bus.serve(client, late, lambda request: request.reply(replies.Done(text="here")))

    thread = threading.Thread(target=serve)
    thread.start()
    assert bus.ask(client, PREFIX, "explain", asking_for(late, "get"), replies.Done).text == "here"
    thread.join()


def test_ask_later_waits_for_a_late_server(network, monkeypatch):
    node, client = network
    asked = questions_asked(monkeypatch)
    served: list[Future] = []
    node.soon(lambda: served.append(node.ask_later("semmap/late", Get(name="x"), patience_s=PATIENCE_S)))
    until(lambda: asked.count("semmap/late/get") > 2, "it was queried without reply")
    assert not served[0].done()
    bus.serve(client, "semmap/late", lambda request: request.reply(replies.Done(text="here")))
    assert served[0].result(PATIENCE_S).text == "here"


def test_a_lost_quick_query_is_repeated(network, monkeypatch):
    node, client = network
    monkeypatch.setattr("semmap.nodes.bus.query_client._ROUND_S", 0.3)
    asked, answers = [], []

    def receive(request):
        asked.append(request)
        if len(asked) == 2:
            request.reply(replies.Done(text="here"))

    bus.serve(client, "semmap/late", receive)
    node.soon(lambda: answers.append(node.ask_later("semmap/late", Quick(name="x"), patience_s=PATIENCE_S)))
    until(lambda: answers, "the question")
    assert answers[0].result(PATIENCE_S).text == "here"


def overloaded(node, client, monkeypatch, *, each=3):
    """The node's thread is held by a question; a function sends others, and another fills the queue.

    What is answered is in the list, in the order in which the node came to it.
    """
    done = []
    in_hand, release = threading.Event(), threading.Event()
    monkeypatch.setattr(node, "_requests", FairQueue(each=each))

    def hold(m):
        in_hand.set()
        assert release.wait(PATIENCE_S)
        done.append(m.name)
        return replies.Done(text=m.name)

    def tell(_):
        done.append("urgent")
        return replies.Done(text="ready")

    handlers = {
        "get": (commands.Get, hold),
        "status": (commands.Status, tell),
    }
    node.serve("semmap/held", handlers, urgent={"status"})
    got: queue.SimpleQueue = queue.SimpleQueue()

    def send(verb="get", name="x", session=client):
        message = commands.Status() if verb == "status" else commands.Get(name=name)
        bus.ask_later(session, "semmap/held", verb, message, replies.Done, lambda read: got.put((name, read)))

    def fill(names):
        """Let one request wait among the events, and then one in the queue for each name."""
        send()
        until(lambda: node._is_immediate, "it waits among the events")
        for number, name in enumerate(names, start=1):
            send(name=name)
            until(lambda number=number: len(node._requests) == number, "it waits")

    until_served(client, "semmap/held/get")
    send()
    assert in_hand.wait(PATIENCE_S)
    return send, fill, release, got, done


def test_requests_beyond_the_full_queue_are_rejected_and_the_rest_is_done(network, monkeypatch):
    node, client = network
    send, fill, release, got, _ = overloaded(node, client, monkeypatch)
    fill("xxx")
    send(name="too late")
    name, read = got.get(timeout=PATIENCE_S)
    assert name == "too late"
    with pytest.raises(
        errors.Busy, match=r"^test_node is busy: 3 requests are waiting; try again in "
    ) as busy:
        read()
    assert busy.value.again_s > 0.0
    release.set()
    for _ in range(5):  # plus the current one and the one among the events
        assert got.get(timeout=PATIENCE_S)[1]().decode().text == "x"


def test_urgent_requests_come_first_and_other_clients_do_not_wait(network, monkeypatch):
    node, client = network
    send, fill, release, _, order = overloaded(node, client, monkeypatch, each=100)
    with bus.open_session(bus.Network(connect=(f"{client.info.links()[0].dst}",))) as other:
        fill([f"first {number}" for number in range(10)])
        until_served(other, "semmap/held/get")
        send(name="other", session=other)
        until(lambda: len(node._requests._by_asker) == 2, "it waits")
        send("status", name="urgent")
        until(lambda: node._requests._urgent, "it waits, too")
        release.set()
        until(lambda: {"first 9", "other", "urgent"} <= set(order), "all are answered")
    assert order.index("urgent") < order.index("first 3")
    assert order.index("other") < order.index("first 5")


def test_a_busy_reply_is_retried_automatically(network, monkeypatch):
    node, client = network
    _, fill, release, _, _ = overloaded(node, client, monkeypatch)
    fill("xxx")
    pause_s = query_client.BusyBackoff.pause_s
    # there is room at the retry
    monkeypatch.setattr(query_client.BusyBackoff, "pause_s", lambda *told: release.set() or pause_s(*told))
    question = commands.Get(name="patient")
    assert bus.ask(client, "semmap/held", "get", question, replies.Done).text == "patient"
    assert release.is_set()


def test_retries_end_after_a_while(network, monkeypatch):
    node, client = network
    _, fill, release, _, _ = overloaded(node, client, monkeypatch)
    fill("xxx")
    monkeypatch.setattr(query_client, "BUSY_S", 0.3)
    with pytest.raises(errors.Busy):
        bus.ask(client, "semmap/held", "get", commands.Get(name="x"), replies.Done)
    release.set()


def test_without_room_requests_wait_and_urgent_ones_and_events_do_not(network):
    node, client = network
    room = threading.Event()
    node.while_there_is_room(room.is_set)
    handlers = {verb: (commands.Get, lambda m: replies.Done(text=m.name)) for verb in ("get", "status")}
    node.serve("semmap/roomy", handlers, urgent={"status"})
    got: queue.SimpleQueue = queue.SimpleQueue()
    ask = (client, "semmap/roomy", "get", commands.Get(name="x"), replies.Done)
    until(lambda: bus.ask_later(*ask, got.put) or len(node._requests), "it waits")
    answer = bus.ask(client, "semmap/roomy", "status", commands.Get(name="at once"), replies.Done)
    assert answer.text == "at once"
    assert got.empty()
    room.set()
    node.soon(lambda: None)
    assert got.get(timeout=PATIENCE_S)().decode().text == "x"


def test_the_newest_publications_are_kept(network, monkeypatch):
    node, client = network
    monkeypatch.setattr(loop, "_MAX_WAITING", 5)
    seen, release = [], threading.Event()
    come = publications_kept(monkeypatch)
    topic = keys.Topic("semmap/test/beats", Health, "lossless")
    node.follow(topic, lambda beat: (seen.append(beat.pid), release.wait(PATIENCE_S)))
    publisher = bus.publisher(client, topic)

    def publish(pid):
        publisher.put(codec.encode(Health(node="x", pid=pid, started_ns=1, stamp_ns=1, state="ready")))

    until_followed(client, topic.key)
    publish(0)
    until(lambda: seen, "the first is in hand")
    for pid in range(1, 21):
        publish(pid)
    until(lambda: come[-1].pid == 20, "all have come")
    release.set()
    until(lambda: seen[-1] == 20, "it has seen the last")
    assert seen == [0, 16, 17, 18, 19, 20]


def test_a_heartbeat_under_another_key_is_ignored(network):
    node, client = network
    heard: list[Health] = []
    node.follow(keys.HEALTH, heard.append)
    beats = [bus.publisher(client, keys.HEALTH, keys.health_key(name)) for name in ("web", "kb_node")]

    def beat():
        for pid, publisher in enumerate(beats):
            said = Health(node="kb_node", pid=pid, started_ns=1, stamp_ns=1, state="ready")
            publisher.put(codec.encode(said))
        return {health.pid for health in heard if health.node == "kb_node"}

    assert until(beat, "a heartbeat under its own key") == {1}  # never that under the page's key
