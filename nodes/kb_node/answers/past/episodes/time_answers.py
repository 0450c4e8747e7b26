"""Answers to when, since when, how long and how often something was so."""

from __future__ import annotations

from semmap.nodes.kb_node.answers.past.episodes import texts
from semmap.nodes.kb_node.answers.past.episodes.location_answers import LocationAnswers
from semmap.nodes.kb_node.answers.past.episodes.occurrences import NotKnown
from semmap.schemas.episodes import Episode, PastAnswer


class TimeAnswers(LocationAnswers):
    """Answers when, since when, how long and how often."""

    def _when(self) -> PastAnswer:
        asked = self._q.asked
        episodes = self._episodes()
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
        parts = [f"at {texts.begin(e)}" if self._is_event() else texts.span(e) for e in episodes]
        count = len(episodes)
        text = f"{count} time{'s' * (count > 1)}: {episodes[0].subject} was {episodes[0].what}"
        text = f"{text} {self._span.text}".strip() + f": {texts.listed(parts)}"
        times = tuple(e.since_ns for e in episodes)
        return PastAnswer(asked="how_often", text=text, count=count, times_ns=times, evidence=tuple(episodes))


def _lasted_s(episode: Episode, first_ns: int, end_ns: int) -> float:
    """Return the duration of the part of an episode that is in a period [s]."""
    until_ns = end_ns if episode.until_ns is None else min(episode.until_ns, end_ns)
    return max(0, until_ns - max(episode.since_ns, first_ns)) / 1e9
