"""The data that a copy needs: the new commits, or the whole map, and in which epoch."""

from __future__ import annotations

import pytest
from msgspec import structs

from semmap.nodes.extern.fleet.facts import Facts
from semmap.nodes.extern.fleet.frames import Frame
from semmap.nodes.extern.fleet.replica import Replica
from semmap.nodes.extern.fleet.synchronization import FullCopy, NextCommits, synchronize
from semmap.schemas.bridge import CopyQuery, MapCopy, Recall
from semmap.schemas.commits import Commit


class Journal:
    """A robot's, as its knowledge base answers."""

    def __init__(self, last, *, map_id="m", course="d", first=1, tbox=()):
        self.commits = {
            seq: Commit(
                seq=seq, stamp_ns=0, id=str(seq), source="operator", digest=f"{course}{seq}", tbox=seq in tbox
            )
            for seq in range(first, last + 1)
        }
        self.whole = MapCopy(
            map_id=map_id, begun_ns=0, seq=last, digest=f"{course}{last}" if last else "", stamp_ns=0
        )
        self.asked = []

    def __call__(self, call):
        self.asked.append(call)
        if isinstance(call, CopyQuery):
            return self.whole
        assert isinstance(call, Recall)
        return tuple(self.commits[seq] for seq in call.seqs if seq in self.commits)


def copy(commit, **other):
    said = {"robot": "r", "map_id": "m", "begun": "", "epoch": 3, "commit": commit, "digest": f"d{commit}"}
    return Facts(**{**said, **other})


def test_a_copy_of_this_map_goes_on_with_the_commits_since():
    found = synchronize(Journal(350), "r", copy(7), None)
    assert isinstance(found, NextCommits)
    assert [commit.seq for commit in found.commits] == [*range(8, 351)]


def test_a_copy_that_is_up_to_date_is_found_to_be_so():
    assert synchronize(Journal(7), "r", copy(7), None) == NextCommits(())


def test_a_robot_without_a_commit_has_nothing_to_copy():
    assert synchronize(Journal(0), "r", None, None) is None


@pytest.mark.parametrize(
    ("journal", "at", "epoch", "why"),
    [
        (Journal(9), None, 1, "first copy"),
        (Journal(9, map_id="other"), copy(7), 4, "new map"),
        (Journal(5), copy(7), 4, "was reset"),
        (Journal(9, course="x"), copy(7), 4, "history differs"),
        (Journal(9, first=8), copy(7), 3, "no longer in its history"),
        (Journal(1200), copy(7), 3, "1193 commits ahead"),
        (Journal(9, tbox={8}), copy(7), 3, "ontology"),
        (Journal(9), copy(None, copying="me", digest=""), 3, "is incomplete"),
        (Journal(9), copy(7, frame=Frame(0, 0, 0, 1)), 3, "frame"),
    ],
)
def test_the_map_is_copied_again(journal, at, epoch, why):
    found = synchronize(journal, "r", at, Frame(1, 2, 3, 0) if why == "frame" else None)
    assert isinstance(found, FullCopy)
    assert why in found.why
    assert (found.facts.epoch, found.facts.commit, found.facts.digest) == (
        epoch,
        journal.whole.seq,
        journal.whole.digest,
    )


def test_a_frame_that_was_given_once_is_kept():
    frame = Frame(1, 2, 3, 0)
    assert isinstance(synchronize(Journal(9), "r", copy(7, frame=frame), None), NextCommits)
    found = synchronize(Journal(9, map_id="other"), "r", copy(7, frame=frame), None)
    assert isinstance(found, FullCopy)
    assert found.facts.frame == frame


def made(seq, **more):
    return Commit(seq=seq, stamp_ns=0, id=str(seq), source="operator", digest=f"d{seq}", **more)


@pytest.fixture
def level():
    """A copy at commit 7 that is known to be of this map."""
    replica = Replica("r")
    replica.update_facts(copy(7))
    replica.synchronize(NextCommits(()), replica.generation)
    assert replica.phase == "in_sync"
    return replica


def test_commits_are_summed_up_in_order_whatever_order_they_come_in(level):
    level.phase = "behind"
    for seq in (9, 8, 5, 9):
        level.add_commit(made(seq))
    level.synchronize(NextCommits(()), level.generation)
    _, after = level.change()
    assert (after.commit, after.digest) == (9, "d9")
    level.update_facts(after, after)
    assert not level.has_work
    assert level.waiting == 0


def test_a_missed_commit_has_to_be_caught_up_with(level):
    level.add_commit(made(9))
    assert level.phase == "behind"
    assert level.change() is None
    level.synchronize(NextCommits((made(8), made(9))), level.generation)
    assert level.change()[1].commit == 9


@pytest.mark.parametrize("commit", [made(8, tbox=True), structs.replace(made(7), digest="other")])
def test_what_does_not_simply_follow_has_to_be_looked_at(level, commit):
    level.add_commit(commit)
    assert level.phase == "behind"


def test_another_process_of_the_knowledge_base_may_have_another_map(level):
    level.add_commit(made(8))
    before = level.generation
    level.restart()
    assert level.change() is None
    level.synchronize(NextCommits((made(8),)), before)  # found out about the one before
    assert level.phase == "behind"


def test_what_the_server_does_not_confirm_was_not_written(level):
    level.add_commit(made(8))
    _, wanted = level.change()
    level.update_facts(copy(7), wanted)
    assert level.phase == "behind"
    level.update_facts(copy(7))
    level.synchronize(NextCommits((made(8),)), level.generation)
    assert level.change()[1].commit == 8


def test_what_was_written_without_a_reply_is_not_written_again(level):
    level.add_commit(made(8))
    level.add_commit(made(9))
    level.update_facts(copy(8))  # asked after the connection was cut
    assert level.change()[1].commit == 9
