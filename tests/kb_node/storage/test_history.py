from datetime import datetime

import pytest

from semmap.nodes.kb_node.storage.history import HistoryReader
from semmap.ontology import entity_triples
from semmap.ontology import vocabulary as v
from semmap.schemas import errors
from semmap.schemas.commands import History
from semmap.schemas.commits import Edit, Transaction
from semmap.schemas.entities import Pose
from tests.kb_node import home
from tests.kb_node.home import chair, transaction, turtle

TBOX_WITH_SINK = [*home.TBOX, *turtle(":sink a dm:Door .")]


def move(number, name, before, after, **fields):
    node, iri = v.entity_iri(f"{name}_coordinates"), v.entity_iri(name)
    there, here = (entity_triples.position(iri, node, Pose(position_m=at)) for at in (before, after))
    return transaction(number, set(here) - set(there), set(there) - set(here), **fields)


A, B, C = (1.0, 2.0, 0.0), (3.0, 2.0, 0.0), (4.0, 2.0, 0.0)


@pytest.fixture
def seen(tmp_path):
    """A map with a history, and its snapshots by commit."""
    semantic_map = home.new_map(tmp_path, TBOX_WITH_SINK)
    snapshots = {}
    for step in (
        transaction(1, [*chair(), *chair("chair2")], verb="add", agent="ann", reason="two chairs"),
        move(2, "chair1", A, B, source="scene", reason="chair1 came to rest"),
        transaction(3, turtle(":kitchen1 a dm:Kitchen .")),
        move(4, "chair1", B, C, source="perception", agent="camera", confidence=0.75),
        transaction(5, (), chair("chair2"), reason="tidy"),
        transaction(6, turtle(":sink dm:hasPreferredReference :r . :r dm:lexicalReference 'sink' .")),
    ):
        semantic_map.commit(step)
        snapshots[semantic_map.seq] = semantic_map.snapshot().entities
    yield HistoryReader(semantic_map._journal), snapshots
    home.close(semantic_map)


def test_the_map_as_it_was_after_each_commit(seen):
    past, snapshots = seen
    for seq, entities in snapshots.items():
        assert past.entities(seq) == entities
        assert tuple(past.entity(e.name, seq) for e in entities) == entities
    assert [e.name for e in past.entities(4, "Seat")] == ["chair1", "chair2"]
    assert past.entities(2, "Kitchen", ["Kitchen"]) == ()
    with pytest.raises(errors.UnknownClass, match=r"unknown class 'Sead'; did you mean Seat"):
        past.entities(4, "Sead")


def test_the_map_as_it_was_at_a_time(seen):
    past, snapshots = seen
    stamps = {c.seq: c.stamp_ns for c in past.history(History())}
    for seq in snapshots:
        assert past._journal.stamps.seq_at(stamps[seq]) == seq
        assert past._journal.stamps.seq_at(stamps[seq] - 1) == seq - 1
        for when in (stamps[seq], stamps[seq] / 1e9):
            assert past.entities(when) == snapshots[seq]
            assert [c.seq for c in past.history(History(since=when, until=when))] == [seq]
    now = datetime.now().isoformat()
    assert past.entities(now) == snapshots[6]
    assert past.entity("chair1", now).pose.position_m == C


def test_a_time_has_the_precision_of_its_text(seen, monkeypatch):
    past, snapshots = seen
    second_ns = int(datetime(2026, 3, 1, 12, 30, 5).timestamp()) * 10**9
    stamps = dict(enumerate((-1, 0, 999_999_999, 10**9, 55 * 10**9 - 1, 55 * 10**9), start=1))
    monkeypatch.setattr(past._journal.stamps, "of", lambda seq: second_ns + stamps[seq])
    monkeypatch.setattr(past._journal.stamps, "_read_all", lambda: [second_ns + s for s in stamps.values()])
    for when, seqs in {
        "2026-03-01T12:30:04": [1],
        "2026-03-01T12:30:05": [2, 3],
        second_ns // 10**9: [2, 3],
        "2026-03-01T12:30:05.000": [1, 2],
        "2026-03-01T12:30": [1, 2, 3, 4, 5],
        "2026-03-01T12": [1, 2, 3, 4, 5, 6],
        "2026-03-01": [1, 2, 3, 4, 5, 6],
    }.items():
        assert [c.seq for c in past.history(History(since=when, until=when))] == seqs
        assert past.entities(when) == snapshots[seqs[-1]]
    today = f"{datetime.now():%Y-%m-%d}"
    assert past.entities(today) == snapshots[6]


