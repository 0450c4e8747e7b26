"""What happened or was somewhere in a period: what did Anna move, who was in the kitchen."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import Protocol

from semmap.nodes.kb_node.answers.past.episodes import contents, texts
from semmap.nodes.kb_node.answers.past.episodes.episode_lists import clip, touches
from semmap.nodes.kb_node.answers.past.episodes.occurrences import NotKnown, Occurrences, Place
from semmap.nodes.kb_node.answers.past.episodes.timeline import Timeline
from semmap.nodes.language.past.question import PastQuestion
from semmap.schemas.episodes import Episode, PastAnswer
from semmap.schemas.wording import few

_FEW = 10


class Period(Protocol):
    """The period of a question [ns]."""

    @property
    def first_ns(self) -> int:
        """Return its beginning."""

    @property
    def last_ns(self) -> int:
        """Return its end."""

    @property
    def at_ns(self) -> int | None:
        """Return the moment that it is, or None."""

    @property
    def text(self) -> str:
        """Return it in words."""


def happened(
    timeline: Timeline,
    occurrences: Occurrences,
    question: PastQuestion,
    among: set[str] | None,
    places: Sequence[Place],
    span: Period,
) -> PastAnswer:
    """Return what was at the places in the period or, for an event, what it happened to.

    `among` are the entities that count, None for all. Raises NotKnown.
    """
    event = question.claim.event
    if question.is_gross:
        touched = _touched(timeline, span)
        return _listed(question, _changes_at(timeline, occurrences, touched, places), span)
    if not event:
        return _were_there(timeline, occurrences, question, among, places, span)
    candidates = _touched(timeline, span) if among is None else sorted(among)
    claim = question.claim
    occurrences.author(claim)  # raises here for an unknown one, not for each entity
    if event == "new":
        claim.event = "put" if places else "add"
    episodes: list[Episode] = []
    for name in candidates:
        try:
            episodes += occurrences.of(claim, (name,))
        except NotKnown:
            if among is not None and len(among) == 1:
                raise
    found = [e for e in clip(episodes, span.first_ns, span.last_ns) if e.since_ns >= span.first_ns]
    found.sort(key=lambda e: e.since_ns)
    by_author = question.asked == "who" and event not in ("enter", "leave", "go")
    if _is_complement(question):
        return _others(question, timeline, among, {e.subject for e in found}, occurrences.what(claim, places))
    found = _repeated(found) if question.is_repeated else found
    if question.order:
        found = found[:1] if question.order == "first" else found[-1:]
    names = tuple(dict.fromkeys((e.by if by_author else e.subject) for e in found if e.by or not by_author))
    parts = [f"{e.subject} was {e.what} at {texts.begin(e)}" for e in found]
    what = "no person" if question.asked == "who" else "nothing"
    text = texts.listed(parts) if found else f"{what} {span.text}".strip()
    count = len(names)
    return PastAnswer(asked=question.asked, text=text, names=names, count=count, evidence=tuple(found))


def _changes_at(
    timeline: Timeline, occurrences: Occurrences, candidates: Sequence[str], places: Sequence[Place]
) -> list[Episode]:
    """Return what happened at places: each change of an entity that was there before or after it."""
    found: list[Episode] = []
    there = [occurrences.there(candidates, place) for place in places]
    for name in candidates:
        events = [] if timeline.is_live(name) else timeline.events(name, "change", "changed")
        for spans in there:
            events = [e for e in events if any(touches(span, e) for span in spans.get(name, ()))]
        found += events
    return found


def _listed(question: PastQuestion, episodes: Sequence[Episode], span: Period) -> PastAnswer:
    found = sorted(clip(episodes, span.first_ns, span.last_ns), key=lambda e: e.since_ns)
    found = [e for e in found if e.since_ns >= span.first_ns]
    names = tuple(dict.fromkeys(e.subject for e in found))
    parts = [f"{e.subject} was {e.what} at {texts.begin(e)}" for e in found]
    text = texts.listed(parts) if found else f"nothing happened {span.text}".strip()
    return PastAnswer(asked=question.asked, text=text, names=names, count=len(names), evidence=tuple(found))


def _touched(timeline: Timeline, span: Period) -> list[str]:
    """Return the entities that commits of a period changed."""
    seqs = timeline.journal.stamps.within(span.first_ns, span.last_ns)
    names = {name for commit in timeline.past.commits(seqs) for name in commit.names}
    return sorted(names | set(timeline.live_names))


def _were_there(
    timeline: Timeline,
    occurrences: Occurrences,
    question: PastQuestion,
    among: set[str] | None,
    places: Sequence[Place],
    span: Period,
) -> PastAnswer:
    """Return what was at a place at a time, or at any time of a period."""
    if not places:
        raise NotKnown("the question names neither an event nor a place")
    place = places[0]
    where = " and ".join(f"{occurrences.preposition(one)} {few(one.names, _FEW)}" for one in places)
    if span.at_ns is not None:
        seq = timeline.seq_at(span.at_ns)
        sets = [set(contents.contents(timeline, occurrences, one, seq, span.at_ns, among)) for one in places]
        found = sorted(set.intersection(*sets))
        if _is_complement(question):
            return _others(question, timeline, among, {*found, *place.names}, f"{where} {span.text}")
        return contents.list_contents(question.asked, found, where, seq, span.at_ns)
    candidates = sorted(among) if among is not None else _all_names(timeline)
    episodes = [e for es in occurrences.there(candidates, place).values() for e in es]
    inside = sorted(clip(episodes, span.first_ns, span.last_ns), key=lambda e: e.since_ns)
    if question.order:
        inside = inside[:1] if question.order == "first" else sorted(inside, key=_end_ns)[-1:]
    if _is_complement(question):
        there = {*(e.subject for e in inside), *place.names}
        return _others(question, timeline, among, there, f"{where} {span.text}".strip())
    inside = _repeated(inside) if question.is_repeated else inside
    names = tuple(dict.fromkeys(e.subject for e in inside))
    parts = [f"{e.subject} {texts.span(e)}" for e in inside]
    nothing = "no person" if question.asked == "who" else "nothing"
    text = f"{where} {span.text}".strip() + ": " + (texts.listed(parts) if inside else nothing)
    return PastAnswer(asked=question.asked, text=text, names=names, count=len(names), evidence=tuple(inside))


def _is_complement(question: PastQuestion) -> bool:
    """Return whether the things are asked for to which it did not happen."""
    return question.is_negated and question.asked in ("what", "how_many")


def _others(
    question: PastQuestion, timeline: Timeline, among: set[str] | None, names: set[str], what: str
) -> PastAnswer:
    """Return the things of which something was not so."""
    candidates = sorted((among or set(_all_names(timeline))) - set(timeline.live_names))
    others = tuple(name for name in candidates if name not in names)
    text = f"never {what}: {few(others, _FEW) if others else 'nothing'}"
    return PastAnswer(asked=question.asked, text=text, names=others, count=len(others))


def _repeated(episodes: Sequence[Episode]) -> list[Episode]:
    """Return the episodes of those that have several."""
    times = Counter(e.subject for e in episodes)
    return [e for e in episodes if times[e.subject] > 1]


def _end_ns(episode: Episode) -> int:
    return episode.until_ns or 1 << 62


def _all_names(timeline: Timeline) -> list[str]:
    """Return all entities that are not places, also those that no longer exist."""
    names = {name for name, _ in timeline.journal.last_touches(timeline.journal.last)}
    names |= timeline.past.initial_entities().keys()
    present = timeline.present.entities
    return sorted(name for name in names if name not in present or not present[name].place)
