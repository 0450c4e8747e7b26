"""How a copy of a robot's map gets to where the robot is: by the commits since, or by copying the whole map.

The digest of a commit is that of all commits up to it. So a copy is of this map, and the commits after it
follow from it, exactly if the robot's journal has the copy's digest at the copy's commit.
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
"""Commits: a copy that is further behind is made anew."""
_PAGE: Final = 100

Ask = Callable[[Call[Any]], Any]
"""Asks the robot's knowledge base; raises NoAnswer."""


class NextCommits(NamedTuple):
    """The copy is of this map, and these commits follow it; the robot is at the last one."""

    commits: tuple[Commit, ...]


class FullCopy(NamedTuple):
    """The map is to be copied as it is now, and `facts` are to be true of the copy; `why` is for people."""

    whole: MapCopy
    facts: Facts
    why: str


def synchronize(
    ask: Ask, robot: str, copy: Facts | None, frame: Frame | None, *, far: int = FAR
) -> NextCommits | FullCopy | None:
    """What brings `copy`, the facts of the robot's graph, to where the robot is; None where it has no map.

    `frame` is where its map is in the fleet's frame, None where nobody says: then it stays what it was.
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
        reason = "its ontology was replaced, or a commit is not to be had"
    whole: MapCopy = ask(CopyQuery())
    if whole.map_id != head.map_id:  # another map has taken its place just now
        same_map = False
    epoch = 1 if copy is None else copy.epoch if same_map else copy.epoch + 1
    return FullCopy(whole, _facts_of(whole, robot, epoch, frame or (copy.frame if copy else None)), reason)


def _reason(ask: Ask, head: MapCopy, copy: Facts | None, frame: Frame | None, far: int) -> tuple[str, bool]:
    """Why the copy cannot go on, in words; whether it is of this map all the same."""
    if copy is None:
        return "it is new", True
    if copy.map_id != head.map_id:
        return "its map was begun anew", False
    if copy.commit is None:
        return "an earlier copy was not finished", True
    if copy.commit > head.seq:
        return "its map went back to an earlier state", False
    known: tuple[Commit, ...] = ask(Recall(seqs=(copy.commit,)))
    if known and known[0].digest != copy.digest:
        return "its map took another course", False
    if not known:
        return "its history does not go back so far", True
    if frame not in (None, copy.frame):
        return "its frame is another one", True
    if head.seq - copy.commit > far:
        return f"it is {head.seq - copy.commit} commits ahead", True
    return "", True


def _fetch_commits(ask: Ask, after: int, until: int) -> tuple[Commit, ...] | None:
    """The commits in between; None where one is missing or replaced the ontology."""
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