@pytest.mark.parametrize(
    ("when", "text"),
    [
        (7, "there is no commit 7 yet; the last one is 6"),
        (0, "there was no map at that time; it begins with commit 1 at 20"),
        ("2001-01-01", "there was no map at that time; it begins with commit 1 at 20"),
        (4e9, "the time is in the future"),
    ],
)
def test_times_outside_the_history_are_rejected(seen, when, text):
    past, _ = seen
    for ask in (lambda: past.entities(when), lambda: past.entity("chair1", when)):
        with pytest.raises(errors.Refused, match=text):
            ask()


def test_an_absent_entity_is_named(seen):
    past, _ = seen
    with pytest.raises(errors.UnknownName, match=r"no entity was named 'chair2' after commit 5$"):
        past.entity("chair2", 5)
    with pytest.raises(
        errors.UnknownName, match=r"no entity was named 'chiar2' after commit 2; did you mean"
    ):
        past.entity("chiar2", 2)
    assert past.entity("sink", 1).class_ == "Door"


def test_history_contains_provenance_and_changes(seen):
    past, _ = seen
    commits = past.history(History())
    assert [c.seq for c in commits] == [1, 2, 3, 4, 5, 6]
    first, fourth, fifth = commits[0], commits[3], commits[4]
    assert (first.source, first.agent, first.verb, first.reason) == ("operator", "ann", "add", "two chairs")
    assert (first.inserted, first.retracted, first.changed) == (2 * len(chair()), 0, ("chair1", "chair2"))
    assert (fourth.source, fourth.agent, fourth.confidence) == ("perception", "camera", 0.75)
    assert (fifth.changed, fifth.removed) == ((), ("chair2",))


@pytest.mark.parametrize(
    ("query", "seqs"),
    [
        (History(name="chair1"), [1, 2, 4]),
        (History(name="chair2"), [1, 5]),
        (History(name="chair1", since=2), [2, 4]),
        (History(name="chair1", until=3), [1, 2]),
        (History(name="chair1", limit=1), [4]),
        (History(limit=2), [5, 6]),
        (History(since=2, until=4), [2, 3, 4]),
        (History(until=3, limit=2), [2, 3]),
        (History(since=5, until=4), []),
        (History(until=99), [1, 2, 3, 4, 5, 6]),
        (History(since="2001-01-01"), [1, 2, 3, 4, 5, 6]),
        (History(until="2001-01-01"), []),
        (History(since="2999-01-01"), []),
        (History(name="sink"), [6]),
    ],
)
def test_history_of_an_entity_and_of_a_span_of_time(seen, query, seqs):
    past, _ = seen
    assert [c.seq for c in past.history(query)] == seqs


def test_history_of_an_unknown_name_is_rejected(seen):
    past, _ = seen
    with pytest.raises(errors.UnknownName, match=r"no entity was ever named 'chair3'; did you mean chair"):
        past.history(History(name="chair3"))


def test_a_word_is_a_name_of_any_time_or_means_one_present_entity(seen):
    past, _ = seen
    present = past.entities(past.last)
    assert [past.resolve(name, present) for name in ("chair1", "chair2")] == ["chair1", "chair2"]
    assert past.resolve("Door", present) == past.resolve("the door", present) == "sink"
    with pytest.raises(errors.UnknownName, match=r"no entity was ever named 'chair3'; did you mean chair"):
        past.resolve("chair3", present)


