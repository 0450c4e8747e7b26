import msgspec
import pytest

from semmap.nodes.runtime.map_replica import MapReplica
from semmap.schemas.commits import Extent, Snapshot
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


def test_a_gap_is_reported_and_changes_nothing():
    view = begun()
    assert not view.take(commit(3, removed=("cup1",)))
    assert (view.seq, set(view.entities)) == (1, {"cup1", "table1"})


def test_another_snapshot_is_loaded():
    view = begun()
    view.begin(Snapshot(seq=9, entities=(entity("sink1", "Sink"),)))
    assert (view.seq, set(view.entities)) == (9, {"sink1"})


def test_a_commit_announced_before_a_snapshot_without_it_is_missing():
    view = MapReplica()
    view.take(commit(3, entity("sink1", "Sink")))
    view.begin(Snapshot(seq=1, entities=(entity("cup1", "Cup"),)))
    assert not view.is_current
    view.begin(Snapshot(seq=3, entities=(entity("cup1", "Cup"), entity("sink1", "Sink"))))
    assert view.is_current


def test_early_commits_are_applied_after_those_before_them():
    view = begun()
    assert not view.take(commit(4, entity("sink1", "Basin")))
    assert not view.take(commit(3, entity("sink1", "Sink"), removed=("cup1",)))
    assert (view.seq, view.is_current) == (1, False)
    assert view.take(commit(2, entity("cup1", "Bowl")))
    assert (view.seq, view.is_current) == (4, True)
    assert {name: e.class_ for name, e in view.entities.items()} == {"sink1": "Basin", "table1": "Table"}


def test_early_commits_of_another_map_are_forgotten():
    view = begun()
    view.take(commit(3, removed=("cup1",)))
    view.doubt()
    view.begin(Snapshot(seq=2, entities=(entity("cup1", "Cup"),)))
    assert (view.seq, set(view.entities), view.is_current) == (2, {"cup1"}, True)


def test_another_knowledge_base_may_know_less():
    view = begun()
    view.take(commit(2, entity("sink1", "Sink")))
    view.doubt()
    view.begin(Snapshot(seq=1, entities=(entity("cup1", "Cup"),)))
    assert view.is_current


def test_an_older_snapshot_counts_only_in_doubt():
    view = begun()
    view.take(commit(2, entity("sink1", "Sink")))
    old = Snapshot(seq=1, entities=())
    assert not view.begin(old)
    assert (view.seq, len(view.entities), view.is_current) == (2, 3, True)
    view.doubt()
    assert not view.is_current
    assert view.begin(old)
    assert (view.seq, view.entities, view.is_current) == (1, {}, True)


def test_in_doubt_a_commit_is_not_known():
    view = begun()
    view.doubt()
    assert not view.take(commit(1))


def test_an_abridged_commit_needs_a_snapshot():
    view = begun()
    left_out = Extent(inserted=9, retracted=0, changed=3, removed=0)
    assert not view.take(msgspec.structs.replace(commit(2), abridged=left_out))
    assert not view.is_current
    assert (view.seq, set(view.entities)) == (1, {"cup1", "table1"})
    view.begin(Snapshot(seq=2, entities=(entity("sink1", "Sink"),)))
    assert view.is_current


def test_commits_between_two_pages_of_a_snapshot_are_taken_in_order():
    view = MapReplica()
    pages = view.begin_pages()
    pages.take(Snapshot(seq=1, entities=(entity("a", "Cup"), entity("b", "Cup")), more=True))
    assert pages.query.after == "b"
    view.take(commit(2, entity("a", "Bowl"), entity("z", "Cup"), removed=("b",)))
    view.take(commit(3, entity("z", "Bowl")))
    pages.take(Snapshot(seq=3, entities=(entity("z", "Bowl"),)))
    assert pages.are_complete
    view.begin(pages.snapshot)
    assert view.seq == 3
    assert {name: e.class_ for name, e in view.entities.items()} == {"a": "Bowl", "z": "Bowl"}


