"""Whether the commits of a recording are those of a journal."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import Any, Final, NamedTuple

from nodes.recorder.recorded_commits import RecordedCommit
from schemas import wording
from schemas.commits import Commit, abridged

_FIELDS: Final = ("id", "stamp_ns", "source", "agent", "reason")
_SHOWN: Final = 80


class Verdict(NamedTuple):
    """What came of it. `is_same`: every recorded commit that could be compared is the journal's."""

    is_same: bool
    text: str


def check(
    recorded: Sequence[RecordedCommit], commit_of: Callable[[int], Commit], *, first: int, last: int
) -> Verdict:
    """Compare the commits of a recording, in order, with those of a journal: the first difference is named.

    The journal has the commits from `first` to `last`; `commit_of(seq)` is one of them, whole.
    """
    if not recorded:
        return Verdict(is_same=True, text="there are no commits in the recording")
    there = [commit for commit in recorded if commit.seq >= first]
    for commit in there:
        if commit.seq > last:
            return Verdict(
                is_same=False, text=f"commit {commit.seq} is not in the journal, whose last one is {last}"
            )
        if difference := _difference(commit, commit_of(commit.seq)):
            return Verdict(is_same=False, text=f"commit {commit.seq} is another one: {difference}")
    seqs = [commit.seq for commit in there]
    if (twice := next((a for a, b in pairwise(seqs) if a == b), None)) is not None:
        return Verdict(is_same=False, text=f"commit {twice} is recorded twice, and not the same")
    told = [f"{wording.counted(len(seqs), 'commit is', 'commits are')} as in the journal{_span(seqs)}"]
    if missing := sorted({*range(seqs[0], seqs[-1])} - {*seqs} if seqs else ()):
        told.append(f"not recorded between them: {wording.few([str(seq) for seq in missing])}")
    if gone := len(recorded) - len(there):
        told.append(
            f"{wording.counted(gone, 'commit', 'commits')} before commit {first} cannot be compared, because"
            " the journal was compacted"
        )
    return Verdict(is_same=True, text="; ".join(told))


def _span(seqs: Sequence[int]) -> str:
    if not seqs:
        return ""
    return f": {seqs[0]}" if seqs[0] == seqs[-1] else f": {seqs[0]} to {seqs[-1]}"


def _difference(recorded: RecordedCommit, commit: Commit) -> str:
    """What is otherwise in a recorded commit; empty where nothing is.

    Of a very large commit, which is recorded without its triples and entities, those are not compared.
    """
    for field in _FIELDS:
        said, journalled = getattr(recorded, field), getattr(commit, field)
        if said != journalled:
            return f"{field} is {_short(said)} in the recording, and {_short(journalled)} in the journal"
    if not (recorded.inserted or recorded.retracted or recorded.changed or recorded.removed):
        if commit.abridged is not None or len(commit.inserted) + len(commit.retracted) > 0:
            return "" if _is_large(commit) else "the recording lacks what it changes"
        return ""
    return (
        _of_sets("inserted triples", recorded.inserted, commit.inserted)
        or _of_sets("retracted triples", recorded.retracted, commit.retracted)
        or _of_sets("changed entities", recorded.changed, [entity.name for entity in commit.changed])
        or _of_sets("removed entities", recorded.removed, [gone.name for gone in commit.removed])
    )


def _is_large(commit: Commit) -> bool:
    return abridged(commit).abridged is not None


def _of_sets(what: str, recorded: Sequence[Any], journalled: Sequence[Any]) -> str:
    if {*recorded} == {*journalled}:
        return ""
    if only := sorted({*recorded} - {*journalled}):
        return f"of its {what} {_short(only[0])} is not in the journal"
    lacking = sorted({*journalled} - {*recorded})
    return f"of its {what} {_short(lacking[0])} is not in the recording"


def _short(value: Any) -> str:
    text = " ".join(value) if isinstance(value, tuple) else repr(value)
    return text if len(text) <= _SHOWN else f"{text[: _SHOWN - 3]}..."
