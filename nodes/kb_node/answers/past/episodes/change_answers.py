"""Answers to who did something, what happened, what changed and what is missing."""

from __future__ import annotations

from msgspec import structs

from semmap.nodes.kb_node.answers.past.episodes import contents, texts
from semmap.nodes.kb_node.answers.past.episodes.happenings import happened
from semmap.nodes.kb_node.answers.past.episodes.inquiry import FEW
from semmap.nodes.kb_node.answers.past.episodes.occurrences import NotKnown
from semmap.nodes.kb_node.answers.past.episodes.time_answers import TimeAnswers
from semmap.schemas.episodes import Episode, PastAnswer
from semmap.schemas.wording import few


class ChangeAnswers(TimeAnswers):
    """Answers who did something, what happened, what changed and what is missing."""

    def _who(self) -> PastAnswer:
        if not self._claim.event or self._claim.event in ("enter", "leave", "go"):
            return self._who_was_there()
        if not self._subjects:
            return self._what()
        episodes = [e for e in self._episodes() if e.by]
        if not episodes:
            return PastAnswer(asked="who", text=self._never(), count=0)
        picked = {"first": episodes[:1], "last": episodes[-1:]}.get(self._q.order, episodes)
        names = (picked[-1].by,)
        parts = [f"{e.by} at {texts.clock(e.since_ns)} (commit {e.since})" for e in reversed(picked)]
        text = f"{picked[-1].subject} was {picked[-1].what} by {parts[0]}"
        text += f"; before that by {texts.listed(parts[1:])}" if len(parts) > 1 else ""
        return PastAnswer(asked="who", text=text, names=names, count=len(picked), evidence=tuple(picked))

    def _who_was_there(self) -> PastAnswer:
        places = self._o.places(self._claim)
        if not places:
            raise NotKnown("the question names neither an event nor a place")
        persons = self._of_class("Person")
        return happened(self._t, self._o, self._q, persons, places, self._span)

    def _of_class(self, class_name: str) -> set[str]:
        entities = list(self._t.present.entities.values())
        found = {e.name for e in entities if class_name in e.types}
        return found | {name for name in self._t.live_names if self._is_robot_or_person(name, class_name)}

    def _is_robot_or_person(self, name: str, class_name: str) -> bool:
        entity = self._t.last_state_of(name)
        return entity is not None and class_name in entity.types

    def _what(self) -> PastAnswer:
        among: set[str] | None = None
        if self._claim.subjects:
            among = {name for text in self._claim.subjects for name in self._o.kind(text)}
        return happened(self._t, self._o, self._q, among, self._o.places(self._claim), self._span)

    def _changed(self) -> PastAnswer:
        first, last = self._commits()
        if self._subjects:
            return self._changes_of(first, last)
        places = self._o.places(self._claim)
        if self._q.is_gross and places:
            return happened(self._t, self._o, self._q, None, places, self._span)
        scope = (
            f"{' '.join(f'{self._o.preposition(p)} {few(p.names, FEW)}' for p in places)} {self._span.text}"
        )
        found = contents.changed(self._t, self._o, places, first, last, scope.strip() or "in the map")
        if self._q.is_all:
            return _as_verdict(found, is_so=not found.names)
        return found

    def _changes_of(self, first: int, last: int) -> PastAnswer:
        """Return what happened to the subjects, commit by commit."""
        episodes = []
        for name in self._subjects:
            for commit, changes in self._t.changes(name):
                if first < commit.seq <= last and changes:
                    what = "; ".join(change.text for change in changes)
                    by = commit.agent or commit.source
                    episodes.append(
                        Episode(subject=name, what=what, since=commit.seq, since_ns=commit.stamp_ns, by=by)
                    )
        if not episodes:
            text = f"nothing happened to {few(self._subjects, FEW)} {self._span.text}".strip()
            return PastAnswer(asked="changed", text=text, count=0)
        parts = [f"{e.subject} {e.what} at {texts.begin(e)}" for e in episodes]
        names = tuple(dict.fromkeys(e.subject for e in episodes))
        return PastAnswer(
            asked="changed",
            text=texts.listed(parts),
            names=names,
            count=len(episodes),
            evidence=tuple(episodes),
        )

    def _commits(self) -> tuple[int, int]:
        """Return the commits between which a period is."""
        span = self._span
        first = self._t.seq_at(span.first_ns - 1) if span.first_ns else max(self._t.journal.first - 1, 1)
        return first, self._t.seq_at(min(span.last_ns, self._t.now_ns))

    def _missing(self) -> PastAnswer:
        places = self._o.places(self._claim)
        first, last = self._commits()
        span = self._span
        if span.at_ns is not None:  # what was missing at 10:00, compared with the beginning
            first = max(self._t.journal.first - 1, 1)
        place = places[0] if places else None
        scope = f"from {few(place.names, FEW)}" if place is not None else "from the map"
        if not span.text:
            span = span._replace(text=f"since {texts.clock(self._t.first_ns)}")
        found = contents.missing(self._t, self._o, place, first, last, f"{scope} {span.text}".strip())
        return _as_verdict(found, is_so=not found.names) if self._q.is_all else found


def _as_verdict(found: PastAnswer, *, is_so: bool) -> PastAnswer:
    """Return an answer as yes or no."""
    return structs.replace(found, verdict=is_so, text=f"{'yes' if is_so else 'no'}: {found.text}")
