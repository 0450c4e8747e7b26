"""A follower of a simulated knowledge base, over real Zenoh."""

import time

import msgspec
import pytest

from semmap.nodes import bus
from semmap.nodes.runtime.loop import Node
from semmap.nodes.runtime.map_follower import Follower
from semmap.nodes.runtime.map_replica import MapReplica
from semmap.schemas import codec, keys
from semmap.schemas.bridge import SnapshotQuery
from semmap.schemas.commands import Classes
from semmap.schemas.commits import Commit, Extent, Snapshot
from semmap.schemas.health import Health
from tests.conftest import free_endpoint, handling, until
from tests.recorder.messages import commit, entity
from tests.waiting import until_followed


class KnowledgeBase:
    """Serves the given snapshot, and records the requests."""

    def __init__(self, session):
        self.node = Node("played", session)  # its own heartbeats would come between the simulated ones
        self.snapshot = Snapshot(seq=1, entities=(entity("cup1"),))
        self.asked = 0
        self._commits = bus.publisher(session, keys.COMMIT)
        self._health = bus.publisher(session, keys.HEALTH, keys.health_key("kb_node"))
        self.node.serve(
            keys.BRIDGE, {"snapshot": (SnapshotQuery, self._snapshot), "classes": (Classes, lambda _: ())}
        )

    def _snapshot(self, query):
        self.asked += 1
        return self.snapshot

    def publish(self, *commits):
        for made in commits:
            self._commits.put(codec.encode(made))

    def beat(self, started_ns, commit=None, digest="", shapes_ns=0):
        health = Health(
            node="kb_node",
            pid=1,
            started_ns=started_ns,
            stamp_ns=1,
            state="ready",
            commit=commit,
            digest=digest,
            shapes_ns=shapes_ns,
        )
        self._health.put(codec.encode(health))


class Following:
    """A node with a follower, and its callbacks."""

    def __init__(self, session):
        self.node = Node("recorder", session)
        self.map = MapReplica[Commit]()
        self.heard, self.begun = [], []
        Follower(
            self.node,
            self.map,
            keys.COMMIT,
            on_commit=lambda commit, known: self.heard.append((commit.seq, known)),
            on_snapshot=self.begun.append,
        )

    @property
    def snapshots(self):
        return [(begun.before, begun.seq) for begun in self.begun]


@pytest.fixture
def both():
    endpoint = free_endpoint()
    here = bus.Network(mode="peer", connect=(), listen=(endpoint,))
    there = bus.Network(mode="peer", connect=(endpoint,), listen=("tcp/127.0.0.1:0",))
    with bus.open_session(here) as session, bus.open_session(there) as other:
        kb, follower = KnowledgeBase(session), Following(other)
        with handling(kb.node), handling(follower.node):
            until(lambda: follower.map.is_current, "the map is known")
            yield kb, follower


def test_commits_follow_a_snapshot(both):
    kb, follower = both
    kb.publish(commit(2, entity("cup2")), commit(3, removed=("cup1",)))
    until(lambda: follower.map.seq == 3, "both were taken")
    assert set(follower.map.entities) == {"cup2"}
    assert (follower.snapshots, follower.heard) == ([(-1, 1)], [(2, True), (3, True)])
    assert kb.asked == 1


def test_missed_commits_are_fetched(both):
    kb, follower = both
    kb.snapshot = Snapshot(seq=4, entities=(entity("cup4"),))
    kb.publish(commit(4, entity("cup4")))
    until(lambda: follower.map.seq == 4, "a snapshot came")
    assert follower.map.is_current
    assert (follower.snapshots[-1], follower.heard) == ((1, 4), [(4, False)])


def test_a_snapshot_without_an_announced_commit_is_fetched_again(both):
    kb, follower = both
    kb.publish(commit(3, entity("cup3")))
    until(lambda: kb.asked > 2, "it asks again")
    kb.snapshot = Snapshot(seq=3, entities=(entity("cup3"),))
    kb.beat(7)
    until(lambda: (kb.beat(7, 3), follower.map.seq == 3)[1], "the snapshot with it came")
    assert follower.map.is_current


def test_a_knowledge_base_with_fewer_commits_is_followed(both):
    kb, follower = both
    kb.beat(1)
    kb.publish(commit(2, entity("cup2")))
    until(lambda: follower.map.seq == 2, "it was taken")
    kb.beat(1)
    kb.snapshot = Snapshot(seq=1, entities=(entity("sink1"),))
    kb.beat(2)
    until(lambda: follower.map.seq == 1, "the other map is in force")
    assert set(follower.map.entities) == {"sink1"}
    assert follower.snapshots == [(-1, 1), (2, 1)]


