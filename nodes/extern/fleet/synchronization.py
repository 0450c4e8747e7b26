"""Synchronization of the copy of a robot's map: by its new commits, or by copying the whole map.

The digest of a commit covers all commits up to it. So the copy belongs to the robot's map, and can be
continued with its later commits, if and only if the journal of the robot has the same digest at the commit of
the copy.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Final, NamedTuple

from semmap.nodes.extern.fleet import facts as f
from semmap.nodes.extern.fleet.facts import Facts
from semmap.nodes.extern.fleet.frames import Frame
from semmap.schemas import errors
from semmap.schemas.bridge import CopyQuery, MapCopy, Recall
from semmap.schemas.calls import Call
from semmap.schemas.commits import Commit

FAR: Final = 1000
"""The number of commits from which the whole map is copied."""
_PAGE: Final = 100

Ask = Callable[[Call[Any]], Any]
"""Sends a request to the knowledge base of the robot; raises NoAnswer."""


class NextCommits(NamedTuple):
    """The commits after the copy, up to the current commit of the robot."""

    commits: tuple[Commit, ...]


class FullCopy(NamedTuple):
    """The whole map, with the facts of the new copy; `why` is a reason for the log."""

    whole: MapCopy
    facts: Facts
    why: str


def synchronize(
    ask: Ask, robot: str, copy: Facts | None, frame: Frame | None, *, far: int = FAR
) -> NextCommits | FullCopy | None:
    """Return the data that updates `copy`, the facts of the robot's graph; None if the robot has no map.

    `frame` is the pose of the map in the fleet frame; None keeps the stored one.
    """
    head: MapCopy = ask(CopyQuery(content=False))
    if not head.seq:
        return None
    reason, same_map = _reason(ask, head, copy, frame, far)
    if not reason:
        if copy is None:
            raise errors.InternalError("a map that was never copied cannot be continued")
        if copy.commit is None:
            raise errors.InternalError("a map that was never copied cannot be continued")
        commits = _fetch_commits(ask, copy.commit, head.seq)
        if commits is not None:
            return NextCommits(commits)
        reason = "its ontology was replaced, or a commit is missing"
    whole: MapCopy = ask(CopyQuery())
    if whole.map_id != head.map_id:  # the map was replaced between the two requests
        same_map = False
    epoch = 1 if copy is None else copy.epoch if same_map else copy.epoch + 1
    return FullCopy(whole, _facts_of(whole, robot, epoch, frame or (copy.frame if copy else None)), reason)


def _reason(ask: Ask, head: MapCopy, copy: Facts | None, frame: Frame | None, far: int) -> tuple[str, bool]:
    """Return why the copy cannot be continued, and whether it belongs to the same map."""
    if copy is None:
        return "first copy", True
    if copy.map_id != head.map_id:
        return "the robot started a new map", False
    if copy.commit is None:
        return "the previous copy is incomplete", True
    if copy.commit > head.seq:
        return "its map was reset to an earlier state", False
    known: tuple[Commit, ...] = ask(Recall(seqs=(copy.commit,)))
    if known and known[0].digest != copy.digest:
        return "its history differs", False
    if not known:
        return "the commit of the copy is no longer in its history", True
    if frame not in (None, copy.frame):
        return "its frame has changed", True
    if head.seq - copy.commit > far:
        return f"it is {head.seq - copy.commit} commits ahead", True
    return "", True


def _fetch_commits(ask: Ask, after: int, until: int) -> tuple[Commit, ...] | None:
    """Return the commits in between; None if one is missing or replaced the ontology."""
    commits: list[Commit] = []
    for start in range(after + 1, until + 1, _PAGE):
        seqs = tuple(range(start, min(start + _PAGE, until + 1)))
        page: tuple[Commit, ...] = ask(Recall(seqs=seqs))
        if tuple(commit.seq for commit in page) != seqs or any(commit.tbox for commit in page):
            return None
        commits += page
    return tuple(commits)


def _facts_of(whole: MapCopy, robot: str, epoch: int, frame: Frame | None) -> Facts:
    return Facts(
        robot=robot,
        map_id=whole.map_id,
        begun=f.iso(whole.begun_ns),
        epoch=epoch,
        frame=frame,
        commit=whole.seq,
        digest=whole.digest,
        stamp=f.iso(whole.stamp_ns),
    )
