"""What was in or on something at a time, what changed there, and what is missing."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from semmap.nodes.kb_node.answers.past.episodes import texts
from semmap.nodes.kb_node.answers.past.episodes.occurrences import Occurrences, Place
from semmap.nodes.kb_node.answers.past.episodes.places import find_places
from semmap.nodes.kb_node.answers.past.episodes.timeline import State, Timeline
from semmap.nodes.kb_node.relations.facts.pair_facts import are_near
from semmap.nodes.kb_node.relations.selection import is_in, is_on
from semmap.schemas.changes import between, in_words
from semmap.schemas.episodes import Episode, PastAnswer
from semmap.schemas.wording import few

_FEW = 10
_ANYHOW = ("to", "from", "at")
"""Prepositions of what is on or in something."""


def contents(
    timeline: Timeline,
    occurrences: Occurrences,
    place: Place,
    seq: int,
    ns: int,
    among: set[str] | None = None,
) -> list[str]:
    """Return what was at a place after a commit, and the live entities that were there at `ns`, by name."""
    state = timeline.state(seq)
    found = {name for name in at_place(occurrences, state, place) if not timeline.is_live(name)}
    for name in timeline.live_names:
        places = timeline.places_by_trail(name, ns)
        if places is not None and set(places) & set(place.names):
            found.add(name)
    return sorted(found if among is None else found & among)


def at_place(occurrences: Occurrences, state: State, place: Place) -> set[str]:
    """Return what is at a place after a commit."""
    holders = set(place.names)
    how = "in" if any(occurrences.is_place(name) for name in holders) else place.how
    found = set()
    for name, solid in state.space.solids.items():
        if name in holders or solid.is_place:
            continue
        is_there = how in ("on", *_ANYHOW) and is_on(state.space, solid, holders, frozenset())
        if how in ("in", *_ANYHOW):
            is_there = is_there or is_in(state.space, solid, holders, frozenset())
        if how == "near":
            others = filter(None, map(state.space.solids.get, holders))
            is_there = any(are_near(state.space, solid, other) for other in others)
        if is_there:
            found.add(name)
    return found


def changed(
    timeline: Timeline, occurrences: Occurrences, places: Sequence[Place], first: int, last: int, scope: str
) -> PastAnswer:
    """Return the entities that differ between two commits, of those at the places before or after.

    Where live entities are is not a change.
    """
    then, now = timeline.state(first), timeline.state(last)
    live = set(timeline.live_names)
    later = timeline.past.match_names(then.entities.keys(), now.entities.keys(), first, last)
    was = {later.get(name, name): entity for name, entity in then.entities.items()}
    concerned = (was.keys() | now.entities.keys()) - live
    for place in places:
        were_there = {later.get(name, name) for name in at_place(occurrences, then, place)}
        concerned &= were_there | at_place(occurrences, now, place) | set(place.names)
    found: list[tuple[str, str]] = []
    for name in sorted(concerned):
        before, after = was.get(name), now.entities.get(name)
        if after is None:
            found.append((name, "removed"))
        elif changes := between(before, after):
            found.append((name, in_words(changes)))
    evidence = tuple(_last_change(timeline, name, first, last, what) for name, what in found[:100])
    if not found:
        text = f"nothing has changed {scope}"
    else:
        parts = [f"{e.subject}: {e.what} (commit {e.since})" for e in evidence]
        more = f"; and {len(parts) - _FEW} more" if len(parts) > _FEW else ""
        text = f"{len(found)} changed {scope}: {'; '.join(parts[:_FEW])}{more}"
    names = tuple(name for name, _ in found)
    return PastAnswer(asked="changed", text=text, names=names, count=len(names), evidence=evidence)


def _last_change(timeline: Timeline, name: str, first: int, last: int, what: str) -> Episode:
    """Return the last commit of a period that touched an entity, or the first one, which added it."""
    seqs = [seq for seq, _ in timeline.past.touching(name) if first < seq <= last]
    if not seqs:
        return Episode(subject=name, what=what)
    is_added = what.startswith("added") and name not in timeline.state(first).entities
    seq = seqs[0 if is_added else -1]
    return Episode(subject=name, what=what, since=seq, since_ns=timeline.stamp(seq), by=timeline.author(seq))


def missing(
    timeline: Timeline, occurrences: Occurrences, place: Place | None, first: int, last: int, scope: str
) -> PastAnswer:
    """Return what was at a place after one commit and is not after another, with where it is then."""
    then, now = timeline.state(first), timeline.state(last)
    later = timeline.past.match_names(then.entities.keys(), now.entities.keys(), first, last)
    was, is_ = (
        set(state.entities) if place is None else at_place(occurrences, state, place) for state in (then, now)
    )
    gone = {later.get(name, name) for name in was} - is_ - set(timeline.live_names)
    names = tuple(sorted(gone))
    evidence, parts = [], []
    for name in names:
        e = _last_change(timeline, name, first, last, "removed" if name not in now.entities else "moved")
        where = find_places(now.space, name) if name in now.entities else ()
        is_at = f"now {' '.join(other for _, other in where[:1])}" if where else e.what
        evidence.append(e)
        parts.append(f"{name} ({is_at}; commit {e.since} at {texts.clock(e.since_ns)})")
    text = f"missing {scope}: {', '.join(parts)}" if names else f"nothing is missing {scope}"
    return PastAnswer(
        asked="missing", text=text, names=names, count=len(names), evidence=tuple(evidence[:100])
    )


def list_contents(asked: str, names: Iterable[str], where: str, seq: int, ns: int) -> PastAnswer:
    """Return the answer with what was at a place."""
    found = tuple(names)
    evidence = tuple(Episode(subject=name, what=where, since=seq, since_ns=ns) for name in found[:100])
    what = few(found, _FEW) if found else ("no person" if asked == "who" else "nothing")
    was = "were" if len(found) > 1 else "was"
    text = f"{what} {was} {where} at {texts.clock(ns)} (commit {seq})"
    return PastAnswer(asked=asked, text=text, names=found, count=len(found), evidence=evidence)
