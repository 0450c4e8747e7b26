"""Where an entity was at a time, before, after or during something else, or over a period."""

from __future__ import annotations

from typing import Final

from semmap.nodes.kb_node.answers.past.episodes import texts
from semmap.nodes.kb_node.answers.past.episodes.occurrences import NotKnown
from semmap.nodes.kb_node.answers.past.episodes.places import find_places, follow
from semmap.nodes.kb_node.answers.past.episodes.timeline import Timeline, is_event
from semmap.schemas.entities import Entity
from semmap.schemas.episodes import Episode, PastAnswer
from semmap.schemas.relations import PHRASES, RelationName

_PLACES: Final = 2
"""Nested places in a text."""


def where_at(timeline: Timeline, name: str, seq: int, ns: int, when: str) -> PastAnswer:
    """Return where an entity was at a time `ns`, after commit `seq`; `when` is that in words.

    Raises NotKnown if it did not exist then, or had no position.
    """
    places = timeline.places_by_trail(name, ns)
    if places is not None:
        where = f"in {places[0]}" if places else "in no place of the map"
        text = f"{name} was {where} {when} (live poses)"
        episode = Episode(subject=name, what=where, since_ns=ns)
        return PastAnswer(asked="where", text=text, names=places, evidence=(episode,))
    state = timeline.state(seq)
    entity = state.entities.get(name)
    if entity is None:
        raise NotKnown(f"{name} was not in the map {when}{_existed(timeline, name)}")
    found = find_places(state.space, name)
    if not found:
        at = "" if entity.pose is None else " at ({:.2f}, {:.2f}, {:.2f}) m".format(*entity.pose.position_m)
        raise NotKnown(f"{name} was on, inside and in nothing of the map {when}{at}")
    where = describe(found)
    since = _placed(timeline, name, seq, entity)
    text = f"{name} was {where} {when}, placed at {texts.begin(since)}"
    return PastAnswer(asked="where", text=text, names=tuple(other for _, other in found), evidence=(since,))


def describe(found: tuple[tuple[RelationName, str], ...]) -> str:
    """Return `on table1 in kitchen1`, with at most two places."""
    innermost = [one for one in found if one[0] == "isLocatedIn"][:_PLACES]
    found = (*(one for one in found if one[0] != "isLocatedIn"), *innermost)
    words = [f"{PHRASES[relation].removeprefix('is ')} {other}" for relation, other in found]
    return " ".join(words)


def _existed(timeline: Timeline, name: str) -> str:
    """Return since when and until when an entity existed."""
    added = timeline.events(name, "add", "added")
    removed = timeline.events(name, "remove", "removed")
    parts = [f"added at {texts.begin(added[0])}"] if added else []
    parts += [f"removed at {texts.begin(removed[-1])}"] if removed else []
    return f": {', '.join(parts)}" if parts else ""


def _placed(timeline: Timeline, name: str, seq: int, entity: Entity) -> Episode:
    """Return the event that gave an entity the position that it had after a commit."""
    moves = [
        (commit, changes)
        for commit, changes in timeline.changes(name)
        if commit.seq <= seq and any(is_event(c, "move") or is_event(c, "add") for c in changes)
    ]
    if not moves:
        made = entity.pose_provenance
        first = made.commit >= timeline.journal.first
        return Episode(
            subject=name,
            what="placed",
            since=made.commit if first else 0,
            since_ns=made.stamp_ns if first else timeline.first_ns,
            by=made.agent or made.source if first else "",
        )
    commit = moves[-1][0]
    by = commit.agent or commit.source
    return Episode(subject=name, what="placed", since=commit.seq, since_ns=commit.stamp_ns, by=by)


def where_during(timeline: Timeline, name: str, first_ns: int, last_ns: int) -> PastAnswer:
    """Return the places where an entity was in a period, in order. Raises NotKnown."""
    found = visited(timeline, name, first_ns, last_ns)
    if not found:
        raise NotKnown(f"where {name} was in that time is not stored{_existed(timeline, name)}")
    parts = [f"{episode.what} {texts.span(episode)}" for episode in found]
    names = tuple(dict.fromkeys(place for e in found for place in e.what.split()[1::2]))
    return PastAnswer(
        asked="where", text=f"{name} was {texts.listed(parts)}", names=names, evidence=tuple(found)
    )


def visited(timeline: Timeline, name: str, first_ns: int = 0, last_ns: int = 1 << 62) -> list[Episode]:
    """Return where an entity was in a period, one episode for each place, in order."""
    if timeline.is_live(name):
        return _visits(timeline, name, first_ns, last_ns)
    found: list[Episode] = []
    where = ""
    for seq, places in follow(timeline, name):
        now = describe(places)
        if now == where:
            continue
        stamp_ns = timeline.stamp(seq) if seq else timeline.first_ns
        if found and found[-1].until_ns is None:
            found[-1] = _ended(found[-1], seq, stamp_ns)
        if now:
            by = timeline.author(seq) if seq >= timeline.journal.first else ""
            found.append(Episode(subject=name, what=now, since=seq, since_ns=stamp_ns, by=by))
        where = now
    return [e for e in found if e.since_ns <= last_ns and (e.until_ns is None or e.until_ns > first_ns)]


def _visits(timeline: Timeline, name: str, first_ns: int, last_ns: int) -> list[Episode]:
    """Return the visits of a live entity to the innermost places."""
    found: list[Episode] = []
    for point in timeline.trails(name).points[name]:
        what = f"in {point.places[0]}" if point.places else ""
        if found and found[-1].what != what and found[-1].until_ns is None:
            found[-1] = _ended(found[-1], None, point.ns)
        if what and (not found or found[-1].what != what or found[-1].until_ns is not None):
            found.append(Episode(subject=name, what=what, since_ns=point.ns))
        if found and point.until_ns is not None:
            found[-1] = _ended(found[-1], None, point.until_ns)
    return [e for e in found if e.since_ns <= last_ns and (e.until_ns is None or e.until_ns > first_ns)]


def _ended(episode: Episode, seq: int | None, ns: int) -> Episode:
    return Episode(
        subject=episode.subject,
        what=episode.what,
        since=episode.since,
        since_ns=episode.since_ns,
        until=seq,
        until_ns=ns,
        by=episode.by,
    )


def where_before(timeline: Timeline, name: str, ns: int, what: str) -> PastAnswer:
    """Return the last place of an entity before a time. Raises NotKnown."""
    before = [e for e in visited(timeline, name) if e.since_ns < ns]
    if not before:
        raise NotKnown(
            f"where {name} was {what} is not stored: the history begins at {texts.clock(timeline.first_ns)}"
        )
    return _at_episode(before[-1], f"{what}: {texts.span(before[-1])}")


def where_after(timeline: Timeline, name: str, ns: int, what: str) -> PastAnswer:
    """Return the first place of an entity after a time, at which it left another one. Raises NotKnown."""
    after = [e for e in visited(timeline, name) if e.until_ns is None or e.until_ns > ns]
    if not after:
        raise NotKnown(f"where {name} was {what} is not stored")
    return _at_episode(after[0], f"{what}: {texts.span(after[0])}")


def _at_episode(episode: Episode, when: str) -> PastAnswer:
    names = tuple(episode.what.split()[1::2])
    text = f"{episode.subject} was {episode.what} {when}"
    return PastAnswer(asked="where", text=text, names=names, evidence=(episode,))
