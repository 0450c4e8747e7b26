from nodes.runtime.map_replica import MapReplica
from schemas.commits import Snapshot
from tests.recorder.messages import commit, entity


def begun():
    view = MapReplica()
    view.begin(Snapshot(seq=1, entities=(entity("cup1", "Cup"), entity("table1", "Table"))))
    return view


def test_before_a_snapshot_nothing_is_known():
    view = MapReplica()
    assert not view.take(commit(7, entity("cup1", "Cup")))
    assert (view.seq, view.entities) == (-1, {})


def test_commits_change_entities():
    view = begun()
    assert view.take(commit(2, entity("cup1", "Bowl"), entity("sink1", "Sink"), removed=("table1",)))
    assert (view.seq, set(view.entities)) == (2, {"cup1", "sink1"})
    assert view.entities["cup1"].class_ == "Bowl"


def test_a_commit_of_the_past_changes_nothing():
    view = begun()
    assert view.take(commit(1, removed=("cup1",)))
    assert "cup1" in view.entities


def test_a_gap_is_told_and_changes_nothing():
    view = begun()
    assert not view.take(commit(3, removed=("cup1",)))
    assert (view.seq, set(view.entities)) == (1, {"cup1", "table1"})


def test_another_snapshot_counts():
    view = begun()
    view.begin(Snapshot(seq=9, entities=(entity("sink1", "Sink"),)))
    assert (view.seq, set(view.entities)) == (9, {"sink1"})


def test_a_commit_heard_of_before_a_snapshot_without_it_is_missed():
    view = MapReplica()
    view.take(commit(2, entity("sink1", "Sink")))
    view.begin(Snapshot(seq=1, entities=(entity("cup1", "Cup"),)))
    assert view.is_behind
    view.begin(Snapshot(seq=2, entities=(entity("cup1", "Cup"), entity("sink1", "Sink"))))
    assert not view.is_behind


def test_another_knowledge_base_may_know_less():
    view = begun()
    view.take(commit(2, entity("sink1", "Sink")))
    view.doubt()
    view.begin(Snapshot(seq=1, entities=(entity("cup1", "Cup"),)))
    assert not view.is_behind