def test_last_seen_is_the_last_commit_that_touched_the_pose(seen):
    past, _ = seen
    chair1, chair2, sink = map(past.last_seen, ("chair1", "chair2", "sink"))
    assert (chair1.pose.position_m, chair1.removed) == (C, None)
    assert (chair1.provenance.commit, chair1.provenance.agent) == (4, "camera")
    assert (chair2.pose.position_m, chair2.provenance.commit) == (A, 1)
    assert (chair2.removed.commit, chair2.removed.reason) == (5, "tidy")
    assert (sink.pose, sink.provenance.commit) == (None, 0)
    with pytest.raises(errors.UnknownName):
        past.last_seen("chair9")


def test_commits_are_found_after_a_clock_change(tmp_path, monkeypatch):
    """The stamps are two, four, three, half past three and five o'clock."""
    semantic_map = home.new_map(tmp_path)
    start_ns = 1_700_000_000 * 10**9
    for number, hour in enumerate((2.0, 4.0, 3.0, 3.5, 5.0), start=1):
        monkeypatch.setattr("time.time_ns", lambda hour=hour: start_ns + int(hour * 3600e9))
        semantic_map.commit(transaction(number, chair(f"chair{number}")))
    past = HistoryReader(semantic_map._journal)

    def at(hour):
        return start_ns / 1e9 + hour * 3600

    def seqs(**span):
        return [commit.seq for commit in past.history(History(**span))]

    assert seqs(since=at(3.8)) == [2, 5]
    assert seqs(since=at(2.5), until=at(3.2)) == [3]
    assert seqs(until=at(3.6)) == [1, 3, 4]
    assert seqs(since=2, until=at(3.2)) == [3]
    assert seqs(since=at(3.2), until=4) == [2, 4]
    assert seqs(name="chair2", since=at(3.8)) == [2]
    assert [len(past.entities(at(hour))) for hour in (2.5, 3.2, 3.8, 4.5, 5.0)] == [1, 3, 4, 4, 5]
    monkeypatch.setattr("time.time_ns", lambda: start_ns + int(3.6 * 3600e9))  # set back again
    assert len(past.entities(at(5.0))) == 5
    with pytest.raises(errors.Refused, match="the time is in the future"):
        past.entities(at(5.1))
    home.close(semantic_map)


def rename(semantic_map, name, new):
    edit = (Edit(name=name, rename=new),)
    semantic_map.commit(
        Transaction(
            id=f"{name} to {new}", source="operator", verb="rename", reason=f"{name} to {new}", edit=edit
        )
    )


def test_the_history_of_a_renamed_entity_includes_its_earlier_names(tmp_path):
    semantic_map = home.new_map(tmp_path)
    semantic_map.commit(transaction(1, chair(), reason="a chair"))
    rename(semantic_map, "chair1", "seat1")
    semantic_map.commit(transaction(3, chair(), reason="another chair"))
    semantic_map.commit(transaction(4, [(v.entity_iri("chair1"), v.dm("isBeside"), v.entity_iri("seat1"))]))
    rename(semantic_map, "seat1", "throne")
    past = HistoryReader(semantic_map._journal)
    with pytest.raises(errors.UnknownName, match="seat1 was renamed to throne in commit 5; see: semmap"):
        past.last_seen("seat1")
    assert [commit.seq for commit in past.history(History(name="throne"))] == [1, 2, 5]
    assert [commit.seq for commit in past.history(History(name="throne", limit=2))] == [2, 5]
    assert [commit.seq for commit in past.history(History(name="throne", since=2))] == [2, 5]
    assert [commit.seq for commit in past.history(History(name="seat1"))] == [1, 2, 5]
    assert [commit.seq for commit in past.history(History(name="chair1"))] == [1, 2, 3, 4, 5]
    assert [commit.seq for commit in past.history(History())] == [1, 2, 3, 4, 5]
    home.close(semantic_map)
