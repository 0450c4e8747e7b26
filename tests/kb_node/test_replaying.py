"""A replay makes the commits of another journal again, one after the other, and says how far it is."""

from __future__ import annotations

import shutil
from concurrent.futures import Future
from types import SimpleNamespace

import pytest

from nodes.kb_node.config import Replay
from nodes.kb_node.replaying import CHANGES, Player, refusing
from nodes.kb_node.storage.journal import FILENAME
from nodes.kb_node.storage.replay.preparing import SOURCE
from schemas import errors
from schemas.commits import NewEntity, Transaction
from tests.kb_node import home


class Loop:
    """A node's loop whose time the test lets pass."""

    def __init__(self, *replies):
        self.due, self.replies, self.asked = [], list(replies), 0

    def later(self, delay_s, function):
        self.due.append((delay_s, function))

    def ask_later(self, prefix, call):
        self.asked += 1
        future = Future()
        reply = self.replies.pop(0) if self.replies else errors.NoAnswer("nobody")
        (future.set_exception if isinstance(reply, Exception) else future.set_result)(reply)
        return future

    def go_on(self):
        """What is due next, and how long it had to wait [s]."""
        ((delay_s, function),), self.due = self.due, []
        function()
        return delay_s


def status(*ready, in_agreement=True):
    nodes = [SimpleNamespace(node=name, state="ready") for name in ready]
    starting = SimpleNamespace(node="recorder", state="starting")
    return SimpleNamespace(nodes=[*nodes, starting], in_agreement=in_agreement)


@pytest.fixture
def replay(tmp_path):
    """`replay(loop)` plays three commits of another map into one that was begun like that."""
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
        spread = []
        player = Player(loop, here, tmp_path / "here", Replay(began + 3, 1.0, 5.0, nodes), spread.append)
        made.append(player)
        return player, spread, here, began

    yield play
    for player in made:
        player.close()
    home.close(here)


def test_the_commits_are_made_again_in_their_order_and_it_says_how_far_it_is(replay):
    loop = Loop(status("kb_node"))
    player, spread, here, began = replay(loop)
    assert player.describe() == f"replaying, at commit {began} of {began + 3}"
    loop.go_on()
    for number in range(1, 4):
        loop.go_on()
        assert [commit.seq for commit in spread] == [*range(began + 1, began + number + 1)]
    assert {entity.name for entity in here.entities()} == {"chair1", "chair2", "chair3"}
    assert player.describe() == f"replayed up to commit {began + 3}"
    assert loop.due == []


@pytest.mark.parametrize(
    ("nodes", "first"),
    [
        (("kb_node", "coordinator"), status("kb_node")),
        (("kb_node", "sim_node"), status("kb_node", "sim_node", in_agreement=False)),
        (("kb_node",), errors.NoAnswer("nobody")),
    ],
    ids=["a node is missing", "bodies move", "no reply"],
)
def test_it_begins_when_all_nodes_are_ready_and_the_bodies_stand(replay, nodes, first):
    loop = Loop(first, status("kb_node", "coordinator", "sim_node"))
    _, spread, _, began = replay(loop, nodes=nodes)
    loop.go_on()
    loop.go_on()
    assert (spread, loop.asked) == ([], 2)
    loop.go_on()
    assert [commit.seq for commit in spread] == [began + 1]


def test_without_a_simulator_nobody_waits_for_bodies(replay):
    loop = Loop(status("kb_node", in_agreement=None))
    _, spread, _, _ = replay(loop)
    loop.go_on()
    loop.go_on()
    assert len(spread) == 1


def test_after_a_while_it_begins_without_the_others(replay):
    loop = Loop()
    _, spread, _, _ = replay(loop)
    for _ in range(101):
        loop.go_on()
    assert (spread, loop.asked) == ([], 100)
    loop.go_on()
    assert len(spread) == 1


def test_such_a_map_is_not_changed_by_anybody():
    handlers = refusing()
    assert set(handlers) == {call.VERB for call in CHANGES}
    change = Transaction(id="1", source="operator", add=(NewEntity(name="a", class_iri="urn:A"),))
    with pytest.raises(errors.Refused, match="a replay of the past, and cannot be changed"):
        handlers[Transaction.VERB][1](change)
