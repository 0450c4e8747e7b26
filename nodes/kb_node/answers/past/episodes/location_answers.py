"""Answers to where something was."""

from __future__ import annotations

from collections.abc import Sequence

from msgspec import structs

from semmap.nodes.kb_node.answers.past.episodes import texts, where
from semmap.nodes.kb_node.answers.past.episodes.episode_lists import clip
from semmap.nodes.kb_node.answers.past.episodes.inquiry import END_NS, Inquiry
from semmap.nodes.kb_node.answers.past.episodes.occurrences import NotKnown
from semmap.nodes.language.past.question import Claim
from semmap.schemas.episodes import PastAnswer


class LocationAnswers(Inquiry):
    """Answers where something was."""

    def _where(self) -> PastAnswer:
        if not self._subjects:
            raise NotKnown("the question names no thing")
        found = _joined([self._where_of(one) for one in self._subjects])
        if not self._claim.kind:
            return found
        kind = self._o.kind(self._claim.kind)
        names = tuple(name for name in found.names if name in kind)
        if not names:
            raise NotKnown(f"{found.text}; that is not one of '{self._claim.kind}'")
        return structs.replace(found, names=names)

    def _where_of(self, name: str) -> PastAnswer:
        span = self._span
        if self._q.anchor is not None:
            return self._where_anchored(name)
        if self._claim.event and self._claim.event not in ("see", "go", "enter"):
            return self._where_event(name)
        if span.at_ns is not None:
            return where.where_at(self._t, name, self._t.seq_at(span.at_ns), span.at_ns, span.text)
        if self._q.is_previous:
            episodes = where.visited(self._t, name)
            current = [e for e in episodes if e.until_ns is None]
            if not current:
                return where.where_before(self._t, name, self._t.now_ns, "at last")
            return where.where_before(
                self._t, name, current[-1].since_ns, f"before it was {current[-1].what}"
            )
        if span.last_ns < END_NS and not span.first_ns:
            return where.where_at(self._t, name, self._t.seq_at(span.last_ns), span.last_ns, span.text)
        is_every = self._claim.kind and not self._q.order  # which rooms did it visit
        if span.first_ns or self._q.is_current or is_every:
            return where.where_during(self._t, name, span.first_ns, span.last_ns)
        episodes = where.visited(self._t, name)
        if not episodes:
            raise NotKnown(f"where {name} was is not stored")
        one = episodes[0 if self._q.order == "first" else -1]
        text = f"{name} was {one.what} {texts.span(one)}"
        return PastAnswer(asked="where", text=text, names=tuple(one.what.split()[1::2]), evidence=(one,))

    def _where_anchored(self, name: str) -> PastAnswer:
        episode = self._anchor(self._span)
        clause = (
            f"{episode.subject} was {episode.what}" if episode.subject != name else f"it was {episode.what}"
        )
        if self._q.anchor == "before":
            return where.where_before(self._t, name, episode.since_ns, f"before {clause}")
        if self._q.anchor == "after":
            return where.where_after(self._t, name, self._end_ns(episode), f"after {clause}")
        ns = episode.since_ns
        seq = episode.since or self._t.seq_at(ns)
        return where.where_at(self._t, name, seq, ns, f"at {texts.clock(ns)}, when {clause}")

    def _where_event(self, name: str) -> PastAnswer:
        """Return where something was put, or with *from*, where it was before."""
        is_from = any(how == "from" for how, _ in self._claim.places)
        claim = Claim(self._claim.subjects, self._claim.event, agent=self._claim.agent)
        episodes = clip(self._o.of(claim, (name,)), self._span.first_ns, self._span.last_ns)
        if not episodes:
            raise NotKnown(f"{name} was never {self._o.what(claim, ())} {self._span.text}".strip())
        last = episodes[0 if self._q.order == "first" else -1]
        clause = f"it was {last.what} at {texts.begin(last)}"
        if is_from:
            return where.where_before(self._t, name, last.since_ns, f"before {clause}")
        return where.where_after(self._t, name, last.since_ns, f"after {clause}")


def _joined(answers: Sequence[PastAnswer]) -> PastAnswer:
    """Return one answer for several subjects."""
    names = tuple(dict.fromkeys(name for one in answers for name in one.names))
    evidence = tuple(episode for one in answers for episode in one.evidence)
    return structs.replace(
        answers[0], text="; ".join(one.text for one in answers), names=names, evidence=evidence
    )
