"""Compares the commits of a recording with those of a journal."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import Any, Final, NamedTuple

from semmap.nodes.recorder.recorded_commits import RecordedCommit
from semmap.schemas import wording
from semmap.schemas.commits import Commit, abridged

_FIELDS: Final = ("id", "stamp_ns", "source", "agent", "reason")
_SHOWN: Final = 80


class Verdict(NamedTuple):
    """The result of a comparison.

    `is_same`: every recorded commit that could be compared equals the journal's. `is_whole`: the recording
    has all commits since its first one.
    """

    is_same: bool
    is_whole: bool
    text: str


def check(
    recorded: Sequence[RecordedCommit], commit_of: Callable[[int], Commit], *, first: int, last: int
) -> Verdict:
    """Compare the commits of a recording, in order, with those of a journal.

    The journal has the commits from `first` to `last`, and `commit_of(seq)` returns one of them in full. The
    text names the first difference, or all commits that the recording lacks.
    """
    there = [commit for commit in recorded if commit.seq >= first]
    for commit in there:
        if commit.seq > last:
            return _different(f"commit {commit.seq} is not in the journal, whose last one is {last}")
        if difference := _difference(commit, commit_of(commit.seq)):
            return _different(f"commit {commit.seq} differs: {difference}")
    seqs = [commit.seq for commit in there]
    if (twice := next((a for a, b in pairwise(seqs) if a == b), None)) is not None:
        return _different(f"commit {twice} is recorded twice, with different content")
    if seqs:
        texts = [f"{wording.counted(len(seqs), 'commit is', 'commits are')} as in the journal{_span(seqs)}"]
    else:
        texts = ["the recording has no commits"] if not recorded else []
    begins = recorded[0].seq if recorded else first
    missing = sorted({*range(max(begins, first), last + 1)} - {*seqs})
    if missing:
        texts.append(f"the recording lacks {_ranges(missing)}")
    if begins > first:
        texts.append(f"it begins after {_ranges(range(first, begins))}")
    if gone := len(recorded) - len(there):
        texts.append(
            f"{wording.counted(gone, 'commit', 'commits')} before commit {first} cannot be compared,"
            " because the journal was compacted"
        )
    return Verdict(is_same=True, is_whole=not missing, text="; ".join(texts))


def _different(text: str) -> Verdict:
    return Verdict(is_same=False, is_whole=False, text=text)


def _ranges(seqs: Sequence[int]) -> str:
    """Return `commit 3` or `commits 2 to 4 and 7`; `seqs` must be sorted."""
    runs: list[list[int]] = []
    for seq in seqs:
        if runs and runs[-1][1] == seq - 1:
            runs[-1][1] = seq
        else:
            runs.append([seq, seq])
    texts = [str(a) if a == b else f"{a} to {b}" for a, b in runs]
    return f"{'commit' if len(seqs) == 1 else 'commits'} {wording.few(texts)}"


def _span(seqs: Sequence[int]) -> str:
    if not seqs:
        return ""
    return f": {seqs[0]}" if seqs[0] == seqs[-1] else f": {seqs[0]} to {seqs[-1]}"


def _difference(recorded: RecordedCommit, commit: Commit) -> str:
    """Describe the first difference of a recorded commit; empty if there is none.

    A very large commit is recorded without its triples and entities, so these are not compared.
    """
    for field in _FIELDS:
        value, journalled = getattr(recorded, field), getattr(commit, field)
        if value != journalled:
            return f"{field} is {_short(value)} in the recording and {_short(journalled)} in the journal"
    if not (recorded.inserted or recorded.retracted or recorded.changed or recorded.removed):
        if commit.abridged is not None or len(commit.inserted) + len(commit.retracted) > 0:
            return "" if _is_large(commit) else "the recording lacks its changes"
        return ""
    return (
        _of_sets("inserted triple", recorded.inserted, commit.inserted)
        or _of_sets("retracted triple", recorded.retracted, commit.retracted)
        or _of_sets("changed entity", recorded.changed, [entity.name for entity in commit.changed])
        or _of_sets("removed entity", recorded.removed, [gone.name for gone in commit.removed])
    )


def _is_large(commit: Commit) -> bool:
    return abridged(commit).abridged is not None


def _of_sets(what: str, recorded: Sequence[Any], journalled: Sequence[Any]) -> str:
    if {*recorded} == {*journalled}:
        return ""
    if only := sorted({*recorded} - {*journalled}):
        return f"{what} {_short(only[0])} is not in the journal"
    lacking = sorted({*journalled} - {*recorded})
    return f"{what} {_short(lacking[0])} is not in the recording"


def _short(value: Any) -> str:
    text = " ".join(value) if isinstance(value, tuple) else repr(value)
    return text if len(text) <= _SHOWN else f"{text[: _SHOWN - 3]}..."
