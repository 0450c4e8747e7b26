"""A replay repeats the commits of another journal in order and reports its progress."""

from __future__ import annotations

import shutil
from concurrent.futures import Future

import pytest

from semmap.nodes.kb_node.config import Replay
from semmap.nodes.kb_node.replaying import CHANGES, ReplayPlayer, find_missing, rejecting_handlers
from semmap.nodes.kb_node.storage.journal import FILENAME
from semmap.nodes.kb_node.storage.replay.preparation import SOURCE
from semmap.schemas import errors
from semmap.schemas.commits import NewEntity, Transaction
from semmap.schemas.replies import NodeStatus, SystemStatus
from tests.kb_node import home


class Loop:
    """A node's loop with a clock that the test controls."""

    def __init__(self, *replies):
        self.due, self.replies, self.asked, self.reported = [], list(replies), 0, []

    def later(self, delay_s, function):
        self.due.append((delay_s, function))

    def ask_later(self, prefix, call):
        self.asked += 1
        future = Future()
        reply = self.replies.pop(0) if self.replies else errors.NoAnswer("no response")
        (future.set_exception if isinstance(reply, Exception) else future.set_result)(reply)
        return future

    def report(self, problem):
        self.reported.append(problem)

    def go_on(self):
        """Run the next task and return its delay [s]."""
        ((delay_s, function),), self.due = self.due, []
        function()
        return delay_s


NODES = ("kb_node", "sim_node")


def status(*ready: str, in_agreement: bool | None = True, **what: tuple[str, ...]) -> SystemStatus:
    return SystemStatus(
        truth="replayed",
        commit=1,
        entities=1,
        bodies=1,
        in_agreement=in_agreement,
        nodes=tuple(
            NodeStatus(node=node, state="ready", pid=1, uptime_s=1.0, heartbeat_age_s=0.1) for node in ready
        ),
        **what,
    )


@pytest.fixture
def replay(tmp_path):
    """`replay(loop)` replays three commits of another map into one with the same beginning."""
    for folder in ("there", "here"):
        (tmp_path / folder).mkdir()
    there, here = home.new_map(tmp_path / "there"), home.new_map(tmp_path / "here")
    began = there.seq
    for number in range(1, 4):
        there.commit(home.transaction(number, home.chair(f"chair{number}", at=(3.0 * number, 2.0, 0.0))))
    home.close(there)
    shutil.copy(tmp_path / "there" / FILENAME, tmp_path / "here" / SOURCE)
    made = []

    def play(loop, nodes=("kb_node",)):
        publish = []
        player = ReplayPlayer(
            loop, here, tmp_path / "here", Replay(began + 3, 1.0, 5.0, nodes), publish.append
        )
        made.append(player)
        return player, publish, here, began

    yield play
    for player in made:
        player.close()
    home.close(here)


def test_commits_are_repeated_in_order_with_their_progress(replay):
    loop = Loop(status("kb_node"))
    player, publish, here, began = replay(loop)
    assert player.describe() == f"replaying, at commit {began} of {began + 3}"
    loop.go_on()
    for number in range(1, 4):
        loop.go_on()
        assert [commit.seq for commit in publish] == [*range(began + 1, began + number + 1)]
    assert {entity.name for entity in here.entities()} == {"chair1", "chair2", "chair3"}
    assert player.describe() == f"replayed up to commit {began + 3}"
    assert loop.due == []


@pytest.mark.parametrize(
    ("nodes", "first"),
    [
        (("kb_node", "coordinator"), status("kb_node")),
        (
            ("kb_node", "sim_node"),
            status("kb_node", "sim_node", in_agreement=False, pending=("cup1 has no body yet",)),
        ),
        (("kb_node",), errors.NoAnswer("no response")),
    ],
    ids=["a node is missing", "a body is missing", "no reply"],
)
def test_it_begins_when_all_nodes_are_ready_and_the_bodies_are_present(replay, nodes, first):
    loop = Loop(first, status("kb_node", "coordinator", "sim_node"))
    _, publish, _, began = replay(loop, nodes=nodes)
    loop.go_on()
    loop.go_on()
    assert (publish, loop.asked) == ([], 2)
    loop.go_on()
    assert [commit.seq for commit in publish] == [began + 1]


def test_without_a_simulator_bodies_are_not_awaited(replay):
    loop = Loop(status("kb_node", in_agreement=None))
    _, publish, _, _ = replay(loop)
    loop.go_on()
    loop.go_on()
    assert len(publish) == 1


def test_it_begins_after_a_timeout(replay):
    loop = Loop()
    _, publish, _, _ = replay(loop)
    for _ in range(101):
        loop.go_on()
    assert (publish, loop.asked) == ([], 100)
    assert loop.reported == ["the replay starts before all nodes are ready: no response"]
    loop.go_on()
    assert len(publish) == 1


def test_a_replayed_map_cannot_be_changed():
    handlers = rejecting_handlers()
    assert set(handlers) == {call.VERB for call in CHANGES}
    change = Transaction(id="1", source="operator", add=(NewEntity(name="a", class_iri="urn:A"),))
    with pytest.raises(errors.Refused, match="a replay and cannot be changed"):
        handlers[Transaction.VERB][1](change)


def test_it_waits_for_its_nodes_and_then_for_the_bodies():
    assert find_missing(status("kb_node"), NODES) == ("sim_node is not ready",)
    assert find_missing(status(*NODES, in_agreement=None), NODES) == ("the scene is not known yet",)
    pending = ("cup1 has no body yet",)
    assert find_missing(status(*NODES, in_agreement=False, pending=pending), NODES) == pending
    assert find_missing(status(*NODES), NODES) == ()


def test_it_does_not_wait_for_moving_bodies():
    moving = ("robot1 is moving: 1.2 m from its committed pose",)
    assert find_missing(status(*NODES, in_agreement=False, displaced=moving), NODES) == ()


def test_without_a_simulator_no_bodies_are_reported_as_missing():
    assert find_missing(status("kb_node", in_agreement=None), ("kb_node",)) == ()