def test_another_tbox_means_other_classes(both):
    kb, follower = both
    kb.snapshot = Snapshot(seq=2, entities=(entity("cup1"),))
    kb.publish(commit(2, tbox=True))
    until(lambda: len(follower.begun) == 2, "classes and snapshot were fetched")
    assert follower.snapshots[-1] == (2, 2)


def test_a_forged_commit_is_detected_by_the_next_heartbeat(both):
    kb, follower = both
    kb.snapshot = Snapshot(seq=1, entities=(entity("cup1"),), digest="one")
    kb.beat(7, 1, "one")
    kb.publish(msgspec.structs.replace(commit(2, removed=("cup1",)), digest="forged"))
    until(lambda: follower.map.seq == 2, "it is believed at first")
    until(lambda: (kb.beat(7, 1, "one"), follower.map.seq == 1)[1], "it is believed no longer")
    assert set(follower.map.entities) == {"cup1"}


def test_a_forged_commit_with_the_next_number_hides_none(both):
    kb, follower = both
    kb.snapshot = Snapshot(seq=2, entities=(entity("cup1"), entity("cup2")), digest="two")
    kb.beat(7, 1, "one")
    kb.publish(
        msgspec.structs.replace(commit(2, removed=("cup1",)), digest="forged"),
        msgspec.structs.replace(commit(2, entity("cup2")), digest="two"),
    )
    until(lambda: set(follower.map.entities) == {"cup1", "cup2"}, "what is true is known")
    assert follower.map.is_confirmed


def test_a_missing_commit_is_noticed_by_the_second_heartbeat(both):
    kb, follower = both
    kb.beat(0, commit=1)
    kb.snapshot = Snapshot(seq=2, entities=(entity("cup2"),))
    kb.beat(0, commit=2)
    kb.publish(commit(1))  # arrives after the heartbeat: it may arrive until the next one
    until(lambda: follower.heard == [(1, True)], "the first beat was heard")
    assert kb.asked == 1
    kb.beat(0, commit=2)
    until(lambda: follower.map.seq == 2, "it was fetched")
    assert kb.asked == 2


def test_a_follower_does_not_fetch_pages_twice(both):
    kb, follower = both
    follower.map.begin_pages()
    left_out = Extent(inserted=9, retracted=0, changed=3, removed=0)
    follower.map.take(msgspec.structs.replace(commit(2), abridged=left_out))
    asked = kb.asked
    beats = []
    follower.node.follow(keys.HEALTH, lambda health: beats.append(health.commit))
    until_followed(kb.node.session, keys.health_key("kb_node"))
    for number in range(1, 5):
        kb.beat(0, commit=2)
        until(lambda number=number: beats.count(2) == number, "the beat is heard")
    assert kb.asked == asked
    kb.snapshot = Snapshot(seq=2, entities=(entity("sink1"),))
    follower.map.cancel_pages()
    until(lambda: follower.map.is_current, "a snapshot came")
    assert set(follower.map.entities) == {"sink1"}


def test_relations_that_change_without_a_commit_are_fetched_once(both):
    kb, follower = both
    kb.beat(7, 1)
    retyped = msgspec.structs.replace(entity("cup1"), types=("Chair", "Supported_Thing"))
    kb.snapshot = Snapshot(seq=1, entities=(retyped,))
    now = time.time_ns()
    kb.beat(7, 1, shapes_ns=now)
    kb.beat(7, 1, shapes_ns=now)
    until(lambda: len(follower.begun) == 2, "the map was fetched again")
    assert follower.snapshots == [(-1, 1), (1, 1)]
    assert follower.map.entities["cup1"].types == retyped.types
    kb.publish(commit(2))
    until(lambda: follower.map.seq == 2, "later messages were taken")
    assert kb.asked == 2


def test_changed_relations_are_fetched_again_if_a_commit_is_newer_than_the_snapshot(both):
    kb, follower = both
    kb.beat(7, 1)
    kb.publish(commit(2))
    until(lambda: follower.map.seq == 2, "the commit was taken")
    kb.beat(7, 2, shapes_ns=time.time_ns())
    until(lambda: kb.asked == 2, "the map was requested")
    retyped = msgspec.structs.replace(entity("cup1"), types=("Chair", "Supported_Thing"))
    kb.snapshot = Snapshot(seq=2, entities=(retyped,))
    until(lambda: follower.map.entities["cup1"].types == retyped.types, "the map was fetched again")


def test_relations_that_changed_before_the_map_was_fetched_are_not_fetched_again(both):
    kb, follower = both
    kb.beat(7, 1, shapes_ns=1)
    kb.publish(commit(2))
    until(lambda: follower.map.seq == 2, "the heartbeat was taken")
    assert kb.asked == 1
