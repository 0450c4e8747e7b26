"""Answers resolved questions about the past."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

from msgspec import structs

from semmap.nodes.kb_node.answers.past.episodes import contents, texts, where
from semmap.nodes.kb_node.answers.past.episodes.happenings import happened
from semmap.nodes.kb_node.answers.past.episodes.occurrences import NotKnown, Occurrences
from semmap.nodes.kb_node.answers.past.episodes.resolved import ResolvedQuestion
from semmap.nodes.kb_node.answers.past.episodes.timeline import Timeline, clip
from semmap.nodes.language.past.question import Claim, PastQuestion
from semmap.schemas import errors
from semmap.schemas.episodes import Episode, PastAnswer
from semmap.schemas.moments import Moment
from semmap.schemas.wording import few

_MOST = 100
_FEW = 5
_END_NS = 1 << 62


class Span(NamedTuple):
    """The period of a question [ns]; `at_ns` is its moment. `text` describes it."""

    first_ns: int = 0
    last_ns: int = _END_NS
    at_ns: int | None = None
    text: str = ""


def answer(timeline: Timeline, resolved: ResolvedQuestion) -> PastAnswer:
    """Return the answer to a question, or why it is not known."""
    try:
        found = _Answering(timeline, resolved).answer()
    except NotKnown as unknown:
        return PastAnswer(asked=resolved.question.asked, text=str(unknown), is_known=False)
    except (errors.Refused, errors.UnknownName, errors.BadRequest) as error:
        return PastAnswer(asked=resolved.question.asked, text=str(error), is_known=False)
    return structs.replace(found, evidence=found.evidence[:_MOST])


class _Answering:
    def __init__(self, timeline: Timeline, resolved: ResolvedQuestion) -> None:
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

    def answer(self) -> PastAnswer:
        """Return the answer. Raises NotKnown."""
        match self._q.asked:
            case "where":
                return self._where()
            case "changed":
                return self._changed()
            case "missing":
                return self._missing()
            case "what" | "how_many":
                return self._what()
            case "who":
                return self._who()
            case "whether":
                return self._whether()
        if not self._subjects:
            raise NotKnown("the question names no thing")
        match self._q.asked:
            case "when" | "until":
                return self._when()
            case "since":
                return self._since()
            case "how_long":
                return self._how_long()
        return self._how_often()

    # The period

    def _read_span(self) -> Span:
        period = self._q.period
        first_ns = 0 if period.since is None else self._ns(period.since)[0]
        if period.since is not None and period.since.commit is not None:
            first_ns += 1  # since a commit is after it
        last_ns = _END_NS if period.until is None else self._ns(period.until)[1]
        if period.until is not None and period.since is None:
            last_ns = self._ns(period.until)[0] - 1
        at_ns = None
        text = ""
        if period.at is not None:
            begin_ns, at_ns = self._ns(period.at)
            text = f"at {texts.clock(begin_ns)}"
            first_ns, last_ns = begin_ns, at_ns
        elif first_ns and last_ns < _END_NS:
            text = f"from {texts.clock(first_ns)} to {texts.clock(min(last_ns, self._t.now_ns))}"
        elif first_ns:
            text = f"since {texts.clock(first_ns)}"
        elif last_ns < _END_NS:
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
            return moment.first_ns, moment.last_ns
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
                return span._replace(first_ns=end_ns, text=f"after {texts.clock(end_ns)}")
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
        own = self._o.subjects(claim) if claim.subjects else ()
        episodes = self._o.of(claim, own or self._subjects)
        inside = clip(episodes, span.first_ns, span.last_ns)
        if not inside:
            what = self._o.what(claim, self._o.places(claim)) or "so"
            raise NotKnown(f"{few(own or self._subjects, _FEW)} was never {what}, as far as the history goes")
        return inside[-1]

    # The kinds of questions

    def _where(self) -> PastAnswer:
        if not self._subjects:
            raise NotKnown("the question names no thing")
        return _joined([self._where_of(one) for one in self._subjects])

    def _where_of(self, name: str) -> PastAnswer:
        span = self._span
        if self._q.anchor is not None:
            return self._where_anchored(name)
        if self._claim.event and self._claim.event not in ("see", "go"):
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
        if span.last_ns < _END_NS and not span.first_ns:
            return where.where_at(self._t, name, self._t.seq_at(span.last_ns), span.last_ns, span.text)
        if span.first_ns or self._q.is_current:
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
            return f"{few(self._subjects, _FEW)} was not {self._what_text()} {self._span.text}"
        begun = f"the history begins at {texts.clock(self._t.first_ns)}"
        text = f"{few(self._subjects, _FEW)} was never {self._what_text()} {self._span.text}".strip()
        return f"{text} ({begun})"

    def _when(self) -> PastAnswer:
        asked = self._q.asked
        episodes = self._episodes()
        if self._claim.event or self._q.asked == "when":
            episodes = [e for e in episodes if e.since_ns >= self._span.first_ns or self._q.order == "last"]
        if not episodes:
            return PastAnswer(asked=asked, text=self._never(), count=0)
        is_event = self._is_event() and not self._claim.is_there
        picked = {"first": episodes[:1], "last": episodes[-1:]}.get(self._q.order, episodes)
        if asked == "until":
            picked = episodes[-1:]
        times: tuple[int, ...]
        if is_event:
            times = (picked[-1].since_ns,)
            parts = [f"at {texts.begin(e)}" for e in picked[::-1]]
            text = f"{picked[-1].subject} was {picked[-1].what} {parts[0]}"
            text += f"; before that {texts.listed(parts[1:])}" if len(parts) > 1 else ""
        elif asked == "until" or self._q.order == "last":
            times = tuple(self._t.now_ns if e.until_ns is None else e.until_ns for e in picked)
            text = f"{picked[-1].subject} was {picked[-1].what} {texts.span(picked[-1])}"
        else:
            times = tuple(e.since_ns for e in picked)
            text = (
                f"{picked[-1].subject} was {picked[-1].what} {texts.listed([texts.span(e) for e in picked])}"
            )
        if len(picked) < len(episodes):
            text += f"; {len(episodes)} times in all"
        return PastAnswer(asked=asked, text=text, times_ns=times, count=len(episodes), evidence=tuple(picked))

    def _current(self) -> Episode:
        """Return what is still so, or the last event. Raises NotKnown."""
        episodes = self._episodes()
        if not episodes:
            raise NotKnown(self._never())
        last = episodes[-1]
        if not self._claim.event and last.until_ns is not None and self._q.is_current:
            raise NotKnown(f"{last.subject} is no longer {last.what}; it was {texts.span(last)}")
        return last

    def _since(self) -> PastAnswer:
        last = self._current()
        text = f"{last.subject} has been {last.what} since {texts.begin(last)}"
        if last.until_ns is not None:
            text = f"{last.subject} was {last.what} {texts.span(last)}"
        return PastAnswer(
            asked="since", text=text, is_known=last.since != 0, times_ns=(last.since_ns,), evidence=(last,)
        )

    def _how_long(self) -> PastAnswer:
        if self._q.is_current or self._claim.is_there:
            last = self._current()
            seconds = (self._t.now_ns - max(last.since_ns, self._span.first_ns)) / 1e9
            at_least = "at least " if last.since == 0 else ""
            lasted = f"for {at_least}{texts.lasted(seconds)}"
            text = f"{last.subject} has been {last.what} {lasted}, {texts.span(last)}"
            return PastAnswer(asked="how_long", text=text, seconds=seconds, evidence=(last,))
        if self._claim.event and self._claim.event != "missing":
            raise NotKnown(f"an event such as '{self._claim.event}' has no duration")
        episodes = self._episodes()
        if self._q.order:
            episodes = episodes[:1] if self._q.order == "first" else episodes[-1:]
        if not episodes:
            return PastAnswer(asked="how_long", text=self._never(), seconds=0.0, count=0)
        end_ns = min(self._span.last_ns, self._t.now_ns)
        seconds = sum(_lasted_s(e, self._span.first_ns, end_ns) for e in episodes)
        at_least = "at least " if episodes[0].since == 0 and self._span.first_ns < self._t.first_ns else ""
        parts = texts.listed([texts.span(e) for e in episodes])
        text = f"{episodes[0].subject} was {episodes[0].what} for {at_least}{texts.lasted(seconds)}"
        text = f"{text} {self._span.text}".strip() + f": {parts}"
        return PastAnswer(
            asked="how_long", text=text, seconds=seconds, count=len(episodes), evidence=tuple(episodes)
        )

    def _how_often(self) -> PastAnswer:
        episodes = self._episodes()
        if not episodes:
            return PastAnswer(asked="how_often", text=f"0 times: {self._never()}", count=0)
        parts = [texts.span(e) if not self._claim.event else f"at {texts.begin(e)}" for e in episodes]
        count = len(episodes)
        text = f"{count} time{'s' * (count > 1)}: {episodes[0].subject} was {episodes[0].what}"
        text = f"{text} {self._span.text}".strip() + f": {texts.listed(parts)}"
        times = tuple(e.since_ns for e in episodes)
        return PastAnswer(asked="how_often", text=text, count=count, times_ns=times, evidence=tuple(episodes))

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
            among = {name for text in self._claim.subjects for name in self._referents[text].names}
            if not among:
                raise NotKnown(self._referents[self._claim.subjects[0]].problem)
        return happened(self._t, self._o, self._q, among, self._o.places(self._claim), self._span)

    def _changed(self) -> PastAnswer:
        first, last = self._commits()
        if self._subjects:
            return self._changes_of(first, last)
        places = self._o.places(self._claim)
        if self._q.is_gross and places:
            return happened(self._t, self._o, self._q, None, places, self._span)
        scope = (
            f"{' '.join(f'{self._o.preposition(p)} {few(p.names, _FEW)}' for p in places)} {self._span.text}"
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
            text = f"nothing happened to {few(self._subjects, _FEW)} {self._span.text}".strip()
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
        scope = f"from {few(place.names, _FEW)}" if place is not None else "from the map"
        found = contents.missing(self._t, self._o, place, first, last, f"{scope} {span.text}".strip())
        return _as_verdict(found, is_so=not found.names) if self._q.is_all else found

    def _whether(self) -> PastAnswer:
        if not self._subjects:
            return self._whether_any()
        if self._q.anchor == "compare":
            return self._compare()
        if self._claim.agent and self._is_event():
            return self._whether_by()
        episodes = self._episodes()
        is_so = len(episodes) > self._q.is_repeated
        if self._q.is_current and self._q.period.since is not None and not self._claim.event:
            is_so = self._q.is_repeated and is_so  # has it been open since 10:00: without a break
            is_so = is_so or any(e.since_ns <= self._span.first_ns and e.until_ns is None for e in episodes)
        if self._q.is_negated:
            verdict, word = not is_so, "no" if is_so else "yes"
        else:
            verdict, word = is_so, "yes" if is_so else "no"
        if episodes:
            parts = [f"at {texts.begin(e)}" if self._claim.event else texts.span(e) for e in episodes]
            text = f"{word}: {episodes[0].subject} was {episodes[0].what} {texts.listed(parts)}"
        else:
            text = f"{word}: {self._never()}"
        evidence = tuple(episodes)
        return PastAnswer(asked="whether", text=text, verdict=verdict, count=len(episodes), evidence=evidence)

    def _whether_by(self) -> PastAnswer:
        """Return whether an author did something, with who did it last."""
        author = self._o.author(self._claim)
        own = self._episodes()
        self._claim.agent = ""
        every = self._episodes()
        if not every:
            return PastAnswer(asked="whether", text=f"no: {self._never()}", verdict=False, count=0)
        last = every[-1]
        is_so = last.by.casefold() == author.casefold() if self._q.is_last else bool(own)
        if is_so and self._q.is_last and self._claim.state:  # was it Anna who left it open
            is_so = any(
                e.until_ns is None for e in self._o.of(replace(self._claim, event=""), self._subjects)
            )
        shown = own if is_so and not self._q.is_last else [last]
        parts = [f"at {texts.begin(e)}" for e in shown]
        verdict = is_so != self._q.is_negated
        text = f"{'yes' if verdict else 'no'}: {last.subject} was {last.what} {texts.listed(parts)}"
        return PastAnswer(
            asked="whether",
            text=text,
            verdict=verdict,
            names=(last.by,),
            count=len(own),
            evidence=tuple(shown),
        )

    def _compare(self) -> PastAnswer:
        """Return whether something was before or after something else."""
        episodes = self._o.of(self._claim, self._subjects)
        if not episodes:
            raise NotKnown(self._never())
        one, other = episodes[-1], self._anchor(Span())
        word = "before" if one.since_ns < other.since_ns else "after"
        parts = [f"{e.subject} was {e.what} at {texts.begin(e)}" for e in (one, other)]
        text = f"{word}: {parts[0]}, and {parts[1]}"
        return PastAnswer(asked="whether", text=text, verdict=word == "before", evidence=(one, other))

    def _whether_any(self) -> PastAnswer:
        found = self._who_was_there() if self._claim.is_anyone and not self._claim.event else self._what()
        is_so = bool(found.names)
        verdict = is_so != self._q.is_negated
        text = f"{'yes' if verdict else 'no'}: {found.text}"
        return structs.replace(found, asked="whether", verdict=verdict, text=text)


def _as_verdict(found: PastAnswer, *, is_so: bool) -> PastAnswer:
    """Return an answer as yes or no."""
    return structs.replace(found, verdict=is_so, text=f"{'yes' if is_so else 'no'}: {found.text}")


def _joined(answers: Sequence[PastAnswer]) -> PastAnswer:
    """Return one answer for several subjects."""
    names = tuple(dict.fromkeys(name for one in answers for name in one.names))
    evidence = tuple(episode for one in answers for episode in one.evidence)
    return structs.replace(
        answers[0], text="; ".join(one.text for one in answers), names=names, evidence=evidence
    )


def _lasted_s(episode: Episode, first_ns: int, end_ns: int) -> float:
    """Return the duration of the part of an episode that is in a period [s]."""
    until_ns = end_ns if episode.until_ns is None else min(episode.until_ns, end_ns)
    return max(0, until_ns - max(episode.since_ns, first_ns)) / 1e9
