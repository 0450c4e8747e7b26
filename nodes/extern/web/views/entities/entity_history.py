"""The history of one entity, commit by commit, and its provenance."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Iterator
from typing import NamedTuple

from semmap.nodes.extern.phrasing import author, moment, provenance_text
from semmap.nodes.extern.web.views.entities.locations import footprint_m2
from semmap.schemas.changes import Change
from semmap.schemas.entities import Entity, Pose, distance_m
from semmap.schemas.replies import LoggedCommit

_STILL_M = 5e-4


class Event(NamedTuple):
    """One commit that changed the entity."""

    commit: int
    when: str
    by: str
    reason: str
    texts: tuple[str, ...]
    """The changes, with the old and the new value."""
    confidence: str = ""


def history_events(
    name: str, commits: Iterable[LoggedCommit], places: Collection[Entity]
) -> tuple[Event, ...]:
    """Return the history of `name`, the newest commit first. Positions are named by the current places."""
    found = [
        Event(
            commit=commit.seq,
            when=moment(commit.stamp_ns),
            by=author(commit),
            reason=commit.reason,
            texts=tuple(_texts(name, commit, places)),
            confidence="" if commit.confidence is None else f"{commit.confidence:.2f}",
        )
        for commit in commits
    ]
    return tuple(reversed(found))


def _texts(name: str, commit: LoggedCommit, places: Collection[Entity]) -> Iterator[str]:
    """Yield the changes of the entity; a commit that changes very many entities does not list them."""
    texts = [
        _describe_move(c, places) if c.kind == "pose" else c.text for c in commit.changes if c.name == name
    ] or [f"renamed to {c.now}" for c in commit.changes if c.kind == "name" and c.was == name]
    if not texts and name in commit.removed:
        texts = ["removed"]
    yield from texts or ["changed, with many others"]
    yield from (f"note: {note}" for note in commit.notes if name in note)


def _describe_move(change: Change, places: Collection[Entity]) -> str:
    """Return the move in words, with its distance and the places."""
    was, now = change.was, change.now
    if not isinstance(was, Pose) or not isinstance(now, Pose):
        return change.text
    far_m = distance_m(was, now)
    if far_m < _STILL_M:
        return change.text
    far = f"{far_m:.2f} m" if far_m >= 1.0 else f"{far_m * 100.0:.0f} cm" if far_m >= 0.01 else ""
    before, after = find_place(was, places), find_place(now, places)
    if before != after:
        between = " and ".join(filter(None, (before and f"from {before}", after and f"to {after}")))
        between = between.replace(" and to", " to")
    else:
        between = f"within {after}" if after else ""
    about = ", ".join(filter(None, (far, between)))
    return f"{change.text} ({about})" if about else change.text


def find_place(pose: Pose, places: Collection[Entity]) -> str:
    """Return the name of the smallest place whose footprint contains a position; empty if there is none."""
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


def group_provenance(entity: Entity) -> dict[str, str]:
    """Return the provenance texts of an entity, by its parts.

    Parts with the same provenance are one entry.
    """
    parts = {
        "pose": entity.pose_provenance,
        "class and size": entity.shape_provenance,
        "labels": entity.reference_provenance,
        "last change": entity.provenance,
    }
    by_text: dict[str, list[str]] = {}
    for part, found in parts.items():
        by_text.setdefault(provenance_text(found), []).append(part)
    return {", ".join(names): text for text, names in by_text.items()}
