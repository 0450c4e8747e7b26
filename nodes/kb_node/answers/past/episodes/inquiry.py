"""A question about the past with its period, and the episodes that it is about."""

from __future__ import annotations

from dataclasses import replace
from typing import Final, NamedTuple

from semmap.nodes.kb_node.answers.past.episodes import texts, where
from semmap.nodes.kb_node.answers.past.episodes.episode_lists import clip
from semmap.nodes.kb_node.answers.past.episodes.occurrences import NotKnown, Occurrences
from semmap.nodes.kb_node.answers.past.episodes.resolved import ResolvedQuestion
from semmap.nodes.kb_node.answers.past.episodes.timeline import Timeline
from semmap.nodes.language.past.question import Claim, PastQuestion
from semmap.schemas.episodes import Episode
from semmap.schemas.moments import Moment
from semmap.schemas.wording import few

FEW: Final = 5
END_NS: Final = 1 << 62


class Span(NamedTuple):
    """The period of a question [ns]; `at_ns` is its moment. `text` describes it."""

    first_ns: int = 0
    last_ns: int = END_NS
    at_ns: int | None = None
    text: str = ""


class Inquiry:
    """One question about the past of a map."""

    def __init__(self, timeline: Timeline, resolved: ResolvedQuestion) -> None:
        """Resolve the period. Raises NotKnown."""
        self._t = timeline
        self._q: PastQuestion = resolved.question
        self._claim = resolved.question.claim
        self._o = Occurrences(timeline, resolved.referents, resolved.it)
        self._subjects = () if self._is_of_kind() else self._o.subjects(self._claim)
        self._referents = resolved.referents
        self._span = self._read_span()

    def _is_of_kind(self) -> bool:
        """Return whether the subject is a kind of things that are looked for: which cups were moved."""
        return self._q.asked in ("what", "how_many")

    def _read_span(self) -> Span:
        period = self._q.period
        first_ns = 0 if period.since is None else self._ns(period.since)[0]
        if period.since is not None and period.since.commit is not None:
            first_ns += 1  # since a commit is after it
        last_ns = END_NS if period.until is None else self._ns(period.until)[1]
        if period.until is not None and period.since is None:
            last_ns = self._ns(period.until)[0] - 1
        at_ns = None
        text = ""
        if period.at is not None:
            begin_ns, at_ns = self._ns(period.at)
            text = f"at {texts.clock(begin_ns)}"
            first_ns, last_ns = begin_ns, at_ns
        elif first_ns and last_ns < END_NS:
            text = f"from {texts.clock(first_ns)} to {texts.clock(min(last_ns, self._t.now_ns))}"
        elif first_ns:
            text = f"since {texts.clock(first_ns)}"
        elif last_ns < END_NS:
            text = f"before {texts.clock(last_ns + 1)}"
        if first_ns > self._t.now_ns:
            raise NotKnown("the time is in the future")
        if last_ns < self._t.first_ns:
            raise NotKnown(
                f"nothing is stored of that time: the history begins at {texts.clock(self._t.first_ns)}"
            )
        if first_ns > last_ns:
            raise NotKnown("the first time is later than the second one")
        span = Span(first_ns, last_ns, at_ns, text)
        is_period = self._q.anchor not in (None, "compare") and self._q.asked != "where"
        return self._anchored(span) if is_period else span

    def _ns(self, moment: Moment) -> tuple[int, int]:
        if moment.commit is None:
            return min(moment.first_ns, END_NS), min(moment.last_ns, END_NS)
        if moment.commit > self._t.journal.last:
            raise NotKnown(f"there is no commit {moment.commit} yet; the last one is {self._t.journal.last}")
        stamp_ns = self._t.stamp(moment.commit)
        return stamp_ns, stamp_ns

    def _anchored(self, span: Span) -> Span:
        """Return the period before, after or during what the second clause states."""
        episode = self._anchor(span)
        is_moment = self._q.asked in ("what", "who", "how_many", "whether") and not self._claim.event
        if is_moment and self._q.anchor in ("before", "after"):
            ns = episode.since_ns - 1 if self._q.anchor == "before" else self._end_ns(episode)
            return Span(ns, ns, ns, f"just {self._q.anchor} {texts.clock(ns)}")
        match self._q.anchor:
            case "before":
                return span._replace(
                    last_ns=episode.since_ns - 1, text=f"before {texts.clock(episode.since_ns)}"
                )
            case "after":
                end_ns = self._end_ns(episode)
                return span._replace(first_ns=end_ns + 1, text=f"after {texts.clock(end_ns)}")
        if episode.until_ns is None and episode.since is not None and episode.by:
            ns = episode.since_ns
            return span._replace(first_ns=ns, last_ns=ns, at_ns=ns, text=f"at {texts.clock(ns)}")
        last_ns = self._t.now_ns if episode.until_ns is None else episode.until_ns
        return span._replace(first_ns=episode.since_ns, last_ns=last_ns, text=texts.span(episode))

    def _end_ns(self, episode: Episode) -> int:
        claim = self._anchor_claim()
        if claim.event:
            return episode.since_ns
        if episode.until_ns is None:
            raise NotKnown(f"{episode.subject} is {episode.what} still, {texts.span(episode)}")
        return episode.until_ns

    def _anchor_claim(self) -> Claim:
        """Return what the second clause states: *before table1* is before it was there."""
        claim = self._q.anchored or Claim()
        own = [text for _, text in self._claim.places]
        if claim.event == "take" and not claim.places and own and self._q.asked != "where":
            return replace(claim, places=[("from", text) for text in own])
        if claim.event or claim.state or claim.places or claim.agent or not claim.subjects:
            return claim
        referent = self._referents[claim.subjects[0]]
        if referent.author and self._claim.event:
            return Claim(
                self._claim.subjects, self._claim.event, places=self._claim.places, agent=referent.text
            )
        return Claim(is_it=True, places=[("at", text) for text in claim.subjects])

    def _anchor(self, span: Span) -> Episode:
        """Return the episode that the second clause is about: the last one in the period."""
        claim = self._anchor_claim()
        is_it = claim is self._q.anchored and claim.is_it and not self._subjects
        own = self._o.subjects(claim) if claim.subjects or is_it else ()
        if not (own or self._subjects):
            raise NotKnown(f"the question names no thing that was so {self._q.anchor} it")
        episodes = self._o.of(claim, own or self._subjects)
        inside = clip(episodes, span.first_ns, span.last_ns)
        if not inside:
            what = self._o.what(claim, self._o.places(claim)) or "so"
            raise NotKnown(f"{few(own or self._subjects, FEW)} was never {what}, as far as the history goes")
        return inside[-1]

    def _episodes(self) -> list[Episode]:
        claim = self._claim
        is_there = claim.is_there and not (claim.state or claim.places)
        if is_there or claim.event == "see":
            return [episode for name in self._subjects for episode in where.visited(self._t, name)[-1:]]
        found = clip(self._o.of(claim, self._subjects), self._span.first_ns, self._span.last_ns)
        return [e for e in found if e.since_ns >= self._span.first_ns] if self._is_event() else found

    def _is_event(self) -> bool:
        return self._claim.event not in ("", "see", "missing")

    def _what_text(self) -> str:
        return self._o.what(self._claim, self._o.places(self._claim)) or "there"

    def _never(self) -> str:
        if self._span.at_ns is not None:
            return f"{few(self._subjects, FEW)} was not {self._what_text()} {self._span.text}"
        begun = f"the history begins at {texts.clock(self._t.first_ns)}"
        text = f"{few(self._subjects, FEW)} was never {self._what_text()} {self._span.text}".strip()
        return f"{text} ({begun})"
