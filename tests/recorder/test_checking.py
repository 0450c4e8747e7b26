"""Comparison of a recording's commits with the journal's."""

import pytest
from msgspec import structs

from semmap.nodes.recorder.checking import check
from semmap.nodes.recorder.recorded_commits import RecordedCommit
from tests.recorder.messages import commit, entity, relation

A, B = relation("cup1", "isOn", "table1"), relation("cup1", "isOn", "desk1")
JOURNAL = {
    1: commit(1, entity("cup1"), inserted=(A,)),
    2: commit(2, entity("cup1"), inserted=(B,), retracted=(A,)),
    3: commit(3, removed=("cup1",), retracted=(B,)),
    4: commit(4, entity("cup2"), inserted=(A,)),
}


def recorded(seq, **others):
    one = structs.replace(JOURNAL[seq], **others)
    return RecordedCommit(
        seq=one.seq,
        stamp_ns=one.stamp_ns,
        id=one.id,
        source=one.source,
        agent=one.agent,
        reason=one.reason,
        inserted=one.inserted,
        retracted=one.retracted,
        changed=tuple(e.name for e in one.changed),
        removed=tuple(gone.name for gone in one.removed),
    )


def checked(*commits, first=1, last=4):
    return check(commits, JOURNAL.__getitem__, first=first, last=last)


def test_what_is_the_same_is_said_to_be():
    same = checked(*map(recorded, (1, 2, 3, 4)))
    assert same == (True, True, "4 commits are as in the journal: 1 to 4")
    assert checked(recorded(3), last=3) == (
        True, True, "1 commit is as in the journal: 3; it begins after commits 1 to 2"
    )  # fmt: skip
    assert checked(recorded(4)).is_whole


def test_commits_that_the_recording_lacks_are_named():
    assert checked(recorded(1), recorded(2), recorded(4)) == (
        True, False, "3 commits are as in the journal: 1 to 4; the recording lacks commit 3"
    )  # fmt: skip
    cut = checked(recorded(1))
    assert cut == (True, False, "1 commit is as in the journal: 1; the recording lacks commits 2 to 4")
    assert "lacks commits 2 and 4" in checked(recorded(1), recorded(3)).text
    none = checked()
    assert none == (True, False, "the recording has no commits; the recording lacks commits 1 to 4")


def test_what_was_compacted_is_said():
    verdict = checked(*map(recorded, (1, 2, 3, 4)), first=3)
    assert verdict.is_same
    assert "2 commits before commit 3 cannot be compared, because the journal was compacted" in verdict.text


@pytest.mark.parametrize(
    ("others", "said"),
    [
        ({"id": "x"}, "commit 2 differs: id is 'x' in the recording and 'id-2' in the journal"),
        ({"reason": "why"}, "reason is 'why' in the recording and '' in the journal"),
        ({"inserted": (A, B)}, "inserted triple <"),
        ({"retracted": ()}, "retracted triple <"),
        ({"changed": ()}, "changed entity 'cup1' is not in the recording"),
        ({"inserted": (), "retracted": (), "changed": ()}, "the recording lacks its changes"),
    ],
)
def test_the_first_difference_is_named(others, said):
    verdict = checked(recorded(1), recorded(2, **others), recorded(3, id="later"))
    assert not verdict.is_same
    assert verdict.text.startswith("commit 2 differs: ")
    assert said in verdict.text


def test_a_commit_that_the_journal_does_not_have_is_named():
    verdict = checked(*map(recorded, (1, 2, 3, 4)), last=3)
    assert verdict == (False, False, "commit 4 is not in the journal, whose last one is 3")
    verdict = checked(recorded(1), recorded(2), recorded(2))
    assert verdict == (False, False, "commit 2 is recorded twice, with different content")
