"""What became of one thing: its history, commit by commit, with where it was moved from and where to."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Iterator
from typing import NamedTuple

from semmap.nodes.extern.phrasing import author, moment, provenance_text
from semmap.nodes.extern.web.views.whereabouts import footprint_m2
from semmap.schemas.changes import Change
from semmap.schemas.entities import Entity, Pose, distance_m
from semmap.schemas.replies import LoggedCommit

_STILL_M = 5e-4


class Event(NamedTuple):
    """One commit that touched the thing."""

    commit: int
    when: str
    by: str
    why: str
    texts: tuple[str, ...]
    """What was and what is, a sentence each."""
    sure: str = ""


def events(name: str, commits: Iterable[LoggedCommit], places: Collection[Entity]) -> tuple[Event, ...]:
    """The history of `name`, the newest first; places are named by where they are now."""
    found = [
        Event(
            commit=commit.seq,
            when=moment(commit.stamp_ns),
            by=author(commit),
            why=commit.reason,
            texts=tuple(_texts(name, commit, places)),
            sure="" if commit.confidence is None else f"{commit.confidence:.2f}",
        )
        for commit in commits
    ]
    return tuple(reversed(found))


def _texts(name: str, commit: LoggedCommit, places: Collection[Entity]) -> Iterator[str]:
    """What changed of it; of a commit that touched very many, no more than that it did."""
    told = [_moved(c, places) if c.kind == "pose" else c.text for c in commit.changes if c.name == name]
    if not told and name in commit.removed:
        told = ["removed"]
    yield from told or ["touched, with many others"]
    yield from (f"note: {note}" for note in commit.notes if name in note)


def _moved(change: Change, places: Collection[Entity]) -> str:
    """The move in words, with how far it was and between which places."""
    was, now = change.was, change.now
    if not isinstance(was, Pose) or not isinstance(now, Pose):
        return change.text
    far_m = distance_m(was, now)
    if far_m < _STILL_M:
        return change.text
    far = f"{far_m:.2f} m" if far_m >= 1.0 else f"{far_m * 100.0:.0f} cm" if far_m >= 0.01 else ""
    before, after = place_at(was, places), place_at(now, places)
    if before != after:
        between = " and ".join(filter(None, (before and f"from {before}", after and f"to {after}")))
        between = between.replace(" and to", " to")
    else:
        between = f"within {after}" if after else ""
    about = ", ".join(filter(None, (far, between)))
    return f"{change.text} ({about})" if about else change.text


def place_at(pose: Pose, places: Collection[Entity]) -> str:
    """The smallest place whose footprint a position is over, by name; empty for none.

    Where a place now stands, so an older position is named after what is there today.
    """
    over = [place for place in places if _is_over(pose, place)]
    return min(over, key=lambda place: (footprint_m2(place), place.name)).name if over else ""


def _is_over(pose: Pose, place: Entity) -> bool:
    if place.pose is None or place.size_m is None:
        return False
    dx = pose.position_m[0] - place.pose.position_m[0]
    dy = pose.position_m[1] - place.pose.position_m[1]
    cos, sin = math.cos(place.pose.yaw_rad), math.sin(place.pose.yaw_rad)
    own_x, own_y = cos * dx + sin * dy, -sin * dx + cos * dy
    return abs(own_x) <= place.size_m[0] / 2.0 and abs(own_y) <= place.size_m[1] / 2.0


def provenance(entity: Entity) -> dict[str, str]:
    """Who said what of it, when and in which commit; what was said at once is told once."""
    said = {
        "pose": entity.pose_provenance,
        "class and size": entity.shape_provenance,
        "references": entity.reference_provenance,
        "last change": entity.provenance,
    }
    by_text: dict[str, list[str]] = {}
    for what, who in said.items():
        by_text.setdefault(provenance_text(who), []).append(what)
    return {", ".join(what): text for text, what in by_text.items()}