def test_a_replica_reports_whether_its_pages_are_being_fetched():
    view = begun()
    pages = view.begin_pages()
    assert view.is_being_fetched
    view.cancel_pages()
    assert not view.is_being_fetched
    pages = view.begin_pages()
    pages.take(Snapshot(seq=2, entities=()))
    view.begin(pages.snapshot)
    assert not view.is_being_fetched


def test_entities_of_a_page_share_equal_parts():
    pages = MapReplica().begin_pages()
    said = msgspec.msgpack.encode(Snapshot(seq=1, entities=(entity("a", "Cup"), entity("b", "Cup"))))
    before = msgspec.msgpack.decode(said, type=Snapshot)
    pages.take(before)
    a, b = pages.snapshot.entities
    assert (a, b) == before.entities
    assert a.types is b.types
    assert a.provenance is b.provenance is b.pose_provenance


def signed(seq, digest, *changed, removed=()):
    return msgspec.structs.replace(commit(seq, *changed, removed=removed), digest=digest)


def known():
    view = MapReplica()
    view.begin(Snapshot(seq=1, entities=(entity("cup1"),), digest="one"))
    return view


def test_reports_of_the_knowledge_base_confirm_commits():
    view = known()
    assert view.is_confirmed
    view.take(signed(2, "two", entity("cup2")))
    assert not view.is_confirmed
    view.confirm(2, "two")
    assert view.is_confirmed


def test_a_commit_that_contradicts_one_that_was_taken_puts_all_in_doubt():
    view = known()
    assert view.take(signed(2, "forged", removed=("cup1",)))
    assert not view.take(signed(2, "two", entity("cup2")))
    assert not view.is_current
    view.begin(Snapshot(seq=2, entities=(entity("cup1"), entity("cup2")), digest="two"))
    assert view.is_confirmed
    assert set(view.entities) == {"cup1", "cup2"}


@pytest.mark.parametrize("forged_first", [True, False])
@pytest.mark.parametrize("gap", [0, 1])
def test_commits_that_contradict_one_another_while_a_snapshot_is_fetched_have_it_fetched_again(
    forged_first, gap
):
    view = known()
    view.begin_pages()
    seq = 2 + gap  # with a gap neither is taken at once
    both = [signed(seq, "forged", removed=("cup1",)), signed(seq, "true", entity("cup2"))]
    for one in both if forged_first else reversed(both):
        view.take(one)
    view.begin(Snapshot(seq=seq - 1, entities=(entity("cup1"),), digest="before"))
    assert not view.is_current
    view.begin_pages()
    view.begin(Snapshot(seq=seq, entities=(entity("cup1"), entity("cup2")), digest="true"))
    assert view.is_confirmed
    assert set(view.entities) == {"cup1", "cup2"}


def test_a_commit_without_a_digest_is_in_doubt_when_the_true_one_comes():
    view = known()
    view.take(signed(2, "", removed=("cup1",)))
    assert not view.take(signed(2, "two", entity("cup2")))
    assert not view.is_current


@pytest.mark.parametrize("digest", ["forged", ""])
def test_a_contradicting_confirmation_puts_all_in_doubt(digest):
    view = known()
    view.take(signed(2, digest, removed=("cup1",)))
    view.confirm(2, "two")
    assert not view.is_current


def test_a_repeated_commit_is_not_a_contradiction():
    view = known()
    view.take(signed(2, "two", entity("cup2")))
    assert view.take(signed(2, "two", entity("cup2")))
    assert view.take(commit(1))  # one of the past comes without its digest
    assert view.is_current


def test_a_number_that_no_snapshot_ever_reaches_is_forgotten():
    view = known()
    view.take(signed(10**9, "forged"))
    for asked in range(2):
        assert not view.is_current, asked
        view.begin(Snapshot(seq=1, entities=(entity("cup1"),), digest="one"))
    assert view.is_confirmed
